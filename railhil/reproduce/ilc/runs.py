"""The protocol: sets of sequences, and the figures of a set; names of the sets and of their figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.plant_sim.stop.draws import drawn_run, drawn_train
from railhil.reproduce.experiments import SequenceRuns, SequenceSet, check_consecutive
from railhil.reproduce.ilc.memory_faults import MemoryFaults
from railhil.reproduce.paper import Entry, read_text
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

TEXT = read_text(__package__)
#: Runs of a sequence, and runs of one in which nothing is learned.
RUNS, FEW = 15, 3
#: Filters of table 3: the paper's, none, and others.
PACKET, NONE = "packet", "none"
FILTERS = (NONE, PACKET, "packet_8", "packet_newest", "packet_antireflect", "mean16", "fir65", "iir", "kalman")
#: Learning gains; 0: the rule max(1/j, 0.3).
GAMMA, GAMMAS = 0.5, (0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 0.0)
#: Tolerances of table 2 (m), and the cycles of the controller (ms).
EPSILON_M, EPSILONS_M = 0.4, (0.2, 0.4, 0.6, 0.8)
CYCLES_MS = (16, 48)
#: Standard deviations of the brake's gain from run to run.
SCATTERS = (0.001, 0.005, 0.01, 0.02)
#: A tolerance with two sides, without a fallback.
WINDOW = "window-0.1"
#: Sets whose memories are damaged.
MEMORY = "memory-faults"

#: The paper's law, and ours, on the train with scatter.
OPEN_FIXED, OPEN_LEARNED = "open-fixed", "open-learned"
REAIM, REAIM_BALISES, REAIM_OBSERVER = "reaim", "reaim-balises", "reaim-observer"
OURS_FIXED, OURS = "reaim-observer-balises", "reaim-learned"
NO_BALISES, LOSS_FIXED, LOSS, SLIDE = "reaim-no-balises-learned", "reaim-loss", "reaim-loss-learned", "reaim-slide"


def filter_key(name: str) -> str:
    """A filter, with the paper's gain and tolerance."""
    return f"filter-{name}"


#: The case of the paper's figure 6.
PAPER_CASE = filter_key(PACKET)


def gamma_key(gamma: float) -> str:
    """A learning gain."""
    return PAPER_CASE if gamma == GAMMA else f"gamma-{gamma:g}" if gamma else "gamma-rule"


def epsilon_key(epsilon_m: float, cycle_ms: int, *, learned: bool) -> str:
    """A tolerance of table 2."""
    if learned and epsilon_m == EPSILON_M and cycle_ms == CYCLES_MS[0]:
        return PAPER_CASE
    return f"eps-{'learned' if learned else 'fixed'}-{epsilon_m:g}-{cycle_ms}ms"


def scatter_key(sigma: float, filtered: str = PACKET) -> str:
    """A scatter of the brake's gain."""
    return f"scatter-{sigma:g}{'' if filtered == PACKET else f'-{filtered}'}"


#: Figures of some runs: title, unit, digits.
MEAN, RMS, P95, WITHIN_10, WITHIN_30 = "mean_error", "rms", "p95", "within_0.1", "within_0.3"
FIGURES: Mapping[str, tuple[str, str, int]] = {
    MEAN: ("mean error", "m", 3),
    RMS: ("rms", "m", 3),
    P95: ("95 % of the errors", "m", 3),
    WITHIN_10: ("within 0.1 m", "%", 0),
    WITHIN_30: ("within 0.3 m", "%", 0),
}
#: Runs until the first of three in a row within 0.3 m: median, and 90 % of the sequences.
CONVERGED, CONVERGED_P90 = "runs_median", "runs_p90"
#: Share of the runs that did not stop by themselves.
NOT_STOPPED = "not_stopped"


def of_run(figure: str, number: int) -> str:
    """A figure over all runs of one number."""
    return f"{figure}_of_run_{number}"


def of_last(figure: str) -> str:
    """A figure over the last third of the runs."""
    return f"{figure}_of_last"


def of_all(figure: str) -> str:
    """A figure over all runs."""
    return f"{figure}_of_all"


#: The same without the runs in which the wheels slid.
LAST_RMS_HELD = of_last("rms_without_slide")

_OWN, _OURS, _ARITHMETIC = "ilc_stop", "reaim", "float64"
_SCENARIO, _CLOSED = "yizhuang_stop", "yizhuang_stop_closed"
#: The laws' model equals the train, and the line is level.
_EXACT = ("task.true.delay_s=0.6", "task.true.lag_s=0.4", "task.true.gain=1", "task.grade=[[0, 0]]")
#: Parameters: the law's own; nothing is learned.
_USUAL: Mapping[str, Any] = {}
_FIXED: Mapping[str, Any] = {"learning": "none"}
#: Scatter of the delay in the entries with scatter.
_DELAY_SCATTER = "task.true.delay_run_sigma_s=0.02"
#: A sequence has converged at the first of so many runs in a row within the limit (m).
_CONVERGED_M, _IN_A_ROW = 0.3, 3


def plan(seeds: Sequence[int]) -> list[Entry]:
    """All sets.

    :raises InputError: the seeds do not follow each other.
    """
    check_consecutive(seeds)
    return [*_paper(seeds), *_closed(seeds), _memories(seeds)]


def _spec(scenario: str, law: str, settings: tuple[str, ...], values: Mapping[str, Any]) -> RunSpec:
    name = "_".join(f"{key}_{value}".lower() for key, value in values.items())
    given = ParameterSet(law, values, Path("parameters", f"{name}.toml")) if values else None
    return RunSpec(scenario, settings, LawSpec(law, _ARITHMETIC, parameters=given), perturbed=True, bus="local")


