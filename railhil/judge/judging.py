"""Judging and display of a system's records: its parts for score, tables, report, run folder and sequences of runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from railhil.judge.criteria import Criterion, Extra, limited
from railhil.judge.declared import Interlocks, Place, Received, ShownProfile, Watch, in_words, interface_received
from railhil.judge.score import Score
from railhil.record.notes import Status, interface_status
from railhil.record.sampling import drawn_trace
from railhil.record.trace import FloatArray, Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import UnknownScenario

if TYPE_CHECKING:
    from railhil.judge.record import Record


@dataclass(frozen=True, slots=True)
class SequenceMeasure:
    """A criterion over sequences of runs.

    :param within: limits in the unit of the criterion; the share of runs inside each is given.
    :param converged: a sequence has converged at the first of ``in_a_row`` successive runs inside this limit.
    """

    criterion: Criterion
    within: tuple[float, ...]
    converged: float
    in_a_row: int = 3


@dataclass(frozen=True, slots=True)
class Noted:
    """A named thing of each run, such as its worst stop, in the rows and tables of a campaign.

    ``key``: column of the name, ``value_key``: of its value, in ``unit`` with ``digits`` decimals and a sign. ``of``:
    name and value from a score; None: the run has none.
    """

    key: str
    title: str
    value_key: str
    unit: str
    digits: int
    of: Callable[[Score], tuple[str, float | None] | None]

    def shown(self, name: str | None, value: float | None) -> str:
        """Title, name and value in words; empty without a name."""
        if name is None:
            return ""
        return f"{self.title} {name}" + ("" if value is None else f" {value:+.{self.digits}f} {self.unit}")


def sequence_measures(scenario: Any, judging: Judging) -> Sequence[SequenceMeasure]:
    """The measures of a scenario: its system's, else one for each of its limits."""
    if judging.learned:
        return judging.learned
    found = []
    for criterion in limited(judging.criteria, scenario):
        limit = criterion.limit_in(scenario)
        assert limit is not None
        if criterion.better == "low":
            found.append(SequenceMeasure(criterion, (limit,), limit))
    return found


def _nothing(*given: Any) -> tuple[Any, ...]:
    return ()


def _no_columns(*given: Any) -> list[tuple[str, str, FloatArray]]:
    return []


def _no_figures(*given: Any) -> dict[str, Any]:
    return {}


def _no_place(*given: Any) -> float | None:
    return None


def _no_text(*given: Any) -> str:
    return ""


