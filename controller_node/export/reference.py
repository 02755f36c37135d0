"""The reference log: control periods computed by the law itself in Python, for the exported C to compute again.

The inputs are made here, by an integer generator, so that the same law and scenario give the same log: a run that
follows its set-points, one that has settled on a steady set-point (where a law that judges its own prediction judges
it good), one whose speed jumps, one at the limits of the wire. The program that the C is written from runs beside the
law; an export whose program is not the law is refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from controller_node.arithmetic import make
from controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from controller_node.export.names import comment
from controller_node.laws.base import NOTCH_Q, SPEED_Q
from controller_node.loop import ControlLoop
from controller_node.program.evaluate import Evaluator
from controller_node.program.model import LawProgram
from controller_node.program.record import leaves
from scenarios.errors import InputError, Words
from scenarios.model import Scenario

#: Bits of a record's flags.
FLAG_BEGIN = 1
FLAG_SENT = 2

_PERIODS = 80
#: Limits of TrainSpeed (s24), 0.1 mm/s.
_SPEED_MIN, _SPEED_MAX = -(2**23), 2**23 - 1
_SPEED_LIKELY_01MMPS = 300_000
_SENT_EVERY = 7
#: Speed errors of the settled run, 0.1 mm/s: 0.03 km/h, and before that what makes it look like a quick approach.
_NEAR_01MMPS, _OFF_01MMPS = 80, 4_000
_MASK = 2**32 - 1

Record = tuple[int, int, int, int, int]


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

    def __init__(self, scenario: Scenario, programs: LawProgram, indexing: str) -> None:
        self.number, other = make("iq"), make("iq")
        self.loop: ControlLoop[int] = ControlLoop(scenario, programs.law, self.number, indexing)
        self._law = programs.law
        parts = (programs.inputs, programs.start, programs.step, programs.sent)
        self._inputs, self._start, self._step, self._sent = (Evaluator(part, other) for part in parts)
        self._state: dict[str, int] | None = None

    def period(self, record: Record) -> tuple[int, ...]:
        """Result words of one control period."""
        flags, k, speed_01mmps, position_01mm, sent = record
        inputs, outputs = self.loop.step(k, speed_01mmps, position_01mm)
        wire = {"k": k, "speed_01mmps": speed_01mmps, "position_01mm": position_01mm}
        given = self._inputs.run(wire)
        if self._state is None:
            self._state = self._start.run(given)
        after = self._step.run(self._state | given)
        self._state = {name: value for name, value in after.items() if name.startswith("state.")}
        if flags & FLAG_SENT:
            self.loop.sent(self.number.from_raw(sent, NOTCH_Q))
            self._state = self._sent.run(self._state | {"notch": sent})
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


def _following(scenario: Scenario, programs: LawProgram, indexing: str) -> Iterator[Record]:
    """A run near its set-points, with another notch sent now and then; then the train stands."""
    twin, generator = _Twin(scenario, programs, indexing), _Generator(1)
    speed = position = 0
    period_ms = scenario.timing.control_period_ns // 1_000_000
    for k in range(_PERIODS):
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 3 else 0)
        yield flags, k, speed, position, generator.between(-256, 256)
        set_point = _wire_speed(twin.loop.inputs(k, 0, position).set_point)
        speed = set_point + generator.between(-400, 400) if k < _PERIODS - 10 else 0
        position += speed * period_ms // 1000


def _settled(scenario: Scenario, programs: LawProgram, indexing: str) -> Iterator[Record]:
    """At the steadiest set-point of the timetable, with notches near 0: every other speed is right to a few mm/s."""
    generator = _Generator(4)
    loop = _Twin(scenario, programs, indexing).loop
    last = int(scenario.plan.running_time_s * 1e9) // scenario.timing.control_period_ns

    def unsteadiness(k: int) -> int:
        given = loop.inputs(k, 0, 0)
        return max(abs(point - given.set_point) for point in given.preview)

    steady = min(range(last + 1), key=unsteadiness)
    right = _wire_speed(loop.inputs(steady, 0, 0).set_point)
    for k in range(3 * _PERIODS):
        limit = _NEAR_01MMPS if k % 2 else _OFF_01MMPS
        off = generator.between(-limit, limit)
        yield (FLAG_BEGIN if k == 0 else 0) | FLAG_SENT, steady, right + off, 0, generator.between(-8, 8)


def _jumping() -> Iterator[Record]:
    """Speeds and positions without any order, within what a train can have."""
    generator = _Generator(2)
    for k in range(_PERIODS):
        speed = generator.between(0, _SPEED_LIKELY_01MMPS)
        position = generator.between(0, 40_000_000)
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 5 else 0)
        yield flags, generator.between(0, 500), speed, position, generator.between(-2048, 2048)


def _limits() -> Iterator[Record]:
    """The limits of the wire and of int32."""
    generator = _Generator(3)
    speeds = (_SPEED_MIN, -1, 0, 1, _SPEED_MAX)
    positions = (INT32_MIN, -1, 0, 50_000, 50_001, INT32_MAX)
    periods = (INT32_MIN, -1, 0, 1, 200, INT32_MAX)
    for k in range(_PERIODS):
        flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 2 else 0)
        chosen = [values[generator.between(0, len(values) - 1)] for values in (periods, speeds, positions)]
        yield flags, chosen[0], chosen[1], chosen[2], (-32768, 32767)[k % 2]


def _line(words: Sequence[int]) -> str:
    return " ".join(f"{word & _MASK:08X}" for word in words)


def reference_log(scenario: Scenario, programs: LawProgram, indexing: str, columns: Sequence[str]) -> str:
    """The log as text: comment lines, then one line of hexadecimal words for each control period.

    :param columns: names of the result words.
    :raises InputError: the recorded program computes something else than the law.
    """
    lines = [
        comment(f"# railhil log 1: law {programs.law}, scenario {scenario.name}, set-points by {indexing}"),
        f"# scenario SHA-256 {scenario.sha256}",
        "# each word: 8 hexadecimal digits of an int32, two's complement",
        f"# {' '.join(['flags', 'k', 'speed_01mmps', 'position_01mm', 'sent', *columns])}",
    ]
    made = (_following(scenario, programs, indexing), _settled(scenario, programs, indexing), _jumping(), _limits())
    for records in made:
        twin = _Twin(scenario, programs, indexing)
        lines += [_line((*record, *twin.period(record))) for record in records]
    return "\n".join(lines) + "\n"
