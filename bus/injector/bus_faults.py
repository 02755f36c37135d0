"""Faults of the bus itself: error frames, error-passive, broken lines, foreign frames that load it.

The hub's model makes the error frames, states and lines (:mod:`railhil.bus.hub.disturbances`). The plant gives the
orders between its own frames, so they have their place in the total order and a run gives the same bytes again. A hit
of a fault is a report of the plant's own CAN controller: error frames, its state, the line from which it takes frames,
answers that cannot come.

Plant and controller are disturbed, the supervisor is not: it judges. For the same reason the plant never becomes
bus-off here.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Self

from railhil.bus.frame import Frame
from railhil.bus.hub.cancontroller import ERROR_PASSIVE
from railhil.bus.hub.disturbances import Disturber, Order
from railhil.bus.injector.activities import Activities
from railhil.bus.injector.node_faults import NodeFaults
from railhil.bus.link import errorframe
from railhil.bus.mvb import parse_master_frame
from railhil.dbc import Contract
from railhil.faults.activity import Activity
from railhil.faults.model import Fault, Random
from railhil.faults.words import CLEAR

#: Words that only a hub with ``--faults`` can carry out, besides the words of a line.
ORDERED = ("error_frames", "passive")
_LINES = ("open", "loose", "short")
_PLANT, _CONTROLLER = "plant", "controller"
#: After so many errors in a row the CAN controller is bus-off.
_TO_BUS_OFF = 32
#: The largest transmit error counter of the plant, and its growth with an error.
_TEC_MAX, _TEC_STEP = 255, 8


def need_orders(faults: Iterable[Fault]) -> bool:
    """Whether some of a run's faults need a hub with ``--faults``."""
    return any(
        one.place.level == "bus" and one.what != CLEAR and (bool(one.place.part) or one.what in ORDERED)
        for one in faults
    )


