"""The index of a directory: what it reads of each kind of folder, and when it reads again."""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from hil_tests.support.run_folders import write_run
from railhil.common.errors import InputError
from railhil.index.find import INDEX, find_folders
from railhil.index.show import Row, all_rows
from railhil.index.tables import open_index
from railhil.record.hash_list import write_hash_list

_REACTION = {
    "begun_s": 1.0, "effective_s": 1.5, "detected_by": "", "detected_s": None, "reaction": "NORMAL", "reaction_s": None,
    "verdict": "PASS", "failures": [], "refused": "",
}  # fmt: skip


def _rows(root: Path) -> dict[str, Row]:
    return {row["folder"]: row for row in all_rows(open_index(root))}


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    """Two runs, one of them in a folder of its own."""
    write_run(tmp_path / "one")
    write_run(tmp_path / "deep" / "er" / "two", "tpfc1", "FAIL", seed=7, faults=["speed stuck @60s for 2s"])
    return tmp_path


def test_each_run_has_its_facts_and_its_scores(runs: Path) -> None:
    found = _rows(runs)
    assert list(found) == ["one", "deep/er/two"] or list(found) == ["deep/er/two", "one"]
    two = found["deep/er/two"]
    assert (two["kind"], two["law"], two["seed"], two["verdict"]) == ("run", "tpfc1", 7, "FAIL")
    assert (two["stop_error_m"], two["signed_stop_error_m"]) == (0.1, -0.1)
    assert two["faults"] == ["speed stuck @60s for 2s"]
    assert two["line"].startswith("stop error")
    assert open_index(runs).tables["events"].num_rows == 4


def test_only_what_has_changed_is_read_again(runs: Path) -> None:
    assert open_index(runs).new == {"one", "deep/er/two"}
    assert open_index(runs).new == frozenset()
    write_run(runs / "three", verdict="INVALID")
    shutil.rmtree(runs / "one")
    index = open_index(runs)
    assert index.new == {"three"}
    assert set(index.tables["folders"]["folder"].to_pylist()) == {"three", "deep/er/two"}
    assert set(index.tables["events"]["folder"].to_pylist()) == {"three", "deep/er/two"}
    write_run(runs / "three", verdict="FAIL")
    assert open_index(runs).new == {"three"}
    assert _rows(runs)["three"]["verdict"] == "FAIL"


def test_the_index_is_the_same_whether_it_was_kept_or_made_again(runs: Path) -> None:
    open_index(runs)
    write_run(runs / "three", scores={"stop_error_m": 0.2, "comfort": 1.5})
    kept, again = open_index(runs), open_index(runs, again=True)
    for name, table in again.tables.items():
        assert sorted(map(str, table.to_pylist())) == sorted(
            map(str, kept.tables[name].select(table.column_names).to_pylist())
        )
        assert set(kept.tables[name].column_names) == set(table.column_names)


@pytest.mark.parametrize("damage", ["cut", "gone", "other"])
def test_a_damaged_index_is_made_again(runs: Path, damage: str) -> None:
    wanted = _rows(runs)
    table = runs / INDEX / "runs.parquet"
    if damage == "cut":
        table.write_bytes(table.read_bytes()[:100])
    elif damage == "gone":
        table.unlink()
    else:
        # That of another directory.
        other = runs / "other"
        write_run(other / "x")
        open_index(other)
        shutil.copy(other / INDEX / "runs.parquet", table)
        shutil.rmtree(other)
    found = _rows(runs)
    assert [row | {"is_new": True} for row in found.values()] == list(wanted.values())


def test_an_edited_document_has_no_result(runs: Path) -> None:
    for name, folder in (("certificate.json", "one"), ("score.json", "deep/er/two")):
        path = runs / folder / name
        path.write_text(path.read_text().replace("FAIL", "PASS").replace('"seed": 0', '"seed": 1'))
    found = _rows(runs)
    for name, folder in (("certificate.json", "one"), ("score.json", "deep/er/two")):
        assert name in found[folder]["problem"]
        assert "a file that nobody changed" in found[folder]["problem"]
        assert found[folder]["verdict"] is None
        assert "stop_error_m" not in found[folder] or found[folder]["stop_error_m"] is None


