"""A log of another program: the record's own time is used, or the log is refused with the line number."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil import library
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.common.errors import InputError
from railhil.dbc import wire_contract
from railhil.judge.record import checked_record
from railhil.record.framelog import log_line, read_log, sha256_of
from railhil.record.own_time import own_time
from railhil.scenarios.load import load

_Line = tuple[int, str]
_STAMP = re.compile(r"\((\d+)\.(\d{6})\) (.*\n)")
#: 2025-11-24, in us since 1970.
_WALL_US = 1_764_000_000_000_000


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run folder of 2 m, with the scenario's file beside it."""
    place = tmp_path_factory.mktemp("run")
    (place / "short.toml").write_text(RUN_2M_TOML)
    return library.run(place / "short.toml", out=place / "run").folder


@pytest.fixture(scope="module")
def lines(run: Path) -> list[_Line]:
    """Stamp in us, and the rest of each line."""
    found = [_STAMP.fullmatch(line) for line in (run / "frames.log").read_text().splitlines(keepends=True)]
    return [(int(one[1]) * 10**6 + int(one[2]), one[3]) for one in found if one is not None]


def _written(path: Path, lines: Sequence[_Line]) -> Path:
    path.write_text("".join(f"({us // 10**6}.{us % 10**6:06d}) {rest}" for us, rest in lines))
    return path


