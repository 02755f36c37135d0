"""Tables, bounds and statements, measured beside published."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

#: Verdict on a statement of a paper on this bench.
FOLLOWS, IN_PART, FOLLOWS_NOT, OPEN = "follows", "follows in part", "does not follow", "cannot be checked"


def rank_names(values: Mapping[str, float | None]) -> list[str]:
    """Names from the least value to the greatest; those without a value are last, in their own order."""
    return sorted(values, key=lambda name: (values[name] is None, values[name] or 0.0))


def find_least(values: Mapping[str, float | None]) -> str | None:
    """The name with the least value; None if none has a value."""
    return next((name for name in rank_names(values) if values[name] is not None), None)


def divide(value: float | None, other: float | None) -> float | None:
    """A value divided by another; None if there is none."""
    return None if value is None or not other else value / other


def is_less(value: float | None, other: float | None) -> bool:
    """Whether a value is less than another; both must be known."""
    return value is not None and other is not None and value < other


def render(value: float | None, digits: int) -> str:
    """A value with its digits; ``-`` for none."""
    return "-" if value is None else f"{value:.{digits}f}"


@dataclass(frozen=True, slots=True)
class Line:
    """One figure: published, and measured by each column of its table; None: there is none.

    ``remark``: a note for readers of this figure. ``holds``: whether it is within its bounds; None: it has none, or was
    not measured.
    """

    item: str
    quantity: str
    unit: str
    digits: int
    published: float | None
    measured: tuple[float | None, ...]
    published_digits: int | None = None
    remark: str = ""
    holds: bool | None = None

    @property
    def ratios(self) -> tuple[float | None, ...]:
        """Measured by published, for each column; None without a published value, or if that is 0."""
        return tuple(divide(value, self.published) for value in self.measured)

    @property
    def published_text(self) -> str:
        """The published value as printed there."""
        return render(self.published, self.digits if self.published_digits is None else self.published_digits)


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
            found.append(render(value, line.digits))
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


def judge_parts(holds: Sequence[bool]) -> str:
    """The verdict on a claim, each part of which holds or not; without parts it cannot be checked.

    The verdict on a paper's statement is computed, never written down.
    """
    if not holds:
        return OPEN
    return FOLLOWS if all(holds) else IN_PART if any(holds) else FOLLOWS_NOT


def bounded_line(
    item: str,
    quantity: str,
    unit: str,
    digits: int,
    bounds: tuple[float | None, float | None],
    measured: tuple[float | None, ...],
    *,
    unmade: str = "",
    remark: str = "",
) -> Line:
    """The line of a figure that must be within bounds; the first measured value is compared.

    :param bounds: least and greatest allowed value; None: there is none.
    :param unmade: the verdict if an entry of the figure was not made; empty: all were made.
    :param remark: follows the verdict.
    """
    low, high = bounds
    allowed = (
        f"{low:g} to {high:g}" if None not in bounds else f"at most {high:g}" if low is None else f"at least {low:g}"
    )
    value = measured[0]
    if unmade:
        verdict = unmade
    elif value is None:
        verdict = "does not hold: no value"
    elif low is not None and value < low:
        verdict = "does not hold: below"
    else:
        verdict = "holds" if high is None or value <= high else "does not hold: above"
    holds = None if unmade else verdict == "holds"
    text = f"{item}, allowed {allowed}"
    return Line(text, quantity, unit, digits, None, measured, remark=f"{verdict}{remark}", holds=holds)


def check_bounds(lines: Sequence[Line], name: Callable[[Line], str]) -> tuple[str, Sequence[bool]]:
    """Figures in a sentence, and for each bound whether it holds; none unless all were measured.

    :param name: (line) -> the bound in words, in the list of those that do not hold.
    """
    made = [line for line in lines if line.holds is not None]
    missed = [f"{name(line)}: {render(line.measured[0], line.digits)}" for line in made if not line.holds]
    left = f" ({len(lines) - len(made)} not made)" if len(made) < len(lines) else ""
    outside = f"; not: {'; '.join(missed)}" if missed else ""
    said = f"{len(made) - len(missed)} of {len(made)} hold{left}{outside}."
    return said, () if left else [bool(line.holds) for line in made]
