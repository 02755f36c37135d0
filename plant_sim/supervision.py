"""Watches whether the supervisor is still there: without a recorder a run ends."""

from __future__ import annotations

import time
from typing import Final, Protocol

from railhil.bus.link import Endpoint
from railhil.common.patience import PATIENCE_S

#: Real time: wall time without an answer after which it counts as lost.
SILENCE_NS: Final = 2_000_000_000
#: Poll periods without an answer after which it counts as lost: two missed polls in a row, however slow the run.
_PERIODS: Final = 2.5


class RunEndpoint(Endpoint, Protocol):
    """An endpoint that knows whether it is itself the cause of the silence."""

    @property
    def is_down(self) -> bool:
        """True while the interface is gone."""


class SupervisorWatch:
    """Wall time since the supervisor last answered, without the time in which the plant itself was off the bus.

    :param period_ns: simulation time between two polls of the supervisor.
    :param rate: simulated seconds per wall second, 0 in lockstep.
    :param silence_ns: real time: minimum wall time for which it may be silent.
    :param patience_s: the bus administrator's patience in lockstep, where an answer may be damaged but is never late.
    """

    def __init__(
        self,
        endpoint: RunEndpoint,
        period_ns: int,
        rate: float,
        *,
        silence_ns: int = SILENCE_NS,
        patience_s: float = PATIENCE_S,
    ) -> None:
        self._endpoint = endpoint
        self.limit_ns = max(silence_ns, round(_PERIODS * period_ns / rate)) if rate else round(patience_s * 1e9)
        self._heard_ns = time.monotonic_ns()
        self._was_down = False

    def begin(self) -> None:
        """Note the beginning of a poll of any port: an interface that is down now may be back at its end."""
        self._was_down = self._endpoint.is_down

    def end(self, now_ns: int) -> None:
        """Note the end of that poll, at ``now_ns`` of the monotonic clock."""
        if self._was_down or self._endpoint.is_down:
            self._heard_ns = now_ns

    def heard(self, now_ns: int) -> None:
        """Note that the supervisor has answered."""
        self._heard_ns = now_ns

    def is_lost(self, now_ns: int) -> bool:
        """True when it has not answered for longer than ``limit_ns``."""
        return now_ns - self._heard_ns > self.limit_ns
