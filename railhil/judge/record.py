"""A recorded run as named by the user: its log, its certificate, and whether they belong together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.common.errors import InputError, Words
from railhil.dbc import ContractError, recorded_contract
from railhil.judge.cross_check import check_folder, check_handshake, check_record
from railhil.judge.events.event import RecordedEvent
from railhil.judge.events.summary import explained, fault_events, why
from railhil.judge.events.telegrams import events_of
from railhil.judge.judging import Judging, judging_of
from railhil.judge.reactions.expected import with_expectations
from railhil.judge.score import Score
from railhil.judge.signals import Signals, signal_table, signal_units
from railhil.judge.stops import ScoredStop
from railhil.record.documents import CERTIFICATE, read_certificate, read_score
from railhil.record.framelog import log_sha256, read_log
from railhil.record.hash_list import HASH_LIST
from railhil.record.log_trace import trace_of_log
from railhil.record.own_time import Timed, own_time
from railhil.record.trace import NodeCounters, Trace, trace_of
from railhil.scenarios.given import KEY as GIVEN_KEY
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario, PublishedScore
from railhil.scenarios.parameters import DIGEST_DIGITS
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.scenario_documents import SCENARIO, any_judged_sha256, find_earlier_scenario, read_scenario
from railhil.scenarios.settings import required
from railhil.scenarios.system import System

if TYPE_CHECKING:
    from railhil.judge.requirements.outcome import Outcome as RequirementOutcome

#: A curve needs two points.
_POINTS_MIN = 2
_BESIDE = "a certificate beside the log, or --scenario"


@dataclass(frozen=True, eq=False)
class Record:
    """One recorded run, whose parts belong together.

    ``invalid``: reason for which the run was not trustworthy, or that the log is not the certified one;
    ``certificate``: empty if there is none for this log.
    """

    log: Path
    #: Scenario of its system, interpreted by the system's own parts.
    scenario: Any = field(repr=False)
    trace: Trace = field(repr=False)
    invalid: str = ""
    certificate: dict[str, Any] = field(default_factory=dict, repr=False)
    #: Parts of the log that were not used, a sentence each.
    unused: tuple[str, ...] = ()
    #: The frames in the record's own time; None: the log has it.
    timed: Sequence[Timed] | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        """Verdict, scores, reasons of a verdict other than PASS, and folder in a line."""
        scores, reasons = self.score.in_words(self.judging.criteria), "" if self.passed else self.line
        return f"<{'; '.join(filter(None, (f'{self.verdict}: {self.title}', scores, reasons, self.place)))}>"

    def _repr_html_(self) -> str:
        from railhil.judge.notebook import run_html

        return run_html(self)

    @property
    def title(self) -> str:
        """Law, scenario and seed."""
        seed = f", seed {self.certificate['seed']}" if "seed" in self.certificate else ""
        return f"{self.label} on {self.scenario.name}{seed}"

    @property
    def place(self) -> str:
        """The run folder as text; empty if there is no log, or no more."""
        return str(self.folder) if self.log.is_file() else ""

    def copy_with(self, **values: Any) -> Record:
        """A copy with other values of its attributes, given also for those that are else derived from the record
        (``score``, ``events``, ``label``): a run that has just been made is judged already."""
        derived = {name for name, kind in vars(Record).items() if isinstance(kind, cached_property)}
        assert values.keys() <= vars(self).keys() | derived, f"only {sorted(vars(self).keys() | derived)} can be given"
        made = copy(self)
        if "trace" in values:
            # What was derived from the other trace is not that of this one.
            for name in ("score", "events", "signals"):
                vars(made).pop(name, None)
        vars(made).update(values)
        return made

    @property
    def system(self) -> System:
        """The system of the scenario."""
        found: System = self.scenario.installed_system
        return found

    @cached_property
    def judging(self) -> Judging:
        """How the system judges and shows it."""
        return judging_of(self.scenario)

    @property
    def folder(self) -> Path:
        """The run folder."""
        return self.log.parent

    def frames(self) -> Iterator[Timed]:
        """The frames of the run ``(time_ns, frame)`` in bus order."""
        return read_log(self.log) if self.timed is None else iter(self.timed)

    @cached_property
    def events(self) -> tuple[RecordedEvent, ...]:
        """The events, as in ``events.csv``, in the order of the instants; injected faults from the certificate."""
        injected = fault_events(self.certificate.get("injected", ()), self.trace.end_s)
        return events_of(self.scenario, self.trace, injected)

    @cached_property
    def score(self) -> Score:
        """The score of the record, with the expectations of its faults and the requirements of its certificate.

        :raises InputError: a requirement of the certificate is none.
        """
        found = self.judging.score(self.scenario, self.trace)
        if injected := self.certificate.get("injected", ()):
            found = with_expectations(found, injected, self.events, self.scenario, self.trace)
        path = self.folder / CERTIFICATE
        if tables := required(self.certificate, path):
            # A run without requirements does not load their language.
            from railhil.judge.requirements.outcome import with_requirements
            from railhil.judge.requirements.requirement import requirements_from_json

            found = with_requirements(self.copy_with(score=found), requirements_from_json(tables, path))
        return found

    @property
    def verdict(self) -> str:
        """PASS, FAIL or INVALID."""
        return "INVALID" if self.invalid else self.score.verdict

    @property
    def passed(self) -> bool:
        """True for the verdict PASS."""
        return self.verdict == "PASS"

    @property
    def reasons(self) -> tuple[str, ...]:
        """One sentence for each limit missed, or the reason why the run is INVALID."""
        return (self.invalid,) if self.invalid else self.score.failures

    @property
    def why(self) -> str:
        """The reactions of the watches, or the refused or missing telegrams, in a sentence; empty for a healthy run."""
        return why(self.scenario, self.events)

    @property
    def line(self) -> str:
        """The reasons of the verdict, and the actions of the watches."""
        return explained("; ".join(self.reasons), self.why)

    @cached_property
    def scores(self) -> Mapping[str, float | None]:
        """Magnitudes of the scores; None where the run has none."""
        document: dict[str, Any] = self.score.as_json()
        return dict(document["scores"])

    @cached_property
    def signed(self) -> Mapping[str, float | None]:
        """Time (s) and stop error (m) with their signs; None where the run has none."""
        document: dict[str, Any] = self.score.as_json()
        return dict(document["signed"])

    @property
    def stops(self) -> tuple[ScoredStop, ...]:
        """The stops that the scenario plans, in their order, each with what the run made of it."""
        return self.score.stops

    @property
    def requirements(self) -> Mapping[str, RequirementOutcome]:
        """What the run made of each sentence that it is judged by, by id."""
        return {one.id: one for one in self.score.requirements}

    @property
    def notes(self) -> tuple[str, ...]:
        """Parts of the log that were not used, and a difference between the certificate's verdict and that of the
        record. It is no error: another version may have judged otherwise."""
        certified, found = self.certificate.get("verdict"), self.score
        if self.invalid or certified in (None, found.verdict):
            return self.unused
        return (*self.unused, f"{CERTIFICATE} of {self.folder} says {certified}, the record gives {found.verdict}")

    @property
    def controller(self) -> str:
        """Name of the law; ``?`` for a record without certificate."""
        return str(self.certificate.get("controller", "?"))

    @cached_property
    def label(self) -> str:
        """Name of the run in tables: its law, parameters and memory, if they are known."""
        found = law_label(self.certificate, self.folder.name)
        if memory := _confirmed(self.certificate).get("memory"):
            found += f"@{memory['sha256'][:DIGEST_DIGITS]}"
        return found + (" (on this seed)" if self.seed_was_trained else "")

    @property
    def published(self) -> PublishedScore | None:
        """The published row of this law, if there is one."""
        return next((row for row in self.scenario.published if row.controller == self.controller), None)

    @property
    def seed_was_trained(self) -> bool:
        """True if the controller's parameters are known to come from this very run, which is then not an evaluation."""
        return bool(self.certificate.get("seed_was_trained"))

    @property
    def caution(self) -> str:
        """The warning for a run that is not an evaluation, empty for the others."""
        if not self.seed_was_trained:
            return ""
        how = "tuned" if self.certificate.get("parameters") else "designed"
        seed = self.certificate.get("seed")
        return f"NOT AN EVALUATION: the parameters of {self.controller} were {how} on this very run, seed {seed}"

    @property
    def can_be_drawn(self) -> bool:
        """True if the truth was recorded more than once."""
        return self.trace.count(self.judging.truth) >= _POINTS_MIN

    @cached_property
    def score_document(self) -> dict[str, Any]:
        """Content of ``score.json``; empty without certificate, or without the file.

        :raises InputError: it is damaged.
        """
        return (read_score(self.folder) if self.certificate else None) or {}

    @property
    def frames_sha256(self) -> str:
        """SHA-256 of ``frames.log``; empty without certificate."""
        return str(self.certificate.get("frames_sha256", ""))

    @cached_property
    def spec(self) -> RunSpec:
        """The description of the run: ``railhil.run(record.spec)`` repeats it.

        :raises InputError: the folder has no certificate with a description.
        """
        path = self.folder / CERTIFICATE
        if not self.certificate:
            raise InputError(path, "", Words("is missing or of another log"), "that of a run that came to its end")
        return RunSpec.from_json(self.certificate, path)

    @cached_property
    def signals(self) -> Signals:
        """Truth, measurements and commands over time; no columns in a record without the truth."""
        notes = self.certificate.get("notes")
        header, rows = signal_table(self.scenario, self.trace, notes)
        return Signals(dict(zip(header, rows.T.copy(), strict=True)), signal_units(self.scenario, self.trace, notes))


