"""``frames.blf`` is read back unchanged: the same frames, time stamps, hash and score."""

from __future__ import annotations

from pathlib import Path

import pytest
from can.io import BLFWriter

from benchmarks.figures import QUICK_TOML
from hil_tests.support.recordings import recorded_folder
from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame, to_message
from railhil.common.errors import InputError
from railhil.judge.record import checked_record
from railhil.record.blf_writer import write_blf
from railhil.record.framelog import log_line, log_sha256, read_log, sha256_of
from railhil.scenarios.load import load
from railhil.systems.ato.judge.score import score

FRAMES = [
    (0, Frame(0x100, b"\1\2")),
    (1_000, Frame(0x7FF, b"")),
    (123_456_789_000, Frame(0x1ABCDEF, bytes(8), EXTENDED)),
    (123_456_790_000, Frame(0x123, bytes(4), REMOTE)),
    (195_999_999_000, Frame(0x123, bytes(12), FD | BRS)),
    (196_000_001_000, Frame(0x124, bytes(64), FD)),
]


def written(folder: Path, frames: list[tuple[int, Frame]]) -> tuple[Path, Path]:
    log, blf = folder / "frames.log", folder / "frames.blf"
    log.write_text("".join(log_line(*frame) for frame in frames), encoding="ascii")
    write_blf(log, blf)
    return log, blf


def test_frames_and_hash_are_those_of_the_log(tmp_path: Path) -> None:
    log, blf = written(tmp_path, FRAMES)
    assert [time_ns for time_ns, _ in read_log(blf)] == [time_ns for time_ns, _ in FRAMES]
    assert list(read_log(blf)) == list(read_log(log))
    assert log_sha256(blf) == log_sha256(log) == sha256_of(log)


@pytest.mark.parametrize("first_ns", [0, 7_123_456_000])
def test_the_file_is_the_one_that_python_can_writes(tmp_path: Path, first_ns: int) -> None:
    # More than one container, with an object that begins in one and ends in the next.
    many = [(196_000_002_000 + 1_000 * i, Frame(i, bytes([i]) * (i % 9))) for i in range(256)] * 16
    frames = [*FRAMES, (196_000_001_000, Frame(0, bytes(8), ERROR)), (0, Frame(0x7, b"")), *many]
    log, blf = written(tmp_path, [(first_ns + time_ns, frame) for time_ns, frame in frames])
    with BLFWriter(tmp_path / "theirs.blf") as writer:
        for time_ns, frame in read_log(log):
            writer.on_message_received(to_message(frame, time_ns / 1e9))
    assert blf.read_bytes() == (tmp_path / "theirs.blf").read_bytes()


def test_error_frames_are_kept(tmp_path: Path) -> None:
    _, blf = written(tmp_path, [(0, Frame(0x100, b"")), (5_000, Frame(0, bytes(8), ERROR))])
    assert [bool(frame.flags & ERROR) for _, frame in read_log(blf)] == [False, True]


def test_a_record_is_scored_from_either(tmp_path: Path) -> None:
    path = tmp_path / "quick.toml"
    path.write_text(QUICK_TOML, encoding="utf-8")
    scenario = load(path)
    recorded_folder(scenario, tmp_path / "run")
    found = [checked_record(str(tmp_path / "run" / name), str(path)) for name in ("frames.log", "frames.blf")]
    assert score(scenario, found[0].trace) == score(scenario, found[1].trace)
    # The certificate is one of either.
    assert found[0].certificate == found[1].certificate != {}


def test_what_is_no_whole_blf_is_one_line(tmp_path: Path) -> None:
    _, blf = written(tmp_path, [(1_000 * i, Frame(0x100, i.to_bytes(8, "big"))) for i in range(30_000)])
    content = blf.read_bytes()
    for size in (0, 3, 100, 144, 200, len(content) // 2, len(content) - 50):
        blf.write_bytes(content[:size])
        with pytest.raises(InputError, match=r"frames\.blf: .*expected a BLF file"):
            list(read_log(blf))
    blf.write_bytes(b"(0.0) can0 100#00\n" * 20)
    with pytest.raises(InputError, match=r"frames\.blf: .*expected a BLF file"):
        list(read_log(blf))
