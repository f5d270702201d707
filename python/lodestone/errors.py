"""What Lodestone raises. The message is one line, in the words of the command line: what is wrong, where, which
bound it broke and what to do.

Arguments of another dtype raise TypeError, of another shape or with NaN ValueError, as everywhere in Python.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator

__all__ = ["Error", "ConfigError", "DataError", "CheckpointError", "IoError", "HardwareError", "NotFoundError"]


class Error(Exception):
    """Base of every fault that a user or a device can cause."""


class ConfigError(Error, ValueError):
    """A configuration or an argument that cannot be used."""


class DataError(Error, ValueError):
    """A data file that cannot be read, or holds values that cannot be used."""


class CheckpointError(Error, ValueError):
    """A checkpoint that is truncated, altered, of another kind or of another version."""


class IoError(Error, OSError):
    """A file or folder that cannot be read or written."""


class HardwareError(Error, RuntimeError):
    """A device that does not answer or answers with a fault, or a supervisor that has stopped the coils."""


class NotFoundError(Error, FileNotFoundError):
    """A file or folder that is not there."""


@contextlib.contextmanager
def reading(path: str | os.PathLike[str]) -> Iterator[str]:
    """The path as text; what fails because nothing lies there raises NotFoundError."""
    text = os.fspath(path)
    if not isinstance(text, str):
        raise TypeError(f"path is {text!r}, must be text or a path")
    try:
        yield text
    except (CheckpointError, DataError, IoError) as error:
        if os.path.exists(text):
            raise
        raise NotFoundError(str(error)) from None
