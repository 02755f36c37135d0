"""A node's link on a serial adapter: whole lines, garbage, a stuck adapter, a full port, unplugged and back."""

from __future__ import annotations

import select
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from railhil.bus.errors import BusLost
from railhil.bus.frame import BRS, FD, REMOTE, Frame
from railhil.bus.link import Timeouts, open_link, slcan
from railhil.bus.link.single import SingleLink
from railhil.bus.link.slcan import STALE_NS, SlcanLink
from railhil.bus.link.slcanline import from_line, to_line
from railhil.bus.mvb import TelegramSource
from railhil.machines.adapter.terminal import Terminal
from railhil.wire.ato import NotchCmd

_WAIT_S = 5.0
#: Long enough that a frame without an answer is stale.
_STALE_S = 2 * STALE_NS / 1e9


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[Terminal]:
    """The adapter's port, plugged in; the test is the adapter."""
    port = Terminal(tmp_path / "tty")
    port.plug_in()
    yield port
    port.pull_out()


def opened(terminal: Terminal, **timeouts: float) -> SlcanLink:
    """A link on the port; what python-can says to open the channel is read."""
    config = {"interface": "slcan", "channel": str(terminal.link), "bitrate": 500_000, "sleep_after_open": 0}
    link = open_link(config, "node", timeouts=Timeouts(**timeouts))
    assert isinstance(link, SlcanLink)
    assert heard(terminal, 5)[-1] == b"O"
    return link


@pytest.fixture
def link(terminal: Terminal) -> Iterator[SlcanLink]:
    """An opened link."""
    found = opened(terminal)
    yield found
    found.close()


def heard(terminal: Terminal, count: int) -> list[bytes]:
    """The next ``count`` lines that the node has written."""
    data = b""
    while data.count(b"\r") < count:
        assert select.select((terminal,), (), (), _WAIT_S)[0], data
        data += terminal.read(4096)
    return data.split(b"\r")[:-1]


def until(condition: Callable[[], object]) -> None:
    """Repeat until true; the kernel hands bytes over in its own time."""
    deadline_s = time.monotonic() + _WAIT_S
    while not condition():
        assert time.monotonic() < deadline_s


def notches(*lives: int) -> list[Frame]:
    """NOTCH_CMD frames that differ in their life sign."""
    return [TelegramSource(NotchCmd.port()).frames(NotchCmd(256, life=life).encode())[0] for life in lives]


def received(link: SlcanLink, count: int) -> list[Frame]:
    frames: list[Frame] = []
    until(lambda: len(frames.__iadd__(link.receive(0.1))) >= count)
    return frames


# -- frames -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("end", [b"\r", b"\r\n", b"\n"])
@pytest.mark.parametrize("size", [1, 7, 4096])
def test_frames_of_every_kind_come_in_one_piece(terminal, link, end, size):
    sent = [Frame(0x118, bytes(8)), Frame(0x110, bytes(3), REMOTE), Frame(0x118, bytes(64), FD | BRS), *notches(1)]
    data = b"".join(to_line(frame) + end for frame in sent)
    for start in range(0, len(data), size):
        terminal.write(data[start : start + size])
    assert received(link, len(sent)) == sent
    link.send(sent)
    assert [from_line(line) for line in heard(terminal, len(sent))] == sent
    assert (link.counters["sent"], link.counters["received"], link.counters["garbage"]) == (4, 4, 0)


@pytest.mark.parametrize(
    ("garbage", "lines"),
    [(b"t1188XX\r", 1), (b"\xff\xfe\x00\r", 1), (b"t9\rhello\r", 2), (b"x" * 1000 + b"\r", 1), (b"t118F\a", 1)],
)
def test_garbage_is_counted_and_costs_no_other_frame(terminal, link, garbage, lines):
    first, second = notches(1, 2)
    terminal.write(to_line(first) + b"\r" + garbage + to_line(second) + b"\r")
    assert received(link, 2) == [first, second]
    assert link.counters["garbage"] >= lines
    assert link.counters["outages"] == 0


def test_time_stamps_of_the_adapter_are_dropped(terminal, link):
    (frame,) = notches(1)
    terminal.write(to_line(frame) + b"03E8\r")
    assert received(link, 1) == [frame]


def test_an_answer_that_ends_with_cr_lf_is_one_answer(terminal, link):
    """Else the second one would be taken for that to the next frame."""
    link.send(notches(1, 2))
    heard(terminal, 2)
    for part in (b"z\r", b"\n"):
        terminal.write(part)
        link.receive(0.02)
    assert len(link._unanswered) == 1
    assert link.counters["garbage"] == 0


def test_input_that_is_never_a_frame_is_said_while_the_node_runs(terminal, link, capfd):
    terminal.write(b"slcan v9.9\r" * 19)
    link.receive(0.05)
    assert "no frame in it" not in capfd.readouterr().err
    terminal.write(b"slcan v9.9\r" * 60)
    until(lambda: link.receive(0.02) == [] and link.counters["garbage"] == 79)
    assert capfd.readouterr().err.count("no frame in it") == 1


# -- a stuck adapter ----------------------------------------------------------------------------------------------


