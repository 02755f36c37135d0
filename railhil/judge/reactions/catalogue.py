"""Entries of a fault catalogue: ``catalogue.toml`` here for the system ``ato``, a file of its own for another.

An operator may inject its faults by hand: ``railhil run --catalogue``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from railhil.common.errors import InputError
from railhil.faults.language import fault_text, parse, sameness
from railhil.faults.model import WATCH_LEVELS, Fault, Trigger
from railhil.judge.reactions.shown import EVENT, STATE, is_sign
from railhil.scenarios.fault_list import fault_texts
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.schema import Table, Text
from railhil.scenarios.system import System
from railhil.scenarios.tomlfile import parse_toml
from railhil.scenarios.validation import validate

CATALOGUE = Path(__file__).parent / "catalogue.toml"
#: In ``detected``: no watch detects the fault.
NOTHING = "nothing"
#: The states at the end of a run that an entry may demand, in words.
ENDS = {"resumes": "the run goes on", "standstill": "the train stands", "lost": "the train stands, controller lost"}
#: A milestone, an interlock or a state on the wire.
Sign = Annotated[str, Field(pattern=f"^({EVENT.pattern}|{STATE.pattern})$")]
Level = Literal["NORMAL", "HOLD", "TRACTION CUT", "SERVICE BRAKE", "EMERGENCY"]


class Entry(Table):
    """One entry: a level, a cause, a time, and the forbidden reactions.

    ``faults``: in the fault language. ``law``: the law of the run, empty: the requested one. ``detected``: one of these
    must show: a cause of a watch, ``refused:CAUSE``, ``missed_polls``, or a sign (a milestone, an interlock or a state
    on the wire, :mod:`railhil.judge.reactions.shown`); ``nothing``: no watch detects the fault, and ``limit`` gives the
    reason. ``reaction``: the weakest level that a watch must reach, ``within_ms`` from the first effect, NORMAL: none
    is needed; ``steps``: levels before it, each with its own time in ms. ``at_most``: the strongest allowed; for
    EMERGENCY, ``ends`` excludes further consequences. ``ends``: ``resumes`` (both watches at NORMAL again, the train
    stops as planned), ``standstill`` (the train stands at the end), ``lost`` (it does, and the controller is lost).
    ``verdict``: the run's, where one is expected; for a run that is not judged (INVALID, TOOL ERROR), ``said`` is part
    of its line, and nothing else is demanded. ``shows``: signs that the run must show, each with its own time in ms
    from the first effect; ``never``: signs that it must not show from there on, each for its own time in ms. ``limit``:
    the undetected part, in words. ``idle``: reason for which the fault may change nothing, for a scenario without its
    target. ``seen_in``: the test of an entry that is no fault of one run.
    """

    id: Annotated[str, Field(pattern=r"^[A-Z][0-9]+[a-z]?$")]
    title: Text
    faults: Annotated[tuple[Text, ...], Field(strict=False)] = ()
    law: str = ""
    detected: Annotated[tuple[Text, ...], Field(strict=False)] = ()
    reaction: Level | None = None
    steps: dict[Level, Annotated[int, Field(gt=0)]] = Field(default_factory=dict)
    at_most: Level | None = None
    within_ms: Annotated[int, Field(gt=0)] | None = None
    shows: dict[Sign, Annotated[int, Field(gt=0)]] = Field(default_factory=dict)
    never: dict[Sign, Annotated[int, Field(gt=0)]] = Field(default_factory=dict)
    ends: Literal["resumes", "standstill", "lost", ""] = ""
    verdict: Literal["PASS", "FAIL", "INVALID", "TOOL ERROR", ""] = ""
    said: str = ""
    limit: Annotated[str, Field(max_length=300)] = ""
    idle: Annotated[str, Field(max_length=300)] = ""
    seen_in: Annotated[str, Field(max_length=300)] = ""

    @model_validator(mode="after")
    def _one_kind(self) -> Entry:
        if bool(self.faults) is bool(self.seen_in):
            raise ValueError(f"{self.id}: either faults or seen_in")
        if wrong := self._lacks() if self.faults else "":
            raise ValueError(f"{self.id}: {wrong}")
        return self

    @property
    def signs(self) -> tuple[str, ...]:
        """All signs that it names."""
        return tuple(sign for sign in (*self.detected, *self.shows, *self.never) if is_sign(sign))

    @property
    def demand(self) -> str:
        """What it demands of a run, in words."""
        if not self.is_judged:
            return f"{self.verdict}: {self.said}"
        bounds_ms: list[tuple[str | None, int | None]] = [*self.steps.items(), (self.reaction, self.within_ms)]
        words = [f"{sign} within {bound_ms} ms" for sign, bound_ms in (*bounds_ms, *self.shows.items()) if bound_ms]
        words += [f"for {for_ms} ms no {sign}" for sign, for_ms in self.never.items()]
        if self.at_most == "NORMAL":
            words.append("no reaction")
        elif self.at_most != self.reaction:
            words.append(f"at most {self.at_most}")
        words += [ENDS[self.ends]] if self.ends else []
        return "; ".join(words + ([f"verdict of the run {self.verdict}"] if self.verdict else []))

    @property
    def is_judged(self) -> bool:
        """Whether the run has a verdict on the train, so that levels, causes and times are checked."""
        return self.verdict not in ("INVALID", "TOOL ERROR")

    @property
    def is_undetected(self) -> bool:
        """Whether no watch detects the fault."""
        return self.detected == (NOTHING,)

    def _lacks(self) -> str:
        """The missing demand of an entry with faults; empty: none is missing."""
        if not self.is_judged:
            return "" if self.said else f"said: part of the line of a run that is {self.verdict}"
        if self.reaction is None:
            return "reaction: the weakest level that must be reached, or NORMAL"
        if not self.detected:
            return f"detected: the causes that may show, or {NOTHING}"
        if self.is_undetected and (self.reaction != "NORMAL" or not self.limit):
            return f"detected {NOTHING}: only with reaction NORMAL, and limit says why"
        if (self.within_ms is None) is not (self.reaction == "NORMAL"):
            return "within_ms: the time of a reaction, and none of NORMAL"
        if self.at_most is None:
            return "at_most: the level that must not be exceeded"
        if self.at_most == "EMERGENCY" and self.ends not in ("standstill", "lost"):
            return "ends: standstill or lost, where the emergency brake is allowed"
        ranks = [WATCH_LEVELS.index(level) for level in (*self.steps, self.reaction)]
        if ranks != sorted(set(ranks)) or ranks[-1] > WATCH_LEVELS.index(self.at_most):
            return "steps, reaction and at_most: in the order of the ladder"
        return ""


class _File(Table):
    entry: list[Entry]


@cache
def catalogue(file: Path = CATALOGUE) -> tuple[Entry, ...]:
    """All entries, in the order of the file.

    :raises InputError: the file is damaged.
    """
    table = parse_toml(file.read_text(encoding="utf-8"))
    return tuple(validate(_File, table, lambda keys: file).entry)


def catalogue_of(system: System) -> tuple[Entry, ...]:
    """The catalogue of a system: its part ``catalogue`` is the path of a file; without it the catalogue of ``ato``.

    :raises InputError: as :func:`catalogue`.
    """
    return catalogue(system.optional_part("catalogue") or CATALOGUE)


#: Levels that change nothing before they are injected: others change the waits of the run, or the start of the hub.
_LEVELS = ("train", "sensor", "actuator", "command", "telegram")


def faults_by_hand(scenario: AnyScenario) -> tuple[str, ...]:
    """The faults of the catalogue of the scenario's system, as texts ``@manual combine id ENTRY``; each fault once.

    They have no duration: the operator chooses it. Places with faults of the scenario are left out, and faults that
    this system cannot inject (a train of one unit has no second one).

    :raises InputError: the catalogue is damaged.
    """
    system = scenario.installed_system
    taken = {parse(text).place for text in scenario.faults}
    texts: dict[tuple[object, ...], str] = {}
    for fault in _catalogued(system):
        if fault.place.level in _LEVELS and fault.place not in taken and _fits(fault, system):
            texts.setdefault(sameness(fault), fault_text(fault))
    return tuple(texts.values())


def _fits(fault: Fault, system: System) -> bool:
    try:
        fault_texts((fault_text(fault),), system, lambda row: Path())
    except InputError:
        return False
    return True


def _catalogued(system: System) -> Iterator[Fault]:
    by_hand = Trigger("manual")
    for entry in catalogue_of(system):
        for text in entry.faults:
            yield replace(
                parse(text), trigger=by_hand, duration_s=None, until="", expect=None, combine=True, id=entry.id
            )
