"""The part of report.html that is explored: its data, and what it does in a browser."""

from __future__ import annotations

import base64
import csv
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.browser import browser
from hil_tests.support.recordings import recorded_folder
from hil_tests.support.scores import with_values
from railhil.scenarios.load import load, load_any
from railhil.supervisor.ato import JUDGING
from railhil.supervisor.events.event import FAULT, LEVEL, LOST, RecordedEvent
from railhil.supervisor.report import page as report_page
from railhil.supervisor.report.distribution import shares, spreads_of, worst_first
from railhil.supervisor.report.explore import explored
from railhil.supervisor.report.page import write_report
from railhil.supervisor.report.recorded import RecordedRun
from railhil.supervisor.report.thinned import packed, seen_rows
from railhil.supervisor.shown import shown_columns
from railhil.supervisor.signals import write_signals

_EVENTS = (
    RecordedEvent(20.0, "TRN_SPEED", FAULT, "loss", until_s=22.0, detail="fault 1: TRN_SPEED loss </script><b>"),
    *(RecordedEvent(20.0 + 0.1 * number, "TRN_SPEED", LOST, "gap") for number in range(50)),
    RecordedEvent(21.0, "controller", LEVEL, "stale", level="hold", until_s=21.5, rank=1, detail="too old"),
)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RecordedRun:
    folder = tmp_path_factory.mktemp("explored") / "run"
    found = recorded_folder(load("yizhuang_05"), folder, seed=5)
    write_signals(found.scenario, found.trace, folder / "signals.csv", found.certificate.get("notes"))
    return replace(found, events=(*found.events, *_EVENTS))


