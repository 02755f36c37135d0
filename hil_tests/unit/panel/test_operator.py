"""The form for a fault with values of the operator: what it offers is what the language takes."""

from __future__ import annotations

from railhil.faults.language import parse, with_condition
from railhil.judge.reactions.catalogue import faults_by_hand
from railhil.panel.operator import list_fault_kinds
from railhil.record.prepared_faults import prepared_for
from railhil.scenarios.load import load_any


def test_each_kind_has_its_parameters_with_unit_and_range() -> None:
    texts = [
        "TRN_SPEED loss 5% @manual combine id T1b", "TRN_SPEED loss @manual", "safety_loop off @manual",
        "TRN_POS delay 20ms @manual x3", "TRN_SPEED loss @20s", "TRN_SPEED masquerade PLT_STAT @manual",
    ]  # fmt: skip
    loss, delay, masquerade = list_fault_kinds(texts)
    assert (loss["name"], loss["tail"]) == ("TRN_SPEED loss", "")
    assert [(one["keyword"], one["value"], one["unit"], one["range"]) for one in loss["parameters"]] == [
        ("", "5%", "%", "0% to 100%"), ("gemodel", "0%", "%", "0% to 100%"), ("gemodel", "100%", "%", "0% to 100%")
    ]  # fmt: skip
    assert (delay["tail"], delay["parameters"][0]["range"]) == ("x3", "0s to 100s")
    assert masquerade["parameters"][0]["fixed"]


def test_the_whole_catalogue_can_be_offered_and_is_taken_as_it_stands() -> None:
    faults = faults_by_hand(load_any("lvshun_tieshan"))
    kinds = list_fault_kinds(faults)
    assert len(kinds) >= 25
    for kind in kinds:
        groups: dict[str, list[str]] = {}
        for one in kind["parameters"]:
            groups.setdefault(one["keyword"], []).append(one["value"])
        values = [word for keyword, texts in groups.items() for word in (keyword, *texts)]
        text = " ".join(filter(None, (kind["name"], *values, kind["tail"])))
        found = prepared_for(text, faults, ())
        assert not isinstance(found, str), found
        number, octets, _, made = found
        assert octets == b""
        assert made == faults[number - 1]
        assert parse(with_condition(text, "manual")).what == parse(made).what
