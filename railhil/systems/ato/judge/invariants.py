"""Rules that hold in every run of a train, faulty or not, checked on the record.

2. No traction at level TRACTION CUT or above, neither commanded by the controller nor applied by the train.
3. Beyond the overspeed margin the emergency brake is applied.
4. A watch lowers its level only after the stated number of good telegrams, or at a standstill; EMERGENCY is never left.

A gap of the record breaks no rule: if a rule depends on a telegram that the record may lack, the run is INVALID
(:mod:`railhil.judge.record_checks`). The run is also INVALID if rule 4 depends on the order of telegrams of two nodes
in real time: after a pause frames come in one burst, and a node takes them later than the recorder.

The numbers follow the specification of the bench. Rule 1 (no telegram that failed a check reaches the law) and 6 (sent
= accepted + refused + lost) need the counters of the nodes: :mod:`railhil.judge.counters`. The checks here use neither
watch: they read levels, speeds and forces from the record, and count its good telegrams again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.ident import PACES, PltIdent
from railhil.common.digits import count_of
from railhil.faults import parse_faults
from railhil.judge.counters import unreconciled
from railhil.judge.declared import Received
from railhil.judge.reception import BoolArray, shown, taken
from railhil.judge.record_checks import UNCLEAR, Unseen
from railhil.record.trace import FloatArray, Trace
from railhil.systems.ato.judge.events import received
from railhil.systems.ato.judge.measures import limits_under_train
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlMode, NotchCmd, SimTruth, TrnPos, TrnSpeed, TrnWatch

if TYPE_CHECKING:
    from railhil.faults.model import Fault

LEVELS = ("NORMAL", "HOLD", "TRACTION CUT", "SERVICE BRAKE", "EMERGENCY")
_TRACTION_CUT, _SERVICE_BRAKE, _EMERGENCY = 2, 3, 4
#: Good telegrams after which a level may be left.
GOOD_NEEDED = {1: 1, _TRACTION_CUT: 5, _SERVICE_BRAKE: 10}
#: Time that the watches may take to notice an overspeed, and the record to show it: the period of TRN_WATCH.
NOTICE_S = 0.16
#: Resolution of SIM_TRUTH's force; anything above half of it is traction.
_FORCE_MIN_N = 10.0
_SPEED_SLACK_MPS = 1e-3
#: Parts of a telegram that carry nothing of its content.
_OF_THE_FRAME = ("counter", "checksum")

IntArray: TypeAlias = npt.NDArray[np.int64]


class _LateUnseen(Unseen):
    """Telegrams that may be missing from a record, and the delay with which a node may have taken the recorded ones."""

    def __init__(self, scenario: Scenario, trace: Trace) -> None:
        super().__init__(scenario, trace)
        watch, ident = scenario.watch, trace.ident(PltIdent)
        self._ages_ms = (0, watch.hold_ms, watch.traction_cut_ms, watch.service_brake_ms)
        self._is_realtime = ident is not None and ident.pace == PACES.index("realtime")

    def lag_s(self, level: int) -> float:
        """Largest delay with which a node takes a telegram after the recorder, for a level entered before it. In
        lockstep there is none. In real time the node's watch limits it: a stronger level would report that it has taken
        none for longer."""
        return self._ages_ms[level] / 1e3 if self._is_realtime else 0.0


def broken(scenario: Scenario, trace: Trace, limits_mps: FloatArray | None = None) -> list[str]:
    """One sentence for the first breach of each rule, with those of :mod:`railhil.judge.counters`; empty for a run
    that keeps them. A sentence that begins with :data:`railhil.judge.record_checks.UNCLEAR` names the gap of the
    record.

    A record of an earlier version, without the level of the train's watch, is checked only for the controller's level.
    Content that a fault has put into NOTCH_CMD is not the controller's and is not checked. With any fault of NOTCH_CMD,
    the order of the controller's levels is not checked either. A traction drive with a fault does not obey the train's
    watch: its traction is checked from EMERGENCY on, where the main breaker opens. With a fault of the adhesion the
    notch in effect is checked in place of the force at the rail, because spinning wheels then make this force.

    :param limits_mps: speed limit at each SIM_TRUTH, shape (n,); None: by the scenario's line.
    """
    if limits_mps is None:
        position_m = trace.values(SimTruth.PORT, "TruePos")
        limits_mps = limits_under_train(scenario.line.speed_limit_mps, position_m, scenario.train.length_m)
    has_watch = "TRN_WATCH" in {port.name for port in trace.contract.ports}
    found = unreconciled(scenario, trace)
    items = {item.port: item for item in received(scenario)}
    unseen = _LateUnseen(scenario, trace)
    if not _is_forged(scenario):
        found += _commanded_traction(trace)
    if not _is_out_of_step(scenario):
        heard = taken(scenario, trace, items[TrnSpeed.PORT])
        found += _left_early_by_controller(trace, heard, unseen)
    if has_watch and trace.count(TrnWatch.PORT):
        found += [*_applied_traction(scenario, trace, items), *_overspeed(scenario, trace, limits_mps)]
        found += _left_early_by_train(trace, taken(scenario, trace, items[NotchCmd.PORT]), unseen)
    elif has_watch and trace.count(PltIdent.PORT):
        # A run without a bus has none of these telegrams.
        found.append(f"{UNCLEAR}no TRN_WATCH, so the level of the train's watch is not known")
    return found


def _is_forged(scenario: Scenario, port: str = NotchCmd.PORT) -> bool:
    """Whether a fault of the run changes the content of a port's telegrams.

    Telegrams that are lost, late, repeated or refused keep their content: level and notch belong together.
    """
    return any(_forges(fault, port) for fault in parse_faults(scenario.faults))


def _forges(fault: Fault, port: str) -> bool:
    place = fault.place
    if place.level == "command":
        return port == NotchCmd.PORT
    # Some of many flipped bits pass the check sequence.
    return place.name == port and (place.part not in ("", *_OF_THE_FRAME) or fault.what == "corrupt")


def _is_out_of_step(scenario: Scenario) -> bool:
    """Whether levels in the record may differ from the controller's at their instants."""
    faults = parse_faults(scenario.faults)
    return any(
        fault.place.level == "command"
        or fault.place.name == NotchCmd.PORT
        or (fault.place.level, fault.place.name, fault.what) == ("node", "controller", "slow")
        for fault in faults
    )


