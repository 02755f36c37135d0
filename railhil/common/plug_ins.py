"""Entry points of a group: the laws and systems that plug in, and those that come with railhil."""

from __future__ import annotations

import importlib.metadata
import pkgutil
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from railhil.common.exit_codes import Signalled

#: The systems that come with railhil.
SYSTEMS = {
    "ato": "railhil.systems.ato:ATO",
    "emu3": "railhil.systems.high_speed:EMU3",
    "hst1": "railhil.systems.high_speed:HST1",
    "line": "railhil.systems.line:LINE",
    "stop": "railhil.systems.stop:STOP",
}
#: The kinds of controllers that a user brings (:mod:`railhil.scenarios.given`).
CONTROLLERS = {
    "python": "railhil.controller_node.given.python:PythonFile",
    "folder": "railhil.controller_node.c_controller.folder:ControllerFolder",
    "qemu": "railhil.controller_node.boards.given:EmulatedController",
    "library": "railhil.controller_node.given.library:SharedLibrary",
    "fmu": "railhil.controller_node.fmu:FmuController",
}
#: Packages with the laws that come with railhil, by their group. A module there is a law: a class, the module's name
#: in capitals (``mm_gpc``: ``MmGpc``). A package may have ``ORDER``, the order of its laws in every list.
SHIPPED = {
    "railhil.laws": "railhil.controller_node.ato.laws",
    "railhil.laws_high_speed": "railhil.controller_node.high_speed.laws",
    "railhil.laws_stop": "railhil.controller_node.stop.laws",
}


#: Entry points that come with railhil one by one, by their group.
_NAMED = {"railhil.systems": SYSTEMS, "railhil.controllers": CONTROLLERS}

#: Modules that systems of earlier versions of ``railhil new system`` import and that have another name now.
RENAMED = {"railhil.record.status": "railhil.record.notes"}


class EndsInterpreter(Exception):
    """Plug-in code has called ``sys.exit``."""


@contextmanager
def guard_plug_in() -> Iterator[None]:
    """Turn a ``sys.exit`` of plug-in code, while it is imported or begins, into an error: otherwise a command would end
    with its exit code and without a message.

    :raises EndsInterpreter: it called it. (``os._exit`` ends the process at once, which nobody can prevent.)
    """
    try:
        yield
    except SystemExit as end:
        if isinstance(end, Signalled):
            raise
        raise EndsInterpreter(
            f"it ends the interpreter, sys.exit({'' if end.code is None else repr(end.code)})"
        ) from end


def cause_of(error: Exception) -> str:
    """Message of an exception of plug-in code; for an import of a module that railhil does not have, also where it has
    one of that name, and where to read what has moved."""
    said = f"{type(error).__name__}: {error}"
    name = error.name if isinstance(error, ModuleNotFoundError) else None
    if name is None or name.count(".") < 2 or name.partition(".")[0] != __name__.partition(".")[0]:
        return said
    if name in RENAMED:
        return f"{said}; import it from {RENAMED[name]}, its name now"
    found = _places(".".join(name.split(".")[:2]), name) or _places("railhil.systems", name)
    same = f"railhil has {' and '.join(sorted(found))}; " if found else ""
    return f"{said}; {same}CHANGELOG.md says what has moved"


def _places(room: str, name: str) -> set[str]:
    """The modules of a room that have the last name of a module."""
    package = find_spec(room)
    folders = package.submodule_search_locations if package is not None else None
    return {
        ".".join((room, *path.relative_to(folder).with_suffix("").parts))
        for folder in folders or ()
        for path in Path(folder).rglob(f"{name.rpartition('.')[2]}.py")
    }


def entries(group: str) -> Mapping[str, importlib.metadata.EntryPoint]:
    """Entry points of a group by name.

    All are looked up once for each ``sys.path``: the lookup reads the metadata of every installed distribution.
    """
    return _entries(group, tuple(sys.path))


@cache
def _entries(group: str, path: tuple[str, ...]) -> Mapping[str, importlib.metadata.EntryPoint]:
    return {entry.name: entry for entry in (*_every(path).select(group=group), *_shipped(group))}


def _shipped(group: str) -> Iterator[importlib.metadata.EntryPoint]:
    for name, reference in _NAMED.get(group, {}).items():
        yield importlib.metadata.EntryPoint(name, reference, group)
    if group in SHIPPED:
        package = find_spec(SHIPPED[group])
        assert package is not None
        for module in pkgutil.iter_modules(package.submodule_search_locations):
            law = "".join(word.capitalize() for word in module.name.split("_"))
            yield importlib.metadata.EntryPoint(module.name, f"{package.name}.{module.name}:{law}", group)


@cache
def _every(path: tuple[str, ...]) -> Any:
    # EntryPoints, or the class with the same select() in Python 3.11.
    return importlib.metadata.entry_points()


@cache
def shipped_order() -> tuple[str, ...]:
    """The laws of railhil that have a place in every table, legend and list, in this order."""
    return tuple(law for package in SHIPPED.values() for law in getattr(import_module(package), "ORDER", ()))


def sort_laws(names: Iterable[str]) -> list[str]:
    """The names, each once: those of :func:`shipped_order` in that order, then the others sorted."""
    found, order = set(names), shipped_order()
    return [name for name in order if name in found] + sorted(found.difference(order))
