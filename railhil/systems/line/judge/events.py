"""Sources of the events of the system ``line``: those of the train, its protection, and the telegrams of doors and
stations.
"""

from __future__ import annotations

from typing import Final

from railhil.judge.declared import Interlocks, Received, Watch
from railhil.systems.ato.judge import events as of_train
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.ato import PltStat
from railhil.wire.line import AtpLim, AtpStatus, DoorCmd, DoorStat, StnInfo

_CAUSES: Final = {
    "ceiling": "above the speed limit",
    "target": "above the curve to a target",
    "release": "above the release speed",
    "trip": "passed the end of authority",
    "position": "position not sure",
    "doors": "doors not locked in motion",
    "roll_away": "rolled away at standstill",
    "self_test": "its own fault",
    "red_signal": "red signal or no authority",
}


def protection_cause(cause: str) -> str:
    """Cause of a reaction of the train protection, in words; it stands in ATP_STAT."""
    return _CAUSES.get(cause, cause.replace("_", " "))


#: An indication, and a train just above the permitted speed, are no reaction.
PROTECTION: Final = Watch(
    "protection",
    "train protection's",
    AtpLim.PORT,
    "AtpStatus",
    "",
    (AtpStatus.NORMAL, AtpStatus.INDICATION, AtpStatus.OVERSPEED, AtpStatus.WARNING, AtpStatus.INTERVENTION),
    quiet=frozenset({AtpStatus.INDICATION, AtpStatus.OVERSPEED}),
    # A warning cuts traction; an intervention is the service brake at least.
    rungs=(0, 0, 0, 2, 3),
)
WATCHES: Final = (*of_train.WATCHES, PROTECTION)
#: Of the train status all but the doors, which open at each stop: DOOR_STAT and the milestones show them.
INTERLOCKS: Final = tuple(
    Interlocks(
        item.port,
        {name: normal for name, normal in item.normal.items() if name not in ("DoorsClosedLocked", "TractionEnabled")},
    )
    if item.port == PltStat.PORT
    else item
    for item in of_train.INTERLOCKS
)


def received(scenario: LineScenario) -> tuple[Received, ...]:
    """Telegrams that controller and train accept only after a check of their content."""
    return (
        *of_train.received(scenario),
        *(Received.of(kind) for kind in (DoorStat, StnInfo, AtpLim, DoorCmd)),
    )
