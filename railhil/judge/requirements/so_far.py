"""What a run in progress makes of its requirements: the outcomes on the frames so far."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from railhil.judge.requirements import syntax
from railhil.judge.requirements.outcome import Outcome, judge_frames
from railhil.judge.requirements.parser import parse_sentence
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.sentence import OPEN

if TYPE_CHECKING:
    from railhil.judge.record import Record

#: Events that the certificate tells: no frame does.
_CERTIFIED = frozenset({"fault", "fault_end"})
_NAME = re.compile(r"[a-z_][a-z0-9_]*")


def judge_so_far(record: Record, requirements: Sequence[Requirement], *, ended: bool = False) -> tuple[Outcome, ...]:
    """As :func:`railhil.judge.requirements.outcome.judge_requirements`; open is also what only the end of the run
    decides, and what depends on its injected faults, of which the certificate tells.

    :param record: the frames so far, without a certificate.
    :param ended: they are the whole run.
    :raises InputError: a sentence does not fit the scenario.
    """
    found = judge_frames(record, requirements)
    return tuple(_decided(one, by, ended) for one, by in zip(found, requirements, strict=True))


def _decided(found: Outcome, requirement: Requirement, ended: bool) -> Outcome:
    if _names(requirement) & _CERTIFIED:
        return Outcome(found.id, found.says, OPEN, title=found.title)
    body = parse_sentence(requirement.says).body
    is_at_end = isinstance(body, syntax.At) and isinstance(body.event, syntax.Limit)
    may_come = isinstance(body, syntax.Eventually) and body.within is None and found.violated
    return replace(found, verdict=OPEN) if not ended and (is_at_end or may_come) else found


def _names(requirement: Requirement) -> set[str]:
    """The words of a sentence, and of the definitions that it uses."""
    define, found, texts = dict(requirement.define), set[str](), [requirement.says]
    while texts:
        for name in set(_NAME.findall(texts.pop())) - found:
            found.add(name)
            texts += [define[name]] if name in define else []
    return found
