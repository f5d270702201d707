"""Lodestone from Python: learned simulators, policies and planners, and environments for reinforcement learning.

Lengths are in m, headings in rad, currents in A. The origin is the dish centre, x points to coil +x, y to coil +y.
The environments need Gymnasium, everything else numpy alone. LibTorch is not loaded.
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import TYPE_CHECKING, Any

from . import _lodestone, errors
from .controllers import Planner, Policy, save_policy
from .dynamics import Dynamics, Prediction
from .errors import (CheckpointError, ConfigError, DataError, Error, HardwareError, IoError, NotFoundError)
from .transitions import Transitions

if TYPE_CHECKING:
    from .mbs_env import MbsEnv
    from .rig_env import RigEnv
    from .sb3 import Sb3VecEnv, actor_layers
    from .vector import MbsVectorEnv, make_vec

__version__: str = _lodestone.version()


def _check_numpy() -> None:
    """Arrays of NumPy 2 are read by what was built with pybind11 2.12 or newer alone."""
    import numpy

    if int(numpy.__version__.partition(".")[0]) >= 2 and _lodestone.pybind11_version() < (2, 12):
        built = ".".join(map(str, _lodestone.pybind11_version()))
        raise ImportError(f"lodestone was built with pybind11 {built}, which cannot read arrays of NumPy {numpy.__version__}: "
                          "pip install 'numpy<2', or build it with pybind11 2.12 or newer")


_check_numpy()

# Name: where it lies, and what must be there besides.
_ON_DEMAND = {"MbsEnv": ("mbs_env", "gymnasium"), "RigEnv": ("rig_env", "gymnasium"), "MbsVectorEnv": ("vector", "gymnasium"),
              "make_vec": ("vector", "gymnasium"), "Sb3VecEnv": ("sb3", "stable_baselines3"),
              "actor_layers": ("sb3", "stable_baselines3")}
_PROJECTS = {"gymnasium": "Gymnasium", "stable_baselines3": "Stable-Baselines3"}

__all__ = ["CheckpointError", "ConfigError", "DataError", "Dynamics", "Error", "HardwareError", "IoError",
           "NotFoundError", "Planner", "Policy", "Prediction", "Transitions", "errors", "save_policy", *_ON_DEMAND]


def __getattr__(name: str) -> Any:
    if name not in _ON_DEMAND:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, needed = _ON_DEMAND[name]
    try:
        return getattr(importlib.import_module(f".{module}", __name__), name)
    except ImportError as error:
        if not isinstance(error, ModuleNotFoundError):
            raise ImportError(f"lodestone.{name} needs a newer {_PROJECTS[needed]} (Gymnasium 1.1, Stable-Baselines3 2.6): "
                              f"pip install --upgrade {needed.replace('_', '-')}") from error
        missing = (error.name or needed).partition(".")[0]
        raise ImportError(f"lodestone.{name} needs {_PROJECTS.get(missing, missing)}, which is not installed: "
                          f"pip install {missing.replace('_', '-')}") from error


def __dir__() -> list[str]:
    return sorted([*globals(), *_ON_DEMAND])


def _register() -> None:
    """lodestone/Mbs-v0 and lodestone/Rig-v0, where Gymnasium is installed."""
    if importlib.util.find_spec("gymnasium") is None:
        return
    from gymnasium.envs.registration import register

    register("lodestone/Mbs-v0", entry_point=f"{__name__}.mbs_env:MbsEnv", vector_entry_point=f"{__name__}.vector:make_vec")
    register("lodestone/Rig-v0", entry_point=f"{__name__}.rig_env:RigEnv")


_register()
