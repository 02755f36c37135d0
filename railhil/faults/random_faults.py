"""Random faults for unforeseen combinations; each is a plain fault that can be run again."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from railhil.faults.language import fault_text, parse
from railhil.faults.model import (
    COUNT,
    LENGTH,
    NAME,
    PPM,
    SHARE,
    SPEED,
    TIME,
    Fault,
    Parameter,
    Place,
    Trigger,
    Value,
    Word,
)
from railhil.faults.words import CLEAR, PLACES, WORDS

#: Words whose effect is a run without verdict, and words for real time only.
LEFT_OUT = frozenset({("train", "nan"), ("clock", "pause"), ("node", "kill"), ("bus", "error_frames"), ("bus", "full")})
#: Nodes without which there is no verdict.
_OTHER_NODES = ("plant", "supervisor")
#: Shortest and longest time of a fault, in s.
DURATIONS_S = (0.01, 10.0)
#: Shortest time of a fault in s, where its target is only used at times: TIME_SYNC is sent each 1.28 s, a force acts
#: while it is commanded, and a wheel slips while it drives or brakes.
_RARE_S = {"clock": 1.5, "actuator": 1.0, "train": 1.0}
#: Place that acts only at single points of the line: its faults last to the end.
_LASTING = "balise"
#: The first fault of a pair begins in this share of the timetable, and the second this long after it on average, in s:
#: the second then still acts on a run whose train the first one stops.
BEGIN_SHARE, APART_S = 0.8, 1.0
_DIGITS = 3
#: Ports with the names of their signals.
Ports = Mapping[str, Sequence[str]]


@dataclass(frozen=True, slots=True)
class Sent:
    """When a run without faults sends a port: first and last instant, and the longest time between two, in s."""

    first_s: float
    last_s: float
    apart_s: float


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _value(chance: random.Random, word: Word, parameter: Parameter, ports: Sequence[str]) -> Value:
    """A value of realistic size, within the parameter's range and with an effect."""
    unit = parameter.unit
    if unit == NAME:
        return chance.choice(list(ports))
    if word.part in ("counter", "checksum"):
        # Whole numbers of some bits.
        drawn = float(chance.randint(1, 6))
    elif unit == SHARE:
        drawn = 10.0 ** chance.uniform(-1.0, 0.0)
    elif unit == TIME:
        drawn = 10.0 ** chance.uniform(-2.0, 0.5)
    elif unit == COUNT:
        drawn = float(chance.randint(1, 6))
    elif unit in (LENGTH, SPEED):
        drawn = chance.uniform(-50.0, 50.0)
    elif unit == PPM:
        drawn = chance.uniform(-1000.0, 1000.0)
    elif parameter.name == "coefficient":
        drawn = 10.0 ** chance.uniform(-3.0, -1.0)
    elif parameter.name == "factor":
        drawn = 2.0 ** chance.uniform(-1.0, 1.0 if parameter.high > 1.0 else 0.0)
    else:
        drawn = chance.uniform(0.0 if parameter.low >= 0.0 else -10.0, 10.0)
    return _rounded(min(max(drawn, parameter.low), parameter.high))


def words_drawn() -> tuple[Word, ...]:
    """The words among which :func:`random_fault` chooses."""
    return tuple(word for word in WORDS if word.name != CLEAR and (word.level, word.name) not in LEFT_OUT)


def names_of(word: Word) -> list[str]:
    """The places at which a word is drawn, of a level that has places of its own: without the nodes that a verdict
    needs."""
    return [name for name in word.names or tuple(PLACES[word.level]) if name not in _OTHER_NODES]


def random_fault(
    chance: random.Random, begin_s: float, ports: Ports, sent: Mapping[str, Sent], words: Sequence[Word]
) -> Fault:
    """One fault that begins at about ``begin_s``; it may meet others on its target.

    :param ports: telegrams on which it may act.
    :param sent: the telegrams that a run without faults sends; a fault begins while its telegram is sent, and lasts
        until one is.
    :param words: words of :func:`words_drawn`.
    """
    level = chance.choice(sorted({word.level for word in words}))
    word = chance.choice([word for word in words if word.level == level])
    name, part, low_s = "", "", _RARE_S.get(level, DURATIONS_S[0])
    names = [port for port in ports if port in sent]
    if level == "telegram":
        name = chance.choice(names)
        part = {"whole": "", "signal": chance.choice(list(ports[name]))}.get(word.part, word.part)
        begin_s = max(min(begin_s, sent[name].last_s - sent[name].apart_s), sent[name].first_s)
        low_s = max(low_s, sent[name].apart_s)
    elif level != "bus":
        name = chance.choice(names_of(word))
    elif word.part == "line":
        part = chance.choice(("a", "b"))
    values = {
        one.name: _value(chance, word, one, names)
        for one in word.parameters
        if one.usual is None or chance.random() < 0.5
    }
    duration_s = count = None
    if word.lasts and name != _LASTING:
        kind = chance.random()
        if kind < 0.6:
            duration_s = round(low_s * (DURATIONS_S[1] / low_s) ** chance.random(), 2)
        elif kind < 0.9 and level == "telegram":
            count = chance.randint(1, 50)
    trigger = Trigger("time", round(begin_s, 2))
    return Fault(Place(level, name, part), word.name, trigger, values, duration_s=duration_s, count=count, combine=True)


