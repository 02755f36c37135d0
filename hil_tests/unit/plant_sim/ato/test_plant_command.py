"""The command line of the plant's process."""

from __future__ import annotations

import os

import pytest

from hil_tests.support.warm import run_module


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--timing-file", "x.csv"), "--timing-file: used only with --pace realtime"),
        (
            ("--pace", "realtime", "--timing-file", "/nowhere/x.csv"),
            "--timing-file: the file /nowhere/x.csv cannot be written",
        ),
        (("--rate", "4"), "argument --rate: allowed only with --pace realtime"),
        (("--realtime-priority", "99"), "--realtime-priority: found 99, allowed 0..98"),
        (("--realtime-priority", "-1"), "--realtime-priority: "),
    ],
)
def test_bad_options_of_the_plant_are_one_line(options: tuple[str, ...], message: str) -> None:
    done = run_module("railhil.plant_sim", options, environment=os.environ)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert message in done.stderr
