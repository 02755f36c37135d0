"""Units that people think in."""

from __future__ import annotations


def kmh(speed: float) -> float:
    """A speed in km/h, in m/s."""
    return speed / 3.6