def answering(terminal: Terminal, link: SlcanLink) -> None:
    """Let the link know an adapter that answers."""
    link.send(notches(0))
    heard(terminal, 1)
    terminal.write(b"z\r")
    until(lambda: link.receive(0.02) == [] and link._answers)


def test_nothing_stale_waits_for_an_adapter_that_hangs(terminal, link):
    """It reads again after 40 notches: of these only the first is there, which it was too late to take back."""
    answering(terminal, link)
    for life in range(1, 41):
        link.send(notches(life % 16))
        if life in (1, 20):
            time.sleep(_STALE_S)
    assert [line for line in heard(terminal, 2) if line] == [to_line(notches(1)[0])]
    assert link.counters["send_dropped"] == 39
    assert link.counters["adapter_stuck"] == 1
    terminal.write(b"z\r\r")
    link.receive(0.05)
    link.send(notches(9))
    assert heard(terminal, 1) == [to_line(notches(9)[0])]


@pytest.mark.parametrize("sign", [b"F00\r\r", b"\r"], ids=["state", "answer"])
def test_an_adapter_whose_answer_was_lost_is_sent_to_again(terminal, link, sign, capfd):
    """Its next sign of life counts, whatever it is: the state that it was asked for, or the answer to an empty line."""
    answering(terminal, link)
    time.sleep(slcan._SILENCE_S)
    link.send(notches(1))
    assert link.receive(0.0) == []
    assert heard(terminal, 2) == [to_line(notches(1)[0]), b"F"], "the question stands behind the frame"
    time.sleep(_STALE_S)
    link.send(notches(2))
    assert link.counters["send_dropped"] == 1
    terminal.write(sign)
    link.receive(0.05)
    before = link.counters["sent"]
    link.send(notches(3))
    assert link.counters["sent"] == before + 1
    assert capfd.readouterr().err == "", "no pause worth a word"


def test_a_long_pause_is_said_at_its_begin_and_end(terminal, link, capfd):
    answering(terminal, link)
    link.send(notches(1))
    time.sleep(0.25)
    link.send(notches(2, 3, 4))
    terminal.write(b"z\r")
    link.receive(0.05)
    said = capfd.readouterr().err.splitlines()
    assert len(said) == 2, said
    assert f"node: slcan:{terminal.link} takes no frames for 0." in said[0]
    assert f"node: slcan:{terminal.link} takes frames again after 0." in said[1]


def test_unplugged_while_it_hangs(terminal, link):
    answering(terminal, link)
    link.send(notches(1))
    time.sleep(_STALE_S)
    terminal.pull_out()
    link.send(notches(2))
    assert link.is_down


def test_in_lockstep_every_frame_waits_for_the_adapter(terminal, link):
    link.lossless = True
    answering(terminal, link)
    for life in range(1, 6):
        link.send(notches(life))
        time.sleep(_STALE_S)
    assert [from_line(line) for line in heard(terminal, 5)] == notches(1, 2, 3, 4, 5)
    assert link.counters["send_dropped"] == 0


def test_an_adapter_that_never_answers_is_no_stuck_one(terminal, link):
    for life in range(3):
        link.send(notches(life))
        time.sleep(_STALE_S)
    assert [from_line(line) for line in heard(terminal, 3)] == notches(0, 1, 2)


def test_a_full_port_makes_room_for_the_newest_frame(terminal, link):
    """Without answers the computer's own buffer is all that tells; it holds some hundred frames."""
    count = 3000
    for life in range(count):
        link.send(notches(life % 16))
    # The last lines are whole, one follows the other.
    lines = b"\r".join(iter(lambda: terminal.read(4096), b"")).split(b"\r")
    assert link.counters["sent"] == count
    assert link.counters["adapter_stuck"] > 0
    assert from_line(lines[-2]) == notches((count - 1) % 16)[0]
    assert len(lines) < count // 2


def test_refused_frames_are_counted(terminal, link):
    terminal.write(b"\a\r\r\a")
    link.receive(0.1)
    link.send(notches(0, 1, 2))
    terminal.write(b"z\r\az\r")
    until(lambda: link.receive(0.05) == [] and link.counters["adapter_refused"])
    assert link.counters["adapter_refused"] == 1, "answers to commands are none to frames"


def test_a_frame_that_is_refused_in_lockstep_ends_the_node(terminal):
    """The frames behind it may be on the bus already: what is left is no record of lockstep."""
    link = opened(terminal, opening_s=0.0)
    link.lossless = True
    link.send(notches(0, 1))
    terminal.write(b"z\r\a")
    with pytest.raises(BusLost, match="refused a frame"):
        until(lambda: link.receive(0.1))
    assert link.counters["adapter_refused"] == 1
    link.close()


def test_a_late_answer_to_the_opening_is_no_refused_frame(terminal, link):
    """python-can opens the channel twice, and does not wait for what is answered: BELL, the second time."""
    link.lossless = True
    link.send(notches(0))
    terminal.write(b"\a")
    assert link.receive(0.05) == []
    assert not link.is_down


