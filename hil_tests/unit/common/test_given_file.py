"""Files that a user gives: regular ones of a bounded size, read at once or refused at once."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from hil_tests.support.cli import complaint, railhil
from railhil.common.errors import InputError
from railhil.common.user_files import given_bytes, given_text
from railhil.scenarios.tomlfile import DEPTH_MAX, parse_toml


@pytest.fixture
def pipe(tmp_path: Path) -> Path:
    """A named pipe that nobody writes."""
    os.mkfifo(tmp_path / "pipe.toml")
    return tmp_path / "pipe.toml"


def test_a_file_is_read_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"one\r\ntwo\rthree\n")
    assert given_bytes(tmp_path / "a") == b"one\r\ntwo\rthree\n"
    assert given_text(tmp_path / "a") == "one\ntwo\nthree\n"


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null"])
def test_a_device_is_refused(path: str) -> None:
    with pytest.raises(InputError, match="is a device or socket, expected a regular file"):
        given_bytes(Path(path))


def test_a_pipe_is_refused_without_waiting(pipe: Path) -> None:
    with pytest.raises(InputError, match="is a pipe, expected a regular file"):
        given_text(pipe)


def test_a_file_that_is_too_large_is_refused_unread(tmp_path: Path) -> None:
    with (tmp_path / "huge").open("wb") as stream:
        stream.truncate(10**12)
    with pytest.raises(InputError, match="has 1000000000000 bytes, expected at most 64000000"):
        given_bytes(tmp_path / "huge")


def test_what_cannot_be_opened_is_an_error_of_the_system(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError):
        given_bytes(tmp_path)
    with pytest.raises(FileNotFoundError):
        given_bytes(tmp_path / "none")


@pytest.mark.parametrize(
    "words",
    ["run --bus local {}", "run --bus local --spec {}", "run --bus local --parameters {}", "run --bus local --dbc {}",
     "run --bus local --memory-from {}", "run --bus local --plant-fmu {}", "memory verify {}", "score {}"],
)  # fmt: skip
def test_no_command_waits_for_a_pipe(pipe: Path, words: str) -> None:
    said = complaint(railhil(*words.format(pipe).split()))
    assert "pipe.toml: is a pipe" in said or "pipe.toml: is no regular file" in said


def test_a_pipe_in_the_place_of_a_scenario_s_file_is_refused(pipe: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text('extends = "pipe.toml"\nname = "mine"\n')
    assert "extends" in complaint(railhil("scenarios", tmp_path / "mine.toml"))


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["a"] * 50_000) + " = 1",
        f"[{'.'.join(['a'] * 50_000)}]",
        " . ".join(['"a"', "b", "'c'"] * 20_000) + " = 1",
        "x = {" + ".".join(["a"] * 50_000) + " = 1}",
    ],
)
@pytest.mark.timeout(20)
def test_a_key_of_thousands_of_parts_is_refused_at_once(text: str) -> None:
    with pytest.raises(ValueError, match=f"more than {DEPTH_MAX}"):
        parse_toml(text)


def test_dots_elsewhere_are_no_parts_of_a_key() -> None:
    dots = ".".join(["a"] * 100)
    quotes = 3 * '"'
    numbers = ", ".join(["0.5"] * 100)
    text = f"a = \"{dots}\" # {dots}\nb = [{numbers}]\nc = {quotes}\n{dots}\n{quotes}\nd = '{dots}'\n"
    assert parse_toml(text) == {"a": dots, "b": [0.5] * 100, "c": f"{dots}\n", "d": dots}
    key = ".".join(["a"] * (DEPTH_MAX - 1))
    assert parse_toml(f"{key} = 1")