@pytest.fixture(scope="module")
def table(run: RecordedRun, tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    path = tmp_path_factory.mktemp("signals") / "signals.csv"
    write_signals(run.scenario, run.trace, path, run.certificate.get("notes"))
    header, *rows = csv.reader(path.read_text(encoding="utf-8").splitlines())
    return dict(zip(header, np.array(rows, dtype=np.float64).T, strict=True))


def unpacked(curve: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Rows and values of a curve of the page."""
    steps = np.frombuffer(base64.b64decode(curve["r"]), f"<u{curve['w'] // 8}")
    return np.cumsum(steps.astype(np.int64)), np.frombuffer(base64.b64decode(curve["v"]), "<f4")


def test_a_thinned_curve_is_the_same_line() -> None:
    rng = np.random.default_rng(1)
    time = np.arange(20_000)
    wave = 30 * np.sin(time / 900) + rng.normal(0, 0.3, len(time))
    wave[7_777] = 55.0
    rows = seen_rows(wave, 500)
    assert len(rows) <= 2 * 500 + 2 + 500
    assert {0, len(wave) - 1, 7_777} <= set(rows.tolist())
    assert wave[rows].min() == pytest.approx(wave.min(), abs=0.02)
    smooth = 30 * np.sin(time / 900)
    rows = seen_rows(smooth, 500)
    assert len(rows) < 500
    assert np.abs(np.interp(time, rows, smooth[rows]) - smooth).max() < 0.05


def test_a_level_keeps_every_change_and_a_gap_stays_one() -> None:
    level = np.zeros(5_000)
    level[100:103], level[4_000:] = 2, 1
    rows = seen_rows(level, 50)
    np.testing.assert_array_equal(np.interp(np.arange(5_000), rows, level[rows]), level)
    wave = np.sin(np.arange(5_000) / 50.0)
    wave[2_000:2_500] = np.nan
    rows, values = unpacked(packed(seen_rows(wave, 100), wave))
    gap = (rows >= 2_000) & (rows < 2_500)
    assert gap.any()
    assert np.isnan(values[gap]).all()
    assert not np.isnan(values[~gap]).any()
    assert rows[~gap][rows[~gap] < 2_000].max() > 1_940
    level[:50] = np.nan
    rows, values = unpacked(packed(seen_rows(level, 50), level))
    assert np.isnan(values[rows < 50]).all()
    assert not np.isnan(values[rows >= 50]).any()


@pytest.mark.slow
@pytest.mark.parametrize("many", [1, 14])
def test_the_page_says_how_far_a_curve_is_from_its_line(
    run: RecordedRun, table: dict[str, np.ndarray], many: int
) -> None:
    """Whatever is thinned, and on pages with so many runs that little is left of each; a notch is exact."""
    found = json.loads(explored([run] * many))["runs"][-1]
    thin = 0
    for name, curve in found["signals"].items():
        expected = table["target_speed_mps"] - table["true_speed_mps"] if name == "tracking_error" else table[name]
        rows, values = unpacked(curve)
        line = np.interp(table["time_s"], table["time_s"][rows], values)
        off = float(np.nanmax(np.abs(line - expected)))
        rounding = 1e-6 * float(np.nanmax(np.abs(expected)))
        assert off <= curve["e"] + rounding
        assert curve["e"] <= 1.1 * off + rounding
        thin += curve["e"] > 2e-4 * float(np.ptp(expected[np.isfinite(expected)]))
    # What the page had promised of every curve.
    assert thin >= 2
    assert found["signals"]["notch_command"]["e"] < 1e-6


@pytest.mark.slow
def test_the_page_has_the_values_of_signals_csv(run: RecordedRun, table: dict[str, np.ndarray]) -> None:
    text = explored([run])
    document = json.loads(text)
    assert len(text) < 45_000
    assert text == explored([run])
    assert "<" not in text
    (found,) = document["runs"]
    assert found["time"] == {"start": 0.0, "step": 0.02, "n": len(table["time_s"])}
    assert {"true_speed_mps", "notch_command", "controller_level", "tracking_error"} <= set(found["signals"])
    for name, curve in found["signals"].items():
        expected = table["target_speed_mps"] - table["true_speed_mps"] if name == "tracking_error" else table[name]
        rows, values = unpacked(curve)
        np.testing.assert_allclose(values, expected[rows], rtol=1e-6, atol=1e-8)
    assert document["over"] == ["true_position_m"]
    assert document["first"][:4] == ["true_speed_mps", "target_speed_mps", "tracking_error", "notch_command"]
    assert "grade_permil" in document["first"]
    # Events that differ only in their instants are one mark.
    marks = [mark for mark in found["events"] if "gap" in mark[2]]
    assert [(mark[0], mark[1]) for mark in marks] == [(20.0, 24.9)]
    assert [mark[3] for mark in found["events"] if mark[2].startswith("fault 1")] == [True]
    assert found["signals"]["controller_level"].get("used")
    assert not found["signals"]["train_level"].get("used")


def test_columns_have_names_units_and_words(run: RecordedRun) -> None:
    shown = shown_columns(run.scenario, run.trace.contract, run.certificate.get("notes"))
    speed, level = shown.named("true_speed_mps"), shown.named("train_level")
    assert speed is not None
    assert (speed.label, speed.unit, speed.factor) == ("true speed", "km/h", 3.6)
    assert level is not None
    assert (level.kind, level.words[0]) == ("level", "normal")
    basis = shown.named("basis_in_use")
    assert basis is not None
    assert basis.words[3] == "step+wavelet"
    assert (shown.speed, shown.target, shown.command) == ("true_speed_mps", "target_speed_mps", "notch_command")
    high = shown_columns(load_any("emu3"))
    assert (high.speed, high.target, high.position, high.command) == (
        "true_speed_mps", "target_mps", "position_m", "command_mps2",
    )  # fmt: skip
    assert sum(column.kind == "level" for column in high.columns) == 3


@pytest.mark.slow
def test_above_twenty_runs_the_page_shows_distributions_and_links_the_worst(
    run: RecordedRun, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limits are lowered: drawing is what takes long."""
    monkeypatch.setattr(report_page, "RUNS_MAX", 3)
    monkeypatch.setattr(report_page, "_WORST", 1)
    runs = [
        replace(
            run, certificate={**run.certificate, "seed": seed}, score=with_values(run.score, stop_error_m=error),
            verdict="FAIL" if error is None or error > 0.3 else "PASS",
        )
        for seed, error in enumerate((0.1, 0.9, None, 0.2))
    ]  # fmt: skip
    folders = [tmp_path / f"run {seed}" for seed in range(4)]
    folders[2].mkdir()
    (folders[2] / "report.html").touch()
    write_report(runs, tmp_path / "report.html", (), folders)
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="distribution-data">(.*?)</script>', text)[1])
    stop = next(spread for spread in data["spreads"] if spread["title"] == "stop error")
    assert (stop["allowed"], stop["limits"]) == ("-0.3 to 0.3", [-0.3, 0.3])
    # The run that did not stop is at or below no value.
    (law,) = stop["laws"]
    assert law["y"][-1] == 75.0
    assert re.findall(r'<a href="([^"]*)">ipfc seed 2</a>', text) == ["run%202/report.html"]
    explored_runs = json.loads(re.search(r'id="explore-data">(.*?)</script>', text)[1])["runs"]
    assert [found["label"] for found in explored_runs] == ["ipfc seed 2"]
    assert worst_first(run.scenario, JUDGING.criteria, runs) == [2, 1, 3, 0]


def test_shares_of_runs() -> None:
    at, below = shares(np.array([3.0, 1.0, np.nan, 1.0]))
    assert (at.tolist(), below.tolist()) == ([1.0, 3.0], [50.0, 75.0])
    at, below = shares(np.arange(10_000.0), 300)
    assert len(at) <= 300
    assert (at[0], at[-1], below[-1]) == (0.0, 9_999.0, 100.0)
    assert shares(np.array([np.nan]))[0].size == 0


@pytest.fixture(scope="module")
def opened(run: RecordedRun, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Any, str, list[str]]]:
    """A browser, the address of a report of two runs, and what any page has asked for."""
    api = pytest.importorskip("playwright.sync_api", reason="MISSING CAPABILITY playwright")
    path = tmp_path_factory.mktemp("page") / "report.html"
    write_report([run, replace(run, label="other", certificate={**run.certificate, "controller": "tdmc"})], path)
    asked: list[str] = []
    with api.sync_playwright() as play:
        program = play.chromium.launch(executable_path=browser(), args=["--no-sandbox"])
        yield program, path.as_uri(), asked
        program.close()


def page_of(opened: tuple[Any, str, list[str]], width_px: int, **how: Any) -> Any:
    program, address, asked = opened
    page = program.new_page(viewport={"width": width_px, "height": 900}, **how)
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: asked.append(str(error)))
    page.goto(address)
    return page


