"""The protocol: every law in three situations, records that test the models, and short runs that count operations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from railhil.controller_node.laws.high_speed.training import Recipe
from railhil.learning.models import learn
from railhil.library import Outcome
from railhil.reproduce.ngpc.names import (
    CYCLES,
    EMERGENCY,
    LAWS,
    MUTATION,
    NORMAL,
    effort_key,
    key,
    model_error,
    record_key,
)
from railhil.reproduce.paper import Planned
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.supervisor.high_speed.ride import Ride
from railhil.supervisor.record import Record
from railhil.supervisor.telemetry import read_summary
from railhil.supervisor.trace import FloatArray

SCENARIOS: Mapping[str, str] = {
    NORMAL: "jinan_xuzhou",
    EMERGENCY: "jinan_xuzhou_emergency",
    MUTATION: "jinan_xuzhou_mutation",
}
#: The first two minutes, in an arithmetic whose operations are counted.
_SHORT, _COUNTED = "hst_short", "float32"
#: The papers simulate on a computer.
_ARITHMETIC = "float64"
#: A record to test models on is driven by this law with a square wave of 0.05 m/s2 (reading D14).
_DRIVER, _DITHER_MPS2 = "pid", 0.05
#: Sampling period of the laws, s; points of a drawn curve are one of these apart.
_PERIOD_S = 1.0

PROTOCOL = (
    "Line, target curve, train and disturbances of the scenarios jinan_xuzhou, jinan_xuzhou_emergency and "
    "jinan_xuzhou_mutation: the papers name the line, delays, lags and the emergency at km 210; everything else is "
    "assumed, and listed by `railhil scenarios jinan_xuzhou`.",
    "Each law on every situation and seed in float64, with its own parameters; none was chosen on these seeds.",
    "Modelling error: an ELM is trained on the record of a run with a dithered PID, without 300 samples spread over "
    "it, and judged on these.",
    "Computing effort: estimated cycles of the target processor for one control period in float32, counted in the "
    "first two minutes of a run.",
)


def planned(seeds: Sequence[int]) -> list[Planned]:
    """All runs."""
    return [*_tracking(seeds), *_records(seeds), *_efforts()]


def _tracking(seeds: Sequence[int]) -> Iterator[Planned]:
    for seed in seeds:
        for situation, scenario in SCENARIOS.items():
            for law in LAWS:
                spec = RunSpec(scenario, law=LawSpec(law, _ARITHMETIC), seed=seed, bus="local")
                yield Planned(key(situation, law, seed), spec, drawn=seed == seeds[0])


def _records(seeds: Sequence[int]) -> Iterator[Planned]:
    given = ParameterSet(_DRIVER, {"dither_mps2": _DITHER_MPS2}, Path("parameters.json"))
    for seed in seeds:
        law = LawSpec(_DRIVER, _ARITHMETIC, parameters=given)
        yield Planned(record_key(seed), RunSpec(SCENARIOS[NORMAL], law=law, seed=seed, bus="local"))


def _efforts() -> Iterator[Planned]:
    for law in LAWS:
        yield Planned(effort_key(law), RunSpec(_SHORT, law=LawSpec(law, _COUNTED), bus="local"))


def measure(outcome: Outcome) -> dict[str, float | None]:
    """Scores; of a run with dither the modelling errors; of one whose operations are counted the cycles."""
    found: dict[str, float | None] = dict(outcome.scores)
    if outcome.certificate.get("parameters"):
        log = outcome.folder / "frames.log"
        record = Record(log, outcome.scenario, outcome.trace, "", dict(outcome.certificate))
        for period_s, error in learn(record, Recipe(), _PERIOD_S).errors.items():
            found[model_error("linear", period_s)] = error.linear_kmh
            found[model_error("integrated", period_s)] = error.integrated_kmh
    if outcome.certificate["arithmetic"] == _COUNTED:
        summary = read_summary(outcome.folder)
        found[CYCLES] = None if summary is None else float(summary.cycles)
    return found


@dataclass(frozen=True, slots=True)
class Drawable:
    """What is drawn of a run: arrays of shape (n,), about a second apart."""

    position_m: FloatArray
    target_kmh: FloatArray
    speed_kmh: FloatArray
    error_kmh: FloatArray


def curves(outcome: Outcome) -> Drawable:
    """Speed and error over distance."""
    ride = Ride.of(outcome.scenario, outcome.trace)
    step = max(1, round(_PERIOD_S / (ride.time_s[1] - ride.time_s[0])))
    return Drawable(
        ride.position_m[::step], ride.target_mps[::step] * 3.6, ride.speed_mps[::step] * 3.6, ride.error_kmh[::step]
    )