def test_a_run_that_did_not_end_and_a_damaged_one_are_told(runs: Path) -> None:
    (runs / "killed").mkdir()
    (runs / "killed" / "frames.log").write_text("")
    (runs / "one" / "certificate.json").write_text("{")
    found = _rows(runs)
    assert found["killed"]["problem"].startswith("did not come to its end")
    assert "cannot be read" in found["one"]["problem"]
    assert found["deep/er/two"]["problem"] == ""


@pytest.mark.parametrize(
    "text", ["[]", "{}", '{"hunt": []}', '{"hunt": {}, "scenario": 3}', '{"rows": 1, "runs": 2, "first": 3}']
)
@pytest.mark.parametrize("document", ["hunt.json", "campaign.json", "sequence.json", "faults.json", "compare.json"])
def test_a_document_with_other_keys_ends_no_index(runs: Path, document: str, text: str) -> None:
    (runs / "odd").mkdir()
    (runs / "odd" / document).write_text(text)
    found = _rows(runs)
    assert len(found) == 3
    assert found["odd"]["verdict"] in (None, "INVALID")


def test_studies_say_their_result_in_a_line(runs: Path) -> None:
    for name, document in {
        "compare": {"scenario": "s", "seed": 3, "runs": [
            {"folder": "a", "label": "ipfc", "verdict": "PASS"}, {"folder": "b", "label": "pid", "verdict": "FAIL"}]},
        "sequence": {
            "first": {"scenario": "s", "controller": "ilc_stop", "seed": 0}, "runs": 4, "made": [{"verdict": "PASS"}]},
        "faults": {"scenario": "s", "controller": "ipfc", "rows": [
            _REACTION | {"entry": "S1", "margin_ms": 12.5},
            _REACTION | {"entry": "S2", "verdict": "FAIL", "failures": ["late"]}]},
        "hunt": {"hunt": {"scenario": "s", "law": "ipfc"}},
        "dossier": {"written": {"railhil": "1.0"}, "headline": "1 requirement: 1 shown."},
    }.items():  # fmt: skip
        (runs / name).mkdir()
        (runs / name / f"{name}.json").write_text(json.dumps(document))
    summary = {
        "runs": 9,
        "requirements": [{"id": "A-1", "verdict": "violated", "margin": -0.2}, {"id": "A-2", "verdict": "kept"}],
    }
    (runs / "hunt" / "summary.json").write_text(json.dumps(summary))
    found = _rows(runs)
    assert (found["compare"]["verdict"], found["compare"]["line"]) == ("FAIL", "ipfc PASS, pid FAIL")
    assert (found["sequence"]["verdict"], found["sequence"]["line"]) == ("PASS", "1 of 4 runs")
    assert (found["faults"]["verdict"], found["faults"]["line"]) == ("FAIL", "2 entries, not as they must be: S2")
    assert (found["dossier"]["version"], found["dossier"]["line"]) == ("1.0", "1 requirement: 1 shown.")
    assert found["hunt"]["line"] == "9 runs, violated: A-1"
    assert found["hunt"]["requirement"] == {"A-1": "violated", "A-2": "kept"}
    assert open_index(runs).tables["reactions"]["margin_ms"].to_pylist() == [12.5, None]


def test_the_instant_is_that_of_the_name_else_that_of_the_document(tmp_path: Path) -> None:
    write_run(tmp_path / "20261128T164714Z-lvshun_tieshan-ipfc")
    os.utime(write_run(tmp_path / "mine") / "certificate.json", (0, 1_000_000_000))
    made = {one.folder: one.made.isoformat() for one in find_folders(tmp_path)[0]}
    assert made["20261128T164714Z-lvshun_tieshan-ipfc"] == "2026-11-28T16:47:14+00:00"
    assert made["mine"] == "2001-09-09T01:46:40+00:00"