@dataclass(frozen=True, slots=True)
class Judging:
    """The part ``judging`` of a system.

    ``criteria``: its scores, in the order of their columns. ``score``: (scenario, trace) -> score, a pure function of
    both. ``truth``: the port whose telegrams are the rows of ``signals.csv``; ``columns``: the columns after the time:
    header with unit, port and signal; ``told``: (trace, notes as in the certificate) -> further columns: header,
    port and values. ``asked``: one sentence at the top of the report on the task of the scenario. ``checks``:
    (scenario, score) -> JUnit cases in addition to the limits of the criteria: name and failure (empty: none).
    ``facts``: (recorded run) -> further facts for the report: name and text. ``counted``: (scores) -> figures over
    several runs for ``compare.json``; ``remark``: the same in words. ``status``: the telegram in which the controller
    reports on its arithmetic and its laws; None: the one named in the system's part ``interface``, if it has one.
    ``published``: description of the published rows; ``deviations``: their source and how it is interpreted here.
    ``advice``: (recorded run, report folder) -> advice after a FAIL. ``extras``: figures of every score that are 0 in a
    good run. ``reckoned``: (scenario, trace) -> columns computed for the rows: header, unit and values. ``shown``:
    further columns for the panel only, as ``columns``. ``quantities``: further names of requirements, as ``reckoned``
    (:mod:`railhil.judge.requirements.names`).

    For the panel only: ``places``: (scenario) -> named places in the order of their positions, of which the panel draws
    a line with the place of the train; ``strip``: names of the columns that it draws over the line, those of the first
    one's unit together, others below; empty: speed and target. ``profiles``: (scenario) ->
    :class:`railhil.judge.declared.ShownProfile`, drawn with them. ``gauges``: names of columns that stand at first
    sight beside those with a role. ``applied``: name of the column with what the train makes of the command.

    ``ends_at_m``: (scenario) -> planned end of the run as a position of the system's ``truth`` in m; None: there is
    none.

    ``noted``: named things of each run, such as its worst stop. ``stop_events``: the milestones of its stops, at which
    scores are known.

    ``learned``: measures over sequences of runs; empty: each limit
    (:func:`railhil.judge.judging.sequence_measures`).

    For the events (:mod:`railhil.judge.declared`): ``watches``: the reaction ladders on the bus.
    ``interlocks``: states of the train, reported when they differ from the usual ones. ``received``: (scenario) -> the
    telegrams that a receiver judges by their content; by default the telegrams of the system's part ``interface``, if
    it has one.
    """

    criteria: tuple[Criterion, ...]
    score: Callable[[Any, Trace], Score]
    truth: str
    columns: tuple[tuple[str, str, str], ...]
    asked: Callable[[Any], str]
    extras: tuple[Extra, ...] = ()
    told: Callable[[Trace, Any], list[tuple[str, str, FloatArray]]] = _no_columns
    checks: Callable[[Any, Score], Sequence[tuple[str, str]]] = _nothing
    facts: Callable[[Any], Sequence[tuple[str, str]]] = _nothing
    counted: Callable[[Sequence[Score]], Mapping[str, Any]] = _no_figures
    remark: Callable[[Sequence[Score]], str] = _no_text
    status: Status | None = None
    published: str = ""
    deviations: Callable[[], tuple[str, Sequence[Any]]] | None = None
    advice: Callable[[Any, Any], str] = _no_text
    reckoned: Callable[[Any, Trace], Sequence[tuple[str, str, FloatArray]]] = _nothing
    quantities: Callable[[Any, Trace], Sequence[tuple[str, str, FloatArray]]] = _nothing
    shown: tuple[tuple[str, str, str], ...] = ()
    watches: tuple[Watch, ...] = ()
    interlocks: tuple[Interlocks, ...] = ()
    received: Callable[[Any], Sequence[Received]] = _nothing
    learned: tuple[SequenceMeasure, ...] = ()
    noted: tuple[Noted, ...] = ()
    stop_events: tuple[str, ...] = ("stopped",)
    ends_at_m: Callable[[Any], float | None] = _no_place
    places: Callable[[Any], Sequence[Place]] = _nothing
    profiles: Callable[[Any], Sequence[ShownProfile]] = _nothing
    strip: tuple[str, ...] = ()
    gauges: tuple[str, ...] = ()
    applied: str = ""


def judging_of(scenario: AnyScenario) -> Judging:
    """The judging of a scenario's system; for an unknown scenario only the data on the wire.

    :raises InputError: the system has no part ``judging``.
    """
    system = scenario.installed_system
    judging: Judging = system.part("judging")
    interface = system.optional_part("interface")
    if interface is not None:
        if judging.status is None:
            judging = replace(judging, status=interface_status(interface))
        if judging.received is _nothing:
            judging = replace(judging, received=lambda scenario: interface_received(interface))
    if isinstance(scenario, UnknownScenario):
        watches = tuple(replace(watch, said=in_words) for watch in judging.watches)
        judging = replace(
            judging,
            reckoned=_nothing,
            quantities=_nothing,
            ends_at_m=_no_place,
            places=_nothing,
            profiles=_nothing,
            watches=watches,
        )
    return judging


def system_pictures(scenario: AnyScenario, runs: Sequence[Record]) -> list[Any]:
    """The figures of the scenario's system, which gets the records with their gaps
    (:class:`railhil.record.sampling.DrawnTrace`).

    Each has ``name``, ``title``, ``caption`` and ``svg``: a :class:`railhil.charts.figure.Figure`, or a picture drawn
    by the system itself (:class:`railhil.report.pictures.Picture`).
    """
    drawn = [
        run.copy_with(trace=drawn_trace(run.scenario, run.trace), score=run.score, events=run.events) for run in runs
    ]
    found: list[Any] = scenario.installed_system.part("pictures")(scenario, drawn)
    return found
