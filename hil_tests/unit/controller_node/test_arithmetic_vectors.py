"""IQ fixed point against vectors made with TI's IQmath library: both profiles, one by one and as arrays."""

from __future__ import annotations

import gzip
import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support import iq_vectors
from hil_tests.support.iq_vectors import (
    FUNCTIONS,
    PROFILES,
    TOLERANCES,
    as_arrays,
    check,
    judge,
    one_by_one,
    shipped_rows,
)
from hil_tests.support.paths import TEST_DATA

DATA = TEST_DATA / "iq"
#: Rows that a profile is not judged by: on the C28x texts and arguments above 1, faults of the portable library.
UNJUDGED = {
    "c28": {"atoIQ": 242, "toa": 200, "asin": 72, "acos": 59},
    "portable": {"toF": 7, "div": 6, "atan2": 15, "atan2PU": 4},
}
#: Rows per function; a folder that lost some would otherwise pass.
COUNTS = """
mpy 1204, rmpy 1171, rsmpy 1204, mpyIQX 599, mpyI32 461, mpyI32int 454, mpyI32frac 421, div 1461,
add 332, sub 315, sadd 342, ssub 313, sat 437, abs 298, shr 285, shl 289, int 298, frac 289,
sqrt 991, isqrt 585, mag 545, exp 639, log 975, sin 822, cos 880, sinPU 423, cosPU 429,
asin 326, acos 263, atan2 589, atan2PU 608,
toF 610, IQf 503, IQd 462, atoIQ 242, toa 200
"""


def test_all_vectors_are_there() -> None:
    assert set(shipped_rows()) == set(FUNCTIONS)
    expected = {name: int(count) for name, count in map(str.split, COUNTS.split(","))}
    assert {function: len(shipped_rows()[function]) for function in FUNCTIONS} == expected


@pytest.mark.parametrize("profile", PROFILES)
def test_every_vector_is_met(profile: str) -> None:
    for function in FUNCTIONS:
        report = check(profile, function, shipped_rows()[function])
        assert report.wrong == report.worst_lsb == 0
        assert report.unjudged == UNJUDGED[profile].get(function, 0)


@pytest.mark.parametrize("function", ["atan2", "atan2PU"])
def test_the_librarys_own_faults_of_the_arctangent_are_those_of_the_portable_profile(function: str) -> None:
    rows = [row for row in shipped_rows()[function] if row["t"] == "u"]
    assert one_by_one(PROFILES["portable"][0](), function, rows) == [row["o"] for row in rows]


def test_the_arctangent_in_turns_is_judged_in_0_to_1_on_the_c28x() -> None:
    row = {"f": "atan2PU", "q": 8, "i": [-3, 3], "r": -32, "o": -32}
    assert iq_vectors.expected("c28", row) == 224
    assert iq_vectors.expected("c28", row | {"i": [3, 3], "r": 32}) == 32
    assert iq_vectors.expected("c28", row | {"c": 7}) == 7
    assert iq_vectors.expected("portable", row) == -32


@pytest.mark.parametrize("profile", PROFILES)
def test_arrays_give_the_same_results_and_counts(profile: str) -> None:
    for function in FUNCTIONS:
        one, many = (make() for make in PROFILES[profile])
        results = as_arrays(many, function, shipped_rows()[function])
        assert results == one_by_one(one, function, shipped_rows()[function])
        assert judge(profile, function, shipped_rows()[function], results).wrong == 0
        assert one.counters == many.counters


