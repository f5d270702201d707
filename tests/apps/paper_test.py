#!/usr/bin/env python3
"""bench paper: cells run apart, survive kills, and end in one report.

usage: paper_test.py LODESTONE SOURCE_FOLDER
"""
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
scratch = tempfile.TemporaryDirectory()
out = pathlib.Path(scratch.name) / "paper"
scale = pathlib.Path(scratch.name) / "tiny.json"
scale.write_text(json.dumps({
    "seeds": 1, "ablation_seeds": 1, "transitions": 600, "data_sizes": [300], "paper_epochs": 3, "best_epochs": 2,
    "centre_steps": 1000, "target_steps": 2000, "mix_steps": 1000, "ablation_steps": 2000, "trials": 1, "ablation_trials": 1}))


def bench(*arguments):
    return [program, "bench", "paper", "--config", str(scale), "--out", str(out), *arguments]


def run(*arguments):
    done = subprocess.run(bench(*arguments), capture_output=True, text=True)
    assert done.returncode == 0, (arguments, done.stdout, done.stderr)
    return done.stdout


def states():
    lines = run("--list").splitlines()[::2]
    return {line.split()[1]: line.split()[0] for line in lines}


cells = states()
assert len(cells) > 100 and set(cells.values()) == {"-"}, cells
for row in ("paper", "paper_simulator", "simulator", "randomised", "best", "any_rig", "planner", "baseline"):
    ours = row in ("best", "any_rig", "planner", "baseline")
    for variant in ("bare", "decorated") + (("identified", "identified_decorated") if ours else ()):
        for task in ("centre", "point", "square"):
            assert f"transfer/{row}/{variant}/{task}/1" in cells, (row, variant, task)
    for task in ("centre", "point", "square"):
        over_all = row in ("paper", "paper_simulator", "baseline") and task != "square"
        assert (f"transfer/{row}/whole_dish/{task}/1" in cells) == over_all, (row, task)
listed = subprocess.run(bench("--list"), capture_output=True, text=True, check=True)
assert "next:" not in listed.stderr, "there is no page yet"
commands = listed.stdout.splitlines()[1::2]
seeds = [line.split("--seed ")[1].split()[0] for line in commands if line.split()[1] != "deploy"]
assert len(set(seeds)) == len(seeds), "runs share a seed"

# One cell, and what it needs.
run("--only", "transfer/baseline/bare/point/1")
assert [cell for cell, state in states().items() if state == "done"] == ["transfer/baseline/bare/point/1"]
summary = json.loads((out / "cells/transfer/baseline/bare/point/1/summary.json").read_text())
assert summary["baseline"]["point"]["n_trials"] == 1, summary

# Killed without a word in the middle: the children stop by themselves, and the next run goes on.
running = subprocess.Popen(bench("--only", "dynamics/paper/1"), stderr=subprocess.DEVNULL)
deadline = time.time() + 120
while not (out / "cells/data/paper/config.json").exists():
    assert time.time() < deadline, "nothing was begun"
    time.sleep(0.05)
running.send_signal(signal.SIGKILL)
running.wait()
deadline = time.time() + 60
while True:
    again = subprocess.run(bench("--only", "dynamics/paper/1"), capture_output=True, text=True)
    if again.returncode == 0:
        break
    assert "another process" in again.stderr and time.time() < deadline, again.stderr
    time.sleep(0.5)
assert states()["data/paper"] == "done" and states()["dynamics/paper/1"] == "done"

# Asked to stop: says so, and what was done stays.
running = subprocess.Popen(bench("--only", "policy/paper/centre/1"), stderr=subprocess.PIPE, text=True)
begun = out / "cells/policy/paper/centre/1/config.json"
while running.poll() is None and not begun.exists():
    time.sleep(0.05)
running.send_signal(signal.SIGTERM)
said = running.communicate(timeout=60)[1]
assert running.returncode in (0, 130), said
run("--only", "policy/paper/centre/1")
state = json.loads((out / "cells/policy/paper/centre/1/run.json").read_text())
assert state["finished"] and state["verb"] == "train-policy", state
assert not (out / "cells/policy/paper/centre/1/training").exists(), "hundreds of replay buffers would fill a disk"
told = subprocess.run([program, "status", str(out)], capture_output=True, text=True).stdout
assert "policy/paper/centre/1" in told and "waiting" in told and "runs are finished" in told, told

