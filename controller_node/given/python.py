"""A controller in Python: a function of the readings, or an object with ``step`` and perhaps ``reset``."""

from __future__ import annotations

import inspect
import re
import sys
import traceback
from collections import namedtuple
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any, ClassVar

from railhil.common import plug_ins
from railhil.common.errors import InputError, Words
from railhil.common.plug_ins import guard_plug_in
from railhil.controller_node.given.computing import (
    Computer,
    ComputingController,
    Terms,
    checked_answer,
)
from railhil.controller_node.given.worker import WorkerController

_SUFFIX = ".py"
_WORD = re.compile(r"[A-Za-z_]\w*")


class Called:
    """See :class:`~railhil.controller_node.given.computing.Computer`.

    :param code: a function of the readings, an object with ``step``, or a class of such objects that takes no
        arguments. ``reset`` is called first, where there is one.
    :param source: named in errors.
    :raises InputError: it is none of these, takes other arguments, or raises.
    """

    def __init__(self, code: Any, terms: Terms, source: str) -> None:
        self._source, self._terms = source, terms
        names = [one.name for one in terms.readings]
        kind: Any = namedtuple("Reading", names)  # type: ignore[misc]
        self._reading = kind
        kind.__doc__ = "\n".join(f"{one.name}: {one.unit or '-'}" for one in terms.readings)
        made = self._call(code, "start") if inspect.isclass(code) else code
        self._step: Callable[..., Any] = getattr(made, "step", made)
        if not callable(self._step):
            found = Words(f"a {type(made).__name__}")
            raise InputError(source, "", found, "a function of the reading, or an object with step")
        try:
            inspect.signature(self._step).bind(None)
        except TypeError as error:
            found = Words(f"{getattr(self._step, '__name__', 'step')}{inspect.signature(self._step)}")
            raise InputError(source, "", found, "one argument, the reading", str(error)) from None
        except ValueError:
            # A function of C has no signature: its first call tells.
            pass
        if hasattr(made, "reset"):
            self._call(made.reset, "reset")

    def compute(self, readings: Sequence[float]) -> Sequence[float]:
        answer = self._call(self._step, "step", self._reading(*readings))
        return checked_answer(self._source, self._terms, answer)

    def close(self) -> None:
        """Nothing is outside of this process."""

    def _call(self, function: Callable[..., Any], what: str, *arguments: Any) -> Any:
        try:
            with guard_plug_in():
                return function(*arguments)
        except Exception as error:
            # Code of the user may raise anything.
            raise _failure(self._source, what, error) from None


def _failure(source: str, what: str, error: Exception) -> InputError:
    """The line for an exception of the user's code: its last place in a file that is none of Python's or railhil's."""
    own = (__file__, plug_ins.__file__)
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename not in own and not frame.filename.startswith("<frozen ")
    ]
    at = f"{frames[-1].filename}:{frames[-1].lineno}" if frames else source
    if isinstance(error, SyntaxError) and error.filename:
        at = f"{error.filename}:{error.lineno}"
    cause = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return InputError(at, what, Words(f"it raises {cause}"), "an answer")


def _name(stem: str, called: str) -> str:
    return re.sub(r"[^A-Za-z0-9_+-]+", "_", f"{stem}-{called}")


def _origin(code: Any) -> Any:
    """The function or class that a function, object, method or partial call comes from."""
    while True:
        if isinstance(code, partial):
            code = code.func
        elif inspect.ismethod(code):
            code = code.__func__
        elif inspect.isfunction(code) and (inner := inspect.unwrap(code)) is not code:
            code = inner
        else:
            return code if inspect.isroutine(code) or inspect.isclass(code) else type(code)


class _SourceLoader(SourceFileLoader):
    """Compiles the text of the file: cached bytecode is that of another text of the same size and second."""

    def path_stats(self, path: str) -> Mapping[str, Any]:
        raise OSError


class PythonFile(WorkerController):
    """``FILE.py:NAME``, by file."""

    form: ClassVar[str] = "FILE.py:NAME"

    def __init__(self, text: str) -> None:
        super().__init__(text)
        file, _, self._attribute = text.rpartition(":")
        self._file = Path(file)
        if not _WORD.fullmatch(self._attribute):
            raise InputError(
                "command line", "--controller", text, f"{self.form}, with the name of a function or object"
            )
        self.name = _name(self._file.stem, self._attribute)
        self.arguments = [file, self._attribute]

    @classmethod
    def reads(cls, text: str) -> bool:
        return text.rpartition(":")[0].endswith(_SUFFIX)

    def files(self) -> tuple[Path, ...]:
        return (self._file,)

    @staticmethod
    def load(arguments: Sequence[str], terms: Terms) -> Computer:
        file, attribute = arguments
        path = Path(file)
        source = f"{file}:{attribute}"
        spec = spec_from_file_location(path.stem, path, loader=_SourceLoader(path.stem, str(path)))
        assert spec is not None
        assert spec.loader is not None
        # A script finds its neighbours; railhil is found where it is installed.
        sys.path.append(str(path.resolve().parent))
        module = module_from_spec(spec)
        sys.modules.setdefault(path.stem, module)
        try:
            with guard_plug_in():
                spec.loader.exec_module(module)
        except Exception as error:
            raise _failure(file, "import", error) from None
        if not hasattr(module, attribute):
            names = sorted(name for name, value in vars(module).items() if callable(value) and name[0] != "_")
            allowed = f"one of {', '.join(names)}" if names else "a function"
            raise InputError(file, "", Words(f"has no {attribute}"), allowed)
        return Called(getattr(module, attribute), terms, source)


class PythonObject(ComputingController):
    """A function or object of the calling program, in its process."""

    form: ClassVar[str] = "a function or object of Python"

    is_here_only: ClassVar[bool] = True

    def __init__(self, code: Any) -> None:
        self._code, self._origin = code, _origin(code)
        called = getattr(self._origin, "__name__", "controller")
        stem = next((path.stem for path in self.files()), "call")
        # No text of a command line.
        super().__init__(f"call:{called}")
        self.name = _name(stem, called)
        self.hashes()

    @classmethod
    def reads(cls, text: str) -> bool:
        return False

    def files(self) -> tuple[Path, ...]:
        """Its source file, where it has one that can still be read."""
        try:
            path = Path(inspect.getfile(self._origin))
        except (TypeError, OSError):
            return ()
        return (path,) if path.is_file() else ()

    def start(self, terms: Terms, patience_s: float) -> Computer:
        return Called(self._code, terms, self.name)
