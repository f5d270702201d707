"""The learned simulator, asked for what a pulse does."""

from __future__ import annotations

import dataclasses
import json
import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lodestone
from .errors import reading

__all__ = ["Dynamics", "Prediction"]


@dataclasses.dataclass(frozen=True)
class Prediction:
    """Next states as they are predicted, for N states (the axis N is absent where one state was asked for).

    Columns are x and y in m and, where the state has one, the heading in rad, in (-pi, pi].
    """

    mean: NDArray[np.float64]
    """[N, S] what all members together expect."""
    weight: NDArray[np.float64]
    """[M, N, K] weights of the K Gaussians that each of M members predicts; each row adds up to 1."""
    component_mean: NDArray[np.float64]
    """[M, N, K, S] their means."""
    spread: NDArray[np.float64]
    """[M, N, K, S] their standard deviations in m, m and rad; 0 where a single value is predicted (K = 1)."""


class Dynamics:
    """A learned simulator, read only: planners, environments and threads share it.

    Attributes:
        members: networks in the ensemble (M)
        components: Gaussians that each predicts (K); 0 where it predicts a single value
        state_size: numbers of a state (S): x_m, y_m, and heading_rad where it is 3
        action_unit: "A", or "percent" of full drive
        action_scale: the action, in that unit, that 1 of an environment's action means
        workspace_radius_m: reach of the training data: the dish radius
        control_period_s: time from pulse to pulse
        rig: what is known of the rig it was learned on
    """

    members: int
    components: int
    state_size: int
    action_unit: str
    action_scale: float
    workspace_radius_m: float
    control_period_s: float
    rig: dict[str, Any]

    def __init__(self, core: _lodestone.Dynamics, folder: str) -> None:
        self._core = core
        self._folder = folder
        facts = json.loads(core.facts())
        for name in self.__class__.__annotations__:
            setattr(self, name, facts[name])

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Dynamics:
        """Reads a checkpoint of `lodestone train-dynamics`.

        Raises:
            NotFoundError: no such folder
            CheckpointError: it is altered, truncated or of another kind
        """
        with reading(folder) as path:
            return cls(_lodestone.Dynamics.load(path), os.path.abspath(path))

    def predict(self, state: ArrayLike, action: ArrayLike) -> Prediction:
        """What one pulse does.

        Args:
            state: [S] or [N, S] in m, m and rad
            action: [A] or [N, A] drives in `action_unit`; of opposed pairs two (x, y), of which positive is the + coil of the axis

        Raises:
            TypeError: no real numbers
            ValueError: another shape, or a number that is not finite
        """
        return Prediction(*self._core.predict(state, action))

    def __deepcopy__(self, memo: dict[int, Any]) -> Dynamics:
        return self  # nobody writes to it

    def __reduce__(self) -> tuple[Any, ...]:
        return self.load, (self._folder,)  # another process reads it there

    def __repr__(self) -> str:
        return f"Dynamics(members={self.members}, components={self.components}, state_size={self.state_size})"


def as_dynamics(dynamics: Dynamics | str | os.PathLike[str]) -> Dynamics:
    """A simulator, or the one in that folder."""
    return dynamics if isinstance(dynamics, Dynamics) else Dynamics.load(dynamics)