def _cut_from(scenario: Scenario) -> int:
    """The level at which no traction can be applied in this run."""
    return _EMERGENCY if _has_fault(scenario, "actuator", "traction") else _TRACTION_CUT


def _has_fault(scenario: Scenario, level: str, name: str) -> bool:
    return any((fault.place.level, fault.place.name) == (level, name) for fault in parse_faults(scenario.faults))


def _place(level: IntArray) -> IntArray:
    """Places in :data:`LEVELS`; -1 for values that are no level."""
    return np.where((level >= 0) & (level < len(LEVELS)), level, -1)


def _told_levels(trace: Trace) -> IntArray:
    """Level of the train's watch in each TRN_WATCH; -1 (unknown) where the next one is missing from the record."""
    life = trace.raw(TrnWatch.PORT, "WatchLife")
    before_gap = np.append((np.diff(life) & 0xF) != 1, False)
    return np.where(before_gap, -1, _place(trace.raw(TrnWatch.PORT, "WatchLevel")))


def _level_at(trace: Trace, time_s: FloatArray) -> IntArray:
    """Level of the train's watch at each instant: the level in the newest TRN_WATCH; -1 where it is unknown."""
    level = _told_levels(trace)
    index = np.searchsorted(trace.times_s(TrnWatch.PORT), time_s, side="right") - 1
    return np.where(index >= 0, level[np.maximum(index, 0)], -1)


def _controller_levels(trace: Trace) -> IntArray:
    """Level in each NOTCH_CMD; -1 for a mode without one.

    A controller that initialises after a restart has no level to keep, one that has ended has none either.
    """
    return _place(trace.raw(NotchCmd.PORT, "CtlMode") - int(CtlMode.RUNNING))


def _commanded_traction(trace: Trace) -> Iterator[str]:
    level, notch = _controller_levels(trace), trace.values(NotchCmd.PORT, "NotchCmd")
    wrong = np.flatnonzero((level >= _TRACTION_CUT) & (notch > 0))
    if len(wrong):
        first = wrong[0]
        yield (
            f"invariant 2: the controller commands notch {notch[first]:.2f} at {LEVELS[level[first]]}, "
            f"at {trace.times_s(NotchCmd.PORT)[first]:.2f} s"
        )


