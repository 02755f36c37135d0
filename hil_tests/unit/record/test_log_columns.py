"""A log read as columns has the same frames as its lines one by one."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.bus.frame import EXTENDED, Frame
from railhil.common.errors import InputError
from railhil.record.framelog import CHANNEL, log_line, log_parts, parsed_line, read_log
from railhil.record.log_columns import ClassicColumns, classic_columns

#: More than one part of a file.
FRAMES = [
    (i * 7_001_000, Frame(i * 37 % 0x800, (i * 2_654_435_761).to_bytes(8, "big")[: i * 5 % 9])) for i in range(40_000)
]
GOOD = "(3.000001) mvb0 100#0102 R\n"


def written(path: Path, frames: list[tuple[int, Frame]]) -> Path:
    path.write_text("".join(log_line(*frame) for frame in frames), encoding="ascii")
    return path


def test_columns_and_lines_have_the_same_frames(tmp_path: Path) -> None:
    log = written(tmp_path / "frames.log", FRAMES)
    parts = list(log_parts(log))
    assert len(parts) > 1
    assert all(isinstance(part, ClassicColumns) for part in parts)
    assert list(read_log(log)) == FRAMES == [parsed_line(line) for line in log.read_text().splitlines(keepends=True)]


def test_an_unusual_frame_in_one_part_changes_no_other(tmp_path: Path) -> None:
    frames = [*FRAMES, (300_000_000_000, Frame(0x1ABCDEF, b"\1", EXTENDED))]
    assert list(read_log(written(tmp_path / "frames.log", frames))) == frames


@pytest.mark.parametrize(
    "other",
    [
        "(3.000001) can0 100#0102 R\n",
        "(3.000001) mvb0 100#0102\n",
        "(3.000001) mvb0 100#010g R\n",
        "(3.000001) mvb0 100#010 R\n",
        "(3.000001) mvb0 800#0102 R\n",
        "(3.000001) mvb0 100##10102 R\n",
        "(3.000001) mvb0 100#R R\n",
        "(3.000001) mvb0 00000100#0102 R\n",
        "(3.00001) mvb0 100#0102 R\n",
        "(3000000000000.000001) mvb0 100#0102 R\n",
        "(x.000001) mvb0 100#0102 R\n",
        "(.000001) mvb0 100#0102 R\n",
        "(3.000001) mvb0 100#010203040506070809 R\n",
        "\n",
        "(3.000001) mvb0 100#0102 R",
    ],
)
def test_lines_that_are_not_those_of_a_run_are_read_one_by_one(other: str) -> None:
    assert classic_columns((GOOD + GOOD).encode(), CHANNEL) is not None
    assert classic_columns((GOOD + other).encode(), CHANNEL) is None
    assert classic_columns((other + GOOD).encode(), CHANNEL) is None


def test_the_number_of_a_bad_line_counts_the_parts_before(tmp_path: Path) -> None:
    log = written(tmp_path / "frames.log", FRAMES)
    with log.open("a") as stream:
        stream.write(f"{GOOD}no line\n")
    with pytest.raises(InputError, match=f"line {len(FRAMES) + 2}: found 'no line'"):
        list(read_log(log))
