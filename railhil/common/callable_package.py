"""A package that is also a function of the library, such as ``railhil.run``."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inspect import Signature


class CallablePackage(ModuleType):
    """The class of a package that can be called: importing the package must not hide the function of its name.

    Signature and docstring are those of the function, for ``help``, notebooks and editors. The package defines
    ``_function``, which imports and returns the function.
    """

    _function: Callable[[], Callable[..., Any]]

    @property
    def function(self) -> Callable[..., Any]:
        """The function for which the package stands."""
        return self._function()

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return self._function()(*args, **kwargs)

    @property
    def __signature__(self) -> Signature:
        from inspect import signature

        return signature(self._function())

    @property
    def __doc__(self) -> str:  # type: ignore[override]
        """The docstring of the function; the call stands below its first line, because ``help`` shows a package."""
        from inspect import getdoc

        summary, _, rest = (getdoc(self._function()) or "").partition("\n")
        return f"{summary}\n\n{self.__name__}{self.__signature__}\n{rest}"
