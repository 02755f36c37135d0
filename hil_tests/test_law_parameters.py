"""Parameter files: what they may hold, what a law makes of them, and that runs say with which they were made."""

from __future__ import annotations

from pathlib import Path

import pytest

from bus.ident import CtlIdent, law_code
from controller_node.laws.ipfc import Ipfc
from controller_node.laws.ipfc_constants import IpfcParameters
from controller_node.laws.parameters import law_parameters
from controller_node.laws.pfc_constants import Wavelet
from hil_tests.bench import direct_run, local_run
from scenarios.errors import InputError
from scenarios.load import load
from scenarios.parameters import ParameterSet, load_parameters

SCENARIO = load("lvshun_tieshan")
TUNED = """
law = "ipfc"
[parameters]
softening_max = 0.8
fit_points = [2, 5, 8, 9]
wavelets = [{ scale = 1, shift_s = 0, bandwidth = 0.5 }]
[training]
scenario = "lvshun_tieshan"
seeds = [0, 1, 7]
notes = { method = "by hand" }
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "tuned.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_file_becomes_the_parameters_of_the_law(tmp_path: Path) -> None:
    given = load_parameters(written(tmp_path, TUNED))
    parameters = law_parameters("ipfc", Ipfc, given)
    assert parameters == IpfcParameters(softening_max=0.8, fit_points=(2, 5, 8, 9), wavelets=(Wavelet(1.0, 0.0, 0.5),))
    assert law_parameters("ipfc", Ipfc, None) is None


def test_digest_is_of_the_content(tmp_path: Path) -> None:
    one = load_parameters(written(tmp_path, TUNED))
    same = load_parameters(written(tmp_path, "# a remark\n" + TUNED.replace("seeds = [0, 1, 7]", "seeds = [9]")))
    other = load_parameters(written(tmp_path, TUNED.replace("0.8", "0.81")))
    assert one.digest == same.digest != other.digest
    assert one.controller == f"ipfc+{one.sha256[:8]}"


@pytest.mark.parametrize(
    ("text", "key", "allowed"),
    [
        ("law = ", "", "a parameter file"),
        ("[parameters]\n", "law", "the key is required"),
        ('law = "ipfc"\n', "parameters", "the key is required"),
        (TUNED.replace("law =", "lwa ="), "lwa", "did you mean law?"),
        (TUNED.replace("[0, 1, 7]", "[]"), "training.seeds", "at least 1"),
        (TUNED.replace("[0, 1, 7]", "[0.5]"), "training.seeds[0]", "whole number"),
        (TUNED.replace("= 0.8", "= nan"), "parameters.softening_max", "a finite number"),
        (TUNED.replace("softening_max", "softening_mux"), "parameters", "did you mean softening_max?"),
        (TUNED.replace("= 0.8", '= "0.8"'), "parameters.softening_max", "valid number"),
        (TUNED.replace("= 0.8", "= true"), "parameters.softening_max", "valid number"),
        (TUNED.replace("[2, 5, 8, 9]", "[2.5]"), "parameters.fit_points[0]", "integer"),
        (TUNED.replace('"ipfc"', '"tdmc"'), "law", "ipfc, the controller asked for"),
    ],
)
def test_bad_file_is_one_line(tmp_path: Path, text: str, key: str, allowed: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(InputError) as caught:
        law_parameters("ipfc", Ipfc, load_parameters(path))
    assert caught.value.key == key
    assert str(path) in str(caught.value)
    assert allowed in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_file_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        load_parameters(tmp_path / "none.toml")


def test_training_seeds_are_refused_for_their_scenario_only(tmp_path: Path) -> None:
    given = load_parameters(written(tmp_path, TUNED))
    with pytest.raises(InputError, match="found seed 1, on which these parameters were tuned"):
        given.check_unseen("lvshun_tieshan", range(1, 5))
    given.check_unseen("lvshun_tieshan", range(2, 7))
    given.check_unseen("another", range(10))
    assert given.seen("lvshun_tieshan", [7, 5, 0]) == [0, 7]


def test_parameters_change_the_run_and_the_handshake_says_so(tmp_path: Path) -> None:
    text = TUNED.replace("softening_max = 0.8", "softening_max = 0.9").partition("fit_points")[0]
    given: ParameterSet = load_parameters(written(tmp_path, text))
    own, tuned = (direct_run(SCENARIO, arithmetic="float64", parameters=each) for each in (None, given))
    assert own.notches != tuned.notches
    over_bus = local_run(SCENARIO, tmp_path, arithmetic="float64", parameters=given)
    assert over_bus.notches == tuned.notches
    ident = over_bus.trace.ident(CtlIdent)
    assert ident is not None
    assert ident.law == law_code(given.controller) != law_code("ipfc")
