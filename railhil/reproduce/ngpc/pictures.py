"""Figures 8 to 13: speed and its error over distance in each situation, of the first seed."""

from __future__ import annotations

from railhil.charts.figure import FREE, TARGET, Chart, Curve, Figure
from railhil.report.figures import Picture, printed
from railhil.report.styles import styles
from railhil.reproduce.ngpc.names import DRAWN, EMERGENCY, MUTATION, NORMAL, key
from railhil.reproduce.ngpc.runs import Drawable
from railhil.reproduce.paper import Results

_FIGURES = {NORMAL: (8, 9), EMERGENCY: (10, 11), MUTATION: (12, 13)}
#: Around the emergency only, km.
_EMERGENCY_KM = (209.0, 215.0)
_PLACE = "position (km)"


def pictures(results: Results) -> list[Picture]:
    """One picture for each situation."""
    return printed(
        [_figure(results, situation) for situation in _FIGURES if any(_drawn(results, situation, law) for law in DRAWN)]
    )


def _drawn(results: Results, situation: str, law: str) -> Drawable | None:
    """The curves of a run; None: it was not made or not drawn."""
    name = key(situation, law, results.seeds[0])
    found = results.runs[name].curves if name in results.runs else None
    return found if isinstance(found, Drawable) else None


def _figure(results: Results, situation: str) -> Figure:
    upper, lower = _FIGURES[situation]
    speeds: list[Curve] = []
    errors: list[Curve] = []
    for law, style in zip(DRAWN, styles(DRAWN), strict=True):
        found = _drawn(results, situation, law)
        if found is None:
            continue
        place_km = found.position_m / 1e3
        if law == DRAWN[0]:
            speeds.append(Curve("target", place_km, found.target_kmh, TARGET))
        speeds.append(Curve(law, place_km, found.speed_kmh, style.look))
        errors.append(Curve(law, place_km, found.error_kmh, style.look))
    bounds = _EMERGENCY_KM if situation == EMERGENCY else FREE
    charts = [
        Chart(speeds, "", "speed (km/h)", bounds, (0.0, None), sync=_PLACE, height_px=210),
        Chart(errors, _PLACE, "error (km/h)", bounds, sync=_PLACE, height_px=290),
    ]
    title = f"Figures {upper} and {lower}: speed and its error, {situation}"
    caption = "True speed; the error is the speed less the target. The papers have these curves as pictures only."
    return Figure(f"figures_{upper}_{lower}", title, caption, charts)
