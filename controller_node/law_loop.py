"""A law on one arithmetic, with its state from one control period to the next: the base of the systems' loops."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Generic

from railhil.common.errors import InputError, Words
from railhil.common.mypyc import mypyc_attr
from railhil.common.plug_ins import guard_plug_in
from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.compiled_law import CompiledLaw, Values
from railhil.controller_node.laws.failure import find_source_line
from railhil.controller_node.laws.memory import kept, memory_arguments
from railhil.controller_node.laws.parameters import law_parameters
from railhil.controller_node.program.model import map_leaves, name_leaves
from railhil.controller_node.program.tracer import Tracer
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec


@contextmanager
def starting(law: str, kind: type[Any], made_for: str) -> Iterator[None]:
    """Turn any exception raised while a law is made into one line about the law."""
    try:
        with guard_plug_in():
            yield
    except InputError:
        raise
    except Exception as error:
        # A law is code that somebody plugs in, and may raise anything.
        at = find_source_line(kind, error)
        cause = f"{type(error).__name__}: {error}{f', at {at}' if at else ''}"
        found, allowed = Words("a law that fails at its start"), f"a law that can be made for {made_for}"
        raise InputError("controller", law, found, allowed, cause) from error


def refuse_solver(law: str, kind: type[Any], arithmetic: Arithmetic[Any]) -> None:
    """Refuse a law that is computed by a solver in an arithmetic without one.

    :raises InputError: it is such a law.
    """
    if kind.solver and not arithmetic.solves:
        allowed = "float64: this law is computed by a solver, which has no fixed point, single precision or C"
        raise InputError("controller", f"{law}, arithmetic", arithmetic.name, allowed)


@mypyc_attr(allow_interpreted_subclasses=True)
class LawLoop(ABC, Generic[T]):
    """Law and state on one arithmetic; the state is computed by the law or by its compiled functions.

    :param kind: class of the law.
    :param made_for: the operating point, for errors: "0.5 s and 7 notches".
    :param arithmetic: a fresh one; the one named by ``law`` is ignored.
    :raises InputError: a law that cannot be made for this scenario or has no program in this arithmetic, parameters or
        a memory of another law.
    """

    def __init__(
        self, scenario: AnyScenario, law: LawSpec, arithmetic: Arithmetic[T], kind: type[Any], made_for: str
    ) -> None:
        #: Name by which the law was requested.
        self.name = name = law.controller
        self.arithmetic = arithmetic
        self.made_for = made_for
        self._scenario = scenario
        self._memory = law.memory
        refuse_solver(name, kind, arithmetic)
        if kind.floating and not arithmetic.wide:
            allowed = "float64 or float32: this law has no fixed-point formats"
            raise InputError("controller", f"{name}, arithmetic", Words("fixed point"), allowed)
        parameters = law_parameters(name, kind, law.parameters)
        with starting(name, kind, made_for):
            remembered = memory_arguments(name, kind, scenario, law.memory)
            #: A :class:`railhil.controller_node.laws.base.ControlLaw`.
            self.law: Any = kind(arithmetic, scenario, parameters, *remembered)
        self._state: Any = None
        # Leaves of the state after a compiled step, which is newer than the state above.
        self._leaves: Values | None = None
        #: The compiled functions of the law, used where they are given.
        self.compiled: CompiledLaw | None = None

    @property
    def state(self) -> Any:
        """State of the law; None before the first step."""
        if self._leaves is not None:
            following = iter(self._leaves)
            self._state = map_leaves(self._state, lambda name, old: next(following))
            self._leaves = None
        return self._state

    @state.setter
    def state(self, state: Any) -> None:
        self._state, self._leaves = state, None

    def step_compiled(self, wire: Values) -> tuple[Values, Values] | None:
        """One control period without the law, from its wire values as operands: leaves of inputs and of outputs.

        None in the first period and where only the law can compute it; nothing has changed then.
        """
        if self.compiled is None or self._state is None:
            return None
        before = self._leaves
        if before is None:
            before = tuple([value for _, value in name_leaves(self._state)])
        done = self.compiled.step(before, wire)
        if done is None:
            return None
        inputs, self._leaves, outputs, noted = done
        if self.arithmetic.noted is not None:
            self.arithmetic.noted += noted
        return inputs, outputs

    def compute_answer(self, state: Any, inputs: Any) -> tuple[Any, Any]:
        """The law's step as it is recorded: state and inputs -> state and outputs."""
        after, outputs = self.law.step(state, inputs)
        return after, outputs

    @abstractmethod
    def trace_inputs(self, tracer: Tracer) -> Any:
        """The law's inputs, from the wire values as inputs of the tracer to which it is bound."""

    @abstractmethod
    def trace_commands(self, tracer: Tracer) -> Any:
        """The commands really sent, as inputs of the tracer."""

    def kept(self) -> dict[str, Any] | None:
        """The memory that the law wants to keep of the run, see :func:`railhil.controller_node.laws.memory.kept`."""
        return kept(self.name, self.law, self._scenario, self.state, self._memory)
