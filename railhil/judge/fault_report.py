"""Results of the faults of a run: the logs of all nodes in one file, and for each fault whether it acted.

Every run uses this module, so the injection is imported inside the functions, for runs with faults only.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.bus.can_settings import HUB_INTERFACE, LOCAL
from railhil.bus.select import BusChoice
from railhil.common.user_files import refuse_unreadable, whole_file
from railhil.scenarios.model import AnyScenario

if TYPE_CHECKING:
    from railhil.faults.model import Fault

#: The logs of the nodes in a run folder, and all of them in one, by time.
LOGS, FAULTS = "faults-*.csv", "faults.csv"


@dataclass(frozen=True, slots=True)
class FaultOutcome:
    """One fault of a run.

    ``text``: with all values drawn, and with the instant of a fault injected by hand. Times are simulation time in s:
    ``begun_s``: it became active, ``effect_s``: it first changed something, ``ended_s``: it ended; None: it did not.
    ``hits``: number of telegrams, samples or processes that it has changed.
    """

    number: int
    text: str
    by_hand: bool
    begun_s: float | None
    effect_s: float | None
    ended_s: float | None
    hits: int
    #: Nodes that inject it and have left no log.
    unlogged: tuple[str, ...] = ()
    #: It states what it expects, so that a run of it is a test also if it is injected by hand.
    is_test: bool = True

    @property
    def missed(self) -> str:
        """Reason for which the run proves nothing about the controller; empty if the fault acted, and for a fault that
        is left to the operator and is no test."""
        if self.unlogged and not self.hits:
            options = " and ".join(f"railhil node {node} --fault-logs DIR" for node in self.unlogged)
            return f"fault {self.number}: nothing is known of it without {options}: {self.text}"
        if self.begun_s is None:
            return "" if self.by_hand else f"fault {self.number} never began: {self.text}"
        is_judged = self.hits or (self.by_hand and not self.is_test)
        return "" if is_judged else f"fault {self.number} changed nothing: {self.text}"

    @property
    def line(self) -> str:
        """Its result, for the console."""
        if self.begun_s is None:
            return f"fault {self.number}: {self.text}: not injected"
        found = "changed nothing" if self.effect_s is None else f"{self.hits} hits, first at {self.effect_s:.2f} s"
        warns = "" if self.hits or self.missed else " (warning: the run is judged as if it had not been injected)"
        return f"fault {self.number}: {self.text}: begun at {self.begun_s:.2f} s, {found}{warns}"

    def as_json(self) -> dict[str, Any]:
        """All fields."""
        return {
            "number": self.number,
            "fault": self.text,
            "by_hand": self.by_hand,
            "begun_s": self.begun_s,
            "effect_s": self.effect_s,
            "ended_s": self.ended_s,
            "hits": self.hits,
        }


_Row = tuple[int, int, str, str, str]


def fault_outcomes(folder: Path, scenario: AnyScenario, seed: int) -> list[FaultOutcome]:
    """The result of each fault of a run whose nodes have ended, by number; writes :data:`FAULTS`.

    :param folder: the run folder with the logs of the nodes.
    :raises OSError: it cannot be read or written.
    """
    if not scenario.faults:
        return []
    from railhil.bus.injector.activities import FILE_NAME
    from railhil.bus.injector.node_faults import nodes_of
    from railhil.scenarios.fault_list import injection_of

    rows = _logged(folder)
    with whole_file(folder / FAULTS) as draft:
        draft.write_text(_text(rows), encoding="utf-8")
    found, faults = _outcomes(scenario, seed, rows)
    injection = injection_of(scenario, seed)
    assert injection is not None
    contract = scenario.installed_system.contract
    logged = {path.name for path in folder.glob(LOGS)}
    for index, fault in enumerate(faults):
        silent = [
            node for node in sorted(nodes_of(fault, injection, contract)) if FILE_NAME.format(node=node) not in logged
        ]
        found[index] = replace(found[index], unlogged=tuple(silent))
    return found


def logged_outcomes(folder: Path, scenario: AnyScenario, seed: int) -> list[FaultOutcome]:
    """Content of the logs in a run folder on each fault, by number; empty without logs.

    :raises InputError: a log cannot be read.
    """
    with refuse_unreadable(folder / LOGS, "what the nodes have written"):
        rows = _logged(folder)
    return _outcomes(scenario, seed, rows)[0] if rows else []


def _logged(folder: Path) -> list[_Row]:
    """The lines of all logs, by time."""
    return sorted((row for path in sorted(folder.glob(LOGS)) for row in _rows(path)), key=lambda row: row[1])


def _outcomes(
    scenario: AnyScenario, seed: int, rows: Sequence[_Row]
) -> tuple[list[FaultOutcome], tuple[Fault, ...] | list[Fault]]:
    """The result of each fault, and the faults with their random draws."""
    from railhil.scenarios.fault_list import draw_faults

    faults = draw_faults(scenario, seed)
    return [_outcome(number, fault, rows) for number, fault in enumerate(faults, start=1)], faults


def missing_logs(folder: Path, scenario: AnyScenario) -> list[str]:
    """Logs of faults that the nodes of a run have yet to write into its folder, by their file names."""
    if not scenario.faults:
        return []
    from railhil.bus.injector.activities import FILE_NAME, INSIDE
    from railhil.bus.injector.node_faults import nodes_of
    from railhil.scenarios.fault_list import injection_of

    injection = injection_of(scenario, 0)
    assert injection is not None
    contract = scenario.installed_system.contract
    nodes = {node for fault in injection.faults for node in nodes_of(fault, injection, contract) or (INSIDE,)}
    names = sorted(FILE_NAME.format(node=node) for node in nodes)
    return [name for name in names if not (folder / name).is_file()]


def take_logs(source: Path, folder: Path) -> None:
    """Move the logs that nodes have left in a folder of their own into the run folder.

    :raises OSError: a log cannot be read or written.
    """
    for path in sorted(source.glob(LOGS)):
        with whole_file(folder / path.name) as draft:
            draft.write_bytes(path.read_bytes())
        path.unlink()


def check_faults(scenario: AnyScenario, transports: Sequence[str], pace: str) -> None:
    """Refuse a run with a fault that cannot be injected (:mod:`railhil.faults.capability`).

    :param transports: all that apply to the run.
    :raises InputError: the first such fault.
    """
    if not scenario.faults:
        return
    from railhil.bus.injector.node_faults import nodes_of
    from railhil.faults.capability import check_injectable
    from railhil.scenarios.fault_list import injection_of

    injection = injection_of(scenario, 0)
    assert injection is not None
    contract = scenario.installed_system.contract
    for fault in injection.faults:
        check_injectable(fault, transports, pace, sorted(nodes_of(fault, injection, contract)))


def transports_of(choice: BusChoice, foreign: bool) -> list[str]:
    """The transports of a run, in the words of :data:`railhil.faults.capability.TRANSPORTS`.

    :param foreign: the controller is not railhil's.
    """
    known = {LOCAL: "local", HUB_INTERFACE: "hub", "socketcan": "kernel"}
    found = known.get(str(choice.config.get("interface")), "adapter")
    return [found, *(["board"] * foreign)]


def missed_faults(outcomes: Sequence[FaultOutcome]) -> str:
    """The faults without effect, as the reason for which the run proves nothing; empty if all of them acted."""
    return "; ".join(filter(None, (one.missed for one in outcomes)))


def _rows(path: Path) -> Iterable[_Row]:
    with path.open(encoding="utf-8", newline="") as stream:
        lines = csv.reader(stream)
        next(lines, None)
        for number, time_ns, what, before, after in lines:
            yield int(number), int(time_ns), what, before, after


def _text(rows: Sequence[_Row]) -> str:
    from railhil.bus.injector.activities import COLUMNS

    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(rows)
    return buffer.getvalue()


def _outcome(number: int, fault: Fault, rows: Sequence[_Row]) -> FaultOutcome:
    from railhil.faults.language import fault_text, parse
    from railhil.faults.model import Trigger

    own = [row for row in rows if row[0] == number]
    begun = [time_ns for _, time_ns, what, *_ in own if what == "begun"]
    ended = [time_ns for _, time_ns, what, *_ in own if what == "ended"]
    hits = [time_ns for _, time_ns, what, *_ in own if what not in ("begun", "ended")]
    given = [text for _, _, what, _, text in own if what == "begun" and text]
    if given:
        # An operator gave it other values.
        fault = replace(fault, values=parse(given[0]).values)
    by_hand = fault.trigger.kind == "manual"
    if by_hand and begun:
        # The same run again needs no hand.
        fault = replace(fault, trigger=Trigger("time", min(begun) / 1e9))
        if ended and fault.duration_s is None and fault.count is None:
            fault = replace(fault, duration_s=(max(ended) - min(begun)) / 1e9)
    return FaultOutcome(
        number,
        fault_text(fault),
        by_hand,
        min(begun) / 1e9 if begun else None,
        min(hits) / 1e9 if hits else None,
        max(ended) / 1e9 if ended else None,
        len(hits),
        is_test=fault.expect is not None,
    )
