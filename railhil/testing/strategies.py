"""Faults as a strategy of hypothesis: counterexamples shrink to fewer, shorter and later faults.

Needs hypothesis, which no extra of railhil installs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hypothesis import strategies as st

from railhil.bus.can_settings import LOCAL
from railhil.common.command_line import USUAL_SCENARIO
from railhil.faults.capability import life_signal, why_not
from railhil.faults.language import fault_text
from railhil.faults.model import COUNT, NAME, PPM, SHARE, TIME, Fault, Parameter, Place, Trigger, Value, Word
from railhil.faults.random_faults import Ports, words_drawn
from railhil.faults.words import PLACES
from railhil.scenarios.fault_list import list_disturbed_signals
from railhil.scenarios.load import load_any
from railhil.scenarios.system import System

#: Resolution of instants and durations, and the longest duration, in s.
_STEP_S, _LONGEST_S = 0.01, 10.0
#: Nodes that a fault may end without ending the record.
_NODES = ("controller",)


def faults(
    scenario: str = USUAL_SCENARIO, *, settings: Sequence[str] = (), min_size: int = 1, max_size: int = 2
) -> st.SearchStrategy[tuple[str, ...]]:
    """Lists of faults in the fault language that a lockstep run of a scenario in one process can inject.

    :param scenario: shipped name or TOML file; its timetable bounds the instants, its system the places.
    :param min_size, max_size: number of faults.
    :raises InputError: there is no such scenario.
    """
    loaded = load_any(scenario, settings)
    system = loaded.installed_system
    ports = list_disturbed_signals(system)
    places = _places(system, ports)
    last = round(loaded.planned_s / _STEP_S) - 1

    @st.composite
    def fault(draw: st.DrawFn) -> Fault:
        word, place = draw(st.sampled_from(places))
        values = {one.name: draw(_value(one, place, ports)) for one in word.parameters if one.usual is None}
        # Counted from the end, so that a simpler fault is later.
        trigger = Trigger("time", round((last - draw(st.integers(0, last))) * _STEP_S, 2))
        steps = draw(st.integers(1, round(_LONGEST_S / _STEP_S))) if word.lasts else 0
        duration_s = round(steps * _STEP_S, 2) if steps else None
        return Fault(place, word.name, trigger, values, duration_s=duration_s)

    def texts(found: list[Fault]) -> tuple[str, ...]:
        # Several may meet on one target.
        return tuple(fault_text(replace(one, combine=len(found) > 1)) for one in found)

    return st.lists(fault(), min_size=min_size, max_size=max_size).map(texts)


def _places(system: System, ports: Ports) -> list[tuple[Word, Place]]:
    """All words with the places at which they can be injected, telegrams first."""
    found = [
        (word, place)
        for word in sorted(words_drawn(), key=lambda word: word.level != "telegram")
        for place in _places_of(word, system, ports)
    ]
    return [one for one in found if not why_not(Fault(one[1], one[0].name, Trigger("time")), LOCAL, "lockstep")]


def _places_of(word: Word, system: System, ports: Ports) -> list[Place]:
    level = word.level
    if level == "telegram":
        parts = {"whole": [""], "counter": ["counter"], "checksum": ["checksum"]}
        return [
            Place(level, port, part)
            for port, signals in ports.items()
            for part in parts.get(word.part, signals)
            if part != "counter" or life_signal(system.contract.port(port)) is not None
        ]
    if level == "bus":
        return [Place(level)] if word.part == "whole" else []
    names = {"node": _NODES, "command": tuple(system.named)}.get(level, word.names or tuple(PLACES[level]))
    plants = level in ("train", "sensor", "actuator")
    return [Place(level, name) for name in names if not plants or f"{level}.{name}" in system.injects]


def _value(parameter: Parameter, place: Place, ports: Ports) -> st.SearchStrategy[Value]:
    """Values of the size that a field engineer would try, within the range of the parameter."""
    if parameter.unit == NAME:
        return st.sampled_from([name for name in ports if name != place.name])
    spans = {SHARE: (1, 100, 0.01), TIME: (1, 300, 0.01), COUNT: (1, 6, 1.0), PPM: (-1000, 1000, 1.0)}
    low, high, unit = spans.get(parameter.unit, (1, 40, 0.05) if "factor" in parameter.name else (-50, 50, 1.0))

    def within(number: int) -> float:
        return round(min(max(number * unit, parameter.low), parameter.high), 4)

    return st.integers(low, high).map(within)
