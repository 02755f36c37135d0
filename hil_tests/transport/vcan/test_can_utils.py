"""can-utils with railhil's nodes: they see the same frames as the record, and the nodes tolerate what they
send."""

from __future__ import annotations

import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from hil_tests.support.candump import candump_line
from hil_tests.transport.vcan.bench import counters_of, run_on, socketcan
from hil_tests.transport.vcan.dump import Dump, frames_of
from railhil.bus.frame import ERROR, Frame
from railhil.bus.link import open_link
from railhil.bus.mvb import F_DEVICE_STATUS
from railhil.bus.order import BusOrder
from railhil.controller_node.ato.node import ControllerNode
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of
from railhil.scenarios.run_spec import LawSpec
from railhil.wire.ato import NotchCmd

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600), pytest.mark.usefixtures("can_utils")]

#: No telegram: where ports of ours have their check sequence is none.
_NO_TELEGRAM = bytes.fromhex("DEADBEEFDEADBEEF")
_SO_RCVBUFFORCE = 33


def record_of(frames: list[Frame]) -> list[Frame]:
    """What a record has of the bus: from the first telegram of the run, without device status, in the order of the
    wire."""
    contract = wire_contract()

    def is_status(frame: Frame) -> bool:
        scan = frame.can_id == contract.poll_id and frame.data[0] >> 4 == F_DEVICE_STATUS
        return scan or frame.can_id == contract.device_status_id

    for source in ("controller", "supervisor"):
        order = BusOrder(wire_contract(), source, patience_s=0.0)
        frames = [item for frame in frames for item in order.feed(frame)] + order.flush()
    opening = contract.port("PLT_IDENT").address
    start = next(index for index, frame in enumerate(frames) if frame.can_id == opening)
    return [frame for frame in frames[start:] if not is_status(frame)]


@contextmanager
def load(*options: str) -> Iterator[None]:
    """``cangen`` on vcan0 with these options."""
    process = subprocess.Popen(["cangen", "vcan0", *options])
    try:
        yield
        assert process.poll() is None, "cangen has ended by itself"
    finally:
        process.terminate()
        process.wait()


def test_candump_sees_the_record_frame_for_frame(hop, hop_reference, folder):
    with Dump(folder / "candump.log") as dump:
        result, exit_codes = run_on(socketcan(), hop, folder)
    assert (result.line, exit_codes, result.frames_sha256) == ("", [0, 0], hop_reference.frames_sha256)
    assert record_of(dump.frames()) == frames_of(folder / "frames.log")


@pytest.mark.faults
def test_cansend_is_heard_and_error_frames_are_no_telegrams(hop, hop_reference, folder):
    """20000100# (restarted) has the number of TIME_SYNC, 20000040# is bus-off until then."""
    sent = ["7F3#DEADBEEF", "20000004#0010000000000000", "20000040#", "20000100#"]
    started: list[subprocess.Popen[bytes]] = []

    def send(time_s: float) -> None:
        if time_s > 3.0 and not started:
            script = "; ".join(f"cansend vcan0 {frame}" for frame in sent)
            started.append(subprocess.Popen(["sh", "-c", script]))

    result, exit_codes = run_on(socketcan(), hop, folder, on_progress=send)
    assert [process.wait(30) for process in started] == [0]
    assert (result.line, exit_codes, result.score) == ("", [0, 0], hop_reference.score)
    frames = frames_of(folder / "frames.log")
    assert frames.count(Frame(0x7F3, b"\xde\xad\xbe\xef")) == 1
    assert len([frame for frame in frames if frame.flags & ERROR]) == 3
    assert [frame for frame in frames if frame.can_id < 0x7F0 and not frame.flags] == frames_of(hop_reference.log)
    for counters in (result.recorder_counters, counters_of(folder, "controller"), counters_of(folder, "plant")):
        assert (counters["error_frames"], counters["bus_off"], counters["outages"]) == (3, 1, 1)


@pytest.mark.faults
def test_load_of_foreign_frames_changes_no_command(hop, hop_reference, folder):
    """Random data under foreign identifiers, and our own ones without a check sequence."""
    fixed = ("-L", "8", "-D", _NO_TELEGRAM.hex())
    with load("-g", "10", "-I", "7A0"), load("-g", "20", "-I", "128", *fixed), load("-g", "30", "-I", "130", *fixed):
        result, exit_codes = run_on(socketcan(), hop, folder)
    assert (result.line, exit_codes, result.score.verdict) == ("", [0, 0], hop_reference.score.verdict)
    frames = frames_of(folder / "frames.log")
    wrong = [frame for frame in frames if frame.data == _NO_TELEGRAM]
    assert {frame.can_id for frame in wrong} == {0x128, 0x130}
    assert any(frame.can_id == 0x7A0 for frame in frames)
    assert [frame for frame in frames if frame.can_id != 0x7A0 and frame.data != _NO_TELEGRAM] == frames_of(
        hop_reference.log
    )
    trace = trace_of(read_log(folder / "frames.log"), wire_contract())
    assert [int(code) for code in trace.raw(NotchCmd.PORT, "NotchCmd")] == hop_reference.commands("notch")
    # PLT_STAT is one frame; of a telegram of several a wrong frame may also take the place of a right one.
    refused = counters_of(folder, "controller")["wrong_check_sequence"]
    assert refused >= len([frame for frame in wrong if frame.can_id == 0x128])


def test_canplayer_and_candump(hop, hop_reference):
    """A controller that hears a recorded run gives the answers of the record. A live dump has the lines of which
    hil_tests/unit/dbc shows that cantools decodes them; to load it here would take ten seconds.
    """
    dump = subprocess.Popen(["candump", "-n", "60", "vcan0"], stdout=subprocess.PIPE, text=True)
    contract = wire_contract()
    own_ids = {can_id for port in contract.ports if port.source == "controller" for can_id in port.can_ids}
    node = ControllerNode(hop, LawSpec())
    link = open_link(socketcan())
    # The player does not wait for a slow machine; root may have a buffer for all of it.
    link.bus.socket.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, 16 << 20)
    player = subprocess.Popen(["canplayer", "-I", str(hop_reference.log), "vcan0=mvb0"])
    answers: list[Frame] = []
    deadline_s = time.monotonic() + 120.0
    try:
        while node.ended is None and time.monotonic() < deadline_s:
            for frame in link.receive(0.5):
                answers += node.handle(frame)
        assert player.wait(60) == 0
        text, _ = dump.communicate(timeout=60)
    finally:
        link.close()
        for process in (player, dump):
            process.kill()
            process.wait()
    assert link.counters["rx_lost"] == 0
    recorded = frames_of(hop_reference.log)
    assert answers == [frame for frame in recorded if frame.can_id in own_ids]
    # The answers of this controller are between the frames of the player, which does not wait for them.
    assert len(text.splitlines()) == 60
    assert set(text.splitlines()) <= {candump_line(frame, "vcan0") for frame in recorded}
