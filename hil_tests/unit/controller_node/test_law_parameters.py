"""Parameter files: allowed content, their effect on a law, and the record of the parameters in runs."""

from __future__ import annotations

import dataclasses
import warnings
from pathlib import Path
from typing import Any, Literal, get_origin, get_type_hints

import pytest

from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bench import direct_run, local_run
from railhil.bus.ident import CtlIdent, law_code
from railhil.common.errors import InputError
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.ato.ipfc_constants import IpfcParameters
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.ato.pfc_constants import Wavelet
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws import names
from railhil.controller_node.laws.parameters import law_parameters
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.tuning.__main__ import shipped

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
        (TUNED.replace("softening_max", "softening_mux"), "parameters.softening_mux", "did you mean softening_max?"),
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


#: Values that hung a design, divided by zero, or turned a law round: law, what the file says, key, what is allowed.
BEYOND = [
    ("ipfc", "horizon = 1000000", "horizon", "at most 200"),
    ("ipfc", "horizon = 99999999999999999999", "horizon", "at most 200"),
    ("ipfc", "wavelets = []", "wavelets", "at least 1 values"),
    ("ipfc", "wavelets = [{ scale = nan, shift_s = 0, bandwidth = 0.5 }]", "wavelets[0].scale", "at most 100"),
    ("ipfc", "fit_points = []", "fit_points", "at least 1 values"),
    ("ipfc", "fit_points = [0, 5]", "fit_points[0]", "at least 1"),
    ("ipfc", "set_point_order = -1", "set_point_order", "at least 0"),
    ("ipfc", "error_order = -3", "error_order", "at least 0"),
    ("ipfc", "speed_width_below_kmh = 0", "speed_width_below_kmh", "at least 0.0005"),
    ("ipfc", "model_gain_mps = 0", "model_gain_mps", "at least 0.001"),
    ("ipfc", "softening_max = 1.0", "softening_max", "less than 1"),
    ("ipfc_plus", "speed_noise_mps = 0.0", "speed_noise_mps", "at least 1e-05"),
    ("ipfc_plus", "gain_error_max = 1.0", "gain_error_max", "at most 0.9"),
    ("ipfc_plus", "replan_min_s = 0.0", "replan_min_s", "at least 0.1"),
    ("ipfc_plus", "fit_points_s = [1.0, 100000.0]", "fit_points_s[1]", "at most 30"),
    ("ipfc_plus", "wheel_error_max = -0.01", "wheel_error_max", "at least 0"),
    ("ipfc_plus", "wheel_sigma = 0.0", "wheel_sigma", "at least 1e-06"),
    ("ipfc_plus", "force_limit_margin = -2.0", "force_limit_margin", "at least 0"),
    ("ipfc_plus", "position_error_max_m = -1.0", "position_error_max_m", "at least 0"),
    ("ipfc_plus", "speed_error_max_kmh = -1.0", "speed_error_max_kmh", "at least 0"),
    ("tdmc", "model_horizon_s = 1e9", "model_horizon_s", "at most 120"),
    ("tdmc", "prediction_horizon_s = -3.0", "prediction_horizon_s", "at least 0.1"),
    ("tdmc", "move_weight = -0.1", "move_weight", "at least 0"),
    ("tdmc", "last_error_weight = 0.0", "last_error_weight", "at least 0.001"),
    ("fuzzy_pid", "no_traction_s = 1e9", "no_traction_s", "at most 30"),
    ("fuzzy_pid", "proportional = -2.0", "proportional", "at least 0"),
    ("fuzzy_pid", "integral_span = 1.1", "integral_span", "at most 1"),
    ("fuzzy_pid", "error_big_kmh = 0.0", "error_big_kmh", "at least 0.03"),
    ("tpfc1", "ramp_slope_kmh_per_s = 1e6", "ramp_slope_kmh_per_s", "at most 100"),
]


@pytest.mark.parametrize(("law", "line", "key", "allowed"), BEYOND)
def test_a_value_beyond_its_range_is_one_line(tmp_path: Path, law: str, line: str, key: str, allowed: str) -> None:
    """Before anything is computed with it: no warning of a numerical library stands before the line."""
    path = written(tmp_path, f'law = "{law}"\n[parameters]\n{line}\n')
    given = load_parameters(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError) as caught:
            Controller(SCENARIO, LawSpec(law, parameters=given))
    assert str(caught.value).startswith(f"{path}: parameters.{key}: found ")
    assert allowed in caught.value.allowed


def sides_of(kind: Any) -> set[str]:
    """Which sides of a field's type are bounded: those of the type itself, ``ge``, ``max_length`` and so on."""
    bounds = [bound for item in getattr(kind, "__metadata__", ()) for bound in item.metadata]
    return {side for bound in bounds for side in ("ge", "gt", "le", "lt", "max_length") if hasattr(bound, side)}


@pytest.mark.parametrize("law", names())
def test_every_number_has_a_range_with_default_and_search_inside(law: str) -> None:
    kind = load_law(law)
    hints = get_type_hints(kind.parameters_type, include_extras=True)
    for name, hint in hints.items():
        if hint is not bool and get_origin(hint) is not Literal:
            assert sides_of(hint) & {"ge", "gt", "max_length"}, name
            assert sides_of(hint) & {"le", "lt", "max_length"}, name
    defaults = dataclasses.asdict(kind.parameters_type())
    corners = [{name: bounds[side] for name, bounds in kind.tunable.items()} for side in (0, 1)]
    for values in (defaults, *corners):
        law_parameters(law, kind, ParameterSet(law, values, Path("inside")))
    for given in shipped():
        if given.law == law:
            law_parameters(law, kind, given)


def test_a_number_of_thousands_of_digits_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a parameter file"):
        load_parameters(written(tmp_path, f'law = "ipfc"\n[parameters]\nhorizon = {"9" * 5000}\n'))


def test_missing_file_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        load_parameters(tmp_path / "none.toml")


def test_training_seeds_are_refused(tmp_path: Path) -> None:
    given = load_parameters(written(tmp_path, TUNED))
    with pytest.raises(InputError, match="seed 1, on which these parameters were tuned"):
        given.check_unseen(range(1, 5))
    given.check_unseen(range(2, 7))
    assert given.find_seen([7, 5, 0]) == [0, 7]


@pytest.mark.slow
def test_parameters_change_the_run_and_the_handshake_says_so(tmp_path: Path) -> None:
    text = TUNED.replace("softening_max = 0.8", "softening_max = 0.9").partition("fit_points")[0]
    given: ParameterSet = load_parameters(written(tmp_path, text))
    (tmp_path / "short.toml").write_text(RUN_72M_TOML)
    short = load(tmp_path / "short.toml")
    own = direct_run(short, RunSpec(law=LawSpec(arithmetic="float64")))
    over_bus = local_run(short, tmp_path, RunSpec(law=LawSpec(arithmetic="float64", parameters=given)))
    assert own.commands("notch") != over_bus.commands("notch")
    ident = over_bus.trace.ident(CtlIdent)
    assert ident is not None
    assert ident.law == law_code(given.controller) != law_code("ipfc")
