"""Reads a finished run of `lodestone deploy` and measures it anew from its rows, beside the figures that it has written.

    /usr/bin/python3 examples/read_run.py runs/deploy

Of a point the error is the distance to it at the end, of a path the RMS distance to the target that moves along it. It
needs numpy, and no Lodestone. Only a virtual rig knows where the needle truly is; of another take sensed_x_m, sensed_y_m.
"""
import collections
import csv
import itertools
import json
import operator
import pathlib
import sys

import numpy as np

folder = pathlib.Path(sys.argv[1])
if not json.loads((folder / "run.json").read_text())["finished"]:
    sys.exit(f"{folder} is not finished: --resume goes on")
summary = json.loads((folder / "summary.json").read_text())


def figures(rig, controller, task):
    """What deploy has found: with several rigs below their names, the baseline's own below "baseline"."""
    of_rig = summary.get(rig, summary)
    return (of_rig["baseline"] if controller == "baseline" else of_rig)[task]


def distances_mm(rows):
    """From needle to target at every observation, without the way to the start of a path."""
    needle, target = (np.array([[row[f"{whose}_x_m"], row[f"{whose}_y_m"]] for row in rows if row["approach"] == "0"], float)
                      for whose in ("true", "target"))
    return 1e3 * np.linalg.norm(needle - target, axis=1)


errors_mm = collections.defaultdict(list)
with open(folder / "trajectories.csv", newline="") as file:  # a row for each observation
    for (*what, _), rows in itertools.groupby(csv.DictReader(file), operator.itemgetter("rig", "controller", "task", "trial")):
        distance_mm = distances_mm([*rows])
        on_path = "time_rms_error_mm" in figures(*what)
        errors_mm[(*what,)].append(np.sqrt(np.mean(distance_mm**2)) if on_path else distance_mm[-1])
for what, errors in errors_mm.items():
    own = figures(*what)
    print(*what, f"{np.mean(errors):.6f} mm, deploy wrote {own.get('time_rms_error_mm', own['mean_error_mm']):.6f} mm")
