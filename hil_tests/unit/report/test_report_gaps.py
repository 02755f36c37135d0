"""The report draws no line over what the record does not have."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hil_tests.support.fault_runs import fast
from hil_tests.support.recordings import row_of
from hil_tests.support.stops import SHORT
from hil_tests.support.svg_paths import path_points
from railhil.bench import local_run
from railhil.charts.figure import TIME, Chart, Curve, Figure
from railhil.charts.svg import markup
from railhil.dbc import wire_contract
from railhil.judge.judging import system_pictures
from railhil.judge.record import Record
from railhil.record.framelog import read_log
from railhil.record.notes import ReportedNote
from railhil.record.sampling import drawn_trace, holding_s
from railhil.record.trace import Trace, trace_of
from railhil.report.over_time import columns_of, signal_charts, signals
from railhil.report.styles import Style
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato import panels as ato_panels
from railhil.systems.ato.judge.curves import curves
from railhil.systems.ato.judge.score import score
from railhil.systems.ato.panels import Drawn

_FROM_S, _TO_S = 10.0, 16.0
_SILENT = ("SIM_TRUTH", "NOTCH_CMD", "CTL_STAT")
#: As the law declares its bit field.
_NOTE = ReportedNote("Note1", "basis", "basis", "", "", 1.0, False, ("step", "wavelet", "ramp"))


class Gappy:
    """590 m in 49 s; the whole record, and one without some ports from 10 s to 16 s."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.scenario: AnyScenario = fast(folder)
        local_run(self.scenario, folder)
        self._frames = list(read_log(folder / "frames.log"))

    def trace(self, *silent: str) -> Trace:
        ids = {can_id for port in silent for can_id in trace_of([], wire_contract()).contract.port(port).can_ids}
        return trace_of(
            (
                (time_ns, frame)
                for time_ns, frame in self._frames
                if not (_FROM_S < time_ns / 1e9 < _TO_S and frame.can_id in ids)
            ),
            wire_contract(),
        )

    def run(self, trace: Trace) -> Record:
        return row_of(self.folder, {}, self.scenario, trace, score(self.scenario, trace))


@pytest.fixture(scope="module")
def gappy(tmp_path_factory: pytest.TempPathFactory) -> Gappy:
    return Gappy(tmp_path_factory.mktemp("gappy"))


#: The middle of the gap, between two ticks.
_MIDDLE_S = (_FROM_S + _TO_S) / 2 + 0.003


def bridges(time_s: Any, values: Any, middle: float = _MIDDLE_S) -> bool:
    """Whether a line goes over the middle of the gap."""
    x, known = np.asarray(time_s, dtype=float), np.isfinite(np.asarray(values, dtype=float))
    return bool(np.any(known[:-1] & known[1:] & (x[:-1] < middle) & (x[1:] > middle)))


def drawn_over_time(figures: Sequence[Figure]) -> Iterator[tuple[str, Curve]]:
    """The curves of the run over time, each with the name of its figure."""
    for figure in figures:
        for chart in figure.charts:
            for curve in chart.curves if chart.x_label == TIME or chart.sync == TIME else ():
                if curve.run >= 0 and len(curve.x) > 2 and curve.x[0] < _FROM_S:
                    yield f"{figure.name} {curve.label}", curve


@pytest.mark.parametrize(("silent", "is_bridged"), [(_SILENT, False), ((), True)])
def test_no_figure_has_a_line_over_a_gap(gappy: Gappy, silent: tuple[str, ...], is_bridged: bool) -> None:
    run = gappy.run(gappy.trace(*silent)).copy_with(certificate={"notes": [_NOTE.as_json()]})
    found = dict(drawn_over_time(ato_panels.pictures(run.scenario, [run])))
    assert {name.split()[0] for name in found} >= {"error", "stop", "notch", "force", _NOTE.name}
    for name, curve in found.items():
        assert bridges(curve.x, curve.y) == is_bridged, name
        # The path in the page is broken there, too.
        chart = Chart([curve], TIME, "")
        x, y = path_points(re.search(r'class="curve"[^>]* d="([^"]*)"/></g>', markup(Figure("f", "", "", [chart])))[1])
        if not curve.is_step:
            assert bridges(x, y) == is_bridged, name


