"""The protocol: sets of sequences, and the figures of a set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.plant_sim.stopping.draws import drawn_run, drawn_train
from railhil.reproduce.ilc import names
from railhil.reproduce.ilc.faults import MemoryFaults
from railhil.reproduce.ilc.names import CYCLES_MS, EPSILONS_M, FEW, RUNS, epsilon_key, filter_key, gamma_key, of_all
from railhil.reproduce.learned import MadeSequences, Sequences, check_consecutive
from railhil.reproduce.paper import Planned
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

_OWN, _OURS, _ARITHMETIC = "ilc_stop", "reaim", "float64"
_SCENARIO, _CLOSED = "yizhuang_stop", "yizhuang_stop_closed"
#: The laws' model is that of the train, and the line is level.
_EXACT = ("task.true.delay_s=0.6", "task.true.lag_s=0.4", "task.true.gain=1", "task.grade=[[0, 0]]")
#: Parameters: the law's own; nothing is learned.
_USUAL: Mapping[str, Any] = {}
_FIXED: Mapping[str, Any] = {"learning": "none"}
#: What the entries with scatter have beside it.
_DELAY_SCATTER = "task.true.delay_run_sigma_s=0.02"
#: A sequence has converged at the first of so many runs in a row within the limit (m).
_CONVERGED_M, _IN_A_ROW = 0.3, 3

PROTOCOL = (
    "Train, brake, sensors and scatter of the scenarios yizhuang_stop and, for a train with scatter, "
    "yizhuang_stop_closed: the paper prints none of these values (its table 1 is lost); all are chosen, and listed by "
    "`railhil scenarios yizhuang_stop`.",
    "Each entry is a set of sequences with one sequence for each seed, 15 runs each, or 3 where nothing is learned. A "
    "sequence begins without a memory, and each of its runs with what the last one has left. Errors are those of the "
    "true stop; the law reads what the mark balise has measured.",
    "The paper's law is ilc_stop, with gain 0.5, tolerance 0.4 m and a one-sided trigger; ours is reaim; both in "
    "float64. What differs is in the command beside each entry and in its parameter file, which stands beside this "
    "page.",
    "Converged: the first of three runs in a row within 0.3 m. After learning: the last 5 of 15 runs.",
    "The seeds are those that `railhil learn` takes by default.",
)


def planned(seeds: Sequence[int]) -> list[Planned]:
    """All sets.

    :raises InputError: the seeds do not follow each other.
    """
    check_consecutive(seeds)
    return [*_paper(seeds), *_closed(seeds), _memories(seeds)]


def _spec(scenario: str, law: str, settings: tuple[str, ...], values: Mapping[str, Any]) -> RunSpec:
    name = "_".join(f"{key}_{value}".lower() for key, value in values.items())
    given = ParameterSet(law, values, Path("parameters", f"{name}.toml")) if values else None
    return RunSpec(scenario, settings, LawSpec(law, _ARITHMETIC, parameters=given), perturbed=True, bus="local")


def _set(seeds: Sequence[int], key: str, spec: RunSpec, runs: int = RUNS) -> Planned:
    return Planned(key, spec, how=Sequences(seeds[0], len(seeds), runs))


def _paper(seeds: Sequence[int]) -> Iterator[Planned]:
    def one(key: str, *settings: str, runs: int = RUNS, values: Mapping[str, Any] = _USUAL) -> Planned:
        return _set(seeds, key, _spec(_SCENARIO, _OWN, settings, values), runs)

    for name in names.FILTERS:
        yield one(filter_key(name), values={} if name == names.PACKET else {"filter": name})
    for gamma in names.GAMMAS:
        if gamma != names.GAMMA:
            yield one(gamma_key(gamma), values={"gamma": gamma})
    for cycle_ms in CYCLES_MS:
        cycle = (f"timing.control_period_ms={cycle_ms}",) if cycle_ms != CYCLES_MS[0] else ()
        for epsilon_m in EPSILONS_M:
            given = {} if epsilon_m == names.EPSILON_M else {"epsilon_m": epsilon_m}
            if (key := epsilon_key(epsilon_m, cycle_ms, learned=True)) != names.PAPER_CASE:
                yield one(key, *cycle, values=given)
            fixed = epsilon_key(epsilon_m, cycle_ms, learned=False)
            yield one(fixed, *_EXACT, *cycle, runs=FEW, values={**given, **_FIXED})
    yield one(names.WINDOW, *_EXACT, runs=1, values={"epsilon_m": 0.1, "trigger": "window", **_FIXED})
    for sigma in names.SCATTERS:
        yield one(names.scatter_key(sigma), f"task.true.gain_run_sigma={sigma:g}", _DELAY_SCATTER)
    one_percent = "task.true.gain_run_sigma=0.01"
    yield one(names.scatter_key(0.01, names.NONE), one_percent, _DELAY_SCATTER, values={"filter": names.NONE})


def _closed(seeds: Sequence[int]) -> Iterator[Planned]:
    def one(key: str, scenario: str = _CLOSED, law: str = _OURS, runs: int = RUNS, **values: Any) -> Planned:
        return _set(seeds, key, _spec(scenario, law, (), values), runs)

    yield one(names.OPEN_FIXED, law=_OWN, runs=FEW, learning="none")
    yield one(names.OPEN_LEARNED, law=_OWN)
    yield one(names.REAIM, runs=FEW, learning=False, observer=False, balises=False)
    yield one(names.REAIM_BALISES, runs=FEW, learning=False, observer=False)
    yield one(names.REAIM_OBSERVER, runs=FEW, learning=False, balises=False)
    yield one(names.OURS_FIXED, runs=FEW, learning=False)
    yield one(names.OURS)
    yield one(names.NO_BALISES, "yizhuang_stop_no_balises")
    yield one(names.LOSS_FIXED, "yizhuang_stop_low_speed_loss", runs=FEW, learning=False)
    yield one(names.LOSS, "yizhuang_stop_low_speed_loss")
    yield one(names.SLIDE, "yizhuang_stop_slide")


def _memories(seeds: Sequence[int]) -> Planned:
    return Planned(names.MEMORY, _spec(_SCENARIO, _OWN, (), {}), how=MemoryFaults(seeds[0], len(seeds)))


def measure(outcome: Any) -> dict[str, float | None]:
    """Figures of a set: by the number of the run, over the last third, over all; of damaged memories their own."""
    if not isinstance(outcome, MadeSequences):
        return dict(outcome)
    from railhil.batch.statistics import at_most
    from railhil.sequences.summary import runs_to_converge, spread, tail_runs

    errors = errors_of(outcome.runs)
    runs = errors.shape[1]
    last = errors[:, -tail_runs(runs) :]
    found: dict[str, float | None] = {}
    limits = (0.1, 0.3)

    def take(values: NDArray[np.float64], name: Any) -> None:
        made = spread(values, limits)
        shares = {f"within_{limit}": share for limit, share in made["within"].items()}
        found.update({name(figure): (made | shares)[figure] for figure in names.FIGURES})

    for number in range(1, runs + 1):
        take(errors[:, number - 1], lambda figure, number=number: names.of_run(figure, number))
    take(last, names.of_last)
    take(errors, of_all)
    needed = runs_to_converge(np.abs(errors), _CONVERGED_M, _IN_A_ROW)
    for name, q in ((names.CONVERGED, 0.5), (names.CONVERGED_P90, 0.9)):
        value = at_most(needed, q)
        found[name] = value if np.isfinite(value) else None
    found[names.NOT_STOPPED] = float(np.mean(np.isnan(errors)))
    held = np.where(_slides(outcome), np.nan, errors)[:, -tail_runs(runs) :]
    found[names.LAST_RMS_HELD] = spread(held, limits)["rms"]
    return found


def errors_of(runs: Sequence[Sequence[Any]]) -> NDArray[np.float64]:
    """True stop errors, m, overshoot positive; shape (sequences, runs), NaN where a train did not stop."""
    return np.array([[run.score.signed["stop_error_m"] for run in sequence] for sequence in runs], dtype=np.float64)


def _slides(outcome: MadeSequences) -> NDArray[np.bool_]:
    """Runs with limited adhesion, shape (sequences, runs)."""
    scenario: Any = outcome.scenario
    task = scenario.task
    found = []
    for sequence in outcome.runs:
        train = drawn_train(task, sequence[0].spec.seed)
        found.append([drawn_run(task, train, run.spec.seed, run.spec.run_number).adhesion_mps2 > 0 for run in sequence])
    return np.array(found)
