"""Selection of the bus: flags, then python-can's configuration, then vcan0, then the hub; and passing it to other
processes."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import can
import pytest
from can.cli import add_bus_arguments
from hypothesis import given
from hypothesis import strategies as st

from railhil.bus.can_settings import named_bus
from railhil.bus.select import BusChoice, arguments_from_config, choose_bus
from railhil.common.errors import InputError


def parsed(*arguments: str) -> dict[str, Any]:
    parser = argparse.ArgumentParser()
    add_bus_arguments(parser)
    return named_bus(parser.parse_args(arguments))


@pytest.fixture(autouse=True)
def _clean(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No configuration of this machine."""
    monkeypatch.setattr(can.util, "CONFIG_FILES", [str(tmp_path / "can.rc")])
    for name in ("CAN_INTERFACE", "CAN_CHANNEL", "CAN_BITRATE", "CAN_CONFIG"):
        monkeypatch.delenv(name, raising=False)


def chosen(*arguments: str, private_hub: Path | None = None, vcan: bool = False) -> BusChoice:
    """The choice for a command line; there is no vcan0 unless a test says so."""
    return choose_bus(parsed(*arguments), private_hub, vcan)


@pytest.fixture
def configured(tmp_path: Path) -> None:
    """A configuration file."""
    (tmp_path / "can.rc").write_text("[default]\ninterface = virtual\nchannel = from_file\nbitrate = 125000\n")


@pytest.mark.usefixtures("configured")
def test_flags_come_first(tmp_path: Path) -> None:
    choice = chosen("-i", "virtual", "-c", "mine", private_hub=tmp_path / "hub", vcan=True)
    assert choice.config == {"interface": "virtual", "channel": "mine"}
    assert (choice.reason, choice.needs_hub, choice.transport) == ("given on the command line", False, "virtual:mine")


@pytest.mark.usefixtures("configured")
def test_configuration_file_comes_second(tmp_path: Path) -> None:
    choice = chosen(private_hub=tmp_path / "hub", vcan=True)
    assert choice.config == {"interface": "virtual", "channel": "from_file", "bitrate": 125000}
    assert choice.reason == "from python-can's configuration"
    assert not choice.needs_hub


