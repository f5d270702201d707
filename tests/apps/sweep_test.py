#!/usr/bin/env python3
"""sweep: seeds x settings, killed, cancelled and resumed; what is wrong with one is said before anything is run.

usage: sweep_test.py LODESTONE SOURCE_FOLDER
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
folder = pathlib.Path(scratch.name)
whole = {"verb": "train-policy", "config": ["fast/policy_centre.json"], "seeds": 2, "score": "result.success_rate",
         "settings": ["simulator=physics", "training.env_steps=4000", "training.warm_up_steps=1000", "training.evaluate_every=1000",
                      "training.checkpoint_every_s=0"],
         "grid": {"td3.learning_rate": [3e-4, 1e-3]}}


def sweep(name, out, **changes):
    file = folder / f"{name}.json"
    file.write_text(json.dumps({**whole, **changes}))
    return [program, "sweep", str(file), "--out", str(folder / out), "--threads", "2"]


def run(command, code=0):
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == code, (command, done.stdout, done.stderr)
    return done.stdout + done.stderr


def results(out):
    return json.loads((folder / out / "sweep.json").read_text())


def wait_for(condition, what):
    deadline = time.time() + 120
    while not condition():
        assert time.time() < deadline, what
        time.sleep(0.02)


# Straight through.
said = run(sweep("a", "straight"))
assert "learning_rate=0.001" in said and "2 of 2" in said, said
rows = results("straight")["rows"]
assert len(rows) == 2 and all(len(row["scores"]) == 2 and "interval" in row for row in rows), rows
assert rows[0]["mean"] >= rows[1]["mean"]
assert "Score by value" in (folder / "straight/report.html").read_text()

# Killed in the middle, again and again: the same scores, and what was finished is not run again.
for kill in range(3):
    begun = subprocess.Popen(sweep("a", "killed"), stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    time.sleep(0.4 + 0.6 * kill)
    begun.send_signal(signal.SIGKILL)
    begun.wait()
wait_for(lambda: subprocess.run(sweep("a", "killed"), capture_output=True).returncode == 0, "it does not go on")
assert results("killed") == results("straight"), (results("killed"), results("straight"))
manifests = {path: path.read_bytes() for path in (folder / "killed").rglob("manifest.json")}
run(sweep("a", "killed"))
assert manifests == {path: path.read_bytes() for path in (folder / "killed").rglob("manifest.json")}

# Cancelled from elsewhere: it says that it goes on, and does.
begun = subprocess.Popen(sweep("a", "cancelled"), stderr=subprocess.PIPE, text=True)
wait_for(lambda: list((folder / "cancelled").rglob("metrics.jsonl")) if (folder / "cancelled").exists() else False, "nothing was begun")
run([program, "sweep", "cancel", str(folder / "cancelled")])
assert "goes on where it was" in begun.communicate(timeout=60)[1]
assert begun.returncode == 130, begun.returncode
told = run([program, "sweep", "status", str(folder / "cancelled")])
assert "of 4 runs are finished" in told and "not finished" in told, told
assert "== learning_rate=" in run([program, "sweep", "logs", str(folder / "cancelled")])
run(sweep("a", "cancelled"))
assert results("cancelled") == results("straight")

# Another score of the same runs.
run(sweep("a", "straight", score="result.fresh_evaluation.episode_end_error_mm", lower_is_better=True))
errors = [row["mean"] for row in results("straight")["rows"]]
assert errors == sorted(errors), errors

# More seeds and values join what was run, which is not run again; other settings are another sweep.
manifests = {path: path.read_bytes() for path in (folder / "straight").rglob("*/manifest.json")}
run(sweep("a", "straight", seeds=3, grid={"td3.learning_rate": [3e-4, 1e-3, 3e-3]}))
assert [len(row["scores"]) for row in results("straight")["rows"]] == [3, 3, 3], results("straight")
assert all(path.read_bytes() == there for path, there in manifests.items())
longer = [text.replace("env_steps=4000", "env_steps=5000") for text in whole["settings"]]
assert 'settings = ["simulator=physics","training.env_steps=5000"' in run(sweep("a", "straight", settings=longer), 2)

# Random search and successive halving: the last rung's budget is the largest, and fewer come there.
halving = {"key": "training.env_steps", "first": 1500, "factor": 2, "rungs": 3}
halved = {"grid": {}, "seeds": 1, "random": {"count": 4, "ranges": {"td3.learning_rate": {"from": 1e-4, "to": 1e-2, "log": True}}},
          "settings": [text for text in whole["settings"] if "env_steps" not in text], "halving": halving}
run(sweep("b", "halved", **halved))
assert sorted(row["rung"] for row in results("halved")["rows"]) == [1, 1, 2, 3], results("halved")
best = results("halved")["rows"][0]["point"]["name"]
assert json.loads((folder / "halved/rung3" / best / "1/config.json").read_text())["training"]["env_steps"] == 6000

# Cancelled while nothing works on it, it goes on all the same.
assert "nothing works on it" in run([program, "sweep", "cancel", str(folder / "halved")])
before = results("halved")
run(sweep("b", "halved", **halved))
assert results("halved") == before
assert "seeds = 2 (there: 1)" in run(sweep("b", "halved", **{**halved, "seeds": 2}), 2), "rungs chose by the seeds there were"

# What is wrong is said in one line, and nothing is left behind.
for changes, what in (({"grid": {"td3.learning_rat": [1]}}, "td3.learning_rate"), ({"verb": "dance"}, "dance"),
                      ({"grid": {"td3.learning_rate": ["fast"]}}, "td3.learning_rate"), ({"config": ["nowhere.json"]}, "nowhere.json"),
                      ({"verb": "check"}, "check"), ({"verb": "evaluate dynamics"}, "bench rigs"),
                      ({**halved, "halving": {**halving, "factor": 100000}}, "training.env_steps = 15000000000000"), ({"score": "x"}, "result.success_rate")):
    said = run(sweep("bad", "bad", **changes), 2)
    assert what in said and len(said.splitlines()) == 1, said
    assert not (folder / "bad").exists(), changes
assert "holds no sweep" in run([program, "sweep", "status", str(folder)], 2)
for verb in ("sweep", "plan"):
    for what in ("cancel", "logs"):
        assert "holds no plan" in run([program, verb, what, str(folder)], 2)

print("sweep: straight, killed, cancelled, scored otherwise, halved")
