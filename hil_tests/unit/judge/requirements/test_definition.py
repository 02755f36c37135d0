"""Sentences drawn at random, on records drawn at random, give what their definition gives when it is written out tick
by tick: verdict, margin and number of cases."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from hil_tests.unit.judge.requirements.records import REFUSED, REPEATED, judged, names, record_of
from railhil.judge.record import Record
from railhil.judge.requirements import syntax
from railhil.judge.requirements.parser import parse_sentence
from railhil.judge.requirements.requirement import Requirement
from railhil.systems.ato.judge.events import WATCHES
from railhil.wire.ato import CtlMode

TICK_MS = 10
_TIMES = (20, 25, 30, 50, 64, 100, 1000)


class Drawn:
    """Sentences and records from one stream of draws."""

    def __init__(self, seed: int) -> None:
        self._draws = np.random.default_rng(seed)

    def _one(self, *of: str) -> str:
        return str(self._draws.choice(list(of)))

    def _time(self) -> str:
        return f"{self._draws.choice(_TIMES)} ms"

    def _comparison(self) -> str:
        sign = self._one("<", "<=", ">", ">=", "=", "!=")
        speed = f"measured_speed {sign} {self._draws.integers(0, 6)} m/s"
        notch = f"notch_command {sign} {self._draws.integers(-2, 3)}"
        level = f"controller_level {sign} {self._one('hold', 'traction_cut', 'emergency')}"
        age = f"age(TRN_SPEED) {sign} {self._draws.integers(0, 4) * 10} ms"
        good = f"good(TRN_SPEED) {sign} {self._draws.integers(0, 5)}"
        bad = f"bad(TRN_SPEED) {sign} {self._draws.integers(0, 3)}"
        return self._one(speed, speed, notch, level, level, age, good, bad)

    def condition(self, depth: int = 2) -> str:
        kind = self._draws.random()
        if depth == 0 or kind < 0.4:
            return self._comparison()
        if kind < 0.5:
            return f"not ({self.condition(depth - 1)})"
        if kind < 0.6:
            return f"{self._one('begin', 'end')} of ({self.condition(depth - 1)})"
        return f"({self.condition(depth - 1)} {self._one('and', 'or')} {self.condition(depth - 1)})"

    def sentence(self) -> str:
        body = self._one("always", "never", "never for", "whenever", "whenever", "whenever", "whenever", "eventually")
        scope = ""
        if self._draws.random() < 0.3:
            event = f"begin of ({self.condition(1)})"
            scope = self._one(
                f"from {self._draws.integers(0, 30) * 5} ms to {self._draws.integers(10, 60) * 10} ms, ",
                f"after {event}, ", f"between {event} and end of ({self.condition(1)}), ",
            )  # fmt: skip
        if body == "never for":
            return f"{scope}never {self.condition()} for longer than {self._time()}"
        if body in ("always", "never"):
            return f"{scope}{body} {self.condition()}"
        hold = self._one("", f" for {self._time()}")
        if body == "eventually":
            return f"{scope}eventually {self._one('', f'within {self._time()} ')}{self.condition()}{hold}"
        times = sorted(self._draws.choice(_TIMES, 2, replace=False).tolist())
        first = self._one("", "at once ", f"within {self._time()} ", f"from {times[0]} ms to {times[1]} ms ")
        rest = self._one(hold, f", until {self.condition(1)}", ", until end")
        return f"{scope}whenever {self.condition()}, {first}{self.condition()}{rest}"

    def record(self) -> tuple[Record, Record]:
        """A record, and the same with the telegrams of each tick in the opposite order."""
        ticks = int(self._draws.integers(3, 45))
        values = [0, 1, 2, 3, 4, 5, REFUSED, REPEATED, None]
        drawn = self._draws.choice(values, ticks, p=[0.1, *[0.1] * 5, 0.1, 0.1, 0.2])
        speeds = [None if one is None else one if one < 0 else one * 1000 for one in drawn.tolist()]
        modes = [int(mode) for mode in CtlMode]
        commands = [
            None if self._draws.random() < 0.2
            else (int(self._draws.integers(-2, 3)) * 256, int(self._draws.choice(modes)))
            for _ in range(-(-ticks // 2))
        ]  # fmt: skip
        return record_of(speeds, commands), record_of(speeds, commands, turned=True)


class Defined:
    """The definition, for each tick by itself: lists of margins, None where nothing is known. 0 stands beside the truth
    of a comparison at its limit, so that a margin is a pair (size, sign of the truth)."""

    def __init__(self, record: Record) -> None:
        trace = record.trace
        self.count = trace.end_ns // (TICK_MS * 10**6) + 1
        self._ms = [tick * TICK_MS for tick in range(self.count)]
        self._speeds = list(
            zip(
                [time_ns // 10**6 for time_ns in trace.times_ns("TRN_SPEED")],
                trace.raw("TRN_SPEED", "TrainSpeed").tolist(),
                trace.raw("TRN_SPEED", "SpeedChk").tolist(),
                trace.raw("TRN_SPEED", "SpeedLife").tolist(),
                strict=True,
            )
        )
        self._commands = list(
            zip(
                [time_ns // 10**6 for time_ns in trace.times_ns("NOTCH_CMD")],
                trace.raw("NOTCH_CMD", "NotchCmd").tolist(),
                trace.raw("NOTCH_CMD", "CtlMode").tolist(),
                strict=True,
            )
        )
        #: Of each TRN_SPEED: fresh, with a wrong check variable.
        self._wrong: list[bool] = []
        self._accepted = self._judge()

    def _judge(self) -> list[tuple[int, bool]]:
        """Instants of TRN_SPEED and whether it is accepted: a fresh life sign and a correct check variable."""
        found, last = [], -1
        for at_ms, _, check, life in self._speeds:
            fresh = last < 0 or 1 <= (life - last) % 16 <= 7
            last = life if fresh else last
            found.append((at_ms, fresh and check == 1))
            self._wrong.append(fresh and check != 1)
        return found

    def value(self, node: syntax.Value, tick: int) -> float | None:
        now = self._ms[tick]
        if isinstance(node, syntax.Number):
            return float(node.value)
        if isinstance(node, syntax.Name) and node.name == "measured_speed":
            told = zip(self._speeds, self._accepted, strict=True)
            known = [raw for (at_ms, raw, *_), (_, good) in told if good and at_ms <= now]
            return known[-1] * 1e-4 if known else None
        if isinstance(node, syntax.Name) and node.name == "notch_command":
            known = [raw for at_ms, raw, _ in self._commands if at_ms <= now]
            return known[-1] / 256 if known else None
        if isinstance(node, syntax.Name) and node.name == "controller_level":
            known = [mode for at_ms, _, mode in self._commands if at_ms <= now]
            ladder = list(WATCHES[0].ladder)
            return float(ladder.index(known[-1])) if known and known[-1] in ladder else None
        if isinstance(node, syntax.Name):
            return {"hold": 1.0, "traction_cut": 2.0, "emergency": 4.0}[node.name]
        assert isinstance(node, syntax.Call)
        accepted = [at_ms for at_ms, good in self._accepted if good and at_ms <= now]
        if node.function == "age":
            return float(now - (accepted[-1] if accepted else 0))
        if node.function == "bad":
            return float(
                sum(
                    not good and at_ms > (accepted[-1] if accepted else -1)
                    for at_ms, good in self._accepted
                    if at_ms <= now
                )
            )
        row = 0
        last_ms = 0
        for (at_ms, good), is_wrong in zip(self._accepted, self._wrong, strict=True):
            if at_ms > now:
                break
            if not good:
                row = 0 if is_wrong else row
                continue
            row = 1 if at_ms - last_ms > 2 * TICK_MS else row + 1
            last_ms = at_ms
        return 0.0 if now - last_ms > 2 * TICK_MS else float(row)

    def margins(self, node: syntax.Condition) -> list[tuple[float, int] | None]:
        """Size and truth at each tick; None: not known."""
        if isinstance(node, syntax.Compare):
            return [self._compared(node, tick) for tick in range(self.count)]
        if isinstance(node, syntax.Not):
            return [None if one is None else (-one[0], -one[1]) for one in self.margins(node.of)]
        if isinstance(node, syntax.Edge):
            return self._edges(node)
        assert isinstance(node, syntax.Junction)
        sides = zip(self.margins(node.left), self.margins(node.right), strict=True)
        turned = 1 if node.word == "and" else -1
        return [self._joined(one, other, turned) for one, other in sides]

    def _compared(self, node: syntax.Compare, tick: int) -> tuple[float, int] | None:
        left, right = self.value(node.left, tick), self.value(node.right, tick)
        if left is None or right is None:
            return None
        apart = round(left - right, 6)
        if node.sign in ("=", "!="):
            return (-abs(apart), 1 if apart == 0 else -1) if node.sign == "=" else (abs(apart), -1 if apart == 0 else 1)
        size = apart if ">" in node.sign else -apart
        return size, 1 if size > 0 or (size == 0 and "=" in node.sign) else -1

    def _edges(self, node: syntax.Edge) -> list[tuple[float, int] | None]:
        inner, found = self.margins(node.of), list[tuple[float, int] | None]()
        for tick, one in enumerate(inner):
            before = inner[tick - 1] if tick else None
            held = before is not None and before[1] > 0
            holds = one is not None and one[1] > 0
            comes = holds and not held if node.word == "begin" else held and one is not None and not holds
            found.append((1.0, 1) if comes else (-1.0, -1))
        return found

    def _joined(
        self, one: tuple[float, int] | None, other: tuple[float, int] | None, turned: int
    ) -> tuple[float, int] | None:
        known = [side for side in (one, other) if side is not None]
        if len(known) < 2 and not any(side[1] * turned < 0 for side in known):
            return None
        return (min if turned > 0 else max)(known)


#: Larger and smaller than any margin.
_MOST, _LEAST = (math.inf, 1), (-math.inf, -1)


def windows(node: syntax.Number | None, up: bool) -> int:
    assert node is not None
    ticks = float(node.value) / TICK_MS
    return math.ceil(ticks) if up else math.floor(ticks)


def least_of(
    margins: Sequence[tuple[float, int] | None], first: int, after: int, beyond: tuple[float, int]
) -> tuple[float, int] | None:
    inside = [margins[tick] if tick < len(margins) else beyond for tick in range(first, after)]
    if inside and not any(inside):
        return None
    return min((one for one in inside if one is not None), default=_MOST)


def scope_of(defined: Defined, scope: syntax.Scope | None) -> list[tuple[int, int]]:
    end = defined.count - 1
    if scope is None:
        return [(0, end)]
    if scope.word == "from":
        assert isinstance(scope.first, syntax.Number)
        assert isinstance(scope.last, syntax.Number)
        first, last = windows(scope.first, True), min(windows(scope.last, False), defined.count)
        return [(first, last)] if first <= min(last, end) else []
    begins = [tick for tick, one in enumerate(defined.margins(scope.first)) if one is not None and one[1] > 0]
    if scope.word == "after":
        return [(begins[0], end)] if begins else []
    finishes = [tick for tick, one in enumerate(defined.margins(scope.last)) if one is not None and one[1] > 0]
    found: list[tuple[int, int]] = []
    for tick in begins:
        if not found or tick > found[-1][1]:
            found.append((tick, min((one for one in finishes if one > tick), default=end)))
    return found


def defined_outcome(record: Record, says: str) -> tuple[str, int, float | None]:
    """Verdict, number of cases and margin."""
    sentence, defined = parse_sentence(says), Defined(record)
    body, spans = sentence.body, scope_of(defined, sentence.scope)
    margins, count = defined.margins(body.condition), defined.count
    scoped = [any(first <= tick <= last for first, last in spans) for tick in range(count)]
    # Cases as pairs of bounds: worst and best continuation behind the end of the record.
    cases: list[tuple[tuple[float, int], tuple[float, int]]] = []
    if isinstance(body, syntax.Whenever):
        given = [
            one is not None and one[1] > 0 and scoped[tick] for tick, one in enumerate(defined.margins(body.given))
        ]
        met = sum(one and not (tick and given[tick - 1]) for tick, one in enumerate(given))
        released = [False] * count
        if body.until is not None and not isinstance(body.until, syntax.Limit):
            released = [one is not None and one[1] > 0 for one in defined.margins(body.until)]
        first = 0 if body.first is None else windows(body.first, True)
        last = 0 if body.last is None else windows(body.last, False)
        hold = 1 if body.hold is None else windows(body.hold, True)

        def reaction(tick: int, beyond: tuple[float, int]) -> tuple[float, int] | None:
            if tick >= count:
                return beyond
            if body.until is not None:
                stop = next((one for one in range(tick, count) if released[one]), count)
                return least_of(margins, tick, stop, beyond)
            return margins[tick] if hold == 1 else least_of(margins, tick, tick + hold, beyond)

        for tick in [tick for tick in range(count) if given[tick]]:
            reacts = [
                [reaction(one, beyond) for one in range(tick + first, tick + last + 1)] for beyond in (_LEAST, _MOST)
            ]
            bounds = [max((one for one in row if one is not None), default=_LEAST) for row in reacts]
            cases.append((bounds[0], bounds[1]))
    elif isinstance(body, syntax.Eventually):
        met, hold = len(spans), 1 if body.hold is None else windows(body.hold, True)
        for first, last in spans:
            end = last if body.within is None else first + windows(body.within, False)
            bounds = []
            for beyond in (_LEAST, _MOST):
                row = [
                    beyond
                    if tick >= count
                    else margins[tick]
                    if hold == 1
                    else least_of(margins, tick, tick + hold, beyond)
                    for tick in range(first, end + 1)
                ]
                bounds.append(max((one for one in row if one is not None), default=_LEAST))
            cases.append((bounds[0], bounds[1]))
    else:
        met = sum(
            any(margins[tick] is not None for tick in range(first, min(last + 1, count))) for first, last in spans
        )
        longer = 1 if isinstance(body, syntax.Always) or body.longer is None else windows(body.longer, False) + 1
        inside = [one if one is not None and scoped[tick] else _LEAST for tick, one in enumerate(margins)]
        for tick, one in enumerate(margins):
            if one is None or not scoped[tick]:
                continue
            if isinstance(body, syntax.Always):
                cases.append((one, one))
            else:
                held = [least_of(inside, tick, tick + longer, beyond) or _MOST for beyond in (_MOST, _LEAST)]
                cases.append(((-held[0][0], -held[0][1]), (-held[1][0], -held[1][1])))
    cases = [(worst, best) for worst, best in cases if best != _LEAST]
    if not cases:
        return "says nothing", met, None
    violated = [best for _, best in cases if best[1] < 0]
    kept = [worst for worst, _ in cases if worst[1] > 0]
    # A scope that ends behind the record may have further cases.
    ends = isinstance(body, syntax.Eventually) or not spans or spans[0][1] < count
    verdict = "violated" if violated else "kept" if len(kept) == len(cases) and ends else "open"
    worst = min([*violated, *kept], default=_MOST)
    return verdict, met, worst[0] if math.isfinite(worst[0]) else None


def compare(seed: int, sentences: int) -> dict[str, int]:
    drawn, verdicts = Drawn(seed), dict[str, int]()
    for _ in range(sentences):
        says, (record, turned) = drawn.sentence(), drawn.record()
        bound = Requirement("T-1", says).bind(names())
        found, (verdict, met, margin) = judged(record, says), defined_outcome(record, says)
        assert (found.verdict, found.antecedent_met) == (verdict, met), says
        assert judged(turned, says) == found
        # A margin of several dimensions depends on their scales; the verdict does not.
        if bound.condition.unit is not None:
            assert (None if found.margin is None else round(found.margin, 6)) == margin, says
        verdicts[found.verdict] = verdicts.get(found.verdict, 0) + 1
    return verdicts


@pytest.mark.slow
def test_random_sentences_give_what_their_definition_gives() -> None:
    verdicts = compare(1, 500)
    assert verdicts.keys() == {"kept", "violated", "open", "says nothing"}
    assert min(verdicts.values()) > 20


@pytest.mark.long
def test_five_thousand_random_sentences_give_what_their_definition_gives() -> None:
    compare(2, 5000)
