"""The protocol: every law in three situations, records that test the models, and short runs that count operations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from railhil.bus.high_speed import wire
from railhil.controller_node.laws.high_speed.training import Recipe
from railhil.judge.record import Record
from railhil.learning.models import learn
from railhil.library import Outcome
from railhil.record.telemetry import read_summary
from railhil.record.trace import FloatArray
from railhil.reproduce.ngpc.names import (
    BESIDE,
    CALM,
    CYCLES,
    DRAWN,
    EMERGENCY,
    FIXED_MODEL,
    LATE,
    LATER,
    LAWS,
    MAIN,
    MUTATION,
    NORMAL,
    PID,
    STRONGER,
    UNITS,
    WINDOWS,
    effort_key,
    key,
    laws_of,
    model_error,
    record_key,
    seeds_of,
    units_key,
)
from railhil.reproduce.paper import Planned
from railhil.reproduce.ways import Coupled
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.high_speed.ride import Ride

SCENARIOS: Mapping[str, str] = {
    NORMAL: "jinan_xuzhou",
    EMERGENCY: "jinan_xuzhou_emergency",
    MUTATION: "jinan_xuzhou_mutation",
    FIXED_MODEL: "jinan_xuzhou_emergency",
    LATE: "jinan_xuzhou",
    LATER: "jinan_xuzhou",
    STRONGER: "jinan_xuzhou",
    CALM: "jinan_xuzhou",
}
#: Begin and duration of the mutations of jinan_xuzhou_mutation, s; those of the other situations are at the same times.
WINDOWS_S = ((1030, 80), (2800, 90), (3590, 85))
_FAULT: Mapping[str, str] = {
    LATE: "train.delay longer 500ms",
    LATER: "train.delay longer 1000ms",
    STRONGER: "train.gain scale 1.4",
}
#: Parameters of the laws in a situation that are not their own, and the file for them.
_GIVEN: Mapping[str, tuple[Mapping[str, str], str]] = {FIXED_MODEL: ({"ident": "off"}, "ident_off_{law}.toml")}
_CALM = ("task.gradient_permil=0", "task.wind_sigma_mps2=0")
#: The first two minutes, in an arithmetic whose operations are counted.
_SHORT, _COUNTED = "hst_short", "float32"
#: The papers simulate on a computer.
_ARITHMETIC = "float64"
#: A record to test models on is driven by this law with a square wave of 0.05 m/s2 (reading D14).
_DRIVER, _DITHER, _DITHER_MPS2 = PID, "dither_mps2", 0.05
#: Sampling period of the laws, s; points of a drawn curve are one of these apart.
_PERIOD_S = 1.0
_UNITS_SCENARIO: Mapping[str, str] = {"free": "jinan_xuzhou_emu3", "coupled": "jinan_xuzhou_emu3_coupled"}
#: Ports of the plant that the scores are computed from.
_PORTS, _UNITS_PORTS = (wire(1).truth.PORT,), (wire(3).truth.PORT,)

PROTOCOL = (
    "Line, target curve, train and disturbances of the scenarios jinan_xuzhou, jinan_xuzhou_emergency and "
    "jinan_xuzhou_mutation: the papers name the line, delays, lags and the emergency at km 210; everything else is "
    "assumed, and listed by `railhil scenarios jinan_xuzhou`.",
    "No parameter of a law was chosen on the seeds, nor was a network trained on them.",
    f"Each law in float64 with its own parameters. Only the first seed: the record, and in normal running and with "
    f"mutations the laws {', '.join(law for law in LAWS if law not in MAIN)}. Every seed: everything else.",
    f"Beside the papers: {LATE}, {LATER}, {STRONGER} (delay 0.5 s or 1 s longer, gain 1.4, at the times of the "
    f"mutation and instead of it); {CALM} (neither gradient nor wind); {FIXED_MODEL} (the emergency, and the model is "
    f'not identified: `ident = "off"`).',
    "Runs of the journeys, but for the record, are made without a bus: the plant and the law coupled by the same raw "
    "integers. Tests show telegrams and scores equal to those of the nodes. Such a run has no frames.log; the command "
    "beside it makes the same run over the in-process bus. The parameter "
    f'files stand beside this page: `{_DITHER} = {_DITHER_MPS2}` for the record, `ident = "off"` for {FIXED_MODEL}, '
    '`loop = "mean"` for one loop on the mean speed of three units.',
    "Modelling error: an ELM is trained on the record of a run with a dithered PID, without 300 samples spread over "
    "it, and judged on these.",
    "Computing effort: estimated cycles of the target processor for one control period in float32, counted in the "
    "first two minutes of a run over the in-process bus.",
)


def planned(seeds: Sequence[int]) -> list[Planned]:
    """All runs."""
    return [*_tracking(seeds), *_records(seeds[:1]), *_units(seeds), *_efforts()]


def _tracking(seeds: Sequence[int]) -> Iterator[Planned]:
    for situation, scenario in SCENARIOS.items():
        faults = tuple(f"{_FAULT[situation]} @{at}s for {s}s" for at, s in WINDOWS_S) if situation in _FAULT else ()
        settings = _CALM if situation == CALM else ()
        values, file = _GIVEN.get(situation, ({}, ""))
        for law in laws_of(situation):
            given = ParameterSet(law, values, Path(file.format(law=law))) if values else None
            for seed in seeds_of(situation, law, seeds):
                how = LawSpec(law, _ARITHMETIC, parameters=given)
                spec = RunSpec(scenario, settings, how, seed, bus="local", faults=faults)
                is_drawn = law in DRAWN and situation not in BESIDE and seed == seeds[0]
                yield Planned(key(situation, law, seed), spec, is_drawn, Coupled(_PORTS))


def _records(seeds: Sequence[int]) -> Iterator[Planned]:
    given = ParameterSet(_DRIVER, {_DITHER: _DITHER_MPS2}, Path("dither.toml"))
    for seed in seeds:
        law = LawSpec(_DRIVER, _ARITHMETIC, parameters=given)
        spec = RunSpec(SCENARIOS[NORMAL], law=law, seed=seed, bus="local")
        # Over the in-process bus: a network is trained on a log.
        yield Planned(record_key(seed), spec)


def _units(seeds: Sequence[int]) -> Iterator[Planned]:
    for kind, law, loop in UNITS:
        given = ParameterSet(law, {"loop": loop}, Path(f"mean_loop_{law}.toml")) if loop == "mean" else None
        for seed in seeds:
            spec = RunSpec(
                _UNITS_SCENARIO[kind], law=LawSpec(law, _ARITHMETIC, parameters=given), seed=seed, bus="local"
            )
            yield Planned(units_key(kind, law, loop, seed), spec, how=Coupled(_UNITS_PORTS))


def _efforts() -> Iterator[Planned]:
    for law in LAWS:
        yield Planned(effort_key(law), RunSpec(_SHORT, law=LawSpec(law, _COUNTED), bus="local"))


def measure(outcome: Outcome) -> dict[str, float | None]:
    """Scores; with mutations the RMSE inside them; of a run with dither the modelling errors; of one whose operations
    are counted the cycles."""
    found: dict[str, float | None] = dict(outcome.scores)
    if outcome.scenario.faults:
        found[WINDOWS] = windows_rmse_kmh(Ride.of(outcome.scenario, outcome.trace))
    if _DITHER in ((outcome.certificate.get("parameters") or {}).get("values") or {}):
        log = outcome.folder / "frames.log"
        record = Record(log, outcome.scenario, outcome.trace, "", dict(outcome.certificate))
        for period_s, error in learn(record, Recipe(), _PERIOD_S).errors.items():
            found[model_error("linear", period_s)] = error.linear_kmh
            found[model_error("integrated", period_s)] = error.integrated_kmh
    if outcome.certificate["arithmetic"] == _COUNTED:
        summary = read_summary(outcome.folder)
        found[CYCLES] = None if summary is None else float(summary.cycles)
    return found


def windows_rmse_kmh(ride: Ride) -> float | None:
    """RMSE of the speed inside the windows of the mutation, as far as the run is scored there; None: it is not."""
    time_s = ride.time_s
    inside = np.any([(time_s >= begin_s) & (time_s < begin_s + long_s) for begin_s, long_s in WINDOWS_S], axis=0)
    errors = ride.error_kmh[inside & ride.scored]
    return float(np.sqrt(np.mean(errors * errors))) if len(errors) else None


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
