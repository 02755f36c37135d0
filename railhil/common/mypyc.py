"""``@mypyc_attr(allow_interpreted_subclasses=True)``: a class of the compiled build (setup.py) that others subclass.

Without it, mypyc lets no class of interpreted code have a compiled one as its base. Only mypyc reads it. A subclass
overrides methods and properties; an attribute it sets in ``__init__``, because compiled code does not see one of the
subclass's body.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from mypy_extensions import mypyc_attr
else:
    C = TypeVar("C", bound=type)

    def mypyc_attr(**attributes: bool) -> Callable[[C], C]:
        """The class is returned unchanged, so that railhil does not need mypy at run time."""
        del attributes
        return lambda marked: marked


__all__ = ["mypyc_attr"]