@pytest.mark.parametrize("answer", [b"\a", b"F00\r", b""])
def test_the_answer_to_the_question_for_the_state_is_none_to_a_frame(terminal, answer):
    """Adapters that do not know the question answer BELL, or nothing."""
    link = opened(terminal, opening_s=0.0)
    link.lossless = True
    until(lambda: link.receive(0.05) == [] and select.select((terminal,), (), (), 0.0)[0])
    questions = heard(terminal, 1)
    assert set(questions) == {b"F"}
    link.send(notches(0))
    terminal.write(answer * len(questions) + b"z\r")
    assert link.receive(0.01) == []
    link.send(notches(1))
    # More than one: a slow machine may have asked once more.
    terminal.write(b"\a\a\a")
    with pytest.raises(BusLost, match="refused a frame"):
        until(lambda: link.receive(0.1))
    link.close()


def test_an_adapter_of_another_protocol_is_no_slcan_adapter(terminal):
    """python-can's robotell keeps its port under the same name."""
    link = open_link({"interface": "robotell", "channel": str(terminal.link)}, "node")
    assert type(link) is SingleLink
    terminal.read(4096)
    link.send(notches(1))
    written = terminal.read(4096)
    assert written.startswith(b"\xaa\xaa"), written
    link.close()


@pytest.mark.parametrize("half", [b"\xaa\0\0", b"\xaa\0\0\0\0", b"\xaa\0\0\0\0\x01\x18\x01\0\0\x07"])
def test_half_a_frame_on_a_serial_line_is_garbage(terminal, half):
    """Of which python-can's reader raises struct.error or TypeError."""
    link = open_link({"interface": "serial", "channel": str(terminal.link)}, "node")
    terminal.write(half)
    until(lambda: link.receive(0.0) == [] and link.counters["garbage"])
    assert (link.counters["garbage"], link.is_down) == (1, False)
    link.close()


# -- gone and back ------------------------------------------------------------------------------------------------


def test_unplugged_and_plugged_in_again(terminal, link, capfd):
    terminal.pull_out()
    assert link.receive(0.1) == []
    assert link.is_down
    link.send(notches(1))
    assert link.receive(0.05) == []
    terminal.plug_in()
    until(lambda: link.receive(0.2) == [] and not link.is_down)
    link.send(notches(2))
    assert [from_line(line) for line in heard(terminal, 6)[5:]] == notches(2), "the old frame is not sent late"
    said = capfd.readouterr().err.splitlines()
    assert len(said) == 2, said
    assert said[0].startswith(f"node: slcan:{terminal.link} is down (")
    assert said[1].startswith(f"node: slcan:{terminal.link} is back after ")
    assert (link.counters["outages"], link.counters["send_dropped"], link.counters["sent"]) == (1, 1, 1)


def test_unplugged_while_sending(terminal, link):
    terminal.pull_out()
    link.send(notches(1))
    assert link.is_down
    assert link.counters["send_dropped"] == 1


def test_one_that_stays_away_is_lost(terminal):
    link = opened(terminal, give_up_s=0.3)
    terminal.pull_out()
    with pytest.raises(BusLost, match=r"^slcan:.*tty: .*not back within"):
        until(lambda: link.receive(0.1))
    link.close()


def test_bus_off_is_asked_for_and_said(terminal, link, capfd):
    assert link.receive(0.1) == []
    assert set(heard(terminal, 1)) == {b"F"}, "an adapter from which nothing comes is asked"
    terminal.write(b"F00\r")
    assert link.receive(0.1) == []
    assert not link.is_down
    terminal.write(b"FA4\r")
    until(lambda: link.receive(0.05) == [] and link.is_down)
    assert "is down (the adapter reports bus errors, status A4" in capfd.readouterr().err
    (frame,) = notches(3)
    terminal.write(to_line(frame) + b"\r")
    assert received(link, 1) == [frame]
    assert not link.is_down
    assert link.counters["bus_off"] == 1


@pytest.mark.parametrize("waits_s", [[0.005] * 60, [0.3]])
def test_silence_counts_over_short_waits_and_within_a_long_one(terminal, link, waits_s):
    """A plant in realtime waits 5 ms at a time; in lockstep as long as it waits for an answer at all."""
    for wait_s in waits_s:
        assert link.receive(wait_s) == []
    assert len(heard(terminal, 2)) >= 2


def test_in_lockstep_a_frame_that_waits_out_bus_off_asks_when_it_is_over(terminal, link):
    """Nobody else need speak: they wait for this very frame."""
    link.lossless = True
    terminal.write(b"FA4\r")
    until(lambda: link.receive(0.05) == [] and link.is_down)
    asked: list[bytes] = []
    lines: list[bytes] = []

    def restart() -> None:
        if select.select((terminal,), (), (), 0.0)[0]:
            asked.append(terminal.read(4096))
            terminal.write(b"F00\r")

    link.while_waiting = restart
    link.send(notches(4))
    assert asked[0].startswith(b"F")
    # An adapter that takes its time is asked again; the frame stands behind every question.
    until(lambda: any(line != b"F" for line in lines.__iadd__(heard(terminal, 1))))
    assert [from_line(line) for line in lines if line != b"F"] == notches(4)
