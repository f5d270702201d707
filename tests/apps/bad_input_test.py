"""Bad input gives one clear line and exit code 2 (configuration) or 1 (data), and nothing is written.
usage: bad_input_test.py LODESTONE SOURCE [EVERY]     only about one in EVERY, drawn by the seed, but in a soak"""
import hashlib
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

import soak

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
every = 1 if soak.whole or len(sys.argv) < 4 else int(sys.argv[3])
draw = random.Random(soak.seed)
checked = 0
failures = []


def check(arguments, code, *expected):
    """Runs in an empty folder; the message must be one line that holds every expected text."""
    global checked
    if draw.randrange(every):
        return
    checked += 1
    with tempfile.TemporaryDirectory() as folder:
        made = subprocess.run([program, *arguments, "--no-reexec"], cwd=folder, capture_output=True, text=True, timeout=60,
                              env={**os.environ, "XDG_RUNTIME_DIR": tempfile.gettempdir()})  # else libwayland says a word
        lines = [line for line in made.stderr.splitlines() if line.strip()]
        what = f"lodestone {' '.join(argument[:200] for argument in arguments)}\n  exit {made.returncode}, stderr: {made.stderr!r}"
        if made.returncode != code:
            failures.append(f"{what}\n  expected exit {code}")
        if len(lines) != 1:
            failures.append(f"{what}\n  expected one line")
        for text in expected:
            if text not in made.stderr:
                failures.append(f"{what}\n  expected to read {text!r}")
        if os.listdir(folder):
            failures.append(f"{what}\n  wrote {os.listdir(folder)}")


check(["collect", "--set", "transitoins=5", "--out", "run"], 2, "transitoins", "did you mean transitions")
check(["collect", "--set", "transitions=many", "--out", "run"], 2, "transitions", '"many"', "whole number")
check(["collect", "--set", "transitions=-1", "--out", "run"], 2, "transitions = -1", "within")
check(["collect", "--config", "nowhere.json", "--out", "run"], 2, "nowhere.json", "does not exist")
check(["collect"], 2, "--out")
check(["train-dynamics", "--set", "data=missing.h5", "--out", "run"], 1, "missing.h5")
check(["train-dynamics", "--set", "model.form=magic", "--out", "run"], 2, "model.form", "paper, delta")
check(["train-policy", "--set", "dynamics=missing", "--out", "run"], 1, "missing")
check(["train-policy", "--set", "td3.discount=2", "--out", "run"], 2, "td3.discount = 2", "0 .. 1")
check(["deploy", "--policy", "missing", "--task", "centre", "--out", "run"], 1, "missing")
check(["import", "missing.csv", "--out", "run.h5"], 1, "missing.csv")
check(["evaluate", "dynamics", "--checkpoint", "missing", "--data", "missing.h5"], 1, "missing")
check(["evaluate", "segmenter", "--checkpoint", "missing"], 1, "missing")
check(["train-segmenter", "--set", "images.crop_px=100", "--out", "run"], 2, "images.crop_px = 100", "multiple of 32")
check(["train-segmenter", "--set", "scenes.glare=[0.5,0.1]", "--out", "run"], 2, "scenes.glare", "low <= high")
check(["train-segmenter", "--set", "frames.count=4", "--out", "run"], 2, "frames.count = 4", "8 .. 2000")
check(["train-segmenter", "--frames", "missing.avi", "--out", "run"], 1, "missing.avi")
check(["calibrate", "--film", "needle.avi", "--out", "run"], 2, "--film", "--rendered")
check(["collect", "--set", "sensor.segmenter=missing", "--out", "run"], 1, "missing")
check(["deploy", "--controller", "baseline", "--sensor", "simulated", "--record", "--out", "run"], 2, "record.enabled", "camera")
check(["calibrate", "--out", "run"], 2, "which camera", "--rendered")
check(["calibrate", "--camera", "missing.png", "--out", "run"], 1, "missing.png")
check(["calibrate", "--set", "rig.camera.kind=uvc", "--camera", "99", "--out", "run"], 1, "99")
check(["calibrate", "--rendered", "--check", "missing.json"], 2, "missing.json", "does not exist")
check(["colect", "--out", "run"], 2, "unknown verb colect", "collect")
check(["deploy", "--set", "rig.backend=cereal", "--out", "run"], 2, "--set rig.backend", "rig.backend", "serial")
check(["deploy", "--rig", "unsen", "--out", "run"], 2, "unsen", "does not exist")
check(["deploy", "--set", "rig.coil.turns=500", "--out", "run"], 2, "no longer a key", "coils")
check(["deploy", "--set", "decorators.stall_swing_deg=20", "--out", "run"], 2, "direction_dither_deg")
check(["deploy", "--deviation", "huge", "--out", "run"], 2, "--deviation", "none, lab, wide")
check(["collect", "--set", "rig.dish.radius_m=0.06", "--out", "run"], 2, "rig.dish.radius_m", "faces")
check(["deploy", "--set", "safety.max_temperature_C=1000", "--controller", "baseline", "--out", "run"], 2,
      "max_temperature_C", "155")
