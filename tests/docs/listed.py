"""What of the pages is not run as it stands there, and why. Keys are a page and how the command or block begins; one that
matches nothing any more is a fault.
"""

BASE = "build/release/apps/lodestone "

# Neither in the sample nor in the soak. What calls the program is still parsed by it, as written.
NOT_RUN = {
    ("README.md", "scripts/test"): "runs this test, among all others",
    ("docs/beyond-the-paper.md", BASE + "bench tasks --out"): "takes hours; apps.tasks runs a small one",
    ("docs/drive-a-bench.md", "apt-get install gcc-avr"): "needs root and a mirror of Debian; scripts/setup has installed the same",
    ("docs/drive-a-bench.md", "avrdude"): "needs an Arduino",
    ("docs/drive-a-bench.md", BASE + "rig check --rig configs/rigs/serial.json"): "needs an Arduino; below it runs on an emulated one",
    ("docs/drive-a-bench.md", BASE + "calibrate coils"): "needs an Arduino; apps.bench runs it on an emulated one",
    ("docs/drive-a-bench.md", BASE + "collect --rig my-rig.json --by gamepad"): "needs a gamepad, and somebody who holds it",
    ("docs/driver-protocol.md", BASE + "rig conform"): "needs an Arduino; apps.driver runs it on an emulated bench, with both examples",
    ("docs/export.md", "import json, numpy, onnxruntime"): "ONNX Runtime for Python is no package of Debian; test_exports replays the same episodes by Node's",
    ("docs/packages.md", "scripts/package"): "needs root and a mirror of Debian, and installs a system",
    ("docs/packages.md", "apt-get install"): "needs root; scripts/package installs it in a bare Debian",
    ("docs/packages.md", "lodestone deploy --models /usr/share"): "needs the package; scripts/package runs it in a bare Debian",
    ("docs/packages.md", "docker build"): "needs Docker and a mirror of its images",
    ("docs/packages.md", "docker run"): "needs Docker and a mirror of its images",
    ("docs/reproduce-the-paper.md", BASE + "bench paper --scale full"): "takes days; results/paper holds what has been run of it",
    ("docs/scale.md", BASE + "bench paper --scale full"): "takes days; apps.slurm runs a small one",
    ("docs/see-the-needle.md", BASE + "calibrate --rig my-rig.json --set rig.camera.kind=uvc"): "needs a camera",
    ("docs/see-the-needle.md", BASE + "train-segmenter --config configs/vision/fine_tune.json --rig my-rig.json"): "needs a film of a needle; apps.own_needle runs it on a rendered one",
}

# In the soak only: what takes long and cannot be made shorter. Parsed in the sample, where it calls the program.
SOAK_ONLY = {
    ("docs/drive-a-bench.md", BASE + "bench emulation"): "simulates an hour",
    ("docs/logs.md", BASE + "bench emulation"): "simulates an hour",
    ("docs/python.md", "/usr/bin/python3 -m venv"): "python.pip does it in every run",
    ("docs/python.md", "build/env/bin/pip install"): "builds everything again; python.pip does it in every run, in a build that is there",
    ("docs/scale.md", "build/dev/tests/runs/test_runs"): "runs.slow runs it every time",
    ("docs/see-the-needle.md", BASE + "train-segmenter"): "sees no needle, and says so, before it has learned for minutes",
}

# On a rig that is not there; the page itself says that so they drive the virtual one.
ON_THE_VIRTUAL_RIG = {
    ("docs/drive-a-bench.md", BASE + "collect --rig my-rig.json --out"): "--set rig.backend=virtual",
    ("docs/drive-a-bench.md", BASE + "deploy --rig my-rig.json"): "--set rig.backend=virtual",
    ("docs/drive-a-bench.md", BASE + "qualify --rig my-rig.json"): "--virtual",
}

# Blocks that the reader saves as a file.
FILES = {
    ("docs/bring-your-own-rig.md", '{\n  "drive"'): "my-rig.json",
    ("docs/deploy-safely.md", '{\n  "safety"'): "zones.json",
    ("docs/deploy-safely.md", '{\n  "keep_out"'): "moving.json",
    ("docs/deploy-safely.md", '{\n  "task"'): "suture.json",
    ("docs/driver-protocol.md", '{\n  "backend"'): "my-bench.json",
    ("docs/sweep.md", '{\n  "verb"'): "rate.json",
}

# Blocks that are none of the reader's to run.
NO_COMMANDS = {
    ("docs/architecture.md", "explore a rig -> "): "a picture",
    ("docs/bring-your-own-rig.md", "find_package(lodestone"): "lines of a CMakeLists.txt; tests/consumer has them",
    ("docs/console-protocol.md", '{"kind": "hello"'): "a message with gaps; tests/console holds the protocol against the page",
    ("docs/console-protocol.md", '{"kind": "state"'): "a message with gaps; tests/console holds the protocol against the page",
    ("docs/console.md", "server {"): "a configuration of nginx",
    ("docs/drive-a-bench.md", "@dialout"): "lines of limits.conf",
    ("docs/driver-protocol.md", '{"id": 7'): "two messages",
    ("docs/results.md", "Errors in mm"): "a table that a quickstart has printed",
    ("docs/serial-protocol.md", "00  stuffed"): "bytes on the wire",
}

# What words stand for that the reader is to replace, in commands within the text.
READERS_OWN = {"DIR": "runs/some", "WIDTH": "wide", "S": "1", "W": "0.5"}


class Table:
    """Looks things up by how they begin, and knows what was never found."""

    def __init__(self, name, entries):
        self.name, self.entries, self.found = name, entries, set()

    def look_up(self, place):
        for key, value in self.entries.items():
            page, beginning = key
            if page == place.page and place.text.startswith(beginning):
                self.found.add(key)
                return value
        return None

    def faults(self):
        return [f"{page}: {self.name} of tests/docs has {beginning!r}, which is not in the page any more"
                for page, beginning in self.entries if (page, beginning) not in self.found]


def tables():
    return {name: Table(name, globals()[name]) for name in ("NOT_RUN", "SOAK_ONLY", "ON_THE_VIRTUAL_RIG", "FILES", "NO_COMMANDS")}
