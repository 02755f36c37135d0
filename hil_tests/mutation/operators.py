"""The changes: at each node of a module's syntax tree, one at a time.

Comparison at and beyond its boundary, whole numbers plus and minus one, floating-point numbers plus 0.5 and times 1.01,
``and``/``or``, ``True``/``False`` and ``+``/``-`` (``*``/``/``, ``<<``/``>>``, ...) swapped, ``min``/``max`` (and their
relatives) swapped, ``not`` and minus removed, a condition negated, a statement left out, a constant returned.
"""

from __future__ import annotations

import ast
import copy
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import isfinite

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
_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.FloorDiv,
    ast.Pow: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
    ast.BitXor: ast.BitOr,
}
_PAIRS = (("min", "max"), ("minimum", "maximum"), ("smaller", "larger"), ("floor", "ceil"), ("any", "all"))
_CALLS = {one: other for a, b in _PAIRS for one, other in ((a, b), (b, a))}
#: Constants to return, by the annotation of the function's result; anything else: None.
_RETURNED: dict[str, tuple[object, ...]] = {"bool": (True, False), "int": (0,), "float": (0.0,), "str": ("",)}

#: A changed node replaces the original at the same place.
Change = Callable[[ast.AST], ast.AST]


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of a module: the statement ``before`` at ``line`` becomes ``after``, both in source form without their
    bodies, inside the function ``scope`` (dotted; empty at the level of the module). ``in_body``: inside the body of a
    function, hence of no effect at import; ``lines``: of the statement, without those of a body.
    """

    scope: str
    in_body: bool
    line: int
    lines: range
    before: str
    after: str
    _source: str
    _number: int
    _change: Change

    @property
    def key(self) -> str:
        """Function and changed statement: what stays when the file is laid out anew, or gets other lines."""
        return f"{self.scope}: {self.after}" if self.scope else self.after

    def tree(self) -> ast.Module:
        """The changed module."""
        tree = ast.parse(self._source)
        target = next(node for place, node in enumerate(ast.walk(tree)) if place == self._number)
        changed = ast.fix_missing_locations(_Apply(target, self._change).visit(tree))
        assert isinstance(changed, ast.Module)
        return changed


class _Apply(ast.NodeTransformer):
    """Change one node of a tree."""

    def __init__(self, target: ast.AST, change: Change) -> None:
        self._target, self._change = target, change

    def visit(self, node: ast.AST) -> ast.AST:
        if node is self._target:
            return ast.copy_location(self._change(node), node)
        return self.generic_visit(node)


def _changes(node: ast.AST, returns: str) -> Iterator[Change]:
    """Possible changes at one node, in a function with this annotation of its result."""
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
    elif isinstance(node, (ast.BinOp, ast.AugAssign)):
        swapped = _ARITHMETIC[type(node.op)]

        def arithmetic(item: ast.AST) -> ast.AST:
            item.op = swapped()  # type: ignore[attr-defined]
            return item

        yield arithmetic
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.Not, ast.USub)):
        if isinstance(node.op, ast.Not) or not isinstance(node.operand, ast.Constant):
            yield lambda item: item.operand  # type: ignore[attr-defined]
    elif isinstance(node, ast.Constant):
        for value in _other_values(node.value):
            yield lambda item, value=value: ast.Constant(value)  # type: ignore[misc]
    elif isinstance(node, ast.Call):
        name = getattr(node.func, "id", getattr(node.func, "attr", ""))
        if name in _CALLS:

            def call(item: ast.AST, other: str = _CALLS[name]) -> ast.AST:
                function = item.func  # type: ignore[attr-defined]
                setattr(function, "id" if isinstance(function, ast.Name) else "attr", other)
                return item

            yield call
    elif isinstance(node, ast.Return) and node.value is not None:
        for value in _RETURNED.get(returns, (None,)):
            if not (isinstance(node.value, ast.Constant) and node.value.value == value):
                yield lambda item, value=value: ast.Return(ast.Constant(value))  # type: ignore[misc]
    if isinstance(node, (ast.If, ast.IfExp, ast.While)) and isinstance(
        node.test, (ast.Name, ast.Attribute, ast.Call, ast.NamedExpr, ast.Subscript)
    ):

        def negate(item: ast.AST) -> ast.AST:
            item.test = ast.UnaryOp(ast.Not(), item.test)  # type: ignore[attr-defined]
            return item

        yield negate
    if isinstance(node, (ast.Expr, ast.Assign, ast.AugAssign, ast.Raise)):
        yield lambda item: ast.Pass()


def _other_values(value: object) -> tuple[object, ...]:
    if isinstance(value, bool):
        return (not value,)
    if isinstance(value, int):
        return value + 1, value - 1
    if isinstance(value, float) and isfinite(value):
        return (value + 0.5, value * 1.01) if value else (0.5,)
    return ()


def _inert(tree: ast.Module) -> set[int]:
    """Ids of the nodes without effect: type annotations, decorators, docstrings, what is for the type checker only."""
    roots: list[ast.AST | None] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign):
            roots.append(node.annotation)
        elif isinstance(node, ast.FunctionDef):
            roots += [node.returns, *(item.annotation for item in ast.walk(node.args) if isinstance(item, ast.arg))]
            roots += node.decorator_list
            if any(getattr(decorator, "id", "") == "overload" for decorator in node.decorator_list):
                roots.append(node)
        elif isinstance(node, ast.ClassDef):
            roots += node.decorator_list
        elif (
            (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
            or (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING")
            or (isinstance(node, ast.Assign) and ast.unparse(node.value).startswith("TypeVar("))
        ):
            roots.append(node)
    return {id(item) for root in roots if root is not None for item in ast.walk(root)}


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a node stands: the dotted name of its outermost function, the result of its innermost, its statement."""

    scope: str = ""
    returns: str = ""
    in_body: bool = False
    statement: ast.stmt | None = None

    @property
    def lines(self) -> range:
        """Lines of the statement, without those of a body."""
        if (node := self.statement) is None:
            return range(0)
        body = getattr(node, "body", None)
        end = body[0].lineno if body else (node.end_lineno or node.lineno) + 1
        return range(node.lineno, max(end, node.lineno + 1))


