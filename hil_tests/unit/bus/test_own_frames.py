"""One rule says which frames are ours, and everyone who reads a bus keeps to it."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.other_frames import CLASSIC, CONTRACT, FD_ONLY, OTHERS
from railhil.bus.frame import BRS, FD, Frame
from railhil.bus.ident import Role
from railhil.bus.mvb import F_DEVICE_STATUS, TelegramSource, device_status_frame, master_frame
from railhil.bus.order import BusOrder
from railhil.bus.own_frames import OwnFrames, answer_ids, no_answer
from railhil.bus.store import TrafficStore
from railhil.dbc import wire_contract
from railhil.record.senders import Findings, Senders
from railhil.record.session import make_session
from railhil.record.trace import TraceReader
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.wire.ato import NotchCmd

OWN = OwnFrames(CONTRACT)
NOTCH = NotchCmd.port()
POLL = master_frame(NOTCH.f_code, NOTCH.address)
ANSWER = TelegramSource(NOTCH).frames(NotchCmd(1, life=1).encode())


def test_each_identifier_has_one_form() -> None:
    assert all(Frame(one, b"") in OWN for one in CLASSIC)
    assert all(Frame(one, b"", FD) in OWN and Frame(one, b"", FD | BRS) in OWN for one in FD_ONLY)
    assert not any(frame in OWN for frame in OTHERS)
    assert not any(Frame(one, b"") in OWN for one in set(range(0x800)) - set(CLASSIC))


def test_the_answers_of_a_node_have_the_identifiers_of_its_telegrams() -> None:
    found = dict(answer_ids(CONTRACT, Role.CONTROLLER))
    (status,) = found.pop((F_DEVICE_STATUS, Role.CONTROLLER))
    assert status == device_status_frame(Role.CONTROLLER, 0).can_id
    made = {TelegramSource(port): port for port in CONTRACT.ports if port.source == "controller"}
    for source, port in made.items():
        sent = [frame.can_id for frame in source.frames(bytes(port.data_bytes))]
        assert list(found.pop((port.f_code, port.address))) == sent
        assert no_answer(sent) == (sent[-1], b"", 0)
    assert (len(made) > 2, found) == (True, {})


def test_the_store_refuses_what_is_not_ours() -> None:
    store = TrafficStore(CONTRACT.ports)
    assert all(store.check(frame).cause for frame in OTHERS)


def test_others_are_recorded_and_move_nothing(tmp_path: Path) -> None:
    """Neither the clock nor the record's beginning, and no answer to a poll of the supervisor."""
    written: list[str] = []
    session = make_session(load("lvshun_tieshan"), written.append, RunSpec())
    assert session.take(OTHERS) == []
    assert (session.recording, session.frames, session.sim_time_s) == (False, 0, 0.0)
    session.recording = True
    assert session.take(OTHERS) == []
    assert (session.frames, session.sim_time_s) == (len(OTHERS), 0.0)
    assert not any(foreign_frames.count for foreign_frames in session.foreign_frames.values())
    senders = Senders(tmp_path, CONTRACT, complete=True)
    list(senders.passing((0, frame) for frame in OTHERS))
    assert senders.findings() == Findings([], [])


def test_others_are_no_answers_and_no_polls_of_a_trace() -> None:
    """A poll between them is answered by the one good frame."""
    reader = TraceReader(CONTRACT)
    reader.take((0, frame) for frame in (*OTHERS, POLL, *OTHERS, *ANSWER, *OTHERS))
    assert (reader.trace.polls, reader.trace.count(NOTCH.name), reader.trace.missed) == (1, 1, [])
    assert reader.trace.foreign == 3 * len(OTHERS)


@pytest.mark.parametrize("fd", [False, True])
def test_others_do_not_change_the_order_of_the_record(fd: bool) -> None:
    answer = TelegramSource(NOTCH, fd).frames(NotchCmd(1, life=1).encode())
    order = BusOrder(wire_contract(), fd=fd, patience_s=0.0)
    assert [item for frame in OTHERS for item in order.feed(frame)] == OTHERS
    # What comes between a poll and its answer stands after both, wherever it was seen.
    found = [item for frame in (POLL, *OTHERS, *answer) for item in order.feed(frame)]
    assert found == [POLL, *answer, *OTHERS]
