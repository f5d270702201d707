"""Gymnasium's own checker passes, with no other warnings than those below."""
import pathlib
import shutil
import tempfile
import unittest
import warnings

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env

import lodestone
import support

dynamics = lodestone.Dynamics.load(support.models / "dynamics_best")

# Observations are lengths in dish radii, which have no bound where a needle may be thrown out of the dish.
ALLOWED = {"A Box observation space minimum value is -infinity. This is probably too low.",
           "A Box observation space maximum value is infinity. This is probably too high."}


def check(test, identity, **arguments):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(gymnasium.make(identity, **arguments).unwrapped)
    plain = {str(warning.message).replace("\x1b[33mWARN: ", "").replace("\x1b[0m", "") for warning in caught}
    test.assertEqual(plain, ALLOWED)


class Environment(unittest.TestCase):
    def test_the_checker_passes(self):
        for task in ("centre", "point", "pose"):
            check(self, "lodestone/Mbs-v0", dynamics=dynamics, task=task)

    def test_it_can_be_made_by_name(self):
        env = gymnasium.make("lodestone/Mbs-v0", dynamics=support.models / "dynamics_paper", task={"goal": "centre"},
                             encoder={"heading": "sine_cosine"})
        observation, _ = env.reset(seed=1)
        self.assertEqual(observation.shape, env.observation_space.shape)
        self.assertEqual(env.unwrapped.contract["goal"], "centre")
        self.assertEqual(env.unwrapped.contract["encoder"]["heading"], "sine_cosine")

    def test_episodes_end_and_begin(self):
        env = lodestone.MbsEnv(dynamics, "centre")
        policy = lodestone.Policy.load(support.models / "centre")
        reached = 0
        for episode in range(20):
            observation, _ = env.reset(seed=3 if episode == 0 else None)
            for step in range(41):
                observation, reward, terminated, truncated, info = env.step(policy.act(observation))
                if terminated or truncated:
                    break
            self.assertTrue(terminated or truncated)
            reached += info["success"]
            with self.assertRaisesRegex(gymnasium.error.ResetNeeded, "call reset"):
                env.step([0.0, 0.0])
        self.assertGreater(reached, 15)

    def test_the_checker_passes_on_the_virtual_rig(self):
        check(self, "lodestone/Rig-v0", task="centre")
        check(self, "lodestone/Rig-v0", task="centre", render_mode="rgb_array")

    def test_a_policy_drives_the_virtual_rig_as_it_does_the_model(self):
        model = lodestone.MbsEnv(dynamics, "centre")
        rig = lodestone.RigEnv("centre", sensor={"kind": "simulated"})
        self.assertEqual(rig.observation_space, model.observation_space)
        self.assertEqual(rig.action_space, model.action_space)
        for part in ("encoder", "goal"):
            self.assertEqual(rig.contract[part], model.contract[part])
        self.assertEqual(rig.contract["action"]["scale"], model.contract["action"]["scale"])
        policy = lodestone.Policy.load(support.models / "centre")
        reached, first = 0, None
        for episode in range(6):
            observation, _ = rig.reset(seed=5 if episode in (0, 5) else None)
            if episode == 0:
                first = observation
            if episode == 5:
                np.testing.assert_array_equal(observation, first)
            over = False
            while not over:
                observation, _, terminated, truncated, info = rig.step(policy.act(observation))
                self.assertNotIn("stopped", info)
                over = terminated or truncated
            reached += info["success"]
            with self.assertRaisesRegex(gymnasium.error.ResetNeeded, "call reset"):
                rig.step([0.0, 0.0])
        self.assertGreaterEqual(reached, 4)
        with self.assertRaisesRegex(lodestone.ConfigError, "there is no camera"):
            lodestone.RigEnv("centre", sensor={"kind": "simulated"}, render_mode="rgb_array").render()

    def test_a_rig_refuses_what_only_a_recording_can_tell(self):
        with self.assertRaisesRegex(lodestone.ConfigError, "task.within = \"reachable\" must be disc"):
            lodestone.RigEnv("centre", sensor={"kind": "simulated"}, rules={"within": "reachable"})
        with self.assertRaisesRegex(TypeError, "unexpected argument 'mbs'"):
            lodestone.RigEnv("centre", sensor={"kind": "simulated"}, mbs={"pose_noise_m": 0.0})

    def test_a_reset_that_fails_leaves_the_rig_as_it_was(self):
        with tempfile.TemporaryDirectory() as place:
            segmenter = pathlib.Path(place) / "segmenter"
            shutil.copytree(support.models / "segmenter", segmenter)
            rig = lodestone.RigEnv("centre", sensor={"segmenter": str(segmenter)}, render_mode="rgb_array")
            first, _ = rig.reset(seed=1)
            shutil.rmtree(segmenter)
            with self.assertRaises(lodestone.CheckpointError):
                rig.reset(seed=2)
            self.assertEqual(rig.render().ndim, 3)
            rig.reset()
            self.assertEqual(rig.step([0.5, 0.0])[0].shape, first.shape)

    def test_the_camera_shows_the_rig(self):
        rig = lodestone.RigEnv("centre", render_mode="rgb_array")
        rig.reset(seed=1)
        image = rig.render()
        self.assertEqual((image.ndim, image.shape[2], image.dtype), (3, 3, np.uint8))
        self.assertGreater(image.std(), 10.0)
        rig.step([1.0, 0.0])
        self.assertFalse(np.array_equal(rig.render(), image))

    def test_the_supervisor_stands_in_front_of_the_rig(self):
        """A run that it stops is cut, says why, and is not gone on with until somebody re-arms it."""
        rig = lodestone.RigEnv("centre", sensor={"kind": "simulated"}, safety={"max_duty": 0.05, "duty_window_s": 0.5},
                               rules={"end_on_success": False, "end_on_dish_exit": False})
        rig.reset(seed=1)
        for _ in range(40):
            *_, terminated, truncated, info = rig.step([1.0, -1.0])
            if terminated or truncated:
                break
        self.assertTrue(truncated)
        self.assertIn("would be on for more than", info["stopped"])
        with self.assertRaises(lodestone.HardwareError) as caught:
            rig.reset()
        reason = info["stopped"].removeprefix("safety: ").split(";")[0]
        self.assertIn(reason, str(caught.exception))
        rig.rearm()
        rig.reset()
        rig.close()
        for use in (lambda: rig.step([0.0, 0.0]), rig.reset, rig.rearm):
            with self.assertRaisesRegex(gymnasium.error.ClosedEnvironmentError, "closed"):
                use()

    def test_a_rig_that_cannot_be_is_refused(self):
        for words, arguments in (("rig.backend", {"rig": {"backend": "cereal"}}), ("unknown key", {"rig": {"dsh": 1}}),
                                 ("safety.max_current_A", {"safety": {"max_current_A": 1000}}), ("rig.camera.source", {"rig": {"backend": "serial"}})):
            with self.assertRaisesRegex(lodestone.Error, words):
                lodestone.RigEnv("centre", sensor={"kind": "camera"}, **arguments)
        with self.assertRaisesRegex(FileNotFoundError, "nowhere.json"):
            lodestone.RigEnv("centre", rig="nowhere.json")

    def test_an_episode_can_be_left(self):
        env = lodestone.MbsEnv(dynamics, "centre")
        first, _ = env.reset(seed=3)
        second, _ = env.reset()
        self.assertFalse(np.array_equal(first, second))
        env.close()
        env.close()
        for use in (lambda: env.step([0.0, 0.0]), env.reset):
            with self.assertRaisesRegex(gymnasium.error.ClosedEnvironmentError, "closed"):
                use()


if __name__ == "__main__":
    support.main()
