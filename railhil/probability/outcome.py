"""``railhil.probability``: the probability of a violation as a function, and its result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from railhil.charts.notebook import html_cell, html_paragraph
from railhil.common.command_line import USUAL_SCENARIO
from railhil.common.digits import count_of
from railhil.common.extras import need
from railhil.common.library_call import FILES, JOBS, PATH, PATH_OR_NONE, SETTINGS, TEXT, library_call
from railhil.probability.plan import LEAST
from railhil.run.spec import Files, Settings, requirement_names, settings_of
from railhil.scenarios.load import stable_name


@dataclass(frozen=True, slots=True)
class LeastDisturbance:
    """The violating run with the least draws that was found.

    ``file``: the scenario that repeats it. ``size``: length of the vector of draws, in standard deviations. ``draws``:
    by name, in standard deviations. ``noise``: seed and coefficient of each stream. ``frames_sha256``: of its run.
    """

    file: Path
    size: float
    draws: Mapping[str, float]
    noise: tuple[tuple[int, float], ...]
    frames_sha256: str


@dataclass(frozen=True)
class ProbabilityOutcome:
    """A finished study of a probability: ``summary`` is the content of its ``summary.json``, ``lines`` what the command
    prints, ``draw_names`` the draws of a run in their order, None where the scenario does not draw."""

    folder: Path
    summary: Mapping[str, Any]
    lines: tuple[str, ...]
    draw_names: tuple[str | None, ...]

    @property
    def p(self) -> float:
        """The probability that a run violates the requirement; 0: no run has."""
        return float(self.summary["p"])

    @property
    def low(self) -> float | None:
        """Lower end of the 95 % interval; None: there is none, as where a repetition has found nothing."""
        return _number(self.summary["low"])

    @property
    def high(self) -> float | None:
        """Upper end of the interval, as :attr:`low`."""
        return _number(self.summary["high"])

    @property
    def is_resolved(self) -> bool:
        """Whether the wanted accuracy is met."""
        return bool(self.summary["is_resolved"])

    @property
    def unresolved_below(self) -> float:
        """About the least probability that the runs could have shown."""
        return float(self.summary["unresolved_below"])

    @property
    def runs(self) -> int:
        """Runs that were made."""
        return int(self.summary["runs"])

    @property
    def repetitions(self) -> tuple[float, ...]:
        """The estimates of the repetitions, of which :attr:`p` is the mean; empty: runs were counted."""
        return tuple(self.summary["repetitions"])

    @cached_property
    def causes(self) -> Mapping[str, float]:
        """Share of each draw, and of the ``noise`` (if known), in the variance of the margin, the largest first."""
        found = self.summary["causes"]
        shares = {name: float(one["share"]) for name, one in found["draws"].items()}
        shares |= {} if found["noise"] is None else {"noise": float(found["noise"])}
        return dict(sorted(shares.items(), key=lambda item: -item[1]))

    @cached_property
    def least(self) -> LeastDisturbance | None:
        """The least disturbance; None: no run has violated the requirement."""
        found = self.summary["least"]
        if found is None:
            return None
        draws = {name: draw for name, draw in zip(self.draw_names, found["draws"], strict=True) if name is not None}
        noise = tuple((int(seed), float(coefficient)) for seed, coefficient in found["noise"])
        return LeastDisturbance(self.folder / LEAST, float(found["size"]), draws, noise, found["sha256"])

    def __repr__(self) -> str:
        interval = "no interval" if self.low is None else f"[{self.low:.2g}, {self.high:.2g}]"
        runs = count_of(self.runs, "run", spec=",")
        says = self.summary["requirement"]["says"]
        return f'<P(not "{says}") = {self.p:.2g} {interval}; {self.summary["scenario"]}, {runs}; {self.folder}>'

    def _repr_html_(self) -> str:
        return html_cell(*map(html_paragraph, self.lines))


def _number(value: float | None) -> float | None:
    return None if value is None else float(value)


@library_call(
    "railhil.probability",
    {
        "scenario": PATH,
        "says": TEXT,
        "requirement": TEXT,
        "requirements": FILES,
        "parameters": PATH_OR_NONE,
        "settings": SETTINGS,
        "jobs": JOBS,
        "out": PATH_OR_NONE,
    },
    {"--set": "settings"},
)
def probability(
    scenario: str | Path = USUAL_SCENARIO,
    *,
    says: str = "",
    requirement: str = "",
    requirements: Files = (),
    controller: str | None = None,
    arithmetic: str | None = None,
    parameters: str | Path | None = None,
    settings: Settings = (),
    accuracy: float = 0.3,
    max_runs: int = 1_000_000,
    points: int = 1000,
    method: str = "auto",
    seed: int = 0,
    jobs: int = 1,
    out: str | Path | None = None,
) -> ProbabilityOutcome:
    """The probability that a run with drawn perturbations violates a requirement (needs the extra ``campaign``).

    It is over the draws of ``[perturbations]``, of faults and of the noise: a statement about the model.

    :param scenario: shipped name, or path of a TOML file.
    :param says: the requirement as a sentence; or
    :param requirement: its id, of the scenario, of ``requirements``, or of the file that its system ships.
    :param requirements: files of sentences, or names of systems that ship one.
    :param controller: name of a law; None: that of ``parameters``, or else the usual one of the scenario's system.
    :param arithmetic: of the law; None: the usual one.
    :param parameters: of the law, from a file.
    :param settings: keys of the scenario with other values: a mapping, or texts ``KEY=VALUE``.
    :param accuracy: half the width of the wanted interval, as a share of P.
    :param max_runs: at most so many runs.
    :param points: runs of each level of a repetition.
    :param method: ``subset``, ``brute``, or ``auto``: that with fewer runs.
    :param seed: of the draws.
    :param jobs: processes; -1: one per core. A script that begins this when it is imported must not do so again in
        them (``if __name__ == "__main__"``).
    :param out: its folder (default ``runs/<utc>-<scenario>-probability``); an incomplete study is resumed.
    :raises InputError: anything that is not allowed, in one line.
    """
    need("pyarrow", "campaign")
    from railhil.probability.plan import Request, find_making
    from railhil.probability.show import lines
    from railhil.probability.study import PROBABILITY
    from railhil.study.call import make_study

    request = Request(
        scenario=stable_name(str(scenario)),
        settings=settings_of(settings),
        requirements=requirement_names(requirements),
        requirement=requirement,
        says=says,
        controller=controller or "",
        arithmetic=arithmetic or "",
        parameters="" if parameters is None else str(Path(parameters).resolve()),
        accuracy=accuracy,
        max_runs=max_runs,
        points=points,
        method=method,
        seed=seed,
    )
    plan, made = make_study(PROBABILITY, request, jobs, out, how=find_making)
    return ProbabilityOutcome(
        made.folder, made.summary, tuple(lines(plan, made.summary, made.folder)), plan.state.all_names
    )
