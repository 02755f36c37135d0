"""Settings of the train protection: profiles, units of the file, values that contradict each other, own balises."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.common.errors import InputError
from railhil.scenarios.load import load
from railhil.scenarios.validation import Keys, join_keys, validate
from railhil.systems.ato.scenario.model import Balise
from railhil.systems.line.scenario.protection import (
    ATP_TAGS,
    AtpTable,
    Protection,
    check_overlaps,
    check_protection,
    protection_balises,
    protection_of,
)
from railhil.systems.line.scenario.protection_keys import ATP_MEANING

TRAIN = load("yizhuang_01_songjiazhuang_xiaocun").train


def refuse(keys: Keys, found: object, allowed: str) -> InputError:
    return InputError("line.toml", join_keys(keys), found, allowed)


def settings(**table: Any) -> Protection:
    return protection_of(validate(AtpTable, table, lambda _: "line.toml", ATP_TAGS), TRAIN)


def test_without_any_key_it_is_the_metro_of_the_specification() -> None:
    assert settings() == Protection()
    assert Protection().emergency_mps2[0][1] * Protection().k_dry[0][1] * Protection().k_wet[0][1] == pytest.approx(
        0.918
    )


def test_the_fixed_times_of_subset026() -> None:
    found = settings(profile="subset026")
    assert (found.t_be_s, found.t_bs_s, found.t_cut_s) == (3.0, 4.0, 8.0)
    assert (found.t_warning_s, found.t_driver_s, found.t_ind_min_s) == (2.0, 4.0, 5.0)
    assert found.increments == "subset026"
    assert settings(profile="subset026", t_be_s=2.5, increments="metro").t_be_s == 2.5
    assert settings(profile="subset026", increments="metro").increments == "metro"


def test_values_of_a_file_become_si_units() -> None:
    found = settings(
        v_release_kmh=7.2, ato_margin_kmh=1.8, k_dry=0.8, emergency_mps2=[[0, 1.3], [36, 1.1]], heed_atp=True
    )
    assert (found.v_release_mps, found.ato_margin_mps) == pytest.approx((2.0, 0.5))
    assert found.k_dry == ((0.0, 0.8),)
    assert found.emergency_mps2 == ((0.0, 1.3), (10.0, 1.1))
    assert found.heed_atp


def test_rotating_masses_are_those_of_the_train_unless_the_file_has_them_or_they_are_unknown() -> None:
    assert settings().rotating_percent == pytest.approx(6.0)
    assert settings(rotating_percent=4.0).rotating_percent == 4.0
    assert settings(rotating_percent="unknown").rotating_percent is None


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"eoa_overlap_m": 40.0}, "line.toml: atp.eoa_overlap_m: found 40, allowed at most svl_overlap_m = 30"),
        ({"svl_overlap_m": 5.5}, "line.toml: atp.eoa_overlap_m: found 10, allowed at most svl_overlap_m = 5.5"),
        (
            {"emergency_mps2": [[10, 1.2], [20, 1.1]]},
            "line.toml: atp.emergency_mps2[0]: found [10, 1.2], allowed the first row from 0 km/h on",
        ),
        (
            {"service_mps2": [[0, 0.9], [40, 0.8], [40, 0.7]]},
            "line.toml: atp.service_mps2[2]: found 40, allowed more than 40: rows are in increasing order",
        ),
        ({"k_dry": [[0, 0.9], [40, 1.2]]}, "line.toml: atp.k_dry[1]: found 1.2, allowed above 0, at most 1"),
        ({"service_mps2": [[0, 0.0]]}, "line.toml: atp.service_mps2[0]: found 0, allowed above 0"),
    ],
)
def test_values_that_contradict_each_other_are_refused(table: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as refused:
        check_protection(settings(**table), refuse)
    assert str(refused.value) == message


def test_usual_values_are_not_refused() -> None:
    check_protection(settings(), refuse)
    check_protection(settings(profile="subset026"), refuse)
    check_protection(settings(eoa_overlap_m=30.0), refuse)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"profile": "tram"}, "line.toml: profile: found 'tram', allowed 'metro' or 'subset026'"),
        ({"k_wet": 1.5}, "line.toml: k_wet: found 1.5, allowed at most 1"),
        ({"t_be": 1.0}, "line.toml: t_be: unknown key"),
    ],
)
def test_values_of_a_wrong_kind_are_refused_by_their_key(table: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        settings(**table)


def test_the_overlap_of_a_stop_has_its_own_key() -> None:
    with pytest.raises(
        InputError, match=r"route\.stops\[1\]\.eoa_overlap_m: found 31, allowed at most svl_overlap_m = 30"
    ):
        check_overlaps(31.0, 30.0, ("route", "stops", 1, "eoa_overlap_m"), refuse)


@given(st.lists(st.floats(0.0, 5000.0), max_size=10), st.floats(50.0, 600.0))
def test_no_two_balises_of_the_protection_lie_further_apart_than_its_spacing(
    places_m: list[float], spacing_m: float
) -> None:
    line = [Balise(number, at_m, at_m) for number, at_m in enumerate(places_m, start=1)]
    own = protection_balises(spacing_m, line, 0.0, 5000.0)
    together_m = sorted([0.0, 5000.0, *places_m, *(one.surveyed_m for one in own)])
    assert all(after - before <= spacing_m + 1e-6 for before, after in pairwise(together_m))
    assert all(0.0 < one.surveyed_m < 5000.0 and one.true_m == one.surveyed_m for one in own)
    assert all(201 <= one.number <= 255 for one in own)
    # Equal numbers are far enough apart for the interval to tell them.
    assert all(own[i + 55].surveyed_m - own[i].surveyed_m > 10 * spacing_m for i in range(len(own) - 55))


def test_a_spacing_of_0_means_no_own_balises() -> None:
    assert protection_balises(0.0, (), 0.0, 5000.0) == ()
    assert [one.surveyed_m for one in protection_balises(300.0, (), 0.0, 600.0)] == [300.0]


def test_every_key_has_a_meaning() -> None:
    assert set(ATP_MEANING) == {f"atp.{key}" for key in AtpTable.model_fields}
