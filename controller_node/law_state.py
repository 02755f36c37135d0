"""State of a law from one control period to the next, computed by the law or by its compiled functions."""

from __future__ import annotations

from typing import Any, Generic

from railhil.common.mypyc import mypyc_attr
from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.compiled_law import CompiledLaw, Values
from railhil.controller_node.program.leaves import leaves, like


@mypyc_attr(allow_interpreted_subclasses=True)
class LawState(Generic[T]):
    """Base of the loops: a law's state on one arithmetic."""

    def __init__(self, arithmetic: Arithmetic[T]) -> None:
        self.arithmetic = arithmetic
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
            self._state = like(self._state, lambda name, old: next(following))
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
            before = tuple([value for _, value in leaves(self._state)])
        done = self.compiled.step(before, wire)
        if done is None:
            return None
        inputs, self._leaves, outputs, noted = done
        if self.arithmetic.noted is not None:
            self.arithmetic.noted += noted
        return inputs, outputs
