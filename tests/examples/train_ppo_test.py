"""It learns, alike in every run, and what it has learned drives a rig that it never saw. Whole in C++; in Python, where it takes
minutes, the first updates only, unless this is the soak.
"""
import json
import re

import soak
import support

TRIALS = 20


class TrainPpo(support.InFolder):
    def train(self, command, name, *updates):
        """The policy's folder, and the share of episodes in per cent that reached the centre in each update."""
        preset = [support.source / "configs/fast/policy_centre.json"] if len(command) == 1 else []  # Python finds its own
        said = support.output(*command, *preset, support.models / "dynamics_best", self.folder / name, *updates)
        found = re.findall(r"^update (\d+): ([\d.]+) % reached the centre", said, re.M)
        self.assertEqual([int(update) for update, _ in found], list(range(1, 1 + len(found))))
        return self.folder / name, [float(share) for _, share in found]

    def success_on_a_rig(self, policy):
        run = self.folder / f"{policy.name}-on-a-rig"
        support.output(support.program, "deploy", "--policy", policy, "--task", "centre", "--controller", "policy", "--sensor", "simulated",
                       "--trials", str(TRIALS), "--seed", "9001", "--threads", "1", "--out", run)
        summary = json.loads((run / "summary.json").read_text())["centre"]
        self.assertEqual((summary["n_trials"], summary["stopped"]), (TRIALS, 0))
        return summary["success_rate"]

    def check(self, command):
        young, beginning = self.train(command, "young", 2)
        grown, shares = self.train(command, "grown")
        self.assertEqual(len(beginning), 2)
        self.assertEqual(len(shares), 40)
        self.assertEqual(shares[:2], beginning)
        self.assertLess(max(shares[:3]), 15.0)
        self.assertGreater(min(shares[-3:]), 85.0)
        before, after = self.success_on_a_rig(young), self.success_on_a_rig(grown)
        print(f"{command[-1].name}: {shares[0]} % -> {shares[-1]} % of the episodes; on a rig {100 * before:.0f} % -> {100 * after:.0f} %")
        self.assertLess(before, 0.4)
        self.assertGreaterEqual(after, 0.7)

    def test_in_cpp(self):
        self.check(support.versions("train_ppo")[0])

    def test_in_python(self):
        for command in support.versions("train_ppo")[1:]:
            soak.told(40 if soak.whole else 2, "updates of PPO in Python")
            if soak.whole:
                self.check(command)
                continue
            _, shares = self.train(command, "python", 2)
            self.assertEqual(shares, self.train(command, "python-again", 2)[1])
            self.assertLess(max(shares), 15.0)
            self.success_on_a_rig(self.folder / "python")  # it drives; how well is the soak's to tell


support.main()
