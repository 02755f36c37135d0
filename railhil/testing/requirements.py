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
FAILED, PASSED, NOT_SHOWN, NO_TEST = "FAILED", "PASSED", "NOT SHOWN", "NO TEST"
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
        """FAILED if one of its tests failed, PASSED if one passed and none failed, else NOT SHOWN; NO TEST without
        one."""
        said = {SAYS[outcome] for outcome in self.tests.values()}
        return next((verdict for verdict in _ORDER if verdict in said), NO_TEST)

    @property
    def counted(self) -> str:
        """How many of its tests passed, in words."""
        passed = sum(outcome == "passed" for outcome in self.tests.values())
        return f"{passed} of {len(self.tests)} tests passed" if self.tests else "no test names it"


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


def with_list(found: Sequence[Requirement], names: Iterable[str]) -> list[Requirement]:
    """The requirements of a list in its order, those without a test, too."""
    known = {one.name: one for one in found}
    return [known.get(name, Requirement(name)) for name in names]


def write_list(found: Sequence[Requirement], source: Path, folder: Path) -> Path:
    """Write a copy of a list with the results; returns its path.

    :raises InputError: the list cannot be read.
    """
    from railhil.common.version import full_version
    from railhil.judge.requirements.lists import Result, write_results

    out = folder / f"{source.stem}_results{source.suffix}"
    results = {}
    for one in found:
        tests = "; ".join(f"{test}: {outcome}" for test, outcome in one.tests.items())
        said = ": ".join(filter(None, (one.counted, tests)))
        results[one.name] = Result(one.verdict, f"{said}, railhil {full_version()}")
    write_results(source, results, out)
    return out


def lines(found: Sequence[Requirement]) -> list[str]:
    """One line for each requirement, then its tests that have not passed."""
    width = max(len(one.name) for one in found)
    said = []
    for one in found:
        said.append(f"{one.name:{width}}  {one.verdict:9}  {one.counted}")
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