check(["rig", "check"], 2, "rig.serial.port")
check(["rig", "check", "--port", "/dev/ttyNOTHING"], 1, "no such port")
check(["bench", "hil"], 2, "bench emulation")
check(["bench", "emulation"], 2, "--out")
check(["calibrate", "coils", "--port", "/dev/ttyNOTHING"], 2, "--out")
check(["bench", "paper", "--scale", "huge"], 2, "smoke")
check(["bench", "paper", "--scale", "smoke", "--only", "nothing"], 2, "nothing", "--list")
check(["deploy", "--controller", "planner", "--sensor", "simulated", "--out", "run"], 2, "dynamics")
check(["deploy", "--controller", "planner", "--set", "planner.elites=5000", "--out", "run"], 2,
      "--set planner.elites: planner.elites = 5000 must not exceed candidates")
check(["bench", "rigs", "--controllers", "magic", "--out", "run"], 2, "\"magic\" is none of planner, policy, baseline, observer")
check(["bench", "rigs", "--decorated", "--controllers", "baseline", "--out", "run"], 2, "name a policy")
check(["bench", "rigs", "--controllers", "planner", "--sensor", "simulated", "--out", "run"], 2, "dynamics=DIR")
check(["bench", "tasks", "--tasks", "triangle", "--out", "run"], 2, "\"triangle\" is none of pose")
check(["bench", "tasks", "--controllers", "magic", "--out", "run"], 2, "\"magic\" is none of planner, policy, baseline")
check(["bench", "tasks", "--scale", "quick", "--out", "run"], 2, "must be smoke or full")
check(["bench", "tasks", "--only", "pose", "--out", "run"], 2, "there is no cell \"pose\"")
check(["deploy", "--controller", "baseline", "--task", "square", "--set", "trials.obstacles.count=3", "--sensor", "simulated", "--out", "run"],
      2, "trials.obstacles.count = 3", "point or pose")
check(["deploy", "--models", "missing", "--out", "run"], 2, "missing/deploy.json")
check(["collect", "--by", "policy", "--out", "run"], 2, "--policy")
check(["train-policy", "--set", "simulator=physics", "--set", "task.within=reachable", "--out", "run"], 2, "dynamics")
check(["train-policy", "--set", "simulator=physics", "--set", "replay.environments=1", "--out", "run"], 2, "recorded")
for setting, key in (("simulator=physics", "method"), ("training.hindsight=0.5", "training.hindsight"),
                     ("replay.environments=1", "replay.environments"), ("action.dead_band=0.1", "action.dead_band")):
    check(["train-policy", "--set", "method=model_gradient", "--set", setting, "--set", "recorded=x.h5",
           "--out", "run"], 2, key)
check(["train-policy", "--set", "simulator=physics", "--set", "task.goal=centre", "--set", "training.hindsight=0.5",
       "--set", "threads=1", "--out", "run"], 2, "training.hindsight")
check(["collect", "--by", "keyboard", "--set", "sessions=2", "--out", "run"], 2, "set sessions = 1")
for name in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"):
    os.environ.pop(name, None)
