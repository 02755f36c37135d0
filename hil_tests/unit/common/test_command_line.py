"""Options of several commands."""

from __future__ import annotations

import argparse

import pytest

from railhil.common.command_line import SEED_MAX, seed_list


def test_seeds_and_ranges_keep_their_order() -> None:
    assert seed_list("0-3", 4) == [0, 1, 2, 3]
    assert seed_list("9,3, 5-6,3", 5) == [9, 3, 5, 6, 3]
    assert seed_list(f"{SEED_MAX}", 1) == [SEED_MAX]
    assert seed_list(" 007 , 1 - 03,\t0", 5) == [7, 1, 2, 3, 0]


@pytest.mark.parametrize(
    "text", ["", "a", "3-1", "0-", "-1", "0-4", "1,2-5", "1 2", "4294967296", "00004294967296", "\u0663", "9" * 5000]
)
def test_other_texts_and_more_seeds_are_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="allowed seeds and ranges"):
        seed_list(text, 4)
