"""Rows of IQmath vectors: the inputs of each function, and reading a folder of them line by line."""

from __future__ import annotations

import gzip
import json
import struct
import zlib
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.iq import C28

Row = dict[str, Any]
FORMATS = range(1, 31)


@dataclass(frozen=True, slots=True)
class Input:
    """Allowed values of an input: integers of a range, or a text (None). ``plain``: an argument that is never an
    array."""

    allowed: range | None
    plain: bool = False

    def holds(self, value: Any) -> bool:
        return type(value) is str if self.allowed is None else type(value) is int and value in self.allowed

    def __str__(self) -> str:
        return "a text" if self.allowed is None else f"{self.allowed.start} to {self.allowed.stop - 1}"


NUMBER, BITS32, BITS64 = Input(range(-(2**31), 2**31)), Input(range(2**32)), Input(range(2**64))
FORMAT, COUNT = Input(FORMATS, plain=True), Input(range(32), plain=True)
TEXT, FORM = Input(None), Input(None, plain=True)


@dataclass(frozen=True, slots=True)
class Function:
    """How a function of the vectors is called: inputs in order, then Q."""

    method: str
    inputs: tuple[Input, ...]
    takes_q: bool = True
    #: struct layouts: what the bits of the input are, and which integer they are written as.
    bits: tuple[str, str] | None = None
    formats: range = FORMATS

    def operand(self, value: Any) -> Any:
        return struct.unpack(self.bits[0], struct.pack(self.bits[1], value))[0] if self.bits else value

    def __call__(self, arithmetic: Any, q: int, inputs: Iterable[Any]) -> Any:
        return getattr(arithmetic, self.method)(*inputs, *([q] if self.takes_q else []))


_ONE, _TWO, _THREE = (NUMBER,), (NUMBER,) * 2, (NUMBER,) * 3
#: pi does not fit into Q30.
_RAD = range(1, 30)
FUNCTIONS = {
    **{name: Function(name, _TWO) for name in ("mpy", "rmpy", "rsmpy", "div", "mag")},
    **{name: Function(name, _ONE) for name in ("sqrt", "isqrt", "exp", "log", "frac")},
    **{name: Function(name, _TWO, takes_q=False) for name in ("add", "sub", "sadd", "ssub")},
    **{name: Function(name, (NUMBER, COUNT), takes_q=False) for name in ("shr", "shl")},
    "abs": Function("abs", _ONE, takes_q=False),
    "sat": Function("sat", _THREE, takes_q=False),
    "mpyIQX": Function("mpy_iqx", (NUMBER, FORMAT) * 2),
    "mpyI32": Function("mpy_i32", _TWO, takes_q=False),
    "mpyI32int": Function("mpy_i32_int", _TWO),
    "mpyI32frac": Function("mpy_i32_frac", _TWO),
    "int": Function("int_part", _ONE),
    **{name: Function(name, _ONE, formats=_RAD) for name in ("sin", "cos", "asin", "acos")},
    "atan2": Function("atan2", _TWO, formats=_RAD),
    "atan2PU": Function("atan2_pu", _TWO),
    "sinPU": Function("sin_pu", _ONE),
    "cosPU": Function("cos_pu", _ONE),
    "toF": Function("to_f", _ONE),
    "IQf": Function("from_float", (BITS32,), bits=("<f", "<I")),
    "IQd": Function("from_float", (BITS64,), bits=("<d", "<Q")),
    "atoIQ": Function("ato_iq", (TEXT,)),
    "toa": Function("to_a", (FORM, NUMBER)),
}


def _refused(row: Any, profile: str | None) -> tuple[str, Any, str] | None:
    """The error in a row: key, found, allowed; None for a row that can be run and judged."""
    if not isinstance(row, dict) or not _is_name(row.get("f")):
        return "f", row, "a row with f, q and i"
    q, inputs, call = row.get("q"), row.get("i"), FUNCTIONS.get(row["f"])
    formats = call.formats if call else FORMATS
    if type(q) is not int or q not in formats:
        return "q", q, f"{formats.start} to {formats.stop - 1} for {row['f']}"
    if call is None:
        return None
    if not isinstance(inputs, list) or len(inputs) != len(call.inputs):
        return "i", inputs, f"{len(call.inputs)} inputs of {row['f']}"
    for place, (kind, value) in enumerate(zip(call.inputs, inputs, strict=True)):
        if not kind.holds(value):
            return f"i[{place}]", value, str(kind)
    if call.bits:
        value = call.operand(inputs[0])
        try:
            C28().from_float(value, q)
        except ValueError:
            return "i[0]", value, f"a value inside int32 in Q{q}"
    for key in ("o", "c", "r"):
        if key in row and not _is_answer(row["f"], row[key]):
            return key, row[key], "[error, text]" if row["f"] == "toa" else "a whole number"
    if profile == "portable" and row.get("t") != "u" and "o" not in row:
        return "o", Words(), "the portable library's result"
    return None


def _is_name(value: Any) -> bool:
    return isinstance(value, str) and value.isascii() and value.isidentifier()


def _is_answer(function: str, value: Any) -> bool:
    if function != "toa":
        return type(value) is int
    return isinstance(value, list) and len(value) == 2 and type(value[0]) is int and isinstance(value[1], str | None)


def _lines(path: Path) -> list[str]:
    try:
        with gzip.open(path, "rt", encoding="utf-8") if path.suffix == ".gz" else path.open(encoding="utf-8") as lines:
            return list(lines)
    except (OSError, EOFError, zlib.error, UnicodeDecodeError) as error:
        raise InputError(str(path), "file", Words(str(error)), "JSON lines, plain or gzip by the name") from None


def read_rows(folder: Path, profile: str | None = None) -> dict[str, list[Row]]:
    """Rows of every ``*.jsonl`` and ``*.jsonl.gz`` of a folder, by function.

    Raises :class:`~railhil.common.errors.InputError` when there are none, for a file that cannot be read and for a line
    that is not a row of its function or, with a ``profile``, lacks the expected result of that profile.
    """
    rows: dict[str, list[Row]] = defaultdict(list)
    for path in sorted([*folder.glob("*.jsonl"), *folder.glob("*.jsonl.gz")]):
        for number, line in enumerate(_lines(path), 1):
            try:
                row = json.loads(line)
            except (ValueError, RecursionError):
                raise InputError(str(path), f"line {number}", line.strip(), "a row with f, q and i") from None
            refused = _refused(row, profile)
            if refused:
                key, found, allowed = refused
                raise InputError(str(path), f"line {number}: {key}", found, allowed)
            rows[row["f"]].append(row)
    if not rows:
        raise InputError(str(folder), "folder", Words("no rows"), "files *.jsonl or *.jsonl.gz")
    return dict(rows)