def test_the_profiles_differ_where_the_libraries_do() -> None:
    different = {
        function
        for function in FUNCTIONS
        if check("portable", function, shipped_rows()[function], PROFILES["c28"][0]()).wrong
    }
    assert different == {
        *("div", "sqrt", "isqrt", "mag", "int", "frac", "mpyI32int", "mpyI32frac", "toF", "exp", "log"),
        *("sin", "cos", "sinPU", "cosPU", "asin", "acos", "atan2", "atan2PU", "atoIQ", "toa"),
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
    rows = [
        row for row in shipped_rows()[function] if "c" not in row and 0 < row.get("r", 0) < 2**30 and row["q"] == 24
    ]
    assert len(rows) > 20
    allowed = {iq_vectors.tolerance(function, row) for row in rows}
    method = FUNCTIONS[function].method
    inside = check("c28", function, rows, _Off(method, -min(allowed)))
    assert (inside.mismatches, inside.unrounded) == (0, len(rows))
    outside = check("c28", function, rows, _Off(method, -max(allowed) - 1))
    assert (outside.mismatches, outside.unrounded) == (len(rows), 0)


def test_exp_is_judged_by_r_inside_its_range_only() -> None:
    smallest, largest = iq_vectors.exp_range(1)
    assert (smallest, largest) == (-1, 41)

    def expected(argument: int, r: int, profile: str = "c28", **other: Any) -> Any:
        return iq_vectors.expected(profile, {"f": "exp", "q": 1, "i": [argument], "r": r, "o": 7} | other)

    # 2 e^20.5, and 2 e^-0.5 = 1.2.
    assert expected(42, 2**31 - 1) == expected(2**31 - 1, 2**31 - 1) == 1599804355
    assert expected(-2, 1) == expected(-(2**31), 0) == 1
    assert expected(largest, 5) == expected(smallest, 5) == 5
    assert expected(42, 3, c=4) == 4
    assert expected(42, 3, f="log") == 3
    assert expected(42, 3, "portable") == 7


def test_command_prints_and_fails_with_a_mismatch(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copy(DATA / "div.jsonl.gz", tmp_path)
    for profile in PROFILES:
        assert iq_vectors.main([str(tmp_path), "--profile", profile]) == 0
        assert iq_vectors.main([str(tmp_path), "--profile", profile, "--arrays"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split() == ["div", "1461", "0", "0", "0", "0"]
    (tmp_path / "more.jsonl").write_text('{"f":"mpy","q":24,"i":[3,5],"o":1,"c":1}\n{"f":"tan","q":24,"i":[0],"o":0}\n')
    assert iq_vectors.main([str(tmp_path)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[2].split() == ["mpy", "1", "1", "0", "1", "0"]
    assert lines[3].split() == ["tan", "1", "not", "offered"]


def one_line(folder: Path, capsys: pytest.CaptureFixture[str], *options: str) -> str:
    """The error of the command, which is one line and exit code 2."""
    assert iq_vectors.main([str(folder), *options]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    return message.removeprefix(f"{folder}").strip()


def test_a_damaged_folder_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert one_line(tmp_path, capsys).startswith(": folder: no rows")
    assert "no rows" in one_line(tmp_path / "missing", capsys)
    with gzip.open(tmp_path / "x.jsonl.gz", "wt") as lines:
        lines.write(json.dumps({"f": "mpy", "q": 24, "i": [1, 2], "o": 0}) + '\n{"f":"mpy","q":"24"}\n')
    assert one_line(tmp_path, capsys) == "/x.jsonl.gz: line 2: q: found '24', allowed 1 to 30 for mpy"
    whole = (tmp_path / "x.jsonl.gz").read_bytes()
    for damaged in (b'{"f":"mpy","q":24,"i":[1,2],"o":0}', whole[:-9], whole[:12] + b"\xff" * 20):
        (tmp_path / "x.jsonl.gz").write_bytes(damaged)
        assert one_line(tmp_path, capsys).startswith("/x.jsonl.gz: file: ")
    (tmp_path / "x.jsonl.gz").unlink()
    (tmp_path / "y.jsonl").write_bytes(b"\xff\xfe")
    assert one_line(tmp_path, capsys).startswith("/y.jsonl: file: ")
    (tmp_path / "y.jsonl").unlink()
    (tmp_path / "y.jsonl").mkdir()
    assert one_line(tmp_path, capsys).startswith("/y.jsonl: file: ")


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("", "line 2: found '', allowed a row with f, q and i"),
        ("[" * 100_000, "line 2: found '[[["),
        ("7", "line 2: f: found 7, allowed a row with f, q and i"),
        ('{"f":"mpy","q":40,"i":[1,2],"o":0,"c":0}', "line 2: q: found 40, allowed 1 to 30 for mpy"),
        ('{"f":"asin","q":30,"i":[1],"o":0}', "line 2: q: found 30, allowed 1 to 29 for asin"),
        ('{"f":"mpy","q":24,"i":[1],"o":0,"c":0}', "line 2: i: found [1], allowed 2 inputs of mpy"),
        ('{"f":"mpy","q":24,"i":[1,"2"],"o":0,"c":0}', "line 2: i[1]: found '2', allowed -2147483648 to 2147483647"),
        ('{"f":"shl","q":24,"i":[1,32],"o":0,"c":0}', "line 2: i[1]: found 32, allowed 0 to 31"),
        ('{"f":"atoIQ","q":24,"i":[1],"o":0,"c":0}', "line 2: i[0]: found 1, allowed a text"),
        (
            '{"f":"IQd","q":24,"i":[18446744073709551616],"o":0,"c":0}',
            "line 2: i[0]: found 18446744073709551616, allow",
        ),
        ('{"f":"IQd","q":30,"i":[4611686018427387904],"o":0,"c":0}', "line 2: i[0]: found 2.0, allowed a value inside"),
        (
            '{"f":"IQd","q":30,"i":[9218868437227405311],"o":0,"c":0}',
            "line 2: i[0]: found 1.7976931348623157e+308, all",
        ),
        ('{"f":"mpy","q":24,"i":[1,2],"o":"0","c":0}', "line 2: o: found '0', allowed a whole number"),
        ('{"f":"toa","q":24,"i":["%2.2f",2],"o":0}', "line 2: o: found 0, allowed [error, text]"),
    ],
)
def test_a_row_that_cannot_be_run_is_one_line(
    row: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "x.jsonl").write_text('{"f":"mpy","q":24,"i":[3,5],"o":0,"c":0}\n' + row + "\n")
    for profile in PROFILES:
        assert one_line(tmp_path, capsys, "--profile", profile).startswith(f"/x.jsonl: {words}")


def test_a_row_without_the_portable_result_is_for_the_c28_only(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "x.jsonl").write_text('{"f":"mpy","q":24,"i":[3,5],"c":0}\n')
    assert iq_vectors.main([str(tmp_path), "--profile", "c28"]) == 0
    message = one_line(tmp_path, capsys, "--profile", "portable")
    assert message == "/x.jsonl: line 1: o: missing, expected the portable library's result"


@pytest.mark.parametrize(
    ("profile", "row"),
    [
        ("c28", '{"f":"tan","q":24,"i":[0],"o":0}'),
        ("c28", '{"f":"atoIQ","q":24,"i":["1.5"],"o":25165824}'),
        ("c28", '{"f":"mpy","q":24,"i":[3,5],"o":0}'),
        ("portable", '{"f":"div","q":24,"i":[-2147483648,3],"o":0,"t":"u"}'),
    ],
)
def test_a_folder_that_says_nothing_about_a_profile_does_not_pass(
    profile: str, row: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "x.jsonl").write_text(row + "\n")
    words = f": folder: no row that the profile {profile} is judged by"
    assert one_line(tmp_path, capsys, "--profile", profile).startswith(words)
