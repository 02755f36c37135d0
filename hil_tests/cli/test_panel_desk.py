"""The panel's tiles, curves and instants in Chromium, by real clicks and keys."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.browser import chromium_or_skip
from hil_tests.support.cli import railhil
from hil_tests.support.panel_page import WAIT_MS, said, started
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of
from railhil.wire.ato import SimTruth

pytestmark = [pytest.mark.needs_browser, pytest.mark.slow]
#: The first screen of an operator, px.
_SMALL = {"width": 1200, "height": 800}
_TILES = "[...document.querySelectorAll('.grid-stack-item')].map(one => one.getAttribute('gs-id'))"


def until(page: Any, expression: str) -> None:
    """Wait until an expression of the page is true; the page itself may evaluate no texts."""
    deadline_s = time.monotonic() + WAIT_MS / 1000
    while not page.evaluate(expression):
        assert time.monotonic() < deadline_s, expression
        page.wait_for_timeout(50)


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with chromium_or_skip() as found:
        yield found


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("desk")
    (folder / "short.toml").write_text(RUN_72M_TOML, encoding="utf-8")
    railhil("run", folder / "short.toml", "--bus", "local", "--no-report", "--out", folder / "run")
    return folder / "run"


@pytest.fixture(scope="module")
def address(recorded: Path) -> Iterator[str]:
    with started(recorded.parent / "said.txt", "panel", recorded, "--port", "0") as (_, found):
        yield found


@pytest.fixture
def page(chromium: Any, address: str) -> Iterator[Any]:
    """A page of the recorded run with all its rows, in a browser that keeps nothing; it must end without an error."""
    context = chromium.new_context(viewport=_SMALL)
    found, errors = context.new_page(), []
    found.on("pageerror", lambda error: errors.append(str(error)))
    found.on("console", lambda line: errors.append(line.text) if line.type == "error" else None)
    found.goto(address)
    until(found, "window.stats().kept[0] > 10")
    yield found
    context.close()
    assert errors == []


def test_the_first_curve_is_in_sight_and_the_speed_is_the_largest_number(page: Any) -> None:
    line = page.locator("#line canvas").first.bounding_box()
    assert line["y"] + line["height"] <= _SMALL["height"]
    assert line["height"] >= 250
    sizes = page.evaluate(
        "[...document.querySelectorAll('#values b')].map(one => parseFloat(getComputedStyle(one).fontSize))"
    )
    assert max(sizes) == sizes[0] > 1.5 * sorted(sizes)[-2]
    assert page.locator("#values .value").first.get_attribute("data-column") == "true_speed_mps"
    page.evaluate("scrollTo(0, document.body.scrollHeight)")
    assert page.locator("#instant").bounding_box()["y"] < 300


def test_on_a_large_screen_the_curves_take_it(page: Any) -> None:
    page.set_viewport_size({"width": 2560, "height": 1440})
    # The charts follow the size one after the other.
    until(page, "document.querySelector('#line canvas').clientWidth > 1500")
    until(page, "document.querySelector('#line canvas').clientHeight > 400")
    assert page.evaluate("document.documentElement.scrollWidth") <= 2560


def test_every_drawn_speed_is_one_of_the_record(page: Any, recorded: Path) -> None:
    trace = trace_of(read_log(recorded / "frames.log"), wire_contract())
    position_m, speed_kmh = trace.values(SimTruth.PORT, "TruePos"), trace.values(SimTruth.PORT, "TrueSpeed") * 3.6
    drawn = page.evaluate(
        "(() => { const all = railhilCharts.drawn(document.querySelector('#line .rc-chart')), y = all['true speed']; "
        "return all.position.map((at, n) => [at, y[n]]).filter(([, value]) => value != null); })()"
    )
    assert len(drawn) > 100
    known = np.stack((position_m, speed_kmh), axis=1)
    for point in drawn:
        # The page has numbers of single precision.
        assert np.min(np.max(np.abs(known - point), axis=1)) < 1e-4, point


def test_the_stop_is_told_to_a_centimetre_as_the_score_has_it(page: Any, recorded: Path) -> None:
    error_m = json.loads((recorded / "score.json").read_text(encoding="utf-8"))["signed"]["stop_error_m"]
    told = said(page, "[data-column=to_go]", "cm")
    assert told.split("\n")[0] == f"{round(abs(error_m) * 100)} cm"
    assert told.split("\n")[1].startswith("stopped past" if error_m > 0 else "short of")
    page.locator("#instant").focus()
    page.keyboard.press("Home")
    said(page, "[data-column=to_go]", r"7[12]\.\d m")


def test_arrow_keys_go_from_sample_to_sample(page: Any, recorded: Path) -> None:
    times_s = trace_of(read_log(recorded / "frames.log"), wire_contract()).times_s(SimTruth.PORT)
    page.locator("#instant").focus()
    page.keyboard.press("Home")
    page.locator("body").press("ArrowRight")
    assert said(page, "#at", r"\d s") == f"{times_s[1]:.2f} s"
    for _ in range(5):
        page.locator("body").press("ArrowRight")
    assert page.inner_text("#at") == f"{times_s[6]:.2f} s"
    page.keyboard.press("Shift+ArrowLeft")
    assert float(page.inner_text("#at").split()[0]) == 0.0


def test_no_number_is_cut_off(page: Any) -> None:
    until(page, "document.querySelector('[data-column=true_speed_mps]') !== null")
    # A text of five characters in each place, as "10.50" has.
    page.evaluate(
        "document.querySelectorAll('.value b span:not(.words)').forEach(one => { one.textContent = '10.50'; })"
    )
    for width in (400, 1200, 2560):
        page.set_viewport_size({"width": width, "height": 800})
        cut = "[...document.querySelectorAll('.value b')].filter(one => one.scrollWidth > one.clientWidth)"
        assert page.evaluate(f"{cut}.map(one => one.textContent)") == []


LEGEND = "[...document.querySelectorAll('[gs-id=\"%s\"] .u-series')].map(one => one.innerText.replace(/\\s+/g, ' '))"


def test_without_a_cursor_the_legend_has_the_values_of_now_or_of_the_chosen_instant(page: Any) -> None:
    until(page, f"{LEGEND % 'command'}.length > 1 && !{LEGEND % 'command'}.some(one => one.endsWith('-'))")
    last = page.evaluate(LEGEND % "command")
    page.evaluate("location.hash = '#t=10'")
    said(page, "#at", r"10\.00 s")
    place_m = float(page.inner_text("[data-column=true_position_m] b").split()[0])
    until(page, f"Math.abs({LEGEND % 'line'}[0].match(/[\\d.]+/)[0] - {place_m}) < 0.006")
    assert not [text for text in page.evaluate(LEGEND % "line") if text.endswith("-")]
    chosen = page.evaluate(LEGEND % "command")
    assert chosen != last
    # A cursor comes and goes.
    page.hover("[gs-id=command] .u-over", position={"x": 200, "y": 40})
    until(page, f"{LEGEND % 'command'}.join() !== {json.dumps(','.join(chosen))}")
    page.hover("#title")
    until(page, f"{LEGEND % 'command'}.join() === {json.dumps(','.join(chosen))}")


def test_on_paper_are_all_tiles_with_their_curves(page: Any, tmp_path: Path) -> None:
    page.emulate_media(color_scheme="dark")
    drawn = (
        "[...document.querySelectorAll('.rc-chart')].map(one => "
        "Object.values(railhilCharts.drawn(one)).reduce((most, y) => Math.max(most, y.length), 0))"
    )
    assert 0 in page.evaluate(drawn)
    page.pdf(path=tmp_path / "page.pdf", format="A4")
    assert 0 not in page.evaluate(drawn)
    page.emulate_media(media="print")
    boxes = page.evaluate(
        "[...document.querySelectorAll('.grid-stack-item')].map(one => one.getBoundingClientRect())"
        ".map(({left, top, right, bottom}) => [left, top, right, bottom])"
    )
    for number, one in enumerate(boxes):
        for other in boxes[:number]:
            across = min(one[2], other[2]) - max(one[0], other[0])
            down = min(one[3], other[3]) - max(one[1], other[1])
            assert across < 1 or down < 1, (one, other)
    cut = "one.scrollHeight > one.clientHeight + 1 && getComputedStyle(one).overflowY !== 'visible'"
    assert page.evaluate(f"[...document.querySelectorAll('.tile > *')].filter(one => {cut}).length") == 0


def test_beyond_the_end_of_a_run_there_is_no_instant(page: Any) -> None:
    end_s = page.inner_text("#at")
    page.evaluate("location.hash = '#t=99999'")
    until(page, "location.hash === '#t=99999'")
    page.wait_for_timeout(200)
    assert page.inner_text("#at") == end_s


def test_a_tile_is_dragged_hidden_kept_and_taken_to_another_browser(page: Any, chromium: Any, address: str) -> None:
    assert page.evaluate(_TILES)[0] == "line"
    box = page.locator("[gs-id=line] .handle h2").bounding_box()
    page.mouse.move(box["x"] + 5, box["y"] + 5)
    page.mouse.down()
    page.mouse.move(box["x"] + 450, box["y"] + 10, steps=8)
    page.mouse.up()
    page.wait_for_selector("[gs-id=line][gs-x='4']", timeout=WAIT_MS)
    page.click("button[aria-label='hide values']")
    page.reload()
    page.wait_for_selector("[gs-id=line][gs-x='4']", timeout=WAIT_MS)
    assert "values" not in page.evaluate(_TILES)
    page.click("#arrange summary")
    page.fill("[data-desk=own]", "mine")
    page.click("[data-desk=save]")
    with page.expect_download() as download:
        page.click("[data-desk=export]")
    path = download.value.path()
    assert json.loads(path.read_text(encoding="utf-8"))["hidden"] == ["values"]
    other = chromium.new_page(viewport=_SMALL)
    other.goto(address)
    other.wait_for_selector("[gs-id=line]", timeout=WAIT_MS)
    assert "values" in other.evaluate(_TILES)
    other.click("#arrange summary")
    bad = path.with_name("bad.json")
    bad.write_text('{"form": "another"}', encoding="utf-8")
    other.set_input_files("[data-desk=load]", bad)
    said(other, "[data-desk=said]", 'found form "another", allowed a file of the button')
    other.set_input_files("[data-desk=load]", path)
    other.wait_for_selector("[gs-id=line][gs-x='4']", timeout=WAIT_MS)
    assert "values" not in other.evaluate(_TILES)
    assert other.input_value("[data-desk=name]") == "mine"
    other.close()
    # As shipped again.
    page.select_option("[data-desk=name]", "drive")
    page.click("[data-desk=reset]")
    page.wait_for_selector("[gs-id=line][gs-x='0'], [gs-id=line]:not([gs-x])", timeout=WAIT_MS)


def test_a_tile_is_moved_and_sized_with_keys(page: Any) -> None:
    page.locator("[gs-id='command'] button").focus()
    page.keyboard.press("Alt+Shift+ArrowDown")
    page.wait_for_selector("[gs-id=command][gs-h='7']", timeout=WAIT_MS)


@pytest.mark.long
def test_everybody_can_read_the_page(page: Any) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="MISSING CAPABILITY axe").Axe()
    for width_px, scheme in ((400, "dark"), (1200, "light"), (2560, "dark")):
        page.set_viewport_size({"width": width_px, "height": 900})
        page.emulate_media(color_scheme=scheme)
        until(page, "document.documentElement.scrollWidth <= innerWidth")
        found = axe.run(page)
        assert found.violations_count == 0, (scheme, width_px, found.generate_report())


@pytest.mark.long
@pytest.mark.parametrize("scenario", ["lvshun_tieshan", "four_stops", "hst", "emu3", "yizhuang_stop"])
def test_a_page_without_a_row_can_be_seen_over_distance_and_in_another_scheme(
    chromium: Any, tmp_path: Path, scenario: str
) -> None:
    page, errors = chromium.new_page(viewport=_SMALL), []
    page.on("pageerror", lambda error: errors.append(str(error)))
    (tmp_path / "live").mkdir()
    (tmp_path / "live/frames.log").touch()
    words = ["panel", scenario, "--follow", tmp_path / "live", "--port", "0"]
    with started(tmp_path / "said.txt", *words) as (_, found):
        page.goto(found)
        page.wait_for_selector("#line canvas", timeout=WAIT_MS)
        for button in ("#axis", "#theme", "#whole", "#axis"):
            page.click(button)
        page.locator("#instant").press("ArrowRight")
        assert page.inner_text("[data-column=true_speed_mps] b").startswith("–")
        page.wait_for_timeout(300)
    page.close()
    assert errors == []


@pytest.mark.long
def test_two_runs_have_their_lamps_and_their_curves(chromium: Any, recorded: Path, tmp_path: Path) -> None:
    page, errors = chromium.new_page(viewport=_SMALL), []
    page.on("pageerror", lambda error: errors.append(str(error)))
    with started(tmp_path / "said.txt", "panel", recorded, recorded, "--port", "0") as (_, found):
        page.goto(found)
        until(page, "window.stats().kept.length == 2 && window.stats().kept[1] > 10")
        said(page, ".lamps:nth-child(2) .lamp:nth-of-type(2)", "●")
        for _ in range(2):
            page.click("#axis")
        assert page.locator(".lamps").count() == 2
    page.close()
    assert errors == []
