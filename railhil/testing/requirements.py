"""The requirements that the tests of a session show, and the results."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

#: Name of the property of a test, in the JUnit report too.
PROPERTY = "requirement"
#: Name of the table in the folder of the session's runs.
FILE_NAME = "requirements.csv"
FAILED, PASSED, NOT_SHOWN = "FAILED", "PASSED", "NOT SHOWN"
#: Outcomes of pytest, and of a test that fails only because no run has shown its sentence -> result of a requirement;
#: the worst comes first.
SAYS: Mapping[str, str] = {
    "error": FAILED,
    "failed": FAILED,
    "xpassed": FAILED,
    "xfailed": FAILED,
    "not shown": NOT_SHOWN,
    "skipped": NOT_SHOWN,
    "passed": PASSED,
}
_ORDER = (FAILED, PASSED, NOT_SHOWN)
#: Columns of what the runs of a test have shown of the sentence that it requires, in the table; empty without one.
COLUMNS = ("margin", "unit", "instant_s", "antecedent_met")


@dataclass
class Requirement:
    """A requirement and its tests: id and outcome of each, in their order.

    ``shown``: what the runs of a test have shown of the sentence that it requires, by columns of the table.
    """

    name: str
    tests: dict[str, str] = field(default_factory=dict)
    shown: dict[str, Mapping[str, object]] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        """FAILED if one of its tests failed, PASSED if one passed and none failed, else NOT SHOWN."""
        said = {SAYS[outcome] for outcome in self.tests.values()}
        return next(verdict for verdict in _ORDER if verdict in said)


def requirements(reports: Iterable[tuple[str, str, Sequence[tuple[str, object]]]]) -> list[Requirement]:
    """The requirements of all tests by name.

    :param reports: outcome, test and its properties; of several reports of a test the worst counts.
    """
    found: dict[str, Requirement] = {}
    worst = list(SAYS)
    for outcome, test, properties in reports:
        if outcome not in SAYS:
            continue
        sentences = {
            key.removeprefix(f"{PROPERTY}."): json.loads(str(value))
            for key, value in properties
            if key.startswith(f"{PROPERTY}.")
        }
        for key, value in properties:
            if key == PROPERTY:
                one = found.setdefault(str(value), Requirement(str(value)))
                shown = sentences.get(one.name, {})
                said = "not shown" if outcome == "failed" and shown.get("verdict") == NOT_SHOWN else outcome
                one.tests[test] = min(said, one.tests.get(test, said), key=worst.index)
                if shown:
                    one.shown[test] = shown
    return sorted(found.values(), key=lambda one: one.name)


def folder_name(test: str) -> str:
    """Name of the first run folder of a test, by file, test and parameters; a further one has a number after it.

    :param test: its id, ``folder/test_file.py::test_name[parameter]``.
    """
    file, _, rest = test.partition("::")
    return re.sub(r"[^\w.@=+-]+", "_", f"{Path(file).stem}.{rest.replace('::', '.')}").strip("_")[:120] or "run"


def lines(found: Sequence[Requirement]) -> list[str]:
    """One line for each requirement, then its tests that have not passed."""
    width = max(len(one.name) for one in found)
    said = []
    for one in found:
        passed = sum(outcome == "passed" for outcome in one.tests.values())
        said.append(f"{one.name:{width}}  {one.verdict:9}  {passed} of {len(one.tests)} tests passed")
        said += [f"{'':{width}}  {outcome}: {test}" for test, outcome in one.tests.items() if outcome != "passed"]
    return said


def write(found: Sequence[Requirement], folder: Path) -> Path:
    """Write the table, one row for each test of each requirement; returns its path."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / FILE_NAME
    with path.open("w", encoding="utf-8", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(("requirement", "verdict", "test", "outcome", *COLUMNS))
        for one in found:
            for test, outcome in one.tests.items():
                shown = one.shown.get(test, {})
                rows.writerow((one.name, one.verdict, test, outcome, *(shown.get(name) for name in COLUMNS)))
    return path
