#!/usr/bin/env python3
"""Logs as other programs read them: npm's MCAP readers, with the messages decoded by protobufjs.

usage: mcap_readers_test.py WRITE_SAMPLE_LOG SOURCE_DIR
"""
import base64
import json
import math
import pathlib
import subprocess
import sys
import tempfile

WRITE_SAMPLE_LOG = sys.argv[1]
READ_MCAP = pathlib.Path(sys.argv[2]) / "tests/node/read_mcap.js"


def read(how, file):
    return json.loads(subprocess.run(["node", READ_MCAP, how, file], check=True, stdout=subprocess.PIPE).stdout)


def of(log, topic):
    return [entry for entry in log["messages"] if entry["topic"] == topic]


def check_whole(log):
    assert log["whole"]
    assert log["metadata"] == {"lodestone": {"verb": "sample", "config": '{"seed": 7}'}}
    counts = {topic: len(of(log, topic)) for topic in
              ("/camera/image", "/needle/pose", "/needle/truth", "/target", "/tf", "/coils/pulse", "/coils/status", "/step", "/log")}
    assert counts == {"/camera/image": 100, "/needle/pose": 99, "/needle/truth": 100, "/target": 100, "/tf": 3, "/coils/pulse": 100,
                      "/coils/status": 99, "/step": 100, "/log": 6}, counts
    assert sum(counts.values()) == len(log["messages"])

    image = of(log, "/camera/image")[7]
    assert image["schema"] == "foxglove.CompressedImage" and image["time_ns"] == "2100000000"
    assert image["message"]["format"] == "jpeg" and image["message"]["frame_id"] == "camera"
    assert base64.b64decode(image["message"]["data"]) == bytes([7]) * 30000
    assert image["message"]["timestamp"] == {"seconds": "2", "nanos": 99993000}, image["message"]["timestamp"]

    pose = of(log, "/needle/pose")[3]["message"]
    assert pose["frame_id"] == "dish"
    assert pose["pose"]["position"] == {"x": 0.003, "y": -0.002, "z": 0}
    assert math.isclose(2 * math.atan2(pose["pose"]["orientation"]["z"], pose["pose"]["orientation"]["w"]), 0.5)
    assert of(log, "/tf")[0]["message"]["child_frame_id"] == "dish"

    assert of(log, "/coils/pulse")[3]["message"]["current_A"] == {"px": 0, "mx": 1.5, "py": 3, "my": 0, "coil": []}
    status = [entry["message"] for entry in of(log, "/coils/status")]
    assert status[0]["temperature_C"] == {"px": 20, "mx": 21, "py": 22, "my": 23, "coil": []}
    assert "supply_V" not in status[0] and status[1]["supply_V"] == 48  # measured every other time
    assert status[69]["faults"] == ["over-temperature", "stuck driver"] and status[68]["faults"] == []

    lost = of(log, "/step")[50]["message"]
    assert lost["sensed"] is False and lost["reason"] == "nothing is seen"
    assert lost["error_m"] == 0 and "action_x" not in lost  # known and 0, and not known

    events = [(entry["message"]["level"], entry["message"]["message"]) for entry in of(log, "/log")]
    assert events == [("INFO", "begins"), ("WARNING", "no pose: nothing is seen"), ("INFO", "the needle is seen again"),
                      ("ERROR", "the coils report: over-temperature, stuck driver"), ("INFO", "the coils report no fault any more"),
                      ("ERROR", "stopped: too warm")], events


def main():
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "sample.mcap"
        subprocess.run([WRITE_SAMPLE_LOG, file], check=True)
        for how in ("indexed", "stream"):
            check_whole(read(how, file))

        # Cut anywhere: the stream ends with the last chunk that is whole, of 7 steps each.
        whole = file.read_bytes()
        steps = []
        for length in range(len(whole) - 1, len(whole) // 3, -(len(whole) // 20)):
            file.write_bytes(whole[:length])
            steps.append(len(of(read("stream", file), "/step")))
        assert steps[0] == 100 and steps == sorted(steps, reverse=True) and len(set(steps)) > 5, steps
        assert all(count % 7 == 0 for count in steps if count < 100), steps

        # Gone in the middle of step 61.
        subprocess.run([WRITE_SAMPLE_LOG, file, "cut"], check=False)
        cut = read("stream", file)
        assert not cut["whole"] and len(of(cut, "/step")) == 56, len(of(cut, "/step"))
    print("logs read back as they were written")


main()
