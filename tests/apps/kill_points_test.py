"""A run that is killed, or whose disk fails, at any call that changes a file ends where an undisturbed one ends."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from soak import sample, told

program, source, failing_disk = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
KINDS = {"kill": 6, "short": 2, "EIO": 2, "ENOSPC": 3}  # how many points of each a sample takes


def start(arguments, folder, at=0, fault="", count=""):
    disk = {"LD_PRELOAD": failing_disk, "LODESTONE_DISK_FOLDER": str(folder), "LODESTONE_DISK_AT": str(at),
            "LODESTONE_DISK_FAULT": fault, "LODESTONE_DISK_COUNT": str(count)} if count or fault else {}
    return subprocess.run([program, *map(str, arguments), "--out", str(folder)], env={**os.environ, **disk},
                          capture_output=True, text=True, timeout=120)


def content(folder, results):
    """Bytes of the files; of a checkpoint, the hashes of its tensors (its manifest names times, too)."""
    return {result: json.loads((folder / result).read_text())["files"] if result.endswith("manifest.json")
            else (folder / result).read_bytes() for result in results}


def goes_on(arguments, folder):
    """What a user does next: --resume; where nothing was begun yet, the same command again, as the message says."""
    made = start([*arguments, "--resume"], folder)
    if made.returncode == 2 and not any(folder.glob("run.json")):
        shutil.rmtree(folder, ignore_errors=True)
        made = start(arguments, folder)
    return made


def sweep(name, arguments, results):
    root = pathlib.Path(tempfile.mkdtemp())
    clean = start(arguments, root / "clean", count=root / "count")
    assert clean.returncode == 0, clean.stderr
    expected = content(root / "clean", results)
    points = int((root / "count").read_text())
    assert points >= 10, f"{name}: only {points} calls were seen"
    tried = 0
    for fault, few in KINDS.items():
        for at in sample(range(1, points + 1), few):
            folder, what = root / "run", f"{name}, {fault} at call {at} of {points}"
            made = start(arguments, folder, at, fault)
            allowed = {"kill": (-9, 0), "short": (0,), "EIO": (0, 1), "ENOSPC": (0, 1)}[fault]
            assert made.returncode in allowed, f"{what}: exit {made.returncode}\n{made.stderr[-2000:]}"
            if made.returncode != 0:
                made = goes_on(arguments, folder)
                assert made.returncode == 0, f"{what}, then --resume: exit {made.returncode}\n{made.stderr[-2000:]}"
            found = content(folder, results)
            for result in results:
                assert found[result] == expected[result], f"{what}: {result} differs"
            shutil.rmtree(folder)
            tried += 1
    shutil.rmtree(root)
    told(tried, f"kill points and disk faults of {name}, of {points} calls")


policy = ("train-policy", "--config", source / "configs/quickstart/policy.json", "--set",
          f"dynamics={source / 'models/dynamics_best'}", "--set", "training.env_steps=6000", "--set",
          "training.warm_up_steps=1000", "--set", "training.evaluate_every=2000", "--set",
          "training.updates_per_step=0.005", "--set", "training.checkpoint_every_s=0.1")
deploy = ("deploy", "--models", source / "models/target", "--task", "point", "--trials", "3", "--seed", "4", "--sensor",
          "simulated")
collect = ("collect", "--sensor", "simulated", "--set", "transitions=120", "--set", "episode_steps=8", "--set", "sessions=2",
           "--set", "checkpoint_every_s=0")
sweep("collect", collect, ["transitions.h5", "coverage.json"])
sweep("train-policy", policy, ["checkpoint/manifest.json"])
sweep("deploy", deploy, ["summary.json", "trials.json", "trajectories.csv"])
