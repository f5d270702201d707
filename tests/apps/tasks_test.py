#!/usr/bin/env python3
"""bench tasks: every cell of a small one runs, the same command goes on, and all ends in one summary.

usage: tasks_test.py LODESTONE SOURCE_FOLDER
"""
import json
import pathlib
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
scratch = tempfile.TemporaryDirectory()
out = pathlib.Path(scratch.name) / "tasks"


def bench(*arguments, code=0, folder=out):
    done = subprocess.run([program, "bench", "tasks", "--config", str(source / "configs/bench/tasks_smoke.json"), "--models",
                           str(source / "models"), "--out", str(folder), *arguments], capture_output=True, text=True)
    assert done.returncode == code, (arguments, done.returncode, done.stdout, done.stderr)
    return done


def trials(cell):
    return json.loads((out / "cells" / cell / "trials.json").read_text())


# One cell first: a summary of what there is.
said = bench("--only", "obstacles/baseline/bare").stdout
assert "1 of " in said, said
assert json.loads((out / "summary.json").read_text())["cells"] == 1
past = trials("obstacles/baseline/bare")
assert [len(trial["obstacles_mm"]) for trial in past] == [3, 3], past
assert past[0]["obstacles_mm"] != past[1]["obstacles_mm"]
assert all(isinstance(trial["unreachable"], bool) for trial in past)

# All others, and the page.
said = bench().stdout
summary = json.loads((out / "summary.json").read_text())
assert summary["cells"] == summary["cells_planned"] > 30, summary["cells"]
assert summary["flow_speed_m_s"] > 0.0
drivers = [summary["pose"], summary["pose_wide"], summary["suture"], summary["obstacles"], *summary["tangent_path"].values(), *summary["flow"].values(),
           *summary["still"].values(), *summary["square_at_mm_s"].values()]
assert len(drivers) == 4 + 3 + 2 + 2 + 3, len(drivers)
for task in drivers:
    for around in ("bare", "decorated"):
        assert task["baseline"][around]["n_trials"] == 2, task
        assert len(task["baseline"][around]["success_interval"]) == 2
assert sorted(summary["tangent_path"]) == ["circle", "eight", "square"]
assert sorted(summary["square_at_mm_s"]) == ["2", "4", "6"]
assert "heading_rms_deg" in summary["tangent_path"]["eight"]["baseline"]["bare"]
assert "heading_error_deg" in summary["pose"]["baseline"]["bare"]
assert sorted(summary["pose"]["policy"]) == ["bare", "decorated"], summary["pose"]["policy"]
assert "stitches_made_share" in summary["suture"]["baseline"]["bare"], summary["suture"]
assert summary["flow"]["point"]["policy"]["bare"]["ratio_to_still"] > 0.0
assert "ratio_to_baseline" in summary["square_at_mm_s"]["6"]["policy"]["decorated"]
assert "flow point" in said and "square_at_mm_s 6" in said, said
assert "square-speed" in (out / "report.html").read_text()

# Another rig's file is the cells', not the bench's.
said = subprocess.run([program, "bench", "tasks", "--scale", "smoke", "--rig", str(source / "configs/rigs/six_planar.json"),
                       "--report", "--out", str(out.parent / "six")], capture_output=True, text=True)
assert said.returncode == 0 and "next: open" in said.stderr, said.stderr

# The oracle's row, beside what drove the same trials.
row = out.parent / "row"
for cell in ("still/point/baseline/bare", "still/point/oracle/bare"):
    bench("--controllers", "baseline,oracle", "--set", "oracle_trials=1", "--only", cell, folder=row)
summary = json.loads((row / "summary.json").read_text())["still"]["point"]
assert summary["oracle"]["bare"]["n_trials"] == 1 and summary["baseline"]["bare"]["n_trials"] == 2, summary
assert summary["baseline"]["bare"]["ratio_to_oracle"] > 0, summary

# It drives a virtual rig and nothing else.
oracle = ["bench", "oracle", "--task", "point", "--trials", "1", "--sensor", "simulated", "--on", "unseen", "--set",
          "trials.point_seconds=2", "--set", "planner.candidates=8", "--set", "planner.particles=2", "--out", str(out.parent / "oracle")]
for _ in range(2):  # the second goes on with what is finished
    said = subprocess.run([program, *oracle, "--resume"], capture_output=True, text=True)
    assert said.returncode == 0 and "oracle" in said.stdout, said.stdout + said.stderr
assert json.loads((out.parent / "oracle/trials.json").read_text())[0]["controller"] == "oracle"
for refused in (["deploy", "--controller", "oracle", "--out", "x"], [*oracle, "--set", "rig.backend=serial"],
                [*oracle, "--set", "controller=baseline"]):
    said = subprocess.run([program, *refused], capture_output=True, text=True)
    assert said.returncode == 2 and said.stderr.count("\n") == 1, said.stderr

# Every controller has the same rigs, starts, targets and obstacles, and so have tasks that go to the same places.
starts = [[trial["start"] for trial in trials(cell)] for cell in ("obstacles/baseline/bare", "obstacles/policy/decorated",
                                                                  "still/point/policy/bare", "flow/point/baseline/bare")]
assert all(each == starts[0] for each in starts), starts
assert [t["obstacles_mm"] for t in trials("obstacles/policy/decorated")] == [t["obstacles_mm"] for t in past]

# Nothing is run again, and the same folder takes no others.
before = (out / "summary.json").read_bytes()
bench("--resume")
assert (out / "summary.json").read_bytes() == before
bench("--report")
assert (out / "summary.json").read_bytes() == before
assert "trials = 3 (there: 2)" in bench("--trials", "3", code=2).stderr

print("bench tasks: run, gone on with, and summed up")