def can_act(fault: Fault, others: Sequence[Fault]) -> bool:
    """Whether a fault can change something beside others that begin before it.

    It cannot if it puts a port in the place of itself, or if the same fault is at the same place already.
    """
    if fault.what == "masquerade" and fault.values.get("port") == fault.place.name:
        return False
    same = [one for one in others if (one.place, one.what, one.values) == (fault.place, fault.what, fault.values)]
    return not any(_is_active_at(one, fault.trigger) for one in same)


def _is_active_at(fault: Fault, trigger: Trigger) -> bool:
    """Whether a drawn fault without a count is still active at the instant of a trigger."""
    end_s = None if fault.duration_s is None else float(fault.trigger.value) + fault.duration_s
    return fault.count is None and (end_s is None or end_s > float(trigger.value))


def random_faults(
    chance: random.Random,
    begin_s: float,
    count: int,
    apart_s: Callable[[], float],
    ports: Ports,
    sent: Mapping[str, Sent],
    words: Sequence[Word],
    is_possible: Callable[[str], bool],
    tries: int | None = None,
) -> list[str]:
    """Random faults in the fault language, each begun some time after the one before; they are combined if they meet.

    :param begin_s: of the first; ``apart_s``: draws the time to the next one.
    :param ports, sent, words: as in :func:`random_fault`.
    :param is_possible: whether the run can inject a fault; others are drawn again.
    :param tries: draws in all; None: as many as it takes. With too few there are fewer faults.
    """
    found: list[str] = []
    while len(found) < count and tries != 0:
        tries = None if tries is None else tries - 1
        fault = random_fault(chance, begin_s, ports, sent, words)
        text = fault_text(fault)
        if is_possible(text) and can_act(parse(text), [*map(parse, found)]):
            found.append(text)
            begin_s += apart_s()
    return found


def random_pair(
    seed: int, horizon_s: float, ports: Ports, sent: Mapping[str, Sent], is_possible: Callable[[str], bool]
) -> tuple[str, str]:
    """Two random faults in the fault language, the same for the same seed; they are combined if they meet.

    :param horizon_s: duration of the timetable.
    :param ports, sent: as in :func:`random_fault`.
    :param is_possible: whether the run can inject a fault; others are drawn again.
    """
    chance = random.Random(seed)
    words = words_drawn()
    begin_s = chance.uniform(0.0, BEGIN_SHARE * horizon_s)

    def apart_s() -> float:
        return chance.expovariate(1.0 / APART_S)

    first, second = random_faults(chance, begin_s, 2, apart_s, ports, sent, words, is_possible)
    return first, second


def word_subset(
    chance: random.Random, words: Sequence[Word], ports: Ports, levels_max: int, ports_max: int
) -> tuple[tuple[Word, ...], Ports]:
    """A random subset of words with their places, and of ports: faults drawn from it meet each other more often than
    those drawn from all ("swarm testing", Groce et al., ISSTA 2012).

    :param levels_max: most levels among them, ``ports_max``: most ports.
    """
    known = sorted({word.level for word in words})
    levels = chance.sample(known, chance.randint(1, min(levels_max, len(known))))
    found: list[Word] = []
    for level in sorted(levels):
        some = [word for word in words if word.level == level]
        kept = [word for word in some if chance.random() < 0.5] or [chance.choice(some)]
        for word in kept:
            names = [] if level in ("telegram", "bus") else names_of(word)
            chosen = tuple(name for name in names if chance.random() < 0.5)
            found.append(replace(word, names=chosen) if chosen else word)
    names = sorted(chance.sample(sorted(ports), chance.randint(1, min(ports_max, len(ports))))) if ports else []
    return tuple(found), {name: ports[name] for name in names}
