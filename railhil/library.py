"""The bench as a library: ``railhil.run``, ``railhil.open_run``, ``railhil.campaign`` and their results.

The functions work like the commands: the same folders, hashes and verdicts.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rich.console import Console

from railhil.bus.telegrams import Event, RunEvent
from railhil.cli.bus_run import NeverBegan, as_recorded, chosen_bus, recorded
from railhil.common.command_line import RATE
from railhil.common.errors import InputError, Words
from railhil.common.output import Output
from railhil.scenarios.load import stable_name
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_document import USUAL_LAW, USUAL_SCENARIO
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.settings import setting
from railhil.scenarios.system import system_named
from railhil.supervisor.criteria import Criterion
from railhil.supervisor.documents import CERTIFICATE
from railhil.supervisor.folder import run_folder, signal_table, signal_units
from railhil.supervisor.inputs import PARAMETERS
from railhil.supervisor.judging import Judging, judging_of
from railhil.supervisor.record import checked_record
from railhil.supervisor.score import Score
from railhil.supervisor.start_up import StartUp
from railhil.supervisor.trace import FloatArray, Trace

__all__ = ["CampaignOutcome", "NeverBegan", "Outcome", "RecordedEvent", "Signals", "campaign", "open_run", "run"]

#: Scenario keys to set: a mapping, or ``KEY=VALUE`` as on the command line.
Settings = Mapping[str, Any] | Sequence[str]
#: A file, parameters read from one, or values of the law's parameters by name.
Parameters = str | Path | ParameterSet | Mapping[str, Any]


class RecordedEvent(NamedTuple):
    """A milestone of a run: its name, its simulation time and the true position of the train."""

    name: str
    time_s: float
    position_m: float


class Signals(Mapping[str, FloatArray]):
    """Columns of ``signals.csv`` by name: float64 arrays of equal shape (n,), one value per 20 ms, NaN where unknown.

    ``units``: unit of each column, empty for numbers without one.
    """

    def __init__(self, columns: Mapping[str, FloatArray], units: Mapping[str, str]) -> None:
        self._columns = dict(columns)
        self.units = dict(units)

    def __getitem__(self, name: str) -> FloatArray:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        return f"Signals({', '.join(self)})"

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with ``time_s`` as its index.

        :raises ModuleNotFoundError: pandas is not installed.
        """
        import pandas

        return pandas.DataFrame(self._columns).set_index("time_s")


@dataclass(frozen=True)
class Outcome:
    """One recorded run.

    ``scores`` are magnitudes, ``signed`` time (s) and stop error (m) with their signs; None where a run has none.
    ``certificate`` is empty for a log without one.
    """

    folder: Path
    scenario: AnyScenario = field(repr=False)
    verdict: str
    reasons: tuple[str, ...]
    scores: Mapping[str, float | None]
    signed: Mapping[str, float | None]
    certificate: Mapping[str, Any] = field(repr=False)
    trace: Trace = field(repr=False)

    @property
    def passed(self) -> bool:
        """True for the verdict PASS."""
        return self.verdict == "PASS"

    @property
    def frames_sha256(self) -> str:
        """SHA-256 of ``frames.log``; empty without certificate."""
        return str(self.certificate.get("frames_sha256", ""))

    @cached_property
    def spec(self) -> RunSpec:
        """The description of the run: ``railhil.run(outcome.spec)`` repeats it.

        :raises InputError: the folder has no certificate with a description.
        """
        path = self.folder / CERTIFICATE
        if not self.certificate:
            raise InputError(path, "file", Words("no certificate of this log"), "a run that came to its end")
        return RunSpec.from_json(self.certificate, path)

    @cached_property
    def signals(self) -> Signals:
        """Truth, measurements and commands over time; no columns in a record without SIM_TRUTH."""
        judging, notes = judging_of(self.scenario), self.certificate.get("notes")
        header, rows = signal_table(judging, self.trace, notes)
        return Signals(dict(zip(header, rows.T.copy(), strict=True)), signal_units(judging, self.trace, notes))

    @cached_property
    def events(self) -> tuple[RecordedEvent, ...]:
        """Milestones in the order of the record, without repetitions."""
        columns = (
            self.trace.raw(RunEvent.PORT, "RunEvent"),
            self.trace.values(RunEvent.PORT, "EventTime"),
            self.trace.values(RunEvent.PORT, "EventPos"),
        )
        known = {kind.value: kind.name.lower() for kind in Event}
        rows = dict.fromkeys(zip(*(column.tolist() for column in columns), strict=True))
        return tuple(RecordedEvent(known[code], *place) for code, *place in rows if code in known)


