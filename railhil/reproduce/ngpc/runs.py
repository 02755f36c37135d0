"""The protocol: every law in three situations and in others beside the papers, records that test the models, runs with
three power units, and short runs that count operations; the figures of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from railhil.controller_node.high_speed.training import Recipe
from railhil.judge.record import Record
from railhil.learning.models import train_models
from railhil.library import Outcome
from railhil.record.telemetry import read_summary
from railhil.reproduce.experiments import SingleRun
from railhil.reproduce.paper import Entry, read_text
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.high_speed.ride import Ride
from railhil.wire.power_units import wire

TEXT = read_text("ngpc")
#: The law of the paper with one unit, its comparators, the baselines for a law with a network, and the best of
#: railhil's own.
ELM, BP, MULTI_MODEL, ADAPTIVE = "elm_ngpc", "bp_ngpc", "mm_gpc", "a_gpc"
LAWS = (ELM, BP, MULTI_MODEL, ADAPTIVE, "pid", "pid_ff", "gpc", "res_ngpc", "os_elm_ngpc", "delay_gpc")
PID, RESIDUAL, DELAY = "pid", "res_ngpc", "delay_gpc"
#: Laws that make the long journeys with every seed; the others make them with the first one.
MAIN = (ELM, MULTI_MODEL, ADAPTIVE, PID, RESIDUAL, DELAY)
#: Laws that the figures show.
DRAWN = (ELM, MULTI_MODEL, ADAPTIVE)
#: Situations that findings name: of the paper with one unit; without gradient and wind.
NORMAL, EMERGENCY, MUTATION, CALM = "normal", "emergency", "mutation", "calm"
#: RMSE over the run, in emergency braking, and inside the windows of a mutation; largest error, emergency stop.
WHOLE, BRAKING, WINDOWS = "rmse_kmh", "emergency_rmse_kmh", "windows_rmse_kmh"
WIDEST, STOP_M = "max_error_kmh", "emergency_stop_m"
#: Figures of three units.
UNITS_RMSE, SPREAD, COUPLER_KN = "units_rmse_kmh", "spread_kmh", "coupler_peak_kn"
#: Estimated cycles of the target processor for one control period.
CYCLES = "cycles"
#: Sampling periods of the modelling error, s.
PERIODS_S = (0.5, 1.0, 2.0, 4.0)
#: Begin and duration of the mutations of jinan_xuzhou_mutation, s. The other situations have theirs at the same times.
WINDOWS_S = ((1030, 80), (2800, 90), (3590, 85))


#: Journeys by situation.
SITUATIONS = TEXT.sets
#: Three power units: free or coupled, law, one loop for each unit or one for all.
UNITS = (
    ("free", PID, "unit"),
    ("free", ELM, "unit"),
    ("coupled", PID, "unit"),
    ("coupled", PID, "mean"),
    ("coupled", ELM, "unit"),
    ("coupled", ELM, "mean"),
)
_UNITS_SCENARIO: Mapping[str, str] = {"free": "jinan_xuzhou_emu3", "coupled": "jinan_xuzhou_emu3_coupled"}
#: The first two minutes, in an arithmetic whose operations are counted.
_SHORT, _COUNTED = "hst_short", "float32"
#: The papers simulate on a computer.
_ARITHMETIC = "float64"
#: This law with a square wave of 0.05 m/s2 drives the runs whose records test models (reading D14).
_DRIVER, _DITHER, _DITHER_MPS2 = PID, "dither_mps2", 0.05
#: Sampling period of the laws, s; points of a drawn curve are one of these apart.
PERIOD_S = 1.0
#: Ports of the plant that the scores are computed from.
_PORTS, _UNITS_PORTS = (wire(1).truth.PORT,), (wire(3).truth.PORT,)


def name_run(situation: str, law: str, seed: int) -> str:
    """Name of a run."""
    return f"{situation}-{law}-{seed}"


def list_laws(situation: str) -> Sequence[str]:
    """Laws that make the journeys of a situation."""
    found: Sequence[str] = SITUATIONS[situation].get("laws", LAWS)
    return found


def list_runs(situation: str, law: str, seeds: Sequence[int]) -> list[str]:
    """Names of the runs of a law in a situation."""
    once = situation in (NORMAL, MUTATION) and law not in MAIN
    return [name_run(situation, law, seed) for seed in (seeds[:1] if once else seeds)]


def name_units_run(kind: str, law: str, loop: str, seed: int) -> str:
    """Name of a run with three units; kind: ``free`` or ``coupled``, loop: ``unit`` or ``mean``."""
    return f"units-{kind}-{law}-{loop}-{seed}"


def name_record(seed: int) -> str:
    """Name of the run whose record tests the models."""
    return f"record-{seed}"


def name_effort_run(law: str) -> str:
    """Name of the run whose operations are counted."""
    return f"effort-{law}"


def name_model_error(kind: str, period_s: float) -> str:
    """Name of a modelling error; kind: ``linear`` or ``integrated``."""
    return f"{kind}_{period_s:g}s_kmh"


def plan(seeds: Sequence[int]) -> list[Entry]:
    """All runs."""
    return [*_tracking(seeds), *_records(seeds[:1]), *_units(seeds), *_efforts()]


def _tracking(seeds: Sequence[int]) -> Iterator[Entry]:
    for name, one in SITUATIONS.items():
        faults = tuple(f"{one['fault']} @{at}s for {s}s" for at, s in WINDOWS_S) if "fault" in one else ()
        for law in list_laws(name):
            file = Path(one.get("file", "").format(law=law))
            given = ParameterSet(law, one["parameters"], file) if "parameters" in one else None
            how = LawSpec(law, _ARITHMETIC, parameters=given)
            for entry, seed in zip(list_runs(name, law, seeds), seeds, strict=False):
                settings = tuple(one.get("settings", ()))
                spec = RunSpec(one["scenario"], settings, how, seed, bus="local", faults=faults)
                is_drawn = law in DRAWN and name in (NORMAL, EMERGENCY, MUTATION) and seed == seeds[0]
                yield Entry(entry, spec, is_drawn, SingleRun(_PORTS))


def _records(seeds: Sequence[int]) -> Iterator[Entry]:
    given = ParameterSet(_DRIVER, {_DITHER: _DITHER_MPS2}, Path("dither.toml"))
    for seed in seeds:
        law = LawSpec(_DRIVER, _ARITHMETIC, parameters=given)
        # Over the in-process bus: a network is trained on a log.
        yield Entry(name_record(seed), RunSpec(SITUATIONS[NORMAL]["scenario"], law=law, seed=seed, bus="local"))


def _units(seeds: Sequence[int]) -> Iterator[Entry]:
    for kind, law, loop in UNITS:
        given = ParameterSet(law, {"loop": loop}, Path(f"mean_loop_{law}.toml")) if loop == "mean" else None
        how = LawSpec(law, _ARITHMETIC, parameters=given)
        for seed in seeds:
            spec = RunSpec(_UNITS_SCENARIO[kind], law=how, seed=seed, bus="local")
            yield Entry(name_units_run(kind, law, loop, seed), spec, experiment=SingleRun(_UNITS_PORTS))


def _efforts() -> Iterator[Entry]:
    for law in LAWS:
        yield Entry(name_effort_run(law), RunSpec(_SHORT, law=LawSpec(law, _COUNTED), bus="local"))


def measure(outcome: Outcome) -> dict[str, float | None]:
    """Scores; with mutations the RMSE inside them; of a run with dither the modelling errors; of one whose operations
    are counted the cycles."""
    found: dict[str, float | None] = dict(outcome.scores)
    if outcome.scenario.faults:
        found[WINDOWS] = compute_windows_rmse_kmh(Ride.of(outcome.scenario, outcome.trace))
    if _DITHER in ((outcome.certificate.get("parameters") or {}).get("values") or {}):
        log = outcome.folder / "frames.log"
        record = Record(log, outcome.scenario, outcome.trace, "", dict(outcome.certificate))
        for period_s, error in train_models(record, Recipe(), PERIOD_S).errors.items():
            found[name_model_error("linear", period_s)] = error.linear_kmh
            found[name_model_error("integrated", period_s)] = error.integrated_kmh
    if outcome.certificate["arithmetic"] == _COUNTED:
        summary = read_summary(outcome.folder)
        found[CYCLES] = None if summary is None else float(summary.cycles)
    return found


def compute_windows_rmse_kmh(ride: Ride) -> float | None:
    """RMSE of the speed inside the windows of the mutation, in the part of the run that is scored; None: no part is."""
    time_s = ride.time_s
    inside = np.any([(time_s >= begin_s) & (time_s < begin_s + long_s) for begin_s, long_s in WINDOWS_S], axis=0)
    errors = ride.error_kmh[inside & ride.scored]
    return float(np.sqrt(np.mean(errors * errors))) if len(errors) else None


def curves(outcome: Outcome) -> Ride:
    """The ride, of which speed and error are drawn over distance."""
    return Ride.of(outcome.scenario, outcome.trace)
