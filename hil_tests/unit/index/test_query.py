"""SQL over an index: it sees the tables, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.run_folders import write_run
from railhil.common.errors import InputError
from railhil.index.query import answer, rows_of
from railhil.index.tables import SCHEMAS, Index, open_index


@pytest.fixture
def index(tmp_path: Path) -> Index:
    write_run(tmp_path / "a", "ipfc", scores={"stop_error_m": 0.3})
    write_run(tmp_path / "b", "pid", "FAIL", scores={"stop_error_m": 0.5, "comfort": 2.0})
    return open_index(tmp_path)


def test_runs_have_a_column_for_each_score(index: Index) -> None:
    found = answer(index, "select folder, stop_error_m, comfort from runs order by folder").to_pylist()
    assert found == [
        {"folder": "a", "stop_error_m": 0.3, "comfort": None}, {"folder": "b", "stop_error_m": 0.5, "comfort": 2.0},
    ]  # fmt: skip


def test_tables_go_together_by_the_folder(index: Index) -> None:
    statement = "select law, cause, time_s from runs join events using (folder) where law = 'pid' order by time_s"
    assert [row["cause"] for row in answer(index, statement).to_pylist()] == ["departed", "stopped"]


def test_every_table_is_there_without_the_stamps(index: Index) -> None:
    for name in SCHEMAS:
        assert "stamp" not in answer(index, f"select * from {name}").column_names


@pytest.mark.parametrize(
    "statement",
    [
        "select * from '{0}'", "select * from read_csv('{0}')", "attach '{0}.db'", "copy runs to '{0}.csv'",
        "set enable_external_access = true", "install httpfs", "select * from index", "select nothing from runs",
        "drop table runs", "", ";", "select",
    ],
)  # fmt: skip
def test_other_files_and_wrong_statements_are_refused_in_a_line(index: Index, tmp_path: Path, statement: str) -> None:
    path = tmp_path / "secret"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="railhil query: SQL: ") as refused:
        answer(index, statement.format(path))
    assert "\n" not in str(refused.value)
    assert {one.name for one in tmp_path.iterdir()} == {"a", "b", "secret", ".railhil-index"}


def test_columns_of_one_name_keep_their_values_apart(index: Index) -> None:
    found = rows_of(
        answer(index, "select a.folder, b.folder, 1 as folder_2 from runs a join runs b on a.folder < b.folder")
    )
    assert [[*row.values()] for row in found] == [["a", "b", 1]]
    assert len(found[0]) == 3


@pytest.mark.parametrize("value", ["timestamp '290000-01-01'", "'infinity'::timestamp", "date '0044-01-01 (BC)'"])
def test_an_instant_that_python_does_not_have_is_refused(index: Index, value: str) -> None:
    with pytest.raises(InputError, match="SQL"):
        rows_of(answer(index, f"select {value}"))
