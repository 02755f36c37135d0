"""The figures of a least case: signals of its sentence, margin, faults and levels of the watches; beside them the same
run without the faults and the nearest one that keeps the requirement."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from railhil.charts.figure import FREE, TIME, ZERO, Area, Bounds, Chart, Curve, Figure, FloatArray, Look
from railhil.judge.events.event import FAULT
from railhil.judge.record import Record
from railhil.judge.requirements.drawn import DrawnSentence, Series
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.outcome import Outcome
from railhil.report.over_time import RunColumns, columns_of, levels_chart
from railhil.report.styles import Style

_HEIGHT_PX, _NAME_PX = 120, 18
#: Letters of the name of a fault beside its bar.
_NAME_LETTERS = 20
#: Dashes and widths of the runs: the case, the nearest one that passes, the one without faults.
_RUNS = ((1.8, ()), (1.3, (7.0, 3.0)), (1.1, (2.0, 2.0)))
_CURVES = (
    "Solid: the case",
    "dashed: the nearest case that keeps the requirement",
    "dotted: the same run without faults",
)
#: Colours of the runs where a chart has a single value.
_COLOURS = ("0", "2", "dim")
#: Least time shown before and behind what decides, in s, and its share of that.
_PAD_S, _PAD_SHARE = 0.2, 0.3
#: Begins and ends of faults that are longer before the decision are not in the near view, in s.
_NEAR_S = 2.0


@dataclass(frozen=True, slots=True)
class Side:
    """A run on the page: its record, and its grid; ``number`` as in :func:`side`."""

    number: int
    label: str
    record: Record
    grid: Grid
    columns: RunColumns


def side(label: str, record: Record, number: int) -> Side:
    """One of the runs of a case.

    :param number: 0: the case; 1: the nearest one that passes; 2: the one without faults.
    """
    return Side(number, label, record, Grid(record), columns_of(record.copy_with(label=label), -1, Style(number)))


def figures(name: str, sides: Sequence[Side], drawn: DrawnSentence | None, outcome: Outcome | None) -> list[Figure]:
    """The time around the decision, and the whole run.

    :param sides: the case first.
    :param drawn: its sentence; None: a rule of every run. ``outcome``: of the case.
    """
    end_s = max(float(one.columns.time_s[-1]) for one in sides)
    near = _near(sides[0].record, outcome, end_s)
    whole = Figure(f"{name}-whole", "The whole run", "", _charts(f"{name}-whole", sides, drawn, outcome, (0.0, end_s)))
    if not whole.charts:
        return []
    if near is None:
        return [whole]
    curves = f"{'; '.join(_CURVES[one.number] for one in sides)}. " if len(sides) > 1 else ""
    caption = f"{curves}A margin below 0 is no violation yet where the sentence allows a time."
    return [
        Figure(f"{name}-near", "What decides", caption, _charts(f"{name}-near", sides, drawn, outcome, near)),
        whole,
    ]


def _near(record: Record, outcome: Outcome | None, end_s: float) -> tuple[float, float] | None:
    """The part of the run that decides; None: it is not known."""
    if outcome is None or outcome.instant_s is None:
        return None
    first = outcome.instant_s if outcome.trigger_s is None else outcome.trigger_s
    last = max(outcome.instant_s, first + (outcome.allowed_s or 0.0))
    edges = [at for one in record.events if one.kind == FAULT for at in (one.time_s, one.time_s + one.lasted_s)]
    first = min([first, *(at for at in edges if first - _NEAR_S < at < first)])
    pad_s = max(_PAD_S, _PAD_SHARE * (last - first))
    return max(0.0, first - pad_s), min(end_s, last + pad_s)


def _charts(
    name: str, sides: Sequence[Side], drawn: DrawnSentence | None, outcome: Outcome | None, bounds: tuple[float, float]
) -> list[Chart]:
    found = []
    marks = [*_window(outcome), *_faults(sides[0])]
    if drawn is not None:
        found += [_values(group, sides, bounds, marks) for group in _grouped(drawn.series())]
        found.append(_margin(drawn, sides, bounds, marks))
    found += _fault_bars(sides[0], bounds)
    for one in sides:
        shown = [column for column in one.columns.shown.columns if column.kind == "level"]
        pairs = [(one.columns, column) for column in shown if column.name in one.columns.values]
        if pairs:
            chart = levels_chart(pairs, bounds, is_named=False)
            found.append(replace(chart, y_label=f"level: {one.label}"))
    last = len(found) - 1
    return [replace(one, sync=name, x_label=TIME if place == last else "") for place, one in enumerate(found)]


def _grouped(series: Sequence[Series]) -> list[list[Series]]:
    """Values of one unit share a chart; a level has its own."""
    found: dict[tuple[str, str], list[Series]] = {}
    for one in series:
        found.setdefault((one.unit, one.text if one.words else ""), []).append(one)
    return list(found.values())


def _values(group: Sequence[Series], sides: Sequence[Side], bounds: tuple[float, float], marks: list[Area]) -> Chart:
    curves = []
    for place, series in enumerate(group):
        for one in sides:
            alone = len(group) == 1
            label = one.label if alone else f"{series.text}: {one.label}"
            colour = _COLOURS[one.number] if alone else str(place)
            values, is_level = series.values(one.grid), bool(series.words)
            curves.append(_curve(label, values, one, bounds, colour, series.unit, is_level))
    limits = {value: text for series in group for value, text in series.limits.items()}
    lines = [Area(None, (value, value), "line", f"limit {text}") for value, text in limits.items()]
    words = {value: word.replace("_", " ") for value, word in group[0].words.items()}
    y_bounds: Bounds = (min(words) - 0.4, max(words) + 0.4) if words else _around([*curves], list(limits))
    texts = ", ".join(dict.fromkeys(series.text for series in group))
    unit = f" ({group[0].unit})" if group[0].unit and not words else ""
    said = f"; limit {', '.join(limits.values())}" if limits else ""
    height_px = max(_HEIGHT_PX, _NAME_PX * len(words))
    return Chart(curves, "", f"{texts}{unit}{said}", bounds, y_bounds, [*marks, *lines], y_names=words,
                 height_px=height_px)  # fmt: skip


def _around(curves: Sequence[Curve], limits: Sequence[float]) -> Bounds:
    """Bounds that have the curves and the limits."""
    known = np.concatenate([*(one.y[np.isfinite(one.y)] for one in curves), np.array(limits, dtype=np.float64)])
    if not known.size:
        return FREE
    low, high = float(known.min()), float(known.max())
    pad = 0.08 * (high - low) or 0.5
    return low - pad, high + pad


def _margin(drawn: DrawnSentence, sides: Sequence[Side], bounds: tuple[float, float], marks: list[Area]) -> Chart:
    curves = [_curve(one.label, drawn.margin(one.grid), one, bounds, _COLOURS[one.number], drawn.unit) for one in sides]
    unit = drawn.unit or "each comparison divided by its scale"
    return Chart(curves, "", f"margin of the condition ({unit})", bounds, _around(curves, [0.0]), [*marks, ZERO],
                 height_px=_HEIGHT_PX)  # fmt: skip


def _curve(
    label: str, values: FloatArray, one: Side, bounds: tuple[float, float], colour: str, unit: str,
    is_level: bool = False,
) -> Curve:  # fmt: skip
    """A value over time, with one tick beyond each bound."""
    tick_ns, count = one.grid.tick_ns, one.grid.count
    first = max(0, int(bounds[0] * 1e9) // tick_ns - 1)
    after = min(count, int(bounds[1] * 1e9) // tick_ns + 3)
    time_s = np.arange(first, after, dtype=np.float64) * tick_ns / 1e9
    width, dashes = _RUNS[one.number]
    is_near = after - first < count
    return Curve(
        label, time_s, values[first:after], Look(colour, width, dashes), unit, is_step=is_level or is_near, run=-1
    )  # fmt: skip


def _window(outcome: Outcome | None) -> Iterator[Area]:
    if outcome is None or outcome.instant_s is None:
        return
    if outcome.trigger_s is not None and outcome.allowed_s:
        until_s = outcome.trigger_s + outcome.allowed_s
        text = f"allowed: {outcome.trigger_s:.2f} s to {until_s:.2f} s"
        yield Area((outcome.trigger_s, until_s), None, "allowed", text, label="allowed time")
    text = f"{outcome.instant_s:.2f} s: here the margin is decided"
    yield Area((outcome.instant_s, outcome.instant_s), None, "line", text)


def _faults(one: Side) -> Iterator[Area]:
    for event in one.record.events:
        if event.kind == FAULT:
            yield Area((event.time_s, event.time_s + event.lasted_s), None, "fault", event.detail)


def _shortened(text: str) -> str:
    """A name that has room beside a chart; the whole text stands under the pointer."""
    return text if len(text) <= _NAME_LETTERS else f"{text[: _NAME_LETTERS - 3]}..."


def _fault_bars(one: Side, bounds: tuple[float, float]) -> list[Chart]:
    """A bar for each fault of a run; empty: it has none."""
    events = [event for event in one.record.events if event.kind == FAULT]
    names = {float(-place): _shortened(f"{event.source} {event.cause}") for place, event in enumerate(events)}
    bars = [
        Area((event.time_s, event.time_s + event.lasted_s), (-place - 0.32, -place + 0.32), "fault", event.detail)
        for place, event in enumerate(events)
    ]
    rows = len(events)
    chart = Chart([], "", "faults", bounds, (0.5 - rows, 0.5), bars, y_names=names, height_px=_NAME_PX * rows)
    return [chart] if events else []
