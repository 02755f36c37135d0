"""The telegrams of a run as they pass, and conditions on their signals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from railhil.bus.frame import Frame
from railhil.bus.store import TrafficStore
from railhil.common.errors import did_you_mean
from railhil.dbc import Contract, Signal

#: What a signal is compared with: a number, a word of its value table, or a function of its value.
Wanted = float | str | Callable[[float], object]


class Heard:
    """Newest telegram of every port."""

    def __init__(self, contract: Contract) -> None:
        self._contract = contract
        self._store = TrafficStore(contract.ports)

    def take(self, frame: Frame, now_ns: int) -> None:
        """Take a frame in bus order."""
        self._store.feed(frame, now_ns)

    def count(self, port: str) -> int:
        """Telegrams of a port so far."""
        return self._store.accepted(port)

    def signals(self, port: str, names: Mapping[str, Any] | None = None) -> dict[str, Signal]:
        """Signals of a port.

        :param names: only these.
        :raises ValueError: there is no such port or signal.
        """
        ports = {one.name: one for one in self._contract.ports}
        if port not in ports:
            raise ValueError(_unknown("port", port, list(ports)))
        signals = {signal.name: signal for signal in ports[port].signals}
        for name in names or ():
            if name not in signals:
                raise ValueError(_unknown(f"signal of {port}", name, list(signals)))
        return signals if names is None else {name: signals[name] for name in names}

    def values(self, port: str) -> dict[str, float]:
        """Physical values of the newest telegram of a port; empty before the first.

        :raises ValueError: there is no such port.
        """
        signals = self.signals(port)
        data = self._store.raw(port)
        return {name: raw_of(signal, data) * signal.scale for name, signal in signals.items()} if data else {}

    def shown(self, port: str, names: Mapping[str, Any]) -> str:
        """Signals of the newest telegram in words."""
        data = self._store.raw(port)
        signals = self.signals(port, names)
        said = [f"{name} {_word(signal, raw_of(signal, data))}" for name, signal in signals.items()] if data else []
        return ", ".join(said) or "no telegram yet"

    def meets(self, port: str, wanted: Mapping[str, Wanted]) -> bool:
        """Whether the newest telegram of a port is as wanted; False before the first."""
        data = self._store.raw(port)
        signals = self.signals(port, wanted)
        return bool(data) and all(_meets(signals[name], raw_of(signals[name], data), wanted[name]) for name in wanted)


def raw_of(signal: Signal, data: bytes) -> int:
    """Raw value of a signal in the process data of its telegram."""
    raw = int.from_bytes(data) >> (len(data) * 8 - signal.first_bit - signal.length) & ((1 << signal.length) - 1)
    return raw - (1 << signal.length) if raw > signal.raw_range[1] else raw


def _meets(signal: Signal, raw: int, wanted: Wanted) -> bool:
    if callable(wanted):
        return bool(wanted(raw * signal.scale))
    if isinstance(wanted, str):
        words = list(signal.values.values())
        if _flat(wanted) not in map(_flat, words):
            raise ValueError(_unknown(f"value of {signal.name}", wanted, words))
        return _flat(signal.values.get(raw, "")) == _flat(wanted)
    return raw * signal.scale == wanted


def _flat(word: str) -> str:
    return word.replace(" ", "_").casefold()


def _word(signal: Signal, raw: int) -> str:
    unit = "" if signal.unit in ("", "1") else f" {signal.unit}"
    return signal.values.get(raw, f"{raw * signal.scale:.6g}{unit}")


def _unknown(what: str, name: str, allowed: list[str]) -> str:
    hint = did_you_mean(name, allowed)
    return f"no {what} {name!r}" + (f" ({hint})" if hint else f", allowed {', '.join(allowed)}")
