"""A controller of your own: a pull that grows with the distance, in the learned simulator and on a rig, by the same code.

    PYTHONPATH=build/release/python /usr/bin/python3 examples/own_controller.py models/dynamics_best

It needs Gymnasium. The rig is virtual and its sensor simulated; without `sensor` it is seen by camera, and with
rig="rig.json" it is a bench of yours.
"""
import sys

import gymnasium
import lodestone  # registers the environments
import numpy as np

BREAKAWAY, GAIN, EPISODES = 0.3, 0.8, 20  # of the largest current: what friction takes, and more per dish radius


def pull(observation):
    """Towards the centre; an observation begins with the needle's x and y in dish radii."""
    x_y = observation[:2]
    distance = np.linalg.norm(x_y)
    return -x_y / distance * min(1.0, BREAKAWAY + GAIN * distance)


def play(env):
    """How many episodes reach the centre, and after how many pulses on average."""
    reached, pulses = 0, 0
    for episode in range(EPISODES):
        observation, _ = env.reset(seed=1 if episode == 0 else None)
        over = False
        while not over:
            observation, reward, terminated, truncated, info = env.step(pull(observation))
            over = terminated or truncated
            pulses += 1
        reached += info["success"]
    return reached, pulses / EPISODES


for name, more in (("lodestone/Mbs-v0", {"dynamics": sys.argv[1]}), ("lodestone/Rig-v0", {"sensor": {"kind": "simulated"}})):
    env = gymnasium.make(name, task="centre", **more)
    reached, pulses = play(env)
    print(f"{name}: {reached} of {EPISODES} episodes reached the centre, {pulses:.1f} pulses each")
    env.close()
