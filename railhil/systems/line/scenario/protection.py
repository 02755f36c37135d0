"""Settings of the train protection (``[atp]``), in SI units."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Protection:
    """Train protection of a run; the defaults are those of the profile ``metro``."""

    enabled: bool = True