def _places(tree: ast.Module) -> dict[int, _Place]:
    found: dict[int, _Place] = {}

    def visit(node: ast.AST, place: _Place, classes: tuple[str, ...]) -> None:
        if isinstance(node, ast.stmt):
            place = replace(place, statement=node)
        found[id(node)] = place
        for field, value in ast.iter_fields(node):
            for child in value if isinstance(value, list) else [value]:
                if not isinstance(child, ast.AST):
                    continue
                if isinstance(node, ast.FunctionDef) and field == "body":
                    scope = place.scope if place.in_body else ".".join((*classes, node.name))
                    visit(child, _Place(scope, ast.unparse(node.returns) if node.returns else "", True), classes)
                elif isinstance(node, ast.ClassDef) and field == "body":
                    visit(child, place, (*classes, node.name))
                else:
                    visit(child, place, classes)

    visit(tree, _Place(), ())
    return found


def mutants(source: str) -> Iterator[Mutant]:
    """Every mutant of a module's source, in the order of its syntax tree. Texts are left as they are."""
    tree = ast.parse(source)
    inert, places = _inert(tree), _places(tree)
    times: Counter[str] = Counter()
    for number, node in enumerate(ast.walk(tree)):
        place = places[id(node)]
        if id(node) in inert or (isinstance(node, (ast.Expr, ast.Assign)) and not place.in_body):
            # Without its statements outside functions a module cannot even be imported.
            continue
        for change in _changes(node, place.returns):
            assert place.statement is not None
            before, after = _texts(place.statement, node, change)
            line = getattr(node, "lineno", 0)
            mutant = Mutant(place.scope, place.in_body, line, place.lines, before, after, source, number, change)
            times[mutant.key] += 1
            if times[mutant.key] > 1:
                mutant = replace(mutant, after=f"{after} (no. {times[mutant.key]})")
            yield mutant


def _texts(statement: ast.stmt, node: ast.AST, change: Change) -> tuple[str, str]:
    """A statement without its body in source form, before and after the change of one of its nodes."""
    head = copy.copy(statement)
    if hasattr(head, "body"):
        head.body = []
    for field in ("orelse", "handlers", "finalbody"):
        if hasattr(head, field):
            setattr(head, field, [])
    place = next(place for place, item in enumerate(ast.walk(head)) if item is (head if node is statement else node))
    changed = copy.deepcopy(head)
    target = next(item for number, item in enumerate(ast.walk(changed)) if number == place)
    before = ast.unparse(head)
    changed = ast.fix_missing_locations(_Apply(target, change).visit(changed))
    after = ast.unparse(changed)
    return before, f"without {before}" if isinstance(changed, ast.Pass) else after
