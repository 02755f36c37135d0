"""The page of a run over a line in a browser: complete without a network, readable at each width in both schemes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.browser import TEXTS_OF_CHARTS, asked, chromium_or_skip
from hil_tests.support.line_record import ImaginedRun, record
from railhil.report.page import write_report
from railhil.scenarios.load import load_any
from railhil.systems.line.scenario.model import LineScenario

pytestmark = [pytest.mark.needs_browser, pytest.mark.slow]
#: Size of the page of a run of 35 minutes, bytes.
_SIZE_MAX = 5_000_000


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pages")
    out, short = load_any("yizhuang_out"), load_any("four_stops")
    assert isinstance(out, LineScenario)
    assert isinstance(short, LineScenario)
    long = ImaginedRun(out, late_s={2: 60.0}, error_m={5: -0.4})
    pair = [ImaginedRun(short), ImaginedRun(short, late_s={1: 20.0})]
    found = {"one": folder / "one.html", "two": folder / "two.html"}
    write_report([record(long, folder)], found["one"])
    write_report([record(run, folder, label=f"law {number}") for number, run in enumerate(pair)], found["two"])
    return found


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with chromium_or_skip() as found:
        yield found


@pytest.mark.long_after(1)
@pytest.mark.parametrize("name", ["one", "two"])
def test_no_text_lies_on_another_and_nothing_is_fetched(pages: dict[str, Path], name: str) -> None:
    found = asked(pages[name], TEXTS_OF_CHARTS)
    assert (found["overlaps"], found["outside"], found["fetched"], found["beyond"]) == ([], [], [], 0)
    assert found["texts"] > 100


@pytest.mark.long_after(1)
@pytest.mark.parametrize("name", ["one", "two"])
def test_everybody_can_read_the_page(pages: dict[str, Path], chromium: Any, name: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="MISSING CAPABILITY axe").Axe()
    for width_px, scheme in ((400, "dark"), (1200, "light")):
        page = chromium.new_page(color_scheme=scheme, viewport={"width": width_px, "height": 900})
        page.goto(pages[name].as_uri())
        assert page.evaluate("document.documentElement.scrollWidth") <= width_px
        found = axe.run(page)
        assert found.violations_count == 0, (scheme, width_px, found.generate_report())
        page.close()


def test_a_zoom_moves_the_named_lines_and_shows_names_that_had_no_room(pages: dict[str, Path], chromium: Any) -> None:
    page = chromium.new_page(viewport={"width": 1200, "height": 900})
    page.goto(pages["one"].as_uri())
    chart = "railhilFigures.charts.find(one => one.plot.querySelector('.across'))"
    assert page.evaluate(f"{chart}.view.zoom(5900, 6700)") is None
    places = page.evaluate(f"[...{chart}.plot.querySelectorAll('.across')].map(one => [Number(one.dataset.at), "
                           "Number(one.getAttribute('transform').match(/[-\\d.]+/)[0])])")  # fmt: skip
    width_px = page.evaluate(f"{chart}.box[2]")
    for at_m, x_px in places:
        assert x_px == pytest.approx((at_m - 5900) / 800 * width_px, abs=0.1)
    inside = [at_m for at_m, _ in places if 5900 <= at_m <= 6700]
    assert inside == [6272.0]


@pytest.mark.long
def test_the_page_of_a_long_run_is_small(pages: dict[str, Path]) -> None:
    text = pages["one"].read_text(encoding="utf-8")
    assert len(text) < _SIZE_MAX
    for said in ("no conformity is claimed", "not the real timetable", "no other trains"):
        assert said in text
