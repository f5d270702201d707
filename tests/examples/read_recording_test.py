"""What is printed is what `lodestone evaluate dynamics` says of the same recording."""
import json
import re

import support


class ReadRecording(support.InFolder):
    def test_its_errors_are_those_of_evaluate(self):
        run, dynamics = self.folder / "collect", support.models / "dynamics_best"
        support.output(support.program, "collect", "--sensor", "simulated", "--set", "transitions=300", "--seed", "3", "--out", run)
        recording = run / "transitions.h5"
        own = json.loads(support.output(support.program, "evaluate", "dynamics", "--checkpoint", dynamics, "--data", recording))
        facts = json.loads((run / "summary.json").read_text())
        said = [support.output(*command, recording, dynamics) for command in support.versions("read_recording")]
        self.assertEqual(len(set(said)), 1, said)
        pulses, episodes, simulator_mm, still_mm = map(float, re.findall(r"\d+(?:\.\d+)?", said[0]))
        self.assertEqual([pulses, episodes], [facts["transitions_with_current"], facts["episodes"]])
        self.assertLess(pulses, facts["transitions"])
        self.assertAlmostEqual(simulator_mm, own["position_rms_mm"], delta=2e-5)
        self.assertAlmostEqual(still_mm, own["baselines"]["no_motion"]["position_rms_mm"], delta=2e-5)
        self.assertLess(simulator_mm, 0.5 * still_mm)


support.main()
