"""Thousands of copies of the learned simulator as one Gymnasium vector environment."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from . import _lodestone
from .controllers import checked_seed
from .dynamics import Dynamics, as_dynamics
from .tasks import Task, environment_config

__all__ = ["MbsVectorEnv", "make_vec"]


def spaces(observation_size: int, action_size: int) -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    """Of one environment: observations [D] and actions [A] in [-1, 1], both float32."""
    return (gymnasium.spaces.Box(-np.inf, np.inf, (observation_size,), np.float32),
            gymnasium.spaces.Box(-1.0, 1.0, (action_size,), np.float32))


def checked_whole(name: str, value: int, least: int, most: int) -> int:
    """Raises TypeError or ValueError where it is no whole number within these bounds."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name} is {value!r}, must be a whole number")
    if not least <= value <= most:
        raise ValueError(f"{name} is {value}, must be within {least} .. {most}")
    return int(value)


class MbsVectorEnv(VectorEnv):
    """N learned simulators stepped as one batch, on threads, without the interpreter's lock.

    An environment that ends starts anew in the same step (AutoresetMode.SAME_STEP): the observation is that of
    the new episode, `infos["final_obs"]` holds the last one of the old, `infos["_final_obs"]` says where.
    `infos["success"]` says where the goal was within the success radius after this step, `final_info` the same
    where an episode ended.

    Arrays are read-only views of the environment's own buffers. They are valid for as long as they are held, and
    show the latest step: the next step() or reset() changes them. Copy what shall last, or ask for copies
    (copy=True).

    Results depend on the seed, not on the number of threads. Environment i draws from a stream of its own, the same
    as MbsEnv(stream=i).

    Attributes:
        contract: encoder, action, goal and rig, for save_policy()
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.SAME_STEP}

    def __init__(self, dynamics: Dynamics | str | os.PathLike[str], num_envs: int, task: Task = "centre", *,
                 seed: int | None = None, threads: int = 0, copy: bool = False, render_mode: None = None,
                 **groups: Mapping[str, Any] | None) -> None:
        """See make_vec()."""
        if render_mode is not None:
            raise TypeError(f"render_mode is {render_mode!r}: the learned simulator draws nothing; use lodestone/Rig-v0")
        self.num_envs = checked_whole("num_envs", num_envs, 1, 1 << 20)
        self._given = None if seed is None else checked_seed(seed)
        self._copy = copy
        self._core = _lodestone.Environments(as_dynamics(dynamics)._core, environment_config(task, **groups),
                                             self.num_envs, 0 if seed is None else self._given, 0, checked_whole("threads", threads, 0, 1024))
        self.contract: dict[str, Any] = json.loads(self._core.contract())
        self.single_observation_space, self.single_action_space = spaces(self._core.observation_size, self._core.action_size)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._everywhere = np.ones(self.num_envs, dtype=np.bool_)
        self._everywhere.setflags(write=False)
        self._begun = False

    def _check_open(self) -> None:
        if self.closed:
            raise gymnasium.error.ClosedEnvironmentError("the environment is closed; make another one")

    def _out(self, array: NDArray[Any]) -> NDArray[Any]:
        return array.copy() if self._copy else array

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """New episodes everywhere.

        Args:
            seed: from the beginning of that seed; without one the streams go on (the first time: from the seed
                that the environment was made with, or one that nobody knows)
            options: none are known

        Returns:
            observations [N, D], and no infos

        Raises:
            ClosedEnvironmentError: it is closed
        """
        self._check_open()
        if options:
            raise ValueError(f"options {sorted(options)} are not known; there are none")
        if seed is None and not self._begun:
            seed = self._given if self._given is not None else int(np.random.SeedSequence().entropy) & ((1 << 63) - 1)
        if seed is not None:
            seed = checked_seed(seed)
            super().reset(seed=seed)
        self._begun = True
        return self._out(self._core.reset(seed)), {}

    def step(self, actions: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_],
                                                NDArray[np.bool_], dict[str, Any]]:
        """One pulse in every environment.

        Args:
            actions: [N, A] in [-1, 1] (cut to it), float32 or float64

        Returns:
            observations [N, D], rewards [N], terminated [N], truncated [N], infos

        Raises:
            ClosedEnvironmentError: it is closed
            ResetNeeded: before the first reset()
            TypeError: no real numbers
            ValueError: another shape, or a number that is not finite
        """
        self._check_open()
        if not self._begun:
            raise gymnasium.error.ResetNeeded("step() before reset(); call reset() first")
        views = self._core.step(actions)
        if self._copy:
            views = tuple(view.copy() if isinstance(view, np.ndarray) else view for view in views)
        observation, reward, terminated, truncated, success, final, ended, any_ended = views
        infos: dict[str, Any] = {"success": success, "_success": self._everywhere}
        if any_ended:
            infos.update(final_obs=final, _final_obs=ended, final_info={"success": success, "_success": ended},
                         _final_info=ended)
        return observation, reward, terminated, truncated, infos

    def close_extras(self, **kwargs: Any) -> None:
        """Lets the threads go; arrays that are still held stay valid."""
        del self._core


def make_vec(dynamics: Dynamics | str | os.PathLike[str], num_envs: int = 1, task: Task = "centre", *,
             seed: int | None = None, threads: int = 0, copy: bool = False, **groups: Any) -> MbsVectorEnv:
    """N copies of a learned simulator as one gymnasium.vector.VectorEnv.

    Args:
        dynamics: the simulator, or its folder
        num_envs: N
        task: "centre", "point" or "pose" (the presets), another preset of train-policy (FILE.json), or a
            dictionary of its keys below `task.`
        seed: of the first reset() that names none
        threads: 0 means one per processor
        copy: give copies instead of views
        groups: keys of the preset to change, group by group: rules={...} (those below `task.`), encoder={...}, mbs={...}, action={...},
            region={...}; `lodestone config --print train-policy` lists them

    Raises:
        NotFoundError, CheckpointError: the simulator
        ConfigError: an unknown key, a value out of bounds, or ones that do not fit the simulator
    """
    return MbsVectorEnv(dynamics, num_envs, task, seed=seed, threads=threads, copy=copy, **groups)
