"""The shipped sentences that repeat rules 2, 3 and 4 agree with these rules.

The rules know the faults of the run, a sentence knows the bus alone. Hence they may differ with these faults: content
that a fault puts into NOTCH_CMD, TRN_POS, TRN_WATCH or SIM_TRUTH, of which a sentence judges what is sent, and a drive
that is stuck on, which has until EMERGENCY by rule 2. Traction between two telegrams is within the 20 ms of ATO-9.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from hil_tests.support.short_runs import RUN_72M_TOML
from hil_tests.unit.systems.ato.test_invariants import SCENARIO, Story, found
from railhil.common.errors import InputError
from railhil.faults import parse_faults
from railhil.faults.random_faults import Sent, random_pair
from railhil.judge.record import Record
from railhil.judge.requirements.outcome import judge_requirements
from railhil.judge.requirements.requirement import Requirement, read_requirements
from railhil.judge.score import Score
from railhil.run.make import NeverBegan, record_run
from railhil.run.spec import with_requirements
from railhil.scenarios.fault_list import list_disturbed_signals
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.study.faultless import can_inject_in, faultless_run

#: Sentence -> what the failures of its rule say.
RULES = {
    "ATO-4": "invariant 3",
    "ATO-8": "invariant 2: the controller commands",
    "ATO-9": "invariant 2: the train",
    "ATO-12": "invariant 4: the train left EMERGENCY",
    "ATO-12b": "invariant 4: the controller left EMERGENCY",
}


@cache
def sentences() -> tuple[Requirement, ...]:
    return tuple(one for one in read_requirements("ato") if one.id in RULES)


def violated(story: Story) -> set[str]:
    trace = story.trace()
    trace.end_ns = 990_000_000
    record = Record(Path("frames.log"), SCENARIO, trace, certificate={})
    judged = record.copy_with(score=Score("PASS", {}, {}, (), "ended_complete"))
    return {one.id for one in judge_requirements(judged, sentences()) if one.violated}


def broken_rules(failures: list[str]) -> set[str]:
    return {name for name, said in RULES.items() if any(text.startswith(said) for text in failures)}


FASTER = round((SCENARIO.train.speed_limit_mps + 2.0) * 1e4)
STORIES = {
    "ATO-4": Story(speed_01mmps=lambda tick: FASTER, traction_20n=lambda tick: 0),
    "ATO-8": Story(controller_level=lambda tick: 2 if tick >= 50 else 0),
    "ATO-9": Story(
        train_level=lambda tick: 2 if tick >= 30 else 0,
        traction_20n=lambda tick: 500,
        notch_actual_16th=lambda tick: 16,
    ),
    "ATO-12": Story(train_level=lambda tick: 4 if 30 <= tick < 60 else 0),
    "ATO-12b": Story(
        controller_level=lambda tick: 4 if 30 <= tick < 60 else 0, notch_256th=lambda tick: 0 if tick < 70 else 256
    ),
}


@pytest.mark.parametrize("name", STORIES)
def test_a_record_that_breaks_a_rule_violates_its_sentence(name: str) -> None:
    assert broken_rules(found(STORIES[name])) == {name}
    assert violated(STORIES[name]) == {name}


def test_a_record_that_keeps_the_rules_violates_no_sentence() -> None:
    kept = Story(
        train_level=lambda tick: 4 if tick >= 30 else 0,
        controller_level=lambda tick: 4 if tick >= 30 else 0,
        notch_256th=lambda tick: 256 if tick < 30 else 0,
        traction_20n=lambda tick: 500 if tick < 30 else 0,
    )
    assert found(kept) == []
    assert violated(kept) == set()


@pytest.fixture(scope="module")
def hop(tmp_path_factory: pytest.TempPathFactory) -> RunSpec:
    """A short journey that is judged by all the sentences."""
    path = tmp_path_factory.mktemp("hop") / "short.toml"
    path.write_text(RUN_72M_TOML, encoding="utf-8")
    return with_requirements(RunSpec(str(path), law=LawSpec("ipfc_plus"), bus="local"), "ato")


@pytest.fixture(scope="module")
def calm(hop: RunSpec) -> tuple[float, Mapping[str, Sent]]:
    return faultless_run(hop)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "faults"),
    [
        # Life signs let the train refuse the answers in which the new controller initialises.
        ("ATO-12b", ("controller stop @5s for 1.19s", "controller restart @7.04s for 150ms")),
        # The new controller hears the first speed 10 ms after its first answer.
        ("ATO-6", ("bus down @5s for 1.58s", "controller restart @5.8s for 30ms")),
        # The new controller counts from its first poll how long it hears no speed.
        ("ATO-6", ("TRN_SPEED loss @5s for 3s", "controller restart @5.9s for 30ms")),
    ],
)
def test_a_controller_that_was_restarted_knows_nothing_of_the_time_before(
    name: str, faults: tuple[str, ...], hop: RunSpec, tmp_path: Path
) -> None:
    """Hunts found these."""
    combined = tuple(f"{fault} combine" for fault in faults)
    result = record_run(replace(hop, faults=combined, out=tmp_path / "run"), keep=False)
    (outcome,) = (one for one in result.score.requirements if one.id == name)
    assert (outcome.verdict, outcome.antecedent_met > 0) == ("kept", True)


def excused(faults: tuple[str, ...]) -> set[str]:
    """The sentences that may differ from their rules in a run with these faults."""
    names = set()
    for fault in parse_faults(faults):
        if fault.place.level == "command" or fault.place.name == "NOTCH_CMD":
            names |= {"ATO-8", "ATO-12b"}
        if fault.place.name in ("traction", "TRN_POS", "TRN_WATCH", "SIM_TRUTH"):
            names |= {"ATO-4", "ATO-9", "ATO-12"}
    return names


@pytest.mark.slow
@pytest.mark.long_after(30)
@pytest.mark.parametrize("number", range(1000))
def test_sentences_and_rules_agree_on_a_run_with_random_faults(
    number: int, hop: RunSpec, calm: tuple[float, Mapping[str, Sent]]
) -> None:
    system = system_named("ato")
    can_inject = partial(can_inject_in, system, hop)
    faults = random_pair(number, calm[0], list_disturbed_signals(system), calm[1], can_inject)
    with TemporaryDirectory() as folder:
        try:
            result = record_run(replace(hop, faults=faults, seed=number, out=Path(folder) / "run"), keep=False)
        except (InputError, NeverBegan) as error:
            pytest.skip(f"the faults do not go together: {error}")
    score = result.score
    if score.verdict == "INVALID":
        return
    said = {one.id for one in score.requirements if one.violated and one.id in RULES}
    assert said ^ broken_rules([*score.failures]) <= excused(faults), faults
