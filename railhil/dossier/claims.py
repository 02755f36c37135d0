"""Claims: each requirement with all that folders and tests show of it, what speaks against it, and the gaps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from typing import TypeVar

from railhil.common.digits import count_of
from railhil.dossier.evidence import Evidence, Judged, Searched, is_same
from railhil.dossier.junit import Test
from railhil.judge.requirements.outcome import NOT_JUDGED
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.sentence import KEPT, OPEN, SILENT, VIOLATED
from railhil.testing.requirements import FAILED, PASSED
from railhil.testing.requirements import NOT_SHOWN as UNSHOWN

Key = TypeVar("Key")
Item = TypeVar("Item")
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

    @property
    def margin(self) -> float | None:
        """Its margin, in the unit of the sentence; None: there is none."""
        return None if self.judged.outcome is None else self.judged.outcome.margin

    @property
    def margin_said(self) -> str:
        """Margin and unit; empty: there is none."""
        outcome = self.judged.outcome
        return "" if outcome is None or outcome.margin is None else f"{outcome.margin:.4g} {outcome.unit}".rstrip()


@dataclass(frozen=True)
class Claim:
    """A requirement and its evidence.

    ``requirement``: None: only tests name it; of a list of another tool it may have no sentence. ``verdict``:
    ``violated`` if anything speaks against it, whether or not it checks; ``shown`` if a folder that checks, or a passed
    test whose runs all check, speaks for it; ``not shown``; ``no evidence``. ``gaps``: sentences on what is missing.
    """

    id: str
    requirement: Requirement | None
    runs: Sequence[Run]
    tests: Sequence[Test]
    searches: Sequence[tuple[Evidence, Searched]]
    verdict: str = NONE
    gaps: tuple[str, ...] = ()
    deviations: Mapping[str, Sequence[Evidence]] = field(default_factory=dict)

    def of(self, verdict: str, *, counts: bool = True) -> list[Run]:
        """The runs with a verdict, that count or do not."""
        return [run for run in self.runs if run.verdict == verdict and run.counts == counts]

    @property
    def title(self) -> str:
        """Its title, else its text, else its sentence; empty: only tests name it."""
        found = self.requirement
        return "" if found is None else found.title or found.says or found.note

    @property
    def least(self) -> str:
        """The smallest margin of the runs that count, in words; empty: none has one."""
        sized = [run for run in self.runs if run.counts and run.margin is not None]
        worst = min(sized, key=lambda run: run.margin or 0.0, default=None)
        return "" if worst is None else f"{worst.margin_said} in {worst.evidence.name}"


def claims_of(listed: Sequence[Requirement], evidence: Sequence[Evidence], tests: Sequence[Test]) -> list[Claim]:
    """All requirements, those of lists in their order, then those that only runs, searches and tests name.

    :param listed: the requirements that the assessment is about.
    """
    known = {one.id: one for one in listed}
    for item in evidence:
        for one in (*(found.requirement for found in item.judged), *(found.requirement for found in item.searched)):
            known.setdefault(one.id, one)
    names = dict.fromkeys((*known, *sorted(test.requirement for test in tests)))
    by_number = {one.number: one for one in evidence}
    return [_claim(name, known.get(name), tests, by_number) for name in names]


def _claim(
    name: str, requirement: Requirement | None, every_test: Sequence[Test], by_number: Mapping[int, Evidence]
) -> Claim:
    evidence = by_number.values()
    judged = [(item, one) for item in evidence for one in item.judged if one.requirement.id == name]
    same = {item.number for item, one in judged if is_same(one.requirement, requirement)}
    runs = sorted((Run(item, one, _why_not(item, one, same)) for item, one in judged), key=_order)
    tests = [test for test in every_test if test.requirement == name]
    searches = [(item, one) for item in evidence for one in item.searched if one.requirement.id == name]
    found = Claim(name, requirement, runs, tests, searches)
    against = list(_against(found))
    passed = [test for test in tests if test.result == PASSED and _is_supported(test, by_number)]
    has_any = tests or searches or any(run.evidence.problems or run.judged.outcome is not None for run in runs)
    is_shown = found.of(KEPT) or passed
    verdict = VIOLATED if against else SHOWN if is_shown else NOT_SHOWN if has_any else NONE
    decided = {run.evidence.number for run in runs if run.verdict in (KEPT, VIOLATED, OPEN)}
    numbers = sorted(decided.union(*(test.runs for test in tests)))
    deviations = by_key((said, by_number[number]) for number in numbers for said in by_number[number].deviations)
    gaps = (*against, *_missing(found, by_number, verdict))
    return replace(found, verdict=verdict, gaps=gaps, deviations=deviations)


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
    return place, float("inf") if run.margin is None else run.margin, run.evidence.number


def _is_supported(test: Test, by_number: Mapping[int, Evidence]) -> bool:
    """Whether all runs of a test are here and check, and the files that tell its outcome are as listed."""
    return (
        bool(test.runs)
        and not test.missing
        and not test.changed
        and not any(by_number[number].problems for number in test.runs)
    )


def by_key(pairs: Iterable[tuple[Key, Item]]) -> dict[Key, list[Item]]:
    """The items of each key, keys and items in their order."""
    found: dict[Key, list[Item]] = {}
    for key, item in pairs:
        found.setdefault(key, []).append(item)
    return found


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
    for item, search in claim.searches:
        if search.violations:
            yield f"{item.kind} {item.name}: {search.said}"


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
    if verdict == SHOWN and not claim.of(KEPT):
        has_sentence = claim.requirement is not None and claim.requirement.says
        rests = "its sentence was kept in no run" if has_sentence else "no sentence"
        yield f"{rests}: it rests on the assertions of its tests"
    for test in claim.tests:
        if test.result == UNSHOWN:
            yield f"test {test.name}: {test.outcome}"
        elif test.result == PASSED and not test.runs:
            yield f"test {test.name}: none of its runs is here"
        elif test.result == PASSED and test.changed:
            yield f"test {test.name}: not as listed, and does not count: {', '.join(test.changed)}"
        elif test.result == PASSED and test.missing:
            yield f"test {test.name}: {count_of(test.missing, 'run')} of it not here"
        elif test.result == PASSED and (bad := [by_number[one] for one in test.runs if by_number[one].problems]):
            yield f"test {test.name}: its runs do not check: {named(bad)}"
    if not claim.runs and not claim.tests:
        yield "only searched for: not found is not absence"
