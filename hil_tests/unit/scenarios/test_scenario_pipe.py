"""A node takes the scenario that it is handed, and reads no file then."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from railhil.bus.errors import BusUnavailable
from railhil.common.errors import InputError
from railhil.controller_node import command as controller
from railhil.plant_sim import command as plant
from railhil.scenarios.load import load_any
from railhil.scenarios.scenario_pipe import offer_scenario, receive_scenario


@pytest.mark.parametrize("name", ["lvshun_tieshan", "emu3_short", "yizhuang_stop_slide"])
def test_the_scenario_is_the_same(name: str) -> None:
    scenario = load_any(name)
    with offer_scenario(scenario) as (_, inherits):
        # Plant and controller read the same memory, in any order.
        assert [receive_scenario(os.dup(*inherits)) for _ in range(2)] == [scenario, scenario]


def test_what_cannot_be_pickled_is_not_handed() -> None:
    scenario: Any = SimpleNamespace(law=lambda: None)
    with offer_scenario(scenario) as (words, inherits):
        assert not words
        assert not inherits


@pytest.mark.parametrize("node", [plant, controller])
def test_a_node_reads_no_file(node: Any, tmp_path: Path) -> None:
    elsewhere = ["-i", "railhil", "-c", str(tmp_path / "hub.sock"), "--bus-kwargs", "connect_timeout=0"]
    with pytest.raises(InputError, match="does not exist"):
        node.main(["gone.toml", *elsewhere])
    with offer_scenario(load_any("lvshun_tieshan")) as (words, inherits):
        words = [words[0], str(os.dup(*inherits))]
        with pytest.raises(BusUnavailable, match="no hub at"):
            node.main(["gone.toml", *words, *elsewhere])
