"""Systems by name: requirements on an entry point, and a one-line error if they are not met."""

from __future__ import annotations

import importlib
from dataclasses import replace
from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.dbc import wire_contract
from railhil.scenarios import system as systems
from railhil.scenarios.load import load, load_any
from railhil.scenarios.scenario_documents import any_document, any_judged_sha256
from railhil.scenarios.system import GROUP, System, system_named
from railhil.systems.ato import ATO

BAD_EVENT = replace(ATO, name="bad_event", events={"arrived": 2})
MISNAMED = replace(ATO, name="other")
NO_SYSTEM = 3
NO_PORTS = replace(ATO, name="no_ports", ports="railhil_of_nobody:ports.toml")


class EarlierScenarios:
    """A reader of scenarios as in version 0.1.0."""

    def __init__(self, system: System) -> None:
        self.stored = system.name


def plugged(folder: Path, patch: pytest.MonkeyPatch, **named: str) -> None:
    """Systems of this module, or references, known by these names until the end of the test."""
    package = folder / "plug" / "systems_of_a_test-1.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: systems-of-a-test\nVersion: 1\n")
    lines = [f"{name} = {value}" for name, value in named.items()]
    (package / "entry_points.txt").write_text("\n".join((f"[{GROUP}]", *lines, "")))
    patch.syspath_prepend(str(package.parent))
    importlib.invalidate_caches()


def test_todays_train_is_the_first_system() -> None:
    scenario = load("lvshun_tieshan")
    system = system_named(scenario.system)
    assert system is ATO
    assert system.contract.sha256 == wire_contract().sha256
    assert system.law in system.law_names()
    for part in ("scenarios", "plant", "controller", "judging", "pictures"):
        assert system.part(part) is not None
    assert load_any("lvshun_tieshan") == scenario
    assert any_document(scenario)["system"] == "ato"
    assert len(any_judged_sha256(scenario)) == 64


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (f"{__name__}:BAD_EVENT", "events.arrived: found 2, allowed 32 to 255"),
        (f"{__name__}:MISNAMED", "naming a System called plugged"),
        (f"{__name__}:NO_SYSTEM", "naming a System called plugged"),
        ("railhil_of_nobody:SYSTEM", "an entry point that can be imported"),
    ],
)
def test_an_entry_point_that_is_no_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, value: str, said: str
) -> None:
    name = "bad_event" if "BAD_EVENT" in value else "plugged"
    plugged(tmp_path, monkeypatch, **{name: value})
    with pytest.raises(InputError) as caught:
        system_named(name)
    assert said in str(caught.value)


def test_an_unknown_system_in_a_scenario_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('extends = "lvshun_tieshan"\nsystem = "atto"\n', encoding="utf-8")
    with pytest.raises(
        InputError, match=r"mine.toml: system: found 'atto', allowed one that is installed: ato"
    ) as caught:
        load_any(path)
    assert "did you mean ato?" in str(caught.value)


@pytest.mark.parametrize(
    ("system", "part", "said"),
    [
        (replace(ATO, plant="railhil.plant_sim.ato.train:Nobody"), "plant", "a part that can be imported"),
        (ATO, "interface", "no such part"),
        (ATO, "events", "no such part"),
    ],
)
def test_a_part_that_is_not_there(system: System, part: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        system.part(part)


def test_parts_as_version_0_1_0_gives_them() -> None:
    reference = "mine.runs:at_once"
    assert replace(ATO, own={"together": reference}) == replace(ATO, sequence_batch=reference)
    assert replace(ATO, own={"direct": reference}) == replace(ATO, direct=reference)
    with pytest.raises(InputError, match=r"system ato: own: found 'batsh', allowed .*kernel.*did you mean batch"):
        replace(ATO, own={"batsh": reference})


def test_a_port_table_that_is_not_there() -> None:
    with pytest.raises(InputError, match="package:file"):
        assert NO_PORTS.contract
    assert systems.names() == ["ato", "emu3", "hst1", "line", "stop"]


def test_a_reader_of_scenarios_of_version_0_1_0_is_told_the_new_name() -> None:
    earlier = replace(ATO, scenarios=f"{__name__}:EarlierScenarios")
    with pytest.raises(InputError, match=r"system ato: scenarios: .*, allowed one with the method restore, which was"):
        _ = earlier.scenario_kind
