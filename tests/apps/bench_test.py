#!/usr/bin/env python3
"""The program on an emulated bench, as somebody with a real one uses it. usage: bench_test.py LODESTONE SOURCE
[PTY_AS_PORT]"""
import csv
import json
import os
import pty
import select
import signal
import subprocess
import sys
import time

from bench_program import as_user, expect, folder, lodestone, patient, run, source, start, wait_for


def read_log(how, file):
    """A log as npm's readers see it: `indexed` where it has its end, else as a `stream`."""
    reader = ["node", source / "tests/node/read_mcap.js", how, file]
    return json.loads(subprocess.run(reader, check=True, stdout=subprocess.PIPE).stdout)


def of(log, topic):
    return [entry for entry in log["messages"] if entry["topic"] == topic]


# A port that is not there is one clear line.
expect(run("rig", "check", "--port", "/dev/ttyNOTHING", code=1), "there is no such port")
expect(run("rig", "check", code=2), "rig.serial.port is empty")

bench = folder / "bench.json"
emulator = start("rig", "emulate", "--out", bench)
try:
    wait_for(bench, emulator)
    # A second bench would be seen through the first one's camera: it refuses.
    expect(run("rig", "emulate", "--out", folder / "second.json", code=1), "UDP 3956", "--no-camera")
    assert not (folder / "second.json").exists()
    expect(run("rig", "check", "--rig", bench, "--set", "rig.camera.serial=OTHER", "--yes", code=1), "asks for OTHER")
    expect(run("rig", "check", "--rig", bench, "--yes"), "firmware 1.2.1", "1280 x 1024", "seen at",
           "asked for +x", "the bench is ready")
    text = run("rig", "check", "--rig", bench, "--no-camera", code=1)
    expect(text, "left out", "not ready")

    run("calibrate", "coils", "--rig", bench, "--yes", "--out", folder / "coils.json")
    measured = json.loads((folder / "coils.json").read_text())["coils"]
    assert all(abs(ohm - 1.90) < 0.03 for ohm in measured["resistance_20C_ohm"]), measured
    assert all(abs(henry - 17.6e-3) < 2e-3 for henry in measured["inductance_H"]), measured

    # The loop with the camera's image, on the serial port.
    text = run("deploy", "--rig", bench, "--controller", "baseline", "--task", "centre", "--trials", 2,
               *patient, "--set", "trials.point_seconds=4", "--mcap", "--out", folder / "deploy")
    expect(text, "as the camera saw them")
    summary = json.loads((folder / "deploy/summary.json").read_text())
    assert summary["scored_by"] == "camera" and summary["baseline"]["centre"]["n_trials"] == 2, summary
    trials = json.loads((folder / "deploy/trials.json").read_text())
    # In wall-clock time no two runs are the same; about one trial in a hundred loses its needle.
    trial = next((one for one in trials if one["completed"]), trials[0])
    assert trial["completed"] and len(trial["sensed_trajectory"]) > 8, trial["stop_reason"]
    # Nobody knows the true pose: there is none, and no figure by it.
    assert "trajectory" not in trial and "final_error_mm" not in trial, trial.keys()
    assert "mean_error_mm" not in summary["baseline"]["centre"] and summary["baseline"]["centre"]["sensed"]["mean_error_mm"] > 0
    with (folder / "deploy/trajectories.csv").open() as file:
        assert not any("true" in column for column in csv.DictReader(file).fieldnames)
    # Each trial has a log, at the wall clock's time, with the image of each step.
    for trial in trials:
        log = read_log("indexed", folder / f"deploy/logs/real-baseline-centre-{trial['trial']}.mcap")
        steps = of(log, "/step")
        assert len(steps) == len(trial["time_s"]) and not of(log, "/needle/truth"), len(steps)
        assert 0 < len(of(log, "/camera/image")) <= len(steps), len(of(log, "/camera/image"))
        assert abs(int(steps[-1]["time_ns"]) / 1e9 - time.time()) < 300, steps[-1]["time_ns"]
        taken = of(log, "/camera/image")[-1]["message"]["timestamp"]
        age_s = int(of(log, "/camera/image")[-1]["time_ns"]) / 1e9 - int(taken["seconds"]) - int(taken["nanos"]) / 1e9
        assert 0 < age_s < 5, age_s
        ended = of(log, "/log")[-1]["message"]["message"]
        assert ended == ("the trial has ended" if trial["completed"] else "stopped: " + trial["stop_reason"]), ended

    # The stop file ends a run at once, and what was measured is written.
    running = start("deploy", "--rig", bench, "--controller", "baseline", "--task", "centre", "--trials", 5,
                    *patient, "--out", folder / "stopped")
    wait_for(folder / "stopped/trajectories.csv", running)
    time.sleep(2)
    (folder / "stopped/STOP").touch()
    text, _ = running.communicate(timeout=30)
    assert running.returncode == 1, text
    expect(text, "STOP exists")
    assert "STOP exists" in json.loads((folder / "stopped/summary.json").read_text())["stopped"]

    # Killed outright: the pulse ends by itself, the next run finds a bench in order.
    running = start("deploy", "--rig", bench, "--controller", "baseline", "--task", "centre", "--trials", 5,
                    *patient, "--mcap", "--out", folder / "killed")
    wait_for(folder / "killed/trajectories.csv", running)
    time.sleep(6)
    running.kill()
    running.wait()
    log = read_log("stream", folder / "killed/logs/real-baseline-centre-0.mcap")  # to the last whole chunk
    assert not log["whole"] and of(log, "/step") and of(log, "/camera/image") and of(log, "/coils/pulse"), log["chunks"]
    time.sleep(1)
    expect(run("rig", "check", "--rig", bench, "--no-camera", "--yes"), "currents are as asked")

    # Exploring frees the needle by itself, or needs somebody who places it.
    text = run("collect", "--rig", bench, "--set", "transitions=12", "--set", "episode_steps=4", *patient, "--out",
               folder / "alone")
    expect(text, "12 transitions", "placements by the operator: 0")
    placed = ["--set", "explorer.self_reset=false"]
    expect(run("collect", "--rig", bench, "--set", "transitions=6", *placed, "--out", folder / "nobody", code=1),
           "nobody can be asked", "lodestone import")
    keyboard, terminal = pty.openpty()
    running = subprocess.Popen([*as_user, lodestone, "collect", "--rig", bench, "--set", "transitions=12", "--set",
                                "episode_steps=4", *placed, *patient, "--out", folder / "explored"], stdin=terminal,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=False)
    seen = b""
    end = time.time() + 60
    answered = 0
    while running.poll() is None and time.time() < end:
        if select.select([running.stdout], [], [], 0.2)[0]:
            seen += os.read(running.stdout.fileno(), 4096)
        while seen.count(b"press any key") > answered:
            os.write(keyboard, b" ")
            answered += 1
    seen += running.stdout.read()
    assert running.wait() == 0, seen.decode()
    assert answered >= 3, seen.decode()
    expect(seen.decode(), "12 transitions")
