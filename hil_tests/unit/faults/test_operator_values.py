"""Values of an operator as octets: whole, or nothing."""

from __future__ import annotations

import pytest

from railhil.bus.codes import FaultOrder
from railhil.bus.injector.activities import Activities
from railhil.faults.language import fault_text, parse
from railhil.faults.operator_values import is_kind, octets_of, with_octets


@pytest.mark.parametrize(
    ("prepared", "wanted"),
    [
        ("TRN_SPEED loss @manual", "TRN_SPEED loss 12.5% @manual"),
        ("TRN_SPEED loss 5% @manual", "TRN_SPEED loss 5% gemodel 1% 40% @manual"),
        ("TRN_SPEED.TrainSpeed raw 1 @manual x10", "TRN_SPEED.TrainSpeed raw 8388607 @manual x10"),
        ("speed value 0 @manual", "speed value -0.0625 @manual"),
        ("NOTCH_CMD replay 100ms @manual", "NOTCH_CMD replay 1.234s @manual"),
    ],
)
def test_the_nodes_read_the_values_that_were_typed(prepared: str, wanted: str) -> None:
    before, after = parse(prepared), parse(wanted)
    assert is_kind(before, after)
    found = with_octets(7, before, octets_of(7, before, after))
    assert found is not None
    assert fault_text(found) == fault_text(after)
    assert octets_of(7, after, after) == b""


@pytest.mark.parametrize(
    "other",
    [
        "TRN_POS loss @manual",
        "TRN_SPEED stuck @manual",
        "TRN_SPEED loss @manual x3",
        "TRN_SPEED masquerade TRN_POS @manual",
    ],
)
def test_another_kind_is_not_made_by_values(other: str) -> None:
    prepared = "TRN_SPEED masquerade PLT_STAT @manual" if "masquerade" in other else "TRN_SPEED loss @manual"
    assert not is_kind(parse(prepared), parse(other))


def test_octets_of_which_one_is_lost_or_wrong_inject_nothing() -> None:
    prepared = parse("TRN_SPEED loss @manual expect HOLD")
    octets = octets_of(1, prepared, parse("TRN_SPEED loss 12% @manual expect HOLD"))
    broken = [octets[:place] + octets[place + 1 :] for place in range(len(octets))]
    broken += [octets[:place] + bytes((octets[place] ^ 1,)) + octets[place + 1 :] for place in range(len(octets))]
    assert [with_octets(1, prepared, one) for one in broken] == [None] * len(broken)
    assert with_octets(2, prepared, octets) is None

    node = Activities([(1, prepared)])
    for octet in broken[2]:
        node.order_now(octet, FaultOrder.VALUE)
    node.order_now(1, FaultOrder.INJECT)
    node.look(10, 0.0, 0.0)
    assert not node.all[0].active
    # What was left over is forgotten.
    for octet in octets:
        node.order_now(octet, FaultOrder.VALUE)
    node.order_now(1, FaultOrder.INJECT)
    node.look(20, 0.0, 0.0)
    assert node.all[0].active
    assert node.all[0].fault.values["share"] == 0.12
    # What is injected, not what is expected of it.
    assert "20,begun,,TRN_SPEED loss 12% @manual" in node.log.text(node.all).splitlines()[-1]
    assert "expect" not in node.log.text(node.all)