def test_a_copy_with_another_trace_has_its_own_signals(gappy: Gappy) -> None:
    whole = gappy.run(gappy.trace())
    rows = len(whole.signals["time_s"])
    assert len(whole.copy_with(trace=gappy.trace("SIM_TRUTH")).signals["time_s"]) < rows
    assert len(whole.copy_with(label="another").signals["time_s"]) == rows


def test_no_line_over_distance_goes_over_a_gap(gappy: Gappy) -> None:
    scenario: Any = gappy.scenario
    trace = gappy.trace("SIM_TRUTH")
    run = Drawn("ipfc", Style(), curves(scenario, trace), score(scenario, trace))
    last = int(np.flatnonzero(np.isnan(run.curves.speed_kmh))[0]) - 1
    before_m, after_m = run.curves.position_m[last], run.curves.position_m[last + 2]
    charts = [
        ato_panels.speed_near(scenario, [run], (before_m + after_m) / 2),
        ato_panels.speed_over_distance(scenario, [run]),
    ]
    for curve in [curve for chart in charts for curve in chart.curves]:
        x, y = curve.x, curve.y
        assert not np.any((x[:-1] == before_m) & (x[1:] == after_m) & np.isfinite(y[:-1]) & np.isfinite(y[1:]))
        assert np.isfinite(y).any() or len(y) < 3
    assert np.isfinite(ato_panels.widest_places(scenario, [run])).all()


@pytest.mark.parametrize(
    ("silent", "gaps"),
    [
        ((), ()),
        (
            ("SIM_TRUTH",),
            (
                "true_speed_mps",
                "target_speed_mps",
                "notch_command",
                "measured_speed_mps",
                "controller_mode",
                "ladder_level",
            ),
        ),
        (("NOTCH_CMD",), ("notch_command", "controller_mode")),
        (("CTL_STAT",), ("ladder_level",)),
    ],
)
def test_no_signal_has_a_line_over_a_gap(gappy: Gappy, silent: tuple[str, ...], gaps: tuple[str, ...]) -> None:
    run = columns_of(gappy.run(gappy.trace(*silent)), 0, Style())
    names = {
        "true_speed_mps",
        "target_speed_mps",
        "notch_command",
        "measured_speed_mps",
        "controller_mode",
        "ladder_level",
    }
    figures = [figure for part in signals([run], []) for figure in part]
    drawn = {curve.column: curve for figure in figures for chart in figure.charts for curve in chart.curves}
    assert {name for name in names if not bridges(drawn[name].x, drawn[name].y)} == set(gaps)
    # The page goes on being drawn over the position.
    assert np.isfinite(run.values["true_position_m"]).all()


def test_the_picture_of_signals_has_no_line_over_a_gap(gappy: Gappy) -> None:
    charts = signal_charts(gappy.scenario, gappy.trace("SIM_TRUTH"))
    places = ("true_position_m", "odometer_m")
    curves = [curve for chart in charts for curve in chart.curves if curve.column not in places]
    assert len(curves) > 8
    assert not any(bridges(curve.x, curve.y) for curve in curves)


