"""The bench as a library: ``railhil.run``, ``railhil.open_run``, ``railhil.campaign`` and their results.

The functions work like the commands: the same folders, hashes and verdicts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from railhil.charts.notebook import html_cell, html_paragraph, html_table, text_table
from railhil.common.command_line import RATE, RATE_MAX, RATE_MIN, USUAL_SCENARIO
from railhil.common.errors import InputError, Sentence, Words, did_you_mean
from railhil.common.library_call import (
    FILES,
    JOBS,
    PATH,
    PATH_OR_NONE,
    SETTINGS,
    TEXTS,
    Kind,
    are_paths,
    is_path,
    library_call,
)
from railhil.judge.criteria import Criterion
from railhil.judge.events.event import RecordedEvent
from railhil.judge.judging import Judging
from railhil.judge.notebook import chart_html
from railhil.judge.record import Record, checked_record
from railhil.judge.signals import Signals
from railhil.record.hash_list import check_hash_list
from railhil.report.recorded import check_one_scenario, distinct_labels
from railhil.report.tables import better_sentence, rows
from railhil.run.make import NeverBegan, record_run
from railhil.run.report import as_recorded
from railhil.run.spec import (
    Files,
    Laws,
    Parameters,
    Settings,
    Texts,
    brought_controller,
    bus_of,
    checked_spec,
    named_laws,
    settings_of,
    spec_of,
    with_requirements,
)
from railhil.scenarios.given import GivenController, NamedCode
from railhil.scenarios.load import stable_name
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import RunSpec, StartUp

__all__ = [
    "CampaignOutcome",
    "Comparison",
    "NeverBegan",
    "Outcome",
    "RecordedEvent",
    "Signals",
    "campaign",
    "compare",
    "open_run",
    "run",
]


#: One recorded run, as this library calls it.
Outcome = Record

#: Arguments by their options or keys, where the names differ.
_NAMES = {"--set": "settings", "--fault": "faults"}


def _is_controller(value: Any) -> bool:
    is_given = value is None or is_path(value) or isinstance(value, GivenController)
    return is_given or callable(value) or hasattr(value, "step")


def _is_run(value: Any) -> bool:
    return is_path(value) or isinstance(value, Record)


@library_call(
    "railhil.run",
    {
        "scenario": Kind("a name, a path or a RunSpec", lambda value: is_path(value) or isinstance(value, RunSpec)),
        "controller": Kind("the name of a law, FILE:NAME, a function or an object with step", _is_controller),
        "parameters": Kind(
            "a file or values by name",
            lambda value: value is None or is_path(value) or isinstance(value, ParameterSet | Mapping),
        ),
        "settings": SETTINGS,
        "faults": TEXTS,
        "requirements": FILES,
        "rate": Kind(
            f"a number from {RATE_MIN:g} to {RATE_MAX:g}",
            lambda value: isinstance(value, int | float) and RATE_MIN <= value <= RATE_MAX,
        ),
        "bus": Kind("a text", lambda value: isinstance(value, str)),
        "memory": PATH_OR_NONE,
        "no_controller": Kind("True or False", lambda value: isinstance(value, bool)),
        "out": PATH_OR_NONE,
    },
    {**_NAMES, "memory_store": "memory"},
)
def run(
    scenario: str | Path | RunSpec = USUAL_SCENARIO,
    *,
    controller: str | Path | object | None = None,
    arithmetic: str | None = None,
    indexing: str = "time",
    parameters: Parameters | None = None,
    settings: Settings = (),
    faults: Texts = (),
    seed: int = 0,
    perturbed: bool = False,
    run_number: int = 1,
    pace: str = "lockstep",
    rate: float = RATE,
    bus: str = "local",
    memory: str | Path | None = None,
    requirements: Files = (),
    no_controller: bool = False,
    out: str | Path | None = None,
) -> Outcome:
    """Make one run, record and score it.

    :param scenario: shipped name, path of a TOML file, or a ``RunSpec``, in which case only ``bus``, ``no_controller``,
        ``out`` and a ``controller`` that is no law are used.
    :param controller: name of a law, or a controller of your own: a function, object or class, or its text such as
        ``mine.py:step``; None: the usual law of the scenario's system.
    :param arithmetic: of the law; None: the usual one of the scenario's system.
    :param indexing: set-points over ``time`` or ``distance``.
    :param parameters: of the law: a file, or values by name; None: the law's own.
    :param settings: keys of the scenario with other values: a mapping, or texts ``KEY=VALUE``.
    :param faults: faults besides the scenario's own, one text or several.
    :param seed: of noise and perturbations.
    :param perturbed: the seed draws the perturbations of the scenario.
    :param pace: ``lockstep`` or ``realtime``.
    :param rate: simulated seconds per second in real time.
    :param run_number: of the run in the sequence of its seed, for systems whose runs have numbers.
    :param bus: ``local``: all nodes in this process; ``auto``: three processes over the bus that ``railhil run`` would
        choose; ``hub``: over a hub of the run's own; ``INTERFACE:CHANNEL[@BITRATE]`` of python-can, such as
        ``socketcan:can0``. A ``RunSpec`` has its own unless this is one of the last two.
    :param memory: folder with the law's memory from run to run: read at the beginning, updated after a valid run.
    :param requirements: files of sentences that judge the run, or names of systems.
    :param no_controller: the controller is a board or another program on the bus.
    :param out: the run folder (default ``runs/<utc>-<scenario>-<controller>``).
    :raises InputError: anything that is not allowed, in one line.
    :raises NeverBegan: the nodes refused the run, or no frame came.
    """
    if rate != RATE and pace == "lockstep":
        raise InputError("railhil.run", "rate", rate, Sentence("used only in a run with pace realtime"))
    kind, can = bus_of(bus, "railhil.run")
    if isinstance(scenario, RunSpec):
        spec = scenario if kind == bus else replace(scenario, bus=kind)
        if (brought := brought_controller(controller)) is not None:
            spec = spec.with_code(NamedCode(spec.plant_fmu, brought))
    else:
        spec = spec_of(
            scenario, controller=controller, arithmetic=arithmetic, indexing=indexing, parameters=parameters,
            settings=settings, faults=faults, seed=seed, perturbed=perturbed, pace=pace, rate=rate, bus=kind,
            memory=memory, run_number=run_number,
        )  # fmt: skip
    spec, loaded = checked_spec(spec)
    if no_controller and spec.is_local:
        found, allowed = Words("a run in this process"), Sentence("used only in a run over a bus")
        raise InputError("railhil.run", "no_controller", found, allowed)
    spec = with_requirements(replace(spec, can=can, start_up=StartUp(foreign=no_controller), out=out), requirements)
    result = record_run(spec, scenario=loaded)
    if result.stopped_exit_code:
        raise KeyboardInterrupt(result.line)
    return as_recorded(result)


@library_call("railhil.open_run", {"folder": PATH})
def open_run(folder: str | Path) -> Outcome:
    """A run from its folder, judged again from the log alone; also from version 0.1.0 or from another machine.

    :param folder: run folder, or the log in it.
    :raises InputError: there is no record, or its parts do not belong together.
    """
    return checked_record(str(folder), None)


@dataclass(frozen=True)
class Comparison:
    """Runs of one scenario beside each other, each with its label."""

    runs: tuple[Outcome, ...]

    @property
    def criteria(self) -> tuple[Criterion, ...]:
        """The criteria by which the runs are judged."""
        return self.runs[0].judging.criteria

    def to_pandas(self) -> Any:
        """Scores without sign and verdicts as a ``pandas.DataFrame``, a row for each label.

        :raises ModuleNotFoundError: pandas is not installed.
        """
        import pandas

        rows = [{**run.scores, "verdict": run.verdict} for run in self.runs]
        return pandas.DataFrame(rows, index=pandas.Index([run.label for run in self.runs], name="run"))

    def __repr__(self) -> str:
        return text_table(self.runs[0].scenario.name, self._heads, self._rows())

    def _repr_html_(self) -> str:
        numbers = range(2, 2 + len(self.criteria))
        table = html_table(self.runs[0].scenario.name, self._heads, self._rows(), numbers)
        return html_cell(table, html_paragraph(better_sentence(self.criteria)), chart_html(self.runs))

    @property
    def _heads(self) -> list[str]:
        """Heads of the columns; ``absolute`` where the table leaves out a sign that the score has."""
        titles = (f"{'absolute ' if one.signed else ''}{one.title}" for one in self.criteria)
        return [
            "run",
            "verdict",
            *(f"{title} ({one.unit_typeset})" for title, one in zip(titles, self.criteria, strict=True)),
        ]

    def _rows(self) -> list[list[str]]:
        """The runs, and the published scores of laws that are not among them; a missed limit has a cross."""
        found = []
        for row in rows(self.runs[0].scenario, self.criteria, self.runs):
            values = [f"{'✗ ' * cell.missed}{cell.measured or cell.published}" for cell in row.cells]
            found.append([row.label if row.verdict else f"{row.label} (published)", row.verdict, *values])
        return found


def _are_runs(value: Any) -> bool:
    return _is_run(value) or (isinstance(value, Iterable) and not isinstance(value, Mapping | Set))


@library_call("railhil.compare", {"runs": Kind("a run, a run folder or a list of them", _are_runs)})
def compare(runs: Outcome | str | Path | Iterable[Outcome | str | Path]) -> Comparison:
    """Runs of one scenario beside each other, as in the report of ``railhil compare``.

    :param runs: results of :func:`run` or :func:`open_run`, or run folders; one or several.
    :raises InputError: there is none, a folder has no record, or two are of different scenarios.
    """
    several = [runs] if isinstance(runs, str | Path | Record) else list(runs)
    if not several:
        raise InputError("railhil.compare", "runs", Words("empty"), "one run or several")
    for place, one in enumerate(several):
        if not _is_run(one):
            raise InputError("railhil.compare", f"runs[{place}]", one, "a run or a run folder")
    records = [run if isinstance(run, Record) else open_run(run) for run in several]
    check_one_scenario(records)
    labels = distinct_labels(records)
    return Comparison(tuple(run.copy_with(label=label) for run, label in zip(records, labels, strict=True)))


@dataclass(frozen=True)
class CampaignOutcome:
    """A finished campaign: ``summary`` is the content of its ``summary.json``."""

    folder: Path
    summary: Mapping[str, Any]
    #: The part of its system that judges runs.
    judging: Judging

    def __repr__(self) -> str:
        from railhil.campaign.show import headline, passed

        return f"<{headline(self.summary)}: {passed(self.summary)}; {self.folder}>"

    def _repr_html_(self) -> str:
        from railhil.campaign.distributions import distributions
        from railhil.campaign.show import cell_html

        figure = distributions(self.summary, self.criteria, self._results)
        return cell_html(self.summary, self.judging, figure, self.folder)

    @property
    def criteria(self) -> tuple[Criterion, ...]:
        """The criteria by which its runs are judged."""
        return self.judging.criteria

    @property
    def laws(self) -> tuple[str, ...]:
        """The laws as named in the tables, the baseline of the comparison first."""
        return tuple(self.summary["laws"])

    @cached_property
    def _results(self) -> Any:
        from railhil.campaign.rows import schema
        from railhil.campaign.study import CAMPAIGN
        from railhil.study.table import RESULTS, read_table

        check_hash_list(self.folder, CAMPAIGN.manifest, None)
        return read_table(self.folder / RESULTS, schema(self.judging))

    def runs(self, law: str) -> dict[str, Any]:
        """Columns of the runs of one law, in the order of their seeds: numpy arrays, NaN where a run has no value.

        :raises KeyError: no law of the campaign.
        """
        from railhil.campaign.rows import rows_of

        if law not in self.laws:
            hint = did_you_mean(law, self.laws)
            raise KeyError(" ".join(filter(None, (f"no law {law!r};", hint, f"laws: {', '.join(self.laws)}"))))
        rows = rows_of(self._results, law)
        return {name: np.asarray(rows[name].to_numpy(zero_copy_only=False)) for name in rows.column_names}

    def to_pandas(self) -> Any:
        """All runs as a ``pandas.DataFrame``.

        :raises ModuleNotFoundError: pandas is not installed.
        """
        return self._results.to_pandas()


@library_call(
    "railhil.campaign",
    {
        "scenario": PATH,
        "parameters": Kind("a file or a list of files", are_paths),
        "settings": SETTINGS,
        "jobs": JOBS,
        "out": PATH_OR_NONE,
    },
    {**_NAMES, "first_seed": "seed"},
)
def campaign(
    scenario: str | Path = USUAL_SCENARIO,
    *,
    laws: Laws | None = None,
    runs: int = 1000,
    seed: int = 1000,
    arithmetic: str = "float64",
    indexing: str = "time",
    parameters: str | Path | Sequence[str | Path] = (),
    both: bool = False,
    settings: Settings = (),
    allow_training_seeds: bool = False,
    jobs: int = 1,
    out: str | Path | None = None,
) -> CampaignOutcome:
    """Perturbed runs of one or several laws on the same seeds (needs the extra ``campaign``).

    :param scenario: shipped name, or path of a TOML file.
    :param laws: one or several, or ``"all"``: names of laws, texts as for :func:`run`, or functions and classes at the
        top of a file; None: those of ``parameters``, or else the usual law of the scenario's system.
    :param runs: number of runs of each law.
    :param seed: of the first run; each further run has the next seed.
    :param arithmetic: of the laws.
    :param indexing: set-points over ``time`` or ``distance``.
    :param parameters: one parameter file or several, each for one of the laws.
    :param both: run these laws also with their own parameters.
    :param settings: keys of the scenario with other values: a mapping, or texts ``KEY=VALUE``.
    :param allow_training_seeds: accept seeds on which parameters were tuned; the result is then no evaluation.
    :param jobs: processes; -1: one per core. A script with threads of its own must not begin a campaign again when it
        is imported (``if __name__ == "__main__"``), because processes import it.
    :param out: its folder (default ``runs/<utc>-<scenario>-campaign``); an incomplete campaign is resumed.
    :raises InputError: anything that is not allowed, in one line.
    """
    from railhil.common.extras import need

    need("pyarrow", "campaign")
    from railhil.campaign.plan import Plan, Request
    from railhil.campaign.study import CAMPAIGN
    from railhil.study.call import make_study
    from railhil.study.perturbed_runs import how_made

    texts, code = ((), {}) if laws is None else named_laws(laws)
    files = (parameters,) if isinstance(parameters, str | Path) else parameters
    request = Request(
        scenario=stable_name(str(scenario)),
        settings=settings_of(settings),
        runs=runs,
        first_seed=seed,
        laws=texts,
        both=both,
        arithmetic=arithmetic,
        indexing=indexing,
        parameters=tuple(str(Path(file).resolve()) for file in files),
        allow_training_seeds=allow_training_seeds,
    )

    def compiled_loops(plan: Plan) -> tuple[str, str | None]:
        return "", how_made(plan.scenario, [entry.law for entry in plan.entries])[1]

    plan, made = make_study(CAMPAIGN, request, jobs, out, code, compiled_loops)
    return CampaignOutcome(made.folder, made.summary, plan.judging)
