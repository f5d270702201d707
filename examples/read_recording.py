"""Reads a recording and holds a learned simulator against it: the figures of `lodestone evaluate dynamics`.

    PYTHONPATH=build/release/python /usr/bin/python3 examples/read_recording.py runs/collect/transitions.h5 models/dynamics_best
"""
import sys

import lodestone
import numpy as np

recording = lodestone.Transitions.load(sys.argv[1])
dynamics = lodestone.Dynamics.load(sys.argv[2])
pulsed = ~recording.zero_current  # what nothing was applied to, nobody trains on
state, action, after = recording.state[pulsed], recording.action[pulsed], recording.next_state[pulsed]


def rms_mm(predicted):
    return 1e3 * np.sqrt(np.mean(np.sum((predicted - after)[:, :2] ** 2, axis=1)))


print(f"pulses {len(after)} in {recording.episode[-1] + 1} episodes, drives in {recording.info['action_unit']}")
print(f"simulator {rms_mm(dynamics.predict(state, action).mean):.6f} mm RMS, a needle that stays {rms_mm(state):.6f} mm")
