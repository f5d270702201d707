"""`lodestone qualify` as its user runs it: on a virtual rig, with a wrong option, interrupted, killed, and gone on with.
usage: qualify_test.py LODESTONE SOURCE"""
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
QUICK = ("qualify", "--virtual", "--sensor", "simulated", "--deviation", "wide", "--rig-seed", "7", "--set", "points.count=6", "--set",
         "points.seconds=1.5")


def start(*arguments, out):
    return subprocess.Popen([program, *map(str, arguments), "--out", str(out), "--no-reexec"], stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def wait_for(file, started):
    """run.json is there when a run begins, state.json once it can be gone on with."""
    while not file.exists() and started.poll() is None:
        time.sleep(0.01)


def run(*arguments, code=0):
    made = subprocess.run([program, *map(str, arguments), "--no-reexec"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=300)
    assert made.returncode == code, f"{arguments}: exit {made.returncode}\n{made.stdout}\n{made.stderr}"
    return made


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    out = folder / "rig"
    made = run(*QUICK, "--minutes", 1.5, "--out", out)
    result = json.loads((out / "qualify.json").read_text())
    assert result["minutes"] <= 2.0 and "stopped" not in result, result
    assert result["still"]["x_mm"]["n"] > 50 and len(result["still"]["x_mm"]["interval"]) == 2, result["still"]
    assert [coil["name"] for coil in result["coils"]] == ["+x", "-x", "+y", "-y"], result["coils"]
    verdicts = {item["item"]: item for item in result["items"]}
    assert all(item["verdict"] in ("good", "acceptable", "mend", "not measured") and item["why"] for item in verdicts.values())
    for item in verdicts:
        assert item in made.stdout, f"{item} is not in\n{made.stdout}"
    assert f"mend first: {result['mend_first']}" in made.stdout, made.stdout
    points = result["points"]
    assert points["controller"] == "baseline" and points["trial_s"] == 1.5 and 1 <= points["failed"]["n"] <= 6, points
    assert points["rms_mm"]["value"] > 0.0 and "error to expect at points, by the baseline: " in made.stdout, made.stdout
    assert "next: open" in made.stderr, made.stderr
    page = (out / "report.html").read_text()
    assert "Looks without a pose over the dish" in page and "<svg" in page
    assert json.loads((out / "run.json").read_text())["finished"]

    # The same rig, the same figures; and nothing is written over.
    run(*QUICK, "--minutes", 1.5, "--out", folder / "again")
    assert json.loads((folder / "again/qualify.json").read_text()) == result
    assert "not empty" in run(*QUICK, "--out", out, code=2).stderr

    # A released model drives to the points as it does in deploy.
    run(*QUICK, "--minutes", 0.5, "--models", source / "models/target", "--out", folder / "by a model")
    assert json.loads((folder / "by a model/qualify.json").read_text())["points"]["controller"] == "policy"
    used = json.loads((folder / "by a model/config.json").read_text())
    preset = json.loads((source / "models/target/deploy.json").read_text())["decorators"]
    assert used["points"]["decorators"] == {**used["points"]["decorators"], **preset}, used["points"]["decorators"]
    assert used["points"]["policy"] == str(source / "models/target") and used["decorators"]["stall_gain"] == 1.5, used["points"]

    for words, text in ((("--minutes", "0"), "minutes = 0"), (("--controller", "planner"), "points.controller"),
                        (("--minutes", "many"), "minutes"), (("--set", "test_curent_A=1"), "test_current_A")):
        told = run(*QUICK, *words, "--out", folder / "none", code=2).stderr
        assert text in told and len(told.strip().splitlines()) == 1, told
    assert "no such folder" in run(*QUICK, "--models", folder / "nothing", "--out", folder / "none", code=1).stderr
    assert not (folder / "none").exists()

    # Ctrl-C: the coils are off, and what was measured is kept.
    stopped = folder / "stopped"
    started = start(*QUICK, "--minutes", "600", out=stopped)
    wait_for(stopped / "run.json", started)
    started.send_signal(signal.SIGINT)
    _, errors = started.communicate(timeout=120)
    assert started.returncode == 130, f"exit {started.returncode}: {errors}"
    assert "qualify.json" in errors and "--resume" in errors, errors
    assert "stopped by the user" in json.loads((stopped / "qualify.json").read_text())["stopped"]
    assert not json.loads((stopped / "run.json").read_text())["finished"]

    # After a kill, or Ctrl-C, the same command goes on, to the same figures.
    for signal_given in (signal.SIGKILL, signal.SIGINT):
        cut = folder / f"cut by {signal_given}"
        started = start(*QUICK, "--minutes", 1.5, out=cut)
        wait_for(cut / "state.json", started)
        started.send_signal(signal_given)
        started.communicate(timeout=120)
        assert started.returncode in (0, 130, -signal.SIGKILL), started.returncode
        assert json.loads((cut / "state.json").read_text())["item"] >= 1
        other = run(*QUICK, "--minutes", 2, "--out", cut, "--resume", code=2).stderr
        assert "minutes = 2" in other and "there: 1.5" in other, other
        run(*QUICK, "--minutes", 1.5, "--out", cut, "--resume")
        assert json.loads((cut / "qualify.json").read_text()) == result, f"after {signal_given}"
        found = run(*QUICK, "--minutes", 1.5, "--out", cut, "--resume")
        assert "finished already" in found.stderr and "mend first" in found.stdout, found.stderr
