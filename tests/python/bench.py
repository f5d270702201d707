"""Prints steps per second of one environment, played from C++, from Python as a batch, and by Gymnasium's SyncVectorEnv.

usage: bench.py AS_CPP [ENVIRONMENTS [ROUNDS [SECONDS]]]
"""
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import lodestone
from lodestone.tasks import environment_config

as_cpp = sys.argv[1]
count, rounds, seconds = (int(word) for word in (*sys.argv[2:], *("4096", "5", "2")[len(sys.argv) - 2:]))
dynamics = lodestone.Dynamics.load("models/dynamics_best")
threads = os.cpu_count()


def rate(environments, chosen, stretch=1):
    """Steps per second, a few steps at a time."""
    for _ in range(3):
        environments.step(chosen)
    steps, start = 0, time.perf_counter()
    while (passed := time.perf_counter() - start) < seconds:
        for _ in range(stretch):
            environments.step(chosen)
        steps += stretch
    return steps * len(chosen) / passed


def actions(environments):
    return np.random.default_rng(1).uniform(-1, 1, environments.action_space.shape).astype(np.float32)


environments = lodestone.make_vec(dynamics, count, "centre", seed=5, threads=threads)
copying = lodestone.make_vec(dynamics, count, "centre", seed=5, threads=threads, copy=True)
few = min(count, 64)
single = SyncVectorEnv([lambda i=i: lodestone.MbsEnv(dynamics, "centre", stream=i) for i in range(few)], autoreset_mode=AutoresetMode.SAME_STEP)
for each in (environments, copying, single):
    each.reset(seed=5)
with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
    file.write(environment_config("centre"))
    file.flush()
    rows = {"C++": lambda: float(subprocess.run([as_cpp, "rate", "models/dynamics_best", file.name, str(count), str(threads), str(seconds)],
                                                 capture_output=True, check=True, text=True).stdout),
            "Python, make_vec": lambda: rate(environments, actions(environments)),
            "Python, make_vec(copy=True)": lambda: rate(copying, actions(copying)),
            f"Python, SyncVectorEnv of {few}": lambda: rate(single, actions(single))}
    measured = {name: [] for name in rows}
    for _ in range(rounds):
        for name, measure in rows.items():
            measured[name].append(measure())
processor = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "?")
print(f"{processor}, {threads} threads, Python {platform.python_version()}, {count} environments, {rounds} rounds of {seconds} s: median (least .. most)")
base = statistics.median(measured["C++"])
for name, values in measured.items():
    middle = statistics.median(values)
    print(f"{name:32} {middle / 1e3:10.1f}  ({min(values) / 1e3:.1f} .. {max(values) / 1e3:.1f}) thousand steps/s  {100 * middle / base:6.1f} % of C++")
