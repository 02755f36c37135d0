"""Runs a study from its plan to its summary, using the parts that already exist."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import monotonic, process_time
from typing import Any, overload

import pyarrow as pa
from rich.console import Console

from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.common.exit_codes import TOOL_ERROR, exit_code_of
from railhil.common.output import show_progress
from railhil.study.claim import InUse
from railhil.study.engines import Engine
from railhil.study.parts import PartsFolder, opened
from railhil.study.plan import C, P, Shard, Study
from railhil.study.table import NotThePart
from railhil.study.work import Task, run_task, task_of

#: Time for which a shard waits for the folder: others that begin or end lock it for a moment.
_OTHERS_S = 10.0


class Stopped(Exception):
    """A study that could not be finished: the reason, the parts kept, the command that resumes it."""

    def __init__(self, text: str, exit_code: int) -> None:
        super().__init__(text)
        self.exit_code = exit_code


@dataclass(frozen=True, slots=True)
class Outcome:
    """Outcome of a study: its folder, the rows of ``results.parquet`` and the content of ``summary.json``; of a shard
    no rows and no summary while parts of other shards are missing."""

    folder: Path
    table: pa.Table | None
    summary: dict[str, Any]

    @property
    def is_whole(self) -> bool:
        """Whether all parts were there, so that they could be joined."""
        return self.table is not None


def execute(
    study: Study[P, C],
    plan: P,
    out: str | None,
    console: Console,
    engine: Engine,
    say: Callable[[str], None],
    shard: Shard | None = None,
    time_s: float | None = None,
) -> Outcome:
    """Make the missing parts, then join and summarise them.

    :param out: the folder; None creates a new one.
    :param console: for progress (standard error).
    :param say: for remarks.
    :param shard: make only its parts; the process that finds all parts there joins them.
    :param time_s: wall time after which no further part is waited for; the study is then cut to the parts that are
        there without a gap, at least one. None: all parts are made.
    :raises InputError: the folder cannot be used, or a law has failed.
    :raises Stopped: workers or parts were lost, or the record can no longer be written.
    """
    wait_s = 0.0
    if shard is not None:
        wait_s = _OTHERS_S
        with opened(study, plan, out, shard, wait_s) as folder:
            with _kept(study, folder, say, f" --shard {shard}"):
                _make_parts(study, plan, folder, console, engine, say)
            if not folder.is_whole():
                return Outcome(folder.path, None, {})
    try:
        with opened(study, plan, out, wait_s=wait_s) as folder, _kept(study, folder, say):
            _make_parts(study, plan, folder, console, engine, say, time_s)
            if folder.is_whole():
                return Outcome(folder.path, *folder.write_results())
            folder.cut()
            made = Outcome(folder.path, *folder.write_results())
            folder.write_manifest()
            return made
    except InUse:
        # Another shard will join the parts.
        if shard is None:
            raise
        return Outcome(folder.path, None, {})


class _Tasks(Sequence[Task]):
    """The tasks of chunks, each made when it is given out: a study that ends by time has many more."""

    def __init__(self, study: Study[P, C], plan: P, chunks: Sequence[C]) -> None:
        self._make: Callable[[C], Task] = partial(task_of, study, plan)
        self._chunks = chunks

    def __len__(self) -> int:
        return len(self._chunks)

    @overload
    def __getitem__(self, place: int) -> Task: ...
    @overload
    def __getitem__(self, place: slice) -> Sequence[Task]: ...
    def __getitem__(self, place: int | slice) -> Task | Sequence[Task]:
        if isinstance(place, slice):
            return [*map(self._make, self._chunks[place])]
        return self._make(self._chunks[place])

    def __iter__(self) -> Iterator[Task]:
        # By its places, an IndexError of the maker would be the end of the sequence.
        return map(self._make, self._chunks)


@contextmanager
def _kept(study: Study[P, C], folder: PartsFolder[P, C], say: Callable[[str], None], words: str = "") -> Iterator[None]:
    """Add to any exception that ends the work the parts kept and the command that continues it.

    :param words: of the command that continues, after the folder.
    :raises InputError: as raised in the block.
    :raises Stopped: another exception was raised there.
    """

    def how_on() -> str:
        again = f"{study.command} --resume {folder.path}{words}"
        return f"{folder.kept():,} of {folder.total:,} {study.unit}s are kept; {again} goes on"

    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"stopped; {how_on()}") from None
    except SystemExit:
        say(f"{study.command}: stopped; {how_on()}")
        raise
    except NotThePart as why:
        raise Stopped(f"a part in {folder.path} has become {why}; {how_on()}", TOOL_ERROR) from why
    except InputError:
        raise
    except Exception as error:
        # A worker, a law or a driver may fail in any way: the message gives the reason and the parts kept.
        text = " ".join(str(error).split()) or type(error).__name__
        code = exit_code_of(error)
        kind = f"{type(error).__name__}: " if not hasattr(error, "exit_code") else ""
        raise Stopped(f"{kind}{text}; {how_on()}", code) from error


def _make_parts(
    study: Study[P, C],
    plan: P,
    folder: PartsFolder[P, C],
    console: Console,
    engine: Engine,
    say: Callable[[str], None],
    time_s: float | None = None,
) -> None:
    """Make the missing parts of a folder, with remarks on those that are there and on the time taken.

    :param time_s: as for :func:`execute`.
    """
    left, complaints = folder.missing()
    for complaint in complaints:
        say(complaint)
    total, kept = folder.total, folder.kept()
    if kept:
        say(f"{folder.path}: {kept:,} of {total:,} {study.unit}s are there already")
    tasks = _Tasks(study, plan, left)
    began_s, used_s, new = monotonic(), process_time(), 0
    with engine(run_task, tasks) as made, show_progress(console, f"{study.unit}s", total, kept) as shown:
        for place, (name, content) in made:
            folder.write_part(name, content)
            new += left[place].runs
            shown(kept + new, f"{study.unit}s, {new / (monotonic() - began_s):,.3g}/s")
            if time_s is not None and monotonic() - began_s >= time_s and folder.leading():
                break
    if new:
        wall_s, cpu_s = monotonic() - began_s, process_time() - used_s
        said = count_of(new, study.unit, spec=",")
        say(f"{said} in {wall_s:.1f} s; this process used {cpu_s:.1f} s of processor time for them")
