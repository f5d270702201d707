"""A sphere, from its preset: explored, learned, trained and driven without a heading, at a small scale.
usage: sphere_test.py LODESTONE SOURCE"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
rig = source / "configs/rigs/sphere.json"


def run(*arguments, code=0):
    made = subprocess.run([program, *map(str, arguments), "--no-reexec"], capture_output=True, text=True)
    assert made.returncode == code, f"{arguments}\n{made.stdout}\n{made.stderr}"
    return made.stdout + made.stderr


def facts_of(checkpoint):
    return json.loads((checkpoint / "manifest.json").read_text())["facts"]


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    run("collect", "--rig", rig, "--config", source / "configs/quickstart/collect.json", "--set", "transitions=2500", "--sensor",
        "simulated", "--out", folder / "collect")
    run("train-dynamics", "--config", source / "configs/quickstart/dynamics.json", "--set", f"data={folder}/collect/transitions.h5",
        "--set", "training.epochs=100", "--out", folder / "dynamics")
    assert facts_of(folder / "dynamics/checkpoint")["dataset"]["layout"] == "position"
    learned = json.loads((folder / "dynamics/evaluation.json").read_text())
    nothing_mm = learned["baselines"]["no_motion"]["position_rms_mm"]
    assert learned["position_rms_mm"] < 0.9 * nothing_mm, learned

    # Encoders ask for a heading in the preset, and leave it out.
    few = ["--set", "training.env_steps=600", "--set", "training.environments=8", "--set", "training.warm_up_steps=100",
           "--set", "training.buffer_size=600", "--set", "training.evaluate_every=300", "--set", "training.evaluation_episodes=8",
           "--set", "td3.hidden=[16,16]", "--set", "td3.batch_size=32"]
    policy = source / "configs/quickstart/policy.json"
    run("train-policy", "--config", policy, "--set", f"dynamics={folder}/dynamics/checkpoint", *few, "--out", folder / "policy")
    run("train-policy", "--config", policy, "--rig", rig, "--set", "simulator=physics", *few, "--out", folder / "plain")
    for trained in ("policy", "plain"):
        assert facts_of(folder / trained / "checkpoint")["encoder"]["heading"] == "none", trained
    text = run("train-policy", "--config", policy, "--rig", rig, "--set", "simulator=physics", "--set", "task.goal=pose", *few, "--out",
               folder / "posed", code=2)
    assert 'task.goal = "pose", but a sphere has no heading' in text, text

    common = ("deploy", "--rig", rig, "--sensor", "simulated", "--trials", 3, "--set", "trials.start_radius=0.4")
    run(*common, "--task", "centre", "--config", source / "configs/best/deploy_planner.json", "--set",
        f"dynamics={folder}/dynamics/checkpoint", "--out", folder / "planner")
    run(*common, "--task", "centre", "--controller", "baseline", "--out", folder / "baseline")
    run(*common, "--task", "point", "--policy", folder / "policy/checkpoint", "--controller", "policy", "--out", folder / "by_policy")
    for driven in ("planner", "baseline", "by_policy"):
        with (folder / driven / "trajectories.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert all(float(row["true_heading_rad"]) == 0.0 for row in rows), driven
        assert all(float(row["sensed_heading_rad"]) == 0.0 for row in rows if row["sensed"] == "1"), driven
    # Who knows where pulses take it brings it nearer to the centre than it was.
    trials = json.loads((folder / "planner/trials.json").read_text())
    starts_mm = [(trial["start"][0] ** 2 + trial["start"][1] ** 2) ** 0.5 for trial in trials]
    assert sum(trial["final_error_mm"] for trial in trials) < sum(starts_mm), trials
    run("report", "--run", folder / "planner")

    # What goes by a heading is refused in one line.
    for more, why in ((("--task", "pose", "--controller", "baseline"), "a sphere (rig.needle.shape) has no heading"),
                      (("--task", "point", "--policy", source / "models/target", "--controller", "policy"),
                       "the policy goes by a heading"),
                      (("--task", "point", "--set", f"dynamics={source}/models/dynamics_best", "--controller", "planner"),
                       "the simulator's states have a heading")):
        text = run("deploy", "--rig", rig, "--sensor", "simulated", *more, "--out", folder / "no", code=2)
        assert why in text and len(text.strip().splitlines()) == 1, text
    text = run("rig", "check", "--rig", rig, code=2)
    assert "rig.needle.shape = sphere" in text, text
