"""The option ``atp.heed_atp``: traction is taken off before the train would reach the permitted speed.

The distance of the speed to the permitted one is followed from telegram to telegram of ATP_LIM; where it would be used
up within :data:`AHEAD_MS`, a notch of traction becomes 0. Without fresh telegrams nothing is limited: the train
protection acts on the train itself.
"""

from __future__ import annotations

from typing import Final

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.lifesign import LifeSign
from railhil.wire.line import AtpLim

#: Traction is taken off this long before the permitted speed would be reached (specification of the line, 4.7).
AHEAD_MS: Final = 500
#: Age above which a telegram counts no longer.
AGE_MAX_MS: Final = 500
_01MMPS_PER_4MMPS: Final = 40


class PermittedSpeed:
    """The permitted speed as the controller knows it.

    ``told``: telegrams by status. ``is_near``: traction has to be off.
    """

    def __init__(self) -> None:
        self.told = [0] * 8
        self.is_near = False
        self._life = LifeSign()
        self._at_ms = -1
        self._margin_01mmps = 0

    def take(self, telegram: AtpLim, speed_01mmps: int, own_ms: int) -> None:
        """Take an ATP_LIM telegram, if its check is correct and its life sign new.

        :param speed_01mmps: the train's speed.
        """
        if telegram.check != CHECK_CORRECT or not self._life.judge(telegram.life).fresh:
            return
        self._life.accept(telegram.life)
        self.told[telegram.status] += 1
        margin_01mmps = telegram.permitted_4mmps * _01MMPS_PER_4MMPS - speed_01mmps
        before_ms, before_01mmps = self._at_ms, self._margin_01mmps
        self._at_ms, self._margin_01mmps = own_ms, margin_01mmps
        if before_ms < 0 or not 0 < own_ms - before_ms <= AGE_MAX_MS:
            self.is_near = margin_01mmps <= 0
            return
        change_01mmps = (margin_01mmps - before_01mmps) * AHEAD_MS // (own_ms - before_ms)
        self.is_near = speed_01mmps > 0 and margin_01mmps + min(change_01mmps, 0) <= 0

    def allows(self, own_ms: int) -> bool:
        """Whether traction is allowed."""
        return not self.is_near or own_ms - self._at_ms > AGE_MAX_MS
