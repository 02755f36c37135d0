"""Bands and bounds that railhil's own specification sets for its laws, and whether the measured means keep them."""

from __future__ import annotations

from dataclasses import dataclass

from railhil.reproduce.ngpc.names import (
    ADAPTIVE,
    DELAY,
    ELM,
    EMERGENCY,
    LATER,
    MULTI_MODEL,
    MUTATION,
    NORMAL,
    PID,
    RESIDUAL,
    RMSE,
    STOP_M,
    WINDOWS,
    key,
    mean,
    seeds_of,
)
from railhil.reproduce.paper import Results

#: Titles of the figures.
TITLES = {RMSE[NORMAL]: "RMSE", RMSE[EMERGENCY]: "RMSE", WINDOWS: "RMSE in the windows", STOP_M: "stop"}


@dataclass(frozen=True, slots=True)
class Band:
    """Least and greatest allowed mean of a figure over the seeds; ``least`` None: there is no least one."""

    situation: str
    law: str
    least: float | None
    most: float
    name: str
    unit: str = "km/h"
    digits: int = 4

    @property
    def text(self) -> str:
        """The band in words."""
        return f"at most {self.most:g}" if self.least is None else f"{self.least:g} to {self.most:g}"

    def is_measured(self, results: Results) -> bool:
        """Whether runs of all seeds were made."""
        seeds = seeds_of(self.situation, self.law, results.seeds)
        return all(key(self.situation, self.law, seed) in results.runs for seed in seeds)

    def holds(self, results: Results) -> bool:
        """Whether the mean is in the band; no value is not."""
        found = mean(results, self.situation, self.law, self.name)
        return found is not None and (self.least is None or found >= self.least) and found <= self.most

    def verdict(self, results: Results) -> str:
        """In words, also the side on which a mean is outside."""
        found = mean(results, self.situation, self.law, self.name)
        if not self.is_measured(results):
            return "not all runs made"
        if self.holds(results):
            return "holds"
        return (
            "does not hold: no value"
            if found is None
            else f"does not hold: {'above' if found > self.most else 'below'}"
        )


def _rmse(situation: str, law: str, least: float | None, most: float) -> Band:
    return Band(situation, law, least, most, RMSE[situation])


BANDS = (
    _rmse(NORMAL, RESIDUAL, 0.09, 0.12),
    _rmse(NORMAL, ELM, 0.14, 0.21),
    _rmse(NORMAL, PID, 0.17, 0.22),
    _rmse(NORMAL, MULTI_MODEL, 0.11, 0.15),
    _rmse(NORMAL, ADAPTIVE, 0.13, 0.20),
    _rmse(EMERGENCY, ELM, 0.24, 0.33),
    _rmse(EMERGENCY, MULTI_MODEL, 0.69, 0.79),
    *(Band(EMERGENCY, law, 4380.0, 4420.0, STOP_M, "m", 1) for law in (ELM, MULTI_MODEL, ADAPTIVE, RESIDUAL, DELAY)),
    _rmse(NORMAL, DELAY, None, 0.072),
    _rmse(EMERGENCY, DELAY, None, 0.197),
    _rmse(MUTATION, DELAY, None, 0.168),
    _rmse(LATER, DELAY, None, 0.31),
)
