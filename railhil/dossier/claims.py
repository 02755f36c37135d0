"""Claims: each requirement with all that folders and tests show of it, what speaks against it, and the gaps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from typing import Any

from railhil.common.digits import count_of
from railhil.dossier.evidence import Evidence, Judged
from railhil.dossier.tests import Test
from railhil.judge.requirements.outcome import NOT_JUDGED
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.sentence import KEPT, OPEN, SILENT, VIOLATED
from railhil.testing.requirements import FAILED, PASSED
from railhil.testing.requirements import NOT_SHOWN as UNSHOWN

SHOWN, NOT_SHOWN, NONE = "shown", "not shown", "no evidence"
_OTHER = "judged by another sentence"
#: Numbers of folders that a sentence names; further ones are counted.
_NAMED_MAX = 6


@dataclass(frozen=True, slots=True)
class Run:
    """A run that was judged by a claim. ``counts``: whether it speaks for it if the sentence is kept; ``why_not``:
    else the reason."""

    evidence: Evidence
    judged: Judged
    why_not: str

    @property
    def verdict(self) -> str:
        """What the record makes of the sentence; empty: nothing."""
        return "" if self.judged.outcome is None else self.judged.outcome.verdict

    @property
    def counts(self) -> bool:
        """Whether it speaks for the claim if the sentence is kept."""
        return not self.why_not


@dataclass(frozen=True, slots=True)
class Search:
    """What a hunt or a probability has found of a claim, in words; ``violations``: number of runs against it."""

    evidence: Evidence
    runs: int
    violations: int
    said: str


@dataclass(frozen=True)
class Claim:
    """A requirement and its evidence.

    ``requirement``: None: only tests name it, without a sentence. ``verdict``: ``violated`` if anything speaks against
    it, whether or not it checks; ``shown`` if a folder that checks, or a passed test whose runs all check, speaks for
    it; ``not shown``; ``no evidence``. ``gaps``: what is missing, a sentence each.
    """

    id: str
    requirement: Requirement | None
    runs: Sequence[Run]
    tests: Sequence[Test]
    searches: Sequence[Search]
    verdict: str = NONE
    gaps: tuple[str, ...] = ()
    deviations: Mapping[str, Sequence[Evidence]] = field(default_factory=dict)

    def of(self, verdict: str, *, counts: bool = True) -> list[Run]:
        """The runs with a verdict, that count or do not."""
        return [run for run in self.runs if run.verdict == verdict and run.counts == counts]

    @property
    def worst(self) -> Run | None:
        """The run with the smallest margin of those that count; None: none has one."""
        sized = [run for run in self.runs if run.counts and _margin(run) is not None]
        return min(sized, key=lambda run: _margin(run) or 0.0, default=None)


def _margin(run: Run) -> float | None:
    return None if run.judged.outcome is None else run.judged.outcome.margin


def claims_of(listed: Sequence[Requirement], evidence: Sequence[Evidence], tests: Sequence[Test]) -> list[Claim]:
    """All requirements, those of the list in its order, then those that only runs, searches and tests name.

    :param listed: the requirements of the list that the assessment is about; none: those of the evidence.
    """
    texts = {one.id: one for one in listed}
    for item in evidence:
        for judged in item.judged:
            texts.setdefault(judged.requirement.id, judged.requirement)
        for row in _rows(item):
            texts.setdefault(row["id"], Requirement(row["id"], row["says"]))
    others = sorted({test.requirement for test in tests} - texts.keys())
    by_number = {one.number: one for one in evidence}
    return [_claim(name, texts.get(name), evidence, tests, by_number) for name in (*texts, *others)]


def _claim(
    name: str,
    requirement: Requirement | None,
    evidence: Sequence[Evidence],
    tests: Sequence[Test],
    by_number: Mapping[int, Evidence],
) -> Claim:
    ours = [(item, judged) for item in evidence for judged in item.judged if judged.requirement.id == name]
    same = {item.number for item, judged in ours if _is_same(judged.requirement, requirement)}
    runs = [Run(item, judged, _why_not(item, judged, same)) for item, judged in ours]
    own = [test for test in tests if test.requirement == name]
    searches = [_search(item, row) for item in evidence for row in _rows(item) if row["id"] == name]
    found = Claim(name, requirement, sorted(runs, key=_order), own, searches)
    against, gaps = list(_against(found)), []
    passed = [test for test in own if test.result == PASSED and _is_supported(test, by_number)]
    is_shown = bool(found.of(KEPT) or passed)
    has_any = own or searches or any(run.evidence.problems or run.judged.outcome is not None for run in runs)
    verdict = VIOLATED if against else SHOWN if is_shown else NOT_SHOWN if has_any else NONE
    gaps = [*against, *_missing(found, by_number, verdict)]
    deviations: dict[str, list[Evidence]] = {}
    decided = {run.evidence.number for run in runs if run.verdict in (KEPT, VIOLATED, OPEN)}
    for number in sorted({*decided, *(number for test in own for number in test.runs)}):
        for said in by_number[number].deviations:
            deviations.setdefault(said, []).append(by_number[number])
    return Claim(name, requirement, found.runs, own, searches, verdict, tuple(gaps), deviations)


def _is_same(one: Requirement, other: Requirement | None) -> bool:
    """Whether two requirements of one id have one meaning."""
    return other is not None and (one.says, one.define, one.when) == (other.says, other.define, other.when)


def _why_not(item: Evidence, judged: Judged, same: Set[int]) -> str:
    """Why a run does not speak for a claim; empty: it does if its sentence is kept.

    :param same: numbers of the folders that are judged by the sentence of the claim.
    """
    if item.problems:
        return "it does not check"
    if judged.why_not:
        return judged.why_not
    if item.number not in same:
        return f"{_OTHER}: {judged.requirement.says}"
    return f"the record of E{item.copy_of} again" if item.copy_of in same else ""


def _order(run: Run) -> tuple[int, float, int]:
    """Violated ones first, then kept ones by their margins, then the others."""
    place = (VIOLATED, KEPT, OPEN, SILENT, NOT_JUDGED).index(run.verdict) if run.verdict else 5
    margin = _margin(run)
    return place, float("inf") if margin is None else margin, run.evidence.number


def _rows(item: Evidence) -> list[dict[str, Any]]:
    """The requirements of a hunt or a probability, as its summary has them."""
    found = item.searched.get("requirements") or []
    one = item.searched.get("requirement")
    return [*found, *([one] if isinstance(one, dict) else [])]


def _search(item: Evidence, row: Mapping[str, Any]) -> Search:
    runs = int(row.get("runs", item.searched.get("runs", 0)))
    if "p" in item.searched:
        low, high = item.searched["low"], item.searched["high"]
        interval = "no interval" if low is None else f"95 % interval {low:.2g} to {high:.2g}"
        return Search(item, runs, 0, f"a drawn run violates it with P = {item.searched['p']:.2g}, {interval}")
    violations = int(row["violations"])
    if violations:
        return Search(item, runs, violations, f"violated in {count_of(violations, 'run')} of {runs:,}")
    if not runs:
        return Search(item, runs, 0, "judged in no run")
    met = f"its antecedent was met in {row['antecedent_met']:,}"
    nearest = "" if row.get("margin") is None else f", nearest margin {row['margin']:.4g} {row['unit']}".rstrip()
    return Search(item, runs, 0, f"not found in {count_of(runs, 'run', spec=',')} ({met}){nearest}")


def _is_supported(test: Test, by_number: Mapping[int, Evidence]) -> bool:
    """Whether all runs of a test are here and check."""
    return bool(test.runs) and not test.missing and not any(by_number[number].problems for number in test.runs)


def named(items: Iterable[Evidence]) -> str:
    """Folders by their names in the dossier."""
    names = [f"E{number}" for number in sorted({item.number for item in items})]
    more = f" and {len(names) - _NAMED_MAX} more" if len(names) > _NAMED_MAX else ""
    return ", ".join(names[:_NAMED_MAX]) + more


def _against(claim: Claim) -> Iterator[str]:
    """What speaks against a claim."""
    if runs := [run.evidence for run in claim.runs if run.verdict == VIOLATED]:
        yield f"violated in {count_of(len(runs), 'run')}: {named(runs)}"
    for test in claim.tests:
        if test.result == FAILED:
            yield f"test {test.name}: {test.outcome}"
    for search in claim.searches:
        if search.violations:
            yield f"{search.evidence.kind} {search.evidence.name}: {search.said}"


def _missing(claim: Claim, by_number: Mapping[int, Evidence], verdict: str) -> Iterator[str]:
    """The gaps of a claim."""
    if verdict == NONE:
        yield "no run, no test and no search is about it"
        yield from dict.fromkeys(run.why_not for run in claim.runs)
        return
    if doubtful := [run.evidence for run in claim.runs if run.evidence.problems]:
        yield f"evidence that does not check, and does not count: {named(doubtful)}"
    if other := [run.evidence for run in claim.runs if run.why_not.startswith(_OTHER)]:
        yield f"judged by another sentence of this id, and does not count: {named(other)}"
    if verdict == VIOLATED:
        return
    for word, why in (
        (OPEN, "the end of the record came before the decision"),
        (SILENT, "its antecedent was never met"),
        (NOT_JUDGED, "a run that is INVALID, or with faults where the requirement is about runs without"),
    ):
        if verdict != SHOWN and (runs := [run.evidence for run in claim.of(word)]):
            yield f"{word} in {count_of(len(runs), 'run')} ({why}): {named(runs)}"
    if claim.requirement is None or not claim.requirement.says:
        yield "no sentence: it rests on the assertions of its tests"
    for test in claim.tests:
        if test.result == UNSHOWN:
            yield f"test {test.name}: {test.outcome}"
        elif test.result == PASSED and not test.runs:
            yield f"test {test.name}: none of its runs is here"
        elif test.result == PASSED and test.missing:
            yield f"test {test.name}: {count_of(test.missing, 'run')} of it not here"
        elif test.result == PASSED and (bad := [by_number[one] for one in test.runs if by_number[one].problems]):
            yield f"test {test.name}: its runs do not check: {named(bad)}"
    if not claim.runs and not claim.tests:
        yield "only searched for: not found is not absence"
