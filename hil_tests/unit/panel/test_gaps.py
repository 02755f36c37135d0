"""Gaps are gaps: no line is drawn over them, nothing is drawn before the time is known, and what is dropped is said."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.fault_runs import fast
from hil_tests.support.panel import ScriptedLink
from railhil.bench import local_run
from railhil.bus.frame import Frame
from railhil.cli.run_identity import RunIdentity
from railhil.dbc import wire_contract
from railhil.panel.history import HISTORY_ROWS_MAX, History, is_gap
from railhil.panel.layout import Rows
from railhil.panel.live import LiveRun
from railhil.panel.receiver import LOOK_FRAMES, Receiver
from railhil.panel.recorded import thin_rows
from railhil.record.framelog import read_log
from railhil.record.trace import FloatArray, trace_of
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario


class Ride:
    """590 m in 49 s, its frames, and its true speed by time."""

    def __init__(self, folder: Path) -> None:
        self.scenario: AnyScenario = fast(folder)
        local_run(self.scenario, folder)
        log = list(read_log(folder / "frames.log"))
        self.frames = [frame for _, frame in log]
        self.times_s = np.array([time_ns for time_ns, _ in log]) / 1e9
        trace = trace_of(log, wire_contract())
        self._times_s, self._speeds = trace.times_s("SIM_TRUTH"), trace.values("SIM_TRUTH", "TrueSpeed")

    def from_s(self, time_s: float) -> list[Frame]:
        return self.frames[int(self.times_s.searchsorted(time_s)) :]

    def speed_kmh(self, time_s: FloatArray) -> FloatArray:
        """The true speed at these instants, which must be instants of the truth."""
        return 3.6 * self._speeds[self._times_s.searchsorted(time_s - 1e-6)]


@pytest.fixture(scope="module")
def ride(tmp_path_factory: pytest.TempPathFactory) -> Ride:
    return Ride(tmp_path_factory.mktemp("ride"))


def shown(ride: Ride, *looks: list[Frame], named: AnyScenario | None = None) -> tuple[LiveRun, FloatArray]:
    """A live run after these looks, and the rows that its page has."""
    arrivals = [part for look in looks for part in (look, [])]
    live = LiveRun(RunIdentity(named or ride.scenario), Receiver({}, lambda config, name: ScriptedLink(*arrivals, [])))
    for _ in looks:
        live.look()
    return live, live._history.rows


def parts(live: LiveRun, rows: FloatArray) -> list[FloatArray]:
    """The stretches of rows between the gaps."""
    gaps = np.flatnonzero(is_gap(rows, live.layout.position))
    return [part for part in np.split(rows, gaps) if len(part) > 1]


def is_true(ride: Ride, live: LiveRun, rows: FloatArray) -> None:
    """Every speed that is drawn is the train's at that instant."""
    for part in parts(live, rows):
        known = part[~is_gap(part, live.layout.position)]
        np.testing.assert_allclose(known[:, 1 + live.layout.speed], ride.speed_kmh(known[:, 0]), atol=1e-6)
        assert np.diff(known[:, 0]).max() < 0.2


def notices(live: LiveRun) -> str:
    state = next(json.loads(text)["state"] for text in live.read_past() if isinstance(text, str) and "state" in text)
    return " ".join(state["notices"])


def chunks(frames: list[Frame], size: int) -> list[list[Frame]]:
    return [frames[start : start + size] for start in range(0, len(frames), size)]


def test_who_joins_late_draws_nothing_before_the_time_is_known(ride: Ride) -> None:
    live, rows = shown(ride, *chunks(ride.from_s(21.0), 400))
    assert rows[0, 0] >= 21.0
    is_true(ride, live, rows)
    early, none = shown(ride, ride.from_s(21.0)[:300])
    assert len(none) == 0
    assert "time is not known" in notices(early)
    assert json.loads(next(text for text in early.read_past() if "state" in str(text)))["state"]["time_s"] is None


