"""Styles that distinguish runs in the same axes.

Colour, dash pattern and marker identify the law and are the same in every report; a second run of a law (with other
parameters) has a thinner line and a filled marker. Dashes, widths and markers survive greyscale printing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from railhil.charts.figure import Look
from railhil.common.plug_ins import shipped_order

#: Colours of Okabe and Ito (distinguishable with colour blindness), dashes in px, markers. The first ones belong to
#: the laws of :func:`shipped_order`, the rest to others.
_LAWS: tuple[tuple[str, tuple[float, ...], str], ...] = (
    ("#0072b2", (), "o"),
    ("#d55e00", (7, 2), "s"),
    ("#009e73", (5, 2, 1.2, 2), "D"),
    ("#cc79a7", (1.8, 1.4), "^"),
    ("#000000", (11, 2, 1.2, 2, 1.2, 2), "v"),
    ("#e69f00", (3.5, 3.5), "P"),
    ("#56b4e9", (14, 4), "X"),
)
#: Width of the line in px and fill of the marker: for a law's first run, its second, and further ones.
_VARIANTS = ((1.5, "none"), (0.7, "full"), (2.3, "full"), (1.1, "full"))
#: Number of runs of one law that keep its colour; further ones use styles not taken by other laws.
_OF_ONE_LAW = 2
_MARKER_PX = 8.0
#: Styles of further columns of a run.
_DASHES = ((), (7.0, 3.0), (2.0, 2.0), (10.0, 3.0, 2.0, 3.0), (4.0, 4.0))


@dataclass(frozen=True, slots=True)
class Style:
    """Indices in the tables above."""

    law: int = 0
    variant: int = 0

    @property
    def colour(self) -> str:
        """Colour of lines and markers."""
        return _LAWS[self.law][0]

    @property
    def dashes(self) -> tuple[float, ...]:
        """Dash pattern in px; empty for a continuous line."""
        return _LAWS[self.law][1]

    @property
    def width(self) -> float:
        """Width of the line in px."""
        return _VARIANTS[self.variant][0]

    @property
    def look(self) -> Look:
        """In shared charts; the marker appears only in the legend, and where a point is marked. A filled one is small,
        so that a hollow one at the same place stays visible."""
        is_full = _VARIANTS[self.variant][1] != "none"
        # Points of several laws may coincide; three sizes keep them visible.
        marker_px = 0.75 * _MARKER_PX if is_full else _MARKER_PX + 2.0 * (self.law % 3)
        return Look(str(self.law), self.width, self.dashes, _LAWS[self.law][2], is_full, marker_px)

    @property
    def alone(self) -> Look:
        """In charts of one run, where the colour is sufficient."""
        return Look(str(self.law))

    def dashed(self, number: int) -> Look:
        """Of one of several columns in a shared chart, counted from 0."""
        return replace(self.look, dashes=self.dashes if number == 0 else _DASHES[number % len(_DASHES)], marker="")


def styles(laws: Sequence[str]) -> list[Style]:
    """A style for each run.

    :param laws: law of each run, in the order of the runs.
    :returns: all different for up to 28 runs; the styles of a law's first two runs do not depend on the other runs if
        it is one of :func:`~railhil.common.plug_ins.shipped_order`.
    """
    order = shipped_order()
    places = {law: order.index(law) for law in laws if law in order}
    others = [law for law in dict.fromkeys(laws) if law not in places]
    free = [place for place in range(len(_LAWS)) if place not in places.values()]
    # Styles not used by railhil's own laws come first.
    free.sort(key=lambda place: place < len(order))
    places |= dict(zip(others, free, strict=False))
    found: dict[int, Style] = {}
    for law, place in places.items():
        runs = [index for index, name in enumerate(laws) if name == law]
        found |= {index: Style(place, variant) for variant, index in enumerate(runs[:_OF_ONE_LAW])}
    rest = _unused(list(found.values()))
    return [found[index] if index in found else next(rest) for index in range(len(laws))]


def _unused(taken: Sequence[Style]) -> Iterator[Style]:
    """Styles that are not taken, followed by all of them."""
    every = [Style(law, variant) for variant in range(len(_VARIANTS)) for law in range(len(_LAWS))]
    yield from (style for style in every if style not in taken)
    while True:
        yield from every
