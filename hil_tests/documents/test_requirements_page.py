"""The page on requirements: each sentence on it is read, and fits a run."""

from __future__ import annotations

import re
import tomllib

import pytest

from hil_tests.documents.pages import blocks_of
from hil_tests.support.paths import ROOT
from railhil.common.errors import InputError
from railhil.dbc import wire_contract
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.parser import parse_sentence
from railhil.judge.requirements.requirement import Requirement, check_requirements, requirements_in
from railhil.judge.requirements.words import FUNCTIONS
from railhil.record.trace import Trace
from railhil.scenarios.load import load

PAGE = "docs/reference/requirements.md"
BLOCKS = list(blocks_of(PAGE, (ROOT / PAGE).read_text("utf-8").splitlines()))
#: The first cell of each row of a table.
ROWS = [
    found[1]
    for block in BLOCKS
    if block.kind == "table"
    for line in block.lines
    if (found := re.match(r"\| `(.*?)` \|", line))
]
SENTENCES = [row for row in ROWS if re.match(r"(always|never|whenever|at|eventually|from|after|between)\b", row)]


@pytest.mark.parametrize("says", [*SENTENCES, *(f"never {row}" for row in ROWS if row not in SENTENCES)])
def test_each_example_fits_a_run(says: str) -> None:
    scenario = load("lvshun_tieshan")
    assert Requirement("T-1", says).bind(Names(scenario, Trace(wire_contract()))).sentence.text == says


def test_each_form_and_each_function_has_an_example() -> None:
    forms = {
        (type(found.body).__name__, found.scope.word if found.scope else "") for found in map(parse_sentence, SENTENCES)
    }
    assert {body for body, _ in forms} == {"Always", "Never", "Whenever", "At", "Eventually"}
    assert {scope for _, scope in forms} == {"", "from", "after", "between"}
    assert all(any(f"{name}(" in row for row in ROWS) for name in FUNCTIONS)


def test_the_example_of_a_file_is_one() -> None:
    (block,) = (block for block in BLOCKS if block.info[:1] == ("toml",))
    found = requirements_in(tomllib.loads(block.text), PAGE)
    check_requirements(found, load("lvshun_tieshan"))
    assert [one.id for one in found] == ["ATO-5", "ATO-1", "ATO-4"]


def test_the_refusal_is_as_printed() -> None:
    (block,) = (block for block in BLOCKS if block.info[:1] == ("text",))
    says = "whenever age(TRN_SPEED) > 64 m, at once notch_command <= 0"
    with pytest.raises(InputError) as refused:
        check_requirements([Requirement("ATO-12", says, file="requirements.toml")], load("lvshun_tieshan"))
    assert block.text.strip() == str(refused.value)