def _set(seeds: Sequence[int], key: str, spec: RunSpec, runs: int = RUNS) -> Entry:
    return Entry(key, spec, experiment=SequenceSet(seeds[0], len(seeds), runs))


def _paper(seeds: Sequence[int]) -> Iterator[Entry]:
    def one(key: str, *settings: str, runs: int = RUNS, values: Mapping[str, Any] = _USUAL) -> Entry:
        return _set(seeds, key, _spec(_SCENARIO, _OWN, settings, values), runs)

    for name in FILTERS:
        yield one(filter_key(name), values={} if name == PACKET else {"filter": name})
    for gamma in GAMMAS:
        if gamma != GAMMA:
            yield one(gamma_key(gamma), values={"gamma": gamma})
    for cycle_ms in CYCLES_MS:
        cycle = (f"timing.control_period_ms={cycle_ms}",) if cycle_ms != CYCLES_MS[0] else ()
        for epsilon_m in EPSILONS_M:
            given = {} if epsilon_m == EPSILON_M else {"epsilon_m": epsilon_m}
            if (key := epsilon_key(epsilon_m, cycle_ms, learned=True)) != PAPER_CASE:
                yield one(key, *cycle, values=given)
            fixed = epsilon_key(epsilon_m, cycle_ms, learned=False)
            yield one(fixed, *_EXACT, *cycle, runs=FEW, values={**given, **_FIXED})
    yield one(WINDOW, *_EXACT, runs=1, values={"epsilon_m": 0.1, "trigger": "window", **_FIXED})
    for sigma in SCATTERS:
        yield one(scatter_key(sigma), f"task.true.gain_run_sigma={sigma:g}", _DELAY_SCATTER)
    one_percent = "task.true.gain_run_sigma=0.01"
    yield one(scatter_key(0.01, NONE), one_percent, _DELAY_SCATTER, values={"filter": NONE})


def _closed(seeds: Sequence[int]) -> Iterator[Entry]:
    def one(key: str, scenario: str = _CLOSED, law: str = _OURS, runs: int = RUNS, **values: Any) -> Entry:
        return _set(seeds, key, _spec(scenario, law, (), values), runs)

    yield one(OPEN_FIXED, law=_OWN, runs=FEW, learning="none")
    yield one(OPEN_LEARNED, law=_OWN)
    yield one(REAIM, runs=FEW, learning=False, observer=False, balises=False)
    yield one(REAIM_BALISES, runs=FEW, learning=False, observer=False)
    yield one(REAIM_OBSERVER, runs=FEW, learning=False, balises=False)
    yield one(OURS_FIXED, runs=FEW, learning=False)
    yield one(OURS)
    yield one(NO_BALISES, "yizhuang_stop_no_balises")
    yield one(LOSS_FIXED, "yizhuang_stop_low_speed_loss", runs=FEW, learning=False)
    yield one(LOSS, "yizhuang_stop_low_speed_loss")
    yield one(SLIDE, "yizhuang_stop_slide")


def _memories(seeds: Sequence[int]) -> Entry:
    return Entry(MEMORY, _spec(_SCENARIO, _OWN, (), {}), experiment=MemoryFaults(seeds[0], len(seeds)))


def measure(outcome: Any) -> dict[str, float | None]:
    """Figures of a set: by the number of the run, over the last third, over all; of damaged memories their own."""
    if not isinstance(outcome, SequenceRuns):
        return dict(outcome)
    from railhil.batch.statistics import at_most
    from railhil.sequences.summary import runs_to_converge, spread, tail_runs

    errors = find_errors(outcome.runs)
    runs = errors.shape[1]
    last = errors[:, -tail_runs(runs) :]
    found: dict[str, float | None] = {}
    limits = (0.1, 0.3)

    def take(values: NDArray[np.float64], name: Any) -> None:
        made = spread(values, limits)
        shares = {f"within_{limit}": share for limit, share in made["within"].items()}
        found.update({name(figure): (made | shares)[figure] for figure in FIGURES})

    for number in range(1, runs + 1):
        take(errors[:, number - 1], lambda figure, number=number: of_run(figure, number))
    take(last, of_last)
    take(errors, of_all)
    needed = runs_to_converge(np.abs(errors), _CONVERGED_M, _IN_A_ROW)
    for name, q in ((CONVERGED, 0.5), (CONVERGED_P90, 0.9)):
        value = at_most(needed, q)
        found[name] = value if np.isfinite(value) else None
    found[NOT_STOPPED] = float(np.mean(np.isnan(errors)))
    held = np.where(_slides(outcome), np.nan, errors)[:, -tail_runs(runs) :]
    found[LAST_RMS_HELD] = spread(held, limits)["rms"]
    return found


def find_errors(runs: Sequence[Sequence[Any]]) -> NDArray[np.float64]:
    """True stop errors, m, overshoot positive; shape (sequences, runs), NaN where a train did not stop."""
    return np.array([[run.score.signed["stop_error_m"] for run in sequence] for sequence in runs], dtype=np.float64)


def _slides(outcome: SequenceRuns) -> NDArray[np.bool_]:
    """Runs with limited adhesion, shape (sequences, runs)."""
    scenario: Any = outcome.scenario
    task = scenario.task
    found = []
    for sequence in outcome.runs:
        train = drawn_train(task, sequence[0].spec.seed)
        found.append([drawn_run(task, train, run.spec.seed, run.spec.run_number).adhesion_mps2 > 0 for run in sequence])
    return np.array(found)
