"""The watch of a train that is commanded by an acceleration: age of its commands, and whether its brake answers."""

from __future__ import annotations

from railhil.common.compilable import compilable

#: Periods of a command without a new life sign after which the unit acts by itself.
STALE_PERIODS = 3
#: A brake is watched when at least this braking should act; it answers if this share of it acts.
BRAKING_FROM_MPS2 = 0.1
ANSWER_SHARE = 0.4
#: A brake that has not answered for this time counts as failed.
ANSWER_S = 2.0


@compilable
def brake_looked_at(
    expected_mps2: float, silent_ticks: int, told_mps2: float, drive_mps2: float, share: float
) -> tuple[float, int]:
    """Check the brake once a tick: braking expected by now, and ticks since the brake answered.

    :param told_mps2: braking that should act, <= 0.
    :param share: of a change of it that is expected within a tick (:func:`share_of`).
    """
    expected_mps2 += (told_mps2 - expected_mps2) * share
    if expected_mps2 < -BRAKING_FROM_MPS2 and drive_mps2 > ANSWER_SHARE * expected_mps2:
        return expected_mps2, silent_ticks + 1
    return expected_mps2, 0


def share_of(tick_s: float, lag_s: float) -> float:
    """Share of a change of the braking that a unit of this lag shows within a tick."""
    return min(1.0, tick_s / lag_s)


def answer_ticks(tick_s: float) -> int:
    """Ticks without an answer after which a brake counts as failed."""
    return round(ANSWER_S / tick_s)
