"""What a newcomer tries first: --version, a mistyped verb, NO_COLOR, completion, what to do next."""
import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
failures = []


def run(*arguments):
    return subprocess.run([program, *arguments, "--no-reexec"], capture_output=True, text=True)


def expect(condition, what):
    if not condition:
        failures.append(what)


version = subprocess.run([program, "--version"], capture_output=True, text=True)
wanted = re.search(r"project\(lodestone VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text()).group(1)
expect(version.returncode == 0 and re.fullmatch(rf"lodestone {re.escape(wanted)} \(commit \S+, \w+\)\n", version.stdout),
       f"--version: {version.stdout!r} {version.stderr!r}")
cited = re.search(r"^version: (\S+)", (source / "CITATION.cff").read_text(), re.M).group(1)
expect(cited == wanted, f"CITATION.cff names version {cited}, the program is {wanted}")

for typed, meant in ((["depoly"], "deploy?"), (["rig", "chek"], "rig check?"), (["bench", "papre"], "bench paper?"),
                     (["evalute", "dynamics"], "evaluate?")):
    made = run(*typed)
    expect(made.returncode == 2 and f"did you mean {meant}" in made.stderr and len(made.stderr.splitlines()) == 1,
           f"{typed}: exit {made.returncode}, {made.stderr!r}")


def on_terminal(environment):
    """What an error looks like on a terminal."""
    reader, writer = pty.openpty()
    subprocess.run([program, "depoly", "--no-reexec"], stderr=writer, env=dict(environment, TERM="xterm-256color"))
    os.close(writer)
    text = os.read(reader, 4096).decode()
    os.close(reader)
    return text


without = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
expect("\033[" in on_terminal(without), "an error on a terminal is coloured")
expect("\033[" in on_terminal(dict(without, NO_COLOR="")), "an empty NO_COLOR says nothing")
expect("\033[" not in on_terminal(dict(without, NO_COLOR="1")), "NO_COLOR turns colours off")

with tempfile.TemporaryDirectory() as folder:
    points = pathlib.Path(folder) / "points.csv"
    points.write_text("x_m,y_m\n0,0\n")
    field = run("rig", "field", "--coil", "+x", "--points", str(points), "--out", f"{folder}/field.csv")
    expect(field.returncode == 0 and f"next: hold {folder}/field.csv" in field.stderr, f"rig field: {field.stderr!r}")
    failed = run("rig", "field", "--coil", "+x", "--points", "missing.csv", "--out", f"{folder}/other.csv")
    expect(failed.returncode != 0 and "next:" not in failed.stderr, f"a failure has no next step: {failed.stderr!r}")

with tempfile.TemporaryDirectory() as folder:
    for name, begins in (("policy.onnx", b"\x08"), ("policy.h", b"/* A policy"), ("policy.pt", b"PK")):
        file = pathlib.Path(folder) / "new" / name
        words = ("export", "--policy", str(source / "models/centre"), "--to", str(file))
        made = run(*words)
        expect(made.returncode == 0 and file.read_bytes().startswith(begins), f"export --to {name}: {made.stderr!r}")
        file.write_text("mine")
        expect(run(*words).returncode == 2 and file.read_text() == "mine", f"export replaces {name}")
        expect(run(*words, "--force").returncode == 0 and file.read_bytes().startswith(begins), f"export --force --to {name}")
        expect([each.name for each in file.parent.iterdir() if each.name.startswith(name)] == [name], f"export leaves more than {name}")

script = run("completion").stdout


def completed(*words):
    """What bash offers for the last of the words."""
    ask = (f"{script}\nCOMP_WORDS=({' '.join(repr(word) for word in words)}); COMP_CWORD={len(words) - 1}\n"
           "_lodestone; printf '%s\\n' \"${COMPREPLY[@]}\"")
    made = subprocess.run(["bash", "-c", ask], capture_output=True, text=True)
    expect(made.stderr == "", f"completion of {words}: {made.stderr!r}")
    return made.stdout.split()


def listed(help_text, pattern):
    return set(re.findall(pattern, help_text, re.M))


verbs = listed(run("--help").stdout.split("Subcommands:")[-1], r"^  ([a-z][a-z-]*)\b")
expect({"collect", "deploy", "report"} <= verbs, f"--help lists {verbs}")
expect(verbs <= set(completed("lodestone", "")), f"verbs offered: {completed('lodestone', '')}")
expect(completed("lodestone", "depl") == ["deploy"], "depl completes to deploy")
for path in sorted(verbs):
    page = run(path, "--help").stdout
    options = listed(page, r"(--[a-z][a-z-]*)(?= |,|$|:)") & listed(page, r"^  (?:-\w,)?(--[a-z][a-z-]*)")
    offered = set(completed("lodestone", path, "--"))
    expect(options and options <= offered, f"{path}: --help has {options}, offered are {offered}")
expect("check" in completed("lodestone", "rig", ""), "rig offers check")
expect("--port" in completed("lodestone", "rig", "check", "--p"), "rig check offers --port")
expect(completed("lodestone", "deploy", "--set", "trials.co") == ["trials.count="], "--set offers keys")
expect({"policy", "baseline", "planner"} <= set(completed("lodestone", "deploy", "--controller", "")),
       "an option offers what its key allows")
expect("train-policy" in completed("lodestone", "config", "--print", "train-"), "config --print offers verbs")
expect(completed("lodestone", "deploy", "--policy", "") == [], "files are left to bash")

print("\n".join(failures) or "first steps are as expected")
sys.exit(bool(failures))
