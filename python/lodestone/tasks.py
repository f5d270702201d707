"""What an environment plays: the presets of train-policy, and what is changed of them."""

from __future__ import annotations

import json
import os
import pathlib
from collections.abc import Mapping
from typing import Any

from . import _lodestone
from .controllers import to_json
from .errors import ConfigError, DataError, IoError, NotFoundError

__all__ = ["Task", "TASKS"]

Task = str | os.PathLike[str] | Mapping[str, Any]

TASKS = ("centre", "point", "pose")
"""Tasks that have a preset."""

RULES = ("rules", "encoder", "action")
MBS_GROUPS = (*RULES, "mbs", "region")
RIG_GROUPS = (*RULES, "rig", "sensor", "safety", "loop")
# Keys of train-policy that say how a policy is learned, not what it plays.
_OF_THE_LEARNER = {"seed", "threads", "method", "dynamics", "simulator", "recorded", "rig", "physics", "replay", "td3",
                   "noise", "model_gradient", "value_iteration", "training"}


def read_json(path: pathlib.Path) -> dict[str, Any]:
    """An object of a file with comments. Raises NotFoundError, IoError and ConfigError."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise NotFoundError(f"{path} does not exist") from None
    except OSError as error:
        raise IoError(f"{path} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ConfigError(f"{path} is no JSON: it is no text in UTF-8") from None
    try:
        whole = json.loads(_lodestone.plain_json(text, str(path)))
    except DataError as error:
        raise ConfigError(str(error)) from None
    if not isinstance(whole, dict):
        raise ConfigError(f"{path} is no JSON object")
    return whole


def _preset(task: Task) -> dict[str, Any]:
    if isinstance(task, Mapping):
        return {"task": dict(task)}
    if isinstance(task, str) and task in TASKS:
        path = pathlib.Path(__file__).parent / "presets" / f"{task}.json"
    else:
        path = pathlib.Path(os.fspath(task))
        if path.suffix != ".json":
            raise ConfigError(f"task = {os.fspath(task)!r}, must be one of {', '.join(TASKS)}, a preset of train-policy "
                              "(FILE.json), or a dictionary of its keys below task.")
    whole = read_json(path)
    return {key: value for key, value in whole.items() if key not in _OF_THE_LEARNER}


def environment_config(task: Task, groups: tuple[str, ...] = MBS_GROUPS, **changes: Mapping[str, Any] | None) -> str:
    """The configuration of an environment as JSON: a preset, with keys of its groups changed."""
    config = _preset(task)
    for group, keys in changes.items():
        if group not in groups:
            raise TypeError(f"unexpected argument {group!r}; groups that can be changed: {', '.join(groups)}")
        if keys is None:
            continue
        if not isinstance(keys, Mapping):
            raise TypeError(f"{group} is {keys!r}, must be a dictionary of its keys")
        name = "task" if group == "rules" else group  # `task` is the name of the preset
        config[name] = {**config.get(name, {}), **keys}
    return to_json(config, "environment")
