"""Logs in Vector's ASC, packed logs, and suffixes in capital letters are read as the candump log of the same frames."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest
from can.io import ASCWriter
from hypothesis import given
from hypothesis import strategies as st

from railhil.bus.frame import BRS, EXTENDED, FD, REMOTE, Frame, to_message
from railhil.common.errors import InputError
from railhil.dbc import wire_contract
from railhil.record.blf_writer import write_blf
from railhil.record.framelog import log_line, log_sha256, read_log, sha256_of
from railhil.record.log_trace import trace_of_log

FRAMES = [
    (0, Frame(0x100, b"\1\2")),
    (1_000, Frame(0x7FF, b"")),
    (123_456_789_000, Frame(0x1ABCDEF, bytes(8), EXTENDED)),
    (195_999_999_000, Frame(0x123, bytes(12), FD | BRS)),
    (196_000_001_000, Frame(0x124, bytes(range(64)), FD)),
]


def _asc(path: Path, frames: list[tuple[int, Frame]]) -> Path:
    with ASCWriter(path) as writer:
        for time_ns, frame in frames:
            writer.on_message_received(to_message(frame, time_ns / 1e9))
    return path


def _log(folder: Path, frames: list[tuple[int, Frame]]) -> Path:
    path = folder / "frames.log"
    path.write_text("".join(log_line(*frame) for frame in frames), encoding="ascii")
    return path


def test_an_asc_of_python_can_has_the_frames_and_hash_of_the_log(tmp_path: Path) -> None:
    log, asc = _log(tmp_path, FRAMES), _asc(tmp_path / "seen.asc", FRAMES)
    assert list(read_log(asc)) == list(read_log(log)) == FRAMES
    assert log_sha256(asc) == log_sha256(log) == sha256_of(log)


_FRAMES = st.one_of(
    st.builds(Frame, st.integers(0, 0x7FF), st.binary(max_size=8), st.just(0)),
    st.builds(Frame, st.integers(0, 0x1FFFFFFF), st.binary(max_size=8), st.just(EXTENDED)),
    st.builds(Frame, st.integers(0, 0x7FF), st.binary(max_size=8).map(lambda data: bytes(len(data))), st.just(REMOTE)),
    st.builds(
        Frame, st.integers(0, 0x7FF), st.sampled_from([1, 8, 12, 48, 64]).map(bytes), st.sampled_from([FD, FD | BRS])
    ),
)


@given(st.lists(st.tuples(st.integers(0, 10**11).map(lambda time_us: time_us * 1000), _FRAMES), min_size=1))
def test_every_frame_comes_back_from_an_asc(tmp_path_factory: pytest.TempPathFactory, frames: list) -> None:
    frames.sort(key=lambda one: one[0])
    found = list(read_log(_asc(tmp_path_factory.mktemp("asc") / "a.asc", frames)))
    # python-can's times count from the first frame.
    assert found == [(time_ns - frames[0][0], frame) for time_ns, frame in frames]


OF_CANOE = """\
date Sam Sep 30 15:06:13.191 2017
base hex  timestamps absolute
internal events logged
// version 9.0.0
Begin Triggerblock Sam Sep 30 15:06:13.191 2017
   0.000000 Start of measurement
   0.015991 CAN 1 Status:chip status error passive - TxErr: 132 RxErr: 0
   0.015992 1  Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0.00%
   2.501000 1  168             Rx   d 8 C1 01 02 03 04 05 06 07 Length = 240015 BitCount = 124 ID = 360
   2.510001 1  ErrorFrame
   2.510201 1  54C5638x        Tx   d 1 FF Length = 1704000 BitCount = 145 ID = 88888888x
   2.520002 CANFD   1 Rx        300  Generic_Name_12                  1 0 8 8 01 02 03 04 05 06 07 08   102203  133 303000 e0006659 46500250 4b140250 20011736 2001040d
