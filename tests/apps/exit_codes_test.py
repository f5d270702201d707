"""Each exit code of the table in docs/verbs.md, by a run that ends with it; and no code that the table lacks."""
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
planted_bug = sys.argv[3] if len(sys.argv) > 3 else None
failures = []
seen = set()


def run(code, *arguments, preload=None, **more):
    """Runs to the end; standard error must be one line where the code is not 0, and not be empty."""
    environment = {**os.environ, **({"LD_PRELOAD": preload} if preload else {})}
    made = subprocess.run([program, *arguments, "--no-reexec"], stderr=subprocess.PIPE, text=True, env=environment, timeout=120,
                          **{"stdout": subprocess.PIPE, **more})
    seen.add(code)
    if made.returncode != code:
        failures.append(f"{arguments}: exit {made.returncode}, expected {code}: {made.stderr!r}")
    if code != 0 and len(made.stderr.strip().splitlines()) != 1:
        failures.append(f"{arguments}: expected one line, not {made.stderr!r}")
    return made


with tempfile.TemporaryDirectory() as folder:
    place = pathlib.Path(folder)
    run(0, "--version")
    run(0, "collect", "--help")
    run(1, "import", str(place / "missing.csv"), "--out", str(place / "out.h5"))
    steps = place / "steps.h5"
    run(0, "collect", "--sensor", "simulated", "--set", "transitions=40", "--out", str(place / "few"))
    (place / "few/transitions.h5").rename(steps)
    with open("/dev/full", "w") as full:  # what is printed goes nowhere
        run(1, "config", "--print", "collect", stdout=full)
        run(1, "--version", stdout=full)
        run(1, "completion", stdout=full)
        run(1, "evaluate", "dynamics", "--checkpoint", str(source / "models/dynamics_paper"), "--data", str(steps), stdout=full)
    run(2, "collect", "--set", "seed=many", "--out", str(place / "run"))
    run(2, "collect", "--frobnicate")
    run(2, "frobnicate")
    if planted_bug:
        (place / "planted-bug.json").write_text("{}")
        made = run(70, "collect", "--config", str(place / "planted-bug.json"), "--out", str(place / "run"), preload=planted_bug)
        if "please report it" not in made.stderr:
            failures.append(f"a bug is not called one: {made.stderr!r}")

    # Ctrl-C in the middle of a run.
    out = place / "interrupted"
    started = subprocess.Popen([program, "collect", "--sensor", "simulated", "--set", "transitions=1000000", "--out", str(out),
                                "--no-reexec"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while not (out / "run.json").exists() and started.poll() is None:
        time.sleep(0.05)
    started.send_signal(signal.SIGINT)
    started.communicate(timeout=120)
    seen.add(130)
    if started.returncode != 130:
        failures.append(f"Ctrl-C: exit {started.returncode}, expected 130")

page = (source / "docs/verbs.md").read_text().partition("## Exit codes")[2].partition("\n## ")[0]
listed = {int(code) for code in re.findall(r"^\| (\d+) \|", page, re.M)}
if listed != {0, 1, 2, 70, 130}:
    failures.append(f"docs/verbs.md lists the exit codes {sorted(listed)}")
if not seen <= listed or (planted_bug and seen != listed):
    failures.append(f"codes of this test: {sorted(seen)}, of docs/verbs.md: {sorted(listed)}")

print("\n".join(failures) or "every exit code is as the table says")
sys.exit(bool(failures))
