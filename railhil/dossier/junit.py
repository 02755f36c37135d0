"""What sessions of pytest have left: ``requirements.csv``, and JUnit reports, of users' tests and of railhil's own."""

from __future__ import annotations

import csv
import json
import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_bytes, given_json, given_text, refuse_unreadable
from railhil.dossier.evidence import Evidence, places_of
from railhil.record.hash_list import changed_files, read_hash_list
from railhil.testing.requirements import COLUMNS, FILE_NAME, PROPERTY, SAYS, folder_name, requirements

#: What ``railhil doctor --json`` has printed.
DOCTOR = "doctor.json"
#: Properties of a test of railhil itself that name the code under test.
CODE, VERSION = "code_sha256", "railhil"
_HASH = re.compile(r"frames_sha256(\.\d+)?")
_WRITTEN = "a JUnit report of pytest"
_UNIT = "unit"
_MARGIN = (float, int, type(None))
#: Element of a JUnit case -> outcome of its test.
_ENDS = {"failure": "failed", "error": "error", "skipped": "skipped"}


@dataclass
class _Runs:
    """Of a test: the files that name it, the numbers of the evidence of its runs, and how many have no evidence."""

    files: dict[str, None] = field(default_factory=dict)
    numbers: set[int] = field(default_factory=set)
    missing: int = 0


@dataclass(frozen=True)
class Test:
    """A test of a requirement: its id, its outcome, and the files that say so.

    ``shown``: what its runs have shown of the sentence. ``runs``: numbers of the evidence of its runs. ``missing``:
    number of its runs that are not among the evidence. ``changed``: the files that are not as the list of a folder
    above them says; ``unlisted``: those in no list.
    """

    requirement: str
    name: str
    outcome: str
    files: tuple[str, ...]
    shown: Mapping[str, Any]
    runs: tuple[int, ...]
    missing: int
    changed: tuple[str, ...] = ()
    unlisted: tuple[str, ...] = ()

    @property
    def is_counted(self) -> bool:
        """Whether one of its files tells how many runs it made: a table does not."""
        return any(Path(name).name != FILE_NAME for name in self.files)

    @property
    def result(self) -> str:
        """FAILED, PASSED or NOT SHOWN."""
        return SAYS[self.outcome]


def test_files(given: Sequence[Path], evidence: Iterable[Evidence]) -> Iterator[Path]:
    """The tables of requirements and the JUnit reports at and below the given folders, but those of runs."""
    # A list of hashes beside a table does not make its folder one of a run.
    runs = {one.folder.resolve() for one in evidence if one.is_record}
    for place in (place for folder in given for place in places_of(folder) if place.resolve() not in runs):
        for path in sorted(place.iterdir()):
            if (path.name == FILE_NAME or path.suffix.lower() == ".xml") and path.is_file():
                yield path


def read_tests(files: Iterable[Path], evidence: Sequence[Evidence]) -> list[Test]:
    """The tests of each requirement; a test that stands in a table and in a JUnit report is one.

    :raises InputError: a file cannot be read.
    """
    reports: list[tuple[str, str, Sequence[tuple[str, object]]]] = []
    runs: dict[str, _Runs] = {}
    names: dict[str, str] = {}
    found = {one.document.get("frames_sha256"): one.number for one in reversed(evidence)}
    # Tables have the ids of pytest, reports their own names of the same tests.
    places = sorted(files, key=lambda one: one.name != FILE_NAME)
    folders = {one.folder.resolve(): one for one in evidence}
    listed = {str(path): _is_as_listed(path, folders) for path in places}
    for path in places:
        for outcome, test, properties in _of_table(path) if path.name == FILE_NAME else _of_junit(path):
            name = names.setdefault(_in_junit(test), test)
            reports.append((outcome, name, properties))
            own = runs.setdefault(name, _Runs())
            own.files[str(path)] = None
            if path.name == FILE_NAME:
                own.numbers |= set(_beside(path, test, folders))
            hashes = [value for key, value in properties if _HASH.fullmatch(key)]
            own.numbers |= {found[value] for value in hashes if value in found}
            own.missing = max(own.missing, sum(value not in found for value in hashes))
    return [
        Test(one.name, test, outcome, tuple(runs[test].files), one.shown.get(test, {}),
             tuple(sorted(runs[test].numbers)), runs[test].missing,
             *(tuple(name for name in runs[test].files if listed[name] is state) for state in (False, None)))
        for one in requirements(reports)
        for test, outcome in one.tests.items()
    ]  # fmt: skip


def _is_as_listed(path: Path, folders: Collection[Path]) -> bool | None:
    """Whether a file has the hash that the list of a folder of evidence above it has; None: no list has it."""
    place = path.resolve()
    for folder in (one for one in place.parents if one in folders):
        name = place.relative_to(folder).as_posix()
        try:
            hashes = read_hash_list(folder) or {}
        except InputError:
            # The folder has this problem already.
            return False
        if name in hashes:
            return not any(changed_files(folder, {name: hashes[name]}))
    return None


