"""The vector environment keeps Gymnasium's promises: there is no checker for one, so this is it."""
import json
import pathlib
import re
import sys
import tempfile
import threading
import time
import unittest

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv

import lodestone
import support

dynamics = lodestone.Dynamics.load(support.models / "dynamics_best")
COUNT = 6


def make(count=COUNT, **more):
    return lodestone.make_vec(dynamics, count, "centre", **more)


def actions(environments, step):
    return np.random.default_rng(step).uniform(-1, 1, environments.action_space.shape).astype(np.float32)


def played(environments, steps=80):
    """Copies of all that a run of steps gives."""
    for step in range(steps):
        *columns, infos = environments.step(actions(environments, step))
        yield [column.copy() for column in columns], infos


class Conformance(unittest.TestCase):
    def test_it_is_one_and_says_what_it_does(self):
        environments = make()
        self.assertIsInstance(environments, VectorEnv)
        self.assertIs(environments.metadata["autoreset_mode"], AutoresetMode.SAME_STEP)
        self.assertEqual(environments.num_envs, COUNT)
        self.assertEqual(environments.single_action_space, gymnasium.spaces.Box(-1, 1, (2,), np.float32))
        self.assertEqual(environments.action_space.shape, (COUNT, 2))
        self.assertEqual(environments.observation_space.shape, (COUNT, *environments.single_observation_space.shape))

    def test_it_gives_what_single_ones_would(self):
        """Gymnasium's own vector environment of as many MbsEnv, step by step and word by word."""
        ours = make()
        theirs = SyncVectorEnv([lambda i=i: lodestone.MbsEnv(dynamics, "centre", stream=i) for i in range(COUNT)],
                               autoreset_mode=AutoresetMode.SAME_STEP)
        first, infos = ours.reset(seed=11)
        np.testing.assert_array_equal(first, theirs.reset(seed=[11] * COUNT)[0])
        self.assertEqual(infos, {})
        ends = cuts = 0
        for (mine, my), (their, other) in zip(played(ours), played(theirs)):
            for one, two in zip(mine[:1] + mine[2:], their[:1] + their[2:]):
                np.testing.assert_array_equal(one, two)
            np.testing.assert_array_equal(mine[1], their[1].astype(np.float32))
            ended = mine[2] | mine[3]
            self.assertEqual("final_obs" in my, bool(ended.any()))
            self.assertEqual("final_obs" in my, "final_obs" in other)
            if ended.any():
                for mask in ("_final_obs", "_final_info"):
                    np.testing.assert_array_equal(my[mask], ended)
                    np.testing.assert_array_equal(my[mask], other[mask])
                for i in np.flatnonzero(ended):
                    np.testing.assert_array_equal(my["final_obs"][i], other["final_obs"][i])
                    self.assertEqual(my["final_info"]["success"][i], other["final_info"]["success"][i])
            self.assertTrue(my["_success"].all())
            self.assertFalse((mine[2] & mine[3]).any())
            ends += int(mine[2].sum())
            cuts += int(mine[3].sum())
        self.assertGreater(ends, 0)
        self.assertGreater(cuts, 0)

    def test_types_and_spaces_hold_in_every_step(self):
        environments = make()
        observation, _ = environments.reset(seed=1)
        self.assertIn(observation, environments.observation_space)
        for (observation, reward, terminated, truncated), infos in played(environments):
            self.assertIn(observation, environments.observation_space)
            self.assertEqual((reward.dtype, terminated.dtype, truncated.dtype), (np.float32, np.bool_, np.bool_))
            self.assertTrue(np.isfinite(observation).all() and np.isfinite(reward).all())
            if "final_obs" in infos:
                self.assertIn(infos["final_obs"], environments.observation_space)

    def test_the_seed_decides_and_the_threads_do_not(self):
        one, two = make(600, threads=1), make(600, threads=3)
        np.testing.assert_array_equal(one.reset(seed=4)[0], two.reset(seed=4)[0])
        for (mine, _), (their, _) in zip(played(one, 20), played(two, 20)):
            for column, other in zip(mine, their):
                np.testing.assert_array_equal(column, other)
        again = one.reset(seed=4)[0].copy()
        onward = one.reset()[0].copy()
        np.testing.assert_array_equal(again, two.reset(seed=4)[0])
        np.testing.assert_array_equal(onward, two.reset()[0])
        self.assertFalse(np.array_equal(again, onward))
        self.assertFalse(np.array_equal(again, one.reset(seed=5)[0]))
        self.assertEqual(one.np_random_seed, 5)
        given = make(600, seed=4)
        np.testing.assert_array_equal(given.reset()[0], again)
        self.assertFalse(np.array_equal(make().reset()[0], make().reset()[0]))  # nobody named one

    def test_arrays_are_views_that_outlive_it(self):
        environments = make()
        observation, _ = environments.reset(seed=1)
        self.assertFalse(observation.flags.writeable or observation.flags.owndata)
        stepped, reward, *_ = environments.step(actions(environments, 0))
        again, *_ = environments.step(actions(environments, 1))
        self.assertTrue(np.shares_memory(stepped, again))
        self.assertTrue(np.shares_memory(observation, again))
        held = again.copy()
        environments.reset(seed=2)  # new buffers
        np.testing.assert_array_equal(again, held)
        environments.close()
        del environments
        np.testing.assert_array_equal(again, held)
        self.assertEqual(reward.shape, (COUNT,))
        copying = make(copy=True)
        first, _ = copying.reset(seed=1)
        stepped, *_ = copying.step(actions(copying, 0))
        self.assertFalse(np.shares_memory(first, stepped))
        np.testing.assert_array_equal(first, make().reset(seed=1)[0])

    def test_other_threads_go_on_while_it_steps(self):
        """The interpreter's lock is free: another thread counts meanwhile, and two may step one environment."""
        environments = make(20000, threads=1)
        environments.reset(seed=1)
        counted, over = [0], threading.Event()

        def count():
            while not over.is_set():
                counted[0] += 1
                time.sleep(0)  # gives the lock back by itself

        thread = threading.Thread(target=count)
        chosen = actions(environments, 0)
        during = 0
        interval = sys.getswitchinterval()
        sys.setswitchinterval(60)  # nobody else takes the lock: the thread counts while step() leaves it free, and at no other time
        self.addCleanup(sys.setswitchinterval, interval)
        thread.start()
        for _ in range(5):
            before = counted[0]
            environments.step(chosen)
            during += counted[0] - before
        over.set()
        thread.join()
        sys.setswitchinterval(interval)
        self.assertGreater(during, 100)
        threads = [threading.Thread(target=lambda: [environments.step(chosen) for _ in range(3)]) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(np.isfinite(environments.step(chosen)[0]).all())

    def test_gymnasium_makes_it_and_wraps_it(self):
        environments = gymnasium.make_vec("lodestone/Mbs-v0", COUNT, vectorization_mode="vector_entry_point",
                                          dynamics=dynamics, task="centre")
        environments = gymnasium.wrappers.vector.RecordEpisodeStatistics(environments)
        environments.reset(seed=1)
        episodes = [infos["episode"]["l"][infos["_episode"]] for _, infos in played(environments) if "episode" in infos]
        self.assertGreater(len(np.concatenate(episodes)), 0)

    def test_every_shipped_preset_is_played(self):
        """Of policies; what it says of learning is left out."""
        for preset in sorted(support.source.glob("configs/*/policy*.json")):
            with self.subTest(preset.name):
                goal = json.loads(re.sub(r"^\s*//.*$", "", preset.read_text(), flags=re.M)).get("task", {}).get("goal", "centre")
                self.assertEqual(lodestone.make_vec(dynamics, 2, preset).contract["goal"], goal)

    def test_a_preset_may_have_comments_as_on_the_command_line(self):
        with tempfile.TemporaryDirectory() as place:
            preset = pathlib.Path(place) / "preset.json"
            preset.write_text('{"task": {"goal": "pose"} /* here, */ // and here\n}')
            self.assertEqual(lodestone.make_vec(dynamics, 2, preset).contract["goal"], "pose")

    def test_a_closed_one_refuses(self):
        environments = make()
        with self.assertRaisesRegex(gymnasium.error.ResetNeeded, "call reset"):
            environments.step(actions(environments, 0))
        environments.reset(seed=1)
        environments.close()
        environments.close()
        with self.assertRaisesRegex(gymnasium.error.ClosedEnvironmentError, "closed"):
            environments.step(actions(environments, 0))
        with self.assertRaisesRegex(gymnasium.error.ClosedEnvironmentError, "closed"):
            environments.reset()


support.main()
