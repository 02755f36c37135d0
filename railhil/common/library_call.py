"""Calls of the library: arguments of the wrong kind, and errors in the words of the call."""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from railhil.common.errors import InputError, InputErrors, Words

A = ParamSpec("A")
R = TypeVar("R")
#: Source of errors about an option of a command.
_COMMAND_LINE = "command line"
_OPTION = re.compile(r"--[a-z][a-z-]*")


@dataclass(frozen=True, slots=True)
class Kind:
    """The values that an argument takes; ``words`` describe them."""

    words: str
    accepts: Callable[[Any], bool]


def is_path(value: Any) -> bool:
    """Whether it is a path, or a text that can be one."""
    return isinstance(value, str | os.PathLike)


def are_texts(value: Any) -> bool:
    """Whether it is one text or several."""
    return isinstance(value, str) or (isinstance(value, Sequence) and all(isinstance(one, str) for one in value))


def are_paths(value: Any) -> bool:
    """Whether it is one path or several."""
    return is_path(value) or (isinstance(value, Sequence) and all(map(is_path, value)))


PATH = Kind("a text or a path", is_path)
PATH_OR_NONE = Kind("a text, a path or None", lambda value: value is None or is_path(value))
TEXT = Kind("a text", lambda value: isinstance(value, str))
SETTINGS = Kind(
    "a mapping, a text KEY=VALUE or a list of such texts", lambda value: isinstance(value, Mapping) or are_texts(value)
)
TEXTS = Kind("a text or a list of texts", are_texts)
FILES = Kind("a file, a name or a list of them", are_paths)
#: Processes; -1: one for each processor.
JOBS = Kind("a whole number from 1, or -1", lambda value: type(value) is int and (value >= 1 or value == -1))


def library_call(
    call: str, kinds: Mapping[str, Kind], others: Mapping[str, str] | None = None
) -> Callable[[Callable[A, R]], Callable[A, R]]:
    """A decorator: the function refuses arguments of another kind, and its errors name it and its arguments where they
    would name the command line and options.

    :param call: name of the function in errors.
    :param kinds: by argument; those that are checked elsewhere are left out.
    :param others: argument by its option or key of another name.
    """

    def decorate(function: Callable[A, R]) -> Callable[A, R]:
        signature = inspect.signature(function)
        names = {f"--{name.replace('_', '-')}": name for name in signature.parameters} | dict(others or {})

        @wraps(function)
        def called(*args: A.args, **kwargs: A.kwargs) -> R:
            given = signature.bind(*args, **kwargs).arguments
            for name, kind in kinds.items():
                if name in given and not kind.accepts(given[name]):
                    raise InputError(call, name, given[name], kind.words)
            try:
                return function(*args, **kwargs)
            except InputError as error:
                raise _in_words_of(error, call, names) from None

        return called

    return decorate


def _in_words_of(error: InputError, call: str, names: Mapping[str, str]) -> InputError:
    """The error with the call as its source, if the user's words are its source, and arguments instead of options."""
    if isinstance(error, InputErrors):
        return InputErrors([_in_words_of(one, call, names) for one in error.errors])

    def said(text: str) -> str:
        return _OPTION.sub(lambda option: names.get(option[0], option[0]), text)

    file, key = error.file, error.key
    if file in names:
        file, key = call, f"{names[file]}: {key}" if key else names[file]
    elif file in (_COMMAND_LINE, call):
        file, key = call, names.get(key, said(key))
    found = Words(said(str(error.found))) if isinstance(error.found, Words) else error.found
    allowed = type(error.allowed)(said(error.allowed))
    hint = None if error.hint is None else said(error.hint)
    if (file, key, allowed, hint, str(found)) == (error.file, error.key, error.allowed, error.hint, str(error.found)):
        return error
    return InputError(file, key, found, allowed, hint)
