"""Runs for the reference log of a train's law.

They are made by an integer generator, so the same law and scenario give the same log: a run that follows its
set-points, one that has settled on a steady set-point (where a law that rates its own prediction rates it as good), one
with random speeds, and one at the limits of the wire.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.ato.control_loop import NO_BALISE, ControlLoop
from railhil.controller_node.export.control import FLAG_BEGIN, FLAG_SENT, Generator, Period
from railhil.controller_node.laws.base import SPEED_Q, BaliseReading
from railhil.controller_node.vector.law import raw_range
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, TrnSpeed

_PERIODS = 80
_SPEED_LIKELY_01MMPS = 300_000
_SENT_EVERY = 7
_BALISE_EVERY = 11
#: Largest speed errors of the settled run, 0.1 mm/s: 0.03 km/h in every other period, and a larger one in the periods
#: between, which makes the approach look fast.
_NEAR_01MMPS, _OFF_01MMPS = 80, 4_000


def _period(
    flags: int, k: int, speed_01mmps: int, position_01mm: int, sent: int, balise: BaliseReading[int] = NO_BALISE
) -> Period:
    return Period(flags, (k, speed_01mmps, position_01mm, *balise), (sent,))


def _wire_speed(loop: ControlLoop[Any], kmh: Any) -> int:
    """km/h, an operand of the law's arithmetic, as 0.1 mm/s."""
    raw: int = loop.arithmetic.raw(kmh, SPEED_Q)
    return raw * 25_000 // (9 << SPEED_Q)


def following(scenario: Scenario, loop: ControlLoop[Any]) -> Iterator[Period]:
    """A run near its set-points, in which another notch is sent in some periods; the train stands at the end."""
    generator = Generator(1)
    speed = position = 0
    balise = NO_BALISE
    period_ms = scenario.timing.control_period_ns // 1_000_000
    for k in range(_PERIODS):
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 3 else 0)
        yield _period(flags, k, speed, position, generator.between(-256, 256), balise)
        set_point = _wire_speed(loop, loop.inputs(k, 0, position).set_point)
        speed = set_point + generator.between(-400, 400) if k < _PERIODS - 10 else 0
        position += speed * period_ms // 1000
        if k % _BALISE_EVERY == 0:
            balise = BaliseReading(k // _BALISE_EVERY + 1, position + generator.between(-20_000, 20_000), position)


def settled(scenario: Scenario, loop: ControlLoop[Any]) -> Iterator[Period]:
    """At the steadiest set-point of the timetable, notches near 0: every other speed is correct to a few mm/s."""
    generator = Generator(4)
    last = int(scenario.plan.running_time_s * 1e9) // scenario.timing.control_period_ns

    def unsteadiness(k: int) -> Any:
        given = loop.inputs(k, 0, 0)
        following = given.preview or [loop.inputs(k + 1, 0, 0).set_point]
        return max(abs(point - given.set_point) for point in following)

    steady = min(range(last + 1), key=unsteadiness)
    right = _wire_speed(loop, loop.inputs(steady, 0, 0).set_point)
    for k in range(3 * _PERIODS):
        limit = _NEAR_01MMPS if k % 2 else _OFF_01MMPS
        off = generator.between(-limit, limit)
        flags = (FLAG_BEGIN if k == 0 else 0) | FLAG_SENT
        yield _period(flags, steady, right + off, 0, generator.between(-8, 8))


def jumping() -> Iterator[Period]:
    """Random speeds and positions, within the range of a real train."""
    generator = Generator(2)
    for k in range(_PERIODS):
        speed = generator.between(0, _SPEED_LIKELY_01MMPS)
        position = generator.between(0, 40_000_000)
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 5 else 0)
        balise = BaliseReading(*(generator.between(0, high) for high in (8, 40_000_000, 40_000_000)))
        yield _period(flags, generator.between(0, 500), speed, position, generator.between(-2048, 2048), balise)


def limits() -> Iterator[Period]:
    """The limits of the wire and of int32."""
    generator = Generator(3)
    slowest, fastest = raw_range(TrnSpeed, "speed_01mmps")
    speeds = (slowest, -1, 0, 1, fastest)
    notches = raw_range(NotchCmd, "notch_256th")
    positions = (INT32_MIN, -1, 0, 50_000, 50_001, INT32_MAX)
    periods = (INT32_MIN, -1, 0, 1, 200, INT32_MAX)
    for k in range(_PERIODS):
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 2 else 0)
        k_, speed, position = [values[generator.between(0, len(values) - 1)] for values in (periods, speeds, positions)]
        balise = BaliseReading(*(positions[generator.between(0, len(positions) - 1)] for _ in range(3)))
        yield _period(flags, k_, speed, position, notches[k % 2], balise)
