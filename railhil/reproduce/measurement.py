"""Makes and measures the entries of a paper's protocol, each in one process without a bus, several at a time."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from railhil.common.errors import InputError
from railhil.common.held_code import OURS, held_sha256
from railhil.common.user_files import given_json, whole_file
from railhil.record.run_folder import remove_torn_run
from railhil.reproduce.paper import Entry, Measurement, Paper, Results
from railhil.study.engines import in_order, processes, until_stopped


def measure_paper(
    paper: Paper,
    seeds: Sequence[int],
    *,
    jobs: int = 1,
    kept: Path | None = None,
    measured: Path | None = None,
    only: str | None = None,
    drawn: bool = False,
    say: Callable[[str], None] = lambda sentence: None,
) -> Results:
    """Make all runs of a paper.

    :param jobs: processes at a time; the result does not depend on it.
    :param kept: folder in which the run folders stay, each under the key of its run; what is there of such a
        run, as from a worker that died, is removed. None: none stays.
    :param measured: folder of the figures of each run; runs whose figures are there are not made again, except those
        that are drawn. None: all are made.
    :param only: pattern (:mod:`fnmatch`) of the names of the runs to make; of the other runs, the result has only those
        with stored figures. None: all.
    :param drawn: also keep the curves of the runs that a figure shows.
    :param say: called after each run.
    :raises InputError: a run cannot be made.
    :raises NeverBegan: the nodes refused a run.
    """
    stored = set() if measured is None else {path.stem for path in measured.glob("*.json")}
    entries = [one for one in paper.plan(seeds) if only is None or fnmatchcase(one.key, only) or one.key in stored]
    found: dict[str, Measurement] = {}
    # Made here: a process that is ended removes no folder.
    with TemporaryDirectory(prefix="railhil-reproduce-") as private:
        work = _Work(paper, kept, Path(private), measured, drawn, only)
        with until_stopped() as stop, processes(jobs, say)(work.measure, entries) as made:
            for one in in_order(made):
                found[one.key] = one
                say(f"{len(found)} of {len(entries)}: {one.key} {one.verdict}")
        if stop.error is not None:
            say(stop.after(len(found), len(entries)))
            raise stop.error
    return Results(tuple(seeds), found)


@dataclass(frozen=True, slots=True)
class _Work:
    """The work on each entry, perhaps in a process of its own; see :func:`measure_paper`."""

    paper: Paper
    kept: Path | None
    private: Path
    measured: Path | None
    drawn: bool
    only: str | None

    def measure(self, entry: Entry) -> Measurement:
        is_drawn = self.drawn and entry.drawn and (self.only is None or fnmatchcase(entry.key, self.only))
        file = None if self.measured is None else self.measured / f"{entry.key}.json"
        if file is not None and not is_drawn and file.is_file():
            return _read(file, entry)
        with ExitStack() as held:
            place = self.kept or Path(held.enter_context(TemporaryDirectory(dir=self.private)))
            remove_torn_run(place / entry.key)
            made = entry.experiment.make(entry.spec, place / entry.key)
            found = Measurement(
                key=entry.key,
                verdict=made.verdict,
                reasons=made.reasons,
                sha256=made.frames_sha256,
                values=dict(self.paper.measure(made)),
                curves=self.paper.curves(made) if is_drawn and self.paper.curves is not None else None,
            )
        if file is not None:
            with whole_file(file) as draft:
                draft.write_text(json.dumps(_identity(entry) | found.as_json()) + "\n", encoding="utf-8", newline="\n")
        return found


def _identity(entry: Entry) -> dict[str, Any]:
    return {"entry": entry.identity, "code_sha256": held_sha256(OURS)}


def _read(file: Path, entry: Entry) -> Measurement:
    """The stored figures of a run.

    :raises InputError: they are from another run, or from other code.
    """
    found = given_json(file, "figures of a run, as --measured writes them")
    for key, allowed in _identity(entry).items():
        if found.get(key) != allowed:
            raise InputError(file, key, str(found.get(key)), f"{allowed}, or no such file: the run is then made")
    return Measurement.from_json(entry.key, found)
