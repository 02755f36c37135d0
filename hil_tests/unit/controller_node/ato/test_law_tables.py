"""Constant tables of the laws as data: the checked-in tables are what the law computes, and nothing else is loaded."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.ato import generate
from railhil.controller_node.ato.ipfc_constants import TABLE, IpfcConstants, compute_constants, make_constants
from railhil.controller_node.laws import load
from railhil.controller_node.laws.constant_table import LawTable, build, coarse, flatten, held, rebuild

AT_FILE = (TABLE.parameters, TABLE.control_period_s, TABLE.notch_max)
LINES = TABLE.path.read_text(encoding="utf-8").splitlines()
#: Behind the title, six head lines and the names of the columns.
ROWS = len(LINES) - 8


@dataclass(frozen=True)
class Small:
    number: Constant = field(metadata=held(4, "eq. (1)"))
    row: tuple[Constant, ...] = field(metadata=held(8, "eq. (2)"))
    matrix: tuple[tuple[Constant, ...], ...] = field(metadata=held(0, "eq. (3), eq. (4)"))


SMALL = build(Small, {"number": 0.3, "row": (1, 2.5), "matrix": [[1, 2], [3, 4], [5, 6]]})


@pytest.mark.parametrize("table", generate.TABLES, ids=lambda table: table.law)
def test_generating_again_gives_the_same_bytes(table: LawTable[Any]) -> None:
    assert table.path.read_bytes() == table.text().encode()


@pytest.mark.parametrize("table", generate.TABLES, ids=lambda table: table.law)
def test_loaded_is_computed_to_the_last_bit(table: LawTable[Any]) -> None:
    computed = flatten(table.compute(table.parameters, table.control_period_s, table.notch_max))
    loaded = flatten(table.load())
    assert [(c.name, c.q, c.raw, c.value, c.origin) for c in loaded] == [
        (c.name, c.q, c.raw, c.value, c.origin) for c in computed
    ]
    assert all(constant.origin for constant in loaded)
    assert load(table.law).name == table.law


def test_every_column_follows_from_the_value() -> None:
    """By plain arithmetic on the file, without the code that wrote it."""
    names = []
    for line in LINES[8:]:
        name, q, raw, value, error, relative, origin = line.split(",", 6)
        names.append(name)
        assert abs(int(raw) - float(value) * 2 ** int(q)) <= 0.5
        assert float(error) == int(raw) / 2 ** int(q) - float(value)
        assert float(relative) == pytest.approx(abs(float(error) / float(value)) if float(value) else 0, rel=1e-3)
        assert origin
    assert len(set(names)) == len(names) == len(flatten(TABLE.load()))


def test_only_the_operating_point_of_the_file_is_loaded() -> None:
    computed = []

    def compute(*point: Any) -> IpfcConstants:
        computed.append(point)
        return compute_constants(*point)

    table = replace(TABLE, compute=compute)
    parameters, period_s, notch_max = AT_FILE
    assert table.make(*AT_FILE) == table.load()
    assert computed == []
    others = [
        (replace(parameters, softening_max=0.86), period_s, notch_max),
        (parameters, 0.4, notch_max),
        (parameters, period_s, 6.0),
    ]
    for other in others:
        assert table.make(*other) == compute_constants(*other)
    assert computed == others


@pytest.mark.slow
def test_a_run_at_that_point_needs_no_scipy() -> None:
    code = (
        "import sys, railhil.controller_node.command, railhil.controller_node.ato.laws.ipfc as ipfc;"
        "from dataclasses import replace; import railhil.controller_node.arithmetic as a;"
        "from railhil.scenarios.load import load; s = load('lvshun_tieshan');"
        "ipfc.Ipfc(a.make('iq'), s); print('scipy' in sys.modules);"
        "other = replace(s, timing=replace(s.timing, control_period_ns=400_000_000));"
        "ipfc.Ipfc(a.make('iq'), other); print('scipy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.split() == ["False", "True"]


def test_names_are_places() -> None:
    assert [(c.name, c.value, c.q, c.raw, c.origin) for c in flatten(SMALL)] == [
        ("number", 0.3, 4, 5, "eq. (1)"),
        ("row[0]", 1.0, 8, 256, "eq. (2)"),
        ("row[1]", 2.5, 8, 640, "eq. (2)"),
        *((f"matrix[{i // 2}][{i % 2}]", i + 1.0, 0, i + 1, "eq. (3), eq. (4)") for i in range(6)),
    ]
    assert rebuild(Small, flatten(SMALL)) == SMALL


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda all_: all_[1:], ("number", "missing")),
        (lambda all_: [*all_, replace(all_[0], name="other")], ("other", "no constant of this law")),
        (lambda all_: [*all_, all_[0]], ("number", "a second time")),
        (lambda all_: [*all_[:3], *all_[4:]], ("matrix[0][0]", r"matrix\[0\]\[1\]")),
        (lambda all_: [all_[0], all_[2], all_[1], *all_[3:]], ("row[0]", r"row\[1\]")),
        (lambda all_: [all_[0], replace(all_[1], name="row"), *all_[2:]], ("row", "a number and a row")),
        (lambda all_: [all_[0], replace(all_[1], name="row[x]"), *all_[2:]], ("row[x]", "no name")),
    ],
)
def test_constants_that_make_no_table(spoil: Callable[[list[Constant]], list[Constant]], words: tuple) -> None:
    with pytest.raises(ValueError, match=words[1]) as caught:
        rebuild(Small, spoil(list(flatten(SMALL))))
    assert caught.value.args[0] == words[0]


def changed(old: str, new: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        assert text.count(old) == 1, old
        return text.replace(old, new)

    return change


def column(name: str, index: int, new: str) -> Callable[[str], str]:
    """Another entry in one row of the file."""
    line = next(line for line in LINES if line.startswith(f"{name},"))
    parts = line.split(",", 6)
    parts[index] = new
    return changed(line, ",".join(parts))


def without(name: str) -> Callable[[str], str]:
    return changed(next(line for line in LINES if line.startswith(f"{name},")) + "\n", "")


#: A change of the file, the key that is named, and the found and allowed that are said.
SPOILED: dict[str, tuple[Callable[[str], str], str, str]] = {
    "raw": (column("gains_step[1]", 2, "2487773"), "gains_step[1]: raw", "found '2487773', allowed 2487804"),
    "value": (column("notch_max", 3, "6.0"), "notch_max: raw", "found '3670016', allowed 3145728"),
    "last digit of a value": (
        column("notch_max", 3, "7.0000001"),
        "notch_max: rounding_error",
        "found '0.0', allowed -",
    ),
    "format": (column("notch_max", 1, "18"), "notch_max: q", "found '18', allowed 19"),
    "no number": (column("notch_max", 3, "seven"), "notch_max", "found 'seven', allowed a number that fits Q19"),
    "too large": (column("notch_max", 3, "1e9"), "notch_max", "found '1e9', allowed a number that fits Q19"),
    "error": (column("per_period", 4, "0.1"), "per_period: rounding_error", "found '0.1', allowed 0.0"),
    "relative error": (column("per_period", 5, "0.1"), "per_period: relative_error", "found '0.1', allowed 0.000e+00"),
    "name": (column("free[3][1]", 0, "free[3][2]"), "free[3][1]", "free[3][2], expected"),
    "unknown name": (column("zero", 0, "nought"), "nought", "no constant of this law"),
    "missing row": (without("free[3][1]"), "rows", f"found '{ROWS - 1}', allowed {ROWS}"),
    "missing first of a row": (without("model[1][0]"), "model[1][0]", "model[1][1]"),
    "missing field": (without("notch_max"), "notch_max", "missing"),
    "missing column": (changed("one_speed,20,", "one_speed,"), "one_speed", "found '6 columns', allowed 7 columns"),
    "origin": (column("notch_max", 6, "train"), "sha256", "allowed"),
    "parameters": (changed("# parameters: ", "# parameters: 0"), "parameters", "found '0"),
    "law": (changed("# law: ipfc", "# law: pid"), "law", "found 'pid', allowed ipfc"),
    "period": (changed("_s: 0.5", "_s: 0.4"), "control_period_s", "found '0.4', allowed 0.5"),
    "notch range": (changed("# notch_max: 7.0", "# notch_max: 6.0"), "notch_max", "found '6.0', allowed 7.0"),
    "no head": (changed("# law: ipfc\n", ""), "law", "missing, expected ipfc"),
    "columns": (changed("name,q,raw", "name,raw,q"), "columns", "found 'name,raw,q,"),
    "empty": (lambda text: "", "law", "missing"),
}


@pytest.mark.parametrize("case", SPOILED)
def test_a_changed_table_is_refused_in_one_line(case: str, tmp_path: Path) -> None:
    change, key, words = SPOILED[case]
    table = replace(TABLE, folder=tmp_path)
    table.path.write_text(change(TABLE.path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        table.make(*AT_FILE)
    message = str(caught.value)
    assert message.startswith(f"{table.path}: {key}: ")
    assert words in message
    assert message.endswith("(python -m railhil.controller_node.ato.generate writes it anew)")
    assert "\n" not in message


def test_a_table_that_is_not_there_or_no_text(tmp_path: Path) -> None:
    table = replace(TABLE, folder=tmp_path)
    with pytest.raises(InputError, match=r"ipfc\.csv: does not exist"):
        table.load()
    table.path.write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match=r"ipfc\.csv: is not UTF-8"):
        table.load()


def test_the_generator_writes_checks_and_lists(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    small = LawTable("small", Small, ("any",), 0.5, 7.0, lambda *point: SMALL, tmp_path / "tables")
    tables = (small,)
    assert generate.main(["--check"], tables) == 1
    assert not small.path.exists()
    assert generate.main([], tables) == 0
    assert small.load() == SMALL
    capsys.readouterr()
    assert generate.main(["--check"], tables) == 0
    assert capsys.readouterr().out == "small.csv: 9 constants\n  number = 0.3: Q4 is off by 4.2e-02\n"
    small.path.write_text(small.path.read_text() + "\n")
    assert generate.main(["--check"], tables) == 1
    assert "small.csv: not what the law computes" in capsys.readouterr().err


def test_coarse_constants_are_listed() -> None:
    fine, rough = Constant("fine", 1 / 3, 20), Constant("rough", 0.01, 12)
    assert coarse([fine, rough]) == (rough,)
    assert coarse([fine, rough], 1e-7) == (fine, rough)
    assert coarse(flatten(TABLE.load())) == ()


def test_a_law_gets_its_table_from_the_file() -> None:
    assert isinstance(make_constants(*AT_FILE), IpfcConstants)
    assert make_constants(*AT_FILE) == TABLE.load()
