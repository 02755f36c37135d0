"""IQmath vectors: read a folder of them, run them on a profile, report what differs.

``python -m hil_tests.support.iq_vectors FOLDER [--profile c28|portable] [--arrays]`` prints rows, differences and the
worst one of every function; exit code 1 if there are differences, 2 for a folder that cannot be read, contains an
invalid row or has no results for the profile. Row format: ``hil_tests/data/iq/SOURCE.md``.

The portable profile must give ``o`` on every row except those tagged ``u``. The C28x profile must give ``c``. Without a
``c``, a value further from the exact ``r`` than TI's own routine may be (:data:`TOLERANCES`) is a mismatch, and a value
within that tolerance is *unrounded* if it is not ``r`` itself: railhil's model promises the nearest number, a target
does not. The exceptions are the rows of exp outside the range of its format and those of atan2PU below 0
(:func:`expected`).
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from hil_tests.support.iq_rows import FUNCTIONS, Row, read_rows
from hil_tests.support.paths import TEST_DATA
from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.iq import C28, C28Batch, Portable, PortableBatch
from railhil.controller_node.arithmetic.iq.series import exp_range

_COLUMNS = ("rows", "mismatches", "unrounded", "worst LSB", "not judged")
PROFILES = {"c28": (C28, C28Batch), "portable": (Portable, PortableBatch)}


@cache
def shipped_rows() -> dict[str, list[Row]]:
    """The repository's own rows; read when the first test needs them, not by every process that collects the tests."""
    return read_rows(TEST_DATA / "iq")


def _of_full_scale(lsb: int) -> Callable[[int, int], int]:
    """A tolerance of this many LSB at 2^31, proportionally smaller below, at least one."""
    return lambda q, exact: max(1, math.ceil(lsb * abs(exact) / 2**31))


def _own_model_of_exp(q: int, exact: int) -> int:
    figures = {30: 7, 24: 1100, 20: 20_000, 16: 600_000}
    return figures.get(q, abs(exact))


def _at_format(lsb: int, full: int) -> Callable[[int, int], int]:
    """A tolerance of this many LSB in Q ``full``, proportionally smaller in lower formats, at least one."""
    return lambda q, exact: max(1, lsb >> (full - q))


#: How far TI's C28x routines may be from the exact value, in LSB: (function of q and exact result, source).
TOLERANCES: dict[str, tuple[Callable[[int, int], int], str]] = {
    "div": (_of_full_scale(7), "IQmath user's guide V1.70: 28 bits"),
    "sqrt": (_of_full_scale(6), "IQmath user's guide V1.70: 29 bits"),
    "isqrt": (_of_full_scale(5), "IQmath user's guide V1.70: 29 bits"),
    "mag": (_of_full_scale(6), "IQmath user's guide V1.70: 29 bits"),
    "sin": (lambda q, exact: 1, "IQmath user's guide V1.70: 30 bits, 1 LSB at Q29"),
    "cos": (lambda q, exact: 2, "IQmath user's guide V1.70: 30 bits, 2 LSB at Q29"),
    "sinPU": (lambda q, exact: 1, "IQmath user's guide V1.70: 30 bits, 1 LSB at Q30"),
    "cosPU": (lambda q, exact: 2, "IQmath user's guide V1.70: 29 bits, 2 LSB at Q30"),
    "atan2": (_at_format(32, 29), "IQmath user's guide V1.70: 26 bits, 32 LSB at Q29"),
    "atan2PU": (_at_format(16, 30), "IQmath user's guide V1.70: 27 bits"),
    "asin": (lambda q, exact: 3, "no published figure; that of the portable library"),
    "acos": (lambda q, exact: 3, "no published figure; that of the portable library"),
    "exp": (_own_model_of_exp, "no published figure; estimate from a model of the published steps"),
    "log": (lambda q, exact: 8 if q == 30 else 2, "no published figure; that of the portable library"),
}


def expected(profile: str, row: Row) -> Any:
    """The expected result of a profile, None if the row has none: tagged ``u``, or a text without ``c``.

    The C28x limits the argument of exp to the range of its format, on both sides: outside it, ``r`` is not what the
    library gives, but the result at the limit. Its atan2PU gives 0 to 1, while ``r`` is in -1/2 to 1/2.
    """
    if profile == "portable":
        return None if row.get("t") == "u" else row["o"]
    if "r" in row and "c" not in row:
        if row["f"] == "exp":
            return _at_the_limit(row["i"][0], row["q"], row["r"])
        if row["f"] == "atan2PU" and row["i"][0] < 0:
            return row["r"] + (1 << row["q"])
    return row.get("c", row.get("r"))


