"""The currents are those that `lodestone deploy` has given for the same pose, and the same in every language."""
import csv

import support


class LoadPolicy(support.InFolder):
    def test_it_acts_as_deploy_does(self):
        run = self.folder / "run"
        support.output(support.program, "deploy", "--policy", support.models / "target", "--task", "point", "--controller", "policy",
                       "--sensor", "simulated", "--trials", "4", "--seed", "5", "--threads", "1", "--out", run)
        with open(run / "trajectories.csv", newline="") as file:
            first = [row for row in csv.DictReader(file) if float(row["t_s"]) == 0.0]  # nothing to remember yet
        self.assertEqual(len(first), 4)
        commands = support.versions("load_policy")
        for row in first:
            seen = [row[name] for name in ("sensed_x_m", "sensed_y_m", "sensed_heading_rad", "target_x_m", "target_y_m")]
            said = [support.output(*command, support.models / "target", *seen) for command in commands]
            self.assertEqual(len(set(said)), 1, said)
            lines = [line.split() for line in said[0].splitlines()]
            for word, axis in zip(lines[0][1:], "xy"):
                self.assertAlmostEqual(float(word), float(row[f"action_{axis}"]), delta=2e-5)
            self.assertEqual([line[1] for line in lines[1:]], ["+x", "-x", "+y", "-y"])
            for line, coil in zip(lines[1:], ("px", "mx", "py", "my")):
                self.assertAlmostEqual(float(line[2]), float(row[f"current_{coil}_A"]), delta=3e-4)
                self.assertEqual(line[3], "A")
            self.assertGreater(max(float(line[2]) for line in lines[1:]), 1.0)

    def test_a_folder_without_one_is_refused(self):
        for command in support.versions("load_policy"):
            self.assertIn(str(self.folder), support.refusal(*command, self.folder, 0, 0, 0, 0, 0))

    def test_what_is_no_number_is_refused(self):
        for command in support.versions("load_policy"):
            self.assertIn("here", support.refusal(*command, support.models / "target", "here", 0, 0, 0, 0))


support.main()
