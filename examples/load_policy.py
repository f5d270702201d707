"""Loads a policy and asks it for one pulse: where the needle lies and shall go in, the coils' currents out.

    PYTHONPATH=build/release/python /usr/bin/python3 examples/load_policy.py models/centre 0.010 0.020 0.1 0 0

After the policy come x and y of the needle in m, its heading in rad, x and y of the target in m.
"""
import sys

import lodestone

x_m, y_m, heading_rad, target_x_m, target_y_m = (float(word) for word in sys.argv[2:7])
policy = lodestone.Policy.load(sys.argv[1])
action = policy([x_m, y_m, heading_rad], [target_x_m, target_y_m])  # it remembers: reset() before another needle
print("action {:.6f} {:.6f}".format(*action))
for coil, current_A in zip(("+x", "-x", "+y", "-y"), policy.drives(action)):
    print(f"coil {coil} {current_A:.6f} {policy.action['unit']}")
