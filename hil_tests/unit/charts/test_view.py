"""A chart of the panel and a figure of a page do the same for a reader: range, cursor and values are of one program."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.browser import chromium_or_skip
from railhil.charts import static_text
from railhil.charts.figure import Chart, Curve, Figure
from railhil.charts.svg import markup

pytestmark = [pytest.mark.slow, pytest.mark.needs_browser]

_X = np.array([0.0, 10.0, 20.0, 40.0, 70.0, 100.0])
_Y = np.array([0.0, 3.0, 1.0, 5.0, 2.0, 4.0])
_COMMON = """
const views = [], own = railhilView.View;
railhilView.View = class extends own { constructor(drawing) { super(drawing); views.push(this); } };
window.picked = [];
"""
_STREAM = f"""
const inside = document.querySelector("main");
const data = [{_X.tolist()}, {_Y.tolist()}];
for (const height of [200, 120]) railhilCharts.chart(inside,
  {{x: {{label: "time", unit: "s"}}, height, sync: "both", series: [{{label: "one", unit: "m"}}]}}, data);
inside.querySelector(".u-over").addEventListener("click", event => picked.push(event.offsetX));
"""
_CLICKS = "document.querySelector('.chart > svg').onclick = event => picked.push(event.offsetX)"


def _page(kind: str) -> str:
    styles = static_text("charts.css") + static_text("uPlot.min.css" if kind == "stream" else "figures.css")
    scripts = [static_text("view.js"), _COMMON]
    body = ""
    if kind == "stream":
        scripts += [static_text("uPlot.iife.min.js"), static_text("charts.js"), _STREAM]
    else:
        curve = Curve("one", _X, _Y, unit="m")
        charts = [Chart([curve], "time (s)", sync="both"), Chart([curve], "time (s)", sync="both", height_px=90)]
        body = markup(Figure("f", "Figure", "", charts))
        scripts += [static_text("figures.js"), _CLICKS]
    text = "\n".join(scripts)
    return f"<!doctype html><style>{styles}</style><main style='width:900px'>{body}</main><script>{text}</script>"


@pytest.fixture(params=["stream", "figure"])
def page(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Any]:
    path = tmp_path / "page.html"
    path.write_text(_page(request.param), encoding="utf-8")
    with chromium_or_skip() as program:
        found = program.new_page(viewport={"width": 1000, "height": 700})
        errors: list[str] = []
        found.on("pageerror", lambda error: errors.append(str(error)))
        found.goto(path.as_uri())
        yield found
        assert errors == []


def _frame(page: Any) -> tuple[float, float, float]:
    """Left edge, width and a height inside the axes of the first chart."""
    left, width = page.evaluate("(f => [f.left, f.width])(views[0].drawing.frame())")
    box = page.evaluate("(b => [b.top, b.height])(views[0].drawing.surface.getBoundingClientRect())")
    return left, width, box[0] + 0.4 * box[1]


def _ranges(page: Any) -> list[list[float]]:
    found: list[list[float]] = page.evaluate("views.map(view => [...view.drawing.range()])")
    return found


def _said(page: Any) -> str:
    return str(page.evaluate("document.querySelector('.keys, .u-legend').innerText")).replace("\n", " ")


def test_a_drag_shows_that_range_in_every_chart_of_the_word_and_is_no_click(page: Any) -> None:
    left, width, y = _frame(page)
    page.mouse.move(left + 0.2 * width, y)
    page.mouse.down()
    page.mouse.move(left + 0.6 * width, y, steps=3)
    page.mouse.up()
    assert _ranges(page) == [pytest.approx([20.0, 60.0], abs=0.3)] * 2
    assert page.evaluate("picked") == []
    page.mouse.click(left + 0.5 * width, y)
    assert len(page.evaluate("picked")) == 1
    page.mouse.dblclick(left + 0.5 * width, y)
    assert _ranges(page) == [[0.0, 100.0]] * 2


def test_the_cursor_takes_the_sample_near_the_pointer_and_says_what_lies_between(page: Any) -> None:
    left, width, y = _frame(page)
    page.mouse.move(left + 0.202 * width, y)
    assert "1 m" in _said(page)
    assert "≈" not in _said(page)
    assert page.evaluate("views.map(view => view.at)") == [20.0, 20.0]
    page.mouse.move(left + 0.2 * width, y + 2000)
    assert "1 m" not in _said(page)


def test_arrows_go_from_sample_to_sample_and_keys_change_the_range(page: Any) -> None:
    page.evaluate("views[0].cursor(20)")
    page.evaluate("views[0].drawing.element.focus()")
    places = []
    for key in ("ArrowRight", "ArrowRight", "ArrowLeft", "ArrowLeft", "ArrowLeft", "ArrowLeft", "ArrowLeft"):
        page.keyboard.press(key)
        places.append(page.evaluate("views[1].at"))
    assert places == [40.0, 70.0, 40.0, 20.0, 10.0, 0.0, 0.0]
    page.evaluate("views[0].cursor(40)")
    page.keyboard.press("+")
    assert _ranges(page) == [pytest.approx([20.0, 70.0])] * 2
    page.keyboard.press("Shift+ArrowRight")
    assert _ranges(page) == [pytest.approx([25.0, 75.0])] * 2
    for _ in range(9):
        page.keyboard.press("Shift+ArrowRight")
    # At the end it stays as wide.
    assert _ranges(page) == [pytest.approx([50.0, 100.0])] * 2
    page.keyboard.press("0")
    assert _ranges(page) == [[0.0, 100.0]] * 2


def test_the_wheel_zooms_around_the_pointer_only_with_ctrl(page: Any) -> None:
    left, width, y = _frame(page)
    page.mouse.move(left + 0.5 * width, y)
    page.mouse.wheel(0, -100)
    assert _ranges(page)[0] == [0.0, 100.0]
    page.keyboard.down("Control")
    page.mouse.wheel(0, -100)
    page.keyboard.up("Control")
    page.wait_for_function("views[0].drawing.range()[0] > 0")
    assert _ranges(page)[0] == pytest.approx([10.0, 90.0], abs=0.5)
