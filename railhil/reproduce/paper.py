"""A paper for ``railhil reproduce``: runs to be made, and the figures from them beside the published ones.

A paper is one record (:class:`Paper`) in a package of its own. All its parts are pure functions of the measured runs,
so that the same seeds give the same bytes.
"""

from __future__ import annotations

import shlex
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from importlib.resources import files
from statistics import fmean, median
from typing import Any

from railhil.charts.figure import Figure
from railhil.common.version import full_version
from railhil.report.deviations import Deviation
from railhil.reproduce.comparison import OPEN, Line, Statement, Table, judge_parts
from railhil.reproduce.experiments import Experiment, SingleRun
from railhil.scenarios.run_spec import RunSpec

#: Name of each paper, in the order of the list, and its record, ``module:object``.
PAPERS: Mapping[str, str] = {
    "ipfc": "railhil.reproduce.ipfc:PAPER",
    "ngpc": "railhil.reproduce.ngpc:PAPER",
    "ilc": "railhil.reproduce.ilc:PAPER",
}


def find_paper(name: str, papers: Mapping[str, str] = PAPERS) -> Paper:
    """A paper by its name, which must be one of ``papers``."""
    module, _, record = papers[name].partition(":")
    found: Paper = getattr(import_module(module), record)
    return found


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of a protocol: ``key`` names it in tables, documents and folders; ``drawn``: a figure shows its curves.

    ``spec``: the run; of a set of sequences any of its runs. ``experiment``: the way in which the entry is made.
    """

    key: str
    spec: RunSpec
    drawn: bool = False
    experiment: Experiment = field(default_factory=SingleRun)

    @property
    def command(self) -> str:
        """The command that makes only this entry; empty: there is none."""
        words = self.experiment.words(self.spec)
        return shlex.join(["railhil", *words]) if words else ""

    @property
    def identity(self) -> list[str]:
        """Everything besides the code on which its figures depend: experiment, law with its parameters, run."""
        return [repr(self.experiment), self.spec.law.label, *self.spec.words]


@dataclass(frozen=True, slots=True)
class Measurement:
    """The stored results of an entry: its figures by name (None: a run did not get that far), and the curves of a drawn
    one.

    ``reasons``: the reasons why the verdict is not PASS. ``sha256``: of its log; empty if it has none.
    """

    key: str
    verdict: str
    reasons: tuple[str, ...]
    sha256: str
    values: Mapping[str, float | None]
    curves: Any = None

    @classmethod
    def from_json(cls, key: str, found: Mapping[str, Any]) -> Measurement:
        """What :meth:`as_json` has made, without curves."""
        return cls(key, found["verdict"], tuple(found["reasons"]), found["sha256"], found["measured"])

    def as_json(self) -> dict[str, Any]:
        """Verdict and figures, as files have them."""
        return {
            "verdict": self.verdict,
            "reasons": list(self.reasons),
            "sha256": self.sha256,
            "measured": dict(self.values),
        }


@dataclass(frozen=True)
class Results:
    """The measured entries of a protocol by key, and the seeds with which they were made; not all need to be there.

    :param railhil: the version that has measured them.
    """

    seeds: tuple[int, ...]
    runs: Mapping[str, Measurement]
    railhil: str = field(default_factory=full_version)

    def has(self, keys: Iterable[str]) -> bool:
        """Whether all these entries were made."""
        return all(key in self.runs for key in keys)

    def list_made(self, keys: Iterable[str]) -> list[str]:
        """The entries among these that were made."""
        return [key for key in keys if key in self.runs]

    def find(self, key: str, name: str) -> float | None:
        """A figure of one entry; None if it has no value or was not made."""
        return self.runs[key].values[name] if key in self.runs else None

    def reduce(self, keys: Iterable[str], name: str, rule: Callable[[list[float]], float] = median) -> float | None:
        """A figure over entries, by default its median; None if one of them has no value or was not made."""
        values = [self.find(key, name) for key in keys]
        known = [value for value in values if value is not None]
        return float(rule(known)) if values and len(known) == len(values) else None

    def find_spread(self, keys: Iterable[str], name: str) -> tuple[float | None, float | None, float | None]:
        """Mean, least and greatest value of a figure over the entries that were made."""
        made = self.list_made(keys)
        return self.reduce(made, name, fmean), self.reduce(made, name, min), self.reduce(made, name, max)


@dataclass(frozen=True)
class Text:
    """The text of a paper as data (``papers/NAME.toml``).

    ``protocol``: description of the runs, in sentences. ``seeds``: the seeds of the page. ``published``: printed
    values. ``bounds``: least and greatest values that railhil's specification allows, by table. ``readings``: places
    that can be read in more than one way, and the bench's reading. ``sets``: sets of runs. ``tables``: title and note
    of each table, and perhaps its entries. ``statements``: place (``at``), text (``claim``), and the reason for the
    verdict here (``why``).
    """

    title: str
    protocol: tuple[str, ...]
    seeds: tuple[int, ...]
    source: str = ""
    published: Mapping[str, Any] = field(default_factory=dict)
    bounds: Mapping[str, Sequence[Mapping[str, Any]]] = field(default_factory=dict)
    readings: tuple[Deviation, ...] = ()
    sets: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    tables: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    statements: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    def table(self, name: str, columns: Sequence[str], lines: Iterable[Line], *, with_ratio: bool = True) -> Table:
        """The table of this name, with title and note of the text."""
        text = self.tables[name]
        return Table(name, text["title"], tuple(columns), tuple(lines), text.get("note", ""), with_ratio)

    def judge(
        self,
        name: str,
        results: Results,
        needs: Iterable[str],
        measured: str,
        holds: Sequence[bool],
        *,
        is_explained: bool = True,
    ) -> Statement:
        """The statement of this name with its verdict.

        It cannot be checked unless all entries that it needs were made and can be trusted.

        :param measured: the figures, in a sentence.
        :param holds: whether each part of the claim holds; without parts it cannot be checked.
        :param is_explained: whether the reason of the text applies.
        """
        text, runs = self.statements[name], results.runs
        missing = [key for key in needs if key not in runs or runs[key].verdict == "INVALID"]
        if missing:
            return Statement(text["at"], text["claim"], f"not made: {', '.join(missing)}.", OPEN)
        why = text.get("why", "") if is_explained else ""
        return Statement(text["at"], text["claim"], measured, judge_parts(holds), why)


def read_text(name: str) -> Text:
    """The text of a paper."""
    found = tomllib.loads(files(__package__).joinpath("papers", f"{name}.toml").read_text(encoding="utf-8"))
    first, last = found.pop("seeds")
    readings = tuple(Deviation(**{"other": ""} | one) for one in found.pop("readings", ()))
    protocol = tuple(found.pop("protocol"))
    return Text(protocol=protocol, seeds=tuple(range(first, last + 1)), readings=readings, **found)


@dataclass(frozen=True)
class Paper:
    """One paper.

    ``plan``: (seeds) -> the entries. ``measure``: (outcome of an entry, as its experiment makes it) -> its figures.
    ``curves``: (outcome) -> what ``draw`` needs of an entry that is ``drawn``; None: the figures suffice. ``compare``,
    ``judge``, ``draw``: (results) -> tables, statements in the order of the paper, figures. All of them are functions
    of a module, so that a run can be made in another process.
    """

    name: str
    text: Text
    plan: Callable[[Sequence[int]], Sequence[Entry]]
    measure: Callable[[Any], Mapping[str, float | None]]
    compare: Callable[[Results], Sequence[Table]]
    judge: Callable[[Results], Sequence[Statement]]
    draw: Callable[[Results], Sequence[Figure]]
    curves: Callable[[Any], Any] | None = None
