"""Tests of users: the bench in pytest (:mod:`railhil.pytest_plugin`), its runs, and units.

Guide: docs/howto/testing.md. Importing this package loads nothing else; modules are loaded when a name is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from railhil.testing.bench import Bench
    from railhil.testing.live import Live
    from railhil.testing.result import Run
    from railhil.testing.strategies import faults

#: Name -> its module.
_PLACES = {
    "Bench": "railhil.testing.bench",
    "Live": "railhil.testing.live",
    "Run": "railhil.testing.result",
    "faults": "railhil.testing.strategies",
}
__all__ = ["Bench", "Live", "Run", "faults", "kmh"]


def kmh(speed: float) -> float:
    """A speed in km/h, in m/s."""
    return speed / 3.6


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_PLACES[name]), name)
