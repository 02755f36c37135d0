"""The requirements that the tests of a session show, and the results."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

#: Name of the property of a test, in the JUnit report too.
PROPERTY = "requirement"
#: Name of the table in the folder of the session's runs.
FILE_NAME = "requirements.csv"
#: Outcomes of pytest -> result of a requirement; the worst comes first.
_SAYS: Mapping[str, str] = {
    "error": "FAILED",
    "failed": "FAILED",
    "xpassed": "FAILED",
    "xfailed": "FAILED",
    "skipped": "NOT SHOWN",
    "passed": "PASSED",
}
_ORDER = ("FAILED", "PASSED", "NOT SHOWN")


@dataclass
class Requirement:
    """A requirement and its tests: id and outcome of each, in their order."""

    name: str
    tests: dict[str, str] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        """FAILED if one of its tests failed, PASSED if one passed and none failed, else NOT SHOWN."""
        said = {_SAYS[outcome] for outcome in self.tests.values()}
        return next(verdict for verdict in _ORDER if verdict in said)


def requirements(reports: Iterable[tuple[str, str, Sequence[tuple[str, object]]]]) -> list[Requirement]:
    """The requirements of all tests by name.

    :param reports: outcome, test and its properties; of several reports of a test the worst counts.
    """
    found: dict[str, Requirement] = {}
    worst = list(_SAYS)
    for outcome, test, properties in reports:
        if outcome not in _SAYS:
            continue
        for key, value in properties:
            if key == PROPERTY:
                tests = found.setdefault(str(value), Requirement(str(value))).tests
                tests[test] = min(outcome, tests.get(test, outcome), key=worst.index)
    return sorted(found.values(), key=lambda one: one.name)


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
        rows.writerow(("requirement", "verdict", "test", "outcome"))
        for one in found:
            rows.writerows((one.name, one.verdict, test, outcome) for test, outcome in one.tests.items())
    return path
