"""Entries of a fault catalogue: ``catalogue.toml`` here for the system ``ato``, a file of its own for another."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from railhil.scenarios.schema import Table, Text
from railhil.scenarios.system import System
from railhil.scenarios.tomlfile import parsed_toml
from railhil.scenarios.validation import validated

CATALOGUE = Path(__file__).parent / "catalogue.toml"
Level = Literal["NORMAL", "HOLD", "TRACTION CUT", "SERVICE BRAKE", "EMERGENCY"]


class Entry(Table):
    """One entry.

    ``faults``: what is injected, in the fault language. ``law``: the law of the run, empty: the one asked for.
    ``detected``: one of these must show: a cause of a watch, ``refused:CAUSE`` or ``missed_polls``. ``reaction``: the
    weakest level that a watch must reach, ``within_ms`` from the first effect; ``at_most``: the strongest allowed.
    ``ends``: ``resumes`` (both watches at NORMAL again, the train stops as planned), ``standstill`` (the train stands
    at the end), ``lost`` (it does, and the controller is lost). ``verdict``: the run's, where one is expected.
    ``limit``: what is not detected, in words. ``seen_in``: where an entry is tested that is no fault of one run.
    """

    id: Annotated[str, Field(pattern=r"^[A-Z][0-9]+[a-z]?$")]
    title: Text
    faults: Annotated[tuple[Text, ...], Field(strict=False)] = ()
    law: str = ""
    detected: Annotated[tuple[Text, ...], Field(strict=False)] = ()
    reaction: Level | None = None
    at_most: Level = "EMERGENCY"
    within_ms: Annotated[int, Field(gt=0)] | None = None
    ends: Literal["resumes", "standstill", "lost", ""] = ""
    verdict: Literal["PASS", "FAIL", "INVALID", "TOOL ERROR", ""] = ""
    limit: Annotated[str, Field(max_length=300)] = ""
    seen_in: Annotated[str, Field(max_length=300)] = ""

    @model_validator(mode="after")
    def _one_kind(self) -> Entry:
        if bool(self.faults) is bool(self.seen_in):
            raise ValueError(f"{self.id}: either faults or seen_in")
        return self


class _File(Table):
    entry: list[Entry]


@cache
def catalogue(file: Path = CATALOGUE) -> tuple[Entry, ...]:
    """All entries, in the order of the file.

    :raises InputError: the file is damaged.
    """
    table = parsed_toml(file.read_text(encoding="utf-8"))
    return tuple(validated(_File, table, lambda keys: file).entry)


def catalogue_of(system: System) -> tuple[Entry, ...]:
    """The catalogue of a system: its part ``catalogue`` is the path of a file; without it that of ``ato``.

    :raises InputError: as :func:`catalogue`.
    """
    return catalogue(system.part("catalogue")) if "catalogue" in system.own else catalogue()