finally:
    emulator.send_signal(signal.SIGINT)
    text, _ = emulator.communicate(timeout=20)
assert emulator.returncode == 0, text

# The same through libserialport, which takes the pseudo-terminal for a device; then the bench vanishes.
if len(sys.argv) > 3:
    bench.unlink()
    emulator = start("rig", "emulate", "--no-camera", "--out", bench)
    try:
        wait_for(bench, emulator)
        port = json.loads(bench.read_text())["serial"]["port"].replace("/dev/", "/dev/./")
        preloaded = {"LD_PRELOAD": sys.argv[3]}
        expect(run("rig", "check", "--port", port, "--no-camera", "--yes", env=preloaded), "currents are as asked")
        running = start("calibrate", "coils", "--port", port, "--yes", "--set", "pulses=50", "--out",
                        folder / "never.json", env={**os.environ, **preloaded})
        time.sleep(3)
    finally:
        emulator.kill()
        emulator.wait()
    text, _ = running.communicate(timeout=20)
    assert running.returncode == 1, text
    expect(text, "serial port")
    assert not (folder / "never.json").exists()

# Six coils on three motor controllers: each gets its current, and the paper's rig is told that this bench is another.
six = folder / "six.json"
emulator = start("rig", "emulate", "--rig", source / "configs/rigs/six_planar.json", "--no-camera", "--out", six)
try:
    wait_for(six, emulator)
    expect(run("rig", "check", "--rig", six, "--no-camera", "--yes"), "coil at0", "coil at300", "currents are as asked")
    run("calibrate", "coils", "--rig", six, "--yes", "--set", "pulses=2", "--out", folder / "six-coils.json")
    measured = json.loads((folder / "six-coils.json").read_text())["coils"]
    assert all(abs(ohm - 0.824) < 0.02 for ohm in measured["resistance_20C_ohm"]), measured
    assert len(measured["inductance_H"]) == 6, measured
    port = json.loads(six.read_text())["serial"]["port"]
    expect(run("rig", "check", "--port", port, "--no-camera", "--yes", code=1),
           "for 3 motor controllers (6 outputs), the rig's 4 coils", "flash coils-2.hex")
finally:
    emulator.kill()
    emulator.wait()

# By hand, without a display: nothing is pressed, so the needle rests, but every episode is on disk.
headless = {"SDL_VIDEODRIVER": "dummy"}
by_hand = ["collect", "--by", "keyboard", "--sensor", "simulated", "--set", "episode_steps=3", "--out",
           folder / "by-hand"]
running = start(*by_hand, "--set", "transitions=30", env={**os.environ, **headless})
time.sleep(4.5)
running.kill()
running.wait()
text = run(*by_hand, "--set", "transitions=30", "--resume", env=headless)
expect(text, "30 transitions")
expect(run("collect", "--by", "gamepad", "--out", folder / "no-gamepad", code=1, env=headless), "no gamepad was found")
print("ok")
