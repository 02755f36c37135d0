"""Which telegrams of a port are used: life sign and check variables, for layouts with and without them."""

from __future__ import annotations

from collections import Counter
from types import SimpleNamespace
from typing import Any

import pytest

from railhil.bus.acceptance import Acceptance, checks_of, life_of
from railhil.bus.telegrams import RunEvent
from railhil.common.errors import InputError
from railhil.wire.ato import NotchCmd, TrnSpeed


def test_what_a_layout_has() -> None:
    assert life_of(RunEvent) is None
    assert life_of(TrnSpeed) is not None
    assert list(checks_of(TrnSpeed)) == ["check"]
    assert checks_of(RunEvent) == {}


def test_a_telegram_without_life_sign_and_check_is_always_accepted() -> None:
    counters: Counter[str] = Counter()
    acceptance = Acceptance(RunEvent, counters)
    assert [acceptance.accept(RunEvent()) for _ in range(3)] == [True] * 3
    assert counters == {}


def test_every_step_of_the_life_sign_with_every_check() -> None:
    for step in range(16):
        for check in range(4):
            counters: Counter[str] = Counter()
            acceptance = Acceptance(NotchCmd, counters)
            assert acceptance.accept(NotchCmd(0, life=9))
            fresh = 1 <= step <= 7
            assert acceptance.accept(NotchCmd(0, check=check, life=(9 + step) % 16)) == (fresh and check == 1)
            expected = {
                "duplicate": step == 0,
                "out_of_order": step > 7,
                "gap": 2 <= step <= 7,
                "check_variable": fresh and check != 1,
            }
            assert counters == {cause: 1 for cause, holds in expected.items() if holds}
            # A fresh life sign is remembered, whatever the check says.
            again = acceptance.accept(NotchCmd(0, life=(10 + step) % 16))
            assert again == (step <= 7)


@pytest.mark.parametrize("raw_range", [(0, 255), (0, 7), (-8, 7)])
def test_a_life_sign_has_four_bits(raw_range: tuple[int, int]) -> None:
    signal = SimpleNamespace(raw_range=raw_range, check=None)
    kind: Any = SimpleNamespace(PORT="X", signals=lambda: [("life", signal)])
    words = rf"^ports: X\.life: {raw_range[0]} to {raw_range[1]}, expected a life sign of 4 bits, 0 to 15$"
    with pytest.raises(InputError, match=words):
        life_of(kind)


def test_a_layout_with_a_life_sign_and_two_check_variables() -> None:
    """Both have to be correct."""
    parts = {
        "life": SimpleNamespace(raw_range=(0, 15), check=None),
        "one": SimpleNamespace(check="chk"),
        "two": SimpleNamespace(check="chk"),
    }
    kind: Any = SimpleNamespace(PORT="X", signals=lambda: list(parts.items()))
    for one, two in ((1, 1), (1, 0), (0, 1), (2, 2)):
        acceptance = Acceptance(kind, Counter())
        assert acceptance.accept(SimpleNamespace(life=0, one=one, two=two)) == (one == two == 1)  # type: ignore[arg-type]
