"""The figures are measured from the recorded motion, and are those of the run."""
import json
import pathlib
import re
import shutil
import tempfile

import support

OF_A_PATH = ("cross_track_rms_mm", "time_rms_error_mm")  # what is measured in C++ and in Python


class ReadRun(support.InFolder):
    @classmethod
    def setUpClass(cls):
        place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(place.cleanup)
        cls.deployed = pathlib.Path(place.name) / "run"
        support.output(support.program, "deploy", "--models", support.models / "target", "--task", "all", "--controller", "both", "--on", "both",
                       "--sensor", "simulated", "--trials", "2", "--seed", "1", "--threads", "1", "--out", cls.deployed)

    def deploy(self):
        """A copy of a finished run."""
        return shutil.copytree(self.deployed, self.folder / "run")

    def figures(self, command, run):
        """(rig, controller, task): measured, and as deploy wrote it."""
        found = re.findall(r"^(\w+) (\w+) (\w+) ([\d.]+) mm, deploy wrote ([\d.]+) mm$", support.output(*command, run), re.M)
        return {tuple(what): (float(measured), float(written)) for *what, measured, written in found}

    def test_they_equal_the_summary(self):
        run = self.deploy()
        summary = json.loads((run / "summary.json").read_text())
        for command, of_a_path in zip(support.versions("read_run"), OF_A_PATH):
            figures = self.figures(command, run)
            self.assertEqual(len(figures), 2 * 2 * 4)
            for (rig, controller, task), (measured, written) in figures.items():
                own = (summary[rig]["baseline"] if controller == "baseline" else summary[rig])[task]
                own_mm = own["mean_error_mm" if task in ("centre", "point") else of_a_path]
                self.assertAlmostEqual(measured, own_mm, delta=2e-5)
                self.assertAlmostEqual(written, own_mm, delta=1e-6)

    def test_they_are_measured(self):
        """A needle that lay elsewhere at the end has another error, whatever the summary says."""
        run = self.deploy()
        before = [self.figures(command, run) for command in support.versions("read_run")]
        trials = json.loads((run / "unseen/trials.json").read_text())
        first = next(trial for trial in trials if (trial["controller"], trial["task"]) == ("policy", "centre"))
        first["trajectory"][-1][:2] = [10.0, 0.0]
        (run / "unseen/trials.json").write_text(json.dumps(trials))
        lines = (run / "trajectories.csv").read_text().splitlines()
        last = max(i for i, line in enumerate(lines) if line.startswith("unseen,policy,centre,0,"))
        cells = lines[last].split(",")
        cells[5:7] = "0.010", "0"
        lines[last] = ",".join(cells)
        (run / "trajectories.csv").write_text("\n".join(lines) + "\n")
        what = ("unseen", "policy", "centre")
        for command, was in zip(support.versions("read_run"), before):
            now = self.figures(command, run)
            self.assertGreater(now[what][0], was[what][0] + 4.0)
            self.assertEqual(now[what][1], was[what][1])
            self.assertEqual({key: pair for key, pair in now.items() if key != what}, {key: pair for key, pair in was.items() if key != what})

    def test_a_run_that_goes_on_is_refused(self):
        run = self.deploy()
        state = json.loads((run / "run.json").read_text())
        (run / "run.json").write_text(json.dumps({**state, "finished": False}))
        for command in support.versions("read_run"):
            self.assertIn("finished", support.refusal(*command, run))


support.main()
