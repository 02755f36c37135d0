"""Constant table of a law as data: computed offline, checked into the package, loaded without linear algebra.

A law keeps its constants in a frozen dataclass. A field, with :func:`held` as its metadata, is a ``Constant``, a tuple
of them or a tuple of such tuples. A constant is named after its position: ``deviation_max``, ``free[3]``,
``model[0][2]``. The file has one row per constant, header lines with the operating point for which it was computed, and
a check sum::

    # law: ipfc
    ...
    name,q,raw,value,rounding_error,relative_error,origin
    model[0][0],24,16713986,0.9962312002717226,-1.9608705770224333e-09,1.968e-09,eq. (16)
"""

from __future__ import annotations

import csv
import hashlib
import io
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import groupby
from pathlib import Path
from typing import Any, Generic, TypeVar

from railhil.common.errors import InputError, Words
from railhil.common.user_files import refuse_unreadable
from railhil.controller_node.arithmetic.base import Constant

FOLDER = Path(__file__).parents[1] / "ato" / "tables"
COLUMNS = ("name", "q", "raw", "value", "rounding_error", "relative_error", "origin")
#: A constant with a larger relative rounding error is reported.
COARSE = 1e-4

_TITLE = "# Constants of a control law, written by python -m railhil.controller_node.ato.generate, not by hand."
_HINT = "python -m railhil.controller_node.ato.generate writes it anew"
_NAME = re.compile(r"(\w+)((?:\[\d+\])*)")

Table = TypeVar("Table")


def held(q: int, origin: str) -> dict[str, Any]:
    """Metadata of a table's field: the format of its constants and the origin of their values."""
    return {"q": q, "origin": origin}


def _named(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, Constant | float | int):
        yield name, value
        return
    for i, item in enumerate(value):
        yield from _named(f"{name}[{i}]", item)


def flatten(table: Any) -> tuple[Constant, ...]:
    """All constants of a table, in the order of its fields."""
    return tuple(c for item in fields(table) for _, c in _named(item.name, getattr(table, item.name)))


def build(kind: type[Table], values: Mapping[str, Any]) -> Table:
    """A table from plain numbers: for each field a number, or nested sequences of numbers.

    Raises ``ValueError`` when a number does not fit the format of its field.
    """

    def constants(name: str, value: Any, q: int, origin: str) -> Any:
        if isinstance(value, float | int):
            return Constant(name, float(value), q, origin)
        return tuple(constants(f"{name}[{i}]", item, q, origin) for i, item in enumerate(value))

    items = fields(kind)  # type: ignore[arg-type]
    return kind(**{item.name: constants(item.name, values[item.name], **item.metadata) for item in items})


def rebuild(kind: type[Table], constants: Sequence[Constant]) -> Table:
    """The table from which :func:`flatten` made these constants, by their names.

    Raises ``ValueError`` (name, then the fault) for a name without a field, a field without a constant, and a name that
    does not match its position.
    """
    declared = [item.name for item in fields(kind)]  # type: ignore[arg-type]
    found: dict[str, Any] = {}
    for name, group in groupby(constants, lambda constant: constant.name.partition("[")[0]):
        if name not in declared or name in found:
            raise ValueError(name, "a second time" if name in found else "no constant of this law")
        leaves = list(group)
        found[name] = _nested([(_indices(leaf.name), leaf) for leaf in leaves])
        for (expected, _), leaf in zip(_named(name, found[name]), leaves, strict=True):
            if leaf.name != expected:
                raise ValueError(expected, leaf.name)
    for name in declared:
        if name not in found:
            raise ValueError(name, "missing")
    return kind(**found)


def _indices(name: str) -> tuple[int, ...]:
    match = _NAME.fullmatch(name)
    if match is None:
        raise ValueError(name, "no name of a constant")
    return tuple(int(index) for index in re.findall(r"\d+", match[2]))


def _nested(leaves: list[tuple[tuple[int, ...], Constant]]) -> Any:
    if len(leaves) == 1 and not leaves[0][0]:
        return leaves[0][1]
    if not all(indices for indices, _ in leaves):
        raise ValueError(leaves[0][1].name, "a number and a row of the same name")
    groups = groupby(leaves, lambda leaf: leaf[0][0])
    return tuple(_nested([(indices[1:], constant) for indices, constant in group]) for _, group in groups)


def coarse(constants: Iterable[Constant], limit: float = COARSE) -> tuple[Constant, ...]:
    """Constants with a relative rounding error above ``limit``."""
    return tuple(constant for constant in constants if constant.relative_error > limit)


