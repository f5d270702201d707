#!/usr/bin/env python3
"""Drivers outside the program on an emulated bench: those of the examples keep the protocol and drive a needle, and
one that hangs, lies or dies ends in coils off. usage: driver_test.py LODESTONE SOURCE DRIVER_COILS"""
import json
import shlex
import signal
import socket
import subprocess
import sys
import threading
import time

from bench_program import expect, folder, patient, run, source, start, wait_for

driver_in_cpp = sys.argv[3]
python = "/usr/bin/python3"

# Stands between the program and a driver, and spoils what is in its name once so many pulses have gone by.
BETWEEN = '''
import json, os, subprocess, sys, time
fault, pulses, driver = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
behind = subprocess.Popen(driver, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
def read(file):
    head = file.read(4)
    return file.read(int.from_bytes(head, "little")) if len(head) == 4 else None
def write(file, text):
    file.write(len(text).to_bytes(4, "little") + text)
    file.flush()
while (asked := read(sys.stdin.buffer)) is not None:
    pulses -= json.loads(asked)["do"] == "pulse"
    if pulses < 0 and fault == "hang":
        time.sleep(1000)
    if pulses < 0 and fault == "die":
        os._exit(3)
    write(behind.stdin, asked)
    answer = json.loads(read(behind.stdout))
    if pulses < 0 and fault == "lie" and "current_A" in answer:
        answer["current_A"] = [0.0 for _ in answer["current_A"]]
    if pulses < 0 and fault == "babble":
        print("one more pulse", flush=True)
    write(sys.stdout.buffer, json.dumps(answer).encode())
'''
# A needle that comes to the dish centre within five seconds, as a sensor tells it, and grey images of nothing.
SEES = '''
import json, sys, time
begun = time.monotonic()
while len(head := sys.stdin.buffer.read(4)) == 4:
    asked, more, image = json.loads(sys.stdin.buffer.read(int.from_bytes(head, "little"))), {}, b""
    if asked["do"] == "hello":
        more = {"protocol": 1, "name": "eyes"}
    else:
        time.sleep(0.02)
        more = {"age_s": 0.01}
    if asked["do"] == "pose":
        x_m = max(0.0, 0.008 - 0.002 * (time.monotonic() - begun))
        more.update(x_m=x_m, y_m=0.0, heading_rad=3.14, sigma_m=1e-4, sigma_rad=0.01)
    if asked["do"] == "image":
        image = bytes(640 * 480)
        more.update(format="gray8", width_px=640, height_px=480, bytes=len(image))
    text = json.dumps({"id": asked["id"], **more}).encode()
    sys.stdout.buffer.write(len(text).to_bytes(4, "little") + text + image)
    sys.stdout.buffer.flush()
'''
eyes = folder / "eyes.py"
eyes.write_text(SEES)
between = folder / "between.py"
between.write_text(BETWEEN)


def served(command):
    """A port of the loopback; whoever connects speaks to a command of his own."""
    door = socket.create_server(("127.0.0.1", 0))

    def serve():
        while True:
            link, _ = door.accept()
            with link:
                subprocess.run(command, stdin=link, stdout=link)
    threading.Thread(target=serve, daemon=True).start()
    return f"tcp://127.0.0.1:{door.getsockname()[1]}"


# Addresses that are none, and drivers that are not there, are one clear line.
expect(run("rig", "conform", code=2), "this rig has no driver", "docs/driver-protocol.md")
conform = ["rig", "conform", "--yes", "--set"]
expect(run(*conform, "rig.driver.coils=/dev/ttyACM0", code=2), "must be process:COMMAND or tcp://HOST:PORT")
expect(run(*conform, "rig.driver.coils=tcp://127.0.0.1:9", code=1), "cannot be reached", "is it running there?")
expect(run(*conform, "rig.driver.coils=process:no-such-driver", code=1), "no-such-driver has gone")

