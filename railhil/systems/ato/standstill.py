"""The system ``ato``'s own examination: does a law keep its notch constant at standstill with target 0?

Rounding inside a feedback loop can sustain an oscillation (a limit cycle) that exact arithmetic would not have. A train
is held at standstill twice: undisturbed, where the notch must not change at all; and after one reading of 1 mm/s, where
the law may oscillate by itself (its model keeps moving while the train is held), but in the same way as in float64. A
law that follows the timetable by itself is examined at the timetable's end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

from railhil.audit.bars import CODE_DIFFERENCE_MAX, Bar, Look
from railhil.common.digits import count_of
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, BaliseReading, LawInputs, TrackInputs
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario

HELD_S = 60.0
#: One reading of 1 mm/s, in km/h with Q ``SPEED_Q``.
_KICK_RAW = round(0.0036 * 2**SPEED_Q)
#: Number of a control period beyond the end of any timetable.
_PERIODS_MAX = 2**31 - 1


@dataclass(frozen=True, slots=True)
class Standstill:
    """Notch codes (1/256 notch) computed for a train that is held at standstill for ``seconds``.

    ``changes``: changes of the code at rest. After the reading of 1 mm/s, ``kicked_difference`` is the largest
    difference from float64 (given the same notches) and ``kicked_swing`` the largest magnitude of the law's code.
    """

    seconds: float
    changes: int
    kicked_difference: int
    kicked_swing: int


class _Held:
    """A law with the inputs of a train at standstill."""

    def __init__(self, scenario: Scenario, law: str, arithmetic: Arithmetic[Any]) -> None:
        self._arithmetic = arithmetic
        self._law = ControlLoop(scenario, LawSpec(law), arithmetic).law
        # Beyond the end of the timetable its last entry applies.
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
    """Hold the train twice: undisturbed, and after one reading of 1 mm/s.

    :param arithmetic: fresh, for the undisturbed train.
    :param twin: another fresh one of the same kind, for the train with the reading.
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
        f"at rest the notch changes {count_of(found.changes, 'time')}; after one reading of 1 mm/s the law swings to "
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
