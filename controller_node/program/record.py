"""Records the programs of a law by calling each of its functions once under the tracer."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from railhil.common.plug_ins import guard_plug_in
from railhil.controller_node.laws.fault import law_fault
from railhil.controller_node.program.leaves import leaves, like
from railhil.controller_node.program.model import LawProgram, Program, Value
from railhil.controller_node.program.tracer import FormatError, Tracer
from railhil.scenarios.run_spec import LawSpec

if TYPE_CHECKING:
    from railhil.controller_node.law_loop import LawLoop

#: Functions of a law whose names differ from those of their programs.
_FUNCTIONS = {"sent": "with_sent", "first step": "step"}


def record(scenario: Any, law: LawSpec, *, wide: bool = False) -> LawProgram:
    """Programs of a law on a scenario of its system, see :func:`record_loop`."""
    computes = scenario.installed_system.part("controller").computes
    return record_loop(computes.loop, scenario, law, wide=wide)


def record_loop(
    loop: Callable[[Any, LawSpec, Any], LawLoop[Value]], scenario: Any, law: LawSpec, *, wide: bool = False
) -> LawProgram:
    """Programs of a law on a scenario.

    :param loop: binds a law to an arithmetic.
    :param law: its arithmetic is ignored.
    :param wide: record it as run by an arithmetic without formats (for operation counts); formats are then not checked.
    :raises InputError: the law cannot be bound; a law that raises, mixes formats, computes with Python's operators or
        changes the formats of its state: with the location in the law's source.
    """
    tracer = Tracer(wide)
    bound = loop(scenario, law, tracer)
    try:
        with guard_plug_in():
            return _recorded(tracer, bound)
    except Exception as error:
        # A law is code that somebody plugs in, and may raise anything.
        program = tracer.program
        quantity = program.quantities[-1].name if program is not None and program.quantities else None
        function = program.name if program is not None else "inputs"
        raise law_fault(bound.name, type(bound.law), error, _FUNCTIONS.get(function, function), quantity) from error


def _recorded(tracer: Tracer, loop: LawLoop[Value]) -> LawProgram:
    wide = tracer.wide

    def fresh(name: str, old: Value) -> Value:
        return tracer.input(name, old.q, old.kind)

    inputs = tracer.begin("inputs")
    given = loop.traced_inputs(tracer)
    inputs.outputs = list(leaves(given, "in"))

    start = tracer.begin("start")
    first_state = loop.law.start(like(given, fresh, "in"))
    start.outputs = list(leaves(first_state, "state"))
    formats = _formats(tracer, loop, first_state, given)

    def state_input(name: str, old: Value) -> Value:
        return tracer.input(name, formats[name])

    step = tracer.begin("step")
    state = like(first_state, state_input, "state")
    new_state, outputs = loop.answered(state, like(given, fresh, "in"))
    step.outputs = [*leaves(new_state, "state"), *leaves(outputs, "out")]
    sent = tracer.begin("sent")
    told = loop.law.with_sent(like(first_state, state_input, "state"), loop.traced_commands(tracer))
    sent.outputs = list(leaves(told, "state"))
    if not wide:
        _check(step, formats)
        _check(sent, formats)
    return LawProgram(loop.name, inputs, start, step, sent)


def _formats(tracer: Tracer, loop: LawLoop[Value], first_state: Any, given: Any) -> dict[str, int | None]:
    """Format of every leaf of the state: from its start or, if it starts as the constant 0, from the result of a
    step."""
    formats = {name: value.q for name, value in leaves(first_state, "state")}

    def known(name: str, old: Value) -> Value:
        return tracer.input(name, formats.get(name, old.q), old.kind)

    while True:
        tracer.begin("first step")
        after, _ = loop.answered(like(first_state, known, "state"), like(given, known, "in"))
        found = {name: value.q for name, value in leaves(after, "state") if formats[name] is None}
        if all(q is None for q in found.values()):
            return formats
        formats |= found


def _check(program: Program, formats: dict[str, int | None]) -> None:
    for name, value in program.outputs:
        expected = formats.get(name)
        if expected is not None and value.q is not None and value.q != expected:
            raise FormatError(f"{program.name}: state {name} is Q{expected} before and Q{value.q} after")
