"""Stable-Baselines3's TD3 learns in the learned simulator, and `lodestone deploy` drives a rig with its actor. In a soak it learns the centre."""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import gymnasium
import numpy as np
import torch
from stable_baselines3 import SAC, TD3
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.vec_env import VecMonitor

import lodestone
import support

sys.path.append(str(support.source / "tests/apps"))
import soak

SAMPLE, WHOLE, BETWEEN = 3_000, 120_000, 10_000  # environment steps; an evaluation every BETWEEN
EPISODES = 256
TRIALS = 50  # on a rig


def make_model(dynamics):
    """TD3 with the numbers of configs/fast/policy_centre.json."""
    torch.set_num_threads(1)
    environments = lodestone.Sb3VecEnv(lodestone.make_vec(dynamics, 32, "centre", seed=1, threads=1))
    return TD3("MlpPolicy", environments, learning_rate=lambda left: 1e-3 * max(left, 0.1), buffer_size=100_000, learning_starts=2000, batch_size=256,
               gamma=0.97, train_freq=1, gradient_steps=4, action_noise=NormalActionNoise(np.zeros(2), np.full(2, 0.15)), target_policy_noise=0.1,
               target_noise_clip=0.25, policy_kwargs={"net_arch": [128, 128]}, seed=1)


def first_episodes(act, environments, seed):
    """Mean return and success rate of the first episode of each environment."""
    observation, _ = environments.reset(seed=seed)
    reached, over = np.zeros((2, EPISODES), bool)
    returns = np.zeros(EPISODES)
    while not over.all():
        observation, reward, terminated, truncated, infos = environments.step(act(observation))
        returns += np.where(over, 0.0, reward)
        reached |= infos["success"] & ~over
        over |= terminated | truncated
    return returns.mean(), reached.mean()


class KeepBest(BaseCallback):
    """Keeps the actor with the best mean return, as train-policy does."""

    def __init__(self, environments):
        super().__init__()
        self.environments, self.best, self.actor = environments, -np.inf, None

    def _on_step(self):
        if self.num_timesteps % BETWEEN < self.training_env.num_envs:
            mean, rate = first_episodes(lambda seen: self.model.predict(seen, deterministic=True)[0], self.environments, seed=7)
            print(f"{self.num_timesteps} steps: return {mean:.2f}, success {100 * rate:.1f} %", flush=True)
            if mean > self.best:
                self.best, self.actor = mean, copy.deepcopy(self.model.policy.actor.state_dict())
        return True


def learn(model, environments):
    """A sample of the training, or in a soak all of it."""
    if not soak.whole:
        return model.learn(SAMPLE)
    kept = KeepBest(environments)
    model.learn(WHOLE, callback=kept)
    model.policy.actor.load_state_dict(kept.actor)
    return model


def run(*arguments, place):
    made = subprocess.run([support.program, *map(str, arguments)], capture_output=True, text=True, cwd=place)
    assert made.returncode == 0, made.stderr


def deploy(policy, trials, place, name):
    """The trials of a policy alone on a virtual rig."""
    run("deploy", "--policy", policy, "--task", "centre", "--trials", trials, "--seed", 9001, "--sensor", "simulated", "--out", name, place=place)
    return [trial for trial in json.loads((pathlib.Path(place) / name / "trials.json").read_text()) if trial["controller"] == "policy"]


class StableBaselines(unittest.TestCase):
    def test_its_actor_becomes_a_policy(self):
        dynamics = lodestone.Dynamics.load(support.models / "dynamics_best")
        environments = lodestone.make_vec(dynamics, EPISODES, "centre", threads=1)
        model = learn(make_model(dynamics), environments)
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place) / "policy"
            lodestone.save_policy(folder, lodestone.actor_layers(model.policy.actor), contract=environments.contract)
            policy = lodestone.Policy.load(folder)
            observation, _ = environments.reset(seed=78)
            np.testing.assert_allclose(policy.act(observation), model.predict(observation, deterministic=True)[0], atol=1e-5)
            mean, rate = first_episodes(policy.act, environments, seed=77)
            print(f"{EPISODES} fresh episodes after {model.num_timesteps} steps: return {mean:.2f}, success {100 * rate:.1f} %")
            trials = deploy(folder, TRIALS if soak.whole else 2, place, "driven")
            self.assertTrue(all(trial["completed"] for trial in trials))
            if soak.whole:
                self.assertGreaterEqual(rate, 0.95)
                run("train-policy", "--config", support.source / "configs/fast/policy_centre.json", "--set", f"dynamics={support.models}/dynamics_best",
                    "--set", f"training.env_steps={WHOLE}", "--out", "native", place=place)
                native = deploy("native/checkpoint", TRIALS, place, "driven_natively")
                errors = [np.mean([trial["final_error_mm"] for trial in driven]) for driven in (trials, native)]
                print(f"{TRIALS} trials on a rig: {errors[0]:.2f} mm, trained natively {errors[1]:.2f} mm")
                self.assertLessEqual(errors[0], 1.1 * errors[1])
        soak.told(model.num_timesteps, "steps of Stable-Baselines3's TD3")

    def test_a_batch_is_what_it_wants(self):
        """Its own wrapper agrees on rewards and ends; what it is given is its to keep."""
        environments = lodestone.Sb3VecEnv(lodestone.make_vec(support.models / "dynamics_best", 4, "centre", threads=1))
        environments.seed(3)
        first = VecMonitor(environments).reset()
        held = first.copy()
        ends = []
        for step in range(45):
            observation, reward, done, infos = environments.step(np.zeros((4, 2), np.float32))
            for i in np.flatnonzero(done):
                ends.append(infos[i])
        np.testing.assert_array_equal(first, held)
        self.assertEqual(len(ends), 4)  # nothing moved, so all were cut
        self.assertTrue(all(end["TimeLimit.truncated"] and not end["is_success"] for end in ends))
        self.assertEqual(ends[0]["terminal_observation"].shape, observation[0].shape)

    def test_another_network_is_refused(self):
        environments = lodestone.Sb3VecEnv(lodestone.make_vec(lodestone.Dynamics.load(support.models / "dynamics_best"), 2))
        model = TD3("MlpPolicy", environments, policy_kwargs={"activation_fn": torch.nn.Tanh, "net_arch": [8]})
        with self.assertRaisesRegex(ValueError, "ReLU between them"):
            lodestone.actor_layers(model.policy.actor)
        other = SAC("MlpPolicy", environments, policy_kwargs={"net_arch": [8]})
        with self.assertRaisesRegex(ValueError, "one of TD3 or DDPG"):
            lodestone.actor_layers(other.policy.actor)

    def test_environments_of_gymnasium_s_own_are_refused_and_those_of_sb3_work(self):
        more = {"dynamics": str(support.models / "dynamics_best"), "task": "centre"}
        synchronous = gymnasium.make_vec("lodestone/Mbs-v0", 2, vectorization_mode="sync", **more)
        with self.assertRaisesRegex(ValueError, "SAME_STEP"):
            lodestone.Sb3VecEnv(synchronous)
        self.assertEqual(make_vec_env("lodestone/Mbs-v0", n_envs=2, env_kwargs=more).reset().shape[0], 2)


support.main()