def _confirmed(certificate: Mapping[str, Any]) -> Mapping[str, Any]:
    """Confirmed facts of the law; none for a controller that has not reported them."""
    return {} if certificate.get("asked") else certificate


def law_label(certificate: Mapping[str, Any], otherwise: str) -> str:
    """The law with its parameters, if they are not its own, and the board or the program that computed it.

    :param otherwise: for a record without certificate.
    """
    label = str(certificate.get("controller") or otherwise)
    if parameters := _confirmed(certificate).get("parameters"):
        label += f"+{parameters['sha256'][:DIGEST_DIGITS]}" + (" tuned" if parameters.get("training") else "")
    if target := certificate.get("target"):
        return f"{label} on {target['board']}"
    given = certificate.get(GIVEN_KEY)
    return f"{label} in C" if given and given["label"] == label else label


def log_path(text: str) -> Path:
    """Path of the log that a user named directly, by its run folder or by the certificate in it.

    :raises InputError: there is no such file.
    """
    path = Path(text)
    folder = path.parent if path.name == CERTIFICATE else path
    log = folder / "frames.log" if folder.is_dir() else path
    if not log.is_file():
        found = Words("does not exist" if not log.exists() else "is no regular file")
        raise InputError(log, "", found, "a candump log, a BLF or ASC of one, or a run folder with frames.log")
    return log