def _row(constant: Constant) -> list[str]:
    return [
        constant.name,
        str(constant.q),
        str(constant.raw),
        repr(constant.value),
        repr(constant.rounding_error),
        f"{constant.relative_error:.3e}",
        constant.origin,
    ]


@dataclass(frozen=True)
class LawTable(Generic[Table]):
    """The checked-in table of one law: its operating point, and the function that computes a table for any other."""

    law: str
    kind: type[Table]
    #: Parameters of the law (a frozen dataclass), control period in s, largest notch.
    parameters: Any
    control_period_s: float
    notch_max: float
    compute: Callable[[Any, float, float], Table]
    folder: Path = FOLDER

    @property
    def path(self) -> Path:
        """Path of the table's file."""
        return self.folder / f"{self.law}.csv"

    def make(self, parameters: Any, control_period_s: float, notch_max: float) -> Table:
        """The table at an operating point: from the file at its own, else computed.

        Raises :class:`~railhil.common.errors.InputError` (one line) when the file differs from the generator's output
        for this law, and the exceptions of ``compute``.
        """
        own = (self.parameters, self.control_period_s, self.notch_max)
        if (parameters, control_period_s, notch_max) == own:
            return self.load()
        return self.compute(parameters, control_period_s, notch_max)

    def text(self) -> str:
        """The computed text of the file."""
        constants = flatten(self.compute(self.parameters, self.control_period_s, self.notch_max))
        body = io.StringIO()
        writer = csv.writer(body, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(_row(constant) for constant in constants)
        head = "".join(f"# {key}: {value}\n" for key, value in self._head(len(constants), body.getvalue()).items())
        return f"{_TITLE}\n{head}{body.getvalue()}"

    def _head(self, rows: int, body: str) -> dict[str, str]:
        return {
            "law": self.law,
            "control_period_s": repr(self.control_period_s),
            "notch_max": repr(self.notch_max),
            "parameters": hashlib.sha256(repr(self.parameters).encode()).hexdigest()[:16],
            "rows": str(rows),
            "sha256": hashlib.sha256(body.encode()).hexdigest(),
        }

    def load(self) -> Table:
        """The table from its file; see :meth:`make`."""
        with refuse_unreadable(self.path, f"the table of the law ({_HINT})"):
            content = self.path.read_text(encoding="utf-8")
        lines = content.splitlines(keepends=True)
        comments = [line for line in lines if line.startswith("#")]
        body = "".join(lines[len(comments) :])
        rows = list(csv.reader(io.StringIO(body)))
        head = dict(line[2:].strip().split(": ", 1) for line in comments if ": " in line)
        expected = self._head(max(len(rows) - 1, 0), body)
        # Compare the check sum last, so that an invalid row is named.
        for key in ("law", "control_period_s", "notch_max", "parameters"):
            self._expect(key, head.get(key), expected[key])
        self._expect("columns", ",".join(rows[0] if rows else []), ",".join(COLUMNS))
        formats = {item.name: item.metadata["q"] for item in fields(self.kind)}  # type: ignore[arg-type]
        constants = [self._constant(row, formats) for row in rows[1:]]
        try:
            table = rebuild(self.kind, constants)
        except ValueError as error:
            name, found = error.args
            raise InputError(self.path, name, Words(found), f"the constants of {self.law} in order", _HINT) from error
        self._expect("rows", expected["rows"], head.get("rows", "none"))
        self._expect("sha256", expected["sha256"], head.get("sha256", "none"))
        return table

    def _expect(self, key: str, found: str | None, allowed: str) -> None:
        if found != allowed:
            raise InputError(self.path, key, Words() if found is None else found, allowed, _HINT)

    def _constant(self, row: list[str], formats: Mapping[str, int]) -> Constant:
        """The constant of a row, checked to be consistent with its value and its field."""
        name = row[0] if row else ""
        self._expect(name, f"{len(row)} columns", f"{len(COLUMNS)} columns")
        q = formats.get(name.partition("[")[0])
        if q is not None:
            self._expect(f"{name}: q", row[1], str(q))
        try:
            constant = Constant(name, float(row[3]), int(row[1]), row[6])
        except ValueError as error:
            raise InputError(self.path, name, row[3], f"a number that fits Q{row[1]}", _HINT) from error
        for column, found, allowed in zip(COLUMNS, row, _row(constant), strict=True):
            self._expect(f"{name}: {column}", found, allowed)
        return constant
