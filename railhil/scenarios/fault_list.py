"""The faults of a scenario: from tables and texts to canonical texts that its system can inject."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeAlias

from railhil.common.errors import InputError, did_you_mean
from railhil.dbc import Port
from railhil.faults.capability import instruments, life_signal, port_names
from railhil.faults.language import FAULTS_MAX, fault_text, parse
from railhil.faults.model import COUNT, Draw, Fault, Injection, Place, Random, Trigger, Value
from railhil.faults.notation import ALLOWED, place_text, trigger_text
from railhil.faults.span import with_span
from railhil.faults.tables import fault_of
from railhil.faults.words import CLEAR, kind_of_part, word_of
from railhil.scenarios import streams
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import System

#: Planned instants of a scenario by their name, in s from the start of the run: the n-th has number n; None: it has
#: no time.
Marks: TypeAlias = Mapping[str, Sequence[float | None]]
_NO_MARKS: Marks = MappingProxyType({})
#: Events that every run has: milestones of the bench.
_MILESTONES = ("departed", "stopped", "emergency")


def fault_texts(
    rows: Sequence[Mapping[str, Any] | str],
    system: System,
    origin: Callable[[int], Path],
    marks: Marks = _NO_MARKS,
) -> tuple[str, ...]:
    """Canonical texts of the rows of ``fault``, tables and texts. A fault that begins at a mark begins at its time.

    :param origin: file of a row.
    :param marks: planned instants of the scenario.
    :raises InputError: a row is not in the language, its system cannot inject it, or two of them act on one target.
    """
    found: list[Fault] = []
    for index, row in enumerate(rows):
        refuse = _Refuse(origin(index), row if isinstance(row, str) else f"fault[{index}]")
        if index >= FAULTS_MAX:
            raise refuse(f"{len(rows)} faults", f"at most {FAULTS_MAX}")
        fault = _planned(fault_of(row, refuse, origin(index)), marks, refuse)
        _check(fault, system, refuse)
        for other in found:
            if _collide(fault, other):
                allowed = "combine in both, or one after the other: one fault at a time on a target"
                raise refuse(f"{fault_text(other)} on the same target", allowed)
        found.append(fault)
    return tuple(map(fault_text, found))


class _Refuse:
    """Makes the errors of one row."""

    def __init__(self, file: Path, key: str) -> None:
        self._file = file
        self._key = key

    def __call__(self, found: str, allowed: str, hint: str | None = None) -> InputError:
        return InputError(self._file, self._key, found, allowed, hint)


def _planned(fault: Fault, marks: Marks, refuse: _Refuse) -> Fault:
    """The fault with a time in the place of its mark."""
    trigger = fault.trigger
    if trigger.kind != "mark":
        return fault
    name, _, number = str(trigger.value).partition(" ")
    times_s = marks.get(name, ())
    known = [index for index, time_s in enumerate(times_s, 1) if time_s is not None]
    if int(number) not in known:
        allowed = ", ".join(f"{name} {index}" for index in known) or ", ".join(f"{one} 1" for one in marks) or ALLOWED
        raise refuse(f"@{trigger_text(trigger)}", allowed, None if name in marks else did_you_mean(name, marks))
    at_s = times_s[int(number) - 1]
    assert at_s is not None
    return with_span(replace(fault, trigger=Trigger("time", round(at_s + trigger.delay_s, 9))), refuse)


def _check(fault: Fault, system: System, refuse: _Refuse) -> None:
    place, trigger = fault.place, fault.trigger
    if place.level == "telegram":
        for name in port_names(fault, system.contract, system.units, system.named):
            _check_port(fault, _port(name, place.name, system, refuse), system, refuse)
        if fault.what == "masquerade":
            other = str(fault.values["port"])
            whole = replace(fault, place=Place("telegram"))
            _check_port(whole, _port(other, other, system, refuse), system, refuse)
    elif place.level == "command":
        if place.name not in system.named:
            known = ", ".join(f"command.{name}" for name in system.named) or "no command of this system has a name"
            raise refuse(place_text(place), known)
    elif place.level in ("train", "sensor", "actuator") and f"{place.level}.{place.name}" not in system.injects:
        allowed = ", ".join(system.injects) or f"none: the plant of system {system.name} has no faults of its own"
        raise refuse(place_text(place), allowed, did_you_mean(place_text(place), system.injects))
    if fault.units and place.level not in ("telegram",) and not system.units:
        raise refuse(f"units {fault.units}", f"no units: a train of system {system.name} has one")
    if fault.units and max(fault.units) > max(1, len(system.units)):
        raise refuse(f"unit {max(fault.units)}", f"units 1 to {max(1, len(system.units))}")
    truth = system.truth
    if trigger.kind in ("position", "speed") and not (truth and getattr(truth, trigger.kind)):
        raise refuse(f"@ a {trigger.kind}", f"no {trigger.kind}: system {system.name} does not say where it is sent")
    for event in filter(None, (trigger.value if trigger.kind == "event" else "", fault.until)):
        known_events = events_of(system)
        if event not in known_events:
            raise refuse(str(event), f"one of {', '.join(known_events)}", did_you_mean(str(event), known_events))


def _port(name: str, written: str, system: System, refuse: _Refuse) -> Port:
    """The port of a name.

    :param written: the name in the fault, which may lack the unit.
    :raises InputError: there is no such port.
    """
    names = [port.name for port in system.contract.ports]
    if name not in names:
        raise refuse(written, f"a port: {', '.join(names)}", did_you_mean(written, names))
    return system.contract.port(name)


def list_disturbed_signals(system: System) -> dict[str, list[str]]:
    """The ports on which faults may act, in the order of the port table, with the names of their signals."""
    return {
        port.name: [signal.name for signal in port.signals]
        for port in system.contract.ports
        if not _is_instrument(port, system)
    }


def _is_instrument(port: Port, system: System) -> bool:
    return port.name in instruments(system.truth) or port.source == "supervisor"


def _check_port(fault: Fault, port: Port, system: System, refuse: _Refuse) -> None:
    if _is_instrument(port, system):
        raise refuse(port.name, "a port of the vehicle: the bench itself needs this one to observe the run")
    part = fault.place.part
    if kind_of_part("telegram", part) == "signal":
        names = [signal.name for signal in port.signals]
        if part not in names:
            raise refuse(part, f"counter, checksum, {', '.join(names)}", did_you_mean(part, names))
    if part == "counter" and life_signal(port) is None:
        raise refuse(f"{port.name}.counter", "a port with a life sign")


def events_of(system: System) -> list[str]:
    """Events by which a fault of this system may begin or end."""
    found = [*_MILESTONES, *system.events]
    truth = system.truth
    if truth is not None:
        found += ["standstill"] * bool(truth.speed) + ["braking"] * bool(truth.acceleration)
        found += ["traction"] * bool(truth.traction)
        for port, name in truth.levels.items():
            signal = next(one for one in system.contract.port(port).signals if one.name == name)
            found += signal.values.values()
    return list(dict.fromkeys(found))


def _collide(one: Fault, other: Fault) -> bool:
    """Whether two faults may be active on one target at the same time, and do not both say ``combine``."""
    if one.place != other.place or CLEAR in (one.what, other.what) or (one.combine and other.combine):
        return False
    if one.units and other.units and not {*one.units} & {*other.units}:
        return False
    first, second = sorted((one, other), key=lambda fault: _start_s(fault) or 0.0)
    begins_s, next_s = _start_s(first), _start_s(second)
    if begins_s is None or next_s is None or first.duration_s is None:
        return True
    return begins_s + first.duration_s > next_s


def _start_s(fault: Fault) -> float | None:
    trigger = fault.trigger
    return float(trigger.value) + trigger.delay_s if trigger.kind == "time" else None


def list_draws(faults: Sequence[Fault]) -> list[tuple[int, str]]:
    """The values of faults that each run draws anew, in the order of their numbers in a scenario's ``draws``: number of
    the fault, from 1, and name of the parameter. A fault with a seed of its own has the same values in every run."""
    return [
        (number, name)
        for number, fault in enumerate(faults, 1)
        if fault.seed is None
        for name in sorted(fault.values)
        if isinstance(fault.values[name], Draw)
    ]


def name_fault_draws(texts: Sequence[str]) -> tuple[str, ...]:
    """A name for each value of :func:`list_draws`.

    :param texts: the scenario's ``faults``.
    """
    faults = _parse_all(texts)
    return tuple(f"fault {number} {place_text(faults[number - 1].place)} {name}" for number, name in list_draws(faults))


def draw_values(fault: Fault, number: int, seed: int, numbers: Sequence[float] = ()) -> Fault:
    """A fault with its distributions drawn for one run: its text is in the language again.

    Counts are rounded down; a draw outside a parameter's bounds becomes the nearer bound.

    :param number: its place in the run's list, from 1.
    :param seed: of the run.
    :param numbers: standard normal numbers that draw its values, instead of the seed.
    """
    if not any(isinstance(value, Draw) for value in fault.values.values()):
        return fault
    source = streams.fault_generator(streams.FAULT_VALUES, seed, number, fault.seed)

    place = fault.place
    word = word_of(place.level, place.name, place.part, fault.what)
    assert word is not None
    parameters = {parameter.name: parameter for parameter in word.parameters}

    given = iter(numbers)

    def one(name: str, value: Value) -> Value:
        if not isinstance(value, Draw):
            return value
        if numbers:
            found = _drawn_by(value, next(given))
        elif value.kind == "uniform":
            found = float(source.uniform(value.a, value.b))
        else:
            found = float(source.normal(value.a, value.b))
        parameter = parameters[name]
        found = min(max(found, parameter.low), parameter.high)
        return float(int(found)) if parameter.unit == COUNT else found

    values = {name: one(name, fault.values[name]) for name in sorted(fault.values)}
    return replace(fault, values=MappingProxyType(values))


def _drawn_by(value: Draw, number: float) -> float:
    """The value that a standard normal number draws."""
    if value.kind == "uniform":
        return value.a + (value.b - value.a) * streams.probability_of(number)
    return value.a + value.b * number


def injection_of(scenario: AnyScenario, seed: int) -> Injection | None:
    """The data that the injectors of a run need; None: nothing is injected.

    :param seed: of the run.
    """
    return make_injection(scenario, seed) if scenario.faults else None


def make_injection(scenario: AnyScenario, seed: int) -> Injection:
    """:func:`injection_of`, also for a run without faults, which may be given some."""
    faults = draw_faults(scenario, seed)
    system = scenario.installed_system
    noise = getattr(scenario, "noise", ())

    def samples(number: int) -> Random:
        return streams.fault_samples(seed, number, faults[number - 1].seed, noise)

    return Injection(
        tuple(faults),
        samples,
        system.truth,
        system.named,
        system.units,
        {number: name for name, number in system.events.items()},
    )


def draw_faults(scenario: AnyScenario, seed: int) -> list[Fault]:
    """The faults of a scenario with the draws of one run, in their order: number n is the n-th.

    :raises InputError: a text is not in the language, as in a stored scenario that was changed.
    """
    return draw_each(_parse_all(scenario.faults), seed, getattr(scenario, "draws", ()))


def draw_each(faults: Sequence[Fault], seed: int, draws: Sequence[float]) -> list[Fault]:
    """All faults of a run with their values drawn.

    :param draws: of the run, the last of which are those of :func:`list_draws`; empty: the seed draws them.
    """
    places = [number for number, _ in list_draws(faults)] if draws else []
    own = list(zip(places, draws[len(draws) - len(places) :], strict=True))
    return [
        draw_values(fault, number, seed, [draw for place, draw in own if place == number])
        for number, fault in enumerate(faults, start=1)
    ]


def _parse_all(texts: Sequence[str]) -> list[Fault]:
    return [parse(text, "faults") for text in texts]
