"""The needle comes to the centre, by pulses that the log holds and that keep to the supervisor's limit."""
import csv
import re

import support


class OwnCoils(support.InFolder):
    def test_the_needle_arrives_within_the_limit(self):
        log = self.folder / "pulses.csv"
        (command,) = support.versions("own_coils")
        said = support.output(*command, log)
        found = re.fullmatch(r"(\d+) pulses, (\d+) of them cut to 10 A: from ([\d.]+) mm to ([\d.]+) mm off the centre\n", said)
        pulses, cut, before_mm, after_mm = map(float, found.groups())
        self.assertGreater(before_mm, 20.0)
        self.assertLess(after_mm, 2.0)
        with open(log, newline="") as file:
            rows = [[float(cell) for cell in row.values()] for row in csv.DictReader(file)]
        self.assertEqual(len(rows), pulses)
        currents_A = [row[:4] for row in rows]
        self.assertEqual(max(map(max, currents_A)), 10.0)
        self.assertEqual(min(map(min, currents_A)), 0.0)
        self.assertEqual(sum(10.0 in row for row in currents_A), cut)
        self.assertGreater(cut, 0)
        self.assertTrue(all(px * mx == 0.0 and py * my == 0.0 for px, mx, py, my in currents_A))
        self.assertEqual({row[4] for row in rows}, {0.1})

    def test_it_wants_a_log(self):
        (command,) = support.versions("own_coils")
        self.assertIn("usage", support.refusal(*command))
        self.assertIn("cannot be written", support.refusal(*command, self.folder / "nowhere/pulses.csv"))


support.main()