bench = folder / "bench.json"
emulator = start("rig", "emulate", "--out", bench)
try:
    wait_for(bench, emulator)
    described = json.loads(bench.read_text())
    port = described["serial"]["port"]
    in_python = [python, str(source / "examples/driver_coils.py"), port]

    def rig(name, address, sensor="", **more):
        file = folder / f"{name}.json"
        file.write_text(json.dumps({**described, "backend": "driver", **more,
                                    "driver": {"coils": address, "sensor": sensor, "reply_timeout_s": 0.5}}))
        return file

    with_python = rig("python", "process:" + shlex.join(in_python))
    for file in (with_python, rig("cpp", "process:" + shlex.join([driver_in_cpp, port])), rig("tcp", served(in_python))):
        text = run("rig", "conform", "--rig", file, "--yes")
        expect(text, "coil controller, by", "coil -y: its current", "stop ends a pulse", "off; it says:",
               "the driver keeps the protocol")
        assert "FAILED" not in text, text
    for verb in (["rig", "check"], ["calibrate", "coils", "--out", folder / "coils.json"]):
        expect(run(*verb, "--rig", with_python, "--yes", code=2), "rig.backend = driver")

    # Camera and needle as ever; the coils through a program of somebody's own.
    deploy = ["deploy", "--controller", "baseline", "--task", "centre", *patient, "--set", "trials.point_seconds=4"]
    text = run(*deploy, "--rig", with_python, "--trials", 2, "--out", folder / "deploy")
    expect(text, "bench connected on driver coil controller, by Python")
    trials = json.loads((folder / "deploy/trials.json").read_text())
    trial = next((one for one in trials if one["completed"]), trials[0])
    assert trial["completed"] and len(trial["sensed_trajectory"]) > 8, trial["stop_reason"]

    # A program that sees the needle, in place of camera and segmenter; another that hands out images.
    sees = "process:" + shlex.join([python, str(eyes)])
    with_eyes = rig("eyes", "process:" + shlex.join(in_python), sees, camera={"kind": "driver", "source": sees})
    text = run("rig", "conform", "--rig", with_eyes, "--yes")
    expect(text, "seen 30 of 30 times", "640 x 480 px", "the driver keeps the protocol")
    run(*deploy, "--rig", with_eyes, "--trials", 1, "--set", "trials.point_seconds=8", "--out", folder / "eyes")
    trial, = json.loads((folder / "eyes/trials.json").read_text())
    assert trial["completed"] and trial["sensed"]["final_error_mm"] < 0.1, trial["stop_reason"]
    assert trial["sensed_trajectory"][0][0] > 4.0, trial["sensed_trajectory"][0]
    dark = rig("dark", "process:" + shlex.join(in_python), camera={"kind": "driver", "source": sees})
    expect(run(*deploy, "--rig", dark, "--trials", 1, "--out", folder / "dark", code=1), "must be 1280x1024")

    # What a driver does wrong in the middle of a run ends it, and the coils are off.
    for fault, why in (("hang", "does not answer in time"), ("die", "has gone"), ("lie", "is said to have 0 A"),
                       ("babble", "where a length belongs")):
        spoiled = rig(fault, "process:" + shlex.join([python, str(between), fault, "1", *in_python]))
        text = run(*deploy, "--rig", spoiled, "--trials", 3, "--out", folder / fault, code=1)
        expect(text, why)
        assert why in json.loads((folder / fault / "summary.json").read_text())["stopped"], text
        time.sleep(1.0)
        expect(run("rig", "check", "--rig", bench, "--no-camera", "--clear", "--yes"), "currents are as asked")

    # Killed outright: the driver sees the end of its stream, and the next run finds a bench in order.
    running = start(*deploy, "--rig", with_python, "--trials", 5, "--out", folder / "killed")
    wait_for(folder / "killed/trajectories.csv", running)
    time.sleep(2)
    running.kill()
    running.wait()
    time.sleep(1.0)
    expect(run("rig", "check", "--rig", bench, "--no-camera", "--yes"), "currents are as asked")
finally:
    emulator.send_signal(signal.SIGINT)
    text, _ = emulator.communicate(timeout=20)
assert emulator.returncode == 0, text