# How fast trainings are alone: one at a time, on one thread, kept beside the others.
run("--pace", "--only", "pace/best/centre")
pace = json.loads((out / "results/pace/records/pace/best/centre.json").read_text())
assert pace["machine"]["threads"] == 1 and pace["policy"]["other_processor_seconds"] >= 0.0, pace
assert "pool = wide" in (out / "pace/build.ninja").read_text() and "--threads' '1'" in (out / "pace/build.ninja").read_text()
refused = subprocess.run(bench("--pace", "--engine", "slurm"), capture_output=True, text=True)
assert refused.returncode == 2 and "--pace is measured on this machine" in refused.stderr, refused.stderr

# A report of what is there, whenever one is wanted.
said = run("--report")
assert "proportional pull | bare" in said and "not run yet" in said, said
report = json.loads((out / "report.json").read_text())
assert report["transfer"]["baseline"]["bare"]["point"]["n_trials"] == 1, report
assert report["paces"]["best"]["centre"]["steps_per_s"] > 0.0, report["paces"]

# What it says of the trials is what they were.
run("--only", "transfer/baseline/whole_dish/point/1")
discs = {variant: json.loads((out / f"cells/transfer/baseline/{variant}/point/1/config.json").read_text())["trials"] for variant in ("bare", "whole_dish")}
for told in ("Trials start within {bare[start_radius]:g} dish radii of the middle, and points lie within {bare[goal_radius]:g}:",
             "Over the whole dish, starts lie within {whole_dish[start_radius]:g}, wherever the needle fits, and points within {whole_dish[goal_radius]:g},"):
    assert told.format(**discs) in said, (told, discs)
trained = json.loads((source / "configs/paper/policy_target.json").read_text())["task"]
assert all(discs["whole_dish"][radius] == trained[radius] for radius in ("start_radius", "goal_radius")), (trained, discs)
around = json.loads((source / "configs/best/deploy.json").read_text())["decorators"]
assert (f"no current within {1e3 * around['hold_radius_m']:g} mm of the target, and a path's target is fed {around['lead_s']:g} s ahead") in said, around
run("--report")

# What was kept is enough for the page, and for another machine to go on: nothing that is finished is run again there.
page = pathlib.Path(scratch.name) / "page"
drawn = subprocess.run([program, "bench", "paper", "--report", "--from", str(out / "results"), "--out", str(page)], capture_output=True, text=True)
assert drawn.returncode == 0, drawn.stderr
assert (page / "report.json").read_bytes() == (out / "report.json").read_bytes()
elsewhere = pathlib.Path(scratch.name) / "elsewhere"
other = [program, "bench", "paper", "--config", str(scale), "--out", str(elsewhere), "--results", str(out / "results")]
subprocess.run([*other, "--only", "mix/3/1"], check=True, capture_output=True)
assert not (elsewhere / "cells/transfer").exists() or not list((elsewhere / "cells/transfer").rglob("run.json"))
assert json.loads((elsewhere / "cells/dynamics/paper/1/manifest.json").read_text()) == json.loads(
    (out / "cells/dynamics/paper/1/manifest.json").read_text()), "made again, though its weights were kept"
assert "mix/3/1" in [cell for cell, state in states().items() if state == "done"], "what was run elsewhere counts here"

# What is kept for everybody stays small.
kept = sum(file.stat().st_size for file in (source / "results/paper").rglob("*") if file.is_file())
assert 0 < kept <= 40e6, f"results/paper holds {kept / 1e6:.1f} MB"

# The same folder does not take cells of another size.
scale.write_text(scale.read_text().replace('"trials": 1', '"trials": 2'))
other = subprocess.run(bench(), capture_output=True, text=True)
assert other.returncode == 2 and "trials = 2 (there: 1)" in other.stderr, other.stderr

print("bench paper: listed, run apart, killed and resumed")