def _applied_traction(scenario: Scenario, trace: Trace, items: Mapping[str, Received]) -> Iterator[str]:
    if _has_fault(scenario, "train", "adhesion"):
        # Spinning wheels push the train until they have slowed down, even without drive.
        if _is_forged(scenario, TrnPos.PORT):
            return
        # A telegram that is sent again tells a notch that was in effect before.
        good = shown(scenario, trace, items[TrnPos.PORT])
        time_s, applied = trace.times_s(TrnPos.PORT)[good], trace.values(TrnPos.PORT, "NotchActual")[good]
        least, what = 0.0, "has notch {:.2f} in effect"
    else:
        time_s, applied = trace.times_s(SimTruth.PORT), trace.values(SimTruth.PORT, "TractionForce") / 1e3
        least, what = _FORCE_MIN_N / 1e3, "applies {:.1f} kN of traction"
    # The level before is checked as well: when the port that opens the ticks is lost, a later tick can have the same
    # instant.
    level = np.minimum(_level_at(trace, time_s), _level_at(trace, np.nextafter(time_s, -np.inf)))
    wrong = np.flatnonzero((level >= _cut_from(scenario)) & (applied > least))
    if len(wrong):
        first = wrong[0]
        yield (
            f"invariant 2: the train {what.format(applied[first])} at {LEVELS[level[first]]}, at {time_s[first]:.2f} s"
        )


def _overspeed(scenario: Scenario, trace: Trace, limits_mps: FloatArray) -> Iterator[str]:
    time_s, speed_mps = trace.times_s(SimTruth.PORT), trace.values(SimTruth.PORT, "TrueSpeed")
    most_mps = np.minimum(limits_mps, scenario.train.speed_limit_mps) + scenario.watch.overspeed_margin_mps
    beyond = speed_mps > most_mps + _SPEED_SLACK_MPS
    if not beyond.any():
        return
    # Only a lasting excess counts: the level appears in the record some ticks after the speed.
    later = _level_at(trace, time_s + NOTICE_S)
    ends = np.minimum(np.searchsorted(time_s, time_s + NOTICE_S), len(time_s) - 1)
    noticed = time_s + NOTICE_S <= time_s[-1]
    wrong = np.flatnonzero(beyond & beyond[ends] & noticed & (later >= 0) & (later < _EMERGENCY))
    if len(wrong):
        first = wrong[0]
        yield (
            f"invariant 3: {speed_mps[first] * 3.6:.1f} km/h at {time_s[first]:.2f} s, beyond the margin, "
            f"and the train's watch is at {LEVELS[later[first]]}"
        )


def _good_before(trace: Trace, told: str, good: BoolArray, port: str) -> IntArray:
    """Number of ``good`` telegrams of port ``told`` before each telegram of ``port``."""
    return np.searchsorted(trace.order(told)[good], trace.order(port))


def _left_early(
    who: str, time_s: FloatArray, level: IntArray, first: IntArray, past: IntArray, standing: Standing, port: str,
    unseen: _LateUnseen,
) -> Iterator[str]:  # fmt: skip
    """The first breach of rule 4, or the gap of the record that hides it.

    :param level: at each instant; -1: not known. The good telegrams of ``port`` are numbered in their order: ``first``
        is the first one that can count for a level entered at an instant, ``past`` the first that is too late for a
        level left.
    :param standing: whether the train stands at each instant; a train that has stood at this level may leave any level,
        also if it has stood between two instants only.
    """
    for index in (np.flatnonzero(np.diff(level) < 0) + 1).tolist():
        left, entered = int(level[index - 1]), index - 1
        if level[index] < 0 or left == 0:
            continue
        if left == _EMERGENCY:
            yield f"invariant 4: {who} left EMERGENCY at {time_s[index]:.2f} s"
            return
        while entered > 0 and level[entered - 1] == left:
            entered -= 1
        if entered > 0 and level[entered - 1] < 0:
            # The level may have been entered earlier.
            continue
        count = int(past[index] - first[entered])
        rows = slice(entered, index + 1)
        # At a standstill SERVICE BRAKE is left at once, and a level may be left through it between two reports.
        if count >= GOOD_NEEDED[left] or standing.stood(int(entered), int(index)):
            continue
        said = f"{who} left {LEVELS[left]} at {time_s[index]:.2f} s"
        missing = unseen.count(port, time_s[entered - 1 if entered else 0], time_s[index])
        begun = max(0, int(np.searchsorted(time_s, time_s[entered] - unseen.lag_s(left), side="right")) - 1)
        if not standing.known[rows].all():
            yield f"{UNCLEAR}{said}, and no {standing.port} shows whether the train stood"
        elif count + missing >= GOOD_NEEDED[left]:
            yield f"{UNCLEAR}{said} after {count_of(count, f'good {port} telegram')}, {missing} not in the record"
        elif past[index] - first[begun] + missing >= GOOD_NEEDED[left] or standing.stood(begun, int(index)):
            yield (
                f"{UNCLEAR}{said} after {count_of(count, f'good {port} telegram')}, needed {GOOD_NEEDED[left]}: "
                "in real time it may have taken those before later than the recorder"
            )
        else:
            yield f"invariant 4: {said} after {count_of(count, 'good telegram')}, needed {GOOD_NEEDED[left]}"
        return


