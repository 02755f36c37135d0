"""What the controller's watch observes at one instant, in the tests."""

from __future__ import annotations

from typing import NamedTuple

from railhil.controller_node.ato.speed_watch import Finding, Reception


class Seen(NamedTuple):
    """Arguments of :func:`railhil.controller_node.ato.speed_watch.observe`, after ladder and state."""

    age_ms: int
    telegram: Reception = Reception.NONE
    standstill: bool = False
    overspeed: bool = False
    finding: Finding | None = None
