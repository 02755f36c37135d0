"""Puts a changed module in the place of the original: into one that is imported already, or before it is."""

from __future__ import annotations

import ast
import importlib.abc
import importlib.machinery
import importlib.util
import sys
from collections.abc import Iterator, Sequence
from types import CodeType, FunctionType, ModuleType
from typing import Any


def path_of(name: str) -> str:
    """Source file of a module, without importing it (its packages are)."""
    spec = importlib.util.find_spec(name)
    if spec is None or spec.origin is None or not spec.origin.endswith(".py"):
        raise ModuleNotFoundError(f"{name}: no module with a source file")
    return spec.origin


def functions_of(module: ModuleType) -> dict[tuple[str, int], FunctionType]:
    """The functions of a module and of its classes, by dotted name and first line."""
    found: dict[tuple[str, int], FunctionType] = {}

    def visit(names: dict[str, Any]) -> None:
        for value in list(names.values()):
            if isinstance(value, type) and value.__module__ == module.__name__:
                visit(dict(vars(value)))
                continue
            for part in (value, *(getattr(value, name, None) for name in ("fget", "__func__", "__wrapped__", "func"))):
                if isinstance(part, FunctionType) and part.__module__ == module.__name__:
                    found[part.__qualname__, part.__code__.co_firstlineno] = part

    visit(vars(module))
    return found


def _codes(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _codes(constant)


def replace_code(module: ModuleType, tree: ast.Module, scope: str = "") -> bool:
    """Give the functions of an imported module the code of a changed tree: everybody who imported one has the change.

    :param scope: only this function; empty: all.
    :returns: False if the function cannot be found, or none.
    """
    assert module.__file__ is not None
    functions = functions_of(module)
    replaced = 0
    for code in _codes(compile(tree, module.__file__, "exec")):
        function = functions.get((code.co_qualname, code.co_firstlineno))
        if function is None or scope not in ("", function.__qualname__):
            continue
        if len(function.__code__.co_freevars) == len(code.co_freevars):
            function.__code__ = code
            replaced += 1
    return replaced > 0


class _Loader(importlib.machinery.SourceFileLoader):
    """Loads a module from a changed tree."""

    def __init__(self, name: str, path: str, tree: ast.Module) -> None:
        super().__init__(name, path)
        self._tree = tree

    def get_code(self, fullname: str) -> CodeType:
        return compile(self._tree, self.path, "exec")


class _Finder(importlib.abc.MetaPathFinder):
    def __init__(self, name: str, path: str, tree: ast.Module) -> None:
        self._name, self._loader = name, _Loader(name, path, tree)

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        return importlib.util.spec_from_loader(fullname, self._loader) if fullname == self._name else None


def import_changed(name: str, path: str, tree: ast.Module) -> None:
    """From now on the module is imported from a changed tree. It must not have been imported."""
    if name in sys.modules:
        raise RuntimeError(f"{name} is imported already")
    sys.meta_path.insert(0, _Finder(name, path, tree))
