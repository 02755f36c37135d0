"""The law of many trains as machine code from its recorded program: replaces the loop of the law on arrays.

For the shipped laws in ``iq``, ``float64`` and ``float32``. In another arithmetic, and for a foreign law or one with an
operation that cannot be emitted, the law itself is computed on arrays
(:class:`railhil.controller_node.ato.control_loop.ControlLoop`). The law itself also computes the first control period,
and a step of a train with an event to count.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from railhil.batch import compiled, law_parts
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import NO_BALISE, ControlLoop
from railhil.controller_node.ato.controller import WIRE
from railhil.controller_node.compiled_law import is_shipped
from railhil.controller_node.laws import load
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.program.emit_numba import emit_numba
from railhil.controller_node.program.emit_python import FIXED, FLOAT32, FLOAT64, is_state
from railhil.controller_node.program.model import Program, map_leaves, name_leaves
from railhil.controller_node.program.ranges import Ranges, analyse_law
from railhil.controller_node.program.tracer import record
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario

#: Kind of text for each arithmetic that has one.
_FAMILIES = {"iq": FIXED, "float64": FLOAT64, "float32": FLOAT32}


class Notches(NamedTuple):
    """The output that the batch uses."""

    notch: NDArray[Any]


class EmittedProgram:
    """One program of a law as machine code, bound to its numbers.

    :param law: its name.
    :param ranges: of its values in fixed point; None in an arithmetic without formats.
    :raises KeyError: an operation that cannot be emitted.
    """

    def __init__(self, program: Program, law: str, arithmetic: str, ranges: Ranges | None) -> None:
        family = _FAMILIES[arithmetic]
        emitted = emit_numba(program, family, make(arithmetic), ranges)
        kind: Any = np.int64 if family == FIXED else np.float64
        self._numbers = (
            np.array(emitted.numbers, dtype=kind),
            np.array(emitted.limits, dtype=np.int64),
            *(np.array(table, dtype=kind) for table in emitted.tables),
        )
        what = f"{law} in {arithmetic} ({program.name})"
        self._function = compiled.cached_text(emitted.text, program.name, what, law_parts)
        self._kind = kind
        #: Number of outputs that are no state.
        self.answers = sum(not is_state(name) for name, _ in program.outputs)

    def run(self, state: NDArray[Any], given: NDArray[Any], left: NDArray[np.bool_]) -> NDArray[Any]:
        """Its outputs, shape (N, outputs), and the new state in place of the old one, shape (N, leaves).

        :param given: (N, inputs).
        :param left: set where the law itself has to compute the step; the state is unchanged there.
        """
        answer = np.empty((len(given), self.answers), dtype=self._kind)
        self._function(state, given, answer, left, *self._numbers)
        return answer


class EmittedLoop:
    """A control loop whose law is machine code.

    ``state``: set to None it begins anew. ``arithmetic``: on arrays; its counts cover all steps.

    :param programs: inputs and step of the law.
    :param notch: place of the notch among the outputs of the step.
    """

    def __init__(self, law: ControlLoop[Any], programs: tuple[EmittedProgram, EmittedProgram], notch: int) -> None:
        self._law = law
        self.arithmetic: Any = law.arithmetic
        self.track = law.law.track
        self._inputs, self._step = programs
        self._notch = notch
        self._state: NDArray[Any] | None = None
        self._kinds: list[Any] = []

    @property
    def state(self) -> Any:
        """Leaves of the state of each train, None before the first step."""
        return self._state

    @state.setter
    def state(self, state: None) -> None:
        self._state = self._law.state = state

    def step(
        self, k: Any, speed_01mmps: Any, position_01mm: Any, balise: BaliseReading[Any] = NO_BALISE
    ) -> tuple[None, Notches]:
        """One control period of all trains."""
        trains = np.size(speed_01mmps)
        kind = self._step._kind
        if self._state is None:
            _, outputs = self._law.step(k, speed_01mmps, position_01mm, balise)
            first = [np.asarray(value) for _, value in name_leaves(self._law.state)]
            self._kinds = [value.dtype for value in first]
            self._state = np.array([np.broadcast_to(value, trains) for value in first], dtype=kind).T.copy()
            return None, Notches(np.broadcast_to(outputs.notch, trains))
        wire = (k, speed_01mmps, position_01mm, *(balise if self.track else ()))
        given = np.empty((trains, len(wire)), dtype=kind)
        given[:, 0] = k
        for column, value in enumerate(wire[1:], 1):
            given[:, column] = self.arithmetic.from_raw(value, 0)
        left = np.zeros(trains, dtype=np.bool_)
        answer = self._step.run(self._state, self._inputs.run(self._state[:, :0], given, left), left)
        notch = answer[:, self._notch].copy()
        if left.any():
            self._by_the_law(np.flatnonzero(left), wire, notch)
        return None, Notches(notch)

    def _by_the_law(self, trains: NDArray[np.int64], wire: tuple[Any, ...], notch: NDArray[Any]) -> None:
        """A step of some trains by the law itself, with its counts."""
        state, law, counted = self._state, self._law, self.arithmetic.per_train
        assert state is not None
        columns = iter([state[trains, i].astype(kind) for i, kind in enumerate(self._kinds)])
        law.state = map_leaves(law.state, lambda name, old: next(columns))
        given = [value[trains] if np.ndim(value) else value for value in wire]
        if counted is not None:
            self.arithmetic.per_train = {kind: np.zeros(trains.size, dtype=np.int64) for kind in counted}
        _, outputs = law.step(*given[:3], *([BaliseReading(*given[3:])] if self.track else []))
        if counted is not None:
            for kind, counts in self.arithmetic.per_train.items():
                counted[kind][trains] += counts
            self.arithmetic.per_train = counted
        for i, (_, value) in enumerate(name_leaves(law.state)):
            state[trains, i] = value
        notch[trains] = outputs.notch


#: The laws made last: a campaign makes a loop for each of its chunks.
_KEPT = 8
_kept: list[tuple[Scenario, LawSpec, Callable[[], Any]]] = []


def loop_of(scenario: Scenario, law: LawSpec) -> Any:
    """The loop of a law on arrays: as machine code where possible.

    :raises InputError: as :class:`ControlLoop`.
    """
    for known in _kept:
        if known[1] == law and known[0] == scenario:
            return known[2]()
    programs = _programs(scenario, law)

    def loop() -> Any:
        alone: ControlLoop[Any] = ControlLoop(scenario, law, make(law.arithmetic, batch=True))
        return alone if programs is None else EmittedLoop(alone, *programs)

    _kept.insert(0, (scenario, law, loop))
    del _kept[_KEPT:]
    return loop()


def _programs(scenario: Scenario, law: LawSpec) -> tuple[tuple[EmittedProgram, EmittedProgram], int] | None:
    """Inputs and step of a law as machine code, and the place of its notch; None: it must be computed itself."""
    if law.arithmetic not in _FAMILIES or not is_shipped(load(law.controller)):
        return None
    one = make(law.arithmetic)
    program = record(scenario, law, wide=one.wide)
    inputs, step = None, None
    if not one.wide:
        ranges = analyse_law(program, ControlLoop(scenario, law, one).law.state_bounds(), WIRE)
        if ranges.may_wrap:
            return None
        inputs, step = ranges.inputs, ranges.step
    answers = [name for name, _ in program.step.outputs if not is_state(name)]
    try:
        programs = (
            EmittedProgram(program.inputs, law.controller, law.arithmetic, inputs),
            EmittedProgram(program.step, law.controller, law.arithmetic, step),
        )
    except KeyError:
        # An operation without a text.
        return None
    return programs, answers.index("out.notch")
