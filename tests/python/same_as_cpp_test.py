"""The package gives what C++ gives, to the last bit."""
import json
import subprocess
import tempfile
import unittest

import numpy as np

import lodestone
from lodestone.tasks import environment_config
import support


def number(i):
    return ((i * 7919) % 2001 - 1000) / 1000.0


def decisions(controller):
    for i in range(8):
        pose = [0.03 * number(i), 0.03 * number(i + 50), 3.0 * number(i + 70)]
        yield from controller(pose, [0.01, -0.005])


def steps(environments):
    yield from environments.reset(seed=5)[0].ravel()
    for step in range(60):
        actions = np.array([number(step * 31 + i) for i in range(100)], np.float32).reshape(50, 2)
        observation, reward, terminated, truncated, infos = environments.step(actions)
        yield from observation.ravel()
        for column in (reward, terminated, truncated, infos["success"]):
            yield from column.astype(float)
        yield from infos.get("final_obs", observation).ravel()


class SameAsCpp(unittest.TestCase):
    def test_every_number(self):
        dynamics = lodestone.Dynamics.load(support.models / "dynamics_best")
        state = [[0.03 * number(3 * i), 0.03 * number(3 * i), 3.0 * number(3 * i + 2)] for i in range(20)]
        drive = [[15.0 * number(100 + 2 * i), 15.0 * number(101 + 2 * i)] for i in range(20)]
        prediction = dynamics.predict(state, drive)
        ours = [*prediction.mean.ravel()]
        for member in range(dynamics.members):
            for part in (prediction.weight, prediction.component_mean, prediction.spread):
                ours += [*part[member].ravel()]
        ours += decisions(lodestone.Policy.load(support.models / "any_rig"))
        ours += decisions(lodestone.Planner(dynamics, seed=9))
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            file.write(environment_config("point"))
            file.flush()
            made = subprocess.run([support.as_cpp, "values", support.models / "dynamics_best", support.models / "any_rig",
                                   file.name], stdout=subprocess.PIPE, check=True)
        ours += steps(lodestone.make_vec(dynamics, 50, "point", threads=2))
        theirs = np.frombuffer(made.stdout)
        self.assertEqual(len(ours), len(theirs))
        np.testing.assert_array_equal(np.array(ours, float), theirs)

    def test_examples_of_the_checkpoints(self):
        """What the checkpoints were made with, on whatever processor: within rounding."""
        for name in ("centre", "target"):
            policy = lodestone.Policy.load(support.models / name)
            content = (support.models / name / "examples.safetensors").read_bytes()
            header = int.from_bytes(content[:8], "little")
            entries = json.loads(content[8:8 + header])
            seen, done = (np.frombuffer(content[8 + header:], np.float32, offset=entries[key]["data_offsets"][0],
                                        count=int(np.prod(entries[key]["shape"]))).reshape(entries[key]["shape"])
                          for key in ("observation", "action"))
            np.testing.assert_allclose(policy.act(seen), done, atol=1e-5)

    def test_threads_and_rows_change_nothing(self):
        dynamics = lodestone.Dynamics.load(support.models / "dynamics_best")
        whole = dynamics.predict([[0.01, 0.0, 0.1], [0.0, 0.02, -2.0]], [[3.0, 0.0], [-6.0, 9.0]])
        one = dynamics.predict([0.0, 0.02, -2.0], [-6.0, 9.0])
        np.testing.assert_array_equal(whole.mean[1], one.mean)
        np.testing.assert_array_equal(whole.component_mean[:, 1], one.component_mean)
        self.assertEqual(one.weight.shape, (4, 3))
        np.testing.assert_allclose(one.weight.sum(axis=1), 1.0, rtol=1e-6)


support.main()
