# SPDX-License-Identifier: BSD-3-Clause
"""How far a robot is from everything its depth sensor sees: exact, with a certified bracket."""

from typing import TYPE_CHECKING

from . import _core
from ._core import *  # noqa: F403
from ._core import __version__, none

if TYPE_CHECKING:
    from .filtered import min_distance_filtered as min_distance_filtered
    from .playing import play as play
    from .seeing import picture as picture
    from .seeing import show as show

# Each of these imports what only it needs.
_later = {"show": "seeing", "picture": "seeing", "play": "playing", "min_distance_filtered": "filtered"}

__all__ = [*(name for name in dir(_core) if not name.startswith("_")), *_later]  # pyright: ignore
assert __version__ and none


def __getattr__(name):
    if name in _later:
        import importlib

        return getattr(importlib.import_module(f"clearance.{_later[name]}"), name)
    raise AttributeError(f"module 'clearance' has no attribute {name!r}")