check(["collect", "--by", "keyboard", "--sensor", "simulated", "--out", "run"], 1, "no display", "--by explorer")
check(["collect", "--set", "rig.backend=serial", "--set", "rig.serial.port=/dev/ttyNOTHING", "--set",
       "explorer.self_reset=false", "--out", "run"], 1, "nobody can be asked", "lodestone import")
check(["qualify", "--virtual"], 2, "--out")
check(["qualify", "--virtual", "--minutes", "0", "--out", "run"], 2, "minutes = 0")
check(["adapt", "--sensor", "simulated", "--out", "run"], 2, "--models", "--from-scratch")
check(["adapt", "--models", str(source / "models/dynamics_paper"), "--sensor", "simulated", "--out", "run"], 2, "predicts distributions")
check(["adapt", "--models", str(source / "models/dynamics_best"), "--pulses", "30", "--sensor", "simulated", "--out", "run"], 2,
      "8 episodes", "episode_steps")
check(["adapt", "--rollback", "--out", "nowhere"], 2, "nowhere", "no adaptation")
check(["deploy", "--models", str(source / "models/any_rig"), "--set", "dynamics=elsewhere", "--sensor", "simulated", "--out", "run"], 1,
      "elsewhere")
check(["bench", "rigs", "--adapt", "1000", "--controllers", "baseline", "--set", "dynamics=" + str(source / "models/dynamics_paper"),
       "--sensor", "simulated", "--out", "run"], 2, "predicts distributions")
check(["bench", "rigs", "--adapt", "30", "--models", str(source / "models"), "--sensor", "simulated", "--out", "run"], 2, "8 episodes")
check(["bench", "rigs", "--adapt", "many", "--models", str(source / "models"), "--sensor", "simulated", "--out", "run"], 2, "whole numbers")
check(["bench", "emulation", "--set", "dynamics=elsewhere", "--out", "run"], 1, "elsewhere")
check(["report", "--run", "nope"], 2, "nope", "no such folder")
check(["report", "--run", "."], 2, "holds no run", "collect")
check(["deploy", "--controller", "baseline", "--sensor", "simulated", "--task", "point", "--target-mm", "50,0", "--out", "run"], 2,
      "target_mm", "outside the dish", "42.5")
target = str(source / "models/target")
check(["export", "--to", "policy.onnx"], 2, "export takes one of", "--policy")
check(["export", "--policy", target], 2, "--to")
check(["export", "--policy", target, "--to", "policy.onyx"], 2, "--to policy.onyx", ".onnx, .h, .pt")
check(["export", "--policy", target, "--to", target + "/deploy.json"], 2, "deploy.json", "its ending", ".onnx")
check(["export", "--policy", "missing", "--to", "policy.onnx"], 1, "missing")
check(["export", "--policy", str(source / "models/segmenter"), "--to", "policy.onnx"], 1, "segmenter", "policy")
check(["config", "--print", "nothing"], 2, "nothing", "collect")


def resealed(folder, change):
    """A copy of the released policy whose manifest is changed and sealed again."""
    policy = pathlib.Path(folder) / "policy"
    shutil.rmtree(policy, ignore_errors=True)
    shutil.copytree(source / "models/target", policy)
    policy.chmod(0o755)
    manifest = json.loads((policy / "manifest.json").read_text())
    change(manifest)
    del manifest["sha256"]
    text = json.dumps(manifest, separators=(",", ":"), ensure_ascii=False)
    manifest["sha256"] = hashlib.sha256(text.encode()).hexdigest()
    (policy / "manifest.json").unlink()
    (policy / "manifest.json").write_text(json.dumps(manifest, ensure_ascii=False))
    return policy


