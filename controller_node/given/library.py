"""A controller in a shared library with the C interface of a folder's ``NAME.h``: ``FILE.so`` or ``FILE.so:PREFIX``.

It is loaded in the worker process only, and only for a run that the command line asks for.
"""

from __future__ import annotations

import ctypes
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from railhil.common.errors import InputError, Words
from railhil.controller_node.given.computing import Computer, Terms, checked_answer
from railhil.controller_node.given.worker import WorkerController

_FORM = re.compile(r"(?P<file>.*\.so)(?::(?P<prefix>[A-Za-z_]\w*))?")


class Loaded:
    """See :class:`~railhil.controller_node.given.computing.Computer`.

    :param file: of the library.
    :param prefix: first word of its functions.
    :raises InputError: it cannot be loaded, lacks ``PREFIX_step`` or ``PREFIX_interface``, or is made for other
        readings and commands.
    """

    def __init__(self, file: str, prefix: str, terms: Terms) -> None:
        self._source, self._terms = file, terms
        try:
            library = ctypes.CDLL(str(Path(file).resolve()))
        except OSError as error:
            raise InputError(file, "", Words(f"cannot be loaded: {error}"), "a shared library for this host") from None
        try:
            self._step = getattr(library, f"{prefix}_step")
            interface = ctypes.c_char * (len(terms.interface) + 1)
            found = interface.in_dll(library, f"{prefix}_interface").value.decode("ascii", "replace")
        except (AttributeError, ValueError) as error:
            missing = str(error).rpartition("undefined symbol: ")[2]
            allowed = (
                f"{prefix}_step and {prefix}_interface, as make lib makes them (FILE.so:PREFIX names another prefix)"
            )
            raise InputError(file, "", Words(f"has no {missing}"), allowed) from None
        if found != terms.interface:
            raise InputError(file, f"{prefix}_interface", found, terms.interface)
        self._step.restype = None
        self._readings = (ctypes.c_float * len(terms.readings))()
        self._commands = (ctypes.c_float * len(terms.commands))()
        reset = getattr(library, f"{prefix}_reset", None)
        if reset is not None:
            reset.restype = None
            reset()

    def compute(self, readings: Sequence[float]) -> Sequence[float]:
        self._readings[:] = [*readings]
        self._commands[:] = [math.nan] * len(self._commands)
        self._step(self._readings, self._commands)
        return checked_answer(self._source, self._terms, list(self._commands))

    def close(self) -> None:
        """Nothing is outside of this process."""


class SharedLibrary(WorkerController):
    """``FILE.so``, by file."""

    form: ClassVar[str] = "FILE.so[:PREFIX]"
    arithmetic = "float32"

    def __init__(self, text: str) -> None:
        super().__init__(text)
        found = _FORM.fullmatch(text)
        assert found is not None
        self._file = Path(found["file"])
        prefix = found["prefix"] or re.sub(r"\W", "_", self._file.stem.removeprefix("lib"))
        self.name = prefix
        self.arguments = [str(self._file), prefix]

    @classmethod
    def reads(cls, text: str) -> bool:
        return _FORM.fullmatch(text) is not None

    def files(self) -> tuple[Path, ...]:
        return (self._file,)

    @staticmethod
    def load(arguments: Sequence[str], terms: Terms) -> Computer:
        file, prefix = arguments
        return Loaded(file, prefix, terms)
