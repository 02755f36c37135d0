"""The matrix of faults: the verdict first, each margin as a bar of its bound, tables of one system side by side."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.browser import asked
from railhil.common.errors import InputError
from railhil.judge.reactions.catalogue import Entry
from railhil.judge.reactions.evaluate import Row
from railhil.record.documents import FAULT_TABLE, read_fault_table
from railhil.record.hash_list import HASH_LIST, write_hash_list
from railhil.report.fault_matrix import report_of

ENTRY = Entry(
    id="T2b",
    title="burst of 20 speed telegrams lost",
    faults=("TRN_SPEED loss 100% @v>40km/h x20",),
    detected=("speed_age",),
    reaction="TRACTION CUT",
    at_most="TRACTION CUT",
    within_ms=70,
    ends="resumes",
)
KEPT = Row(ENTRY, 20.0, 20.01, "speed_age", 20.031, "TRACTION CUT", 20.066, "PASS", safe_s=20.3)
LATE = Row(ENTRY, 20.0, 20.01, "speed_age", 20.031, "TRACTION CUT", 20.15, "FAIL", ["TRACTION CUT after 140 ms, <70>"])
ABSENT = Row(ENTRY.model_copy(update={"id": "S3b"}), refused="the scenario has no balises")


def table(folder: Path, *rows: Row, **changed: Any) -> Path:
    """The folder of a table, with a folder for each run."""
    for row in rows:
        (folder / row.entry.id).mkdir(parents=True, exist_ok=True)
    by = {"system": "ato", "scenario": "yizhuang_05", "controller": "ipfc", "railhil": "1", "code_sha256": "0" * 64}
    folder.mkdir(exist_ok=True)
    document = {**by, **changed, "rows": [row.as_json() for row in rows]}
    (folder / FAULT_TABLE).write_text(json.dumps(document))
    return folder


def page(*folders: Path) -> str:
    report_of(folders, folders[0] / "report.html")
    return (folders[0] / "report.html").read_text(encoding="utf-8")


def test_a_row_is_the_same_after_it_was_written_and_read(tmp_path: Path) -> None:
    document = read_fault_table(table(tmp_path, KEPT, LATE, ABSENT))
    assert document is not None
    assert [Row.from_json(row) for row in document["rows"]] == [KEPT, LATE, ABSENT]


def test_the_verdict_comes_first_and_says_what_is_wrong(tmp_path: Path) -> None:
    text = page(table(tmp_path, KEPT, ABSENT))
    assert text.index('class="badge PASS"') < text.index("<table")
    assert "1 run, each as it must be; least margin 20% of its bound (T2b); without a run here: S3b" in text
    text = page(table(tmp_path, LATE))
    assert '<span class="badge FAIL">FAIL</span>' in text
    assert "1 run, not as it must be: T2b" in text
    assert "TRACTION CUT after 140 ms, &lt;70&gt;" in text
    assert 'class="badge INVALID"' in page(table(tmp_path, ABSENT))
    text = page(table(tmp_path, KEPT, entries=["T2b", "T3"]))
    assert 'class="badge INVALID"' in text
    assert "stopped before T3" in text


def test_the_bar_is_the_part_of_the_bound_that_was_used(tmp_path: Path) -> None:
    text = page(table(tmp_path, KEPT))
    assert 'class="used" y="1" width="80.0"' in text
    assert "56 of 70&nbsp;ms, margin&nbsp;14&nbsp;ms" in text
    assert 'class="over" y="1" width="100.0"' in page(table(tmp_path, LATE))


def test_a_reaction_at_its_bound_is_no_violation(tmp_path: Path) -> None:
    """The difference of the two times is 70.0000000000003 ms."""
    text = page(table(tmp_path, replace(KEPT, effective_s=23.85, reaction_s=23.92)))
    assert 'class="used" y="1" width="100.0"' in text
    assert "70 of 70&nbsp;ms, margin&nbsp;0&nbsp;ms" in text
    assert "least margin 0% of its bound" in text


def test_a_train_that_stood_before_the_fault_stands_from_before(tmp_path: Path) -> None:
    stands = ENTRY.model_copy(update={"ends": "standstill"})
    assert "the train stands from before" in page(table(tmp_path, replace(KEPT, entry=stands, safe_s=12.0)))
    assert "the train stands after 12.0 s" in page(table(tmp_path, replace(KEPT, entry=stands, safe_s=32.01)))


def test_each_entry_says_what_was_required_and_what_came(tmp_path: Path) -> None:
    text = page(table(tmp_path, KEPT, ABSENT))
    for words in (
        "TRN_SPEED loss 100% @v&gt;40km/h x20",
        "at&nbsp;20.00&nbsp;s, first effect 20.01&nbsp;s",
        "TRACTION CUT within 70 ms; the run goes on",
        'speed age <span class="second">after 21 ms</span>',
        "NORMAL again after 290 ms",
        '<a href="T2b">T2b</a>',
        "the scenario has no balises",
    ):
        assert words in text


def test_tables_of_one_system_stand_side_by_side(tmp_path: Path) -> None:
    folders = [
        table(tmp_path / "a", KEPT),
        table(tmp_path / "b", LATE, controller="tdmc"),
        table(tmp_path / "c", KEPT, system="stop"),
    ]
    text = page(*folders)
    assert text.count('id="beside-') == 1
    beside = text[text.index('id="beside-ato"') : text.index('<h2 id="table-1"')]
    assert "56 of 70 ms" in beside
    assert "140 ms, &lt;70&gt;" in beside
    assert beside.count("<td") == 2
    assert 'href="../b/T2b"' in text


def test_pairs_are_counted_by_their_places_and_a_broken_rule_has_its_command(tmp_path: Path) -> None:
    faults = ["TRN_SPEED loss 100% @20s", "sensor.speed stuck @21s"]
    kept = {"number": 7, "faults": faults, "verdict": "PASS", "failures": []}
    broken = kept | {"number": 8, "verdict": "FAIL", "failures": ["invariant 2: traction at SERVICE BRAKE"]}
    text = page(table(tmp_path, pairs=[kept, broken]))
    assert "2 random pairs of faults (1 FAIL, 1 PASS); 1 break a rule" in text
    assert 'class="badge FAIL"' in text
    assert "invariant 2: traction at SERVICE BRAKE" in text
    assert "--seed 8 &#39;--fault=TRN_SPEED loss 100% @20s&#39;" in text
    assert 'data-name="telegram">2 <span class="said">1</span>' in text


def test_a_table_without_the_demands_of_its_entries_is_refused_in_a_line(tmp_path: Path) -> None:
    folder = table(tmp_path, KEPT)
    document = json.loads((folder / FAULT_TABLE).read_text())
    del document["rows"][0]["demanded"]
    (folder / FAULT_TABLE).write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"rows.demanded: missing or damaged"):
        page(folder)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"system": None}, "system: found None, allowed a text"),
        ({"pairs": [{"number": 1, "faults": ["one"], "verdict": "PASS", "failures": []}]}, "pairs"),
    ],
)
def test_a_damaged_table_is_refused_in_a_line(tmp_path: Path, changed: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        page(table(tmp_path, KEPT, **changed))


def test_the_page_says_when_where_and_by_whom_its_runs_were_made(tmp_path: Path) -> None:
    recorded = {"utc": "2026-11-29T01:02:03Z", "host": "bench", "operator": "<me>"}
    text = page(table(tmp_path, KEPT, recorded=recorded, seed=3))
    assert (
        "Recorded 2026-11-29 01:02 UTC on bench by &lt;me&gt; with railhil 1. Seed 3, code sha256 000000000000" in text
    )


def test_a_row_names_the_sentences_that_its_run_has_decided(tmp_path: Path) -> None:
    text = page(table(tmp_path, replace(KEPT, requirements={"ATO-5": "kept", "ATO-6": "violated", "ATO-12": "kept"})))
    cell = text[text.index('data-name="required"') :].partition("</td>")[0]
    required = re.sub("<[^>]*>", "", cell)
    assert "ATO-5, ATO-12 kept" in required
    assert "ATO-6 violated" in required


def test_the_text_of_a_sentence_stands_once_below_the_table_with_its_entries(tmp_path: Path) -> None:
    says = "whenever fault, within 64 ms notch_command <= 0"
    late = replace(LATE, entry=ENTRY.model_copy(update={"id": "T3"}), requirements={"ATO-6": "violated"})
    rows = replace(KEPT, requirements={"ATO-6": "kept"}), late
    text = page(table(tmp_path, *rows, sentences={"ATO-6": says, "ATO-9": "never brake < 0 N"}))
    assert text.count("whenever fault, within 64 ms notch_command &lt;= 0") == 1
    below = re.sub("<[^>]*>", "", text[text.index('id="table-1-ATO-6"') :])
    assert "kept in 1 run" in below
    assert "violated in T3" in below
    assert text.count('href="#table-1-ATO-6"') == 2
    assert "ATO-9" not in text, "no run has decided it"


def test_an_edited_file_of_a_run_that_a_row_leads_to_is_said(tmp_path: Path) -> None:
    folder = table(tmp_path, KEPT, hash_list=HASH_LIST)
    (folder / "T2b" / "certificate.json").write_text("{}")
    (folder / "T2b" / "frames.log").write_text("one")
    write_hash_list(folder / "T2b")
    write_hash_list(folder)
    page(folder)
    (folder / "T2b" / "frames.log").write_text("two")
    with pytest.raises(InputError, match=r"T2b/frames\.log: sha256"):
        page(folder)


@pytest.mark.slow
@pytest.mark.needs_browser
@pytest.mark.parametrize("width_px", [400, 1200, 2560])
def test_the_page_fits_every_screen(tmp_path: Path, width_px: int) -> None:
    long = "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan"
    says = {"ATO-6": "whenever " + " and ".join(["age(TRN_SPEED) > 64 ms"] * 9) + ", within 64 ms notch_command <= 0"}
    decided = replace(KEPT, requirements={"ATO-6": "kept"})
    page(*(table(tmp_path / name, decided, LATE, ABSENT, scenario=long, sentences=says) for name in "ab"))
    wide = "({beyond: document.documentElement.scrollWidth - window.innerWidth})"
    assert asked(tmp_path / "a" / "report.html", wide, width_px)["beyond"] <= 0
