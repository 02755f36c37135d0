"""The reference log: control periods computed by the law itself in Python, for the exported C to compute again.

The inputs are made here, by an integer generator, so that the same law and scenario give the same log: a run that
follows its set-points, one that has settled on a steady set-point (where a law that judges its own prediction judges
it good), one whose speed jumps, one at the limits of the wire. The program that the C is written from runs beside the
law; an export whose program is not the law is refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.export.names import comment
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, BaliseReading
from railhil.controller_node.loop import NO_BALISE, ControlLoop
from railhil.controller_node.program.evaluate import Evaluator
from railhil.controller_node.program.model import BALISE_INPUTS, LawProgram
from railhil.controller_node.program.record import leaves
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec

#: Bits of a record's flags.
FLAG_BEGIN = 1
FLAG_SENT = 2

_PERIODS = 80
#: Limits of TrainSpeed (s24), 0.1 mm/s.
_SPEED_MIN, _SPEED_MAX = -(2**23), 2**23 - 1
_SPEED_LIKELY_01MMPS = 300_000
_SENT_EVERY = 7
_BALISE_EVERY = 11
#: Speed errors of the settled run, 0.1 mm/s: 0.03 km/h, and before that what makes it look like a quick approach.
_NEAR_01MMPS, _OFF_01MMPS = 80, 4_000
_MASK = 2**32 - 1


@dataclass(frozen=True, slots=True)
class LogPeriod:
    """One control period of a log: flags, what is on the wire, notch sent (1/256)."""

    flags: int
    k: int
    speed_01mmps: int
    position_01mm: int
    sent: int
    balise: BaliseReading[int] = NO_BALISE

    def words(self, track: bool) -> tuple[int, ...]:
        """Words of a line; the balise only for a law that is given it."""
        words = (self.flags, self.k, self.speed_01mmps, self.position_01mm, self.sent)
        return (*words, *self.balise) if track else words


class _Generator:
    """Numerical Recipes' linear congruential generator, upper bits."""

    def __init__(self, seed: int) -> None:
        self._state = seed

    def between(self, low: int, high: int) -> int:
        self._state = (1664525 * self._state + 1013904223) & _MASK
        return low + (self._state >> 8) % (high - low + 1)


class _Twin:
    """The law and its program side by side, from the start of a run.

    :raises InputError: in :meth:`period`, when their results differ.
    """

    def __init__(self, scenario: Scenario, programs: LawProgram, law: LawSpec) -> None:
        self.number, other = make("iq"), make("iq")
        self.loop: ControlLoop[int] = ControlLoop(scenario, law, self.number)
        self._law, self.track = programs.law, programs.track
        parts = (programs.inputs, programs.start, programs.step, programs.sent)
        self._inputs, self._start, self._step, self._sent = (Evaluator(part, other) for part in parts)
        self._state: dict[str, int] | None = None

    def period(self, record: LogPeriod) -> tuple[int, ...]:
        """Result words of one control period."""
        inputs, outputs = self.loop.step(record.k, record.speed_01mmps, record.position_01mm, record.balise)
        wire = {"k": record.k, "speed_01mmps": record.speed_01mmps, "position_01mm": record.position_01mm}
        if self.track:
            wire |= zip(BALISE_INPUTS, record.balise, strict=True)
        given = self._inputs.run(wire)
        if self._state is None:
            self._state = self._start.run(given)
        after = self._step.run(self._state | given)
        self._state = {name: value for name, value in after.items() if name.startswith("state.")}
        if record.flags & FLAG_SENT:
            self.loop.sent(self.number.from_raw(record.sent, NOTCH_Q))
            self._state = self._sent.run(self._state | {"notch": record.sent})
        law: list[Any] = [*leaves(inputs, "in"), *leaves(self.loop.state, "state"), *leaves(outputs, "out")]
        program = [*given.items(), *self._state.items(), *((n, v) for n, v in after.items() if n.startswith("out."))]
        for (name, value), (_, other) in zip(law, program, strict=True):
            if value != other:
                found = Words(f"{name} = {other} from its recorded operations, {value} from the law")
                raise InputError("controller", self._law, found, "a law without branches on data")
        counters = self.number.counters
        return (*(value for _, value in law), counters.saturations, counters.zero_divisions)


def _wire_speed(kmh_raw: int) -> int:
    """km/h in Q20 as 0.1 mm/s."""
    return kmh_raw * 25_000 // (9 << SPEED_Q)


