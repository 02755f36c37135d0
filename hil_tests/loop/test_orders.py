"""Orders of an operator in a whole run: on the wire, in the certificate, and the same bytes when made again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.short_runs import RUN_2M_TOML, RUN_72M_TOML
from railhil.bus.codes import FaultOrder, SupCommand
from railhil.bus.telegrams import SupCmd
from railhil.dbc import wire_contract
from railhil.judge.events.event import LEVEL
from railhil.judge.events.summary import fault_events
from railhil.judge.events.telegrams import events_of
from railhil.judge.fault_report import fault_outcomes, missed_faults
from railhil.judge.reactions.catalogue import faults_by_hand
from railhil.panel.live_orders import LiveOrders
from railhil.record.framelog import read_log
from railhil.record.trace import Trace, trace_of
from railhil.run.local import LocalRun, local_plan
from railhil.scenarios.run_spec import LawSpec, RunSpec


class Hands:
    """A panel at which somebody presses buttons at given polls."""

    def __init__(self, presses: dict[int, list[dict[str, object]]]) -> None:
        self._presses = presses
        self._looks = 0

    def take(self, timeout_s: float) -> list[dict[str, object]]:
        self._looks += 1
        return self._presses.get(self._looks, [])

    def tell(self, report: dict[str, object]) -> None:
        pass


@pytest.fixture
def spec(tmp_path: Path) -> RunSpec:
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    return RunSpec(str(path), faults=("TRN_SPEED loss @manual", "safety_loop off @manual"))


def made(spec: RunSpec, folder: Path, panel: Hands | None = None) -> LocalRun:
    folder.mkdir()
    run = LocalRun(replace(local_plan(spec.load(), spec, folder), panel=panel))
    run.execute()
    return run


def orders_of(run: LocalRun) -> tuple[str, ...]:
    """All that has been ordered in a run."""
    operator = run.session.commands.operator
    assert operator is not None
    return tuple(operator.sent)


@pytest.mark.faults
def test_what_was_ordered_by_hand_makes_the_same_run_again(spec, tmp_path):
    presses = {
        3: [{"do": "inject", "fault": 1}],
        5: [{"do": "pause"}],
        # The answer of the pause looks twice, the next one ends it.
        7: [{"do": "start"}],
        9: [{"do": "clear", "fault": 1}],
        14: [{"do": "stop"}],
    }
    by_hand = made(spec, tmp_path / "hand", Hands(presses))
    assert [text.partition(" ")[2] for text in orders_of(by_hand)] == ["inject 1", "pause", "clear 1", "stop"]
    again = made(replace(spec, orders=orders_of(by_hand)), tmp_path / "again")
    assert again.log.path.read_bytes() == by_hand.log.path.read_bytes()

    trace = trace_of(read_log(by_hand.log.path), wire_contract())
    commands = trace.raw(SupCmd.PORT, "SupCommand").tolist()
    assert commands.count(SupCommand.NONE) == 1
    assert commands.count(SupCommand.STOP) == 1
    assert trace.word("RUN_EVENT", "RunEvent", int(trace.raw("RUN_EVENT", "RunEvent")[-1])) == "ended_by_supervisor"
    # Simulation time stood still.
    paused = commands.index(SupCommand.NONE)
    times_ns = trace.times_ns(SupCmd.PORT)
    assert times_ns[paused + 1] == times_ns[paused]


@pytest.mark.faults
def test_an_order_without_effect_warns_and_a_test_without_effect_proves_nothing(spec, tmp_path):
    presses = {3: [{"do": "inject", "fault": 1}], 8: [{"do": "stop"}]}
    for name, end, missed in (("warns", "", ""), ("test", " expect HOLD", "fault 1 changed nothing: ")):
        run = made(replace(spec, faults=(f"TRN_SPEED loss 0% @manual{end}",)), tmp_path / name, Hands(presses))
        (found,) = fault_outcomes(tmp_path / name, run.scenario, spec.seed)
        assert (found.begun_s is not None, found.hits) == (True, 0)
        assert missed_faults([found]).startswith(missed)
        assert bool(missed_faults([found])) is bool(missed)
        assert ("warning" in found.line) is not bool(missed)


@pytest.mark.faults
def test_the_bands_of_a_live_page_are_those_of_the_record(spec, tmp_path):
    faults = (
        "TRN_SPEED loss 30% @manual combine", "TRN_POS loss 30% @manual for 200ms", "NOTCH_CMD loss @500ms for 300ms",
        "BALISE corrupt @v>100km/h", "TRN_SPEED stuck @manual combine",
    )  # fmt: skip
    presses = {
        3: [{"do": "inject", "fault": 1}, {"do": "inject", "fault": 2}],
        6: [{"do": "pause"}],
        8: [{"do": "start"}],
        12: [{"do": "clear", "fault": 1}],
        14: [{"do": "inject", "fault": 5}],
        18: [{"do": "stop"}],
    }
    run = made(replace(spec, faults=faults), tmp_path / "run", Hands(presses))
    seen = bands_checked(run, tmp_path / "run", spec, {1, 2, 3, 5}, {5})
    orders = [event["text"] for event in seen if event["kind"] == "order"]
    assert orders == ["pause", "start again", "cleared fault 1: TRN_SPEED loss 30%", "stop"]


#: Faults with conditions, by scenario and law.
CONDITIONS = {
    (RUN_72M_TOML, "ipfc"): (
        "TRN_POS loss 30% @10m until braking", "PLT_STAT loss @v>2m/s for 300ms", "NOTCH_CMD loss 5% @v<3m/s+1s",
        "TRN_SPEED delay 20ms @departed+200ms x2", "NOTCH_SDT loss 5% @2s until stopped", "BALISE corrupt @1000m",
    ),
    ('extends = "yizhuang_stop"\nname = "short"\n', "ilc_stop"): (
        "SPEED_RAW loss 5% @v<30km/h for 2s", "ODO loss 5% @braking+1s until standstill",
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.faults
@pytest.mark.parametrize(("scenario", "law"), CONDITIONS, ids=[law for _, law in CONDITIONS])
def test_bands_of_faults_with_conditions_are_those_of_the_record(tmp_path, scenario, law):
    (tmp_path / "short.toml").write_text(scenario, encoding="utf-8")
    faults = CONDITIONS[scenario, law]
    spec = RunSpec(str(tmp_path / "short.toml"), law=LawSpec(controller=law, arithmetic="float64"), faults=faults)
    acting = {number for number, text in enumerate(faults, start=1) if "1000m" not in text}
    # Only the record tells when a fault with a count ends.
    lasting = {number for number, text in enumerate(faults, start=1) if "v<3m/s" in text or " x2" in text}
    seen = bands_checked(made(spec, tmp_path / "run"), tmp_path / "run", spec, acting, lasting)
    assert not [one for one in seen if " x2" in one["text"] and "is_open" in one]


def bands_checked(
    run: LocalRun, folder: Path, spec: RunSpec, numbers: set[int], open_ones: set[int]
) -> list[dict[str, Any]]:
    """The live events of a run; the bands of its faults must be those of these numbers and of the record."""
    seen: list[dict[str, Any]] = []

    def add(time_s: float, kind: str, source: str, text: str) -> dict[str, Any]:
        seen.append({"time_s": time_s, "kind": kind, "source": source, "text": text, "until_s": None})
        return seen[-1]

    live = LiveOrders(lambda: run.scenario.faults, add, run.scenario.installed_system)
    live.find(run.trace)
    assert live.find(Trace(run.trace.contract)) == []
    tick_s = run.scenario.timing.base_tick_ns / 1e9
    outcomes = fault_outcomes(folder, run.scenario, spec.seed)
    events = fault_events([one.as_json() for one in outcomes], run.trace.end_s)
    recorded = {event.detail.split(":")[0]: event for event in events}
    bands = {event["text"].split(":")[0]: event for event in seen if event["kind"] == "fault"}
    assert set(bands) == set(recorded) == {f"fault {number}" for number in numbers}
    for number in numbers:
        band, known = bands[f"fault {number}"], recorded[f"fault {number}"]
        # The truth comes with every second tick.
        assert band["time_s"] == pytest.approx(known.time_s, abs=2.5 * tick_s)
        if number not in open_ones:
            assert band["until_s"] == pytest.approx(known.until_s, abs=2.5 * tick_s)
    return seen


@pytest.mark.faults
def test_a_fault_of_the_catalogue_that_is_typed_during_a_run_makes_the_same_run_again(spec, tmp_path):
    spec = replace(spec, faults=())
    faults = faults_by_hand(spec.load())
    # A train of one unit has no second one, and nothing is prepared twice.
    assert len(set(faults)) == len(faults) > 40
    spec = replace(spec, faults=faults)
    presses = {
        3: [{"do": "fault", "text": "TRN_SPEED loss for 320 ms"}],
        4: [{"do": "fault", "text": "brake weak 30%"}],
        12: [{"do": "stop"}],
    }
    by_hand = made(spec, tmp_path / "hand", Hands(presses))
    number = faults.index("TRN_SPEED loss @manual combine id T3") + 1
    other = faults.index("brake weak 30% @manual combine id C3a") + 1
    assert [text.partition(" ")[2] for text in orders_of(by_hand)] == [
        f"inject {number}", f"inject {other}", f"clear {number}", "stop"
    ]  # fmt: skip
    levels = {event.cause for event in events_of(by_hand.scenario, by_hand.trace) if event.kind == LEVEL}
    assert "speed_age" in levels
    again = made(replace(spec, orders=orders_of(by_hand)), tmp_path / "again")
    assert again.log.path.read_bytes() == by_hand.log.path.read_bytes()


@pytest.mark.slow
@pytest.mark.faults
def test_faults_with_values_of_the_operator_make_the_same_run_again(spec, tmp_path):
    """At a telegram of the plant, inside the plant and at the controller; the report names the values."""
    prepared = ("TRN_SPEED loss 5% @manual", "speed delayed @manual combine", "NOTCH_CMD.NotchCmd offset 9 @manual")
    spec = replace(spec, faults=prepared)
    presses = {
        3: [
            {"do": "fault", "text": "TRN_SPEED loss 62.5% for 320ms"},
            {"do": "fault", "text": "NOTCH_CMD.NotchCmd offset -2.5"},
            {"do": "fault", "text": "speed delayed 750ms"},
        ],
        35: [{"do": "stop"}],
    }
    by_hand = made(spec, tmp_path / "hand", Hands(presses))
    outcomes = [one.text for one in fault_outcomes(tmp_path / "hand", by_hand.scenario, spec.seed)]
    assert [text.partition(" @")[0] for text in outcomes] == [
        "TRN_SPEED loss 62.5%", "speed delayed 750ms", "NOTCH_CMD.NotchCmd offset -2.5"
    ]  # fmt: skip
    again = made(replace(spec, orders=orders_of(by_hand)), tmp_path / "again")
    assert again.log.path.read_bytes() == by_hand.log.path.read_bytes()
    # The values act: the faults as they were prepared make another run.
    plain = tuple(text for text in orders_of(by_hand) if " value " not in text)
    other = made(replace(spec, orders=plain), tmp_path / "plain")
    assert other.trace.raw("NOTCH_CMD", "NotchCmd").tolist() != by_hand.trace.raw("NOTCH_CMD", "NotchCmd").tolist()


@pytest.mark.parametrize(
    ("scenario", "level"),
    [("hst_short", "service_brake"), ("emu3_short", "service_brake"), ("yizhuang_stop", "emergency")],
)
def test_the_emergency_button_of_every_train_makes_the_same_run_again(scenario, level, tmp_path):
    """A press of the button, its release, and the stop of the run are telegrams; their list makes the same bytes."""
    laws = {"hst_short": "pid", "emu3_short": "pid", "yizhuang_stop": "ilc_stop"}
    spec = RunSpec(
        scenario, law=LawSpec(controller=laws[scenario], arithmetic="float64"), faults=("safety_loop off @manual",)
    )
    presses = {4: [{"do": "inject", "fault": 1}], 12: [{"do": "clear", "fault": 1}], 20: [{"do": "stop"}]}
    by_hand = made(spec, tmp_path / "hand", Hands(presses))
    assert [text.partition(" ")[2] for text in orders_of(by_hand)] == ["inject 1", "clear 1", "stop"]
    trace = by_hand.trace
    assert trace.raw(SupCmd.PORT, "FaultOrder").tolist().count(FaultOrder.INJECT) == 1
    taken = [event for event in events_of(by_hand.scenario, trace) if event.kind == LEVEL]
    assert [(event.level, event.cause) for event in taken][-1] == (level, "")
    again = made(replace(spec, orders=orders_of(by_hand)), tmp_path / "again")
    assert again.log.path.read_bytes() == by_hand.log.path.read_bytes()


@pytest.mark.slow
def test_without_orders_nothing_is_different(spec, tmp_path):
    by_hand = made(spec, tmp_path / "by_hand", Hands({}))
    assert by_hand.log.path.read_bytes() == made(spec, tmp_path / "none").log.path.read_bytes()
    assert orders_of(by_hand) == ()


def test_the_recorder_has_the_time_of_the_run_with_prepared_faults(spec, tmp_path):
    """It judges TIME_SYNC by the ticks that it has seen, and takes the pace from it."""
    run = made(spec, tmp_path / "run")
    assert [cause for cause in run.session.counters if cause.startswith("time_")] == []
