"""A dossier: its claims, its evidence, the tool that made it, the gaps of all of these, and its folder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.user_files import whole_file
from railhil.common.version import full_version
from railhil.dossier.claims import NONE, NOT_SHOWN, SHOWN, Claim, by_key, claims_of, named
from railhil.dossier.evidence import DOSSIER, Evidence, folders_of, read_evidence
from railhil.dossier.junit import Validation, read_tests, read_validation, test_files
from railhil.index.find import RUN
from railhil.judge.requirements.lists import Result, write_results
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.sentence import VIOLATED
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, REPORT, write_hash_list
from railhil.record.run_folder import json_text, recorded_by
from railhil.record.signature import SIGNATURE, sign_list

#: Endings of versions that name no commit.
_UNNAMED = (".dirty", "+unknown")


@dataclass(frozen=True)
class Tool:
    """A railhil that made evidence. ``validated``: whether the given validation is of this code and nothing failed in
    it; ``said``: the same in words."""

    version: str
    code_sha256: str
    made: Sequence[Evidence]
    validated: bool
    said: str


@dataclass(frozen=True)
class Dossier:
    """``doctor``: versions and properties of a machine."""

    claims: Sequence[Claim]
    evidence: Sequence[Evidence]
    validation: Validation | None
    doctor: Mapping[str, str]
    written: Mapping[str, str] = field(default_factory=dict)

    @property
    def is_complete(self) -> bool:
        """Whether each requirement is shown, all evidence checks, and no test of the validation failed."""
        has_failed = self.validation is not None and bool(self.validation.failed)
        doubtful = any(one.problems for one in self.evidence)
        return not has_failed and not doubtful and all(one.verdict == SHOWN for one in self.claims)

    @property
    def headline(self) -> str:
        """The result in a line."""
        counts = {word: sum(one.verdict == word for one in self.claims) for word in (SHOWN, VIOLATED, NOT_SHOWN, NONE)}
        said = ", ".join(
            f"{count} {'without evidence' if word == NONE else word}" for word, count in counts.items() if count
        )
        checks = sum(not one.problems for one in self.evidence)
        folders = count_of(len(self.evidence), "folder")
        return (
            f"{count_of(len(self.claims), 'requirement')}: {said or 'none'}. {folders} of evidence, {checks} as listed."
        )

    @property
    def tools(self) -> list[Tool]:
        """The tools of the evidence, by version and code."""
        made = by_key(
            ((str(version), str(one.document.get("code_sha256"))), one)
            for one in self.evidence
            if (version := one.document.get("railhil"))
        )
        return [Tool(*key, items, *self._validated(key[1])) for key, items in made.items()]

    def _validated(self, code: str) -> tuple[bool, str]:
        found = self.validation
        if found is None:
            return False, "no results of railhil's own tests are here (--validation DIR)"
        if found.codes != (code,):
            return False, "the results of railhil's own tests are not, or not all, of its code"
        counts = ", ".join(f"{count:,} {outcome}" for outcome, count in found.outcomes.items())
        return not found.failed, f"its own tests: {counts}"

    @property
    def gaps(self) -> list[str]:
        """All gaps, those of the claims first."""
        return [*self._of_claims(), *self._of_evidence(), *self._of_tools()]

    def _of_claims(self) -> Iterator[str]:
        if not self.claims:
            yield "there is no requirement: no list was given, and no run, test or search names one"
        yield from (f"{one.id} {one.verdict}: {'; '.join(one.gaps)}" for one in self.claims if one.verdict != SHOWN)
        alike = by_key((gap, one.id) for one in self.claims if one.verdict == SHOWN for gap in one.gaps)
        yield from (f"{', '.join(names)}: {gap}" for gap, names in alike.items())

    def _of_evidence(self) -> Iterator[str]:
        for one in self.evidence:
            yield from (f"{one.name} {one.folder}: {said}" for said in one.problems)
            if one.copy_of is not None:
                yield f"{one.name} {one.folder}: the record of E{one.copy_of} again; it counts once"
        if unsigned := [one for one in self.evidence if not one.signed]:
            count = f"{len(unsigned)} of {count_of(len(self.evidence), 'folder')}"
            yield f"{count} without a signature (who changes a file can write its hash, too): {named(unsigned)}"
        tests = [test for one in self.claims for test in one.tests]
        if unlisted := dict.fromkeys(name for test in tests for name in test.unlisted):
            names = ", ".join(unlisted)
            yield f"outcomes of tests in files that no list of hashes has (an edit is not noticed): {names}"
        if uncounted := dict.fromkeys(test.name for test in tests if test.runs and not test.is_counted):
            found = count_of(len(uncounted), "test")
            yield f"{found} without a JUnit report: a table does not tell how many runs a test made, nor if one is gone"
        alike = by_key((said, one) for one in self.evidence for said in (*one.unchecked, *one.remarks))
        yield from (f"{named(items)}: {said}" for said, items in alike.items())
        if silent := [one for one in self.evidence if one.kind == RUN and one.verdict and not one.judged]:
            yield f"judged by no requirement: {named(silent)}"
        laws = by_key((str(law), one) for one in self.evidence if (law := one.document.get("controller")))
        if len(laws) > 1:
            said = "; ".join(f"{law} {named(items)}" for law, items in laws.items())
            yield f"the evidence is of {len(laws)} controllers, and a requirement is about one: {said}"

    def _of_tools(self) -> Iterator[str]:
        tools = self.tools
        if len(tools) > 1:
            yield f"the evidence was made by {len(tools)} versions of railhil"
        for tool in tools:
            if tool.version.endswith(_UNNAMED):
                yield f"railhil {tool.version}, which made {named(tool.made)}, is no commit: its files are not in git"
            if not tool.validated:
                yield f"railhil {tool.version}, which made {named(tool.made)}: {tool.said}"
        if self.validation is not None:
            yield from (f"a test of railhil itself failed: {name}" for name in self.validation.failed)

    def as_json(self) -> dict[str, Any]:
        """Content of ``dossier.json``."""
        tools = [{**vars(one), "made": [item.name for item in one.made]} for one in self.tools]
        return {
            "written": self.written,
            "headline": self.headline,
            "complete": self.is_complete,
            "gaps": self.gaps,
            "claims": [_claim(one) for one in self.claims],
            "evidence": [_evidence(one) for one in self.evidence],
            "tools": tools,
            "validation": None if self.validation is None else asdict(self.validation),
            "doctor": self.doctor,
        }


def _claim(one: Claim) -> dict[str, Any]:
    return {
        "id": one.id,
        "requirement": None if one.requirement is None else one.requirement.as_json(),
        "verdict": one.verdict,
        "gaps": one.gaps,
        "runs": [
            {"evidence": run.evidence.name, "counts": run.counts, "why_not": run.why_not,
             "outcome": None if run.judged.outcome is None else run.judged.outcome.as_json()}
            for run in one.runs
        ],
        "tests": [asdict(test) for test in one.tests],
        "searches": [{"evidence": item.name, "violations": found.violations, "said": found.said}
                     for item, found in one.searches],
        "deviations": {said: [item.name for item in items] for said, items in one.deviations.items()},
    }  # fmt: skip


def _evidence(one: Evidence) -> dict[str, Any]:
    said = ("name", "kind", "title", "verdict", "reasons", "list_sha256", "signature", "problems", "unchecked",
            "remarks", "copy_of", "deviations")  # fmt: skip
    return {
        "folder": str(one.folder),
        **{key: getattr(one, key) for key in said},
        **{key: one.document.get(key) for key in ("frames_sha256", "faults", "railhil", "code_sha256")},
    }


def make_dossier(
    given: Sequence[Path],
    listed: Sequence[Requirement] = (),
    key: Path | None = None,
    validation: Path | None = None,
    doctor: Mapping[str, str] | None = None,
) -> Dossier:
    """Check and read all folders.

    :param listed: the requirements that the assessment is about; each run is judged by those with a sentence, too.
    :param key: that must have signed; None: a signature is not asked for.
    :param validation: folder of the results of railhil's own tests.
    :param doctor: versions and properties of this machine, unless the validation has them.
    :raises InputError: a folder has no evidence, or a file that is no evidence cannot be read.
    """
    evidence = list(read_evidence(folders_of(given), [one for one in listed if one.says], key))
    tests = read_tests(test_files(given, evidence), evidence)
    found = None if validation is None else read_validation(validation)
    claims = claims_of(listed, evidence, tests)
    written = {**recorded_by(), "railhil": full_version()}
    return Dossier(claims, evidence, found, (found and found.doctor) or doctor or {}, written)


def check_out(folder: Path) -> None:
    """Refuse a folder that something else is in, before the work whose result it gets.

    :raises InputError: it has other files than those of a dossier, or is signed.
    """
    names = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    if SIGNATURE in names:
        raise InputError("command line", "--out", Words(f"{folder} is signed ({SIGNATURE})"), "another folder")
    if names and DOSSIER not in names:
        raise InputError("command line", "--out", str(folder), "an empty or new folder, or that of a dossier")


def write_dossier(
    dossier: Dossier, page: str, folder: Path, key: Path | None = None, lists: Sequence[Path] = ()
) -> None:
    """Write document, page, copies of the lists with the results, and list of hashes.

    :param key: that signs the list of hashes; None: none does. :param lists: of requirements, of other tools.
    :raises OSError: they cannot be written. :raises InputError: the key cannot sign.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in ((DOSSIER, json_text(dossier.as_json() | {HASH_LIST_KEY: HASH_LIST})), (REPORT, page)):
        with whole_file(folder / name) as draft:
            draft.write_text(text, encoding="utf-8")
    results = {one.id: Result(one.verdict, "; ".join(one.gaps) or one.least) for one in dossier.claims}
    copies = {f"{path.stem}_results{path.suffix}": path for path in lists}
    for name, path in copies.items():
        write_results(path, results, folder / name)
    write_hash_list(folder, only=(DOSSIER, REPORT, *copies))
    sign_list(folder, key)