def _outcome(
    folder: Path, scenario: AnyScenario, trace: Trace, found: Score, invalid: str, certificate: Mapping[str, Any]
) -> Outcome:
    document: dict[str, Any] = found.as_json()
    verdict, reasons = (found.verdict, found.failures) if not invalid else ("INVALID", (invalid,))
    return Outcome(folder, scenario, verdict, reasons, document["scores"], document["signed"], certificate, trace)


def _settings(given: Settings) -> tuple[str, ...]:
    if isinstance(given, Mapping):
        # JSON values are TOML values, except tables and null, which no key has.
        given = [f"{key}={json.dumps(value)}" for key, value in given.items()]
    return tuple(setting(text) for text in given)


def _parameters(given: Parameters | None, law: str) -> ParameterSet | None:
    """Parameters; values given without a file count as read from the run folder, where they will be written."""
    if given is None or isinstance(given, ParameterSet):
        return given
    if isinstance(given, Mapping):
        return ParameterSet(law, dict(given), Path(PARAMETERS))
    return load_parameters(Path(given).resolve())


def run(
    scenario: str | Path | RunSpec = USUAL_SCENARIO,
    *,
    controller: str = USUAL_LAW,
    arithmetic: str = "iq",
    indexing: str = "time",
    parameters: Parameters | None = None,
    settings: Settings = (),
    faults: Sequence[str] = (),
    seed: int = 0,
    perturbed: bool = False,
    pace: str = "lockstep",
    rate: float = RATE,
    bus: str = "local",
    memory: str | Path | None = None,
    out: str | Path | None = None,
) -> Outcome:
    """Make one run, record and score it.

    :param scenario: shipped name, path of a TOML file, or a ``RunSpec``, in which case only ``out`` is used.
    :param faults: what is injected besides the scenario's own faults, one text each (docs/faults.md).
    :param bus: ``local``: all nodes in this process; ``auto``: three processes over the bus that ``railhil run`` would
        choose.
    :param memory: file with the law's memory from run to run: read at the beginning, replaced after a valid run.
    :param out: the run folder (default ``runs/<utc>-<scenario>-<controller>``).
    :raises InputError: anything that is not allowed, in one line.
    :raises NeverBegan: the nodes refused the run, or no frame came.
    """
    if isinstance(scenario, RunSpec):
        spec = scenario
    else:
        law = LawSpec(controller, arithmetic, indexing, _parameters(parameters, controller))
        spec = RunSpec(stable_name(str(scenario)), _settings(settings), law, seed, perturbed, pace, rate, bus=bus)
        kept = None if memory is None else str(Path(memory).resolve())
        spec = replace(spec, memory_file=kept, faults=tuple(faults))
    # Whatever its source, it is checked like a file.
    checked = RunSpec.from_json(spec.as_json(), Path("railhil.run"))
    spec = replace(checked, law=spec.law, memory_file=spec.memory_file)
    loaded = spec.load()
    system_named(loaded.system).check_law(spec.law.controller, "railhil.run", "controller")
    how = StartUp()
    with chosen_bus(argparse.Namespace(), spec) as choice:
        folder, made = run_folder(None if out is None else str(out), loaded.name, spec.law.controller)
        given = spec.law.parameters
        if given is not None and given.source == Path(PARAMETERS):
            placed = replace(given, source=folder.resolve() / PARAMETERS)
            spec = replace(spec, law=replace(spec.law, parameters=placed))
        done, result = recorded(loaded, spec, how, choice, folder, made, Output(stderr=True), quiet=True)
    if done.stopped_exit_code:
        raise KeyboardInterrupt(result.line)
    row = as_recorded(folder, done, result)
    return _outcome(folder, loaded, done.trace, result.score, "" if result.trusted else row.line, row.certificate)


