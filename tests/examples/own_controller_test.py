"""The needle comes to the centre: by the simulated sensor, by camera, and in Python in most episodes, simulated or on a rig."""
import re
import unittest

import support


class OwnController(unittest.TestCase):
    def test_the_needle_arrives(self):
        (command, *_) = support.versions("own_controller")
        said = [support.output(*command), support.output(*command, support.models / "segmenter")]
        self.assertNotEqual(*said)  # sensors do not err alike
        for text in said:
            off_mm = [float(word) for word in re.findall(r"s: ([\d.]+) mm", text)]
            self.assertEqual(len(off_mm), 41)
            self.assertAlmostEqual(off_mm[0], 25.0, delta=0.5)
            self.assertLess(max(off_mm[-10:]), 3.0)

    def test_the_same_function_drives_model_and_rig(self):
        for command in support.versions("own_controller")[1:]:
            said = support.output(*command, support.models / "dynamics_best")
            found = re.findall(r"^lodestone/(\w+)-v0: (\d+) of 20 episodes reached the centre, ([\d.]+) pulses each$", said, re.M)
            self.assertEqual([name for name, *_ in found], ["Mbs", "Rig"], said)
            for _, reached, pulses in found:
                self.assertGreaterEqual(int(reached), 15)
                self.assertLess(float(pulses), 20.0)


support.main()
