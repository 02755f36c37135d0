"""Records the programs of a control loop by calling every function of the law once under the tracer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from railhil.common.plug_ins import plugged_in
from railhil.controller_node.ato.loop import NO_BALISE, ControlLoop
from railhil.controller_node.laws.base import NOTCH_Q, BaliseReading
from railhil.controller_node.laws.fault import law_fault
from railhil.controller_node.program.leaves import leaves, like
from railhil.controller_node.program.model import BALISE_INPUTS, Kind, LawProgram, Program, Value
from railhil.controller_node.program.tracer import FormatError, Tracer
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec

#: Functions of a law whose names differ from those of their programs.
_FUNCTIONS = {"sent": "with_sent", "first step": "step"}


def record(
    scenario: Scenario,
    law: LawSpec,
    *,
    wide: bool = False,
) -> LawProgram:
    """Programs of a law on a scenario.

    :param law: its arithmetic is ignored.
    :param wide: record it as run by an arithmetic without formats (for operation counts); formats are then not checked.
    :raises scenarios.errors.InputError: an unknown law or indexing; a law that raises, mixes formats, computes with
        Python's operators or changes the formats of its state: with the location in the law's source.
    """
    tracer = Tracer(wide)
    loop: ControlLoop[Value] = ControlLoop(scenario, law, tracer)

    def inputs() -> Any:
        k = tracer.input("k", None, Kind.INDEX)
        speed, position = tracer.input("speed_01mmps", 0), tracer.input("position_01mm", 0)
        balise: BaliseReading[Any] = NO_BALISE
        if loop.law.track:
            balise = BaliseReading(*(tracer.input(name, 0) for name in BALISE_INPUTS))
        return loop.inputs(k, speed, position, balise)

    def told() -> Any:
        return tracer.input("notch", NOTCH_Q)

    def check(outputs: Any) -> None:
        if len(outputs.notes) != len(loop.law.notes):
            raise FormatError(f"step answers {len(outputs.notes)} notes, the law declares {len(loop.law.notes)}")
        for note, value in zip(loop.law.notes, outputs.notes, strict=True):
            if not wide and value.q is not None and value.q != note.q:
                raise FormatError(f"note {note.name} is Q{value.q}, declared Q{note.q}")

    return recorded(tracer, law.controller, type(loop.law), loop.law, inputs, told, check)


class Stepped(Protocol):
    """The functions of a law that are traced."""

    @property
    def start(self) -> Callable[[Any], Any]:
        """Inputs -> state."""

    @property
    def step(self) -> Callable[[Any, Any], Any]:
        """State and inputs -> state and outputs."""

    @property
    def with_sent(self) -> Callable[[Any, Any], Any]:
        """State and what was sent -> state."""


def _unchecked(outputs: Any) -> None:
    """No check: the outputs have already been zipped together."""


def recorded(
    tracer: Tracer,
    law: str,
    kind: type[Any],
    functions: Stepped,
    given: Callable[[], Any],
    told: Callable[[], Any],
    check: Callable[[Any], None] = _unchecked,
) -> LawProgram:
    """Programs of a law that is bound to a tracer.

    :param law: the name by which it was requested; ``kind``: its class, for error messages.
    :param given: makes the law's inputs from inputs of the tracer; ``told``: inputs for what was really sent.
    :param check: raises FormatError for outputs of a step that are not as declared.
    :raises InputError: like :func:`record`.
    """
    try:
        with plugged_in():
            return _recorded(tracer, law, functions, given, told, check)
    except Exception as error:
        # A law is code that somebody plugs in, and may raise anything.
        program = tracer.program
        quantity = program.quantities[-1].name if program is not None and program.quantities else None
        function = program.name if program is not None else "inputs"
        raise law_fault(law, kind, error, _FUNCTIONS.get(function, function), quantity) from error


def _recorded(
    tracer: Tracer,
    law: str,
    functions: Stepped,
    inputs_of: Callable[[], Any],
    told_of: Callable[[], Any],
    check: Callable[[Any], None],
) -> LawProgram:
    wide = tracer.wide

    def fresh(name: str, old: Value) -> Value:
        return tracer.input(name, old.q, old.kind)

    inputs = tracer.begin("inputs")
    given = inputs_of()
    inputs.outputs = list(leaves(given, "in"))

    start = tracer.begin("start")
    first_state = functions.start(like(given, fresh, "in"))
    start.outputs = list(leaves(first_state, "state"))
    formats = _formats(tracer, functions, first_state, given)

    def state_input(name: str, old: Value) -> Value:
        return tracer.input(name, formats[name])

    step = tracer.begin("step")
    state = like(first_state, state_input, "state")
    new_state, outputs = functions.step(state, like(given, fresh, "in"))
    check(outputs)
    step.outputs = [*leaves(new_state, "state"), *leaves(outputs, "out")]
    sent = tracer.begin("sent")
    told = functions.with_sent(like(first_state, state_input, "state"), told_of())
    sent.outputs = list(leaves(told, "state"))
    if not wide:
        _check(step, formats)
        _check(sent, formats)
    return LawProgram(law, inputs, start, step, sent)


def _formats(tracer: Tracer, functions: Stepped, first_state: Any, given: Any) -> dict[str, int | None]:
    """Format of every leaf of the state: from its start or, if it starts as the constant 0, from the result of a
    step."""
    formats = {name: value.q for name, value in leaves(first_state, "state")}

    def known(name: str, old: Value) -> Value:
        return tracer.input(name, formats.get(name, old.q), old.kind)

    while True:
        tracer.begin("first step")
        after, _ = functions.step(like(first_state, known, "state"), like(given, known, "in"))
        found = {name: value.q for name, value in leaves(after, "state") if formats[name] is None}
        if all(q is None for q in found.values()):
            return formats
        formats |= found


def _check(program: Program, formats: dict[str, int | None]) -> None:
    for name, value in program.outputs:
        expected = formats.get(name)
        if expected is not None and value.q is not None and value.q != expected:
            raise FormatError(f"{program.name}: state {name} is Q{expected} before and Q{value.q} after")
