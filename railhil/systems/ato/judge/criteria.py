"""The criteria of a train that drives automatically from one stop to the next.

A further criterion is a further entry here; the batch, which computes the scores in its compiled loop, must compute it
too (:mod:`railhil.systems.ato.batch.engine`).
"""

from __future__ import annotations

from railhil.judge.criteria import DID_NOT_STOP, STOP_ERROR_KEY, Criterion, Extra, Limit
from railhil.systems.ato.judge import journey
from railhil.systems.ato.judge.measures import KMH

#: Largest excess over the speed limit, in m/s.
OVERSPEED = Extra("overspeed_mps", "overspeed", "overspeeds", "over-\nspeed", tuning_weight=KMH)
#: Eq. (8): distance of the standstill from the stopping point.
STOP_ERROR = Criterion(
    STOP_ERROR_KEY, "stop error", "m", 4, lambda run: run.stop.error_m,
    limit=Limit(lambda scenario: scenario.plan.stop_error_max_m, 0), signed=STOP_ERROR_KEY, tuning_digits=3,
    audit_allowed=0.01, without=DID_NOT_STOP,
)  # fmt: skip
#: Eq. (7): difference of the arrival time from the timetable.
TIME_ERROR = Criterion(
    "punctuality_s", "time error", "s", 4, lambda run: run.stop.late_s,
    limit=Limit(lambda scenario: scenario.plan.time_error_max_s, 1), signed="time_error_s", tuning_digits=3,
    audit_allowed=0.01, without=DID_NOT_STOP,
)  # fmt: skip
#: The five criteria of the paper, in the order of their columns.
CRITERIA = (
    Criterion("itae", "ITAE", "km/h s2", 1, journey.itae_kmh_s2, published_digits=0, tuning_digits=0),
    Criterion("energy_kj", "energy", "kJ", 0, journey.energy_kj),
    TIME_ERROR,
    STOP_ERROR,
    Criterion("comfort", "comfort", "m/s2/km", 3, journey.comfort_mps2_per_km, statistics_digits=4),
)
