"""The exchange of frames over two streams of octets: records in pieces, refusals, bounded waiting, and the C end."""

from __future__ import annotations

import os
import re
import subprocess
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.foreign import build_node, export_node
from railhil.bus.frame import EXTENDED, Frame
from railhil.bus.mvb import master_frame
from railhil.controller_node.pipe import END, FAILURE, FRAME, TEXT, ControllerFailed, Decoder, Pipe, encode
from railhil.scenarios.load import load

_END = bytes((END, 7, 1, 0, 0, 0x10, 0, 0, 0))
_ANSWER = bytes((FRAME, 1, 0x10, 2, 5, 6)) + bytes((TEXT, 2)) + b"hi" + _END
_RECORDS = [(FRAME, Frame(0x110, b"\x05\x06")), (TEXT, b"hi"), (END, _END[1:])]

_FRAMES = st.builds(lambda can_id, data: Frame(can_id, data), st.integers(0, 0x7FF), st.binary(max_size=8))


@given(st.lists(st.integers(1, 5)))
def test_records_may_arrive_in_pieces_of_any_length(lengths: list[int]) -> None:
    decoder, found, rest = Decoder(), [], _ANSWER
    for length in lengths:
        found += list(decoder.feed(rest[:length]))
        rest = rest[length:]
    assert [*found, *decoder.feed(rest)] == _RECORDS


@given(st.lists(_FRAMES, max_size=20))
def test_frames_come_back_as_they_were_sent(frames: list[Frame]) -> None:
    stream = encode(frames)
    assert stream[-1] == END
    assert [record for _, record in Decoder().feed(stream[:-1])] == frames


def test_frames_that_no_mailbox_takes_are_not_sent() -> None:
    assert encode([Frame(0x118, b"", EXTENDED), Frame(0x12345, b"", EXTENDED)]) == bytes((END,))


@contextmanager
def one_line_at_most() -> Iterator[None]:
    try:
        yield
    except ValueError as error:
        refusal = str(error)
    else:
        return
    assert re.fullmatch(r"a (frame|record) with [^\n]*", refusal)


@given(st.binary(max_size=300))
def test_random_octets_are_records_or_one_line(octets: bytes) -> None:
    records = Decoder().feed(octets)
    with one_line_at_most():
        for tag, content in records:
            assert tag in (FRAME, END, TEXT, FAILURE)
            assert not isinstance(content, Frame) or (content.can_id <= 0x7FF and len(content.data) <= 8)


@contextmanager
def _other_end(act: Callable[[int, int], object], patience_s: float = 10.0) -> Iterator[Pipe]:
    """A pipe, and a thread that acts as its controller, with the descriptors of its input and its output."""
    read, answers = os.pipe()
    orders, write = os.pipe()

    def play() -> None:
        act(orders, answers)
        os.close(answers)

    thread = threading.Thread(target=play)
    thread.start()
    yield Pipe("board x", read, write, patience_s)
    os.close(write)
    thread.join()
    os.close(read)
    os.close(orders)


def _say(octets: bytes) -> Callable[[int, int], object]:
    def act(orders: int, answers: int) -> None:
        os.read(orders, 100)
        for octet in octets:
            os.write(answers, bytes((octet,)))

    return act


def test_an_answer_has_its_frames_and_its_figures() -> None:
    with _other_end(_say(_ANSWER)) as pipe:
        answer = pipe.exchange([Frame(0x118, bytes(8))])
    assert (answer.frames, answer.ticks, answer.free_stack) == ([Frame(0x110, b"\x05\x06")], 0x107, 0x10)
    assert pipe.console == ["hi"]


@pytest.mark.parametrize(
    ("octets", "words"),
    [
        (b"", "has ended"),
        (_ANSWER[:-1], "has ended"),
        (bytes((FAILURE, 5)) + b"NaN\n!", "has failed: NaN !"),
        (b"\x09", "sends a record with tag 0x09"),
        (bytes((FRAME, 8, 0, 0)), "sends a frame with identifier 0x800"),
        (bytes((FRAME, 1, 0, 9)), "and 9 octets"),
        (bytes((FRAME, 1, 0, 0)) * 300, "more than 256 frames"),
    ],
)
def test_a_controller_that_fails_is_one_line(octets: bytes, words: str) -> None:
    with _other_end(_say(octets)) as pipe, pytest.raises(ControllerFailed) as error:
        pipe.exchange([])
    assert words in str(error.value)
    assert "\n" not in str(error.value)
    assert error.value.exit_code == 2


def test_a_controller_that_does_not_answer_or_does_not_read_is_given_up() -> None:
    def wait(orders: int, answers: int) -> None:
        event.wait(10)

    event = threading.Event()
    with _other_end(wait, patience_s=0.05) as pipe:
        for frames in ([], [Frame(0x118, bytes(8))] * 20_000):
            with pytest.raises(ControllerFailed, match=r"has not answered for 0\.05 s"):
                pipe.exchange(frames)
        event.set()


@pytest.mark.needs_compiler
@pytest.mark.slow
def test_the_exported_program_answers_over_its_standard_streams_and_refuses_other_octets(tmp_path: Path) -> None:
    export_node(load("lvshun_tieshan"), tmp_path)
    program = build_node(tmp_path)
    poll = master_frame(15, 1)
    with subprocess.Popen([program, "pipe"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        pipe = Pipe("ipfc_node", process.stdout.fileno(), process.stdin.fileno(), 10.0)
        assert [frame.can_id for frame in pipe.exchange([poll, poll]).frames] == [0x88, 0x88]
        assert pipe.exchange([]).frames == []
    assert process.returncode == 0
    done = subprocess.run([program, "pipe"], input=b"\x07", capture_output=True, check=False)
    assert (done.stdout[0], done.returncode) == (FAILURE, 2)
