#!/usr/bin/env python3
"""Logs of the program as other programs read them: MCAP by npm's readers, TensorBoard's events by its definitions.
usage: logs_test.py LODESTONE SOURCE"""
import base64
import collections
import csv
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

lodestone, source = sys.argv[1], pathlib.Path(sys.argv[2])
folder = pathlib.Path(tempfile.mkdtemp(prefix="lodestone-logs-"))


def run(*arguments, code=0):
    done = subprocess.run([lodestone, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300, cwd=source)
    assert done.returncode == code, f"{arguments}: exit {done.returncode}, expected {code}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def node(script, *arguments):
    return json.loads(subprocess.run(["node", source / "tests/node" / script, *map(str, arguments)], check=True, stdout=subprocess.PIPE).stdout)


def counts(log):
    return collections.Counter(message["topic"] for message in log["messages"])


def events(log):
    return [message["message"]["message"] for message in log["messages"] if message["topic"] == "/log"]


def of(log, topic):
    return [message for message in log["messages"] if message["topic"] == topic]


def wait_for(what, process, seconds=120):
    end = time.time() + seconds
    while not what():
        assert process.poll() is None, f"it has ended before its time: {process.communicate()}"
        assert time.time() < end, "it does not come"
        time.sleep(0.02)


def size(file):
    return file.stat().st_size if file.exists() else 0


def a_trial_by_camera():
    """Everything that trajectories.csv has of it, and the images."""
    out = folder / "seen"
    run("deploy", "--controller", "baseline", "--task", "centre", "--trials", 1, "--set", "trials.point_seconds=3", "--mcap", "--record",
        "--out", out)
    log = node("read_mcap.js", "indexed", out / "logs/explored-baseline-centre-0.mcap")
    rows = list(csv.DictReader((out / "trajectories.csv").open()))
    seen = sum(row["sensed"] == "1" for row in rows)
    assert len(rows) == 11 and seen > 5, rows
    expected = {"/step": 11, "/needle/truth": 11, "/target": 11, "/needle/pose": seen, "/camera/image": 11, "/coils/pulse": seen - 1,
                "/coils/status": 10, "/tf": 1}
    found = counts(log)
    assert seen < 11 or {topic: found[topic] for topic in expected} == expected, found
    assert events(log)[0] == "trial explored-baseline-centre-0" and events(log)[-1] == "the trial has ended", events(log)
    for image in of(log, "/camera/image"):
        jpeg = base64.b64decode(image["message"]["data"])
        assert jpeg[:3] == b"\xff\xd8\xff" and jpeg[-2:] == b"\xff\xd9" and len(jpeg) > 10000, len(jpeg)
    last, row = of(log, "/needle/truth")[-1]["message"]["pose"]["position"], rows[-1]
    assert abs(last["x"] - float(row["true_x_m"])) < 1e-8 and abs(last["y"] - float(row["true_y_m"])) < 1e-8
    facts = log["metadata"]["lodestone"]
    assert facts["trial"] == "explored-baseline-centre-0" and "coils" in json.loads(facts["rig"]) and facts["program"].startswith("lodestone ")
    return out


def an_older_run(seen):
    """The same from what the run has recorded besides."""
    text = run("export", "--run", seen, "--to", folder / "older.mcap")
    assert "trials       1\n" in text and "images       11\n" in text, text
    log = node("read_mcap.js", "indexed", folder / "older.mcap")
    direct = node("read_mcap.js", "indexed", seen / "logs/explored-baseline-centre-0.mcap")
    for topic in ("/step", "/needle/truth", "/target", "/needle/pose"):
        assert counts(log)[topic] == counts(direct)[topic], (topic, counts(log))
    assert counts(log)["/camera/image"] == 11, counts(log)  # of the film
    assert events(log) == events(direct), events(log)
    for one, other in zip(of(log, "/needle/pose"), of(direct, "/needle/pose")):
        for axis in "xy":
            assert abs(one["message"]["pose"]["position"][axis] - other["message"]["pose"]["position"][axis]) < 1e-8
    temperature = [of(either, "/coils/status")[-1]["message"]["temperature_C"] for either in (log, direct)]
    assert all(abs(temperature[0][coil] - temperature[1][coil]) < 1e-6 for coil in ("px", "mx", "py", "my")), temperature
    assert not list(folder.glob("*.part"))
    text = run("export", "--run", folder / "nothing", "--to", folder / "nothing.mcap", code=1)
    assert "neither trajectories.csv nor transitions.h5" in text and not (folder / "nothing.mcap").exists(), text


def a_run_that_is_killed():
    """It leaves a log to its last whole chunk, and a second one when it goes on."""
    out = folder / "killed"
    arguments = ["collect", "--sensor", "simulated", "--set", "transitions=1000000", "--mcap", "--out", str(out)]
    process = subprocess.Popen([lodestone, *arguments], cwd=source, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    first, second = out / "logs/session-0.mcap", out / "logs/session-0-2.mcap"
    wait_for(lambda: size(first) > 60000, process)
    process.kill()
    process.communicate()
    log = node("read_mcap.js", "stream", first)
    found = counts(log)
    assert not log["whole"] and found["/step"] > 100 and found["/step"] - found["/coils/status"] <= 1, found
    assert any(event.startswith("an episode of 25 steps") for event in events(log)), events(log)
    process = subprocess.Popen([lodestone, *arguments, "--resume"], cwd=source, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    wait_for(lambda: size(second) > 20000, process)
    process.send_signal(signal.SIGINT)
    text = process.communicate(timeout=120)[1].decode()
    assert process.returncode == 130, text
    assert node("read_mcap.js", "indexed", second)["whole"]
    assert counts(node("read_mcap.js", "stream", first)) == found  # nobody has touched it

    # Where no log can be written nothing is driven.
    shutil.rmtree(out / "logs")
    (out / "logs").write_text("in the way")
    text = run(*arguments, "--resume", code=1)
    faults = [line for line in text.splitlines() if str(out / "logs") in line]
    assert len(faults) == 1 and "cannot" in faults[0], text


def a_training():
    """TensorBoard has the configuration and the result of a run beside its curves."""
    run("collect", "--sensor", "simulated", "--set", "transitions=120", "--set", "episode_steps=8", "--out", folder / "data")
    out = folder / "dynamics"
    run("train-dynamics", "--set", f"data={folder / 'data/transitions.h5'}", "--set", "model.hidden=[16]", "--set", "training.epochs=3",
        "--out", out)
    tags = node("read_events.js", out)
    config = json.loads((out / "config.json").read_text())
    text = tags["config"]["text"][0]
    assert text.startswith("```json\n") and json.loads(text[8:-5]) == config, text
    assert tags["config"]["metadata"]["pluginData"]["pluginName"] == "text"
    settings = {name: next(iter(value.values())) for name, value in
                tags["_hparams_/session_start_info"]["hparams"]["sessionStartInfo"]["hparams"].items()}
    assert settings["training.epochs"] == 3 and settings["model.hidden"] == "[16]" and settings["data"] == config["data"], settings
    end = tags["_hparams_/session_end_info"]["hparams"]["sessionEndInfo"]
    assert end["status"] == "STATUS_SUCCESS", end
    evaluation = json.loads((out / "evaluation.json").read_text())
    final = tags["final/position_rms_mm"]
    assert final["step"] == 3 and abs(final["simpleValue"] / evaluation["position_rms_mm"] - 1) < 1e-6, final
    assert any(tag.startswith("train") or "loss" in tag for tag in tags), list(tags)


recorded = a_trial_by_camera()
an_older_run(recorded)
a_run_that_is_killed()
a_training()
shutil.rmtree(folder)
print("logs read back as they were written")