_OTHER_STAMPS: dict[str, Callable[[list[_Line]], list[_Line]]] = {
    "a tenth": lambda lines: [(us // 10, rest) for us, rest in lines],
    "wall clock": lambda lines: [(_WALL_US + 41 * n, rest) for n, (_, rest) in enumerate(lines)],
    "since the first frame": lambda lines: [
        (41 * n, rest.replace("mvb0", "can0")) for n, (_, rest) in enumerate(lines)
    ],
}


@pytest.mark.parametrize("name", _OTHER_STAMPS)
def test_other_stamps_give_the_same_score(run: Path, lines: list[_Line], tmp_path: Path, name: str) -> None:
    log = _written(tmp_path / "seen.log", _OTHER_STAMPS[name](lines))
    wanted, found = checked_record(str(run), None), checked_record(str(log), str(run.parent / "short.toml"))
    assert found.score.as_json() == wanted.score.as_json()
    assert [*found.frames()] == [*wanted.frames()]
    (note,) = found.notes
    assert note.startswith("the stamps of seen.log are not the times of the run")
    assert not wanted.notes


def test_an_exported_blf_with_absolute_times_is_the_certified_record(here: Railhil, run: Path) -> None:
    done = here("export", run, "--blf", "--start", "2026-11-22T18:42:55Z")
    assert done.exit_code == 0, done.err
    found = checked_record(str(run / "run.blf"), None)
    assert found.certificate
    assert found.score.as_json() == checked_record(str(run), None).score.as_json()
    assert "the stamps of run.blf" in found.notes[0]


@pytest.mark.slow
def test_frames_around_the_run_are_left_out_by_every_reader(
    here: Railhil, run: Path, lines: list[_Line], tmp_path: Path
) -> None:
    """Of the search for nodes, and of others; a run of which the log has not the beginning."""
    scan = log_line(0, master_frame(F_DEVICE_STATUS, 1)).split(" ", 1)[1]
    before = [(0, scan), (0, "mvb0 123#00 R\n")]
    log = _written(tmp_path / "seen.log", [*before, *lines, *lines])
    with pytest.raises(InputError, match=rf"line {len(lines) + 3}: 0.000000 s"):
        checked_record(str(log), str(run.parent / "short.toml"))
    end_us = lines[-1][0]
    after = [(end_us, rest) for _, rest in before]
    _written(log, [*before, *lines, *after])
    record = checked_record(str(log), str(run.parent / "short.toml"))
    assert record.notes == ("seen.log: 1 frame before the run and 2 after it are left out",)
    other = [(us, rest) for us, rest in lines if us >= 1_300_000]
    last_us = other[-1][0]
    _written(log, [*other, (last_us, scan), *((last_us + us, rest) for us, rest in lines)])
    record = checked_record(str(log), str(run.parent / "short.toml"))
    assert record.score.as_json() == checked_record(str(run), None).score.as_json()
    assert record.notes[-1] == f"seen.log: {len(other)} frames before the run and 0 after it are left out"
    for node in ("plant", "controller"):
        done = here("replay", log, "--node", node, "--scenario", run.parent / "short.toml", "--json")
        assert done.exit_code == 0, done.err
        assert done.json["notes"] == list(record.notes)


def test_parts_in_the_wrong_order_are_refused(run: Path, lines: list[_Line], tmp_path: Path) -> None:
    """By their stamps, or by TIME_SYNC where the stamps have been made to fit."""
    scenario = str(run.parent / "short.toml")
    half = len(lines) // 2
    swapped = [*lines[half:], *lines[:half]]
    log = _written(tmp_path / "seen.log", swapped)
    with pytest.raises(InputError, match=rf"seen.log: line {len(lines) - half + 1}: 0.000000 s, expected"):
        checked_record(str(log), scenario)
    part = len(lines) // 4
    moved = [*lines[:part], *lines[2 * part : 3 * part], *lines[part : 2 * part], *lines[3 * part :]]
    _written(log, [(us, rest) for (us, _), (_, rest) in zip(lines, moved, strict=True)])
    with pytest.raises(InputError, match=r"seen.log: line \d+: TIME_SYNC \d+.\d\d s, expected \d+.\d\d s or later"):
        checked_record(str(log), scenario)


def test_halves_whose_stamps_were_made_to_fit_are_no_whole_run(run: Path, lines: list[_Line], tmp_path: Path) -> None:
    half = len(lines) // 2
    swapped = [*lines[half:], *lines[:half]]
    log = _written(tmp_path / "seen.log", [(us, rest) for (us, _), (_, rest) in zip(lines, swapped, strict=True)])
    # The plant tells its identity again during a run: that is no beginning.
    with pytest.raises(InputError, match=r"seen.log: line \d+: TRN_SPEED and no PLT_IDENT before it"):
        checked_record(str(log), str(run.parent / "short.toml"))


@pytest.mark.parametrize("parts", [1, 3])
def test_a_log_without_the_first_ident_names_it(run: Path, lines: list[_Line], tmp_path: Path, parts: int) -> None:
    """The first is part of the handshake, before all ticks; it is repeated after 1.28 s."""
    first = wire_contract().port("PLT_IDENT")
    ids = [f" {can_id:03X}#" for can_id in first.can_ids][:parts]
    begun = next(index for index, (us, _) in enumerate(lines) if us > 0)
    kept = [one for n, one in enumerate(lines) if n >= begun or not any(text in one[1] for text in ids)]
    assert len(kept) == len(lines) - parts
    log = _written(tmp_path / "seen.log", kept)
    with pytest.raises(InputError, match=r"seen.log: line \d+: TRN_SPEED and no PLT_IDENT before it"):
        checked_record(str(log), str(run.parent / "short.toml"))


def test_a_second_run_is_refused_with_the_line_at_which_it_begins(
    here: Railhil, run: Path, lines: list[_Line], tmp_path: Path
) -> None:
    """A verdict on one of them would be taken for that of the log."""
    end_us = lines[-1][0]
    log = _written(tmp_path / "seen.log", [*lines, *((end_us + us, rest) for us, rest in lines)])
    done = here("score", log, "--scenario", run.parent / "short.toml")
    assert done.exit_code == 2
    assert f"seen.log: line {len(lines) + 1}: the beginning of a second run" in done.one_line()


def test_a_log_of_two_buses_is_refused(run: Path, lines: list[_Line], tmp_path: Path) -> None:
    other = [(us, rest.replace("mvb0", "can1") if n == 1000 else rest) for n, (us, rest) in enumerate(lines)]
    log = _written(tmp_path / "seen.log", other)
    with pytest.raises(InputError, match=r"line 1001: channel: found 'can1', allowed mvb0, as in the first line"):
        checked_record(str(log), str(run.parent / "short.toml"))


@pytest.mark.long_after(2)
@pytest.mark.parametrize(
    "fault",
    [
        "",
        "TRN_SPEED loss 30% @0s",
        "TRN_SPEED loss 100% @1s for 1s",
        "TIME_SYNC loss 100% @0s",
        "TRN_SPEED duplicate @1s for 1s",
        "NOTCH_CMD delay 20ms jitter 20ms @1s",
        "controller kill @2s",
    ],
)
def test_a_record_of_our_own_has_its_own_time(tmp_path: Path, fault: str) -> None:
    """Also where faults touch what the nodes count their time by."""
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    faults = [fault] if fault else []
    log = library.run(tmp_path / "short.toml", faults=faults, out=tmp_path / "run").folder / "frames.log"
    found = own_time(log, load(tmp_path / "short.toml", faults=faults), wire_contract())
    assert found.frames == list(read_log(log))
    assert (found.notes, found.sha256) == ((), sha256_of(log))
