"""Tables, bands and statements, measured beside published."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from railhil.reproduce.paper import Results

#: Verdict on a statement of a paper on this bench.
FOLLOWS, IN_PART, FOLLOWS_NOT, OPEN = "follows", "follows in part", "does not follow", "cannot be checked"


def order(values: Mapping[str, float | None]) -> list[str]:
    """Names from the least value to the greatest; those without a value are last, in their own order."""
    return sorted(values, key=lambda name: (values[name] is None, values[name] or 0.0))


def least(values: Mapping[str, float | None]) -> str | None:
    """The name with the least value; None if none has a value."""
    return next((name for name in order(values) if values[name] is not None), None)


def quotient(value: float | None, other: float | None) -> float | None:
    """A value divided by another; None if there is none."""
    return None if value is None or not other else value / other


def is_less(value: float | None, other: float | None) -> bool:
    """Whether a value is less than another; both must be known."""
    return value is not None and other is not None and value < other


def decimal(value: float | None, digits: int) -> str:
    """A value with its digits; ``-`` for none."""
    return "-" if value is None else f"{value:.{digits}f}"


@dataclass(frozen=True, slots=True)
class Line:
    """One figure: published, and measured by each column of its table; None: there is none.

    ``remark``: a note for readers of this figure.
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
        return tuple(quotient(value, self.published) for value in self.measured)

    @property
    def published_text(self) -> str:
        """The published value as printed there."""
        return decimal(self.published, self.digits if self.published_digits is None else self.published_digits)


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
        found = [line.quantity, line.item, line.unit, *([line.published_text] if self.is_published else [])]
        for value, ratio in zip(line.measured, line.ratios, strict=True):
            found.append(decimal(value, line.digits))
            if self._has_ratio:
                found.append("-" if ratio is None else f"{ratio:#.3g}".rstrip("."))
        return [*found, line.remark]


@dataclass(frozen=True, slots=True)
class Statement:
    """A statement of the paper: its place, its text, the measured figures, the verdict (``FOLLOWS``, ``IN_PART``,
    ``FOLLOWS_NOT`` or ``OPEN``), and the reason."""

    at: str
    claim: str
    measured: str
    verdict: str
    why: str = ""


@dataclass(frozen=True, slots=True)
class Finding:
    """The measurement for a statement.

    ``statement``: its name in the text of the paper. ``measured``: the figures, in a sentence. ``holds``: whether each
    part of the claim holds; without parts it cannot be checked. ``needs``: the entries that the figures are from.
    ``is_explained``: whether the text's reason applies.
    """

    statement: str
    measured: str
    holds: Sequence[bool]
    needs: Iterable[str] = ()
    is_explained: bool = True

    @property
    def verdict(self) -> str:
        """The verdict. The verdict on a paper's statement is computed, never written down."""
        if not self.holds:
            return OPEN
        return FOLLOWS if all(self.holds) else IN_PART if any(self.holds) else FOLLOWS_NOT


@dataclass(frozen=True, slots=True)
class Band:
    """Least and greatest allowed value of a figure; None: there is none.

    ``at``, ``what``: its place in the table. ``needs``: (results) -> the entries that the figure is from. ``measured``:
    (results) -> the values in the table; the first of these is compared. ``unmade``: the verdict without an entry.
    """

    at: str
    what: str
    unit: str
    digits: int
    least: float | None
    most: float | None
    needs: Callable[[Results], Sequence[str]]
    measured: Callable[[Results], tuple[float | None, ...]]
    unmade: str = "not made"

    @property
    def limits(self) -> str:
        """The band in words."""
        if self.least is None:
            return f"allowed at most {self.most:g}"
        return f"allowed at least {self.least:g}" if self.most is None else f"allowed {self.least:g} to {self.most:g}"

    def value(self, results: Results) -> float | None:
        """The figure."""
        return self.measured(results)[0]

    def is_measured(self, results: Results) -> bool:
        """Whether the entries were made."""
        return results.has(self.needs(results))

    def holds(self, results: Results) -> bool:
        """Whether the figure is in the band; False without a value."""
        return self.verdict(results) == "holds"

    def verdict(self, results: Results) -> str:
        """In words, also the side on which a figure is outside."""
        if not self.is_measured(results):
            return self.unmade
        if (found := self.value(results)) is None:
            return "does not hold: no value"
        if self.least is not None and found < self.least:
            return "does not hold: below"
        return "holds" if self.most is None or found <= self.most else "does not hold: above"

    def line(self, results: Results, remark: str = "") -> Line:
        """Its line in a table; the remark follows the verdict."""
        remark = f"{self.verdict(results)}{remark}"
        return Line(
            f"{self.what}, {self.limits}", self.at, self.unit, self.digits, None, self.measured(results), remark=remark
        )


def check_bands(statement: str, results: Results, bands: Sequence[Band], name: Callable[[Band], str]) -> Finding:
    """The finding about some bands; it cannot be checked unless all were measured.

    :param name: (band) -> the band in words, in the list of those that do not hold.
    """
    made = [band for band in bands if band.is_measured(results)]
    held = [band.holds(results) for band in made]
    missed = [
        f"{name(band)}: {decimal(band.value(results), band.digits)}"
        for band, holds in zip(made, held, strict=True)
        if not holds
    ]
    left = f" ({len(bands) - len(made)} not made)" if len(made) < len(bands) else ""
    outside = f"; not: {'; '.join(missed)}" if missed else ""
    return Finding(statement, f"{sum(held)} of {len(made)} hold{left}{outside}.", () if left else held)
