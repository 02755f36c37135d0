"""Random faults: combinations that nobody thought of, each a plain fault that can be run again."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence

from railhil.faults.language import fault_text
from railhil.faults.model import Fault, Place, Trigger, Value
from railhil.faults.words import CLEAR, COUNT, LENGTH, NAME, PLACES, PPM, SHARE, SPEED, TIME, WORDS, Parameter, Word

#: Words whose effect is a run without verdict, and those of real time.
LEFT_OUT = frozenset({("train", "nan"), ("clock", "pause"), ("node", "kill"), ("bus", "error_frames"), ("bus", "full")})
#: Nodes without which there is no verdict.
_OTHER_NODES = ("plant", "supervisor")
#: Shortest and longest time of a fault, in s.
DURATIONS_S = (0.01, 10.0)
_DIGITS = 3
#: Ports with the names of their signals.
Ports = Mapping[str, Sequence[str]]


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _value(chance: random.Random, parameter: Parameter, ports: Ports) -> Value:
    """A value of the size that a field engineer would try, within the range of the parameter."""
    unit = parameter.unit
    if unit == NAME:
        return chance.choice(list(ports))
    if unit == SHARE:
        drawn = chance.random()
    elif unit == TIME:
        drawn = 10.0 ** chance.uniform(-2.0, 0.5)
    elif unit == COUNT:
        drawn = float(chance.randint(1, 6))
    elif unit in (LENGTH, SPEED):
        drawn = chance.uniform(-50.0, 50.0)
    elif unit == PPM:
        drawn = chance.uniform(-1000.0, 1000.0)
    elif parameter.name in ("factor", "share"):
        drawn = 2.0 ** chance.uniform(-1.0, 1.0)
    else:
        drawn = chance.uniform(-10.0, 10.0)
    return _rounded(min(max(drawn, parameter.low), parameter.high))


def words_drawn() -> tuple[Word, ...]:
    """The words among which :func:`random_fault` chooses."""
    return tuple(word for word in WORDS if word.name != CLEAR and (word.level, word.name) not in LEFT_OUT)


def random_fault(chance: random.Random, horizon_s: float, ports: Ports, words: Sequence[Word]) -> Fault:
    """One fault that begins before ``horizon_s``; it may meet others on its target.

    :param ports: telegrams on which it may act.
    :param words: those of :func:`words_drawn`.
    """
    level = chance.choice(sorted({word.level for word in words}))
    word = chance.choice([word for word in words if word.level == level])
    name, part = "", ""
    if level == "telegram":
        name = chance.choice(list(ports))
        part = {"whole": "", "signal": chance.choice(list(ports[name]))}.get(word.part, word.part)
    elif level != "bus":
        name = chance.choice([one for one in word.names or tuple(PLACES[level]) if one not in _OTHER_NODES])
    elif word.part == "line":
        part = chance.choice(("a", "b"))
    values = {
        one.name: _value(chance, one, ports) for one in word.parameters if one.usual is None or chance.random() < 0.5
    }
    trigger = Trigger("time", round(chance.uniform(0.0, horizon_s), 2))
    low_s, high_s = DURATIONS_S
    duration_s = count = None
    if word.lasts:
        kind = chance.random()
        if kind < 0.6:
            duration_s = round(low_s * (high_s / low_s) ** chance.random(), 2)
        elif kind < 0.9 and level == "telegram":
            count = chance.randint(1, 50)
    return Fault(Place(level, name, part), word.name, trigger, values, duration_s=duration_s, count=count, combine=True)


def random_pair(seed: int, horizon_s: float, ports: Ports, is_possible: Callable[[str], bool]) -> tuple[str, str]:
    """Two random faults in the fault language, the same for the same seed; they are combined if they meet.

    :param is_possible: whether the run can inject a fault; others are drawn again.
    """
    chance = random.Random(seed)
    words = words_drawn()
    found: list[str] = []
    while len(found) < 2:
        text = fault_text(random_fault(chance, horizon_s, ports, words))
        if is_possible(text):
            found.append(text)
    return found[0], found[1]