def _recorded_scenario(log: Path, name: str | None) -> AnyScenario:
    """The scenario with which a log was recorded: by name, else from its folder, else as named in the certificate.

    A folder of version 0.1.0 has no scenario; the shipped ones of that version are kept with their hashes.

    :raises InputError: none of them gives it.
    """
    if name is not None:
        return load_any(name)
    if (log.parent / SCENARIO).is_file():
        return read_scenario(log.parent / SCENARIO)
    path = log.parent / CERTIFICATE
    document = read_certificate(log.parent, _BESIDE)
    if document is None:
        # A file that is no log has no certificate either; its first line says more.
        next(iter(read_log(log)), None)
        raise InputError(path, "", Words("does not exist: the run did not come to its end"), _BESIDE)
    scenario = document.get("scenario")
    if scenario is None:
        raise InputError(path, "scenario", Words(), _BESIDE)
    earlier = find_earlier_scenario(str(document.get("scenario_sha256")))
    if earlier is not None:
        return earlier
    return load_any(str(scenario), document.get("settings", ()), document.get("faults", ()))


def checked_record(text: str, name: str | None) -> Record:
    """Log, scenario and telegrams of a record, checked against each other.

    The SHA-256 in the certificate is compared last: the message that a log belongs to another scenario is more helpful
    than that it is not the certified one. A log that differs from the certified one is read in its own time
    (:mod:`railhil.record.own_time`): a log of another program may hold the same run.

    :param text: log or run folder.
    :param name: scenario, if the user names one. A damaged certificate is then ignored; a folder of which a file was
        changed, or a log that does not match its certificate, is accepted as an INVALID record.
    :raises InputError: one line for the first inconsistency.
    """
    log = log_path(text)
    document, changed = _certificate(log, name)
    scenario = _recorded_scenario(log, name)
    _check_judged(log, scenario, document, name)
    contract = recorded_contract(log.parent, document.get("dbc_sha256"), scenario.installed_system.contract)
    wanted, found = document.get("frames_sha256"), log_sha256(log)
    trace = trace_of_log(log, contract)
    check_handshake(log, scenario, trace)
    own = None if wanted == found else own_time(log, scenario, contract)
    notes: tuple[str, ...] = ()
    timed: Sequence[Timed] | None = None
    if own is not None:
        trace, notes, timed = trace_of(own.frames, contract), own.notes, own.frames
    if own is not None and wanted != own.sha256:
        if name is None and wanted is None:
            key, missing = ("frames_sha256", "missing") if document else ("", "does not exist")
            raise InputError(log.parent / CERTIFICATE, key, Words(missing), _BESIDE)
        if name is None:
            raise InputError(log, "sha256", found, f"{wanted} ({CERTIFICATE} beside it): a log that nobody changed")
        other = ""
        if wanted is not None:
            other = f"{log.name} (sha256 {found}) is not the log that {CERTIFICATE} beside it is of (sha256 {wanted})"
        return Record(log, scenario, trace, "; ".join(filter(None, (changed, other))), {}, notes, timed)
    try:
        check_record(log.parent, document, scenario, trace)
    except InputError as error:
        if name is None:
            raise
        changed = changed or str(error)
    told = document.get("received")
    trace.reported = None if told is None else NodeCounters(told["exact"], told["nodes"])
    invalid = str(document.get("line") or "no reason given") if document.get("verdict") == "INVALID" else ""
    return Record(log, scenario, trace, "; ".join(filter(None, (changed, invalid))), document, notes, timed)


def _certificate(log: Path, name: str | None) -> tuple[dict[str, Any], str]:
    """The certificate beside a log, empty if there is none, and the reason for which its folder cannot be trusted
    (empty: it can).

    :param name: of the scenario, if the user names one; otherwise such a folder is refused.
    """
    document: dict[str, Any] | None = None
    try:
        try:
            document = read_certificate(log.parent, _BESIDE)
        finally:
            # A certificate that cannot be read has most likely been changed.
            check_folder(log.parent, document)
    except (InputError, ContractError) as error:
        if name is None:
            raise
        damaged = document is None and not (log.parent / HASH_LIST).is_file()
        return document or {}, "" if damaged else str(error)
    return document or {}, ""


def _check_judged(log: Path, scenario: AnyScenario, document: dict[str, Any], name: str | None) -> None:
    """The limits in the folder must be those of the run; a scenario named by the user may have others."""
    wanted, found = document.get("judged_sha256"), any_judged_sha256(scenario)
    if name is None and wanted is not None and wanted != found:
        allowed = f"{wanted} ({CERTIFICATE}): limits that nobody changed"
        raise InputError(log.parent / SCENARIO, "judged_sha256", found, allowed)
