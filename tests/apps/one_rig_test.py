"""A rig with another dish, other coils and another needle, from one file: every step is seen to use it.
usage: one_rig_test.py LODESTONE SOURCE"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)

    def run(*arguments, code=0):
        made = subprocess.run([program, *map(str, arguments), "--no-reexec"], capture_output=True, text=True)
        assert made.returncode == code, f"{arguments}\n{made.stdout}\n{made.stderr}"
        return made.stdout + made.stderr

    mine = {
        "coils": {"turns": 480, "centre_distance_m": 0.072, "inner_radius_m": 0.03, "outer_radius_m": 0.045,
                  "length_m": 0.05, "max_current_A": 11.0, "resistance_20C_ohm": [1.5, 1.5, 1.5, 1.5]},
        "needle": {"length_m": 0.018, "chain_m": 0.016, "moment_A_m2": 2.1e-3},
        "dish": {"radius_m": 0.035},
    }
    rig = folder / "rig.json"
    rig.write_text(json.dumps(mine))
    quick = ["--rig", rig, "--sensor", "simulated", "--seed", 3]

    # What would run is printed with where each value comes from.
    rows = {line.split()[0]: line for line in
            run("config", "--print", "deploy", *quick, "--set", "trials.count=2").splitlines()}
    assert "rig.json" in rows["rig.dish.radius_m"] and "0.035" in rows["rig.dish.radius_m"]
    assert "--sensor" in rows["sensor.kind"] and "--set trials.count" in rows["trials.count"]
    assert " default " in rows["rig.supply_V"]
    # The description is the only place of these figures.
    for verb in ("collect", "deploy", "train-policy", "import", "calibrate", "train-segmenter"):
        for line in run("config", "--print", verb).splitlines()[1:]:
            key, value = line.split()[:2]
            if not key.startswith("rig."):
                assert not any(word in key for word in ("dish_radius", "length_scale", "resistance", "turns")), line
                assert value not in ("0.0425", "0.0235", "1.9", "0.00169"), line
    # The file that is shipped says what is taken without one.
    shipped = json.loads((source / "configs/rigs/paper.json").read_text())
    printed = {line.split()[0]: line.split()[1] for line in run("config", "--print", "collect").splitlines()[1:]}
    flat = {}

    def flatten(part, path):
        for key, value in part.items():
            flatten(value, f"{path}{key}.") if isinstance(value, dict) else flat.update({path + key: value})

    flatten(shipped, "rig.")
    for key, value in flat.items():
        assert json.loads(printed[key]) == value, (key, value, printed[key])
    assert {key for key in printed if key.startswith("rig.")} == set(flat)

    # Every verb takes a rig that is shipped, train-policy all of them, how they are reached included; and a wrong one is a wrong one.
    for preset in sorted((source / "configs/rigs").glob("*.json")):
        run("config", "--print", "train-policy", "--rig", preset)
    for verb in ("collect", "deploy", "train-dynamics", "import", "calibrate", "train-segmenter"):
        run("config", "--print", verb, "--rig", preset)
    wrong = folder / "wrong.json"
    wrong.write_text(json.dumps({**mine, "serial": {"baud": 12}}))
    text = run("train-policy", "--rig", wrong, "--set", "simulator=physics", "--out", folder / "none", code=2)
    assert "serial.baud = 12" in text and not (folder / "none").exists(), text

    run("collect", *quick, "--set", "transitions=400", "--out", folder / "collect")
    run("train-dynamics", "--set", f"data={folder}/collect/transitions.h5", "--set", "model.form=delta", "--set",
        "model.batch_norm=false", "--set", "training.epochs=3", "--out", folder / "dynamics")
    text = run("train-dynamics", "--rig", source / "configs/rigs/paper.json", "--set",
               f"data={folder}/collect/transitions.h5", "--out", folder / "other", code=1)
    assert "other figures" in text, text
    learned = json.loads((folder / "dynamics/checkpoint/manifest.json").read_text())["facts"]["dataset"]
    assert learned["workspace_radius_m"] == 0.035 and learned["action_scale"] == 11.0, learned
    assert learned["rig"]["coils"]["turns"] == 480 and learned["rig"]["needle"]["length_m"] == 0.018, learned["rig"]

    few = ["--set", "training.env_steps=600", "--set", "training.environments=8", "--set", "training.warm_up_steps=100",
           "--set", "training.buffer_size=600", "--set", "training.evaluate_every=300", "--set",
           "training.evaluation_episodes=8", "--set", "td3.hidden=[16,16]", "--set", "td3.batch_size=32"]
    text = run("train-policy", "--rig", source / "configs/rigs/paper.json", "--set", f"dynamics={folder}/dynamics/checkpoint", *few,
               "--out", folder / "other", code=1)
    assert "other figures" in text and not (folder / "other").exists(), text
    run("train-policy", "--rig", rig, "--set", f"dynamics={folder}/dynamics/checkpoint", *few, "--out", folder / "policy")
    run("train-policy", "--rig", rig, "--set", "simulator=physics", *few, "--out", folder / "plain")
    for trained in ("policy", "plain"):
        facts = json.loads((folder / trained / "checkpoint/manifest.json").read_text())["facts"]
        assert facts["action"]["scale"] == 11.0 and facts["encoder"]["length_scale_m"] == 0.035, facts
        assert facts["rig"]["dish"]["radius_m"] == 0.035, facts

    text = run("deploy", *quick, "--policy", folder / "policy/checkpoint", "--task", "point", "--trials", 3,
               "--out", folder / "deploy")
    assert "other figures" not in text, text
    starts = []
    for trial in json.loads((folder / "deploy/trials.json").read_text()):
        starts.append(math.hypot(*trial["start"][:2]) / 1e3)
    assert max(starts) <= 0.82 * 0.035 + 1e-9, starts
    # Deployed on another rig, it says what differs; a rig that takes less refuses.
    text = run("deploy", "--sensor", "simulated", "--policy", folder / "policy/checkpoint", "--task", "point",
               "--trials", 1, "--out", folder / "elsewhere")
    assert "other figures of: coils, needle, dish" in text, text
    text = run("deploy", *quick, "--set", "rig.coils.max_current_A=5", "--policy", folder / "policy/checkpoint",
               "--out", folder / "weak", code=2)
    assert "rig.coils.max_current_A" in text, text

    # The baseline knows these coils: it commands the field of this rig, not of the paper's.
    drives = []
    for name, options in (("here", ["--rig", rig]), ("paper", [])):
        run("deploy", *options, "--sensor", "simulated", "--deviation", "none", "--controller", "baseline", "--task",
            "point", "--target-mm", "10,0", "--trials", 1, "--set", "trials.start_radius=0", "--out", folder / name)
        with open(folder / name / "trajectories.csv") as file:
            header = file.readline().strip().split(",")
            row = dict(zip(header, file.readline().strip().split(",")))
        drives.append([float(row[key]) for key in header if key.startswith("current")])
    assert drives[0] != drives[1], drives
    assert max(map(abs, drives[0])) <= 11.0, drives
