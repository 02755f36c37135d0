"""The page of an index: what it shows is what the folders say, and nothing of them can be a program."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.browser import chromium_or_skip
from hil_tests.support.cli import Railhil
from hil_tests.support.run_folders import record_two_runs, write_run
from railhil.index import page as index_page
from railhil.index.curves import POINTS_MAX
from railhil.index.page import page, write_page
from railhil.index.tables import open_index

_EVIL = "</script><script>window.evil = 1</script>"


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    """Three versions of two laws, one with a requirement, and a folder whose texts are markup."""
    sentence = {"id": "ATO-5", "says": "x", "verdict": "kept", "margin": 0.25, "unit": "m"}
    for version in range(3):
        for law in ("ipfc", "pid"):
            name = f"2026110{version + 1}T000000Z-{law}"
            scores = {"stop_error_m": 0.1 * (version + 1), "energy_kj": 74000.0, "itae": 100.0}
            write_run(
                tmp_path / name, law, "FAIL" if law == "pid" else "PASS", version, scores,
                [sentence] if law == "ipfc" else (), railhil=f"0.{version}.0",
            )  # fmt: skip
    write_run(tmp_path / "evil", line=_EVIL, faults=[_EVIL], verdict="FAIL")
    return tmp_path


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with chromium_or_skip() as found:
        yield found


def _data(text: str) -> Any:
    return json.loads(re.findall(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[0])


def test_a_page_has_every_row_once_and_no_text_of_a_folder_is_a_program(runs: Path) -> None:
    text = page(open_index(runs), "")
    assert _EVIL not in text
    data = _data(text)
    column = data["columns"]["folder"]
    assert sorted(column["values"][at] for at in column["rows"]) == sorted(
        one.name for one in runs.iterdir() if one.name[0] != "."
    )
    error = data["scores"]["stop_error_m"]
    assert sorted({error["values"][at] for at in error["rows"]}) == pytest.approx([0.1, 0.2, 0.3])
    assert data["systems"]["ato"]["criteria"][0]["title"]


def test_a_page_elsewhere_leads_to_the_folders(runs: Path, tmp_path: Path) -> None:
    out = tmp_path / "evil" / "page.html"
    write_page(open_index(runs), out)
    assert _data(out.read_text())["links"] == "../"
    write_page(open_index(runs), runs / "index.html")
    assert _data((runs / "index.html").read_text())["links"] == ""


@pytest.mark.slow
def test_each_point_of_a_curve_is_a_row_of_the_record(here: Railhil, tmp_path: Path) -> None:
    record_two_runs(here, tmp_path)
    data = _data(page(open_index(tmp_path / "runs"), ""))
    assert set(data["curves"]) == {"0", "1"}
    for folder, curves in data["curves"].items():
        time_s, (label, unit, factor, speed) = curves["time_s"], curves["columns"]["true_speed_mps"]
        assert (label, unit, factor) == ("true speed", "km/h", 3.6)
        with (tmp_path / "runs" / folder / "signals.csv").open() as stream:
            rows = [(float(row["time_s"]), float(row["true_speed_mps"])) for row in csv.DictReader(stream)]
        assert 2 < len(time_s) <= POINTS_MAX
        assert set(zip(time_s, speed, strict=True)) <= set(rows)
    assert data["curves"]["0"]["time_s"] == data["curves"]["1"]["time_s"]
    header = (tmp_path / "runs" / "0" / "signals.csv").read_text().partition("\n")[0].split(",")
    assert ["time_s", *data["curves"]["0"]["columns"]] == header, "every signal can be compared"
    # Older runs have their speed only, and a page that is served asks for what it needs.
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(index_page, "SIGNALS_MAX", 1)
        curves = _data(page(open_index(tmp_path / "runs"), ""))["curves"]
        assert sorted(len(one["columns"]) for one in curves.values()) == [1, len(header) - 1]
    assert _data(page(open_index(tmp_path / "runs"), "", is_served=True))["curves"] == {}


@pytest.mark.slow
@pytest.mark.needs_browser
def test_two_runs_are_compared_in_any_signal_that_both_have(here: Railhil, chromium: Any, tmp_path: Path) -> None:
    record_two_runs(here, tmp_path)
    write_run(tmp_path / "runs" / "bare")
    out = tmp_path / "runs" / "index.html"
    write_page(open_index(tmp_path / "runs"), out)
    found = chromium.new_page(viewport={"width": 1200, "height": 900})
    found.goto(out.as_uri())
    for folder in "01":
        found.get_by_label(f"compare {folder}", exact=True).check()
    assert found.locator("#signal").input_value() == "true_speed_mps"
    for name in ("true_speed_mps", "true_position_m"):
        found.select_option("#signal", name)
        drawn = found.evaluate(
            "[...document.querySelectorAll('#curves .rc-chart')].map(one => railhilCharts.drawn(one))"
        )
        curves = _data(out.read_text())["curves"]
        factor, own = curves["0"]["columns"][name][2:]
        other = curves["1"]["columns"][name][3]
        assert drawn[0]["0"] == pytest.approx([factor * one for one in own])
        assert drawn[1]["difference"] == pytest.approx(
            [factor * (two - one) for one, two in zip(own, other, strict=True)]
        )
    found.get_by_label("compare bare").check()
    assert "no signal of both" in found.locator("#curves").inner_text()
    assert not found.locator("#signal").is_visible()


@pytest.mark.slow
@pytest.mark.needs_browser
def test_rows_are_filtered_sorted_grouped_and_compared(chromium: Any, runs: Path) -> None:
    out = runs / "index.html"
    write_page(open_index(runs), out)
    found = chromium.new_page(viewport={"width": 1200, "height": 900})
    errors: list[str] = []
    found.on("pageerror", lambda error: errors.append(str(error)))
    found.goto(out.as_uri())

    def folders() -> list[str]:
        return [text.strip() for text in found.locator("#rows td.folder").all_text_contents()]

    assert len(folders()) == 7
    found.select_option("#by-law", "pid")
    assert [one[-3:] for one in folders()] == ["pid"] * 3
    found.get_by_role("button", name="stop error").click()
    assert folders() == [f"2026110{number}T000000Z-pid" for number in (1, 2, 3)]
    found.get_by_role("button", name="stop error").click()
    assert folders()[0] == "20261103T000000Z-pid"
    found.select_option("#by-law", "*")
    found.select_option("#by-requirement", "ATO-5\n")
    assert [one[-4:] for one in folders()] == ["ipfc"] * 3
    found.select_option("#by-requirement", "*")
    found.fill("#search", "script pid")
    assert folders() == []
    found.fill("#search", "evil")
    assert folders() == ["evil"]
    assert found.evaluate("window.evil") is None
    found.fill("#search", "")
    found.select_option("#by-group", "verdict")
    cells = found.locator("#rows tbody tr").all_inner_texts()
    assert [one.split()[:2] for one in cells] == [["FAIL", "4"], ["PASS", "3"]]
    found.locator("#rows button", has_text="PASS").click()
    assert len(folders()) == 3
    for box in found.locator("#rows input").all()[:2]:
        box.check()
    text = found.locator("#compare table").inner_text()
    assert re.search(r"seed\s+2\s+1", text)
    assert re.search(r"stop error \(m\)\s+-0.3\d*\s+-0.2\d*\s+\+0.1", text)
    assert "ATO-5" not in text, "the margins are equal"
    # The medians of three versions of the law that is left.
    assert found.locator("#versions tbody tr").count() == 3
    found.select_option("#quantity", label="stop error")
    assert found.locator("#versions tbody tr").first.inner_text().split("\t")[-4:-1] == ["0.1", "0.1", "0.1"]
    assert found.locator("#trend canvas").count() == 1
    assert errors == []


@pytest.mark.slow
@pytest.mark.needs_browser
def test_everybody_can_read_the_page(chromium: Any, runs: Path) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="MISSING CAPABILITY axe").Axe()
    out = runs / "index.html"
    write_page(open_index(runs), out)
    for width_px, scheme in ((400, "dark"), (1200, "light")):
        context = chromium.new_context(
            color_scheme=scheme, viewport={"width": width_px, "height": 900}, bypass_csp=True
        )
        found = context.new_page()
        found.goto(out.as_uri())
        for box in found.locator("#rows input").all()[:2]:
            box.check()
        # Charts are made as wide as there is room, and fit when the page has been laid out.
        found.wait_for_function(f"document.documentElement.scrollWidth <= {width_px}")
        done = axe.run(found)
        assert done.violations_count == 0, (scheme, width_px, done.generate_report())
        context.close()


@pytest.mark.slow
@pytest.mark.needs_browser
def test_new_is_what_was_made_since_the_reader_looked(chromium: Any, runs: Path) -> None:
    out = runs / "index.html"
    write_page(open_index(runs), out)
    found = chromium.new_page()
    found.goto(out.as_uri())
    assert "since you looked" not in found.locator("#lead").inner_text()
    # An instant between the versions, as if the reader had looked then.
    found.evaluate("localStorage.setItem('railhil.index', Date.UTC(2026, 10, 2, 12) / 1000)")
    found.reload()
    assert "3 made since you looked at 2026-11-02 12:00" in found.locator("#lead").inner_text()
    found.select_option("#since", index=1)
    assert found.locator("#rows tbody tr").count() == 3
