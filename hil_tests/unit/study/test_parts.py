"""Parts of a study: damaged, torn and foreign ones are noticed, and made again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pyarrow as pa
import pytest

from hil_tests.support.toy_study import TOY, Chunk, ChunkWork, Plan, Request, contents, make
from railhil.study.execute import Stopped
from railhil.study.table import NotThePart, file_bytes, read_part

PLAN = Plan(Request(runs=60, chunk=20))
CHUNK = PLAN.chunks()[1]
ROWS = TOY.work(PLAN, CHUNK).rows()


@pytest.fixture
def part(tmp_path: Path) -> Path:
    path = tmp_path / "part.parquet"
    path.write_bytes(file_bytes(ROWS, PLAN.origin(CHUNK)))
    return path


def test_a_part_is_read_back(part: Path) -> None:
    assert read_part(part, TOY, PLAN, CHUNK).replace_schema_metadata() == ROWS


def test_the_same_rows_are_the_same_bytes(part: Path) -> None:
    pieces = pa.concat_tables([ROWS.slice(at, 3) for at in range(0, 20, 3)])
    assert file_bytes(pieces, PLAN.origin(CHUNK)) == part.read_bytes()


@pytest.mark.parametrize("share_kept", [0.0, 0.3, 0.99])
def test_a_torn_part_is_noticed(part: Path, share_kept: float) -> None:
    content = part.read_bytes()
    part.write_bytes(content[: int(len(content) * share_kept)])
    with pytest.raises(NotThePart, match="torn or damaged"):
        read_part(part, TOY, PLAN, CHUNK)


def test_a_flipped_bit_changes_no_figure(part: Path) -> None:
    """What the checksums of the pages leave out (page headers) does not reach the rows."""
    content, noticed = part.read_bytes(), 0
    places = range(0, len(content), 7)
    for place in places:
        flipped = bytearray(content)
        flipped[place] ^= 1
        part.write_bytes(flipped)
        try:
            found = read_part(part, TOY, PLAN, CHUNK)
        except NotThePart:
            noticed += 1
        else:
            assert found.replace_schema_metadata() == ROWS, place
    assert noticed > len(places) / 2


def test_a_part_of_other_runs_is_noticed(part: Path) -> None:
    with pytest.raises(NotThePart, match="of other runs"):
        read_part(part, TOY, PLAN, PLAN.chunks()[0])
    part.write_bytes(file_bytes(ROWS, PLAN.origin(PLAN.chunks()[0])))
    with pytest.raises(NotThePart, match="with other seeds"):
        read_part(part, TOY, PLAN, PLAN.chunks()[0])
    part.write_bytes(file_bytes(ROWS.drop_columns("square"), PLAN.origin(CHUNK)))
    with pytest.raises(NotThePart, match="with other columns"):
        read_part(part, TOY, PLAN, CHUNK)


def test_a_part_whose_work_cannot_be_made_is_not_the_end_of_the_study(tmp_path: Path) -> None:
    def work(plan: Plan, chunk: Chunk) -> ChunkWork:
        return ChunkWork([chunk.seeds][chunk.index], plan.request.code)

    with pytest.raises(Stopped, match="IndexError: list index out of range; 1 of 3 runs are kept"):
        make(Request(runs=3), tmp_path / "toy", study=replace(TOY, work=work))


def test_only_what_is_missing_or_damaged_is_made(tmp_path: Path) -> None:
    request, folder = Request(runs=6), tmp_path / "toy"
    make(request, folder)
    whole = contents(folder)
    parts = [folder / "parts" / f"toy-0000{index}.parquet" for index in range(6)]
    times_ns = [part.stat().st_mtime_ns for part in parts]
    parts[1].unlink()
    parts[2].write_bytes(parts[3].read_bytes())
    (folder / "results.parquet").unlink()
    (folder / "parts" / ".part-x").touch()
    _, said = make(request, folder)
    assert said[:2] == [
        f"{parts[2]} is of other runs: its 1 run is made again",
        f"{folder}: 4 of 6 runs are there already",
    ]
    assert [part.stat().st_mtime_ns == then for part, then in zip(parts, times_ns, strict=True)] == [
        True, False, False, True, True, True,
    ]  # fmt: skip
    assert contents(folder) == whole
