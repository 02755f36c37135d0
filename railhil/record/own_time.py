"""The time that a record itself holds: TIME_SYNC, life signs and polls, counted as the recorder of a run counts them.

A log of another program has other stamps: wall-clock times, or times since its first frame. The run is then recorded
again from its frames (:class:`railhil.record.session.Session`), which gives the same stamps as ``railhil run`` writes.
Frames before the run or after its end are left out, as by the recorder.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from railhil.bus.clock import from_time_sync
from railhil.bus.frame import BRS, FD, Frame
from railhil.bus.ident import PltIdent
from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import F_DEVICE_STATUS
from railhil.bus.own_frames import OwnFrames
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import TimeSync
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.dbc import Contract
from railhil.record.framelog import log_line, read_log
from railhil.record.log_files import is_candump
from railhil.record.session import make_session
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

Timed = tuple[int, Frame]
#: A logger may stamp two frames in the wrong order, but not further apart than this.
_BACK_MAX_NS: Final = 1_000_000_000
#: Faults with these words touch TIME_SYNC.
_TOUCHING: Final = (TimeSync.PORT, "bus")
_OF_FD: Final = FD | BRS


@dataclass(frozen=True, slots=True)
class OwnTime:
    """A record in its own time.

    :param frames: frames of the run, in bus order.
    :param notes: parts of the log that were not used, a sentence each; empty: the log is as railhil writes it.
    """

    frames: list[Timed]
    notes: tuple[str, ...]

    @property
    def sha256(self) -> str:
        """SHA-256 of the log that railhil would have written."""
        digest = hashlib.sha256()
        for time_ns, frame in self.frames:
            digest.update(log_line(time_ns, frame).encode("ascii"))
        return digest.hexdigest()


class RunClock:
    """Gives the frames of one run, in bus order, the times that they had in it.

    :param contract: the one used for recording.
    """

    def __init__(self, scenario: AnyScenario, contract: Contract) -> None:
        self._kept: list[Timed] = []
        self._session = make_session(
            scenario, str, RunSpec(), contract=contract, keep=lambda time_ns, frame: self._kept.append((time_ns, frame))
        )
        self._poll_id = contract.poll_id
        #: Frames after the end of the run.
        self.after = 0

    @property
    def has_begun(self) -> bool:
        """Whether the beginning of the run was among the frames."""
        return self._session.recording

    @property
    def has_ended(self) -> bool:
        """Whether the end of the run was among the frames."""
        return self._session.ended is not None

    def take(self, frame: Frame) -> Timed | None:
        """The frame with its time; None: it is no part of the run."""
        if self.has_ended and (self.after or frame.can_id == self._poll_id):
            # The answer to the plant's last poll is the end of the record.
            self.after += 1
            return None
        self._session.handle(frame)
        # The recorder's own answers are among the frames already.
        timed = self._kept[0] if self._kept else None
        self._kept.clear()
        return timed


def own_time(log: Path, scenario: AnyScenario, contract: Contract) -> OwnTime:
    """The frames of a run with the times that they had in it.

    :param contract: the one used for recording.
    :raises InputError: as :func:`railhil.record.framelog.read_log`; the order of the log is not that of the bus; it
        begins during the run, or has a second one.
    """
    kept: list[Timed] = []
    clock = RunClock(scenario, contract)
    touched = any(word in text for text in scenario.faults for word in _TOUCHING)
    order = None if touched else _Order(scenario, contract)
    before = moved = latest_ns = 0
    first, counted = contract.port(PltIdent.PORT), contract.clock_port
    opening, clock_ids, own = (first.address, first.fd_id), (counted.address, counted.fd_id), OwnFrames(contract)
    # A run that has begun before is heard: its PLT_IDENT is a repetition until nodes are searched again.
    others_from = 0
    for number, (time_ns, frame) in enumerate(read_log(log), 1):
        if time_ns < latest_ns - _BACK_MAX_NS:
            raise _at(log, number, f"{time_ns / 1e9:.6f} s", f"{latest_ns / 1e9:.6f} s or later")
        latest_ns = max(latest_ns, time_ns)
        if not clock.has_begun and (others_from or frame.can_id not in opening):
            # Frames of another run, or of the search for nodes: the time begins with the run.
            is_scan = is_search(frame, contract) or frame.can_id == contract.device_status_id
            before += not is_scan
            if is_scan:
                others_from = 0
            elif not others_from and frame.can_id in clock_ids and frame in own:
                others_from = number
            continue
        if clock.has_ended and frame.can_id in opening and frame in own:
            raise _at(log, number, "the beginning of a second run", "the end of the first")
        timed = clock.take(frame)
        if timed is None:
            continue
        if order is not None and (wrong := order.contradiction(frame)):
            raise _at(log, number, *wrong)
        kept.append(timed)
        moved += timed[0] != time_ns
    if others_from and not clock.has_begun:
        raise _at(log, others_from, f"{counted.name} and no {PltIdent.PORT} before it", "the handshake first")
    return OwnTime(kept, tuple(_notes(log, moved, before, clock.after)))


def _notes(log: Path, moved: int, before: int, after: int) -> Iterable[str]:
    if moved:
        yield (
            f"the stamps of {log.name} are not the times of the run ({count_of(moved, 'frame')}): times are counted "
            "from TIME_SYNC and life signs"
        )
    if before or after:
        yield f"{log.name}: {count_of(before, 'frame')} before the run and {after} after it are left out"


def _at(log: Path, number: int, found: str, allowed: str) -> InputError:
    where = f"{'line' if is_candump(log) else 'frame'} {number}"
    return InputError(log, where, Words(found), f"{allowed}: a log of one run in the order of the bus")


def is_search(frame: Frame, contract: Contract) -> bool:
    """Whether a frame is a poll of the search for nodes before a run, which no recorder keeps."""
    return frame.can_id == contract.poll_id and bool(frame.data) and frame.data[0] >> 4 == F_DEVICE_STATUS


class _Order:
    """Finds two TIME_SYNC between which the record holds more simulation time than they tell. Lost frames only make it
    less.

    The simulation time is counted by the telegrams of the truth, which no fault touches.
    """

    def __init__(self, scenario: AnyScenario, contract: Contract) -> None:
        truth = scenario.installed_system.truth
        counted = contract.clock_port if truth is None else contract.port(truth.port)
        timing, port = scenario.timing, contract.port(TimeSync.PORT)
        schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, contract)
        self._base_tick_ns = timing.base_tick_ns
        self._period_ns = schedule.ticks(counted.name) * timing.base_tick_ns
        self._counted_ids = {counted.can_ids[0], counted.fd_id}
        self._ids = {port.can_ids[0], port.fd_id}
        self._bytes = port.data_bytes
        self._said_ns = self._passed_ns = 0

    def contradiction(self, frame: Frame) -> tuple[str, str] | None:
        """The value found and the values allowed, if this frame is such a TIME_SYNC."""
        self._passed_ns += self._period_ns if frame.can_id in self._counted_ids else 0
        if frame.can_id not in self._ids or frame.flags & ~_OF_FD or len(frame.data) < self._bytes:
            return None
        telegram = TimeSync.decode(frame.data[: self._bytes])
        if telegram.check != CHECK_CORRECT:
            return None
        said_ns = from_time_sync(telegram, self._base_tick_ns) * self._base_tick_ns
        earliest_ns = self._said_ns + self._passed_ns - MAX_STEP * self._base_tick_ns
        self._said_ns, self._passed_ns = said_ns, 0
        if said_ns >= earliest_ns:
            return None
        return f"{TimeSync.PORT} {said_ns / 1e9:.2f} s", f"{earliest_ns / 1e9:.2f} s or later by the frames before"
