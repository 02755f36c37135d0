"""The protocol: sets of sequences, and the figures of a set; names of the sets and of their figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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

TEXT = read_text("ilc")
#: Runs of a sequence in which something is learned.
RUNS = 15
#: The case of the paper's figure 6, and the same without a filter.
PAPER_CASE, NO_FILTER = "filter-packet", "filter-none"
#: Sets whose memories are damaged.
MEMORY = "memory-faults"

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


def name_run_figure(figure: str, number: int) -> str:
    """A figure over all runs of one number."""
    return f"{figure}_of_run_{number}"


def name_last_figure(figure: str) -> str:
    """A figure over the last third of the runs."""
    return f"{figure}_of_last"


def name_whole_figure(figure: str) -> str:
    """A figure over all runs."""
    return f"{figure}_of_all"


#: The same without the runs in which the wheels slid.
LAST_RMS_HELD = name_last_figure("rms_without_slide")

#: A sequence has converged at the first of so many runs in a row within the limit (m).
_CONVERGED_M, _IN_A_ROW = 0.3, 3


def plan(seeds: Sequence[int]) -> list[Entry]:
    """All sets.

    :raises InputError: the seeds do not follow each other.
    """
    check_consecutive(seeds)
    first, count = seeds[0], len(seeds)
    made = [
        Entry(key, _make_spec(one), experiment=SequenceSet(first, count, one.get("runs", RUNS)))
        for key, one in TEXT.sets["entries"].items()
    ]
    return [*made, Entry(MEMORY, _make_spec({}), experiment=MemoryFaults(first, count))]


def is_learned(key: str) -> bool:
    """Whether something is learned in a set; its figures are then those of the last runs."""
    return "runs" not in TEXT.sets["entries"][key]


def _make_spec(one: Mapping[str, Any]) -> RunSpec:
    """Any run of a set."""
    values, law = one.get("parameters", {}), one.get("law", "ilc_stop")
    name = "_".join(f"{key}_{value}".lower() for key, value in values.items())
    given = ParameterSet(law, values, Path("parameters", f"{name}.toml")) if values else None
    shared = [setting for name in one.get("shared", ()) for setting in TEXT.sets["settings"][name]]
    settings = (*shared, *one.get("settings", ()))
    how = LawSpec(law, "float64", parameters=given)
    return RunSpec(one.get("scenario", "yizhuang_stop"), settings, how, perturbed=True, bus="local")


def measure(outcome: SequenceRuns) -> dict[str, float | None]:
    """Figures of a set: by the number of the run, over the last third, over all; of damaged memories their own."""
    if outcome.figures is not None:
        return dict(outcome.figures)
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
        take(errors[:, number - 1], lambda figure, number=number: name_run_figure(figure, number))
    take(last, name_last_figure)
    take(errors, name_whole_figure)
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