class BusFaults:
    """The bus faults of one run, at the plant."""

    def __init__(self, faults: NodeFaults, disturber: Disturber, contract: Contract) -> None:
        self._activities = faults.activities
        self._disturber = disturber
        self._poll_id = contract.poll_id
        # Number of frames of an answer, by the poll's request; the CAN FD form has fewer.
        self._answers = {
            port.f_code << 12 | port.address: len(port.can_ids)
            for port in contract.ports
            if port.source == _CONTROLLER and port.mode == "poll"
        }
        self._errors = [(one, faults.samples(one.number)) for one in faults.at("bus", "error_frames")]
        self._passives = faults.at("bus", "passive")
        self._lines = [(one, faults.samples(one.number)) for one in faults.at("bus", *_LINES)]
        self._host = disturber.host
        # Errors ordered for the plant's own frames since it last heard of its counter.
        self._pending = 0
        # Whether it is noted that no answer to the last packet can come.
        self._is_cut_off = False
        # Orders that have not been taken back yet.
        self._disturbs = self._is_passive = False
        self._dead: set[tuple[str, str]] = set()

    @classmethod
    def of(cls, faults: NodeFaults, disturber: Disturber, contract: Contract) -> Self | None:
        """The bus faults of a run; None if it has none."""
        found = need_orders(one.fault for one in faults.activities.all)
        return cls(faults, disturber, contract) if found else None

    def instant(self) -> None:
        """Give the orders for faults that begin or end with an instant."""
        passive = any(one.active for one in self._passives)
        if passive is not self._is_passive:
            self._is_passive = passive
            for who in (_PLANT, _CONTROLLER):
                self._disturber.order(Order("passive", who, on=passive))
        disturbs = any(one.active for one, _ in self._errors)
        if self._disturbs and not disturbs:
            # Many errors may have taken the controller off the bus.
            self._disturber.order(Order("restart", _CONTROLLER))
        self._disturbs = disturbs
        dead = {found for one, random in self._lines if one.active for found in _dead(one.fault, random)}
        for who, line in sorted(dead ^ self._dead):
            self._disturber.order(Order("line", who, line=line, on=(who, line) in dead))
        self._dead = dead

    def sending(self, frames: Sequence[Frame]) -> None:
        """Draw which of these frames, and of the answers to their polls, are disturbed."""
        self._is_cut_off = False
        for one, random in self._errors:
            if not one.active:
                continue
            share = one.fault.parameter("share")
            own = sum(_errors(share, random) for _ in frames)
            others = sum(_errors(share, random) for frame in frames for _ in range(self._asked(frame)))
            own = min(own, (_TEC_MAX - self._host.tec) // _TEC_STEP - self._pending)
            if own > 0:
                self._pending += own
                self._disturber.order(Order("errors", _PLANT, count=own))
            if others:
                self._disturber.order(Order("errors", _CONTROLLER, count=others))

    def heard(self, frames: Sequence[Frame]) -> None:
        """Note the reports and the state of the plant's CAN controller."""
        self._pending = 0
        for frame in frames:
            if errorframe.is_bus_error(frame):
                tec, rec = errorframe.counters_of(frame)
                self._note([one for one, _ in self._errors], "", f"error frame, TEC {tec}, REC {rec}")
        if self._lines and not self._is_cut_off and self._disturber.is_cut_off(_CONTROLLER):
            self._is_cut_off = True
            # Another line would be in use without the newest of these faults.
            newest = sorted((one for one, _ in self._lines if one.active), key=lambda one: -(one.begun_ns or 0))
            self._note(newest, "answer", "cut off")
        before, host = self._host, self._disturber.host
        if host is before:
            return
        self._host = host
        if host.state == ERROR_PASSIVE != before.state:
            self._note(self._passives, before.state, f"{host.state}, TEC {host.tec}, REC {host.rec}")
        if host.switch_overs != before.switch_overs:
            self._note([one for one, _ in self._lines], f"line {before.line}", f"line {host.line}")

    def _note(self, faults: Sequence[Activity], before: str, after: str) -> None:
        for one in faults:
            if one.active:
                self._activities.note(one, before, after)
                return

    def _asked(self, frame: Frame) -> int:
        """How many frames of the controller a frame asks for."""
        if frame.can_id != self._poll_id or frame.flags:
            return 0
        asked = parse_master_frame(frame.data)
        return 0 if asked is None else self._answers.get(asked[0] << 12 | asked[1], 0)


def _errors(share: float, random: Random) -> int:
    """How many attempts to send one frame an error destroys; each is disturbed like the first."""
    count = 0
    while count < _TO_BUS_OFF and random.random() < share:
        count += 1
    return count


def _dead(fault: Fault, random: Random) -> list[tuple[str, str]]:
    """Nodes whose connection to a line is dead in this instant, each with the line.

    An open line parts the controller from plant and supervisor; a short-circuited line works for no node.
    """
    line = fault.place.part.upper()
    if fault.what == "loose" and random.random() >= fault.parameter("share"):
        return []
    return [(who, line) for who in ((_PLANT, _CONTROLLER, "supervisor") if fault.what == "short" else (_CONTROLLER,))]


#: Identifier of the foreign frames: no port has it, and it loses every arbitration against the ports.
FOREIGN_ID = 0x7E0
#: Bits of a frame with 8 bytes and 11 bit identifier, without stuff bits, with the pause behind it.
FRAME_BITS = 111


class Flood:
    """Foreign frames of a given share of the bus, evenly over the instants.

    :param bit_rate: of the bus in bit/s.
    """

    def __init__(self, activity: Activity, bit_rate: int) -> None:
        self._activity = activity
        self._bit_rate = bit_rate
        self._sent = 0

    def frames(self, activities: Activities) -> list[Frame]:
        """The frames of the instant that begins."""
        one = self._activity
        if not one.active or one.begun_ns is None:
            return []
        per_s = one.fault.parameter("share") * self._bit_rate / FRAME_BITS
        due = int((activities.now_ns - one.begun_ns) / 1e9 * per_s) + 1
        count, self._sent = due - self._sent, due
        if count > 0:
            activities.note(one, "", f"{count} x {FOREIGN_ID:03X}")
        return [Frame(FOREIGN_ID, (self._sent - index).to_bytes(8)) for index in range(count)]