End TriggerBlock
"""  # noqa: E501


def test_an_asc_of_canoe_is_read(tmp_path: Path) -> None:
    path = tmp_path / "CANOE.ASC"
    path.write_text(OF_CANOE)
    found = list(read_log(path))
    assert [time_ns for time_ns, _ in found] == [2_501_000_000, 2_510_001_000, 2_510_201_000, 2_520_002_000]
    assert found[0][1] == Frame(0x168, bytes([0xC1, 1, 2, 3, 4, 5, 6, 7]))
    assert found[2][1] == Frame(0x54C5638, b"\xff", EXTENDED)
    assert found[3][1] == Frame(0x300, bytes(range(1, 9)), FD | BRS)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("timestamps absolute", "timestamps relative", "its times are relative to the line before"),
        ("d 8 C1 01", "d 8 C1", "a frame has 7 of 8 bytes"),
        ("d 8 C1 01", "d 8 C1 zz", "after frame|cannot be read"),
        ("2.510201 1  54C", "2.510201 2  54C", "frame 3: channel: found 1, allowed 0, as in the first frame"),
        ("2.501000 1", "9999999999999999.0 1", "cannot be read, .*a time of"),
        ("End TriggerBlock\n", "End Trig", "the last line is not whole"),
    ],
)
def test_an_asc_that_cannot_be_taken_as_it_is_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = tmp_path / "seen.asc"
    # The length at the end of CANoe's line would be taken for data.
    path.write_text(OF_CANOE.replace(" Length = 240015 BitCount = 124 ID = 360", "").replace(old, new))
    with pytest.raises(InputError, match=message):
        list(read_log(path))


def test_what_is_no_asc_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "seen.asc"
    for content in (b"", b"(0.0) can0 100#00\n", b"\xff\xfe\x00" * 50 + b"\n"):
        path.write_bytes(content)
        with pytest.raises(InputError, match=r"seen\.asc: has no frame, expected an ASC file"):
            list(read_log(path))


@pytest.mark.parametrize("name", ["frames.log.gz", "FRAMES.LOG.GZ", "frames.blf.gz", "A.BLF", "seen.asc.gz", "A.Asc"])
def test_packed_files_and_capital_letters_are_read_by_every_reader(tmp_path: Path, name: str) -> None:
    log = _log(tmp_path, FRAMES)
    write_blf(log, tmp_path / "frames.blf")
    _asc(tmp_path / "seen.asc", FRAMES)
    kind = next(end for end in ("log", "blf", "asc") if f".{end}" in name.lower())
    content = {"log": log, "blf": tmp_path / "frames.blf", "asc": tmp_path / "seen.asc"}[kind].read_bytes()
    path = tmp_path / "other" / name
    path.parent.mkdir()
    path.write_bytes(gzip.compress(content) if name.lower().endswith(".gz") else content)
    assert list(read_log(path)) == FRAMES
    assert log_sha256(path) == sha256_of(log)
    assert trace_of_log(path, wire_contract()).end_ns == FRAMES[-1][0]


@pytest.mark.parametrize("name", ["frames.log.gz", "frames.blf.gz", "seen.asc.gz"])
def test_a_packed_file_that_is_cut_off_or_damaged_is_one_line(tmp_path: Path, name: str) -> None:
    frames = [(1_000 * i, Frame(0x100, (i * 7919).to_bytes(8, "big"))) for i in range(9_000)]
    log = _log(tmp_path, frames)
    write_blf(log, tmp_path / "frames.blf")
    _asc(tmp_path / "seen.asc", frames)
    packed = gzip.compress((tmp_path / name.removesuffix(".gz")).read_bytes())
    path = tmp_path / name
    for content in (packed[: len(packed) // 2], packed[:-9] + b"\0" * 9, b"no gzip" * 9, b"\x1f\x8b" + bytes(60)):
        path.write_bytes(content)
        with pytest.raises(InputError, match=rf"{name}: .*cannot be (unpacked|read)|has no frame"):
            list(read_log(path))
        with pytest.raises(InputError):
            log_sha256(path)
