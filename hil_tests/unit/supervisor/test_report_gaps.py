"""The report draws no line over what the record does not have, in its figures and in Explore."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hil_tests.support.fault_runs import fast
from hil_tests.support.stops import SHORT
from railhil.bench import local_run
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.supervisor.framelog import read_log
from railhil.supervisor.notes import ToldNote
from railhil.supervisor.report import events_panel, panels, signals_picture
from railhil.supervisor.report.explore import explored
from railhil.supervisor.report.figures import pictures, system_pictures
from railhil.supervisor.report.panels import Drawn
from railhil.supervisor.report.recorded import RecordedRun, curves, recorded_run
from railhil.supervisor.report.stacked import line
from railhil.supervisor.report.styles import Style
from railhil.supervisor.sampled import drawn_trace, holding_s
from railhil.supervisor.score import score
from railhil.supervisor.trace import Trace, trace_of

_FROM_S, _TO_S = 10.0, 16.0
_SILENT = ("SIM_TRUTH", "NOTCH_CMD", "CTL_STAT")
#: As the law declares its bit field.
_NOTE = ToldNote("Note1", "basis", "basis", "", "", 1.0, False, ("step", "wavelet", "ramp"))


class Gappy:
    """590 m in 49 s; the whole record, and one without some ports from 10 s to 16 s."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.scenario: AnyScenario = fast(folder)
        local_run(self.scenario, folder)
        self._frames = list(read_log(folder / "frames.log"))

    def trace(self, *silent: str) -> Trace:
        ids = {can_id for port in silent for can_id in trace_of([]).contract.port(port).can_ids}
        return trace_of(
            (time_ns, frame)
            for time_ns, frame in self._frames
            if not (_FROM_S < time_ns / 1e9 < _TO_S and frame.can_id in ids)
        )

    def run(self, trace: Trace) -> RecordedRun:
        return recorded_run(self.folder, {}, self.scenario, trace, score(self.scenario, trace))


@pytest.fixture(scope="module")
def gappy(tmp_path_factory: pytest.TempPathFactory) -> Gappy:
    return Gappy(tmp_path_factory.mktemp("gappy"))


#: The middle of the gap, between two ticks.
_MIDDLE_S = (_FROM_S + _TO_S) / 2 + 0.003


def bridges(time_s: Any, values: Any, middle: float = _MIDDLE_S) -> bool:
    """Whether a line goes over the middle of the gap."""
    x, known = np.asarray(time_s, dtype=float), np.isfinite(np.asarray(values, dtype=float))
    return bool(np.any(known[:-1] & known[1:] & (x[:-1] < middle) & (x[1:] > middle)))


def drawn_over_time(gappy: Gappy, trace: Trace) -> dict[str, Axes]:
    """The axes over time, by what they show."""
    scenario: Any = gappy.scenario
    run = Drawn("ipfc", Style(), curves(scenario, trace, [_NOTE.as_json()]), score(scenario, trace))
    axes = {name: Figure().subplots() for name in ("error", "force", "notch", "flags", "speed", "distance")}
    panels.speed_error(axes["error"], run)
    panels.force(axes["force"], run)
    panels.notch(axes["notch"], run)
    panels.flags(axes["flags"], run, _NOTE.name, panels.flag_sets([run], _NOTE.name))
    events_panel.speed_over_time(axes["speed"], run)
    panels.distance_over_time(axes["distance"], scenario, [replace(run, label="train")])
    return axes


def test_no_figure_has_a_line_over_a_gap(gappy: Gappy) -> None:
    planned = ("target", "target stop")
    for silent, expected in ((_SILENT, False), ((), True)):
        for name, axes in drawn_over_time(gappy, gappy.trace(*silent)).items():
            curved = [one for one in axes.get_lines() if name == "speed" or one.get_label() not in planned]
            curved = [one for one in curved if len(one.get_xdata()) > 2]
            assert curved, name
            for one in curved:
                assert bridges(one.get_xdata(), one.get_ydata()) == expected, (name, silent)
    assert len(pictures(gappy.scenario, [gappy.run(gappy.trace(*_SILENT))])) >= 6


def test_no_line_over_distance_goes_over_a_gap(gappy: Gappy) -> None:
    scenario: Any = gappy.scenario
    trace = gappy.trace("SIM_TRUTH")
    run = Drawn("ipfc", Style(), curves(scenario, trace), score(scenario, trace))
    last = int(np.flatnonzero(np.isnan(run.curves.speed_kmh))[0]) - 1
    before_m, after_m = run.curves.position_m[last], run.curves.position_m[last + 2]
    axes = Figure().subplots()
    panels.speed_near(axes, scenario, [run], (before_m + after_m) / 2)
    panels.speed_over_distance(axes, scenario, [run])
    for one in axes.get_lines():
        x, y = (np.asarray(each, dtype=float) for each in (one.get_xdata(), one.get_ydata()))
        assert not np.any((x[:-1] == before_m) & (x[1:] == after_m))
        assert np.isfinite(y).any() or len(y) < 3
    assert np.isfinite(panels.widest_places(scenario, [run])).all()


