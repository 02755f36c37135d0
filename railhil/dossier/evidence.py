"""Folders of evidence: found below the given ones, checked as ``railhil verify`` does, and read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_json
from railhil.judge.evidence import Checked, check_folder_alone, folders_below, is_evidence, signature_sentence
from railhil.judge.record import Record
from railhil.judge.requirements.outcome import Outcome, judge_requirements
from railhil.judge.requirements.requirement import Requirement, requirements_from_json
from railhil.judge.requirements.sentence import VIOLATED
from railhil.record.documents import CERTIFICATE, SCORE
from railhil.record.framelog import LOG_NAME, sha256_of
from railhil.record.hash_list import DOCUMENTS, HASH_LIST
from railhil.record.signature import signed
from railhil.scenarios.model import watch_sentence
from railhil.scenarios.settings import REQUIREMENTS, required

#: Document of a dossier, which is no evidence of another one.
DOSSIER = "dossier.json"
RUN = "run"
_SUMMARY = "summary.json"
_SEARCHES = ("hunt.json", "probability.json")


@dataclass(frozen=True, slots=True)
class Judged:
    """What a run shows of a requirement. ``why_not``: why its sentence cannot be judged on the run; empty: it is."""

    requirement: Requirement
    outcome: Outcome | None = None
    why_not: str = ""


@dataclass(frozen=True)
class Evidence:
    """A folder, checked and read.

    ``problems``: why it does not count, a sentence each. ``signature``: who has signed it, or a folder above it;
    ``signed``: whether anybody has. Of a run that can be read: ``title``, ``verdict``, ``judged``, ``deviations``, and
    ``document``, its certificate. ``searched``: summary of a hunt or a probability. ``copy_of``: number of the folder
    with the same record.
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
    title: str = ""
    verdict: str = ""
    reasons: str = ""
    judged: tuple[Judged, ...] = ()
    deviations: tuple[str, ...] = ()
    document: dict[str, Any] = field(default_factory=dict, repr=False)
    searched: dict[str, Any] = field(default_factory=dict, repr=False)
    published: tuple[str, Sequence[Any]] | None = field(default=None, repr=False)
    copy_of: int | None = None

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
        own = list(_walk(folder)) if folder.is_dir() else []
        if not own:
            missing = Words("does not exist" if not folder.exists() else "has no evidence")
            raise InputError(folder, "", missing, f"a folder with run folders, or with one of {', '.join(DOCUMENTS)}")
        found |= {path.resolve(): path for path in own if path.resolve() not in found}
    return list(found.values())


def _walk(folder: Path) -> Iterator[Path]:
    if (folder / DOSSIER).is_file():
        return
    has_log = (folder / LOG_NAME).is_file()
    if has_log or is_evidence(folder):
        yield folder
    if not has_log and not (folder / CERTIFICATE).is_file():
        for path in sorted(folder.iterdir()):
            if path.is_dir() and not path.is_symlink() and not path.name.startswith("."):
                yield from _walk(path)


def read_evidence(folders: Sequence[Path], claims: Sequence[Requirement], key: Path | None) -> Iterator[Evidence]:
    """Check and read folders of evidence, those above before those below.

    :param claims: by which each run is judged, beside its own requirements.
    :param key: that must have signed; None: a signature is not asked for.
    :raises InputError: the key is none.
    """
    above: dict[Path, Evidence] = {}
    records: dict[str, int] = {}
    for number, folder in enumerate(folders, 1):
        found = _read(number, folder, claims, key, above.get(folder.resolve()), records)
        yield found[0]
        above |= {(folder / name).resolve(): found[0] for name in folders_below(folder, found[1])}


