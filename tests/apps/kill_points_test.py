"""A run that is killed, or whose disk fails, at any call that changes a file ends where an undisturbed one ends."""
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

from soak import sample, told

program, source, failing_disk = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
KINDS = {"kill": 3, "short": 1, "EIO": 1, "ENOSPC": 1}  # how many points of each a sample takes


def start(arguments, folder, at=0, fault="", count="", option="--out", largest_file=None):
    disk = {"LD_PRELOAD": failing_disk, "LODESTONE_DISK_FOLDER": str(folder), "LODESTONE_DISK_AT": str(at),
            "LODESTONE_DISK_FAULT": fault, "LODESTONE_DISK_COUNT": str(count)} if count or fault else {}
    return subprocess.run([program, *map(str, arguments), option, str(folder)], env={**os.environ, **disk},
                          capture_output=True, text=True, timeout=300,
                          preexec_fn=largest_file and (lambda: resource.setrlimit(resource.RLIMIT_FSIZE, [largest_file] * 2)))


def content(folder, results):
    """Bytes of the files; of a checkpoint, the hashes of its tensors (its manifest names times, too)."""
    return {result: json.loads((folder / result).read_text())["files"] if result.endswith("manifest.json")
            else (folder / result).read_bytes() for result in results}


def goes_on(arguments, folder):
    """What a user does next."""
    return start([*arguments, "--resume"], folder)


def sweep(name, arguments, results, exit_code=0):
    """Every point in a soak, a few of each kind otherwise."""
    root = pathlib.Path(tempfile.mkdtemp())
    clean = start(arguments, root / "clean", count=root / "count")
    assert clean.returncode == exit_code, clean.stderr
    expected = content(root / "clean", results)
    points = int((root / "count").read_text())
    assert points >= 10, f"{name}: only {points} calls were seen"
    tried = 0
    for fault, few in KINDS.items():
        for at in sample(range(1, points + 1), few):
            folder, what = root / "run", f"{name}, {fault} at call {at} of {points}"
            made = start(arguments, folder, at, fault)
            allowed = {"kill": (-9, exit_code), "short": (exit_code,), "EIO": (0, 1), "ENOSPC": (0, 1)}[fault]
            assert made.returncode in allowed, f"{what}: exit {made.returncode}\n{made.stderr[-2000:]}"
            if made.returncode != 0:
                made = goes_on(arguments, folder)
                assert made.returncode in (0, exit_code), f"{what}, then --resume: exit {made.returncode}\n{made.stderr[-2000:]}"
            found = content(folder, results)
            for result in results:
                assert found[result] == expected[result], f"{what}: {result} differs"
            shutil.rmtree(folder)
            tried += 1
    shutil.rmtree(root)
    told(tried, f"kill points and disk faults of {name}, of {points} calls")


