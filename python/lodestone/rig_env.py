"""A rig in its control loop as a Gymnasium environment."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lodestone
from .controllers import checked_seed
from .single_env import SingleEnv
from .tasks import RIG_GROUPS, Task, environment_config, read_json

__all__ = ["RigEnv"]


class RigEnv(SingleEnv[_lodestone.RigEnvironment]):
    """A rig, virtual or real: lodestone/Rig-v0. Spaces, rules and contract are those of MbsEnv.

    Every step is one of the control loop, behind the supervisor: observe, pulse, rest. What counts is what the
    sensor sees. A needle that is not seen is looked for, and the step lasts until it is found. Where the supervisor
    or a device stops the run, the episode is truncated, `info["stopped"]` says why, and reset() raises HardwareError
    until that is mended (rearm(), or reset(seed=...) on a virtual rig, which is then a new one).

    On a real rig time goes on between two steps: who takes longer than the loop allows (`loop`, `safety`) is
    stopped, too.

    Attributes:
        contract: encoder, action, goal and rig, for save_policy()
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 3}

    def __init__(self, task: Task = "centre", *, rig: str | os.PathLike[str] | Mapping[str, Any] | None = None,
                 rig_seed: int = 1, sensor_seed: int = 1, operator: Callable[[float, float, float], None] | None = None,
                 render_mode: str | None = None, **groups: Mapping[str, Any] | None) -> None:
        """
        Args:
            task: as for make_vec()
            rig: rig.json, or keys of it; {"backend": "serial", ...} is a real or an emulated one. The paper's
                virtual rig by default
            rig_seed: of what is hidden in a virtual rig
            sensor_seed: of what a virtual rig's camera sees
            operator: called with x and y in m and a heading in rad, returns when the needle lies about there; a
                virtual rig needs none
            render_mode: "rgb_array": images of the camera (sensor={"kind": "camera"}, which is the default)
            groups: keys to change: rules={...} (those below `task.`), encoder={...}, action={...}, sensor={...}, safety={...}, loop={...};
                `lodestone config --print deploy` lists them

        Raises:
            NotFoundError, ConfigError, CheckpointError: what cannot be used
            HardwareError: a real rig that does not answer
        """
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode is {render_mode!r}, must be None or 'rgb_array'")
        if operator is not None and not callable(operator):
            raise TypeError(f"operator is {operator!r}, must be a function of x_m, y_m and heading_rad")
        self.render_mode = render_mode
        if rig is not None and not isinstance(rig, Mapping):
            rig = read_json(pathlib.Path(os.fspath(rig)))
        sensor = {"segmenter": str(pathlib.Path(__file__).parent / "segmenter")}
        given = groups.pop("sensor", None)
        if given is not None and not isinstance(given, Mapping):
            raise TypeError(f"sensor is {given!r}, must be a dictionary of its keys")
        config = environment_config(task, RIG_GROUPS, rig=rig, sensor={**sensor, **(given or {})}, **groups)
        super().__init__(_lodestone.RigEnvironment(config, checked_seed(rig_seed), checked_seed(sensor_seed), operator))

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Has the needle placed, and begins a run.

        Args:
            seed: of starts, goals and a virtual rig's own chance, from the beginning; a virtual rig is made anew.
                Without one all goes on (the first time: from a seed that nobody knows)
            options: none are known

        Returns:
            observation [D], and no infos

        Raises:
            ClosedEnvironmentError: it is closed
            HardwareError: the rig is stopped, or its needle is not seen
        """
        core = self._open_core()
        seed = self._seed_of(seed, options)
        self._ended = True
        observation = core.reset(seed)
        self._begun, self._ended = True, False
        return observation, {}

    def step(self, action: ArrayLike) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One pulse.

        Args:
            action: [A] in [-1, 1] (cut to it), float32 or float64

        Returns:
            observation [D], reward, terminated, truncated, and {"success": whether the goal is reached}, with
            "stopped" where the run was stopped

        Raises:
            ClosedEnvironmentError: it is closed
            ResetNeeded: the episode has ended
            TypeError: no real numbers
            ValueError: another shape, or a number that is not finite
        """
        core = self._core_with_episode()
        observation, reward, terminated, truncated, success, stopped = core.step(action)
        self._ended = terminated or truncated
        info: dict[str, Any] = {"success": success}
        if stopped:
            info["stopped"] = stopped
        return observation, reward, terminated, truncated, info

    def render(self) -> NDArray[np.uint8] | None:
        """The camera's newest image [rows, columns, 3], where render_mode is "rgb_array".

        Raises:
            ConfigError: there is no camera, or no image yet
        """
        return self._open_core().image() if self.render_mode == "rgb_array" else None

    def rearm(self) -> None:
        """Takes pulses again after a stop. For an operator who has seen its reason, never for a program.

        Raises:
            HardwareError: the cause is still there
        """
        self._open_core().rearm()
