"""Orders of an operator as text."""

from __future__ import annotations

import pytest

from railhil.common.errors import InputError
from railhil.scenarios.operator_commands import OperatorCommand, parse_command, parse_commands
from railhil.scenarios.run_spec import RunSpec


@pytest.mark.parametrize(
    "one",
    [
        OperatorCommand(2, "pause"),
        OperatorCommand(75, "inject", 1),
        OperatorCommand(75, "clear", 255),
        OperatorCommand(999_999_999, "stop"),
    ],
)
def test_a_text_is_read_as_it_is_written(one):
    assert parse_command(one.text) == one


@pytest.mark.parametrize(
    "text",
    [
        "",
        "75",
        "1 stop",
        "75 inject",
        "75 inject 0",
        "75 inject 256",
        "75 stop 1",
        "75 start",
        "x stop",
        "75  stop",
        "-7 stop",
    ],
)
def test_other_texts_are_refused(text):
    with pytest.raises(InputError, match="order"):
        parse_command(text)


def test_one_telegram_carries_one_order():
    with pytest.raises(InputError, match="there is '75 pause'"):
        parse_commands(["75 pause", "75 stop"])


def test_a_run_keeps_its_orders_in_certificate_and_command(tmp_path):
    spec = RunSpec(orders=("75 inject 1", "80 stop"))
    assert spec.words[-4:] == ["--order", "75 inject 1", "--order", "80 stop"]
    assert RunSpec.from_json(spec.as_json(), tmp_path) == spec