def _read(
    number: int,
    folder: Path,
    claims: Sequence[Requirement],
    key: Path | None,
    above: Evidence | None,
    records: dict[str, int],
) -> tuple[Evidence, Checked]:
    checked = check_folder_alone(folder)
    problems = [without_folder(said, folder) for said in checked.problems]
    has_list = (folder / HASH_LIST).is_file()
    said, is_good = signature_sentence(signed(folder, key) if has_list else None, key)
    is_signed = said.startswith("signed")
    if not is_signed and above is not None and above.signed:
        inner = f"{folder.resolve().relative_to(above.folder.resolve()).as_posix()}/{HASH_LIST}"
        if not any(problem.startswith(f"{inner}: ") for problem in above.problems):
            said, is_good, is_signed = f"{above.signature}, in the list of {above.name}", True, True
    if not is_good:
        problems.append(said)
    if not has_list and not (folder / CERTIFICATE).is_file():
        problems.append("the run did not come to its end: there is no certificate")
    record = checked.record
    kind = next((name for name in DOCUMENTS if (folder / name).is_file()), "")
    own: dict[str, Any] = {}
    if record is not None:
        own = _of_run(record, claims)
        own["copy_of"] = records.setdefault(record.frames_sha256, number) if not problems else None
        own["copy_of"] = None if own["copy_of"] == number else own["copy_of"]
    elif kind == CERTIFICATE:
        own = _of_damaged(folder)
    elif kind in _SEARCHES:
        own = {"searched": _searched(folder, problems)}
    made = Evidence(
        number=number,
        folder=folder,
        kind=RUN if kind in (CERTIFICATE, "") else kind.removesuffix(".json"),
        problems=tuple(problems),
        unchecked=tuple(without_folder(said, folder) for said in checked.unchecked),
        remarks=tuple(without_folder(said, folder) for said in checked.remarks),
        signature=said,
        signed=is_signed,
        list_sha256=sha256_of(folder / HASH_LIST) if has_list else "",
        **own,
    )
    return made, checked


def without_folder(said: str, folder: Path) -> str:
    """A sentence on a file of a folder that is named beside it."""
    return said.replace(f"{folder}/", "").removeprefix(f"{folder}: ")


def _of_run(record: Record, claims: Sequence[Requirement]) -> dict[str, Any]:
    judging = record.judging
    return {
        "title": record.title,
        "verdict": record.verdict,
        "reasons": "" if record.passed else record.line,
        "judged": tuple(_judged(record, claims)),
        "deviations": tuple(_deviations(record)),
        "document": record.certificate,
        "published": judging.deviations() if record.scenario.published and judging.deviations else None,
    }


def _judged(record: Record, claims: Sequence[Requirement]) -> Iterator[Judged]:
    """The requirements by which the run was judged, and then the others."""
    path = record.folder / CERTIFICATE
    own = requirements_from_json(required(record.certificate, path), path)
    for requirement in own:
        yield Judged(requirement, record.requirements[requirement.id])
    known = {one.id for one in own}
    for requirement in claims:
        if requirement.id not in known:
            try:
                (outcome,) = judge_requirements(record, [requirement])
            except InputError as error:
                yield Judged(requirement, None, f"its sentence does not fit the scenario: {error.difference}")
            else:
                yield Judged(requirement, outcome)


def _of_damaged(folder: Path) -> dict[str, Any]:
    """What the documents of a folder say that does not check: it can only speak against a requirement."""
    try:
        document = given_json(folder / CERTIFICATE, "a certificate")
        found = requirements_from_json(required(document, folder / CERTIFICATE), folder / CERTIFICATE)
    except InputError:
        # The folder is among the gaps already.
        return {}
    try:
        said = given_json(folder / SCORE, "a score").get(REQUIREMENTS) or []
        violated = {one.get("id") for one in said if one.get("verdict") == VIOLATED}
    except (InputError, AttributeError):
        # Likewise.
        violated = set()
    judged = (Judged(one, Outcome(one.id, one.says, VIOLATED) if one.id in violated else None) for one in found)
    title = f"{document.get('controller')} on {document.get('scenario')}, seed {document.get('seed')}"
    return {"title": title, "judged": tuple(judged), "document": document}


def _searched(folder: Path, problems: list[str]) -> dict[str, Any]:
    """The summary of a hunt or a probability; empty: it is not finished."""
    try:
        return given_json(folder / _SUMMARY, "the summary of a finished search")
    except InputError as error:
        problems.append(without_folder(str(error), folder))
        return {}


def _deviations(record: Record) -> Iterator[str]:
    """What an assessor has to know of a run before its margins."""
    certificate = record.certificate
    yield from filter(None, (record.caution, watch_sentence(record.scenario)))
    if record.invalid:
        yield f"the run is INVALID: {record.invalid}"
    if certificate.get("pace") == "realtime":
        yield "the run kept real time: made again, its frames have other instants"
    if certificate.get("foreign"):
        yield "the controller was a board or another program: law and arithmetic are as it reported them"
    if certificate.get("not_witnessed"):
        yield f"{', '.join(certificate['not_witnessed'])}: their owners did not say which frames they sent"
    if certificate.get("other_frames"):
        yield f"{certificate['other_frames']} frames of the record are of nobody in the contract"
    if certificate.get("branched_from"):
        yield "the run is a branch of another run"
    if not record.passed and not record.invalid:
        yield "the run is FAIL: its folder says why"