def test_a_date_in_the_certificate_comes_first(tmp_path: Path) -> None:
    recorded = {"utc": "2026-11-05T06:07:08Z", "host": "bench-1", "operator": "ann"}
    write_run(tmp_path / "20261128T164714Z-a", recorded=recorded)
    (row,) = _rows(tmp_path).values()
    assert row["made"].isoformat() == "2026-11-05T06:07:08+00:00"
    assert (row["host"], row["operator"]) == ("bench-1", "ann")


def test_a_run_folder_itself_is_a_directory_of_one(runs: Path) -> None:
    assert list(_rows(runs / "one")) == ["."]


def test_a_directory_that_is_not_there_is_refused_and_nothing_is_made(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist, expected a directory with run folders"):
        open_index(tmp_path / "nowhere")
    assert not list(tmp_path.iterdir())


def test_a_directory_that_cannot_be_written_has_an_index_all_the_same(runs: Path) -> None:
    (runs / INDEX).write_text("")
    index = open_index(runs)
    assert len(index.new) == 2
    assert any("not kept" in one for one in index.remarks)


def test_links_are_not_followed(runs: Path) -> None:
    (runs / "loop").symlink_to(runs)
    assert len(_rows(runs)) == 2


def test_an_edit_that_keeps_size_and_date_of_a_document_is_seen(runs: Path) -> None:
    open_index(runs)
    path = runs / "one" / "score.json"
    before = path.stat()
    path.write_text(path.read_text().replace("0.1", "0.2", 1))
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert "a file that nobody changed" in _rows(runs)["one"]["problem"]


def test_a_score_without_a_line_in_the_list_has_no_result(runs: Path) -> None:
    path = runs / "one" / "SHA256SUMS"
    path.write_text("".join(line for line in path.read_text().splitlines(keepends=True) if "score.json" not in line))
    found = _rows(runs)["one"]
    assert "has no line of score.json" in found["problem"]
    assert found["verdict"] is None


@pytest.mark.parametrize(
    ("document", "key", "value"),
    [("certificate.json", "seed", 10**30), ("certificate.json", "command", "\ud800"), ("score.json", "why", [7]),
     ("score.json", "requirements", [{"id": "A", "says": "x", "verdict": "kept", "margin": 10**400}]),
     ("certificate.json", "recorded", {"utc": "0001-01-01T00:00:00+14:00", "host": "", "operator": ""})],
)  # fmt: skip
def test_a_value_that_no_column_holds_ends_no_index(runs: Path, document: str, key: str, value: object) -> None:
    path = runs / "one" / document
    path.write_text(json.dumps(json.loads(path.read_text()) | {key: value}))
    write_hash_list(runs / "one")
    found = _rows(runs)
    assert "other keys or values" in found["one"]["problem"]
    assert found["one"]["verdict"] is None
    assert found["deep/er/two"]["verdict"] == "FAIL"


def test_no_score_stands_for_a_fact(runs: Path) -> None:
    write_run(runs / "one", scores={"folder": 1.0, "seed": 2.0, "stop_error_m": 0.1})
    assert (_rows(runs)["one"]["seed"], _rows(runs)["one"]["stop_error_m"]) == (0, 0.1)


def test_names_and_links_that_cannot_be_read_hide_no_other_folder(runs: Path) -> None:
    (runs / "report.html").symlink_to("nowhere")
    write_run(runs / "bad")
    os.rename(os.fsencode(runs / "bad"), os.fsencode(runs) + b"/bad\xff")
    write_run(runs / 'a\nb<script>"%s ü')
    index = open_index(runs)
    assert {row["folder"] for row in all_rows(index)} == {"one", "deep/er/two", 'a\nb<script>"%s ü'}
    assert any("bad\\udcff is left out" in said for said in index.remarks)
    assert any("report.html cannot be read" in said for said in index.remarks)


def test_folders_may_be_nested_deeper_than_calls(runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    depth = sys.getrecursionlimit() + 100
    with monkeypatch.context() as moved:
        moved.chdir(runs)
        for _ in range(depth):
            os.mkdir("n")
            os.chdir("n")
        try:
            assert len(find_folders(runs)[0]) == 2
        finally:
            # Neither shutil nor pytest removes what is nested so deep.
            for _ in range(depth):
                os.chdir("..")
                os.rmdir("n")


@pytest.mark.parametrize(
    ("changed", "verdict", "said"),
    [
        ({"entries": ["S1"]}, "PASS", "1 entry, all as they must be"),
        ({"entries": ["S1", "S2"]}, "INVALID", "stopped before S2"),
        ({"rows": [], "pairs": [{"number": 1, "faults": ["a", "b"], "verdict": "FAIL", "failures": ["x"]}]}, "FAIL",
         "1 random pair, 1 break a rule"),
    ],
)  # fmt: skip
def test_a_table_of_faults_that_was_stopped_or_whose_pairs_break_a_rule_is_no_pass(
    tmp_path: Path, changed: dict[str, object], verdict: str, said: str
) -> None:
    (tmp_path / "faults").mkdir()
    row = _REACTION | {"entry": "S1"}
    (tmp_path / "faults" / "faults.json").write_text(json.dumps({"scenario": "s", "rows": [row]} | changed))
    found = _rows(tmp_path)["faults"]
    assert found["verdict"] == verdict
    assert said in found["line"]


@pytest.mark.parametrize(
    ("name", "document"),
    [
        ("faults.json", {"rows": [_REACTION | {"entry": "S1"}]}),
        ("compare.json", {"runs": [{"label": "ipfc", "verdict": "PASS", "folder": "ipfc"}]}),
        ("sequence.json", {"first": {}, "made": [], "runs": 2}),
        ("campaign.json", {"campaign": {}, "scenario": {}}),
    ],
)
def test_a_document_is_dated_by_what_it_records(tmp_path: Path, name: str, document: dict[str, object]) -> None:
    (tmp_path / "some").mkdir()
    recorded = {"utc": "2026-11-29T01:02:03Z", "host": "bench", "operator": "me"}
    (tmp_path / "some" / name).write_text(json.dumps({"scenario": "s", "recorded": recorded} | document))
    found = _rows(tmp_path)["some"]
    assert (found["made"].isoformat(), found["dated_by"]) == ("2026-11-29T01:02:03+00:00", "certificate")


@pytest.mark.parametrize("name", ["certificate.json", "score.json", "SHA256SUMS", ""])
def test_a_folder_that_is_removed_while_it_is_read_is_left_out_or_said(runs: Path, name: str) -> None:
    """Without a name the whole folder."""

    def remove(done: int, total: int) -> None:
        if done == 0 and name:
            (runs / "one" / name).unlink(missing_ok=True)
        elif done == 0:
            shutil.rmtree(runs / "one")

    index = open_index(runs, progress=remove)
    found = {row["folder"]: row for row in all_rows(index)}
    assert found["deep/er/two"]["problem"] == ""
    if name:
        assert found["one"]["problem"]
        assert index.remarks == []
    else:
        assert "one" not in found
        assert index.remarks == [f"{runs / 'one'} is left out: it was removed while it was read"]


@pytest.mark.parametrize("kind", ["faults", "compare", "certificate", "sequence", "hunt"])
def test_a_document_that_is_gone_when_it_is_read_is_said(tmp_path: Path, kind: str) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / f"{kind}.json").write_text("{}")
    index = open_index(tmp_path, progress=lambda *_: (tmp_path / "one" / f"{kind}.json").unlink())
    (row,) = all_rows(index)
    assert f"{kind}.json" in row["problem"]
    assert "does not exist" in row["problem"]


def test_a_changed_byte_in_the_rows_of_a_kept_index_is_seen(runs: Path) -> None:
    wanted = [row | {"is_new": False} for row in _rows(runs).values()]
    table = runs / INDEX / "folders.parquet"
    good = table.read_bytes()
    with pq.ParquetFile(table) as file:
        group = file.metadata.row_group(0)
        columns = [group.column(place) for place in range(group.num_columns)]
        pages = [at for one in columns for at in (one.data_page_offset + one.total_compressed_size // 2,)]
    for at in pages:
        table.write_bytes(good[:at] + bytes([good[at] ^ 1]) + good[at + 1 :])
        assert [row | {"is_new": False} for row in _rows(runs).values()] == wanted
