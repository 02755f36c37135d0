"""IQ fixed point against vectors made with TI's IQmath library: both profiles, one by one and as arrays."""

from __future__ import annotations

import gzip
import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from hil_tests import iq_vectors
from hil_tests.iq_vectors import FUNCTIONS, PROFILES, TOLERANCES, as_arrays, check, judge, one_by_one, read_rows

DATA = Path(__file__).parent / "data" / "iq"
ROWS = read_rows(DATA)
#: Functions of the vectors that no profile has.
NOT_OFFERED = {"asin", "acos", "atan2", "atan2PU"}
#: Rows that a profile is not judged by: text functions of the C28x, faults of the portable library.
UNJUDGED = {"c28": {"atoIQ": 242, "toa": 200}, "portable": {"toF": 7, "div": 6}}
#: Rows per function; a folder that lost some would otherwise pass.
COUNTS = """
mpy 1204, rmpy 1171, rsmpy 1204, mpyIQX 599, mpyI32 461, mpyI32int 454, mpyI32frac 421, div 1461,
add 332, sub 315, sadd 342, ssub 313, sat 437, abs 298, shr 285, shl 289, int 298, frac 289,
sqrt 991, isqrt 585, mag 545, exp 639, log 975, sin 822, cos 880, sinPU 423, cosPU 429,
toF 610, IQf 503, IQd 462, atoIQ 242, toa 200
"""


def test_all_vectors_are_there() -> None:
    assert set(ROWS) - set(FUNCTIONS) == NOT_OFFERED
    expected = {name: int(count) for name, count in map(str.split, COUNTS.split(","))}
    assert {function: len(ROWS[function]) for function in FUNCTIONS} == expected


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("function", FUNCTIONS)
def test_every_vector_is_met(profile: str, function: str) -> None:
    report = check(profile, function, ROWS[function])
    assert report.wrong == 0
    assert report.unjudged == UNJUDGED[profile].get(function, 0)
    # Exp of the C28x limits its argument: above the range it gives the value of the largest argument.
    assert report.worst_lsb == 0 or (profile, function) == ("c28", "exp")


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("function", FUNCTIONS)
def test_arrays_give_the_same_results_and_counts(profile: str, function: str) -> None:
    one, many = (make() for make in PROFILES[profile])
    results = as_arrays(many, function, ROWS[function])
    assert results == one_by_one(one, function, ROWS[function])
    assert judge(profile, function, ROWS[function], results).wrong == 0
    assert one.counters == many.counters


def test_the_profiles_differ_where_the_libraries_do() -> None:
    different = {
        function for function in FUNCTIONS if check("portable", function, ROWS[function], PROFILES["c28"][0]()).wrong
    }
    assert different == {
        *("div", "sqrt", "isqrt", "mag", "int", "frac", "mpyI32int", "mpyI32frac", "toF", "exp", "log"),
        *("sin", "cos", "sinPU", "cosPU", "atoIQ", "toa"),
    }


class _Off:
    """The C28x profile with one function off by some LSB."""

    def __init__(self, method: str, lsb: int) -> None:
        self._exact = getattr(PROFILES["c28"][0](), method)
        self._lsb = lsb
        setattr(self, method, self._off)

    def _off(self, *arguments: int) -> int:
        return int(self._exact(*arguments)) + self._lsb


@pytest.mark.parametrize("function", TOLERANCES)
def test_a_difference_inside_the_librarys_own_accuracy_is_told_from_one_outside(function: str) -> None:
    rows = [row for row in ROWS[function] if "c" not in row and 0 < row["r"] < 2**30 and row["q"] == 24]
    assert len(rows) > 20
    allowed = {iq_vectors.tolerance(function, row) for row in rows}
    method = FUNCTIONS[function].method
    inside = check("c28", function, rows, _Off(method, -min(allowed)))
    assert (inside.mismatches, inside.unrounded) == (0, len(rows))
    outside = check("c28", function, rows, _Off(method, -max(allowed) - 1))
    assert (outside.mismatches, outside.unrounded) == (len(rows), 0)


def test_exp_falls_short_only_above_its_range() -> None:
    largest = {q: iq_vectors.exp_range(q)[1] for q in range(1, 31)}
    row: dict[str, Any] = {"f": "exp", "q": 16, "i": [largest[16]], "r": 2**31 - 1}
    assert iq_vectors.shortfall("exp", row) == 0
    row["i"] = [largest[16] + 1]
    # One LSB of the argument is 2^-16 of the result.
    assert 2**15 - 1 <= iq_vectors.shortfall("exp", row) <= 2**15
    assert iq_vectors.shortfall("log", row) == 0


def test_command_prints_and_fails_with_a_mismatch(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copy(DATA / "div.jsonl.gz", tmp_path)
    for profile in PROFILES:
        assert iq_vectors.main([str(tmp_path), "--profile", profile]) == 0
        assert iq_vectors.main([str(tmp_path), "--profile", profile, "--arrays"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split() == ["div", "1461", "0", "0", "0", "0"]
    (tmp_path / "more.jsonl").write_text(
        '{"f":"mpy","q":24,"i":[3,5],"o":1,"c":1}\n{"f":"asin","q":24,"i":[0],"o":0}\n'
    )
    assert iq_vectors.main([str(tmp_path)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[2].split() == ["mpy", "1", "1", "0", "1", "0"]
    assert lines[3].split() == ["asin", "1", "not", "offered"]


def test_a_damaged_folder_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert iq_vectors.main([str(tmp_path)]) == 2
    assert "no rows" in capsys.readouterr().err
    with gzip.open(tmp_path / "x.jsonl.gz", "wt") as lines:
        lines.write(json.dumps({"f": "mpy", "q": 24, "i": [1, 2], "o": 0}) + '\n{"f":"mpy","q":"24"}\n')
    assert iq_vectors.main([str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert "line 2" in message
    assert message.count("\n") == 1
