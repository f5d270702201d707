"""One learned simulator as a Gymnasium environment."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lodestone
from .controllers import checked_seed
from .dynamics import Dynamics, as_dynamics
from .single_env import SingleEnv
from .tasks import Task, environment_config

__all__ = ["MbsEnv"]


class MbsEnv(SingleEnv[_lodestone.Environments]):
    """The learned simulator, one copy: lodestone/Mbs-v0. For many at once use make_vec().

    Attributes:
        contract: encoder, action, goal and rig, for save_policy()
    """

    metadata = {"render_modes": []}

    def __init__(self, dynamics: Dynamics | str | os.PathLike[str], task: Task = "centre", *, stream: int = 0,
                 render_mode: None = None, **groups: Mapping[str, Any] | None) -> None:
        """
        Args:
            dynamics: the simulator, or its folder
            task, groups: as for make_vec()
            stream: which environment of a vector environment with the same seed it is

        Raises:
            NotFoundError, CheckpointError: the simulator
            ConfigError: an unknown key, a value out of bounds, or ones that do not fit the simulator
        """
        if render_mode is not None:
            raise TypeError(f"render_mode is {render_mode!r}: the learned simulator draws nothing; use lodestone/Rig-v0")
        super().__init__(_lodestone.Environments(
            as_dynamics(dynamics)._core, environment_config(task, **groups), 1, 0, checked_seed(stream), 1))

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """A new episode.

        Args:
            seed: from the beginning of that seed; without one the stream goes on (the first time: from a seed that
                nobody knows)
            options: none are known

        Returns:
            observation [D], and no infos
        """
        core = self._open_core()
        seed = self._seed_of(seed, options)
        # An episode that has ended has been followed by the next one already.
        observation = core.observation() if seed is None and self._ended else core.reset(seed)
        self._begun, self._ended = True, False
        return observation[0].copy(), {}

    def step(self, action: ArrayLike) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One pulse.

        Args:
            action: [A] in [-1, 1] (cut to it), float32 or float64

        Returns:
            observation [D], reward, terminated, truncated, and {"success": whether the goal is reached}

        Raises:
            ClosedEnvironmentError: it is closed
            ResetNeeded: the episode has ended
            TypeError: no real numbers
            ValueError: another shape, or a number that is not finite
        """
        core = self._core_with_episode()
        _, reward, terminated, truncated, success, final, _, self._ended = core.step(action)
        return final[0].copy(), float(reward[0]), bool(terminated[0]), bool(truncated[0]), {"success": bool(success[0])}
