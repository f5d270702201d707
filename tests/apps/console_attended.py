"""An attended run for an hour while every processor is busy: the page that attends it is not taken for silent.
The sample is shorter, and leaves the processors alone.
usage: console_attended.py PROGRAM [MINUTES]"""
import contextlib
import os
import subprocess
import sys
import tempfile
import time

import soak
from console_page import Browser, Console

program = sys.argv[1]
minutes = float(sys.argv[2]) if len(sys.argv) > 2 else 60.0 if soak.whole else 0.25
busy = soak.whole or len(sys.argv) > 2
kTargets = ([0.6, 0.4], [0.4, 0.6], [0.6, 0.6], [0.4, 0.4])


@contextlib.contextmanager
def busy_processors():
    workers = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count())]
    try:
        yield
    finally:
        for worker in workers:
            worker.kill()
            worker.wait()


with tempfile.TemporaryDirectory() as folder, Console(program, f"{folder}/console") as console, Browser() as browser:
    page = browser.page(console.url)
    page.ready()
    with busy_processors() if busy else contextlib.nullcontext():
        begun_s = time.monotonic()
        clicks = 0
        while time.monotonic() - begun_s < 60.0 * minutes:
            page.point(kTargets[clicks % len(kTargets)])
            clicks += 1
            time.sleep(5.0)
            stops = [event for event in console.events() if event["level"] == "stop"]
            assert not stops, f"after {time.monotonic() - begun_s:.0f} s and {clicks} clicks: {stops}"
    assert page.mode == "running", page.mode

soak.told(clicks, f"clicks in {minutes:g} minutes of an attended run{', every processor busy' if busy else ''}, never stopped")
