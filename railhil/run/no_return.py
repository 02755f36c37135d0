"""The point of no return of a run with faults: the last instant at which ending all of them still saves it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL
from railhil.faults.language import fault_text, parse
from railhil.faults.model import Trigger
from railhil.faults.notation import place_text
from railhil.faults.words import CLEAR
from railhil.judge.record import Record
from railhil.judge.result import Result
from railhil.run.branch import Trunk, branched_run
from railhil.scenarios.given import NO_CODE, NamedCode
from railhil.scenarios.run_spec import RunSpec

#: Decimals of an instant in a fault: 1 ns.
_DIGITS = 9


@dataclass(frozen=True, slots=True)
class NoReturn:
    """What was found.

    ``saved_s``: last instant that saves the run; None: not even the run without its faults is saved. ``lost_s``: the
    next tick, of which a branch, or the run itself, shows that it does not. ``branches``: number of branches that were
    made. Between the first fault and ``saved_s`` not every instant was tried.
    """

    saved_s: float | None
    lost_s: float
    branches: int

    @property
    def sentence(self) -> str:
        """The same in words."""
        many = count_of(self.branches, "branch", "branches")
        if self.saved_s is None:
            return f"ending the faults does not save the run: without them it fails, too ({many})"
        return f"ending all faults at {self.saved_s:g} s still saves the run, at {self.lost_s:g} s no longer ({many})"


def is_saved(result: Result) -> bool:
    """Whether a run misses nothing that it is judged by; faults that had no effect any more do not count."""
    return result.exit_code != FAIL and result.score.verdict == "PASS"


@dataclass(frozen=True, slots=True)
class _Acting:
    """A fault of the run: its text, its begin and its end in s (None: it did not)."""

    text: str
    begun_s: float | None
    ended_s: float | None


def has_acting_faults(record: Record) -> bool:
    """Whether a fault of a recorded run began."""
    return bool(_acting(record))


def no_return_sentence(record: Record) -> str:
    """The point of no return of a recorded run in words; empty for a run that its faults have not lost."""
    if record.verdict != "FAIL" or not _acting(record):
        return ""
    try:
        return find_no_return(record).sentence
    except InputError as error:
        return f"the point of no return is not known: {error}"


def find_no_return(record: Record, saves: Callable[[Result], bool] = is_saved, code: NamedCode = NO_CODE) -> NoReturn:
    """The last instant at which ending all faults still saves a run, by bisection over branches.

    :param saves: whether the result of a branch is one of a run that is saved.
    :param code: with which the run was made; its branches are then runs from the start.
    :raises InputError: the run has no fault that began, or cannot be repeated with the same bytes.
    """
    acting = _acting(record)
    if not acting:
        found = Words("no fault that began")
        raise InputError(record.log.parent, "injected", found, "a run that its faults have lost")
    tick_ns = record.scenario.timing.base_tick_ns
    spec = _with_all_faults(branched_run(record.log.parent, code), record)
    first = min(round(one.begun_s * 1e9) for one in acting if one.begun_s is not None) // tick_ns
    ends = [record.trace.end_s if one.ended_s is None else one.ended_s for one in acting]
    lost = max(-(-round(max(ends) * 1e9) // tick_ns), first + 1)
    made = 0
    with Trunk(spec) as trunk:
        if first:
            trunk.advance(first * tick_ns / 1e9)

        def is_saved_at(tick: int) -> bool:
            return saves(trunk.branch(ended_at(acting, tick * tick_ns / 1e9), keep=False))

        saved = first
        made += 1
        if not is_saved_at(saved):
            return NoReturn(None, saved * tick_ns / 1e9, made)
        while lost - saved > 1:
            middle = (saved + lost) // 2
            made += 1
            if is_saved_at(middle):
                saved = middle
            else:
                lost = middle
    return NoReturn(saved * tick_ns / 1e9, lost * tick_ns / 1e9, made)


def _acting(record: Record) -> list[_Acting]:
    """All faults of a run, in their order; empty if none began."""
    rows = record.certificate.get("injected") or []
    found = [_Acting(row["fault"], row["begun_s"], row["ended_s"]) for row in rows]
    return found if any(one.begun_s is not None for one in found) else []


def _with_all_faults(spec: RunSpec, record: Record) -> RunSpec:
    """The run with the faults of its scenario named like the others, so that branches can change all of them."""
    own = len(record.scenario.faults) - len(spec.faults)
    if not own:
        return spec
    return replace(spec, settings=(*spec.settings, "fault=[]"), faults=tuple(record.scenario.faults))


def ended_at(acting: list[_Acting], time_s: float) -> tuple[str, ...]:
    """The faults of a run that all end at an instant, with their numbers; those that have not begun never begin.

    Expectations are left out.
    """
    found, places = [], []
    for one in acting:
        fault = replace(parse(one.text), expect=None)
        if one.begun_s is None or one.begun_s >= time_s:
            fault = replace(fault, trigger=Trigger("manual"))
        elif one.ended_s is None or one.ended_s > time_s:
            places.append(fault.place)
        found.append(fault_text(fault))
    return (
        *found,
        *(f"{place_text(place)} {CLEAR} @{round(time_s, _DIGITS):.12g}s" for place in dict.fromkeys(places)),
    )
