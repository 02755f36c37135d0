"""What the system ``ato`` looks at besides: does a law, at rest with a target of 0, keep sending one notch?

Rounding inside a loop can keep it going for ever where exact numbers come to rest. Two looks at a train that is held
at standstill: untouched, where the notch must not move at all; and after one reading of the smallest speed, where a
law may well swing by itself (its model runs on while the train is held), but no other than in float64. A law that
follows the timetable by itself is held where it ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

from railhil.audit.bars import CODE_DIFFERENCE_MAX, Bar, Look
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, BaliseReading, LawInputs, TrackInputs
from railhil.controller_node.loop import ControlLoop
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec

HELD_S = 60.0
#: One reading of 1 mm/s, in km/h with Q ``SPEED_Q``.
_KICK_RAW = round(0.0036 * 2**SPEED_Q)
#: Number of a control period after every timetable.
_PERIODS_MAX = 2**31 - 1


@dataclass(frozen=True, slots=True)
class Standstill:
    """What a train held for ``seconds`` is sent; codes are 1/256 notch.

    ``changes``: changes of the code at rest. ``kicked_difference``: largest difference to float64 (told the same
    notches) after the reading; ``kicked_swing``: largest code then, of the law itself.
    """

    seconds: float
    changes: int
    kicked_difference: int
    kicked_swing: int


class _Held:
    """A law that is given a train at standstill."""

    def __init__(self, scenario: Scenario, law: str, arithmetic: Arithmetic[Any]) -> None:
        self._arithmetic = arithmetic
        self._law = ControlLoop(scenario, LawSpec(law), arithmetic).law
        # Beyond the end of every timetable the last entry holds.
        stop, none = (arithmetic.from_raw(raw, 0) for raw in (round(scenario.plan.distance_m * 1e4), 0))
        self._track: Any = TrackInputs(_PERIODS_MAX, stop, BaliseReading(none, none, none)) if self._law.track else ()
        self._state: Any = self._law.start(self._inputs(0))

    def _inputs(self, speed_raw: int) -> LawInputs[Any]:
        zero = self._arithmetic.from_raw(0, SPEED_Q)
        speed = self._arithmetic.from_raw(speed_raw, SPEED_Q)
        return LawInputs(speed, zero, (zero,) * self._law.horizon, self._track)

    def step(self, speed_raw: int = 0) -> int:
        self._state, outputs = self._law.step(self._state, self._inputs(speed_raw))
        return int(self._arithmetic.raw(outputs.notch, NOTCH_Q))

    def sent(self, code: int) -> None:
        self._state = self._law.with_sent(self._state, self._arithmetic.from_raw(code, NOTCH_Q))


def standstill(scenario: Scenario, law: str, arithmetic: Arithmetic[Any], twin: Arithmetic[Any]) -> Standstill:
    """Hold the train twice.

    :param arithmetic: fresh, for the train at rest; ``twin``: another of the same, for the reading.
    """
    periods = round(HELD_S * 1e9 / scenario.timing.control_period_ns)
    at_rest = _Held(scenario, law, arithmetic)
    codes = [at_rest.step() for _ in range(periods)]
    kicked, reference = _Held(scenario, law, twin), _Held(scenario, law, make("float64"))
    differences, swings = [], []
    for k in range(periods):
        speed_raw = _KICK_RAW if k == 0 else 0
        code, wanted = kicked.step(speed_raw), reference.step(speed_raw)
        reference.sent(code)
        differences.append(abs(code - wanted))
        swings.append(abs(code))
    return Standstill(HELD_S, sum(a != b for a, b in pairwise(codes)), max(differences), max(swings))


def look(scenario: Scenario, law: LawSpec, fresh: Callable[[], Arithmetic[Any]]) -> Look:
    """The part ``audit`` of the system, see :data:`railhil.audit.bars.OwnLook`."""
    found = standstill(scenario, law.controller, fresh(), fresh())
    return Look(
        "standstill",
        f"Train held for {found.seconds:g} s with target 0",
        f"at rest the notch changes {found.changes} times; after one reading of 1 mm/s the law swings to "
        f"{found.kicked_swing}/256 notch, {found.kicked_difference}/256 from float64",
        asdict(found),
        (
            Bar(f"changes of the notch in {found.seconds:g} s at rest", f"{found.changes}", "0", not found.changes),
            Bar(
                "held train after one reading of 1 mm/s: difference",
                f"{found.kicked_difference}/256 notch",
                f"at most {CODE_DIFFERENCE_MAX}",
                found.kicked_difference <= CODE_DIFFERENCE_MAX,
            ),
        ),
    )
