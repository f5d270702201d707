"""Recorded steps of a rig."""

from __future__ import annotations

import dataclasses
import json
import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _lodestone
from .errors import reading

__all__ = ["Transitions"]


@dataclasses.dataclass(frozen=True)
class Transitions:
    """N recorded steps, one row each, in the order in which they were recorded."""

    state: NDArray[np.float64]
    """[N, S] x_m, y_m and, for a needle, heading_rad, before the pulse."""
    action: NDArray[np.float64]
    """[N, A] drives in `info["action_unit"]`."""
    next_state: NDArray[np.float64]
    """[N, S] after it."""
    terminated: NDArray[np.bool_]
    """[N] the episode ended by itself here."""
    truncated: NDArray[np.bool_]
    """[N] it was cut here."""
    zero_current: NDArray[np.bool_]
    """[N] nothing was applied: training leaves these rows out."""
    episode: NDArray[np.int64]
    """[N] index of the episode."""
    info: dict[str, Any]
    """Where they come from and what the numbers mean: layout, action_unit, action_scale, workspace_radius_m, ..."""

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Transitions:
        """Reads a recording of `lodestone collect` (.h5), or a .csv as `lodestone import` does.

        Raises:
            NotFoundError: no such file
            DataError: it is no such file, altered, or holds what cannot be
        """
        with reading(path) as text:
            columns = _lodestone.read_transitions(text)
        return cls(info=json.loads(columns.pop("facts")), **columns)

    def __len__(self) -> int:
        return len(self.state)
