"""Conditions, groups and order of the rows of an index."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import pytest

from hil_tests.support.run_folders import write_run
from railhil.common.errors import InputError
from railhil.index.show import all_rows, as_json, check_key, chosen, doubts, groups, in_order, instant
from railhil.index.tables import Index, open_index

NOW = datetime(2026, 11, 28, 12, tzinfo=UTC)


@pytest.fixture
def index(tmp_path: Path) -> Index:
    sentence = {"id": "ATO-5", "says": "x", "verdict": "violated", "margin": -0.5, "unit": "m"}
    write_run(tmp_path / "20261101T000000Z-a", "ipfc", scores={"stop_error_m": 0.3})
    write_run(tmp_path / "20261115T000000Z-b", "ipfc", "FAIL", seed=10, requirements=[sentence])
    write_run(tmp_path / "20261128T000000Z-c", "pid", "INVALID", seed=9, scores={"stop_error_m": 0.02}, perturbed=True)
    return open_index(tmp_path)


@pytest.mark.parametrize(
    ("where", "found"),
    [
        ({}, "abc"), ({"law": "ip*"}, "ab"), ({"law": "ip*", "verdict": "FAIL"}, "b"), ({"requirement": "ATO-5"}, "b"),
        ({"requirement": ""}, "ac"), ({"seed": "9"}, "c"), ({"perturbed": "true"}, "c"), ({"verdict": "fail"}, ""),
        ({"is_new": "true"}, "abc"),
    ],
)  # fmt: skip
def test_rows_are_chosen_by_patterns_of_their_values(index: Index, where: dict[str, str], found: str) -> None:
    assert "".join(row["folder"][-1] for row in chosen(all_rows(index), where.items())) == found


@pytest.mark.parametrize(
    ("text", "found"), [("2026-11-15", "bc"), ("14d", "bc"), ("12h", "c"), ("4w", "abc"), ("2026-11-15T01:00", "c")]
)
def test_rows_are_chosen_by_their_instant(index: Index, text: str, found: str) -> None:
    assert "".join(row["folder"][-1] for row in chosen(all_rows(index), {}, instant(text, NOW))) == found


@pytest.mark.parametrize("text", ["", "yesterday", "3", "3 years", "2026-13-01", "-1d"])
def test_what_is_no_instant_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r".*"):
        instant(text, NOW)


def test_numbers_are_ordered_as_numbers_and_missing_ones_come_first(index: Index) -> None:
    rows = all_rows(index)
    assert [row["seed"] for row in in_order(rows, "seed")] == [0, 9, 10]
    assert "".join(row["folder"][-1] for row in in_order(rows, "stop_error_m")) == "cba"
    assert [row["perturbed"] for row in in_order(rows, "perturbed")][-1] is True


def test_a_group_counts_verdicts_and_a_requirement_has_its_own(index: Index) -> None:
    rows = all_rows(index)
    assert [(one["law"], one["folders"], one["verdicts"]) for one in groups(rows, "law")] == [
        ("ipfc", 2, {"PASS": 1, "FAIL": 1}), ("pid", 1, {"INVALID": 1}),
    ]  # fmt: skip
    (group,) = groups(rows, "requirement")
    assert (group["requirement"], group["folders"], group["verdicts"]) == ("ATO-5", 1, {"violated": 1})


def test_an_unknown_key_is_refused_with_the_one_that_was_meant(index: Index) -> None:
    with pytest.raises(InputError, match="did you mean verdict"):
        check_key(index, "--group", "verdct")


def test_a_document_has_only_what_the_folder_has(index: Index) -> None:
    first = as_json(all_rows(index)[0])
    assert first["made"] == "2026-11-01T00:00:00+00:00"
    assert None not in first.values()
    assert "requirement" not in first


def test_conditions_of_one_key_hold_together(index: Index) -> None:
    where = [("verdict", "*A*"), ("verdict", "F*")]
    assert [row["folder"][-1] for row in chosen(all_rows(index), where)] == ["b"]


def test_the_date_of_a_run_is_that_of_its_recording_and_another_one_is_told(tmp_path: Path) -> None:
    recorded = {"utc": "2026-11-02T03:04:05+00:00", "host": "h", "operator": "o"}
    write_run(tmp_path / "20261128T000000Z-copied", recorded=recorded)
    write_run(tmp_path / "20261101T000000Z-named")
    write_run(tmp_path / "20261399T000000Z-digits")
    rows = {row["folder"][17:]: row for row in all_rows(open_index(tmp_path))}
    assert {name: row["dated_by"] for name, row in rows.items()} == {
        "copied": "certificate", "named": "name", "digits": "file",
    }  # fmt: skip
    assert rows["copied"]["made"].isoformat() == "2026-11-02T03:04:05+00:00"
    (said,) = doubts([*rows.values()])
    assert said.startswith("~ ")
    assert "digits" in said
    assert "named" not in said


def test_a_folder_that_is_checked_against_nothing_is_told(tmp_path: Path) -> None:
    write_run(tmp_path / "20261101T000000Z-old", hash_list=None)
    (tmp_path / "20261101T000000Z-old" / "SHA256SUMS").unlink()
    (said,) = doubts(all_rows(open_index(tmp_path)))
    assert said == "1 folder without SHA256SUMS, checked against nothing: 20261101T000000Z-old"