#: Short runs of the systems with figures of their own: scenario, law, settings.
_OTHERS = {
    "hst1": ("hst_short", "elm_ngpc", ("task.duration_s=9",)),
    "emu3": ("emu3_short", "pid", ("task.duration_s=9",)),
    "stop": ("yizhuang_stop", "one_shot", SHORT),
}
_OTHER_FROM_S, _OTHER_TO_S = 4.0, 6.0


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("system", _OTHERS)
def test_no_figure_of_another_system_has_a_line_over_a_gap(system: str, tmp_path: Path) -> None:
    name, law, settings = _OTHERS[system]
    scenario = load_any(name, settings)
    made = local_run(scenario, tmp_path, RunSpec(law=LawSpec(law, arithmetic="float64")))
    contract = made.trace.contract
    cyclic = {can_id for port in holding_s(scenario, contract) for can_id in contract.port(port).can_ids}
    frames = list(read_log(tmp_path / "frames.log"))
    gappy = trace_of(
        (
            (time_ns, frame)
            for time_ns, frame in frames
            if not (_OTHER_FROM_S < time_ns / 1e9 < _OTHER_TO_S and frame.can_id in cyclic)
        ),
        contract,
    )
    middle_s = (_OTHER_FROM_S + _OTHER_TO_S) / 2 + 0.001
    place_m = np.interp(middle_s, made.trace.times_s("TRUTH"), made.trace.values("TRUTH", "TruePos"))
    stop_m = scenario.task.stop_m if system == "stop" else 0.0
    middles = {
        "time (s)": middle_s,
        "position (km)": place_m / 1e3,
        "position less stopping point (m)": place_m - stop_m,
    }
    for trace, expected in ((made.trace, True), (gappy, False)):
        figures = system_pictures(scenario, [row_of(tmp_path, {}, scenario, trace, made.score)])
        # The charts above have the axis of the last one.
        curves = [
            (middles[figure.charts[-1].x_label], path_points(d))
            for figure in figures
            for d in re.findall(r'<path class="curve"[^>]* d="(M[^"]*)"/>', markup(figure))
            if not d.endswith("H30")
        ]
        over = [bridges(x, y, middle) for middle, (x, y) in curves]
        assert len(over) >= 4
        # Those of the last metres and of a margin may begin later.
        assert sum(over) >= 3 if expected else not any(over)
        assert any(np.isfinite(y[x > middle]).any() for middle, (x, y) in curves)


def test_a_record_as_figures_get_it_has_one_row_more_for_each_silence(gappy: Gappy) -> None:
    for silent, more in (((), 0), (("SIM_TRUTH",), 1)):
        trace = gappy.trace(*silent)
        drawn = drawn_trace(gappy.scenario, trace)
        assert drawn_trace(gappy.scenario, drawn) is drawn
        assert (drawn.count("SIM_TRUTH"), drawn.count("TRN_SPEED")) == (
            trace.count("SIM_TRUTH") + more, trace.count("TRN_SPEED"),
        )  # fmt: skip
        time_s, speed, raw = (
            drawn.times_s("SIM_TRUTH"), drawn.values("SIM_TRUTH", "TrueSpeed"), drawn.raw("SIM_TRUTH", "TrueSpeed"),
        )  # fmt: skip
        unknown = np.isnan(speed)
        assert len(time_s) == len(speed) == len(raw) == len(drawn.order("SIM_TRUTH"))
        assert (np.diff(time_s) > 0).all()
        assert np.ma.getmaskarray(raw).tolist() == unknown.tolist()
        assert unknown.sum() == more
        assert time_s[unknown] == pytest.approx([_FROM_S + 0.001] * more)
        assert speed[~unknown].tolist() == trace.values("SIM_TRUTH", "TrueSpeed").tolist()
        assert drawn.missed_polls == trace.missed_polls
        assert drawn.refused is trace.refused


@pytest.mark.slow
@given(st.lists(st.tuples(st.integers(1, 900), st.integers(1, 30)), min_size=1, max_size=6))
@example([(325, 30), (1, 1), (614, 30)])
def test_a_path_has_the_extremes_and_goes_over_no_gap(parts: list[tuple[int, int]]) -> None:
    shown = np.concatenate([[True] * known + [False] * unknown for known, unknown in parts])
    x = np.arange(len(shown), dtype=float)
    y = np.where(shown, np.sin(x / 7.0) * x, np.nan)
    text = markup(Figure("f", "", "", [Chart([Curve("c", x, y)], "x")]))
    (d,) = re.findall(r'<path class="curve"[^>]* d="(M[^"]*)"/></g>', text)
    at, values = path_points(d)
    known = np.isfinite(values)
    assert shown[at[known].astype(int)].all()
    for begin, end in zip(at[:-1][known[:-1] & known[1:]], at[1:][known[:-1] & known[1:]], strict=True):
        assert shown[int(begin) : int(end) + 1].all()
    np.testing.assert_allclose(values[known], y[at[known].astype(int)], rtol=1e-6)
    assert np.nanmax(values) == pytest.approx(np.nanmax(y), rel=0.05, abs=1.0)
