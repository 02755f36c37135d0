"""The figures of report.html: their data, and what they do in a browser."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.browser import chromium_or_skip
from hil_tests.support.recordings import recorded_folder
from hil_tests.support.scores import with_values
from hil_tests.support.svg_paths import path_points
from railhil.charts.curve_points import pick_rows
from railhil.judge.events.event import FAULT, LEVEL, LOST, RecordedEvent
from railhil.judge.record import Record
from railhil.judge.signals import write_signals
from railhil.report import page as report_page
from railhil.report.display_columns import shown_columns
from railhil.report.distribution import shares, spreads_of, worst_first
from railhil.report.page import page, write_report
from railhil.scenarios.load import load, load_any
from railhil.systems.ato.judge.judging import JUDGING

_EVENTS = (
    RecordedEvent(20.0, "TRN_SPEED", FAULT, "loss", until_s=22.0, detail="fault 1: TRN_SPEED loss </script><b>"),
    *(RecordedEvent(20.0 + 0.1 * number, "TRN_SPEED", LOST, "gap") for number in range(50)),
    RecordedEvent(21.0, "controller", LEVEL, "stale", level="hold", until_s=21.5, rank=1, detail="too old"),
)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Record:
    folder = tmp_path_factory.mktemp("explored") / "run"
    found = recorded_folder(load("yizhuang_05"), folder, seed=5)
    write_signals(found.scenario, found.trace, folder / "signals.csv", found.certificate.get("notes"))
    return found.copy_with(events=(*found.events, *_EVENTS))


@pytest.fixture(scope="module")
def table(run: Record, tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    path = tmp_path_factory.mktemp("signals") / "signals.csv"
    write_signals(run.scenario, run.trace, path, run.certificate.get("notes"))
    header, *rows = csv.reader(path.read_text(encoding="utf-8").splitlines())
    return dict(zip(header, np.array(rows, dtype=np.float64).T, strict=True))


def chart_of(text: str, column: str) -> tuple[np.ndarray, np.ndarray, dict[str, str]]:
    """Points of the path of a column in a page, and its other attributes."""
    found = re.findall(rf'<path class="curve[^>]*data-column="{column}"[^>]*>', text)
    assert len(found) == 1, column
    given = dict(re.findall(r'([a-z-]+)="([^"]*)"', found[0]))
    return *path_points(given["d"]), given | {"step": "data-step" in found[0]}


def test_a_thinned_curve_is_the_same_line() -> None:
    rng = np.random.default_rng(1)
    time = np.arange(20_000)
    wave = 30 * np.sin(time / 900) + rng.normal(0, 0.3, len(time))
    wave[7_777] = 55.0
    rows = pick_rows(wave, 500)
    assert len(rows) <= 2 * 500 + 2 + 500
    assert {0, len(wave) - 1, 7_777} <= set(rows.tolist())
    assert wave[rows].min() == pytest.approx(wave.min(), abs=0.02)
    smooth = 30 * np.sin(time / 900)
    rows = pick_rows(smooth, 500)
    assert len(rows) < 500
    assert np.abs(np.interp(time, rows, smooth[rows]) - smooth).max() < 0.05


def test_a_level_keeps_every_change_and_a_gap_stays_one() -> None:
    level = np.zeros(5_000)
    level[100:103], level[4_000:] = 2, 1
    rows = pick_rows(level, 50)
    np.testing.assert_array_equal(np.interp(np.arange(5_000), rows, level[rows]), level)
    wave = np.sin(np.arange(5_000) / 50.0)
    wave[2_000:2_500] = np.nan
    rows = pick_rows(wave, 100)
    gap = (rows >= 2_000) & (rows < 2_500)
    assert gap.any()
    assert np.isnan(wave[rows[gap]]).all()
    assert not np.isnan(wave[rows[~gap]]).any()
    assert rows[~gap][rows[~gap] < 2_000].max() > 1_940
    level[:50] = np.nan
    rows = pick_rows(level, 50)
    assert np.isnan(level[rows[rows < 50]]).all()
    assert not np.isnan(level[rows[rows >= 50]]).any()


@pytest.mark.slow
def test_each_curve_is_drawn_once_with_the_values_of_signals_csv(run: Record, table: dict[str, np.ndarray]) -> None:
    """The points of a path are rows of the table; what lies between two is as far from the line as the path says."""
    text = page([run])
    assert text == page([run])
    shown = shown_columns(run.scenario, run.trace.contract, run.certificate.get("notes"))
    thinned = 0
    for column in shown.columns:
        if not np.nan_to_num(table[column.name]).any() and column.kind == "note":
            continue
        expected = table[column.name] * column.factor
        if column.name == "brake_n":
            expected = -expected
        if column.kind == "level":
            continue
        if column.name == "basis_in_use":
            expected = np.searchsorted(np.unique(expected[np.isfinite(expected)]), expected).astype(float)
        x, y, given = chart_of(text, column.name)
        known = np.isfinite(y)
        at = np.interp(x[known], table["time_s"], np.arange(len(expected)))
        on_row = np.abs(at - at.round()) < 1e-3
        if not given["step"]:
            assert on_row.all(), column.name
            np.testing.assert_allclose(y[known], expected[at.round().astype(int)], rtol=1e-6, atol=1e-6)
            off = np.nanmax(np.abs(np.interp(table["time_s"], x[known], y[known]) - expected))
            assert off <= float(given.get("data-within", 0)) * 1.1 + 1e-5 * np.nanmax(np.abs(expected)) + 1e-6
            thinned += len(x) < len(expected) / 4
    assert thinned >= 3
    assert {"data-over", "data-label"} <= set(re.findall(r"data-[a-z]+", text))


@pytest.mark.slow
def test_faults_and_events_are_marks_and_levels_have_words(run: Record) -> None:
    text = page([run])
    figure = text[text.index('<figure id="reactions">') :]
    figure = figure[: figure.index("</figure>")]
    faults = re.findall(r'<path class="fault"[^>]*>(?:<title>(.*?)</title>)?', figure)
    # A band over the speed, and a bar in the row of the faults.
    assert len(faults) == 2
    assert all("TRN_SPEED loss &lt;/script&gt;&lt;b&gt;" in said for said in faults)
    assert figure.count('<path class="event"') >= 50
    assert ">normal</text>" in figure
    # A reader who does not see the chart is told what it shows, and from where to where.
    labels = re.findall(r'role="img" aria-label="([^"]*)"', text)
    assert len(labels) == text.count('<div class="chart"')
    assert any("Speed over distance" in said and "limit, target, ipfc" in said and "distance (m) 0 to" in said
               for said in labels) or any("speed (km/h)" in said for said in labels)  # fmt: skip


def test_columns_have_names_units_and_words(run: Record) -> None:
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
    run: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limits are lowered: drawing is what takes long."""
    monkeypatch.setattr(report_page, "RUNS_MAX", 3)
    monkeypatch.setattr(report_page, "_WORST", 1)
    folders = [tmp_path / f"run {seed}" for seed in range(4)]
    runs = [
        run.copy_with(
            log=folders[seed] / "frames.log",
            certificate={**run.certificate, "seed": seed},
            score=replace(
                with_values(run.score, stop_error_m=error), verdict="FAIL" if error is None or error > 0.3 else "PASS"
            ),
        )
        for seed, error in enumerate((0.1, 0.9, None, 0.2))
    ]  # fmt: skip
    folders[2].mkdir()
    (folders[2] / "report.html").touch()
    write_report(runs, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    figure = text[text.index('<figure id="distributions">') :]
    stop = next(part for part in figure.split('<div class="chart"') if ">stop error (m)<" in part)
    assert "allowed -0.3 to 0.3 m" in stop
    assert stop.count('<path class="line"') == 2
    # The run that did not stop is at or below no value.
    _, below = path_points(re.search(r'<path class="curve"[^>]* data-step="" d="([^"]*)"', stop)[1])
    assert np.nanmax(below) == 75.0
    assert re.findall(r'<a href="([^"]*)">ipfc seed 2</a>', text) == ["run%202/report.html"]
    assert re.search(r'data-runs="([^"]*)"', text)[1] == "[&#34;ipfc seed 2&#34;]"
    assert worst_first(run.scenario, JUDGING.criteria, runs) == [2, 1, 3, 0]


def test_shares_of_runs() -> None:
    at, below = shares(np.array([3.0, 1.0, np.nan, 1.0]))
    assert (at.tolist(), below.tolist()) == ([1.0, 3.0], [50.0, 75.0])
    at, below = shares(np.arange(10_000.0), 300)
    assert len(at) <= 300
    assert (at[0], at[-1], below[-1]) == (0.0, 9_999.0, 100.0)
    assert shares(np.array([np.nan]))[0].size == 0


@pytest.fixture(scope="module")
def opened(run: Record, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Any, str, list[str]]]:
    """A browser, the address of a report of two runs, and what any page has asked for."""
    path = tmp_path_factory.mktemp("page") / "report.html"
    write_report([run, run.copy_with(label="other", certificate={**run.certificate, "controller": "tdmc"})], path)
    asked: list[str] = []
    with chromium_or_skip() as program:
        yield program, path.as_uri(), asked


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
    times = "railhilFigures.charts.filter(chart => chart.sync === 'time (s)')"
    assert not any(page.evaluate(f"{times}.map(chart => chart.zoomed)"))
    chart = page.locator("#reactions-1 .chart").first
    plot = chart.locator(".plot")
    plot.scroll_into_view_if_needed()
    box = chart.locator(".axes").bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + 60)
    # Hover: the values of signals.csv at the instant that the chart says, in every chart over time.
    page.mouse.move(*middle)
    said = chart.inner_text()
    at_s = float(re.search(r"at ([\d.]+)", said)[1])
    mark, speed_kmh = re.search(r"ipfc\s*(≈?) ?([\d.]+)", said).groups()
    exact = np.interp(at_s, table["time_s"], table["true_speed_mps"]) * 3.6
    assert float(speed_kmh) == pytest.approx(exact, rel=5e-4 if mark else 1e-6)
    assert "at " in page.locator("#error .chart").first.inner_text()
    # Zoom by dragging: all charts together; double click shows everything.
    page.mouse.down()
    page.mouse.move(middle[0] + box["width"] / 5, middle[1], steps=3)
    page.mouse.up()
    ranges = page.evaluate(f"{times}.map(chart => chart.x)")
    low, high = ranges[0]
    assert 0 < low < high < table["time_s"][-1]
    assert all(one == [pytest.approx(low), pytest.approx(high)] for one in ranges)
    page.mouse.dblclick(*middle)
    assert not any(page.evaluate(f"{times}.map(chart => chart.zoomed)"))
    # Keys, and the buttons.
    chart.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("+")
    assert all(page.evaluate(f"{times}.map(chart => chart.zoomed)"))
    page.get_by_role("button", name="everything").click()
    assert not any(page.evaluate("railhilFigures.charts.map(chart => chart.zoomed)"))
    # The mark of the fault says what it is, as text.
    assert "fault 1: TRN_SPEED loss </script><b>" in page.locator("#reactions-1 .fault title").first.text_content()
    # A curve, a run less; over distance, and back.
    key = chart.locator(".key").first
    key.click()
    assert chart.locator("path.curve.off").count() >= 1
    key.click()
    page.get_by_label("other", exact=True).uncheck()
    assert page.locator('.plot .curve[data-run="1"]:visible').count() == 0
    before = page.evaluate(f"{times}[0].curves[0].path.getAttribute('d')")
    page.locator("#over").select_option("true_position_m")
    low, high = page.evaluate(f"{times}[0].x")
    assert (low, high) == (0, pytest.approx(table["true_position_m"][-1], rel=1e-6))
    page.locator("#over").select_option("")
    assert page.evaluate(f"{times}[0].curves[0].path.getAttribute('d')") == before
    page.close()
    assert opened[2] == [opened[1]] * len(opened[2])