def unpacked(run: dict[str, Any], name: str) -> tuple[Any, Any]:
    """Instants and values of a curve, as explore.js reads them."""
    given, time = run["signals"][name], run["time"]
    rows = np.cumsum(np.frombuffer(base64.b64decode(given["r"]), dtype=f"<u{given['w'] // 8}").astype(int))
    if "t" in time:
        return np.frombuffer(base64.b64decode(time["t"]))[rows], np.frombuffer(base64.b64decode(given["v"]), "<f4")
    return time["start"] + time["step"] * rows, np.frombuffer(base64.b64decode(given["v"]), "<f4")


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
def test_explore_has_no_line_over_a_gap(gappy: Gappy, silent: tuple[str, ...], gaps: tuple[str, ...]) -> None:
    document = json.loads(explored([gappy.run(gappy.trace(*silent))]))
    run = document["runs"][0]
    names = {
        "true_speed_mps",
        "target_speed_mps",
        "notch_command",
        "measured_speed_mps",
        "controller_mode",
        "ladder_level",
    }
    assert {name for name in names if not bridges(*unpacked(run, name))} == set(gaps)
    if not silent:
        assert "t" not in run["time"]
    # The page goes on being drawn over the position.
    assert "true_position_m" in document["over"]


def test_the_picture_of_signals_has_no_line_over_a_gap(
    gappy: Gappy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines: list[tuple[Any, Any]] = []
    plot = Axes.plot
    monkeypatch.setattr(Axes, "plot", lambda axes, x, y, **look: (lines.append((x, y)), plot(axes, x, y, **look))[1])
    signals_picture.draw(gappy.scenario, gappy.trace("SIM_TRUTH"), tmp_path / "run.svg")
    assert len(lines) > 10
    assert not any(bridges(x, y) for x, y in lines[1:])


#: Short runs of the systems with figures of their own: scenario, law, settings.
_OTHERS = {
    "hst1": ("hst_short", "elm_ngpc", ("task.duration_s=9",)),
    "emu3": ("emu3_short", "pid", ("task.duration_s=9",)),
    "stop": ("yizhuang_stop", "one_shot", SHORT),
}
_OTHER_FROM_S, _OTHER_TO_S = 4.0, 6.0


@pytest.mark.slow
@pytest.mark.parametrize("system", _OTHERS)
def test_no_figure_of_another_system_has_a_line_over_a_gap(
    system: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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
    lines: list[tuple[Axes, Any, Any]] = []
    plot = Axes.plot
    monkeypatch.setattr(
        Axes, "plot", lambda axes, x, y, **look: (lines.append((axes, x, y)), plot(axes, x, y, **look))[1]
    )
    for trace, expected in ((made.trace, True), (gappy, False)):
        lines.clear()
        assert system_pictures(scenario, [recorded_run(tmp_path, {}, scenario, trace, made.score)])
        over = [bridges(x, y, middles[axes.figure.axes[-1].get_xlabel()]) for axes, x, y in lines]
        assert len(over) >= 4
        # Those of the last metres and of a margin may begin later.
        assert sum(over) >= 3 if expected else not any(over)
        assert any(
            np.isfinite(y[np.asarray(x) > middles[axes.figure.axes[-1].get_xlabel()]]).any() for axes, x, y in lines
        )


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


@given(st.lists(st.tuples(st.integers(1, 900), st.integers(1, 30)), min_size=1, max_size=6), st.booleans())
def test_a_line_has_the_extremes_of_each_part_and_goes_over_no_gap(parts: list[tuple[int, int]], by_mask: bool) -> None:
    shown = np.concatenate([[True] * known + [False] * unknown for known, unknown in parts])
    x = np.arange(len(shown), dtype=float)
    y = np.sin(x / 7.0) * x
    axes = Figure().subplots()
    line(axes, x, y, shown) if by_mask else line(axes, x, np.where(shown, y, np.nan))
    (drawn,) = axes.get_lines()
    at, values = (np.asarray(one, dtype=float) for one in (drawn.get_xdata(), drawn.get_ydata()))
    known = np.isfinite(values)
    assert shown[at[known].astype(int)].all()
    for begin, end in zip(at[:-1][known[:-1] & known[1:]], at[1:][known[:-1] & known[1:]], strict=True):
        assert shown[int(begin) : int(end) + 1].all()
    assert np.nanmax(values) == pytest.approx(np.max(y[shown]), rel=0.05, abs=1.0)
    assert len(at) <= 1700
