"""Lodestone's environments for Stable-Baselines3, and its actors for Lodestone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

__all__ = ["Sb3VecEnv", "actor_layers"]


class Sb3VecEnv(VecEnv):
    """A vector environment of Gymnasium that resets in the same step, as Stable-Baselines3 wants it.

    Stable-Baselines3 keeps what it is given, so it gets copies.
    """

    def __init__(self, environment: VectorEnv) -> None:
        """
        Args:
            environment: of make_vec()

        Raises:
            ValueError: one that begins the next episode in a step of its own
        """
        if environment.metadata.get("autoreset_mode") != AutoresetMode.SAME_STEP:
            raise ValueError(f"the environment resets by {environment.metadata.get('autoreset_mode')}, must by "
                             "AutoresetMode.SAME_STEP: take one of lodestone.make_vec()")
        self.environment = environment
        super().__init__(environment.num_envs, environment.single_observation_space, environment.single_action_space)
        self._actions: NDArray[np.float32] | None = None

    def reset(self) -> NDArray[np.float32]:
        """New episodes everywhere, from the seed that seed() named if it did: observations [N, D]."""
        observation, _ = self.environment.reset(seed=self._seeds[0])
        self._reset_seeds()
        self._reset_options()
        return observation.copy()

    def step_async(self, actions: NDArray[np.float32]) -> None:
        """Remembers the actions [N, A]."""
        self._actions = actions

    def step_wait(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """One pulse in every environment: observations [N, D], rewards [N], ends [N], infos."""
        observation, reward, terminated, truncated, infos = self.environment.step(self._actions)
        success = infos["success"]
        out: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for i in np.flatnonzero(terminated | truncated):
            out[i] = {"terminal_observation": infos["final_obs"][i].copy(), "is_success": bool(success[i]),
                      "TimeLimit.truncated": bool(truncated[i] and not terminated[i])}
        return observation.copy(), reward.copy(), terminated | truncated, out

    def close(self) -> None:
        """Closes the environment."""
        self.environment.close()

    def _of_each(self, value: Any, indices: Any) -> list[Any]:
        return [value for _ in self._get_indices(indices)]

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute of the environment, which all of them share."""
        return self._of_each(getattr(self.environment, attr_name), indices)

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Cannot be: all of them share what they have."""
        raise AttributeError(f"{attr_name} cannot be set for single environments of a batch")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """What a method of the environment gives, called once."""
        return self._of_each(getattr(self.environment, method_name)(*method_args, **method_kwargs), indices)

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """None is."""
        return self._of_each(False, indices)


def actor_layers(actor: Any) -> Sequence[tuple[NDArray[np.float32], NDArray[np.float32]]]:
    """Layers for save_policy() of a TD3 or DDPG actor of Stable-Baselines3 (`model.policy.actor`).

    Raises:
        ValueError: it is no sequence of linear layers with ReLU between them and tanh at the end, on plain
            observations
    """
    import torch  # Stable-Baselines3's own

    if not isinstance(actor.mu, torch.nn.Sequential):
        raise ValueError(f"the actor ends in {type(actor.mu).__name__}, must be one of TD3 or DDPG, whose mu is all of its layers")
    layers = list(actor.mu)
    linear, between = layers[0:-1:2], layers[1:-1:2]
    fits = (all(isinstance(layer, torch.nn.Linear) for layer in linear)
            and all(isinstance(layer, torch.nn.ReLU) for layer in between) and isinstance(layers[-1], torch.nn.Tanh)
            and isinstance(actor.features_extractor, torch.nn.Module)
            and not list(actor.features_extractor.parameters()))
    if not fits:
        raise ValueError(f"the actor is {actor.mu}; a policy is linear layers with ReLU between them and tanh at the end")
    return [(layer.weight.detach().cpu().numpy(), layer.bias.detach().cpu().numpy()) for layer in linear]
