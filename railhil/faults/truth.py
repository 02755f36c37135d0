"""The simulated truth of a system, by which faults begin and end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

#: A record without the truth for longer than this is not accepted as a run, because the motion in the gap is unknown.
#: A short bus failure leaves shorter gaps.
HOLE_MAX_S: Final = 1.0


@dataclass(frozen=True, slots=True)
class Truth:
    """Place of the simulated truth on a system's bus, for triggers: names of a port and of its signals.

    ``speed``, ``position``: without them triggers by speed or position are refused. ``acceleration``: for the event
    ``braking``; ``traction``: for the event ``traction``. ``levels``: ports with the level of a watch, and its signal;
    the names of its values are events. ``beside``: further ports that exist only for the record; like the truth itself
    they are part of the instrument, and no fault touches them.
    """

    port: str
    position: str = ""
    speed: str = ""
    acceleration: str = ""
    traction: str = ""
    levels: Mapping[str, str] = field(default_factory=dict)
    beside: tuple[str, ...] = ()