@pytest.mark.slow
@pytest.mark.needs_browser
def test_zoom_values_choice_and_nothing_fetched(
    opened: tuple[Any, str, list[str]], table: dict[str, np.ndarray]
) -> None:
    page = page_of(opened, 1000)
    charts = page.evaluate("railhilReport.charts.map(chart => [chart.range(), chart.zoomed()])")
    assert all(chart == [[0, table["time_s"][-1]], False] for chart in charts)
    first = page.locator("#explore .u-over").first
    first.scroll_into_view_if_needed()
    box = first.bounding_box()
    # Hover: the value of signals.csv at the instant that the legend says.
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 40)
    said = page.locator("#explore .rc-chart").first.inner_text()
    time_s = float(re.search(r"time:?\s*([\d.]+) s", said)[1])
    mark, speed_kmh = re.search(r"ipfc:?\s*(≈?) ?([\d.]+)(?: ± [\d.]+)? km/h", said).groups()
    row = int(np.flatnonzero(np.isclose(table["time_s"], time_s))[0])
    # Between two points of the curve it is on the line between them, and says so.
    exact = table["true_speed_mps"][row] * 3.6
    assert float(speed_kmh) == pytest.approx(exact, rel=5e-4 if mark else 1e-6)
    at = page.evaluate("(() => { const {rows, values} = railhilReport.curve(railhilReport.data.runs[0],"
                              " 'true_speed_mps'); return rows[9]; })()")  # fmt: skip
    page.evaluate("time => railhilReport.charts[0].cursor(time)", table["time_s"][at])
    said = page.locator("#explore .rc-chart").first.inner_text()
    assert re.search(r"ipfc:?\s*([\d.]+) km/h", said)[1] == f"{table['true_speed_mps'][at] * 3.6:.7g}"
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 40)
    # Zoom by dragging: all charts together; double click shows everything.
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.75, box["y"] + 40, steps=3)
    page.mouse.up()
    end_s = table["time_s"][-1]
    for low, high in page.evaluate("railhilReport.charts.map(chart => chart.range())"):
        assert (low, high) == (pytest.approx(0.5 * end_s, rel=0.02), pytest.approx(0.75 * end_s, rel=0.02))
    page.mouse.dblclick(box["x"] + 100, box["y"] + 40)
    assert not any(page.evaluate("railhilReport.charts.map(chart => chart.zoomed())"))
    # New values leave a zoom of the reader alone, and are shown whole where there is none.
    stream = """([low, high]) => { const chart = railhilReport.charts[1];
      if (low < high) chart.zoom(low, high);
      chart.setData([[0, 50, 100, 150], [0, 1, NaN, 2]].concat(chart.plot.data.slice(2).map(() => [1, 1, 1, 1])));
      return chart.range(); }"""
    assert page.evaluate(stream, [10, 20]) == [10, 20]
    page.evaluate("railhilReport.charts[1].zoom()")
    assert page.evaluate(stream, [0, 0]) == [0, 150]
    page.reload()
    # The mark of the fault says what it is, as text.
    left = page.evaluate("railhilReport.charts[0].plot.valToPos(20, 'x')")
    page.mouse.move(box["x"] + left, box["y"] + 40)
    assert "fault 1: TRN_SPEED loss </script><b>" in page.locator("#explore .rc-tip").first.inner_text()
    # Another signal, one run less, over distance.
    before = page.locator("#explore .rc-chart").count()
    page.locator("#explore summary").click()
    page.get_by_label("basis functions", exact=True).check()
    assert page.locator("#explore .rc-chart").count() == before + 1
    page.get_by_label("other", exact=True).uncheck()
    assert "other" not in page.locator("#explore .charts").inner_text()
    page.locator("#explore-over").select_option("true_position_m")
    low, high = page.evaluate("railhilReport.charts[0].range()")
    assert (low, high) == (0, pytest.approx(table["true_position_m"][-1], rel=1e-6))
    page.close()
    assert opened[2] == [opened[1]] * len(opened[2])


