"""The value in a message: the beginning of its ``repr``, made in no time whatever the value is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from railhil.common.errors import InputError, short_repr
from railhil.common.user_files import given_json
from railhil.scenarios.tomlfile import parse_toml
from railhil.scenarios.validation import join_keys


@pytest.mark.parametrize(
    "value",
    [None, True, -3, 2.5, "a 'b'", b"\x00", [], (), {}, [1, [2.0, "x"]], (1,), (1, 2), {"a": [1], 2: {"b": ()}}, {1}],
)
def test_a_short_value_is_shown_as_python_does(value: object) -> None:
    assert short_repr(value) == repr(value)


def nested(levels: int) -> list[Any]:
    """A value of ``9 ** levels`` parts that takes the room of a few lists."""
    value: list[Any] = ["x"] * 9
    for _ in range(levels):
        value = [value] * 9
    return value


def test_a_value_without_end_is_shown_by_its_beginning() -> None:
    ring: list[Any] = []
    ring.append(ring)
    for value in (nested(15), {"a": nested(30)}, "x" * 10**7, [1] * 10**6, tuple(range(1000))):
        shown = short_repr(value)
        assert shown.endswith("...")
        assert len(shown) == 80
    assert short_repr([1] * 10**6).startswith("[1, 1, 1,")
    assert len(short_repr(ring)) < 80


def test_a_number_of_thousands_of_digits_is_shown_by_its_size() -> None:
    value = parse_toml(f"a = 0x{'f' * 5000}")["a"]
    assert str(InputError("f", "a", value, "a number")) == "f: a: found a whole number of 20000 bits, allowed a number"


def test_a_long_key_is_shortened() -> None:
    assert join_keys(("line", "k" * 10**6, 2)) == f"line.{'k' * 80}...[2]"


def test_a_key_that_stands_twice_in_json_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    for text, words in (
        ('{"a": {"b": 1, "c": 2, "b": 1}}', "the key 'b' stands there twice"),
        ('\ufeff{"a": 1}', "byte order mark"),
    ):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match=words):
            given_json(path, "an object")


def test_a_byte_order_mark_in_toml_is_named() -> None:
    with pytest.raises(ValueError, match="begins with a byte order mark"):
        parse_toml("\ufeffa = 1")