# What no program should choke on: too deep, too large, too long, endless, no number, no file.
with tempfile.TemporaryDirectory() as folder:
    place = pathlib.Path(folder)

    def written(name, text):
        (place / name).write_text(text)
        return str(place / name)

    deep = "[" * 100_000
    check(["collect", "--config", written("deep.json", deep), "--out", "run"], 2, "deep.json:1:65", "nested deeper than 64")
    check(["collect", "--config", written("large.json", '{"seed": 1e999}'), "--out", "run"], 2, "large.json:1:", "1e999 is too large")
    check(["collect", "--config", written("twice.json", '{"seed": 1,\n "seed": 2}'), "--out", "run"], 2, "twice.json:2:", '"seed" is given twice')
    check(["collect", "--set", "seed=18446744073709551615", "--out", "run"], 2, "whole number of at most")
    check(["collect", "--set", "transitions=" + deep, "--out", "run"], 2, "[" * 199 + "... must be")
    check(["collect", "--set", "a" + ".a" * 50_000 + "=1", "--out", "run"], 2, "more than 32 steps")
    check(["collect", "--set", "transitions=\x1b[2J\n", "--out", "run"], 2, "\\u001b[2J\\n")
    check(["collect", "--set", "rig.serial.port=\udcff", "--out", "run"], 2, "argument 3 (rig.serial.port=\\xff) is no UTF-8")
    check(["collect", "--set", "\x1b[2J=1", "--out", "run"], 2, "\\x1b[2J")
    check(["collect", "--seed", "many", "--out", "run"], 2, "--seed", "many")
    for text, *words in (('{"task": "triangle"}', "task = ", "must be one of"), ('{"task": "path"}', "path is missing"), ("{", "task.json:1:"),
                         ('{"task": "square", "side": 3}', "unknown key side = 3", "did you mean side_m?"),
                         ('{"task": "square", "heading": "sideways"}', "trials.path_heading = ", "one of none, tangent"),
                         ('{"task": "square", "heading": "column"}', "trials.path_heading = ", "x_m,y_m,heading_rad")):
        check(["deploy", "--controller", "baseline", "--sensor", "simulated", "--task", written("task.json", text), "--out", "run"], 2, *words)
    os.mkfifo(place / "pipe")
    for path in ("pipe", "/dev/zero", "."):
        path = str(place / path)
        check(["collect", "--config", path, "--out", "run"], 2, "not a file")
        check(["train-dynamics", "--set", f"data={path}", "--out", "run"], 1, "not a file")
        check(["calibrate", "--rendered", "--check", path], 2, "not a file")
        for part in ("actor.safetensors", "manifest.json"):
            policy = resealed(folder, lambda manifest: None)
            (policy / part).unlink()
            (policy / part).symlink_to(path)
            check(["deploy", "--policy", str(policy), "--sensor", "simulated", "--out", "run"], 1, part, "not a file")
    os.symlink("/dev/zero", place / "zero.csv")
    check(["import", str(place / "zero.csv"), "--out", "run.h5"], 1, "zero.csv", "not a file")
    policy = resealed(folder, lambda manifest: (manifest["facts"]["action"].update(unit="percent"),
                                                manifest["facts"]["rig"].update(full_drive_A=0)))
    check(["export", "--policy", str(policy), "--to", "policy.onnx"], 2, str(policy), "per cent", "full_drive_A")
    check(["export", "--policy", target, "--to", written("there.onnx", "")], 2, "there.onnx exists already", "--force")
    for hidden in ([-1], [0], [1e12], [8] * 17):
        policy = resealed(folder, lambda manifest: manifest["facts"].update(hidden=hidden))
        check(["deploy", "--policy", str(policy), "--sensor", "simulated", "--out", "run"], 1, str(policy), "hidden = ")
    odd = "t,X_mm,Y_mm,A,B,C,D\n" + "".join(f"{0.3 * i},{i % 20},{-i % 20},5,0,0,{i % 3}\n" for i in range(60))
    log = written("odd.csv", odd)

    def mapped(units="time=s,currents=A", columns="time=t,x=X,y=Y,currents=A|B|C|D"):
        return ["--map", columns, "--units", units, "--out", "run.h5"]

    check(["import", log, *mapped(), "--page", "run.h5"], 2, "the page's name, too")
    check(["import", log, "--page", "a.html", "--out", "run.h5"], 2, "--page", "--map")
    check(["import", log, "--map", "time=t,x=X,y=Y", "--out", "run.h5"], 2, "--map: currents is missing")
    check(["import", log, "--map", "tmie=t", "--out", "run.h5"], 2, "did you mean time?")
    check(["import", log, *mapped(columns="time=t,x=X,y=Yy,currents=A|B|C|D")], 1, "odd.csv:1", "\"Yy\" (y) is not in the header")
    check(["import", log, *mapped("currents=A")], 1, "\"t\" (time) has no unit", "--units time=UNIT")
    check(["import", log, *mapped(), "--rig", str(source / "configs/rigs/six_planar.json")], 2, "rig.drive.kind = ", "import reads recordings of opposed_pairs")
    check(["import", log, *mapped(), "--set", "map.plausible=false"], 2, "map.plausible", "plausible, for every layout")
    check(["import", log, *mapped("time=h")], 2, "h of time is none of s, ms, us, min")
    check(["import", log, *mapped(), "--set", "map.separator=tab"], 1, "one column only", "map.separator")
    check(["import", log, *mapped(), "--set", "map.decimal=comma"], 1, "odd.csv:2: column 1 (t)", "decimal comma")
    check(["import", log, *mapped("time=ms,currents=A")], 1, "unit of time")
    check(["import", log, *mapped("time=s,x=m,y=m,currents=A")], 1, "outside the dish of 42.5 mm", "correct columns or units")
    check(["import", log, *mapped("time=s,currents=mA")], 1, "no current is above", "correct columns or units")
    check(["import", log, *mapped("time=s,x=px,y=px,currents=A")], 1, "--pixel-m", "--calibration")
    check(["import", log, *mapped(), "--pixel-m", "1e-4"], 1, "pixels have no use")
    check(["import", log, *mapped(), "--pixel-m", "1e-4", "--calibration", "c.json"], 2, "map.pixel_m")
    check(["import", log, *mapped("time=s,x=px,y=px,currents=A"), "--calibration", "missing.json"], 2, "missing.json")
    back = written("back.csv", odd.replace("\n3.0,", "\n0.3,"))
    check(["import", back, *mapped()], 1, "back.csv:12: column 1 (t)", "later than the row before")
    check(["import", written("commas.csv", odd.replace(".", ",")), *mapped()], 1, "commas.csv:", "need another separator")
    check(["import", written("both.csv", odd.replace(",5,0,", ",5,2,")), *mapped()], 1, "both.csv:2: column 5 (B)", "map.opposite_currents=net")
    check(["import", written("below.csv", odd.replace(",5,0,", ",-5,0,")), *mapped()], 1, "below.csv:2: column 4 (A)", "map.negative_current=opposite")
    check(["export", "--data", log, "--to", "minari:d"], 1, "odd.csv:1")
    good = written("good.csv", "coil,drive_percent,x_before_mm,y_before_mm,x_after_mm,y_after_mm\n+x,40,1,0,1,0\n")
    check(["export", "--data", good, "--to", "minari:d", "--id", "no id"], 2, "\"no id\"", "[namespace/]name-v0")
    check(["export", "--data", good, "--to", "minari:d", "--task", "pose"], 2, "task.goal", "no heading")
    check(["export", "--data", good, "--to", "d.hdf5"], 2, "--data becomes minari:")
    check(["export", "--data", good, "--to", "minari:d", "--out", "x"], 2, "--to, not to --out")
    check(["import", written("sign.csv", "coil,drive_percent,x_before_mm,y_before_mm,x_after_mm,y_after_mm\n+x,40,+-1,0,1,0\n"),
           "--out", "run.h5"], 1, "sign.csv:2: column 3", '"+-1" must be a number')
    camera = {"method": "dish", "reprojection_rms_mm": 0.1, "reprojection_rms_px": 0.1, "width_px": 1280, "height_px": 1024,
              "focal_px": 2.0**31, "centre_px": [640, 512], "k1": 0, "k2": 0,
              "rotation": [[1, 0, 0], [0, -1, 0], [0, 0, -1]], "translation_m": [0, 0, 0.47]}
    check(["calibrate", "--rendered", "--check", written("far.json", json.dumps(camera))], 1, "far.json: focal_px", "1e+06")
    for name, text, *expected in (
            ("deploy/summary.json", '{"scored_by": 3}', "summary.json", "scored_by"),
            ("deploy/summary.json", deep, "summary.json:1:65", "deeper"),
            ("collect/coverage.json", '{"transitions": 1e300}', "coverage.json", "transitions"),
            ("collect/coverage.json", json.dumps(dict(transitions=1, cells=1, visited=1, fraction=1, evenness=1, workspace_radius_m=1e9,
                                                      position_cells=1, position_counts=[1], heading_counts=[], drive_counts=[])),
             "coverage.json", "workspace_radius_m")):
        run = place / "odd"
        shutil.rmtree(run, ignore_errors=True)
        (run / name).parent.mkdir(parents=True)
        (run / name).write_text(text)
        check(["report", "--run", str(run)], 1, *expected)

    run = place / "fair"  # what the report does not need may be anything
    (run / "deploy").mkdir(parents=True)
    (run / "deploy/summary.json").write_text("{}")
    (run / "deploy/config.json").write_text('{"on_rig": 3, "transitions": []}')
    made = subprocess.run([program, "report", "--run", str(run), "--no-reexec"], capture_output=True, text=True)
    if made.returncode != 0:
        failures.append(f"report of a run with an odd configuration: {made.returncode} {made.stderr!r}")

