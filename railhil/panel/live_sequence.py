"""Runs of a law that learns: its errors and its memory by the number of the run. A sequence that is being recorded is
read again when another run has ended."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.judge.judging import judging_of
from railhil.judge.sequence_measure import sequence_measures
from railhil.record.documents import read_certificate, read_score
from railhil.scenarios.memory import MEMORY_AFTER, BadRecord, read_record
from railhil.scenarios.model import AnyScenario

#: File that ``railhil sequence run`` writes beside its run folders, and the names of these.
SEQUENCE, _RUNS = "sequence.json", "run[0-9]*"


def find_run_folders(texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """The run folders of a command line: the folders whose curves are shown, and all of them.

    A recorded sequence shows the curves of its first and its last run.

    :raises InputError: a sequence has no finished run.
    """
    shown: list[str] = []
    every: list[str] = []
    for text in texts:
        folder = Path(text)
        if not (folder / SEQUENCE).is_file():
            shown.append(text)
            every.append(text)
            continue
        # A run that was interrupted has no certificate yet.
        runs = sorted(str(one) for one in folder.glob(_RUNS) if read_certificate(one) is not None)
        if not runs:
            raise InputError(folder, "", Words("a sequence without a finished run"), "one finished run or more")
        shown += dict.fromkeys((runs[0], runs[-1]))
        every += runs
    return shown, every


def make_learning_charts(scenario: AnyScenario, folders: Sequence[str]) -> list[dict[str, Any]]:
    """Charts over the number of the run: the system's measures of a sequence, and each number in the memory.

    ``data`` of a chart: numbers of the runs, then a list for each of its ``series``, None where there is no value.

    :returns: empty unless the folders are runs of one law with a memory, each with a number of its own.
    :raises InputError: a file is damaged.
    """
    runs: dict[int, tuple[Mapping[str, float | None], dict[str, float]]] = {}
    laws = set()
    for folder in map(Path, folders):
        certificate, score = read_certificate(folder), read_score(folder)
        if certificate is None or score is None or not (folder / MEMORY_AFTER).is_file():
            continue
        laws.add(certificate["controller"])
        number = int(certificate.get("run_number") or 0)
        if number in runs:
            return []
        try:
            record = read_record(folder / MEMORY_AFTER)
        except BadRecord as bad:
            raise bad.error from None
        runs[number] = {**score["scores"], **score["signed"]}, dict(_find_numbers(record.values))
    if len(runs) < 2 or len(laws) > 1:
        return []
    numbers = sorted(runs)
    charts = []
    for measure in sequence_measures(scenario, judging_of(scenario)):
        criterion, limit = measure.criterion, measure.converged
        errors = [runs[number][0].get(criterion.signed or criterion.key) for number in numbers]
        lines = [("limit", limit), *([("-limit", -limit)] if criterion.signed else [])]
        charts.append(
            {
                "title": f"{criterion.title} by run",
                "unit": criterion.unit,
                "series": [criterion.title, *(name for name, _ in lines)],
                "data": [numbers, errors, *([value] * len(numbers) for _, value in lines)],
            }
        )
    for name in dict.fromkeys(name for number in numbers for name in runs[number][1]):
        kept = [runs[number][1].get(name) for number in numbers]
        charts.append({"title": f"memory: {name}", "unit": "", "series": [name], "data": [numbers, kept]})
    return charts


def _find_numbers(values: Any, name: str = "") -> Iterator[tuple[str, float]]:
    """The numbers with a decimal point in a memory, without counters, keys and histories, by their place."""
    if isinstance(values, Mapping):
        for key, value in values.items():
            yield from _find_numbers(value, f"{name} {key}".strip())
    elif isinstance(values, list) and all(isinstance(one, Mapping) for one in values):
        for place, one in enumerate(values, start=1):
            yield from _find_numbers(one, name if len(values) == 1 else f"{name} {place}")
    elif isinstance(values, float):
        yield name, values


#: Wall time between two readings of a folder.
_LOOK_S = 0.5


class LiveSequence:
    """The sequences among some folders; a complete one does not change any more, and checking it costs one stat.

    :param folders: as given by the user.
    """

    def __init__(self, scenario: AnyScenario, folders: Sequence[str]) -> None:
        self._scenario = scenario
        self._folders = list(folders)
        self._files = [path for folder in folders if (path := Path(folder) / SEQUENCE).is_file()]
        self._stamps = self._read_stamps()
        self._look_s = time.monotonic()

    def look(self) -> list[dict[str, Any]] | None:
        """The charts of :func:`make_learning_charts`, if another run has ended since the last reading; else None."""
        now_s = time.monotonic()
        if not self._files or now_s - self._look_s < _LOOK_S:
            return None
        self._look_s = now_s
        stamps = self._read_stamps()
        if stamps == self._stamps:
            return None
        try:
            charts = make_learning_charts(self._scenario, find_run_folders(self._folders)[1])
        except InputError:
            # The next run is being written: at the next reading it is complete, or has not begun.
            return None
        self._stamps = stamps
        return charts

    def _read_stamps(self) -> list[int]:
        # ``railhil sequence run`` writes it anew after each run, when the folder of the run is complete.
        return [path.stat().st_mtime_ns if path.exists() else 0 for path in self._files]
