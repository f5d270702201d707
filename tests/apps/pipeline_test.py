"""The whole way of a user, small: collect, train-dynamics, train-policy, deploy, report; killed and damaged on the way."""
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
configs = source / "configs" / "quickstart"


def run(*arguments, code=0, within=None):
    made = subprocess.run([program, *map(str, arguments)], cwd=within, capture_output=True, text=True)
    assert made.returncode == code, f"{arguments}: exit {made.returncode}\n{made.stdout}\n{made.stderr}"
    return made


def kill_after(signal_number, ready, *arguments):
    """Starts a verb, waits until `ready` exists, and sends the signal. Returns the exit code."""
    process = subprocess.Popen([program, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120
    while not ready.exists() and process.poll() is None:
        assert time.monotonic() < deadline, f"{ready} did not appear"
        time.sleep(0.02)
    process.send_signal(signal_number)
    return process.wait()


def flip_a_bit(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0x10
    path.write_bytes(content)


with tempfile.TemporaryDirectory() as name:
    root = pathlib.Path(name)
    collect, dynamics, policy = root / "collect", root / "dynamics", root / "policy"

    run("collect", "--config", configs / "collect.json", "--set", "transitions=800", "--out", collect)
    assert (collect / "coverage.json").exists()
    recorded = json.loads((collect / "summary.json").read_text())
    assert recorded["transitions"] == 800 and recorded["episodes"] >= 32, recorded
    assert abs(recorded["placements_per_1000"] - recorded["placements"] / 0.8) < 1e-9, recorded
    again = run("collect", "--config", configs / "collect.json", "--set", "transitions=800", "--out", collect, code=2)
    assert "--resume" in again.stderr, again.stderr

    train_dynamics = ("train-dynamics", "--config", configs / "dynamics.json", "--set",
                      f"data={collect / 'transitions.h5'}", "--set", "training.epochs=4")
    run(*train_dynamics, "--out", dynamics)
    evaluation = json.loads(run("evaluate", "dynamics", "--checkpoint", dynamics / "checkpoint", "--data",
                                collect / "transitions.h5").stdout)
    for key in ("position_rms_mm", "heading_rms_deg", "normalised_l2", "k_step", "k_step_heading_deg", "baselines", "n"):
        assert key in evaluation, key
    assert evaluation["n"] > 500 and evaluation["position_rms_mm"] > 0.0
    assert evaluation["baselines"].get("oracle") is None and evaluation.get("drawn_open_loop") is None
    ask = ("evaluate", "dynamics", "--checkpoint", dynamics / "checkpoint", "--split", "test", "--oracle", "2", "--draws", "3", "--data")
    asked = json.loads(run(*ask, collect / "transitions.h5").stdout)
    drawn = asked["drawn_open_loop"]
    assert drawn["draws"] == 3 and 0.0 < drawn["model"]["k_step"]["10"] and 0.0 < drawn["knn10"]["k_step_heading_deg"]["10"], drawn
    baselines = asked["baselines"]
    assert 0.0 < baselines["oracle"]["position_rms_mm"] < 0.5 * baselines["knn10"]["position_rms_mm"], baselines
    assert baselines["oracle_open_loop"]["k_step_heading_deg"]["1"] > 0.0, baselines
    shutil.copy(collect / "transitions.h5", root / "elsewhere.h5")
    lost = run(*ask, root / "elsewhere.h5", code=1)
    assert "config.json" in lost.stderr and "collect" in lost.stderr, lost.stderr

    # A run killed in the middle goes on, and ends where an undisturbed one ends.
    train_policy = ("train-policy", "--config", configs / "policy.json", "--set",
                    f"dynamics={dynamics / 'checkpoint'}", "--set", "training.env_steps=40000", "--set",
                    "training.warm_up_steps=1000", "--set", "training.evaluate_every=10000", "--set",
                    "training.updates_per_step=0.01", "--set", "training.checkpoint_every_s=0.05")
    run(*train_policy, "--out", policy)
    killed = root / "killed"
    assert kill_after(signal.SIGKILL, killed / "training" / "manifest.json", *train_policy, "--out", killed) == -9
    run(*train_policy, "--out", killed, "--resume")
    weights = [json.loads((folder / "checkpoint" / "manifest.json").read_text())["files"] for folder in (policy, killed)]
    assert weights[0] == weights[1], f"a resumed run differs: {weights}"
    steps = [json.loads(line)["step"] for line in (killed / "metrics.jsonl").read_text().splitlines()]
    assert steps == sorted(set(steps)), f"a curve repeats a step: {steps}"
    # A finished run trains on; other settings are refused by name; another verb's folder, too.
    longer = [text.replace("env_steps=40000", "env_steps=50000") for text in map(str, train_policy)]
    run(*longer, "--out", killed, "--resume")
    assert json.loads((killed / "result.json").read_text())["env_steps"] >= 50000
    other = run(*train_policy, "--set", "td3.discount=0.5", "--out", killed, "--resume", code=2).stderr
    assert "td3.discount = 0.5" in other and "seed" not in other, other
    assert "train-policy" in run(*train_dynamics, "--out", killed, "--resume", code=2).stderr
    told = run("status", killed).stdout
    assert "finished" in told and "train-policy" in told and "environment steps" in told, told
    stopped = root / "stopped"
    code = kill_after(signal.SIGINT, stopped / "training" / "manifest.json", *train_policy, "--out", stopped)
    assert code in (0, 130), code

    deploy = ("deploy", "--config", configs / "deploy.json", "--task", "all", "--trials", "2", "--on", "both",
              "--controller", "both", "--sensor", "simulated", "--set", "record.enabled=false")  # by camera: the released models, below
    run(*deploy, "--policy", policy / "checkpoint", "--out", root / "deploy")
    # Killed in the middle, it goes on with the trials that are left, and ends the same.
    cut = root / "cut"
    kill_after(signal.SIGKILL, cut / "summary.json", *deploy, "--policy", policy / "checkpoint", "--out", cut)
    run(*deploy, "--policy", policy / "checkpoint", "--out", cut, "--resume")
    for file in ("summary.json", "explored/trials.json", "unseen/trials.json", "trajectories.csv"):
        assert (cut / file).read_bytes() == (root / "deploy" / file).read_bytes(), f"{file} of a resumed deployment differs"
    found = run(*deploy, "--policy", policy / "checkpoint", "--out", cut, "--resume")
    assert "finished already" in found.stderr and "centre" in found.stdout, found
    of_deploy = json.loads((root / "deploy" / "summary.json").read_text())
    assert of_deploy["collect"]["transitions"] == 800 and of_deploy["policy"]["updates"] > 0, of_deploy.keys()
    assert of_deploy["dynamics"]["position_rms_mm"] > 0.0
    run("report", "--run", root, "--out", root / "report.html")
    summary = json.loads((root / "summary.json").read_text())
    for task in ("centre", "point", "square", "circle"):
        for key in ("mean_error_mm", "std_error_mm", "median_error_mm", "rms_error_mm", "success_rate", "n_trials"):
            assert key in summary[task], (task, key)
        assert summary[task]["n_trials"] == 2
    assert summary["dynamics"]["position_rms_mm"] > 0.0
    assert summary["policy"]["env_steps"] >= 40000 and summary["policy"]["updates"] > 0
    assert summary["policy"]["train_seconds"] > 0.0
    assert summary["collect"]["transitions"] == 800
    page = (root / "report.html").read_text()
    assert "<svg" in page and "http://" not in page.replace("http://www.w3.org", "")

    points = root / "points.csv"
    points.write_text("x_m,y_m\n0,0\n0.01,0.02\n")
    field = run("rig", "field", "--coil", "+x", "--points", points).stdout.splitlines()
    assert field[0] == "x_m,y_m,Bx_T_per_A,By_T_per_A,Bz_T_per_A" and len(field) == 3
    assert float(field[1].split(",")[2]) > 0.0, "positive current points towards the coil"

    speed = root / "speed"
    quick = ("--set", "runs=1", "--set", "run_s=0.01", "--set", "images=10", "--set", "td3_batch=32", "--set",
             "mbs_environments=1000")
    run("bench", "speed", *quick, "--out", speed)
    measured = json.loads((speed / "speed.json").read_text())
    for figure, key in (("sgemm", "median"), ("td3", "median"), ("td3", "fraction_of_peak"), ("mbs", "median"),
                        ("mbs", "fraction_of_peak"), ("rig", "median")):
        assert measured[figure]["all_threads"][key] > 0.0, (figure, key)
    assert measured["pose"]["p99_ms"] > 0.0 and measured["training_peak_mb"] > 0.0, measured
    assert measured["control"]["median_ms"] >= measured["pose"]["median_ms"]
    for preset in ("policy_centre", "policy_target"):
        fast = root / preset
        said = run("train-policy", "--config", source / "configs" / "fast" / f"{preset}.json", "--set",
                   f"dynamics={dynamics / 'checkpoint'}", "--set", "training.env_steps=12000", "--set",
                   "encoder.drive_gain=true", "--out", fast).stderr
        assert f"--policy {fast}/checkpoint --set dynamics={dynamics / 'checkpoint'}" in said, said
        result = json.loads((fast / "result.json").read_text())
        assert 0.0 < result["seconds_to_95_percent"] <= result["train_seconds"], result

    # Released models drive from a clean clone: by camera, on rigs drawn from the seed.
    released = root / "released"
    run("deploy", "--models", source / "models" / "target", "--task", "square", "--trials", "4", "--seed", "3", "--record", "--out", released)
    summary = json.loads((released / "summary.json").read_text())
    assert summary["square"]["n_trials"] == 4 and summary["square"]["mean_error_mm"] < 3.0, summary
    assert any(film.stat().st_size > 10000 for film in (released / "videos").iterdir()), "no film"
    planned = root / "planned"
    run("deploy", "--config", source / "configs" / "best" / "deploy.json", "--controller", "planner", "--set",
        f"dynamics={source / 'models' / 'dynamics_best'}", "--task", "point", "--trials", "4", "--sensor", "simulated",
        "--out", planned)
    summary = json.loads((planned / "summary.json").read_text())
    assert summary["point"]["mean_error_mm"] < 3.0 and summary["controller"] == "planner", summary

    # Damaged checkpoints are named, and nothing is driven with them.
    tensors = next((policy / "checkpoint").glob("*.safetensors"))
    good = tensors.read_bytes()
    flip_a_bit(tensors)
    assert tensors.name in run(*deploy, "--policy", policy / "checkpoint", "--out", root / "d1", code=1).stderr
    tensors.write_bytes(good[: len(good) // 2])
    assert tensors.name in run(*deploy, "--policy", policy / "checkpoint", "--out", root / "d2", code=1).stderr
    tensors.write_bytes(good)
    wrong = run(*deploy, "--policy", dynamics / "checkpoint", "--out", root / "d3", code=1).stderr
    assert "dynamics" in wrong and "policy" in wrong, wrong
    manifest = policy / "checkpoint" / "manifest.json"
    text = manifest.read_text()
    manifest.write_text(text.replace('"format": 1', '"format": 99'))
    assert "99" in run(*deploy, "--policy", policy / "checkpoint", "--out", root / "d4", code=1).stderr
    manifest.write_text(text)
    run(*deploy, "--policy", policy / "checkpoint", "--out", root / "d5")
print("the pipeline ran, resumed, and refused what was damaged")