class Standing(NamedTuple):
    """Whether the train stands at each of some instants, shape (n,), as ``port`` shows it; ``known``: where it does.

    ``past``: how many telegrams that show a standstill came before each instant, ``first``: before the first telegram
    that can count for a level entered at an instant.
    """

    port: str
    stands: BoolArray
    known: BoolArray
    first: IntArray
    past: IntArray

    def stood(self, entered: int, left: int) -> bool:
        """Whether the train has stood at one of these instants or between two of them."""
        return bool(self.stands[entered : left + 1].any() or self.past[left] > self.first[entered])


def _standing(
    trace: Trace, port: str, signal: str, times: str, unseen: Unseen, good: BoolArray | slice = slice(None)
) -> Standing:
    """The content of the newest telegram before each telegram of ``times``, if none is missing after it, and the number
    of telegrams that show a standstill before it.

    :param good: the telegrams that count.
    """
    time_s = trace.times_s(times)
    told_s, raw, order = trace.times_s(port)[good], trace.raw(port, signal)[good], trace.order(port)[good]
    past = np.searchsorted(order[raw == 0], trace.order(times))
    if not len(raw):
        nowhere = np.zeros(len(time_s), dtype=bool)
        return Standing(port, nowhere, nowhere, past, past)
    index = np.searchsorted(told_s, time_s, side="right") - 1
    newest = np.maximum(index, 0)
    known = (index >= 0) & (time_s - told_s[newest] < 2 * unseen.period_s(port))
    return Standing(port, (index >= 0) & (raw[newest] == 0), known, past, past)


def _left_early_by_controller(trace: Trace, good: BoolArray, unseen: _LateUnseen) -> Iterator[str]:
    """The level stands in each answer, so it was entered after the answer before; telegrams come before the poll.

    :param good: the TRN_SPEED that the controller has taken.

    An accepted TRN_SPEED tells whether the train stands, also one between two polls; for a controller that hears none,
    the train does not stand.
    """
    time_s = trace.times_s(NotchCmd.PORT)
    past = _good_before(trace, TrnSpeed.PORT, good, NotchCmd.PORT)
    first = np.concatenate([[0], past[:-1]])
    standing = _standing(trace, TrnSpeed.PORT, "TrainSpeed", NotchCmd.PORT, unseen, good)
    heard = standing._replace(known=np.ones_like(standing.known), first=np.concatenate([[0], standing.past[:-1]]))
    levels = _controller_levels(trace)
    yield from _left_early("the controller", time_s, levels, first, past, heard, TrnSpeed.PORT, unseen)


def _left_early_by_train(trace: Trace, good: BoolArray, unseen: _LateUnseen) -> Iterator[str]:
    """The level is reported one tick after it was entered, and commands follow it within the tick.

    :param good: the NOTCH_CMD that the train has taken.
    """
    told_s = trace.times_s(TrnWatch.PORT)
    # The order of the record counts: without the port that opens a tick, its report has the instant of the last poll.
    past = _good_before(trace, NotchCmd.PORT, good, TrnWatch.PORT)
    standing = _standing(trace, SimTruth.PORT, "TrueSpeed", TrnWatch.PORT, unseen)
    yield from _left_early(
        "the train", told_s, _told_levels(trace), past, past, standing, NotchCmd.PORT, unseen
    )  # fmt: skip
