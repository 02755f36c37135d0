"""Short runs of precise stopping."""

from __future__ import annotations

from typing import Any

from railhil.scenarios.load import load_any

#: 31 m before the stop at 18 km/h: the run lasts 12 s.
SHORT = ("task.start_m=2600", "task.start_kmh=18", "task.approach_kmh=18", "task.after_stop_s=2")
#: Nothing is drawn.
EXACT = ("task.cruise_sigma_mps=0", "task.wander_sigma_mps=0", "task.sensors.speed_noise_mps=0")
FLAT = ("task.grade=[[0, 0]]",)


def stop_scenario(*settings: str, name: str = "yizhuang_stop") -> Any:
    """A scenario of precise stopping with keys set."""
    return load_any(name, settings)