def _following(scenario: Scenario, twin: _Twin) -> Iterator[LogPeriod]:
    """A run near its set-points, with another notch sent now and then; then the train stands."""
    generator = _Generator(1)
    speed = position = 0
    balise = NO_BALISE
    period_ms = scenario.timing.control_period_ns // 1_000_000
    for k in range(_PERIODS):
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 3 else 0)
        yield LogPeriod(flags, k, speed, position, generator.between(-256, 256), balise)
        set_point = _wire_speed(twin.loop.inputs(k, 0, position).set_point)
        speed = set_point + generator.between(-400, 400) if k < _PERIODS - 10 else 0
        position += speed * period_ms // 1000
        if k % _BALISE_EVERY == 0:
            balise = BaliseReading(k // _BALISE_EVERY + 1, position + generator.between(-20_000, 20_000), position)


def _settled(scenario: Scenario, twin: _Twin) -> Iterator[LogPeriod]:
    """At the steadiest set-point of the timetable, with notches near 0: every other speed is right to a few mm/s."""
    generator = _Generator(4)
    loop = twin.loop
    last = int(scenario.plan.running_time_s * 1e9) // scenario.timing.control_period_ns

    def unsteadiness(k: int) -> int:
        given = loop.inputs(k, 0, 0)
        following = given.preview or [loop.inputs(k + 1, 0, 0).set_point]
        return max(abs(point - given.set_point) for point in following)

    steady = min(range(last + 1), key=unsteadiness)
    right = _wire_speed(loop.inputs(steady, 0, 0).set_point)
    for k in range(3 * _PERIODS):
        limit = _NEAR_01MMPS if k % 2 else _OFF_01MMPS
        off = generator.between(-limit, limit)
        flags = (FLAG_BEGIN if k == 0 else 0) | FLAG_SENT
        yield LogPeriod(flags, steady, right + off, 0, generator.between(-8, 8))


def _jumping() -> Iterator[LogPeriod]:
    """Speeds and positions without any order, within what a train can have."""
    generator = _Generator(2)
    for k in range(_PERIODS):
        speed = generator.between(0, _SPEED_LIKELY_01MMPS)
        position = generator.between(0, 40_000_000)
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 5 else 0)
        balise = BaliseReading(*(generator.between(0, high) for high in (8, 40_000_000, 40_000_000)))
        yield LogPeriod(flags, generator.between(0, 500), speed, position, generator.between(-2048, 2048), balise)


def _limits() -> Iterator[LogPeriod]:
    """The limits of the wire and of int32."""
    generator = _Generator(3)
    speeds = (_SPEED_MIN, -1, 0, 1, _SPEED_MAX)
    positions = (INT32_MIN, -1, 0, 50_000, 50_001, INT32_MAX)
    periods = (INT32_MIN, -1, 0, 1, 200, INT32_MAX)
    for k in range(_PERIODS):
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 2 else 0)
        k_, speed, position = [values[generator.between(0, len(values) - 1)] for values in (periods, speeds, positions)]
        balise = BaliseReading(*(positions[generator.between(0, len(positions) - 1)] for _ in range(3)))
        yield LogPeriod(flags, k_, speed, position, (-32768, 32767)[k % 2], balise)


def _line(words: Sequence[int]) -> str:
    return " ".join(f"{word & _MASK:08X}" for word in words)


def reference_log(
    scenario: Scenario,
    programs: LawProgram,
    law: LawSpec,
    columns: Sequence[str],
) -> str:
    """The log as text: comment lines, then one line of hexadecimal words for each control period.

    :param columns: names of the result words.
    :raises InputError: the recorded program computes something else than the law.
    """
    wire = ["flags", "k", "speed_01mmps", "position_01mm", "sent", *(BALISE_INPUTS if programs.track else ())]
    lines = [
        comment(f"# railhil log 1: law {programs.law}, scenario {scenario.name}, {law.set_points}"),
        f"# scenario SHA-256 {scenario.sha256}",
        "# each word: 8 hexadecimal digits of an int32, two's complement",
        f"# {' '.join([*wire, *columns])}",
    ]

    def fresh() -> _Twin:
        return _Twin(scenario, programs, law)

    for records in (_following(scenario, fresh()), _settled(scenario, fresh()), _jumping(), _limits()):
        twin = fresh()
        lines += [_line((*record.words(programs.track), *twin.period(record))) for record in records]
    return "\n".join(lines) + "\n"
