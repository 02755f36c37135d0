"""Folders of evidence: found below the given ones, checked as ``railhil verify`` does, and read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_json, refuse_unreadable
from railhil.index.find import RUN
from railhil.judge.evidence import Checked, check_folder_alone, folders_below, is_evidence, signature_sentence
from railhil.judge.record import Record
from railhil.judge.requirements.outcome import Outcome, judge_requirements
from railhil.judge.requirements.requirement import Requirement, requirements_from_json
from railhil.judge.requirements.sentence import VIOLATED
from railhil.record.documents import CERTIFICATE, SCORE, SUMMARY
from railhil.record.framelog import LOG_NAME, sha256_of
from railhil.record.hash_list import DOCUMENTS, HASH_LIST
from railhil.record.signature import signed
from railhil.scenarios.model import watch_sentence
from railhil.scenarios.settings import REQUIREMENTS, required

#: Document of a dossier, which is no evidence of another one.
DOSSIER = "dossier.json"
_SEARCHES = ("hunt.json", "probability.json")
_WRITTEN = "what railhil has written"
#: Key of a certificate that is not usual -> what it says.
_DEVIATIONS = {
    "foreign": "the controller was a board or another program: law and arithmetic are as it reported them",
    "not_witnessed": "some nodes did not say which frames they sent",
    "other_frames": "the record has frames that are not of its wire contract",
    "branched_from": "the run is a branch of another run",
}


@dataclass(frozen=True, slots=True)
class Judged:
    """What a run shows of a requirement. ``why_not``: why its sentence cannot be judged on the run; empty: it is."""

    requirement: Requirement
    outcome: Outcome | None = None
    why_not: str = ""


@dataclass(frozen=True, slots=True)
class Searched:
    """What a hunt or a probability has found of a requirement, in words; ``violations``: number of runs against it."""

    requirement: Requirement
    runs: int
    violations: int
    said: str


@dataclass(frozen=True)
class Evidence:
    """A folder, checked and read.

    ``problems``: why it does not count, a sentence each. ``signature``: who has signed it, or a folder above it;
    ``signed``: whether anybody has. Of a run: ``title``, ``verdict``, ``judged``, ``deviations``, and ``document``, its
    certificate. ``copy_of``: number of the folder with the same record.
    """

    number: int
    folder: Path
    kind: str
    problems: tuple[str, ...]
    unchecked: tuple[str, ...]
    remarks: tuple[str, ...]
    signature: str
    signed: bool
    list_sha256: str
    copy_of: int | None = None
    title: str = ""
    verdict: str = ""
    reasons: str = ""
    judged: tuple[Judged, ...] = ()
    searched: tuple[Searched, ...] = ()
    deviations: tuple[str, ...] = ()
    document: Mapping[str, Any] = field(default_factory=dict, repr=False)
    published: tuple[str, Sequence[Any]] | None = field(default=None, repr=False)

    @property
    def is_record(self) -> bool:
        """Whether it is the folder of a run, finished or not."""
        return any((self.folder / name).is_file() for name in (LOG_NAME, CERTIFICATE))

    @property
    def name(self) -> str:
        """By which the dossier refers to it."""
        return f"E{self.number}"


def folders_of(given: Sequence[Path]) -> list[Path]:
    """The folders of evidence at and below the given ones, each once.

    :raises InputError: there is no such folder, or it has no evidence.
    """
    found: dict[Path, Path] = {}
    for folder in given:
        own = [path for path in places_of(folder) if (path / LOG_NAME).is_file() or is_evidence(path)]
        if not own:
            missing = Words("does not exist" if not folder.exists() else "has no evidence")
            raise InputError(folder, "", missing, f"a folder with run folders, or with one of {', '.join(DOCUMENTS)}")
        found |= {path.resolve(): path for path in own if path.resolve() not in found}
    return list(found.values())


def places_of(folder: Path) -> Iterator[Path]:
    """A folder and those below it, but for dossiers and what is in the folder of a run.

    :raises InputError: one of them cannot be read.
    """
    places = [folder] if folder.is_dir() else []
    while places:
        place = places.pop()
        if (place / DOSSIER).is_file():
            continue
        yield place
        if not any((place / name).is_file() for name in (LOG_NAME, CERTIFICATE)):
            with refuse_unreadable(place, "a folder that can be read"):
                below = [one for one in place.iterdir() if one.is_dir() and not one.is_symlink()]
            places += sorted((one for one in below if not one.name.startswith(".")), reverse=True)


def read_evidence(folders: Sequence[Path], listed: Sequence[Requirement], key: Path | None) -> Iterator[Evidence]:
    """Check and read folders of evidence, those above before those below.

    :param listed: requirements by which each run is judged, in place of its own of the same ids.
    :param key: that must have signed; None: a signature is not asked for.
    :raises InputError: the key is none.
    """
    #: A folder below another one -> that one, and the name of the list there.
    above: dict[Path, tuple[Evidence, str]] = {}
    records: dict[str, int] = {}
    for number, folder in enumerate(folders, 1):
        checked = check_folder_alone(folder)
        problems = [_bare(said, folder) for said in checked.problems]
        own = _content(folder, checked, listed, problems)
        has_list = (folder / HASH_LIST).is_file()
        said, is_good = signature_sentence(signed(folder, key) if has_list else None, key)
        is_signed = said.startswith("signed")
        outer, name = above.get(folder.resolve(), (None, ""))
        if outer and outer.signed and not is_signed and not any(one.startswith(f"{name}: ") for one in outer.problems):
            said, is_good, is_signed = f"{outer.signature}, in the list of {outer.name}", True, True
        problems += [] if is_good else [said]
        sha256 = str(own["document"].get("frames_sha256")) if "document" in own and not problems else f"E{number}"
        first = records.setdefault(sha256, number)
        kind = next((name for name in DOCUMENTS if (folder / name).is_file()), CERTIFICATE)
        found = Evidence(
            number=number,
            folder=folder,
            kind=RUN if kind == CERTIFICATE else kind.removesuffix(".json"),
            problems=tuple(problems),
            unchecked=tuple(_bare(one, folder) for one in checked.unchecked),
            remarks=tuple(_bare(one, folder) for one in checked.remarks),
            signature=said,
            signed=is_signed,
            list_sha256=sha256_of(folder / HASH_LIST) if has_list else "",
            copy_of=None if first == number else first,
            **own,
        )
        above |= {(folder / one).resolve(): (found, f"{one}/{HASH_LIST}") for one in folders_below(folder, checked)}
        yield found


def _bare(said: str, folder: Path) -> str:
    """A sentence on a file of a folder that is named beside it."""
    return said.replace(f"{folder}/", "").removeprefix(f"{folder}: ")


def _content(folder: Path, checked: Checked, listed: Sequence[Requirement], problems: list[str]) -> dict[str, Any]:
    """What a folder says, by the names of :class:`Evidence`; ``problems`` gets what cannot be read."""
    try:
        if checked.record is not None:
            return _of_run(checked.record, listed)
        if not (folder / CERTIFICATE).is_file():
            if (folder / LOG_NAME).is_file():
                problems.append("the run did not come to its end: there is no certificate")
            is_search = any((folder / name).is_file() for name in _SEARCHES)
            return {"searched": tuple(_searched(given_json(folder / SUMMARY, _WRITTEN)))} if is_search else {}
    except InputError as error:
        problems.append(_bare(str(error), folder))
    except (KeyError, TypeError, ValueError, AttributeError):
        problems.append(f"{SUMMARY}: other keys than railhil writes")
    return _of_damaged(folder)


def _of_run(record: Record, listed: Sequence[Requirement]) -> dict[str, Any]:
    judging = record.judging
    others: list[str] = []
    judged = tuple(_judged(record, listed, others))
    return {
        "title": record.title,
        "verdict": record.verdict,
        "reasons": "" if record.passed else record.line,
        "judged": judged,
        "deviations": (*others, *_deviations(record)),
        "document": record.certificate,
        "published": judging.deviations() if record.scenario.published and judging.deviations else None,
    }


def _judged(record: Record, listed: Sequence[Requirement], others: list[str]) -> Iterator[Judged]:
    """The run by the requirements of the list, then by its own ones.

    :param others: gets a sentence on each of its own that differs from that of the list.
    """
    path = record.folder / CERTIFICATE
    own = {one.id: one for one in requirements_from_json(required(record.certificate, path), path)}
    for requirement in listed:
        if not is_same(mine := own.pop(requirement.id, requirement), requirement):
            others.append(f"when it was made, {mine.id} was another sentence: {mine.says}")
        try:
            yield Judged(requirement, judge_requirements(record, [requirement])[0])
        except InputError as error:
            yield Judged(requirement, None, f"its sentence does not fit the scenario: {error.difference}")
    yield from (Judged(one, record.requirements[one.id]) for one in own.values())


def is_same(one: Requirement, other: Requirement | None) -> bool:
    """Whether two requirements of one id have one meaning."""
    return other is not None and (one.says, one.define, one.when) == (other.says, other.define, other.when)


def _of_damaged(folder: Path) -> dict[str, Any]:
    """What the documents of a run folder say that does not check: it can only speak against a requirement."""
    try:
        document = given_json(folder / CERTIFICATE, _WRITTEN)
        found = requirements_from_json(required(document, folder / CERTIFICATE), folder / CERTIFICATE)
        said = given_json(folder / SCORE, _WRITTEN).get(REQUIREMENTS) or []
        violated = [one["id"] for one in said if one["verdict"] == VIOLATED]
    except (InputError, KeyError, TypeError):
        # The folder is among the gaps already.
        return {}
    known = {key: text for key, text in document.items() if isinstance(text, str)}
    judged = (Judged(one, Outcome(one.id, one.says, VIOLATED) if one.id in violated else None) for one in found)
    title = f"{known.get('controller')} on {known.get('scenario')}"
    return {"title": title, "judged": tuple(judged), "document": known}


def _searched(summary: Mapping[str, Any]) -> Iterator[Searched]:
    """The requirements of a hunt or a probability.

    :raises KeyError, TypeError, ValueError, AttributeError: it is the summary of neither.
    """
    if "p" in summary:
        said, low, high = f"a drawn run violates it with P = {summary['p']:.2g}", summary["low"], summary["high"]
        said += ", no interval" if low is None else f", 95 % interval {low:.2g} to {high:.2g}"
        one = summary["requirement"]
        yield Searched(Requirement(str(one["id"]), str(one["says"])), int(summary["runs"]), 0, said)
        return
    for one in summary["requirements"]:
        runs, violations = int(one["runs"]), int(one["violations"])
        said = f"not found in {count_of(runs, 'run', spec=',')} (its antecedent was met in {one['antecedent_met']:,})"
        said += "" if one["margin"] is None else f", nearest margin {one['margin']:.4g} {one['unit']}"
        if violations or not runs:
            said = f"violated in {count_of(violations, 'run')} of {runs:,}" if runs else "judged in no run"
        yield Searched(Requirement(str(one["id"]), str(one["says"])), runs, violations, said)


def _deviations(record: Record) -> Iterator[str]:
    """What an assessor has to know of a run before its margins."""
    certificate = record.certificate
    yield from filter(None, (record.caution, watch_sentence(record.scenario)))
    for key, said in _DEVIATIONS.items():
        if certificate.get(key):
            yield said
    if certificate.get("pace") == "realtime":
        yield "the run kept real time: made again, its frames have other instants"
    if record.verdict != "PASS":
        yield f"the run is {record.verdict}: its folder says why"
