"""The export of a train's law: readings of one train in, one notch out (part ``export`` of the system ``ato``)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.ecan import Mailbox
from railhil.controller_node.export import notch_runs
from railhil.controller_node.export.control import Comments, Control, Loop, Macro, Period, Play, Word
from railhil.controller_node.export.node_header import node_header
from railhil.controller_node.export.templates import template
from railhil.controller_node.laws import load
from railhil.controller_node.laws.base import NOTCH_Q, BaliseReading
from railhil.controller_node.laws.note import SLOTS, slots
from railhil.controller_node.loop import NO_BALISE, ControlLoop
from railhil.controller_node.node import mailboxes
from railhil.controller_node.program.model import BALISE_INPUTS, Value
from railhil.controller_node.program.record import record
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec

_BALISE_WORDS = ";\n * last balise: its number (0: none yet), surveyed position and odometer at its passing (0.1 mm)"
#: The controller around the law, the same for every law but for names.
_NODE_FILES = (
    "railhil_mvb.h",
    "railhil_guard.h",
    "railhil_guard.c",
    "railhil_position.c",
    "railhil_control.h",
    "railhil_control.c",
    "railhil_socket.h",
    "railhil_socket.c",
    "railhil_node.c",
)


class _NotchLoop:
    """See :class:`railhil.controller_node.export.control.Loop`."""

    def __init__(self, loop: ControlLoop[int]) -> None:
        self._loop = loop

    @property
    def state(self) -> Any:
        return self._loop.state

    def step(self, given: Sequence[int]) -> tuple[Any, Any]:
        k, speed_01mmps, position_01mm, *balise = given
        return self._loop.step(k, speed_01mmps, position_01mm, BaliseReading(*balise) if balise else NO_BALISE)

    def sent(self, told: Sequence[int]) -> None:
        self._loop.sent(self._loop.arithmetic.from_raw(told[0], NOTCH_Q))


class NotchControl(Control):
    """See :class:`railhil.controller_node.export.control.Control`."""

    scenario: Scenario

    def __init__(self, scenario: Scenario, law: LawSpec) -> None:
        super().__init__(scenario, law)
        self.programs = record(scenario, law)
        first = [Word(name, name, name) for name in ("k", "speed_01mmps", "position_01mm")]
        balise = [Word(name, name, name) for name in (BALISE_INPUTS if self.programs.track else ())]
        self.given, self.told = (*first, *balise), (Word("notch", "notch_code", "sent"),)
        self.record = (*first, *self.told, *balise)

    def comments(self, name: str) -> Comments:
        balise_words = _BALISE_WORDS if self.programs.track else ""
        return Comments(
            use=(
                f"Each control period: {name}_inputs, in the first one {name}_start, then {name}_step. The answer is",
                f"out.notch in 1/256 notch. When another notch is sent, {name}_sent tells the law.",
            ),
            inputs="Control period k, measured speed (0.1 mm/s) and position from the start of the run (0.1 mm)"
            + balise_words,
            sent="The notch (1/256) really sent since the last control period",
            status="CTL_STAT",
            what="notch",
            other="another notch than the answer was",
            record="k,\n * speed in 0.1 mm/s, position in 0.1 mm, notch sent (1/256), and for a law that is given\n"
            " * them: number, surveyed position and odometer at its passing (0.1 mm) of the last balise",
        )

    def member(self, leaf: str) -> str:
        return leaf.partition(".")[2]

    def input_unit(self, leaf: str, value: Value) -> str:
        """Speeds, and positions of the track inputs."""
        if not leaf.startswith("in.track."):
            return "km/h"
        return "0.1 mm" if leaf.endswith("_01mm") else ""

    def macros(self) -> list[Macro]:
        notes = load(self.programs.law).notes
        found = slots(notes)

        def macro(signal: str, number: int) -> Macro:
            note = notes[number]
            words = ", ".join(filter(None, (note.name, note.title, f"1/2^{note.wire_q}", note.unit, *note.bits)))
            return Macro(signal, f"out.notes[{number}]", note.shift, note.limits, words)

        return [macro(signal, found[signal]) if signal in found else Macro(signal) for signal in SLOTS]

    def mailboxes(self) -> tuple[Mailbox, ...]:
        return mailboxes()

    def loop(self, number: Arithmetic[int]) -> Loop:
        return _NotchLoop(ControlLoop(self.scenario, self.law, number))

    def runs(self, play: Play | None) -> Iterator[Iterable[Period]]:
        """None of the bench: the set-points say what a run is like."""
        scenario, law = self.scenario, self.law
        runs = (
            notch_runs.following(scenario, ControlLoop(scenario, law, make("iq"))),
            notch_runs.settled(scenario, ControlLoop(scenario, law, make("iq"))),
            notch_runs.jumping(),
            notch_runs.limits(),
        )
        for periods in runs:
            yield (period._replace(given=period.given[: len(self.given)]) for period in periods)

    def node_files(self, name: str) -> Mapping[str, str]:
        balise = "".join(f", balise[{word}]" for word in range(len(self.given) - 3))
        header = node_header(name, self.programs, self.scenario, self.law)
        return {f"{name}_node.h": header, **{file: template(file, name, BALISE=balise) for file in _NODE_FILES}}

    def node_rows(self, name: str) -> tuple[tuple[str, str], ...]:
        return (
            ("`railhil_control.c`, `railhil_control.h`", "the controller on the bus: frames in, answers to polls out"),
            ("`railhil_guard.c`, `.h`, `railhil_position.c`", "its time, reaction ladder, position, balises"),
            (f"`railhil_mvb.h`, `{name}_node.h`", "telegrams on CAN frames; constants of wire and scenario"),
            ("`railhil_node.c`, `railhil_socket.c`, `.h`", "host program: SocketCAN, or the bench's hub"),
        )