def sweep_sizes(name, arguments, results):
    """A run whose files may not grow beyond a size stops with a word, leaves no part of a file, and goes on."""
    root = pathlib.Path(tempfile.mkdtemp())
    assert start(arguments, root / "clean").returncode == 0
    expected = content(root / "clean", results)
    largest = max(file.stat().st_size for file in (root / "clean").rglob("*"))
    tried = 0
    for size in sample(range(1000, largest, max(1, largest // 60)), 3):
        folder, what = root / "run", f"{name}, files up to {size} bytes"
        made = start(arguments, folder, largest_file=size)
        assert made.returncode == 1 and "File too large" in made.stderr, f"{what}: exit {made.returncode}\n{made.stderr[-2000:]}"
        parts = [str(file) for file in folder.rglob("*") if ".tmp" in file.name or ".part" in file.name]
        assert not parts, f"{what}: left {parts}"
        made = goes_on(arguments, folder)
        assert made.returncode == 0 and content(folder, results) == expected, f"{what}, then --resume: exit {made.returncode}"
        shutil.rmtree(folder)
        tried += 1
    shutil.rmtree(root)
    told(tried, f"limits on the size of a file of {name}")


def sweep_plan(results):
    """Every cell is killed or fails at its n-th call, each a process of its own; the same command goes on."""
    root = pathlib.Path(tempfile.mkdtemp())
    plan = root / "plan.json"
    plan.write_text(json.dumps({"cells": [
        {"id": "collect", "verb": "collect", "config": "quickstart/collect.json", "settings": settings(collect)},
        {"id": "dynamics", "verb": "train-dynamics", "config": "quickstart/dynamics.json",
         "settings": ["data={collect}/transitions.h5", *settings(dynamics)]}]}))
    arguments = ("plan", "run", plan, "--threads", "1")
    clean = start(arguments, root / "clean")
    assert clean.returncode == 0, clean.stderr
    expected = content(root / "clean", results)
    tried = 0
    for fault in ("kill", "ENOSPC"):
        for at in sample(range(1, 80), 2):
            folder, what = root / "run", f"plan, {fault} at call {at} of each cell"
            start(arguments, folder, at, fault)
            for _ in range(3):  # a cell that is killed once ends; the next one may be killed, too
                made = start(arguments, folder)
            assert made.returncode == 0, f"{what}, again: exit {made.returncode}\n{made.stderr[-2000:]}"
            assert content(folder, results) == expected, f"{what}: results differ"
            shutil.rmtree(folder)
            tried += 1
    shutil.rmtree(root)
    told(tried, "kill points and disk faults of a plan's cells")


def sweep_report():
    """A report takes a second and is not gone on with: there is the old page, the new one or none, and no part of one."""
    root = pathlib.Path(tempfile.mkdtemp())
    assert start(deploy, root / "run/deploy").returncode == 0
    page = root / "run/report.html"
    assert start(("report",), root / "run", count=root / "count", option="--run").returncode == 0
    before = page.read_bytes()
    points = int((root / "count").read_text())
    tried = 0
    for fault, few in KINDS.items():
        for at in sample(range(1, points + 1), few):
            for old in (True, False):
                page.unlink(missing_ok=True)
                if old:
                    page.write_bytes(before)
                made = start(("report",), root / "run", at, fault, option="--run")
                assert made.returncode in (-9, 0, 1), f"report, {fault} at call {at}: exit {made.returncode}\n{made.stderr}"
                whole_page = page.exists() and page.read_text().rstrip().endswith("</html>")
                assert whole_page or (not old and made.returncode != 0 and not page.exists()), f"report, {fault} at call {at}: no whole page"
                tried += 1
    shutil.rmtree(root)
    told(tried, f"kill points and disk faults of report, of {points} calls")


def settings(arguments):
    return [value for option, value in zip(arguments, arguments[1:]) if option == "--set"]


policy = ("train-policy", "--config", source / "configs/quickstart/policy.json", "--set",
          f"dynamics={source / 'models/dynamics_best'}", "--set", "training.env_steps=6000", "--set",
          "training.warm_up_steps=1000", "--set", "training.evaluate_every=2000", "--set",
          "training.updates_per_step=0.005", "--set", "training.checkpoint_every_s=0.1")
deploy = ("deploy", "--models", source / "models/target", "--task", "point", "--trials", "3", "--seed", "4", "--sensor",
          "simulated")
collect = ("collect", "--mcap", "--sensor", "simulated", "--set", "transitions=120", "--set", "episode_steps=8", "--set", "sessions=2",
           "--set", "checkpoint_every_s=0")
dynamics = ("train-dynamics", "--set", "model.hidden=[16]", "--set", "training.epochs=4", "--set",
            "training.checkpoint_interval_s=0")
segmenter = ("train-segmenter", "--set", "training.samples=8", "--set", "training.validation_samples=8", "--set",
             "training.epochs=2", "--set", "training.batch_size=4", "--set", "segmenter.network.width=2", "--set",
             "segmenter.network.depth=1", "--set", "images.crop_px=32", "--set", "training.evaluation_samples=4")
qualify = ("qualify", "--virtual", "--sensor", "simulated", "--minutes", "0.5", "--set", "points.count=8", "--set", "points.seconds=1")
with tempfile.TemporaryDirectory() as recorded:
    data = pathlib.Path(recorded) / "collect"
    assert start(collect, data).returncode == 0
    sweep("collect", collect, ["transitions.h5", "coverage.json", "summary.json"])
    sweep("train-dynamics", (*dynamics, "--set", f"data={data / 'transitions.h5'}"), ["checkpoint/manifest.json"])
adapt = ("adapt", "--models", source / "models/dynamics_best", "--sensor", "simulated", "--pulses", "60", "--set",
         "episode_steps=6", "--set", "planner.candidates=8", "--set", "planner.iterations=1", "--set", "learning.epochs=1", "--set", "rehearsal=0",
         "--set", "checkpoint_every_s=0", "--set", "learning.checkpoint_interval_s=0")
sweep("adapt", adapt, ["driving/transitions.h5", "learning/checkpoint/manifest.json", "model/manifest.json"])
sweep("train-policy", policy, ["checkpoint/manifest.json"])
sweep("train-segmenter", segmenter, ["checkpoint/manifest.json"], exit_code=1)  # it sees no needle yet, and says so
sweep("qualify", qualify, ["qualify.json"])
logged = (*deploy, "--mcap")
logs = [f"logs/unseen-policy-point-{trial}.mcap" for trial in range(3)]
sweep("deploy", logged, ["summary.json", "trials.json", "trajectories.csv", *logs])
sweep_sizes("collect", collect, ["transitions.h5", "coverage.json", "summary.json"])
sweep_sizes("deploy", logged, ["summary.json", "trials.json", "trajectories.csv", *logs])
sweep_plan(["collect/transitions.h5", "dynamics/checkpoint/manifest.json"])
sweep_report()
