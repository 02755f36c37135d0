"""Accepts the telegrams of a port, of any layout, that have a new life sign and correct check variables."""

from __future__ import annotations

from collections import Counter

from railhil.bus.layout import CHECK_CORRECT, Telegram
from railhil.bus.lifesign import Life, LifeSign
from railhil.common.errors import InputError, Words
from railhil.dbc import Signal

_LIFE_RANGE = (0, 15)


def life_of(kind: type[Telegram]) -> Signal | None:
    """The life sign of a telegram, its field ``life``; None: it has none.

    :raises InputError: it is not a number of 4 bits.
    """
    found = dict(kind.signals()).get("life")
    if found is not None and found.raw_range != _LIFE_RANGE:
        low, high = found.raw_range
        raise InputError("ports", f"{kind.PORT}.life", Words(f"{low} to {high}"), "a life sign of 4 bits, 0 to 15")
    return found


def checks_of(kind: type[Telegram]) -> dict[str, Signal]:
    """Fields of a telegram that are check variables (``check = "chk"`` in the port table), with their signals."""
    return {name: signal for name, signal in kind.signals() if signal.check == "chk"}


class Acceptance:
    """Accepts telegrams of one port that have passed the traffic store.

    A telegram is accepted if its life sign is new and all its check variables are correct. A field that the layout does
    not have is not checked.

    :param counters: where refusals are counted by cause (``duplicate``, ``out_of_order``, ``check_variable``), and
        ``gap`` for new telegrams after lost ones: the causes of :class:`railhil.controller_node.ato.guard.Guard`.
    :raises InputError: its life sign is not a number of 4 bits.
    """

    __slots__ = ("_checks", "_counters", "_has_life", "_life")

    def __init__(self, kind: type[Telegram], counters: Counter[str]) -> None:
        self._counters = counters
        self._checks = tuple(checks_of(kind))
        self._has_life = life_of(kind) is not None
        self._life = LifeSign()

    def accept(self, telegram: Telegram) -> bool:
        """True when the telegram is accepted."""
        if self._has_life:
            sign: int = telegram.life  # type: ignore[attr-defined]
            life = self._life.judge(sign)
            if not life.fresh:
                self._counters[life.value] += 1
                return False
            if life is Life.GAP:
                self._counters["gap"] += 1
            self._life.accept(sign)
        if any(getattr(telegram, name) != CHECK_CORRECT for name in self._checks):
            self._counters["check_variable"] += 1
            return False
        return True
