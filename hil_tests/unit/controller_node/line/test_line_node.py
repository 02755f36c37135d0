"""The node of a line: its mailboxes, its answers to the polls, and runs with the train of the plant."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.unit.controller_node.line.world import four_stops
from railhil.bus.layout import FLAG_FALSE, FLAG_TRUE
from railhil.controller_node.ecan.mailboxes import MAILBOXES_MAX, mailbox_table
from railhil.controller_node.line.node import LineNode
from railhil.controller_node.line.stations import Drive
from railhil.record.log_trace import trace_of_log
from railhil.run.local import local_run
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.wire.ato import NotchCmd
from railhil.wire.line import AtoStat, AtoState, AtpStat, DoorCmd, DoorOrder


def test_all_mailboxes_of_the_chip_are_taken_and_the_protection_has_one() -> None:
    node = LineNode(four_stops(), LawSpec("ipfc"))
    contract = four_stops().installed_system.contract
    received, sent = ([contract.port(kind.PORT) for kind in side] for side in node.mailbox_telegrams(False))
    table = mailbox_table(contract, received, sent)
    assert len(table) == MAILBOXES_MAX
    assert not {AtpStat.PORT, "SIM_TRUTH"} & {box.port for box in table}
    assert {box.port for box in table if box.transmit} >= {DoorCmd.PORT, AtoStat.PORT, NotchCmd.PORT}


def test_before_the_first_telegram_the_train_is_held_and_no_door_is_ordered() -> None:
    node = LineNode(four_stops(), LawSpec("ipfc"))
    answers = node.answers(False)
    door, state = answers[DoorCmd.PORT](), answers[AtoStat.PORT]()
    assert isinstance(door, DoorCmd)
    assert (door.order, door.hold_brake, door.depart_ready) == (DoorOrder.NONE, FLAG_TRUE, FLAG_FALSE)
    assert isinstance(state, AtoStat)
    assert (state.state, state.ready, state.section) == (AtoState.INITIALISING, FLAG_FALSE, 0)
    assert (node.stations.drive, node.controller.telemetry.steps) == (Drive.NONE, 0)


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
def test_the_train_serves_all_stops_of_a_line(tmp_path: Path, arithmetic: str) -> None:
    line = four_stops()
    undisturbed = replace(
        line,
        route=replace(line.route, dwell_disturbance_s=replace(line.route.dwell_disturbance_s, high=0.0),
                      hold=replace(line.route.hold, probability=0.0)),
    )  # fmt: skip
    result = local_run(undisturbed, tmp_path, RunSpec(law=LawSpec("ipfc_plus", arithmetic)))
    trace = trace_of_log(tmp_path / "frames.log", line.installed_system.contract)
    # Each event is told several times.
    numbered = zip(
        *(trace.values("RUN_EVENT", name) for name in ("EventNumber", "RunEvent", "EventPos", "EventTime")), strict=True
    )
    happened = {int(number): (int(event), place_m, time_s) for number, event, place_m, time_s in numbered}.values()
    arrived = [(place_m, time_s) for event, place_m, time_s in happened if event == 32]
    assert [place_m for place_m, _ in arrived] == pytest.approx([1200, 3420], abs=0.03)
    assert [time_s for _, time_s in arrived] == pytest.approx([137, 340], abs=0.5)
    events = {event for event, _, _ in happened}
    assert {33, 34, 35, 36} <= events
    assert not {37, 38, 39, 40} & events
    assert set(trace.raw("NOTCH_CMD", "CtlCause")) == {0}
    assert set(result.counters["controller"]) <= {"no_mailbox"}


@pytest.mark.long
@pytest.mark.slow
def test_a_law_that_stops_short_is_crept_to_the_stopping_point(tmp_path: Path) -> None:
    line = four_stops()
    result = local_run(line, tmp_path, RunSpec(law=LawSpec("ipfc")))
    trace = trace_of_log(tmp_path / "frames.log", line.installed_system.contract)
    events = set(trace.raw("RUN_EVENT", "RunEvent"))
    assert result.counters["controller"].get("jogs", 0) >= 1
    assert {34, 38} <= events
    assert 37 not in events
    states = set(trace.raw("ATO_STAT", "AtoState"))
    assert {AtoState.RUN, AtoState.JOG, AtoState.OPEN, AtoState.WARN, AtoState.CLOSING, AtoState.READY} <= states
    assert set(trace.raw("NOTCH_CMD", "CtlCause")) == {0}
