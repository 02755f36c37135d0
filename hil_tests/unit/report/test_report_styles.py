"""Runs in the same axes can be told apart, also in greyscale; laws have the same order everywhere."""

from __future__ import annotations

from railhil.common.plug_ins import sort_laws
from railhil.controller_node.ato.laws import ORDER
from railhil.report.styles import Style, styles
from railhil.scenarios.system import system_named
from railhil.systems.ato.scenario.model import Scenario


def look(style: Style) -> tuple[object, ...]:
    """What a grey print keeps of a style."""
    return style.look.dashes, style.look.width, style.look.marker, style.look.is_full


def test_runs_differ_also_in_grey() -> None:
    """Own and tuned parameters of all laws; twelve runs of one law; laws of others."""
    both = styles([law for law in ORDER for _ in range(2)])
    for runs in (
        both,
        styles(["ipfc"] * 12),
        styles([*ORDER, "mine", "yours"]),
        styles([f"law{n}" for n in range(12)]),
    ):
        assert len({look(style) for style in runs}) == len(runs)
    for own, tuned in zip(both[::2], both[1::2], strict=True):
        assert own.colour == tuned.colour
    assert len({style.colour for style in both}) == len(ORDER)
    # A law looks the same whatever is drawn beside it.
    assert styles(["mine", "tdmc", "ipfc_plus"])[1:] == [both[6], both[10]]
    assert len(styles(["ipfc"] * 40)) == 40


def test_laws_stand_in_the_order_of_the_published_table(lvshun: Scenario) -> None:
    assert [row.controller for row in lvshun.published] == list(ORDER[:5])
    assert sort_laws(["zeta", "ipfc_plus", "tdmc", "alpha", "ipfc"]) == ["ipfc", "tdmc", "ipfc_plus", "alpha", "zeta"]
    laws = system_named("ato").law_names()
    assert list(laws) == sort_laws(laws)
