"""python-can's options without python-can: the same options and messages, and no import by what does not need it."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import can
import can.cli
import pytest

from railhil.bus import can_settings


def outcome(add: object, words: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[object, str]:
    """What a parser makes of a command line, and the last line that it prints."""
    parser = argparse.ArgumentParser(prog="railhil node")
    add(parser)  # type: ignore[operator]
    try:
        found: object = {key: str(value) for key, value in vars(parser.parse_args(words)).items()}
    except SystemExit as error:
        found = error.code
    return found, "".join(capsys.readouterr()).strip().rpartition("\n")[2]


@pytest.mark.parametrize(
    "words",
    [
        "-i railhil -c /tmp/hub.sock --fd",
        "-i virtual -b 500000 --data-bitrate 2000000",
        "-i nonsense",
        "-b fast",
        "--bus-kwargs connect_timeout=1e9 name=a rtscts=True",
        "--bus-kwargs 1=2",
        "--timing f_clock=8000000 tseg1=5 tseg2=2 sjw=2 brp=2 nof_samples=1",
        "--timing f_clock=8000000",
        "--timing brp",
    ],
)
def test_options_are_those_of_python_can(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    ours = outcome(can_settings.add_bus_arguments, words.split(), capsys)
    assert ours == outcome(can.cli.add_bus_arguments, words.split(), capsys)


def test_no_option_of_python_can_is_missing() -> None:
    ours, theirs = argparse.ArgumentParser(), argparse.ArgumentParser()
    can_settings.add_bus_arguments(ours)
    can.cli.add_bus_arguments(theirs)
    assert set(ours._option_string_actions) == set(theirs._option_string_actions)


def test_settings_are_looked_for_where_python_can_does(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert list(can_settings._FILES) == can.util.CONFIG_FILES
    assert can_settings.has_settings({}), "python-can is in use here"
    monkeypatch.delitem(sys.modules, "can")
    monkeypatch.setattr(can_settings, "_FILES", (str(tmp_path / "can.conf"),))
    assert not can_settings.has_settings({"HOME": "/"})
    assert can_settings.has_settings({"CAN_CHANNEL": "vcan0"})
    (tmp_path / "can.conf").write_text("[default]\n", encoding="ascii")
    assert can_settings.has_settings({})


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    "module",
    ["bus.hub.cli", "plant_sim.command", "controller_node.command", "run.run", "judge.folder", "cli.run"],
)
def test_a_run_on_the_hub_loads_no_python_can(module: str) -> None:
    words = [sys.executable, "-X", "importtime", "-c", f"import railhil.{module}"]
    loaded = subprocess.run(words, capture_output=True, text=True, check=True).stderr
    names = {line.rpartition("|")[2].strip().partition(".")[0] for line in loaded.splitlines()}
    assert "railhil" in names
    assert not names & {"can", "asammdf", "pandas", "scipy", "matplotlib", "cantools", "numba"}
    if module.endswith(".command"):
        # A node is handed its scenario, and checks it again only without.
        assert "pydantic" not in names
