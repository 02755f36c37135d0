"""Learning from run to run: one offset for each load class and state of the rail, corrected by the measured stop.

The update is P-type terminal iterative learning on the offset b, by which the brake begins earlier::

    b[j+1] = clip(b[j] + clip(gamma e[j], +-8 m), +-12 m)           e = s_stop - S, overshoot positive

There is no update if the wheels slid, the train braked by itself, the report belongs to another run, this run or a
later one has been learned already, the reported error is impossible for a stop, or it is far from the expectation from
the last runs (innovation test).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple

from railhil.common.command_line import RUN_NUMBER_MAX
from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.numbers import DISTANCE_Q, GAIN_Q, Numbers

#: Load classes: below a third of the full load, below two thirds, the rest.
CLASSES = 3
_EDGES_PERCENT = (100.0 / 3.0, 200.0 / 3.0)
STEP_MAX_M = 8.0
OFFSET_MAX_M = 12.0
#: Bounds of the variance of the stop, m2; the larger one is for a stop never seen.
VARIANCE_MIN_M2, VARIANCE_MAX_M2 = 1e-4, 25.0
#: No stop is this far off; a report beyond is a defect of the report.
ERROR_MAX_M = 200.0
#: An error beyond this share of the braking distance is not the brake's (with the innovation test).
SHARE_MAX = 0.09
_RUNS_MAX = 4000.0
#: The rule without a fixed gain: 1/j, at least this.
GAMMA_LEAST = 0.3
LAST_ERRORS = 8
#: Format of variances.
VARIANCE_Q = 24
#: Format of the gain, which may be above 2.
_GAMMA_Q = 28
VERSION = 1


class Record(NamedTuple, Generic[T]):
    """Record of a load class and rail: offset b (m), variance of the stop (m2), runs learned, the last one."""

    offset: T
    variance: T
    runs: T
    last_run: T


class Report(NamedTuple, Generic[T]):
    """Measurement of a stop: number of its run (Q0, 0: none) and error, m (Q ``DISTANCE_Q``)."""

    run: T
    error: T


class Learned(NamedTuple, Generic[T]):
    """``slot``: class + 3 wet. ``before``: its record in this run; ``after``: once it has been learned.

    ``learned``, ``spoiled``: 0 or 1; ``error``: that was learned, m; ``gamma``: with which.
    """

    slot: T
    before: Record[T]
    after: Record[T]
    learned: T
    spoiled: T
    error: T
    gamma: T


def stored_records(values: Mapping[str, Any] | None) -> dict[tuple[int, int], Mapping[str, Any]]:
    """Records of a memory by load class and wet.

    :raises ValueError: an entry that no run of a law can leave.
    """
    if values is None:
        return {}
    if values["version"] != VERSION:
        raise ValueError(f"version {values['version']!r}, allowed {VERSION}")
    found = {}
    for record in values["records"]:
        key = record["load_class"], record["wet"]
        if key in found or key[0] not in range(CLASSES) or key[1] not in (0, 1):
            raise ValueError(f"load class {key[0]!r}, wet {key[1]!r}: allowed 0 to {CLASSES - 1} and 0 or 1, each once")
        bounds = {
            "offset_m": (-OFFSET_MAX_M, OFFSET_MAX_M),
            "variance_m2": (VARIANCE_MIN_M2, VARIANCE_MAX_M2),
            "runs": (0, math.inf),
            "last_run": (0, RUN_NUMBER_MAX),
        }
        for name, (low, high) in bounds.items():
            value = record[name]
            if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
                raise ValueError(f"{name} {value!r}, allowed {low:g} to {high:g}")
        found[key] = record
    return found


class OffsetMemory(Generic[T]):
    """The records of a law from run to run, as constants.

    :param values: the memory, None before the first run.
    :param first_offset_m: offset before the first run (a cold start should undershoot).
    """

    def __init__(self, numbers: Numbers[T], values: Mapping[str, Any] | None, first_offset_m: float = 0.0) -> None:
        self._numbers = numbers
        self._stored = stored_records(values)
        hold = numbers.hold
        memory = "memory"
        self._records: dict[tuple[int, int], Record[T]] = {}
        first = {"offset_m": first_offset_m, "variance_m2": VARIANCE_MAX_M2, "runs": 0, "last_run": 0}
        for load_class in range(CLASSES):
            for wet in (0, 1):
                stored, name = self._stored.get((load_class, wet), first), f"memory_{load_class}_{wet}"
                self._records[load_class, wet] = Record(
                    hold(f"{name}_offset", stored["offset_m"], DISTANCE_Q, memory),
                    hold(f"{name}_variance", stored["variance_m2"], VARIANCE_Q, memory),
                    hold(f"{name}_runs", min(stored["runs"], _RUNS_MAX), 0, memory),
                    hold(f"{name}_last_run", stored["last_run"], 0, memory),
                )
        newest = max((record["last_run"] for record in self._stored.values()), default=0)
        #: Number of the newest run of any record: a train makes its runs one after another, so earlier runs are over.
        self.newest = hold("memory_last_run", newest, 0, memory)
        self._edges = [hold(f"load_class_{n}", edge, 0, "law") for n, edge in enumerate(_EDGES_PERCENT, 1)]
        self._slots = [[hold(f"slot_{n}_{wet}", n + CLASSES * wet, 0, "law") for wet in (0, 1)] for n in range(CLASSES)]

    def record_of(self, load: T, wet: T) -> tuple[T, Record[T]]:
        """Slot and record for a load (percent) and rail (0 or 1), both Q0."""
        ar, zero = self._numbers.ar, self._numbers.zero

        def chosen(of: Any) -> T:
            light, middle, heavy = (ar.where(ar.gt(wet, zero), of(n, 1), of(n, 0)) for n in range(CLASSES))
            first, second = self._edges
            return ar.where(ar.gt(load, first), ar.where(ar.gt(load, second), heavy, middle), light)

        record = Record(*(chosen(lambda n, w, i=i: self._records[n, w][i]) for i in range(len(Record._fields))))
        return chosen(lambda n, w: self._slots[n][w]), record

    def after(self, learned: Learned[Any]) -> dict[str, Any]:
        """The memory after the run, from the state after its last step."""
        ar = self._numbers.ar

        def number(value: Any, q: int) -> float:
            raw: Any = ar.raw(value, q)
            return math.ldexp(raw, -q)

        slot = int(number(learned.slot, 0))
        key = slot % CLASSES, slot // CLASSES
        records = dict(self._stored)
        before, after = learned.before, learned.after
        runs, last_run = int(number(after.runs, 0)), int(number(after.last_run, 0))
        variance_m2 = number(after.variance, VARIANCE_Q)
        if (runs, last_run, variance_m2) != (
            int(number(before.runs, 0)),
            int(number(before.last_run, 0)),
            number(before.variance, VARIANCE_Q),
        ):
            old = self._stored.get(key, {})
            errors = list(old.get("last_errors_m", []))
            if last_run != int(number(before.last_run, 0)):
                errors = [*errors, number(learned.error, DISTANCE_Q)][-LAST_ERRORS:]
            records[key] = {
                "load_class": key[0],
                "wet": key[1],
                "offset_m": number(after.offset, DISTANCE_Q),
                "variance_m2": min(max(variance_m2, VARIANCE_MIN_M2), VARIANCE_MAX_M2),
                "runs": runs,
                "last_run": last_run,
                "last_errors_m": errors,
                "gamma": number(learned.gamma, _GAMMA_Q),
            }
        return {"version": VERSION, "records": [records[one] for one in sorted(records)]}


@dataclass(frozen=True, slots=True)
class LearningRule:
    """How an offset is corrected.

    :param gamma: fixed gain, 0: max(1/j, 0.3).
    :param sigmas: width of the innovation test, 0: none.
    :param report_sigma_m: non-repeating scatter of a stop and its measurement: the gain is multiplied with the share of
        the variance of the last errors beyond it, so that nothing is learned from noise. 0: the gain is not reduced.
    :param active: False: the record is used, and never changed.
    """

    gamma: float
    sigmas: float = 0.0
    report_sigma_m: float = 0.0
    active: bool = True


class Learning(Generic[T]):
    """Corrects the offsets of a law by its rule."""

    def __init__(self, numbers: Numbers[T], offsets: OffsetMemory[T], rule: LearningRule) -> None:
        self._numbers = numbers
        self._offsets = offsets
        self._rule = rule
        hold = numbers.hold
        self._gamma = hold("gamma", rule.gamma, _GAMMA_Q, "parameters")
        self._least = hold("gamma_least", GAMMA_LEAST, _GAMMA_Q, "law")
        self._step = [hold(f"step_{sign}", sign * STEP_MAX_M, DISTANCE_Q, "law") for sign in (1, -1)]
        self._most = [hold(f"offset_{sign}", sign * OFFSET_MAX_M, DISTANCE_Q, "law") for sign in (1, -1)]
        self._noise = hold("report_variance", rule.report_sigma_m**2, VARIANCE_Q, "parameters")
        self._no_variance = hold("variance_0", 0.0, VARIANCE_Q, "law")
        self._spread = [
            hold("variance_max", VARIANCE_MAX_M2, VARIANCE_Q, "law"),
            hold("variance_min", VARIANCE_MIN_M2, VARIANCE_Q, "law"),
        ]
        self._five = [hold(f"five_{sign}", 5.0 * sign, DISTANCE_Q, "root of the largest variance") for sign in (1, -1)]
        self._possible = hold("error_max", ERROR_MAX_M, DISTANCE_Q, "law")
        self._squared = hold("sigmas", rule.sigmas, GAIN_Q - 8, "parameters")
        self._share = hold("share_max", SHARE_MAX, GAIN_Q, "law")
        self._runs_max = hold("runs_max", _RUNS_MAX, 0, "law")

    def start(self, load: T, wet: T) -> Learned[T]:
        """The record for a load (percent) and rail (0 or 1), both Q0."""
        zero = self._numbers.zero
        slot, record = self._offsets.record_of(load, wet)
        nothing = self._numbers.hold("nothing", 0.0, DISTANCE_Q, "law")
        return Learned(slot, record, record, zero, zero, nothing, self._gamma)

    def step(self, learned: Learned[T], ready: T, spoiled: T, run: T, report: Report[T], braking: T) -> Learned[T]:
        """Learn if there is a usable report.

        :param ready: 1 when the train stands. :param spoiled: 1 in a cycle in which the run became unusable for
            learning. :param run: number of this run, 0 if it is not known. :param braking: braking distance of the run,
            m.
        """
        ar, zero, one = self._numbers.ar, self._numbers.zero, self._numbers.one
        error = report.error
        spoiled = ar.maximum(learned.spoiled, spoiled)
        old = learned.before
        size = ar.abs(error)
        possible = ar.where(ar.gt(self._possible, size), ready, zero)
        # Only the run that the train has just made is learned; without a number of the run this cannot be decided.
        own = ar.where(ar.gt(ar.abs(ar.sub(report.run, run)), zero), zero, possible)
        wanted = ar.where(ar.gt(run, self._offsets.newest), own, zero)
        wanted = ar.where(ar.gt(learned.learned, zero), zero, wanted)
        if not self._rule.active:
            return learned._replace(spoiled=spoiled, learned=ar.maximum(learned.learned, wanted))
        usable = ar.where(ar.gt(spoiled, zero), zero, wanted)
        runs = ar.minimum(ar.add(old.runs, one), self._runs_max)
        share = ar.maximum(ar.div(one, runs, _GAMMA_Q), self._least)
        gamma = share if not self._rule.gamma else self._gamma
        limited = ar.clip(error, *self._five)
        surprise = ar.sub(ar.mpy_iqx(limited, DISTANCE_Q, limited, DISTANCE_Q, VARIANCE_Q), old.variance)
        variance = ar.clip(ar.add(old.variance, ar.mpy(surprise, share, _GAMMA_Q)), *self._spread)
        if self._rule.report_sigma_m > 0.0:
            beyond = ar.maximum(ar.sub(variance, self._noise), self._no_variance)
            gamma = ar.mpy(gamma, ar.div(beyond, variance, GAIN_Q), GAIN_Q)
        learns = usable
        if self._rule.sigmas:
            spread = ar.convert(ar.sqrt(old.variance, VARIANCE_Q), VARIANCE_Q, DISTANCE_Q)
            width = ar.mpy(spread, self._squared, GAIN_Q - 8)
            limit = ar.minimum(width, ar.mpy(braking, self._share, GAIN_Q))
            learns = ar.where(ar.gt(size, limit), zero, usable)
        move = ar.clip(ar.mpy(ar.clip(error, self._possible, ar.neg(self._possible)), gamma, _GAMMA_Q), *self._step)
        offset = ar.clip(ar.add(old.offset, move), *self._most)
        use, tell = ar.gt(learns, zero), ar.gt(usable, zero)
        after = Record(
            ar.where(use, offset, learned.after.offset),
            # Also a run that failed the innovation test makes the next one less certain, so that a real change of the
            # train is learned in the end.
            ar.where(tell, variance, learned.after.variance),
            ar.where(use, runs, learned.after.runs),
            ar.where(use, run, learned.after.last_run),
        )
        return Learned(
            learned.slot,
            old,
            after,
            ar.maximum(learned.learned, wanted),
            spoiled,
            ar.where(use, error, learned.error),
            ar.where(use, gamma, learned.gamma),
        )
