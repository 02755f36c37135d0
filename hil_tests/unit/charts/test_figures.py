"""A figure as data is the same on a page and in a file, and a page's markup is what a browser and a reader need."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.svg_paths import path_points
from railhil.charts.figure import TARGET, TIME, ZERO, Area, Band, Chart, Curve, Figure, Look, Point, extent, ticks
from railhil.charts.svg import markup
from railhil.report.pictures import printed, sheet

_NUMBERS = st.floats(-1e6, 1e6)


def path_of(chart: Chart) -> str:
    (d,) = re.findall(r'<path class="curve[^>]* d="(M[^"]*)"/></g>', markup(Figure("f", "", "", [chart])))
    return str(d)


@given(_NUMBERS, st.floats(1e-3, 1e6), st.integers(2, 12))
def test_ticks_are_round_inside_and_as_many_as_allowed(low: float, span: float, most: int) -> None:
    found, decimals = ticks(low, low + span, most)
    step = 10.0**-decimals
    assert len(found) <= most + 1
    for at in found:
        assert low - 1e-6 * span <= at <= low + span * (1 + 1e-6)
        assert at / step == pytest.approx(round(at / step), abs=1e-6 * max(1.0, abs(at / step)))
    assert len({f"{at:.{decimals}f}" for at in found}) == len(found)


@given(st.lists(st.one_of(st.just(float("nan")), st.integers(-3, 3).map(float)), min_size=2, max_size=60))
def test_a_step_holds_each_value_until_the_next(values: list[float]) -> None:
    y = np.array(values)
    if np.isnan(y).all():
        return
    x, found = path_points(path_of(Chart([Curve("c", np.arange(float(len(y))), y, is_step=True)], TIME)))
    for row in range(len(y) - 1):
        # Between two instants the value of the first.
        known = np.isfinite(found[:-1]) & np.isfinite(found[1:])
        inside = np.flatnonzero((x[:-1] < row + 0.5) & (x[1:] > row + 0.5) & known)
        assert [found[place + 1] for place in inside] == ([] if np.isnan(y[row]) else [y[row]])


def test_what_a_chart_shows_is_in_its_markup() -> None:
    x = np.linspace(0.0, 100.0, 50)
    chart = Chart(
        [Curve("a <b> & 'c'", x, np.sqrt(x), unit="m"), Curve("wanted", x, x / 10, TARGET)],
        TIME,
        "place (m)",
        areas=[ZERO, Area((20.0, 30.0), None, "fault", "fault <1>")],
        points=[Point("there", 50.0, 5.0, Look("1", marker="s"))],
        y_names={0.0: "none", 5.0: "half"},
        sync=TIME,
    )
    text = markup(Figure("f", "Title", "", [chart]))
    tree = ET.fromstring(f"<p>{text}</p>")
    svg = next(one for one in tree.iter("svg") if one.get("role") == "img")
    for said in ("Title", "a <b> & 'c'", "wanted", "place (m)", "time (s) 0 to 100"):
        assert said in str(svg.get("aria-label"))
    titles = [one.text for one in tree.iter("title")]
    assert titles == ["fault <1>", "there"]
    assert {"none", "half", "time (s)"} <= {one.text for one in tree.iter("text")}
    keys = ["".join(one.itertext()) for one in tree.iter("span") if one.get("class") == "key"]
    assert keys == ["a <b> & 'c'", "wanted", "there"]


@pytest.mark.slow
def test_the_printed_legend_has_the_marker_of_a_point_without_a_line() -> None:
    x = np.linspace(0.0, 100.0, 50)
    points = [Point("there", 50.0, 5.0, Look("1", marker="s")), Point("line", 20.0, 3.0, Look("0", marker="o"))]
    drawn = sheet(Figure("f", "Title", "", [Chart([Curve("line", x, x)], TIME, "place (m)", points=points)]))
    handles = {one.get_label(): one for one in drawn.axes[0].get_legend().legend_handles}
    assert handles["there"].get_markersize() > 0
    assert handles["line"].get_markersize() == 0


def test_a_logarithmic_chart_has_decades_and_drops_what_it_cannot_show() -> None:
    counts = np.array([1.0, 0.0, 100.0, 100.0])
    chart = Chart([Curve("c", np.array([0.1, 1.0, 10.0, 100.0]), counts, is_step=True, is_filled=True)], "ms", "n",
                  y_bounds=(0.7, None), is_log=True)  # fmt: skip
    x, y = path_points(path_of(chart))
    assert (x[0], x[-1]) == (-1.0, 2.0)
    assert y.max() == 2.0
    assert y[0] == y[-1] < np.log10(0.7)
    text = markup(Figure("f", "", "", [chart]))
    assert all(f">{label}</text>" in text for label in ("0.1", "1", "10", "100"))


def test_files_have_the_same_charts_as_pages() -> None:
    x = np.arange(10.0)
    charts = [
        Chart([Curve("one", x, x)], "", "y", sync="s"),
        Chart([Curve("two", x, -x)], TIME, "z", sync="s", share=0.5),
        Chart([Curve("two", x, -x)], TIME, "z", (2.0, 4.0), share=0.5),
    ]
    figure = Figure("f", "Title", "Caption.", charts)
    axes = sheet(figure).axes
    assert [one.get_ylabel() for one in axes] == ["y", "z", "z"]
    assert axes[2].get_xlim() == extent(charts[2], "x") == (2.0, 4.0)
    for one, chart in zip(axes, charts, strict=True):
        np.testing.assert_array_equal(np.asarray(one.get_lines()[0].get_ydata()), chart.curves[0].y)
        assert one.get_ylim() == pytest.approx(extent(chart, "y"))
    (picture,) = printed([figure])
    assert (picture.name, picture.title, picture.caption) == ("f", "Title", "Caption.")
    assert ">two<" in picture.svg
    assert ">one<" in picture.svg


def test_bands_bars_and_named_lines_are_in_the_markup_and_in_files() -> None:
    x = np.arange(6.0)
    gap = np.where(x == 3.0, np.nan, x)
    chart = Chart(
        [Curve("one", x, x)],
        TIME,
        "y",
        areas=[
            Area((1.0, 2.0), (0.0, 1.0), "block", "first", label="open", colour="2"),
            Area((4.0, 5.0), (0.0, 1.0), "block", "second", label="open", colour="2"),
        ],
        bands=[Band("between", x, gap, x + 1.0, Look("6")), Band("wide", x, x, x, Look("0"), x_high=x + 0.5)],
        x_lines={0.0: "First <stop>", 0.01: "too near", 5.0: "", 4.0: "Last"},
        points=[Point("run", 2.0, 2.0, Look("1", marker="o"), text="at the stop")],
    )
    figure = Figure("f", "Title", "", [chart])
    tree = ET.fromstring(f"<p>{markup(figure)}</p>")
    keys = ["".join(one.itertext()) for one in tree.iter("span") if one.get("class") == "key"]
    assert keys == ["one", "open", "between", "wide", "run"]
    assert [one.text for one in tree.iter("title")] == ["first", "second", "at the stop"]
    bands = [one.get("d") or "" for one in tree.iter("path") if one.get("class") == "band"]
    between, wide = (d for d in bands if d != "M4 2H26V12H4Z")
    # Two pieces, each along the lower line and back along the upper one.
    assert between == "M0 0 1 1 2 2 2 3 1 2 0 1ZM4 4 5 5 5 6 4 5Z"
    assert wide == "M0 0 1 1 2 2 3 3 4 4 5 5 5.5 5 4.5 4 3.5 3 2.5 2 1.5 1 0.5 0Z"
    lines = [one for one in tree.iter("g") if one.get("class") == "across"]
    assert [one.get("data-at") for one in lines] == ["0", "0.01", "4", "5"]
    shown = {text.text: text.get("visibility") for one in lines for text in one.iter("text")}
    assert shown == {"First <stop>": None, "too near": "hidden", "Last": None}
    (axes,) = sheet(figure).axes
    assert {one.get_text() for one in axes.texts} == {"First <stop>", "too near", "", "Last"}
    assert [one.get_text() for one in axes.get_legend().get_texts()].count("open") == 1
