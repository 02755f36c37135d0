"""Figures 8 to 13: speed and its error over distance in each situation, of the first seed."""

from __future__ import annotations

from matplotlib.figure import Figure

from railhil.reproduce.ngpc.names import DRAWN, EMERGENCY, MUTATION, NORMAL, key
from railhil.reproduce.ngpc.runs import Drawable
from railhil.reproduce.paper import Results
from railhil.supervisor.report import panels
from railhil.supervisor.report.figures import Picture, svg
from railhil.supervisor.report.styles import styles

_FIGURES = {NORMAL: (8, 9), EMERGENCY: (10, 11), MUTATION: (12, 13)}
#: Around the emergency only, km.
_EMERGENCY_KM = (209.0, 215.0)


def pictures(results: Results) -> list[Picture]:
    """One picture for each situation."""
    with panels.drawing("none"):
        return [
            _picture(results, situation)
            for situation in _FIGURES
            if any(_drawn(results, situation, law) for law in DRAWN)
        ]


def _drawn(results: Results, situation: str, law: str) -> Drawable | None:
    """The curves of a run; None: it was not made or not drawn."""
    name = key(situation, law, results.seeds[0])
    found = results.runs[name].curves if name in results.runs else None
    return found if isinstance(found, Drawable) else None


def _picture(results: Results, situation: str) -> Picture:
    upper_number, lower_number = _FIGURES[situation]
    name = f"figures_{upper_number}_{lower_number}"
    title = f"Figures {upper_number} and {lower_number}: speed and its error, {situation}"
    figure = Figure(figsize=(8.5, 5.4), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1, 1.4))
    for law, style in zip(DRAWN, styles(DRAWN), strict=True):
        found = _drawn(results, situation, law)
        if found is None:
            continue
        place_km = found.position_m / 1e3
        if law == DRAWN[0]:
            upper.plot(place_km, found.target_kmh, color="0.75", linewidth=3.5, label="target")
        upper.plot(place_km, found.speed_kmh, label=law, **style.line)
        lower.plot(place_km, found.error_kmh, **style.line)
    panels.legend(upper)
    upper.set(ylabel="speed (km/h)", ylim=(0, None))
    lower.set(xlabel="position (km)", ylabel="error (km/h)")
    if situation == EMERGENCY:
        lower.set_xlim(*_EMERGENCY_KM)
    caption = "True speed; the error is the speed less the target. The papers have these curves as pictures only."
    return Picture(name, title, caption, svg(figure, name, title))
