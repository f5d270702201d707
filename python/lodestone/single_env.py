"""What one environment is, whether it is simulated or a rig: how it is seeded, begun and closed."""

from __future__ import annotations

import json
from typing import Any, Generic, TypeVar

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .controllers import checked_seed
from .vector import spaces

__all__ = ["SingleEnv"]

Core = TypeVar("Core")


class SingleEnv(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]], Generic[Core]):
    """One environment around what the extension made.

    Attributes:
        contract: encoder, action, goal and rig, for save_policy()
    """

    def __init__(self, core: Core) -> None:
        self._core: Core | None = core
        self.contract: dict[str, Any] = json.loads(core.contract())
        self.observation_space, self.action_space = spaces(core.observation_size, core.action_size)
        self._begun = False
        self._ended = True

    def _open_core(self) -> Core:
        if self._core is None:
            raise gymnasium.error.ClosedEnvironmentError("the environment is closed; make another one")
        return self._core

    def _core_with_episode(self) -> Core:
        core = self._open_core()
        if self._ended:
            raise gymnasium.error.ResetNeeded("step() without an episode; call reset() first")
        return core

    def _seed_of(self, seed: int | None, options: dict[str, Any] | None) -> int | None:
        """The seed to begin from; without one the stream goes on (the first time: from a seed that nobody knows)."""
        if options:
            raise ValueError(f"options {sorted(options)} are not known; there are none")
        if seed is not None:
            seed = checked_seed(seed)
        gymnasium.Env.reset(self, seed=seed)
        if seed is None and not self._begun:
            seed = int(self.np_random.integers(1 << 63))
        return seed

    def close(self) -> None:
        """Lets it go, a rig with its coils off. It cannot be used any more."""
        self._core = None
