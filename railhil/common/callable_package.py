"""A package that is also a function of the library, such as ``railhil.run``."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inspect import Signature


class CallablePackage(ModuleType):
    """The class of a package that can be called: importing the package must not hide the function of its name.

    Signature and docstring are those of the function, for ``help``, notebooks and editors.
    """

    _function: str

    @property
    def function(self) -> Callable[..., Any]:
        """The function for which the package stands, imported at its first use."""
        module, _, name = self._function.partition(":")
        found: Callable[..., Any] = getattr(import_module(module), name)
        return found

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return self.function(*args, **kwargs)

    @property
    def __signature__(self) -> Signature:
        from inspect import signature

        return signature(self.function)

    @property
    def __doc__(self) -> str:  # type: ignore[override]
        """The docstring of the function; the call stands below its first line, because ``help`` shows a package."""
        from inspect import getdoc

        summary, _, rest = (getdoc(self.function) or "").partition("\n")
        return f"{summary}\n\n{self.__name__}{self.__signature__}\n{rest}"


def stand_for(package: str, function: str) -> None:
    """Make an imported package callable.

    :param function: ``module:name``.
    """
    made = sys.modules[package]
    made.__class__ = CallablePackage
    assert isinstance(made, CallablePackage)
    made._function = function