def test_frames_dropped_at_a_look_are_a_gap_and_are_said(ride: Ride) -> None:
    """As in lockstep, when more comes at one look than is taken."""
    first, much = ride.frames[:4000], ride.frames[4000 : 4000 + LOOK_FRAMES + 9000]
    live, rows = shown(ride, first, much)
    assert live.receiver.dropped == 9000
    is_true(ride, live, rows)
    assert len(parts(live, rows)) == 2
    assert "9000 FRAMES DROPPED HERE" in notices(live)


def test_the_values_go_as_soon_as_frames_were_dropped(ride: Ride) -> None:
    """Before the time is known again, the newest row says that nothing is known: no value stands still."""
    link = ScriptedLink(ride.frames[:4000], [], ride.from_s(30.0)[:200], [])
    live = LiveRun(RunIdentity(ride.scenario), Receiver({}, lambda config, name: link))
    live.look()
    assert not is_gap(live._history.rows[-1:], live.layout.position)[0]
    link.counters["rx_lost"] = 77
    live.look()
    assert is_gap(live._history.rows[-1:], live.layout.position)[0]


def test_a_bus_that_was_away_is_a_gap(ride: Ride) -> None:
    links = [ScriptedLink(ride.frames[:4000], []), ScriptedLink(ride.from_s(25.0), [])]
    receiver = Receiver({}, lambda config, name: links.pop(0))
    live = LiveRun(RunIdentity(ride.scenario), receiver)
    for _ in range(3):
        receiver._retry_s = 0.0
        live.look()
    rows = live._history.rows
    is_true(ride, live, rows)
    assert len(parts(live, rows)) == 2
    assert rows[-1, 0] > 45


def test_another_run_after_a_hole_begins_anew(ride: Ride) -> None:
    """Its handshake was among what was lost: its time is earlier."""
    links = [ScriptedLink(ride.from_s(20.0), []), ScriptedLink(ride.from_s(2.0)[:4000], [])]
    receiver = Receiver({}, lambda config, name: links.pop(0))
    live = LiveRun(RunIdentity(ride.scenario), receiver)
    for _ in range(3):
        receiver._retry_s = 0.0
        live.look()
    rows = live._history.rows
    assert 2.0 < rows[0, 0] < rows[-1, 0] < 12.0
    is_true(ride, live, rows)


def test_a_truth_that_is_missing_is_a_gap_of_a_recorded_run_too(ride: Ride) -> None:
    """As where the recorder missed SIM_TRUTH; the same rows go to the page."""
    truth = set(trace_of([], wire_contract()).contract.port("SIM_TRUTH").can_ids)
    heard = zip(ride.times_s, ride.frames, strict=True)
    trace = trace_of(
        ((round(at * 1e9), one) for at, one in heard if not (10 < at < 16 and one.can_id in truth)), wire_contract()
    )
    live, _ = shown(ride, [])
    made = Rows(ride.scenario, live.layout)
    rows = made.insert_gaps(made.make(trace))
    gaps = rows[is_gap(rows, live.layout.position)]
    assert gaps[:, 0].tolist() == pytest.approx([10.0], abs=0.1)


def without(ride: Ride, port: str, from_s: float, to_s: float) -> list[tuple[int, Frame]]:
    """The record, as if nothing of this port had been heard for a while."""
    own = set(trace_of([], wire_contract()).contract.port(port).can_ids)
    heard = zip(ride.times_s, ride.frames, strict=True)
    return [(round(at * 1e9), one) for at, one in heard if not (from_s < at < to_s and one.can_id in own)]