def test_environment_is_configuration(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CAN_INTERFACE", "virtual")
    monkeypatch.setenv("CAN_CHANNEL", "from_environment")
    assert chosen().transport == "virtual:from_environment"


def test_a_channel_alone_takes_its_interface_from_the_configuration(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else nobody knows which bus it is: report, limits and record would stand for another one."""
    monkeypatch.setenv("CAN_INTERFACE", "railhil")
    choice = chosen("-c", "mine")
    assert choice.transport == "railhil:mine"
    assert choice.arguments == ["-i", "railhil", "-c", "mine"]
    assert "configuration" in choice.reason


def test_a_configured_interface_without_channel_has_no_channel_called_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CAN_INTERFACE", "railhil")
    monkeypatch.delenv("CAN_CHANNEL", raising=False)
    assert chosen().arguments == ["-i", "railhil"]


@pytest.mark.parametrize(
    ("variables", "named"),
    [
        ({"CAN_INTERFACE": "socketcan_native", "CAN_CHANNEL": "can0"}, "CAN_INTERFACE: found 'socketcan_native'"),
        ({"CAN_INTERFACE": "SocketCAN"}, "(did you mean socketcan?)"),
        ({"CAN_INTERFACE": "sockecan"}, "(did you mean socketcan?)"),
        ({"CAN_CHANNEL": "can0"}, "CAN_CHANNEL: channel can0 without an interface"),
        ({"CAN_INTERFACE": "virtual", "CAN_BITRATE": "fast"}, "CAN_BITRATE: found 'fast'"),
        ({"CAN_CONFIG": "{"}, "CAN_CONFIG: found '{'"),
        ({"CAN_CONFIG": "[1]"}, "CAN_CONFIG: found '[1]'"),
        (
            {"CAN_CONFIG": '{"interface": "virtual", "receive_own_messages": "no"}'},
            "CAN_CONFIG: receive_own_messages: ",
        ),
        ({"CAN_CONFIG": '{"interface": "virtual", "port": "x"}'}, "CAN_CONFIG: port: found 'x'"),
    ],
)
def test_a_wrong_variable_is_refused_by_its_name(
    variables: dict[str, str], named: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    with pytest.raises(InputError) as error:
        chosen()
    assert str(error.value).startswith("environment: CAN_")
    assert named in str(error.value)


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("interface = socketcan\n", ""),
        ("[default]\ninterface = sockecan\nchannel = can0\n", "interface"),
        ("[default]\nbustype = sockecan\n", "bustype"),
        ("[default]\ninterfce = socketcan\n", "interfce"),
        ("[default]\ninterface = virtual\nfd = no\n", "fd"),
        ("[default]\ninterface = virtual\nchannel = 50%\n", ""),
        ("[default]\ninterface = virtual\ninterface = socketcan\n", ""),
        ("[default\xff", ""),
    ],
)
def test_a_wrong_file_is_refused_by_its_name(tmp_path: Path, text: str, key: str) -> None:
    (tmp_path / "can.rc").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError) as error:
        chosen()
    assert (error.value.file, error.value.key) == (str(tmp_path / "can.rc"), key)


@pytest.mark.usefixtures("configured")
def test_a_wrong_file_is_refused_beside_a_command_line_too(tmp_path: Path) -> None:
    (tmp_path / "can.rc").write_text("interface = socketcan\n")
    with pytest.raises(InputError):
        chosen("-i", "virtual", "-c", "mine")


def test_what_the_command_line_overrides_need_not_be_right(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CAN_INTERFACE", "sockecan")
    assert chosen("-i", "virtual", "-c", "mine").transport == "virtual:mine"


@pytest.mark.parametrize("arguments", [("-c", "can0"), ("-b", "500000")])
def test_a_channel_without_any_interface_is_refused(arguments: tuple[str, ...]) -> None:
    with pytest.raises(InputError, match="--interface: only -"):
        chosen(*arguments)


def test_a_folder_in_the_place_of_a_file_is_none_as_in_python_can(tmp_path: Path) -> None:
    (tmp_path / "can.rc").mkdir()
    assert chosen().config["interface"] == "railhil"


def test_vcan0_comes_third_and_the_hub_last(tmp_path: Path) -> None:
    hub = chosen(private_hub=tmp_path / "hub")
    assert hub.config["interface"] == "railhil"
    assert hub.config["channel"] == str(tmp_path / "hub")
    assert hub.needs_hub
    assert "user-space hub" in hub.reason
    assert not chosen().needs_hub
    vcan = chosen(private_hub=tmp_path / "hub", vcan=True)
    assert (vcan.transport, vcan.reason, vcan.needs_hub) == ("socketcan:vcan0", "the kernel has vcan0", False)


@pytest.mark.parametrize("arguments", [(), ("--fd",)])
def test_fd_is_what_the_configuration_says(arguments: tuple[str, ...]) -> None:
    assert chosen("-i", "virtual", *arguments).fd == bool(arguments)


def round_trip(config: dict[str, Any]) -> dict[str, Any]:
    return parsed(*arguments_from_config(config))


_WORD = st.from_regex(r"[A-Za-z/._][A-Za-z0-9/._:\-]{0,20}", fullmatch=True)
_EXTRA = st.dictionaries(
    st.from_regex(r"[a-z]{3}_[a-z]{3,8}", fullmatch=True),
    st.one_of(_WORD.filter(lambda text: isinstance(can.util.cast_from_string(text), str)), st.integers(0, 10**6)),
    max_size=3,
)


@pytest.mark.slow
@given(
    st.fixed_dictionaries(
        {"interface": st.sampled_from(["virtual", "socketcan", "railhil"]), "channel": _WORD},
        optional={
            "bitrate": st.integers(1, 10**6),
            "data_bitrate": st.integers(1, 10**7),
            "fd": st.just(True),
        },
    ),
    _EXTRA,
)
def test_flags_give_another_process_the_same_bus(config: dict[str, Any], extra: dict[str, Any]) -> None:
    assert round_trip({**config, **extra}) == {**config, **extra}


@pytest.mark.parametrize("value", [True, False, 1.5, "text", 12])
def test_bus_arguments_keep_their_type(value: object) -> None:
    assert round_trip({"interface": "virtual", "option": value})["option"] == value
    assert type(round_trip({"interface": "virtual", "option": value})["option"]) is type(value)


@pytest.mark.parametrize("hub", [None, Path("/tmp/private/hub.sock")])
def test_the_choice_itself_can_be_handed_on(hub: Path | None) -> None:
    choice = choose_bus(parsed(), hub)
    again = parsed(*choice.arguments)
    assert {key: str(value) for key, value in again.items()} == {
        key: str(value) for key, value in choice.config.items()
    }


def test_hub_without_channel_is_a_hub_of_the_run_s_own(tmp_path: Path) -> None:
    choice = choose_bus(parsed("-i", "railhil"), tmp_path / "hub.sock")
    assert choice.needs_hub
    assert choice.config["channel"] == str(tmp_path / "hub.sock")
    # Nodes cannot see its process: they wait long, unless told otherwise.
    assert choice.arguments[-2:] == ["--bus-kwargs", "connect_timeout=300.0"]
    told = choose_bus(parsed("-i", "railhil", "--bus-kwargs", "connect_timeout=9"), tmp_path / "hub.sock")
    assert told.config["connect_timeout"] == 9
    # Without a place for one of its own, python-can's plugin takes the user's default hub.
    assert not chosen("-i", "railhil").needs_hub
