"""The requirements of a run as rows of the page: of a run in progress judged on its frames so far."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Mapping, Sequence
from itertools import dropwhile
from pathlib import Path
from typing import Any

from railhil.bus.frame import Frame
from railhil.common.errors import InputError
from railhil.dbc import house_contract
from railhil.judge.record import Record
from railhil.judge.requirements.outcome import NOT_JUDGED, Outcome
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.sentence import OPEN
from railhil.judge.requirements.so_far import judge_so_far
from railhil.record.framelog import LOG_NAME
from railhil.record.own_time import RunClock, is_search
from railhil.record.trace import TraceReader
from railhil.scenarios.model import AnyScenario

#: Least wall time between two judgements, and between them as a multiple of the time that one takes (chosen).
JUDGE_S, _REST = 0.5, 20
#: First frames of a run that are kept, until its scenario and its law are known.
_EARLY_FRAMES = 4096
_LOST = "frames of this run were lost here: its sentences are judged in its record"
_NOT_HEARD = "the beginning of this run was not heard: its sentences are judged in its record"


def describe_outcomes(runs: Iterable[tuple[str, Sequence[Outcome]]], said: str = "", so_far: bool = False) -> str:
    """A message with a row for each outcome.

    :param runs: name of each run (empty: the only one), and its outcomes.
    :param said: remark on all of them.
    :param so_far: the run goes on.
    """
    rows = [
        {
            "id": f"{run} {one.id}".strip(),
            "says": one.says,
            "title": one.title,
            "verdict": one.verdict,
            "margin": "" if one.margin is None else f"{one.margin:.4g} {one.unit}".rstrip(),
            "instant_s": one.instant_s,
            "met": one.antecedent_met,
        }
        for run, outcomes in runs
        for one in outcomes
    ]
    return json.dumps({"requirements": {"rows": rows, "said": said, "so_far": so_far}})


class LiveRequirements:
    """Judges the run on a bus by sentences, a few times a second at most.

    All its frames are kept as telegrams (about 1 MB for 100 s): a sentence is about the whole run.
    """

    def __init__(self, requirements: Sequence[Requirement]) -> None:
        self._requirements = requirements
        self._house = house_contract()
        #: Identifiers of the search for nodes before a run.
        self._searching = {self._house.poll_id, self._house.device_status_id}
        self._scenario: AnyScenario | None = None
        self._notes: Sequence[Mapping[str, Any]] | None = None
        self._due_s = 0.0
        self._restart()

    def _restart(self) -> None:
        """Another run may begin."""
        self._early: list[Frame] = []
        self._count = 0
        self._is_heard = False
        self._said = ""
        self._begin()

    def _begin(self) -> None:
        scenario = self._scenario
        self._is_new = True
        self._clock = None if scenario is None else RunClock(scenario, scenario.installed_system.contract)
        self._reader = None if scenario is None else TraceReader(scenario.installed_system.contract)

    def show(self, scenario: AnyScenario | None, notes: Sequence[Mapping[str, Any]] | None) -> None:
        """Judge by this scenario from now on; None: the run is not known.

        :param notes: the law's declaration of its notes; None: not known.
        """
        self._scenario, self._notes = scenario, notes
        self._begin()
        if self._count > len(self._early):
            self._said = _NOT_HEARD
        self._read(self._early)

    def take(self, frames: Sequence[Frame], is_lacking: bool = False) -> None:
        """Take frames in bus order.

        :param is_lacking: some were lost before or among them.
        """
        if is_lacking:
            self._said, self._is_new = _LOST, True
        begin = 0
        for place, frame in enumerate(frames):
            if is_search(frame, self._house):
                self._add(frames[begin:place])
                begin = place
                if self._is_heard or self._said:
                    self._restart()
        self._add(frames[begin:])

    def _add(self, frames: Sequence[Frame]) -> None:
        if not self._is_heard:
            # The search for nodes says nothing of a run.
            frames = list(dropwhile(lambda frame: frame.can_id in self._searching, frames))
            if not frames:
                return
            self._is_heard = self._is_new = True
        self._count += len(frames)
        self._early += frames[: _EARLY_FRAMES - len(self._early)]
        self._read(frames)

    def _read(self, frames: Iterable[Frame]) -> None:
        if self._clock is not None and self._reader is not None and not self._said:
            timed = [one for frame in frames if (one := self._clock.take(frame)) is not None]
            if timed:
                self._reader.take(timed)
                self._is_new = True

    def look(self) -> str:
        """The rows, if they may have changed and are due; else empty."""
        begun_s = time.monotonic()
        is_over = self._clock is not None and self._clock.has_ended
        # A page beside a run goes soon after its end.
        if not self._is_new or (begun_s < self._due_s and not is_over):
            return ""
        self._is_new = False
        message = self.describe()
        now_s = time.monotonic()
        self._due_s = now_s + max(JUDGE_S, _REST * (now_s - begun_s))
        return message

    def describe(self) -> str:
        """The rows now."""
        if self._said or self._scenario is None or self._clock is None or self._reader is None:
            return self._undecided(self._said)
        if not self._clock.has_begun:
            return self._undecided(_NOT_HEARD if self._is_heard else "")
        record = Record(Path(LOG_NAME), self._scenario, self._reader.trace, certificate={"notes": self._notes})
        try:
            found = judge_so_far(record, self._requirements, ended=self._clock.has_ended)
        except InputError as error:
            return self._undecided(str(error))
        return describe_outcomes([("", found)], so_far=not self._clock.has_ended)

    def _undecided(self, why: str) -> str:
        """Rows without outcomes.

        :param why: reason why none will come; empty: the run is awaited.
        """
        verdict = NOT_JUDGED if why else OPEN
        rows = [Outcome(one.id, one.says, verdict, title=one.title) for one in self._requirements]
        return describe_outcomes([("", rows)], why, so_far=True)