@pytest.mark.slow
@pytest.mark.needs_browser
def test_narrow_dark_and_printed(opened: tuple[Any, str, list[str]]) -> None:
    page = page_of(opened, 400, color_scheme="dark")
    found = page.evaluate("""(() => {
      const smallest = Math.min(...[...document.querySelectorAll("body *")].filter(one => one.checkVisibility()
        && [...one.childNodes].some(node => node.nodeType === 3 && node.data.trim()) && one.tagName !== "SCRIPT")
        .map(one => one.closest("svg") ? parseFloat(getComputedStyle(one).fontSize) * one.closest("svg").clientWidth
          / one.closest("svg").viewBox.baseVal.width : parseFloat(getComputedStyle(one).fontSize)));
      const missed = document.querySelector("td.missed").getBoundingClientRect();
      return {beyond: document.documentElement.scrollWidth - innerWidth, smallest, missed: missed.right,
              paper: getComputedStyle(document.body).backgroundColor};
    })()""")
    assert found["beyond"] <= 0
    assert found["smallest"] >= 11
    assert found["missed"] <= 400
    assert found["paper"] == "rgb(22, 24, 28)"
    assert page.locator("#explore .rc-chart").first.is_visible()
    page.emulate_media(media="print")
    assert not page.locator("#explore").is_visible()
    assert page.locator("figure svg").first.is_visible()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    page.close()


def test_runs_of_a_law_with_other_parameters_or_arithmetic_are_distributions_of_their_own(run: RecordedRun) -> None:
    tuned = {"sha256": "1a2b3c4d" + "0" * 56, "training": {"seeds": [1]}}
    how = ({}, {"parameters": tuned}, {"arithmetic": "float64"}, {"perturbed": True})
    runs = [
        replace(run, certificate={**run.certificate, "seed": seed, **others}, score=with_values(run.score, itae=value))
        for value, others in enumerate(how)
        for seed in (1, 2)
    ]
    spreads, looks = spreads_of(run.scenario, JUDGING.criteria[:1], runs)
    labels = ["ipfc iq nominal", "ipfc+1a2b3c4d tuned", "ipfc float64", "ipfc iq perturbed"]
    assert list(spreads[0].values) == list(looks) == labels
    assert [len(values) for values in spreads[0].values.values()] == [2, 2, 2, 2]
    assert len(set(looks.values())) == 4
    # Those that differ in the seed alone are one.
    assert list(spreads_of(run.scenario, JUDGING.criteria[:1], runs[:2])[0][0].values) == ["ipfc"]
