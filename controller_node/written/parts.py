"""What a written-out law is bound to, and the types of its functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

#: Operands in the order of a program's inputs, outputs or quantities.
Values: TypeAlias = tuple[Any, ...]
#: State and inputs -> new state, other outputs, quantities; None: the law itself has to compute this step.
Step: TypeAlias = Callable[[Values, Values], tuple[Values, Values, Values] | None]


class Parts(NamedTuple):
    """The numbers of one law, in the order of their first use.

    ``number``: an arithmetic for the operations that are called; its counters show whether something happened in them.
    ``bounds``: smallest and largest raw value of each checked input, for which nothing wraps.
    """

    number: Any
    constants: Values
    tables: Values
    curves: Values
    lasts: Values
    bounds: Values
