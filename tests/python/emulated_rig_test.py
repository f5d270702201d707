"""RigEnv on an emulated bench: the same class and policy as on the virtual rig, through the firmware, a serial line and a camera."""
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

import numpy as np

import lodestone
import support

# A machine that is busy with something else may be late; that is not what is tested here.
PATIENT = {"max_late_s": 1.0, "max_late_steps": 10, "max_pose_age_s": 2.0}


class EmulatedRig(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bench = pathlib.Path(folder.name) / "bench.json"
        self.emulator = subprocess.Popen([support.program, "rig", "emulate", "--out", self.bench], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                         stderr=subprocess.STDOUT, text=True, cwd=support.source)
        self.addCleanup(self.end_emulator)
        end_s = time.monotonic() + 60
        while not self.bench.exists():
            self.assertIsNone(self.emulator.poll(), "the emulator has ended")
            self.assertLess(time.monotonic(), end_s, "no bench")
            time.sleep(0.1)

    def end_emulator(self):
        self.emulator.send_signal(signal.SIGINT)
        self.emulator.communicate(timeout=20)

    def test_a_policy_drives_it_until_it_vanishes(self):
        placed = []
        env = lodestone.RigEnv("centre", rig=self.bench, operator=lambda *pose: placed.append(pose), render_mode="rgb_array", safety=PATIENT,
                               rules={"end_on_success": False})
        policy = lodestone.Policy.load(support.models / "centre")
        self.assertEqual(env.observation_space.shape, (policy.observation_size,))
        observation, _ = env.reset(seed=1)
        self.assertEqual(len(placed), 1)  # somebody was asked to place it
        scale_m = env.contract["encoder"]["length_scale_m"]

        def drive(decide, steps):
            """Where the needle is before and after, x and y in m."""
            nonlocal observation
            before = observation[:2] * scale_m
            for _ in range(steps):
                observation, _, terminated, truncated, info = env.step(decide(observation))
                self.assertFalse(terminated or truncated, info)
            return before, observation[:2] * scale_m

        before, after = drive(lambda _: np.array([1.0, 0.0]), 4)
        self.assertGreater(after[0] - before[0], 0.003)  # coil +x pulls it there,
        before, after = drive(policy.act, 12)
        self.assertLess(np.linalg.norm(after), 0.7 * np.linalg.norm(before))  # and the policy brings it back
        image = env.render()
        self.assertEqual((image.ndim, image.shape[2], image.dtype), (3, 3, np.uint8))
        self.assertGreater(image.std(), 5)

        self.emulator.kill()
        for _ in range(20):
            observation, _, terminated, truncated, info = env.step(policy.act(observation))
            if truncated:
                break
        self.assertTrue(truncated and not terminated, info)
        self.assertTrue(info["stopped"])
        with self.assertRaises(lodestone.HardwareError):
            env.reset()
        env.close()

    def test_without_somebody_to_place_the_needle(self):
        env = lodestone.RigEnv("centre", rig=self.bench, safety=PATIENT)
        with self.assertRaisesRegex(lodestone.Error, "operator|place"):
            env.reset(seed=1)
        env.close()


support.main()