@pytest.mark.parametrize(
    ("port", "column", "period_s"),
    [
        ("TRN_SPEED", "measured_speed_mps", 0.01),
        ("NOTCH_CMD", "notch_command", 0.02),
        ("CTL_STAT", "ladder_level", 0.16),
    ],
)
def test_a_column_of_a_silent_port_is_a_gap(ride: Ride, port: str, column: str, period_s: float) -> None:
    """From three periods after the last telegram until the next one, live and in a recorded run; others go on."""
    heard = without(ride, port, 10.0, 16.0)
    live, rows = shown(ride, *chunks([frame for _, frame in heard], 500))
    made = Rows(ride.scenario, live.layout)
    recorded = made.insert_gaps(made.make(trace_of(heard, wire_contract())))
    place = 1 + next(at for at, one in enumerate(live.layout.columns) if one.name == column)
    for table in (rows, recorded):
        begun = table[table[:, 0] > 2.0]
        silent = begun[np.isnan(begun[:, place]), 0]
        assert silent[0] == pytest.approx(10.0 + 3 * period_s, abs=period_s + 0.021)
        assert silent[-1] == pytest.approx(16.0, abs=period_s + 0.041)
        assert len(silent) == pytest.approx((6.0 - 3 * period_s) / 0.02, abs=4 + period_s / 0.02)
        assert not is_gap(begun, live.layout.position).any()
    _, end = shown(ride, [frame for time_ns, frame in heard if time_ns < 12e9])
    assert np.isnan(end[-1, place])
    assert np.isfinite(end[-1, 1 + live.layout.speed])


def test_a_truth_that_falls_silent_is_not_shown_any_more(ride: Ride) -> None:
    heard = [frame for time_ns, frame in without(ride, "SIM_TRUTH", 10.0, 16.0) if time_ns < 12e9]
    live, rows = shown(ride, *chunks(heard, 500))
    assert is_gap(rows, live.layout.position)[[-2, -1]].tolist() == [False, True]
    assert rows[-1, 0] == pytest.approx(10.0, abs=0.03)


def test_a_gap_of_one_column_outlives_thinning() -> None:
    rows = np.ones((200_000, 4))
    rows[:, 0] = np.arange(len(rows))
    rows[77_777, 2] = np.nan
    found = thin_rows(rows, 2)
    assert np.isnan(found).sum(axis=0).tolist() == [0, 0, 1, 0]


def test_a_gap_outlives_thinning() -> None:
    rows = np.ones((200_000, 4))
    rows[:, 0] = np.arange(len(rows))
    rows[77_777, 1:3] = np.nan
    assert is_gap(rows, 2).sum() == 1
    found = thin_rows(rows, 2)
    assert len(found) <= 40_000
    assert is_gap(found, 2).sum() == 1
    assert np.isfinite(found[:, [0, 3]]).all()
    history = History(4, 2)
    for part in np.split(rows, 200):
        history.add(part)
    assert len(history.rows) <= HISTORY_ROWS_MAX
    assert history.stride > 4
    assert is_gap(history.rows, 2).sum() == 1


def test_a_scenario_of_the_plants_hash_is_taken_and_no_other(ride: Ride) -> None:
    """What the user names and the plant does not run is not shown; what nobody here has is shown without a target."""
    live, rows = shown(ride, ride.frames[:3000], named=load_any("lvshun_tieshan"))
    assert (live.layout.target, live.layout.speed >= 0) == (-1, True)
    assert "no scenario here has the hash" in notices(live)
    assert ride.scenario.sha256[:8] in notices(live)
    is_true(ride, live, rows)


def test_nothing_is_taken_for_a_run_before_the_plant_has_told(ride: Ride) -> None:
    link = ScriptedLink(ride.from_s(20.5)[:300], [], ride.from_s(20.5)[300:4000], [])
    live = LiveRun(RunIdentity(None), Receiver({}, lambda config, name: link))
    live.look()
    assert live.layout.columns == ()
    assert live.describe()["runs"][0]["name"] == "a run that is not known yet"
    assert "has not told" in notices(live)
    live.look()
    # PLT_IDENT is repeated: who joins late knows the scenario's hash, the law and the seed.
    assert ride.scenario.sha256[:8] in live._watched.run
    assert "law ipfc, seed 0" in live._watched.run
    assert live.layout.speed >= 0
