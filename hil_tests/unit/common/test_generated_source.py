"""Functions whose text is made while the bench runs: they work, and tracebacks and debuggers show their lines."""

from __future__ import annotations

import linecache
import traceback

import pytest

from railhil.common.generated_source import compile_source
from railhil.wire.ato import TrnSpeed


def test_functions_see_the_names_and_each_other() -> None:
    text = "def one():\n    return more\n\n\ndef two():\n    return one() + 1\n"
    made = compile_source("pair of a test", text, {"more": 7})
    assert sorted(made) == ["one", "two"]
    assert made["two"]() == 8


def test_two_texts_of_one_title_are_shown_apart() -> None:
    first, second, again = (
        compile_source("text of a test", f"def found():\n    return {number}\n")["found"] for number in (1, 2, 1)
    )
    assert [first(), second(), again()] == [1, 2, 1]
    names = [function.__code__.co_filename for function in (first, second, again)]
    assert names == ["<railhil text of a test>", "<railhil text of a test 2>", "<railhil text of a test>"]
    assert linecache.getline(names[0], 2) == "    return 1\n"
    assert linecache.getline(names[1], 2) == "    return 2\n"


def test_names_of_one_use_are_not_those_of_another() -> None:
    text = "def found():\n    return number\n"
    first, second = (compile_source("number of a test", text, {"number": number})["found"] for number in (1, 2))
    assert (first(), second()) == (1, 2)
    assert first.__code__ is second.__code__


def test_a_traceback_through_a_codec_shows_its_line() -> None:
    with pytest.raises(OverflowError) as error:
        TrnSpeed(1 << 23).encode()
    # As a traceback does: what has changed on disk is dropped.
    linecache.checkcache()
    text = "".join(traceback.format_exception(error.value))
    assert 'File "<railhil telegram TRN_SPEED' in text
    assert "\n    raise telegram.misfit()\n" in text