for verb in ("collect", "train-dynamics", "train-policy", "deploy", "train-segmenter", "calibrate"):
    made = subprocess.run([program, "config", "--print", verb], capture_output=True, text=True)
    if made.returncode != 0 or "meaning" not in made.stdout or "seed" not in made.stdout:
        failures.append(f"config --print {verb}: {made.stdout!r} {made.stderr!r}")

# Every preset is read without a complaint: the first thing missing is --out, or what the preset works on.
for preset in sorted((source / "configs").glob("*/*.json")):
    if preset.stem.startswith("paper_"):
        listed = subprocess.run([program, "bench", "paper", "--config", str(preset), "--list"], capture_output=True, text=True)
        if listed.returncode != 0 or "transfer/best/bare/square/1" not in listed.stdout:
            failures.append(f"bench paper --config {preset} --list: {listed.stderr!r}")
        continue
    if preset.stem.startswith("tasks_"):
        with tempfile.TemporaryDirectory() as folder:
            shown = subprocess.run([program, "bench", "tasks", "--config", str(preset), "--models", str(source / "models"), "--report",
                                    "--out", folder], capture_output=True, text=True)
        if shown.returncode != 0 or "0 of " not in shown.stdout:
            failures.append(f"bench tasks --config {preset} --report: {shown.stdout!r} {shown.stderr!r}")
        continue
    json.loads(preset.read_text())  # strict JSON, which other programs read, too
    if preset.parent.name == "plans":
        continue
    if preset.parent.name == "rigs":
        printed = subprocess.run([program, "config", "--print", "deploy", "--rig", str(preset)], capture_output=True, text=True)
        if printed.returncode != 0:
            failures.append(f"--rig {preset}: {printed.stderr!r}")
        continue
    verb = {"collect": "collect", "dynamics": "train-dynamics", "policy": "train-policy", "deploy": "deploy",
            "segmenter": "train-segmenter", "fine": "train-segmenter", "emulation": "bench emulation"}[
        preset.stem.split("_")[0]]
    of_verb = {"deploy": "--policy", "train-dynamics": "data=FILE", "train-policy": "dynamics=DIR"}
    first_missing = {("best", "collect.json"): "--policy", ("best", "deploy_planner.json"): "dynamics=DIR",
                     ("best", "deploy_any_pose.json"): "dynamics=DIR", ("best", "deploy_headed_path.json"): "dynamics=DIR",
                     ("best", "deploy_suture.json"): "dynamics=DIR",
                     ("quickstart", "deploy_planner.json"): "dynamics=DIR",
                     ("best", "policy_offline.json"): "recorded"}
    expected = first_missing.get(preset.parts[-2:], "--out" if preset.parent.name == "simulator" else of_verb.get(verb, "--out"))
    check([*verb.split(), "--config", str(preset)], 2, expected)

soak.told(checked, "bad inputs")
print("\n".join(failures) or f"every bad input of {checked} was reported in one line")
sys.exit(bool(failures))