def open_run(folder: str | Path) -> Outcome:
    """A run from its folder, judged again from the log alone; also from version 0.1.0 or from another machine.

    :raises InputError: there is no record, or its parts do not belong together.
    """
    record = checked_record(str(folder), None)
    found = judging_of(record.scenario).score(record.scenario, record.trace)
    return _outcome(record.log.parent, record.scenario, record.trace, found, record.invalid, record.certificate)


@dataclass(frozen=True)
class CampaignOutcome:
    """A finished campaign: ``summary`` is the content of its ``summary.json``."""

    folder: Path
    summary: Mapping[str, Any] = field(repr=False)
    #: How its system judges runs.
    judging: Judging = field(repr=False)

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
        from railhil.campaign.folder import RESULTS
        from railhil.campaign.results_table import read_results

        return read_results(self.folder / RESULTS, self.judging)

    def runs(self, law: str) -> dict[str, Any]:
        """Columns of the runs of one law, in the order of their seeds: numpy arrays, NaN where a run has no value.

        :raises KeyError: no law of the campaign.
        """
        from railhil.campaign.results_table import rows_of

        if law not in self.laws:
            raise KeyError(law)
        rows = rows_of(self._results, law)
        return {name: np.asarray(rows[name].to_numpy(zero_copy_only=False)) for name in rows.column_names}

    def to_pandas(self) -> Any:
        """All runs as a ``pandas.DataFrame``.

        :raises ModuleNotFoundError: pandas is not installed.
        """
        return self._results.to_pandas()


def campaign(
    scenario: str | Path = USUAL_SCENARIO,
    *,
    laws: Sequence[str] = (USUAL_LAW,),
    runs: int = 1000,
    first_seed: int = 1000,
    arithmetic: str = "float64",
    indexing: str = "time",
    parameters: Sequence[str | Path] = (),
    both: bool = False,
    settings: Settings = (),
    allow_training_seeds: bool = False,
    jobs: int = 1,
    out: str | Path | None = None,
) -> CampaignOutcome:
    """Perturbed runs of one or several laws on the same seeds (needs the extra ``campaign``).

    :param laws: their names, or ``("all",)``.
    :param parameters: parameter files, each for one of the laws; ``both``: run these laws also with their own
        parameters.
    :param jobs: processes; -1: one per core.
    :param out: its folder (default ``runs/<utc>-<scenario>-campaign``); an incomplete campaign is resumed.
    :raises InputError: anything that is not allowed, in one line.
    """
    from railhil.campaign.extras import need

    need("pyarrow", "campaign")
    from railhil.campaign.engines import running
    from railhil.campaign.manifest import checked_request
    from railhil.campaign.plan import Request, make_plan
    from railhil.campaign.run import execute

    request = Request(
        scenario=stable_name(str(scenario)),
        settings=_settings(settings),
        runs=runs,
        first_seed=first_seed,
        laws=tuple(laws),
        both=both,
        arithmetic=arithmetic,
        indexing=indexing,
        parameters=tuple(str(Path(file).resolve()) for file in parameters),
        allow_training_seeds=allow_training_seeds,
    )
    plan = make_plan(checked_request(request, Path("railhil.campaign")))

    def say(sentence: str) -> None:
        print(sentence, file=sys.stderr)

    with running("batch" if jobs == 1 else "joblib", jobs, None, say) as engine:
        folder, found = execute(plan, None if out is None else str(out), Console(quiet=True), engine, say)
    return CampaignOutcome(folder, found, plan.judging)