@pytest.mark.slow
@pytest.mark.needs_browser
def test_the_script_draws_the_axes_as_they_are_written(opened: tuple[Any, str, list[str]]) -> None:
    page = page_of(opened, 1000)
    texts = "[...document.querySelectorAll('.axes text')].map(one => one.textContent)"
    written = page.evaluate(texts)
    page.evaluate("railhilFigures.charts.forEach(one => one.draw())")
    assert len(written) > 50
    assert page.evaluate(texts) == written
    page.close()


@pytest.mark.slow
@pytest.mark.needs_browser
def test_without_scripts_the_curves_are_there(opened: tuple[Any, str, list[str]]) -> None:
    program, address, _ = opened
    context = program.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(address)
    assert page.locator("#speed .plot .curve").nth(1).is_visible()
    assert not page.locator("#figures .bar").is_visible()
    assert "Scripts are off" in page.locator("#figures").inner_text()
    context.close()


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.needs_browser
def test_narrow_dark_and_printed(opened: tuple[Any, str, list[str]]) -> None:
    page = page_of(opened, 400, color_scheme="dark")
    found = page.evaluate("""(() => {
      const smallest = Math.min(...[...document.querySelectorAll("body *")].filter(one => one.checkVisibility()
        && [...one.childNodes].some(node => node.nodeType === 3 && node.data.trim()) && one.tagName !== "SCRIPT"
        && one.tagName !== "title").map(one => one.closest(".chart > svg")
          ? parseFloat(getComputedStyle(one).fontSize) * one.closest(".chart > svg").getBoundingClientRect().width
          / one.closest(".chart > svg").viewBox.baseVal.width : parseFloat(getComputedStyle(one).fontSize)));
      const missed = document.querySelector("td.missed").getBoundingClientRect();
      return {beyond: document.documentElement.scrollWidth - innerWidth, smallest, missed: missed.right,
              paper: getComputedStyle(document.body).backgroundColor};
    })()""")
    assert found["beyond"] <= 0
    assert found["smallest"] >= 11
    assert found["missed"] <= 400
    assert found["paper"] == "rgb(22, 24, 28)"
    stroke = "getComputedStyle(document.querySelector('#error .plot .curve')).stroke"
    assert page.evaluate(stroke) == "rgb(79, 176, 236)"
    page.emulate_media(media="print")
    assert not page.locator("#figures .bar").is_visible()
    assert page.locator("#speed .plot .curve").nth(1).is_visible()
    assert page.evaluate(stroke) == "rgb(0, 114, 178)"
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    page.close()


@pytest.mark.long
@pytest.mark.slow
def test_runs_of_a_law_with_other_parameters_or_arithmetic_are_distributions_of_their_own(run: Record) -> None:
    tuned = {"sha256": "1a2b3c4d" + "0" * 56, "training": {"seeds": [1]}}
    how = ({}, {"parameters": tuned}, {"arithmetic": "float64"}, {"perturbed": True})
    runs = [
        run.copy_with(certificate={**run.certificate, "seed": seed, **others}, score=with_values(run.score, itae=value))
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
