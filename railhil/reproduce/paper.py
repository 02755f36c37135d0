"""What a paper is for ``railhil reproduce``: runs to be made, and what is read from them beside the published figures.

A paper is one record (:class:`Paper`) in a module of its own. All its parts are pure functions of the measured runs, so
that the same seeds give the same bytes.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import median
from typing import TYPE_CHECKING, Any

from railhil.report.deviations import Deviation
from railhil.reproduce.ways import Recorded, Way
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    # Needs the extra [report].
    from railhil.report.figures import Picture

#: What a statement of a paper comes to on this bench.
FOLLOWS, IN_PART, FOLLOWS_NOT, OPEN = "follows", "follows in part", "does not follow", "cannot be checked"


@dataclass(frozen=True, slots=True)
class Planned:
    """One entry of a protocol: ``key`` names it in tables, documents and folders; ``drawn``: a figure shows its curves.

    ``spec``: the run; of a set of sequences any of its runs. ``how``: the way in which the entry is made.
    """

    key: str
    spec: RunSpec
    drawn: bool = False
    how: Way = field(default_factory=Recorded)

    @property
    def again(self) -> str:
        """The command that makes it alone; empty: there is none."""
        words = self.how.words(self.spec)
        return shlex.join(["railhil", *words]) if words else ""

    @property
    def identity(self) -> list[str]:
        """What its figures depend on besides the code: way, law with its parameters, run."""
        return [repr(self.how), self.spec.law.label, *self.spec.words]


@dataclass(frozen=True, slots=True)
class Measured:
    """What is kept of an entry: its figures by name (None: a run did not get that far), and the curves of a drawn one.

    ``reasons``: why the verdict is not PASS. ``sha256``: of its log; empty if it has none.
    """

    key: str
    verdict: str
    reasons: tuple[str, ...]
    sha256: str
    values: Mapping[str, float | None]
    curves: Any = None


@dataclass(frozen=True)
class Results:
    """The measured entries of a protocol by key, and the seeds with which they were made; not all need to be there."""

    seeds: tuple[int, ...]
    runs: Mapping[str, Measured]

    def value(self, key: str, name: str) -> float | None:
        """A figure of one entry; None if it has no value or was not made."""
        return self.runs[key].values[name] if key in self.runs else None

    def over(self, keys: Iterable[str], name: str, reduce: Callable[[list[float]], float] = median) -> float | None:
        """A figure over entries, by default its median; None if one of them has no value or was not made."""
        values = [self.value(key, name) for key in keys]
        known = [value for value in values if value is not None]
        return float(reduce(known)) if values and len(known) == len(values) else None


@dataclass(frozen=True, slots=True)
class Line:
    """One figure: published, and measured by each column of its table; None: there is none.

    ``remark``: what a reader must know about this figure.
    """

    item: str
    quantity: str
    unit: str
    digits: int
    published: float | None
    measured: tuple[float | None, ...]
    published_digits: int | None = None
    remark: str = ""

    @property
    def ratios(self) -> tuple[float | None, ...]:
        """Measured by published, for each column; None without a published value, or if that is 0."""
        return tuple(None if not self.published or value is None else value / self.published for value in self.measured)

    def shown(self, value: float | None) -> str:
        """A measured value with its digits; ``-`` for none."""
        return "-" if value is None else f"{value:.{self.digits}f}"

    @property
    def published_shown(self) -> str:
        """The published value as printed there."""
        digits = self.digits if self.published_digits is None else self.published_digits
        return "-" if self.published is None else f"{self.published:.{digits}f}"


@dataclass(frozen=True, slots=True)
class Table:
    """A table of the paper: ``columns`` name the measured values of each line, ``note`` stands below.

    ``with_ratio``: ratios mean something here (they do not for percentages that may be negative).
    """

    name: str
    title: str
    columns: tuple[str, ...]
    lines: tuple[Line, ...]
    note: str = ""
    with_ratio: bool = True

    @property
    def is_published(self) -> bool:
        """True if the paper prints a value of at least one line."""
        return any(line.published is not None for line in self.lines)

    @property
    def headings(self) -> list[str]:
        """Titles of :meth:`cells`; those from :attr:`first_number` on, without the last, are numbers."""
        found = ["quantity", "", "unit", *(["published"] if self.is_published else [])]
        for name in self.columns:
            found += [name, "ratio"] if self._has_ratio else [name]
        return [*found, "remark"]

    @property
    def first_number(self) -> int:
        """Place of the first column of numbers in :attr:`headings`."""
        return 3

    @property
    def _has_ratio(self) -> bool:
        return self.with_ratio and self.is_published

    def cells(self, line: Line) -> list[str]:
        """A line as texts."""
        found = [line.quantity, line.item, line.unit, *([line.published_shown] if self.is_published else [])]
        for value, ratio in zip(line.measured, line.ratios, strict=True):
            found.append(line.shown(value))
            if self._has_ratio:
                found.append("-" if ratio is None else f"{ratio:#.3g}".rstrip("."))
        return [*found, line.remark]


@dataclass(frozen=True, slots=True)
class Statement:
    """Something that the paper says: where, what, what is measured here, the verdict (``FOLLOWS``, ``IN_PART``,
    ``FOLLOWS_NOT`` or ``OPEN``), and why."""

    at: str
    claim: str
    measured: str
    verdict: str
    why: str = ""


def checked(results: Results, statement: Statement, keys: Iterable[str]) -> Statement:
    """The statement, which cannot be checked unless all entries that it needs were made and can be trusted."""
    missing = [key for key in keys if key not in results.runs or results.runs[key].verdict == "INVALID"]
    if not missing:
        return statement
    return replace(statement, measured=f"not made: {', '.join(missing)}.", verdict=OPEN, why="")


def no_curves(outcome: Any) -> None:
    """For a paper whose figures are drawn from the measured values."""


@dataclass(frozen=True)
class Paper:
    """One paper.

    ``protocol``: how the runs are made, in sentences. ``seeds``: those of the page; ``planned``: (seeds) -> the
    entries. ``measure``: (outcome of an entry, as its way makes it) -> its figures; ``curves``: (outcome) -> what
    ``figures`` draws of one that is ``drawn``.
    ``tables``, ``statements``, ``figures``: (results) -> parts of the page. ``readings``: () -> places of the paper
    that can be read in more than one way, and how the bench reads them. All of them are functions of a module, so that
    a run can be made in another process.
    """

    name: str
    title: str
    source: str
    protocol: tuple[str, ...]
    seeds: tuple[int, ...]
    planned: Callable[[Sequence[int]], Sequence[Planned]]
    measure: Callable[[Any], Mapping[str, float | None]]
    tables: Callable[[Results], Sequence[Table]]
    statements: Callable[[Results], Sequence[Statement]]
    figures: Callable[[Results], Sequence[Picture]]
    readings: Callable[[], Sequence[Deviation]] = field(default=tuple)
    curves: Callable[[Any], Any] = no_curves


def order(values: Mapping[str, float | None]) -> list[str]:
    """Names from the least value to the greatest; those without a value are last, in their own order."""
    return sorted(values, key=lambda name: (values[name] is None, values[name] or 0.0))


def least(values: Mapping[str, float | None]) -> str | None:
    """The name with the least value; None if none has a value."""
    return next((name for name in order(values) if values[name] is not None), None)