def _at_the_limit(argument: int, q: int, exact: int) -> int:
    """e^argument, ``exact``, or that of the nearest argument inside the range, by another library than the model's."""
    smallest, largest = exp_range(q)
    limited = min(max(argument, smallest), largest)
    if limited == argument:
        return exact
    with localcontext() as digits:
        digits.prec = 50
        return math.floor((Decimal(limited) / 2**q).exp() * 2**q + Decimal("0.5"))


def tolerance(function: str, row: Row) -> int:
    """LSB by which TI's routine may differ from ``r``, 0 if not specified."""
    return TOLERANCES[function][0](row["q"], row["r"]) if function in TOLERANCES else 0


@dataclass(slots=True)
class Report:
    """Outcome of one function: ``worst_lsb`` is the largest difference from what is expected."""

    rows: int = 0
    mismatches: int = 0
    #: Within the tolerance of the library, but not the nearest number.
    unrounded: int = 0
    worst_lsb: int = 0
    #: Rows without a result for the profile.
    unjudged: int = 0

    @property
    def wrong(self) -> int:
        """Rows that fail the profile as modelled."""
        return self.mismatches + self.unrounded


def one_by_one(arithmetic: Any, function: str, rows: Sequence[Row]) -> list[Any]:
    """Results of a function on the class for one train."""
    call = FUNCTIONS[function]
    return [call(arithmetic, row["q"], map(call.operand, row["i"])) for row in rows]


def as_arrays(arithmetic: Any, function: str, rows: Sequence[Row]) -> list[Any]:
    """Results on the class for N trains: rows with equal Q and plain inputs together."""
    call = FUNCTIONS[function]
    plain = [k for k, kind in enumerate(call.inputs) if kind.plain]
    groups: dict[Any, list[int]] = defaultdict(list)
    for place, row in enumerate(rows):
        groups[row["q"], *(row["i"][k] for k in plain)].append(place)
    results: list[Any] = [None] * len(rows)
    for places in groups.values():
        first = rows[places[0]]
        columns = [
            first["i"][k] if k in plain else np.array([call.operand(rows[place]["i"][k]) for place in places])
            for k in range(len(call.inputs))
        ]
        values = call(arithmetic, first["q"], columns)
        for place, value in zip(places, values.tolist() if isinstance(values, np.ndarray) else values, strict=True):
            results[place] = value
    return results


def judge(profile: str, function: str, rows: Sequence[Row], results: Sequence[Any]) -> Report:
    """Compare results with those that the rows require of a profile."""
    report = Report()
    for row, result in zip(rows, results, strict=True):
        wanted = expected(profile, row)
        report.rows += 1
        if wanted is None:
            report.unjudged += 1
        elif isinstance(wanted, int):
            off_lsb = abs(wanted - result)
            report.worst_lsb = max(report.worst_lsb, off_lsb)
            if off_lsb:
                near = profile == "c28" and "c" not in row and off_lsb <= tolerance(function, row)
                report.unrounded += near
                report.mismatches += not near
        else:
            report.mismatches += list(result) != wanted
    return report


def check(profile: str, function: str, rows: Sequence[Row], arithmetic: Any = None) -> Report:
    """Run the rows of one function on a profile, or on another implementation of its class for one train."""
    return judge(profile, function, rows, one_by_one(arithmetic or PROFILES[profile][0](), function, rows))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m hil_tests.support.iq_vectors", description="Check IQmath vectors.")
    parser.add_argument("folder", type=Path, help="folder with *.jsonl or *.jsonl.gz")
    parser.add_argument("--profile", choices=sorted(PROFILES), default="c28")
    parser.add_argument("--arrays", action="store_true", help="run the class for N trains")
    options = parser.parse_args(arguments)
    one, many = PROFILES[options.profile]
    judged = wrong = 0
    try:
        every = read_rows(options.folder, options.profile)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{'function':<12}" + "".join(f"{title:>12}" for title in _COLUMNS))
    for function, rows in every.items():
        if function not in FUNCTIONS:
            print(f"{function:<12}{len(rows):>12}   not offered")
            continue
        results = as_arrays(many(), function, rows) if options.arrays else one_by_one(one(), function, rows)
        report = judge(options.profile, function, rows, results)
        judged += report.rows - report.unjudged
        wrong += report.wrong
        figures = (report.rows, report.mismatches, report.unrounded, report.worst_lsb, report.unjudged)
        print(f"{function:<12}" + "".join(f"{figure:>12}" for figure in figures))
    if not judged:
        nothing = Words(f"no row that the profile {options.profile} is judged by")
        print(InputError(str(options.folder), "folder", nothing, "rows of a function above"), file=sys.stderr)
        return 2
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
