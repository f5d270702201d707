"""Policies and planners: a pose and a target in, an action out."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lodestone
from .dynamics import Dynamics, as_dynamics
from .errors import ConfigError, reading

__all__ = ["Planner", "Policy", "save_policy"]


class _Controller:
    """What policies and planners have in common."""

    _core: _lodestone.Policy | _lodestone.Planner

    def __call__(self, pose: ArrayLike, target: ArrayLike, target_heading: float | None = None) -> NDArray[np.float64]:
        """One decision, as the control loop asks for it. The last action and the motion since are remembered.

        Args:
            pose: [3] x and y in m, heading in rad
            target: [2] in m
            target_heading: in rad, where the task wants one

        Returns:
            [A] in [-1, 1], of as many numbers as the rig's drive has; of opposed pairs, the sign picks the coil of each axis, the magnitude its part of the largest drive

        Raises:
            TypeError: no real numbers
            ValueError: another shape, or a number that is not finite
        """
        return self._core.decide(pose, target, target_heading)

    def reset(self) -> None:
        """Forgets the episode before. Call it when the needle has been placed."""
        self._core.reset()

    def drives(self, action: ArrayLike, position: ArrayLike | None = None) -> NDArray[np.float64]:
        """Drives of the coils, in ampere unless `action_unit` says per cent: +x, -x, +y, -y, or those that its rig lists.

        Args:
            action: [A] or [N, A] in [-1, 1]
            position: [2] of the needle, x and y in m, which matters where rig.drive.kind is field; None: the dish centre

        Returns:
            [coils] or [N, coils]
        """
        return self._core.drives(action, position)


class Policy(_Controller):
    """A trained policy, bare: without what `lodestone deploy` may put around it (decorators, gain correction).

    Attributes:
        encoder: what it sees, as checkpoints hold it
        action: what its actions mean, as checkpoints hold it (scale in `unit`)
        goal: task it was trained for: "centre", "point" or "pose"
        rig: what is known of the rig it is for; None where that is not known
        hidden: widths of its hidden layers
        observation_size: numbers of an encoded observation (D)
    """

    encoder: dict[str, Any]
    action: dict[str, Any]
    goal: str
    rig: dict[str, Any] | None
    hidden: list[int]
    observation_size: int

    def __init__(self, core: _lodestone.Policy) -> None:
        self._core: _lodestone.Policy = core
        facts = json.loads(core.facts())
        for name in self.__class__.__annotations__:
            setattr(self, name, facts[name])

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Policy:
        """Reads a policy checkpoint, of `lodestone train-policy` or of save_policy().

        Raises:
            NotFoundError: no such folder
            CheckpointError: it is altered, truncated, of another kind, or computes otherwise here
        """
        with reading(folder) as path:
            return cls(_lodestone.Policy.load(path))

    def act(self, observation: ArrayLike) -> NDArray[np.float32]:
        """Actions for encoded observations, as environments give them. Remembers nothing.

        Args:
            observation: [D] or [N, D]

        Returns:
            [A] or [N, A] in [-1, 1]
        """
        return self._core.act(observation)

    def __repr__(self) -> str:
        return f"Policy(goal={self.goal!r}, hidden={self.hidden}, observation_size={self.observation_size})"


class Planner(_Controller):
    """Plans every pulse anew in a learned simulator (cross-entropy method)."""

    def __init__(self, dynamics: Dynamics | str | os.PathLike[str], *, seed: int = 1, **config: Any) -> None:
        """
        Args:
            dynamics: the simulator, or its folder
            seed: of the candidates it draws
            config: keys of `lodestone config --print deploy` below `planner.`, such as horizon=3

        Raises:
            ConfigError: an unknown key, or a value out of bounds
        """
        self._core: _lodestone.Planner = _lodestone.Planner(
            as_dynamics(dynamics)._core, to_json(config, "planner"), checked_seed(seed))


def checked_seed(seed: int) -> int:
    """Raises TypeError or ValueError where it cannot be one."""
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)):
        raise TypeError(f"seed is {seed!r}, must be a whole number")
    if not 0 <= seed < 1 << 63:
        raise ValueError(f"seed is {seed}, must be within 0 .. 2^63 - 1")
    return int(seed)


def to_json(config: Mapping[str, Any], name: str) -> str:
    """Raises ConfigError where it is no JSON."""
    if not isinstance(config, Mapping):
        raise TypeError(f"{name} is {config!r}, must be a dictionary")
    try:
        return json.dumps(config, allow_nan=False)
    except (TypeError, ValueError, RecursionError) as error:
        raise ConfigError(f"{name}: {error}") from None


def _check_replaceable(folder: str) -> None:
    """Nothing but a policy may be replaced by one."""
    if not os.path.isdir(folder) or not os.listdir(folder):
        return
    try:
        with open(os.path.join(folder, "manifest.json"), encoding="utf-8") as file:
            kind = json.load(file)["kind"]
    except (OSError, ValueError, KeyError, TypeError):
        kind = None
    if kind != "policy":
        raise ConfigError(f"save_policy: {folder} is not empty and holds no policy: name a new folder")


def save_policy(folder: str | os.PathLike[str], layers: Sequence[tuple[ArrayLike, ArrayLike]], *,
                contract: Mapping[str, Any]) -> None:
    """Writes a policy that was trained elsewhere, so that Policy.load() reads and `lodestone deploy` drives it.

    The network is linear layers with ReLU between them and tanh at the end. The folder appears whole, with
    example inputs and outputs; a policy that lay there is replaced.

    Args:
        folder: to write
        layers: (weight [outputs, inputs], bias [outputs]) of each linear layer; the last has as many outputs as an action numbers
        contract: of the environment it was trained in (`env.contract`): encoder, action, goal and rig

    Raises:
        CheckpointError: layers that do not fit together or the encoder
        ConfigError: a contract that cannot be used, or a folder that holds something else than a policy
        IoError: the folder cannot be written
        TypeError, ValueError: no real numbers, or one that is not finite
    """
    missing = {"encoder", "action", "goal", "rig"} - set(contract)
    if missing:
        raise ConfigError(f"save_policy: contract lacks {', '.join(sorted(missing))}; pass env.contract")
    pairs = [tuple(layer) for layer in layers]
    for i, pair in enumerate(pairs):
        if len(pair) != 2:
            raise ValueError(f"layers[{i}] holds {len(pair)} arrays, must be weight and bias")
    _check_replaceable(os.fspath(folder))
    _lodestone.save_policy(os.fspath(folder), pairs, to_json(dict(contract), "save_policy: contract"))
