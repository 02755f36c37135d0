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
    for folder, (time_s, speed) in data["curves"].items():
        with (tmp_path / "runs" / folder / "signals.csv").open() as stream:
            rows = [(float(row["time_s"]), float(row["true_speed_mps"])) for row in csv.DictReader(stream)]
        assert 2 < len(time_s) <= POINTS_MAX
        assert set(zip(time_s, speed, strict=True)) <= set(rows)
    assert data["curves"]["0"][0] == data["curves"]["1"][0]
    # As it was kept.
    assert _data(page(open_index(tmp_path / "runs"), ""))["curves"] == data["curves"]


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
    for width_px, scheme in ((400, "dark"), (1200, "light"), (2560, "dark")):
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
