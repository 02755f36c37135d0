"""The frames by identifier, like CANoe's trace in fixed mode: count, period, age, and the decoded telegram."""

from __future__ import annotations

from typing import Any

from railhil.bus.injector.follower import raw_of
from railhil.dbc import Contract, Signal
from railhil.dbc.contract import ANTIVALENT_VALUES, CHECK_VALUES
from railhil.live.bus_follower import Listener
from railhil.panel.heard_bus import HeardBus


class FrameList:
    """Decodes the newest telegram of each port; what has not changed is not decoded again."""

    def __init__(self, contract: Contract) -> None:
        self._signals = {port.name: {item.name: item for item in port.signals} for port in contract.ports}
        self._names = {contract.poll_id: "poll", contract.device_status_id: "device status"}
        #: Identifier with which a telegram is complete -> its port.
        self._completes: dict[int, str] = {}
        for port in contract.ports:
            for number, can_id in enumerate(port.can_ids):
                self._names[can_id] = port.name if port.single_frame else f"{port.name} {number + 1}"
            self._names[port.can_ids[-1]] = port.name
            self._names[port.fd_id] = f"{port.name} FD"
            self._completes[port.can_ids[-1]] = self._completes[port.fd_id] = port.name
        self._decoded: dict[str, tuple[bytes, str]] = {}

    def rows(self, listener: Listener, heard: HeardBus) -> list[list[Any]]:
        """A row per identifier: identifier, name, count, period and age in ms (None: not known), data in hex,
        decoded telegram."""
        now_ns = listener.clock.now_ns
        found = []
        for can_id, seen in sorted(heard.frames.items()):
            port = self._completes.get(can_id)
            # After frames were lost its telegram is not known before it comes again.
            whole = b"" if port is None else listener.newest.data(port)
            text = self._text(port, whole) if port is not None and whole else ""
            last_ns, before_ns = seen.last_ns, seen.before_ns
            period_ms = None if last_ns is None or before_ns is None else (last_ns - before_ns) / 1e6
            age_ms = None if last_ns is None else (now_ns - last_ns) / 1e6
            name = self._names.get(can_id, "?")
            found.append([can_id, name, seen.count, period_ms, age_ms, seen.data.hex(" "), text])
        return found

    @staticmethod
    def watched(heard: HeardBus) -> dict[int, list[list[Any]]]:
        """The last raw frames of the identifiers that somebody watches: instant in s and data in hex."""
        return {
            can_id: [[None if time_s is None else round(time_s, 4), data.hex(" ")] for time_s, data in kept]
            for can_id, kept in heard.watched.items()
        }

    def _text(self, port: str, data: bytes) -> str:
        kept = self._decoded.get(port)
        if kept is not None and kept[0] == data:
            return kept[1]
        text = ", ".join(f"{name} {_said(item, raw_of(data, item))}" for name, item in self._signals[port].items())
        self._decoded[port] = (data, text if data else "")
        return self._decoded[port][1]


def _said(item: Signal, raw: int) -> str:
    """A raw value in the words of the wire contract, else in its unit."""
    words = {"chk": CHECK_VALUES, "antivalent": ANTIVALENT_VALUES}.get(item.check) or item.values
    if raw in words:
        return words[raw]
    return f"{raw * item.scale:.6g} {item.unit}".strip()
