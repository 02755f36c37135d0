"""The error message for a failing law: place in its source, last quantity, and the operation to use instead."""

from __future__ import annotations

import inspect
import traceback
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words

_ALLOWED = "operations of the arithmetic on operands, formats that agree, no branch on data"


def _folders(kind: type[Any]) -> set[Path]:
    """Folders of the source files of a law and its base classes."""
    found = set()
    for part in kind.__mro__:
        if hasattr(part, "step") and not inspect.isabstract(part):
            try:
                found.add(Path(inspect.getfile(part)).resolve().parent)
            except (OSError, TypeError):
                # Defined in a console, without a file: there is no location to name.
                continue
    return found


def find_source_line(kind: type[Any], error: BaseException) -> str:
    """Location in a law's source where an exception was raised, ``FILE:LINE``; empty if no line of it was involved."""
    folders = _folders(kind)
    at = ""
    for frame in traceback.extract_tb(error.__traceback__):
        if Path(frame.filename).resolve().parent in folders:
            at = f"{frame.filename}:{frame.lineno}"
    return at


def _beginning(kind: type[Any], function: str) -> str:
    """Beginning of a law's function, ``FILE:LINE``: the location reported for a wrong result."""
    code = getattr(getattr(kind, function, None), "__code__", None)
    return f"{code.co_filename}:{code.co_firstlineno}" if code is not None else kind.__qualname__


def describe_failure(name: str, kind: type[Any], error: Exception, function: str, quantity: str | None) -> InputError:
    """The one-line message for an exception raised by a law, or caused by its result.

    :param name: the name by which the law was requested.
    :param function: name of the law's function that was called.
    :param quantity: the last quantity that the law had named, None for none; empty: it is not known.
    """
    if isinstance(error, InputError):
        return error
    after = ", before its first quantity" if quantity is None else f", after quantity {quantity}" if quantity else ""
    cause = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    key = f"law {name}, {function}{after}"
    return InputError(
        find_source_line(kind, error) or _beginning(kind, function),
        key,
        Words("an operation that fails"),
        _ALLOWED,
        cause,
    )
