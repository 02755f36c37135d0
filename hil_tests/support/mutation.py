"""A small mutation tester: one change at a time in a module's syntax tree, executed in memory.

A mutant that no check detects shows that a check is missing. Operators: comparison at and beyond its boundary, whole
numbers plus and minus one, ``and``/``or`` swapped, ``True``/``False`` swapped, ``not`` removed, statement left out.
"""

from __future__ import annotations

import ast
import copy
import inspect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from types import ModuleType

import pytest

_COMPARE: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
#: A changed node replaces the original at the same place.
Change = Callable[[ast.AST], ast.AST]


@dataclass(frozen=True, slots=True)
class Mutant:
    """One changed module: ``line`` and ``before`` -> ``after`` in source form, and the changed tree."""

    line: int
    before: str
    after: str
    tree: ast.Module

    @property
    def text(self) -> str:
        """``before -> after``, without the line number (which moves when the file is edited)."""
        return f"{self.before} -> {self.after}"


def _docstrings(tree: ast.Module) -> set[int]:
    """Ids of the statements that are docstrings: removing one changes nothing."""
    holders = (ast.Module, ast.ClassDef, ast.FunctionDef)
    return {
        id(node.body[0])
        for node in ast.walk(tree)
        if isinstance(node, holders) and node.body and isinstance(node.body[0], ast.Expr)
        if isinstance(node.body[0].value, ast.Constant)
    }


def _changes(node: ast.AST) -> Iterator[Change]:
    """Possible changes at one node."""
    if isinstance(node, ast.Compare):
        for place, operator in enumerate(node.ops):
            for other in _COMPARE[type(operator)]:

                def compare(item: ast.AST, place: int = place, other: type[ast.cmpop] = other) -> ast.AST:
                    assert isinstance(item, ast.Compare)
                    item.ops[place] = other()
                    return item

                yield compare
    elif isinstance(node, ast.BoolOp):
        yield lambda item: ast.BoolOp(ast.Or() if isinstance(item.op, ast.And) else ast.And(), item.values)  # type: ignore[attr-defined]
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield lambda item: item.operand  # type: ignore[attr-defined]
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield lambda item: ast.Constant(not item.value)  # type: ignore[attr-defined]
    elif isinstance(node, ast.Constant) and isinstance(node.value, int):
        yield lambda item: ast.Constant(item.value + 1)  # type: ignore[attr-defined]
        yield lambda item: ast.Constant(item.value - 1)  # type: ignore[attr-defined]
    elif isinstance(node, (ast.Expr, ast.Assign, ast.AugAssign)):
        yield lambda item: ast.Pass()


def _annotations(tree: ast.Module) -> set[int]:
    """Ids of all nodes inside type annotations and decorators, which have no effect at run time."""
    roots: list[ast.AST | None] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign):
            roots.append(node.annotation)
        elif isinstance(node, ast.FunctionDef):
            roots += [node.returns, *(item.annotation for item in ast.walk(node.args) if isinstance(item, ast.arg))]
            roots += node.decorator_list
        elif isinstance(node, ast.ClassDef):
            roots += node.decorator_list
    return {id(item) for root in roots if root is not None for item in ast.walk(root)}


class _Apply(ast.NodeTransformer):
    """Change one node of a tree."""

    def __init__(self, target: ast.AST, change: Change) -> None:
        self._target, self._change = target, change

    def visit(self, node: ast.AST) -> ast.AST:
        if node is self._target:
            return ast.copy_location(self._change(node), node)
        return self.generic_visit(node)


def mutants(source: str) -> Iterator[Mutant]:
    """Every mutant of a module's source, in the order of its syntax tree."""
    tree = ast.parse(source)
    inert = _annotations(tree) | _docstrings(tree)
    inside = {id(child) for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) for child in ast.walk(node)}
    for number, node in enumerate(ast.walk(tree)):
        if id(node) in inert or (isinstance(node, (ast.Expr, ast.Assign)) and id(node) not in inside):
            continue
        for change in _changes(node):
            changed = copy.deepcopy(tree)
            target = next(item for place, item in enumerate(ast.walk(changed)) if place == number)
            before = ast.unparse(target)
            mutated = ast.fix_missing_locations(_Apply(target, change).visit(changed))
            assert isinstance(mutated, ast.Module)
            line = getattr(node, "lineno", 0)
            after = next(ast.unparse(item) for place, item in enumerate(ast.walk(mutated)) if place == number)
            yield Mutant(line, before, after, mutated)


def load(mutant: Mutant, original: ModuleType) -> ModuleType:
    """Execute a mutant as a separate module; other modules still import the original."""
    module = ModuleType(original.__name__)
    module.__file__ = original.__file__
    exec(compile(mutant.tree, f"mutant of {original.__name__}", "exec"), module.__dict__)  # noqa: S102
    return module


def survivors(original: ModuleType, checks: Sequence[Callable[[ModuleType], None]]) -> tuple[int, list[Mutant]]:
    """Number of mutants of a module, and those that no check detects."""
    alive = []
    count = 0
    for mutant in mutants(inspect.getsource(original)):
        count += 1
        try:
            module = load(mutant, original)
            for check in checks:
                check(module)
        except (Exception, pytest.fail.Exception):
            # Detected: by a failed check, or because the module does not even load.
            continue
        alive.append(mutant)
    return count, alive