def _in_junit(name: str) -> str:
    """The id of a test as JUnit has it: ``folder.test_file.test_name[parameter]``."""
    place, bracket, parameter = name.partition("[")
    return place.replace(".py::", ".").replace("::", ".").replace("/", ".") + bracket + parameter


def _beside(path: Path, test: str, folders: Mapping[Path, Evidence]) -> Iterator[int]:
    """The runs of a test beside its table, by the names of their folders."""
    name = re.compile(rf"{re.escape(folder_name(test))}(-\d+)?")
    place = path.resolve().parent
    for folder, one in folders.items():
        if folder.parent == place and name.fullmatch(one.folder.name):
            yield one.number


_Report: TypeAlias = tuple[str, str, list[tuple[str, str]]]


def _of_table(path: Path) -> Iterator[_Report]:
    """Outcome, test and properties of each row."""
    with refuse_unreadable(path, "a table of requirements as pytest has written it"):
        for row in csv.DictReader(given_text(path).splitlines()):
            name, test, outcome = (row.get(key) for key in (PROPERTY, "test", "outcome"))
            if not name or not test or outcome not in SAYS:
                raise ValueError(f"columns {PROPERTY}, test and outcome")
            shown = {key: row[key] if key == _UNIT else float(row[key]) for key in COLUMNS if row.get(key)}
            yield str(outcome), test, [(PROPERTY, name), (f"{PROPERTY}.{name}", json.dumps(shown))]


def _of_junit(path: Path) -> Iterator[_Report]:
    for case in _cases(path)[1]:
        properties = [(entry.get("name", ""), entry.get("value", "")) for entry in case.iter("property")]
        with refuse_unreadable(path, _WRITTEN):
            for key, value in properties:
                shown = json.loads(value) if key.startswith(f"{PROPERTY}.") else {}
                if not isinstance(shown, dict) or not isinstance(shown.get(COLUMNS[0]), _MARGIN):
                    raise ValueError(f"property {key}: {value}")
        if any(key == PROPERTY for key, _ in properties):
            yield _outcome(case), f"{case.get('classname')}.{case.get('name')}", properties


def _cases(path: Path) -> tuple[ET.Element, list[ET.Element]]:
    with refuse_unreadable(path, _WRITTEN):
        content = given_bytes(path)
    try:
        root = ET.fromstring(content)
    except ET.ParseError as error:
        raise InputError(path, "", Words("cannot be read"), _WRITTEN, str(error)) from None
    return root, list(root.iter("testcase"))


def _outcome(case: ET.Element) -> str:
    return next((said for element, said in _ENDS.items() if case.find(element) is not None), "passed")


@dataclass(frozen=True)
class Validation:
    """Results of railhil's own tests.

    ``versions``, ``codes``: that they tested, and a word if a report names none. ``outcomes``: number of tests by
    outcome. ``doctor``: what ``railhil doctor`` said of the machine; empty: nothing.
    """

    files: tuple[str, ...] = ()
    versions: tuple[str, ...] = ()
    codes: tuple[str, ...] = ()
    begun: str = ""
    hosts: tuple[str, ...] = ()
    outcomes: Mapping[str, int] = field(default_factory=dict)
    failed: tuple[str, ...] = ()
    doctor: Mapping[str, str] = field(default_factory=dict)


def read_validation(folder: Path) -> Validation:
    """The JUnit reports in a folder, and ``doctor.json``.

    :raises InputError: there is no report, or one cannot be read.
    """
    files = sorted(folder.rglob("*.xml")) if folder.is_dir() else []
    if not files:
        found = Words("has no JUnit report" if folder.exists() else "does not exist")
        raise InputError(folder, "", found, "the folder of what railhil's own tests have left (make test)")
    outcomes: Counter[str] = Counter()
    failed: list[str] = []
    said: dict[str, dict[str, None]] = {CODE: {}, VERSION: {}, "timestamp": {}, "hostname": {}}
    for path in files:
        root, cases = _cases(path)
        outcomes.update(map(_outcome, cases))
        failed += [f"{one.get('classname')}.{one.get('name')}" for one in cases if _outcome(one) in ("failed", "error")]
        properties = [(entry.get("name"), entry.get("value", "")) for entry in root.iter("property")]
        for key in (CODE, VERSION):
            said[key] |= dict.fromkeys([value for name, value in properties if name == key] or ["not named"])
        for suite in root.iter("testsuite"):
            for key in ("timestamp", "hostname"):
                said[key] |= {suite.get(key, ""): None}
    told: dict[str, str] = {}
    if (path := folder / DOCTOR).is_file():
        document = given_json(path, "what railhil doctor --json has printed")
        findings = [one for one in document.get("findings") or () if isinstance(one, dict)]
        told = {name: text for name, text in document.items() if isinstance(text, str)}
        told |= {str(one.get("subject")): str(one.get("found")) for one in findings}
    return Validation(
        files=tuple(str(path.relative_to(folder)) for path in files),
        versions=tuple(said[VERSION]),
        codes=tuple(said[CODE]),
        begun=min(filter(None, said["timestamp"]), default=""),
        hosts=tuple(filter(None, said["hostname"])),
        outcomes=dict(sorted(outcomes.items())),
        failed=tuple(failed),
        doctor=told,
    )
