"""The table of transports: one row and one link are a transport."""

from __future__ import annotations

from importlib import import_module

import pytest

from railhil.bus import transports
from railhil.bus.link import open_link
from railhil.bus.link.single import SingleLink
from railhil.bus.transports import TRANSPORTS, Transport, limits, limits_of, transport_of


class Mine(SingleLink):
    """A link of somebody's own."""


@pytest.mark.parametrize("transport", TRANSPORTS, ids=lambda one: one.name or "-".join(one.interfaces) or "other")
def test_every_row_names_a_link_that_can_be_opened_and_says_what_is_not_modelled(transport: Transport) -> None:
    module, _, name = transport.link.partition(":")
    assert callable(getattr(import_module(module), name).opened)
    assert len(transport.unmodelled) > 10


@pytest.mark.parametrize(
    ("bus", "name"),
    [
        ("local:", "local"),
        ("railhil:pipes", "railhil pipes"),
        ("railhil:pipes:4,5", "railhil pipes"),
        ("railhil:/tmp/pipes.sock", "railhil"),
        ("socketcan:vcan3", "socketcan vcan"),
        ("socketcan:can0", "socketcan can"),
        ("slcan:/dev/ttyACM0", "slcan, serial adapters"),
        ("kvaser:0", ""),
    ],
)
def test_the_first_row_that_serves_a_bus_is_its_transport(bus: str, name: str) -> None:
    interface, _, channel = bus.partition(":")
    assert transport_of(interface, channel).name == name
    assert not name or limits_of(bus) == limits()[name]


def test_a_row_and_a_link_are_a_transport(monkeypatch: pytest.MonkeyPatch) -> None:
    row = Transport("mine", ("virtual",), "everything but the frames", link=f"{__name__}:Mine")
    monkeypatch.setattr(transports, "TRANSPORTS", (row, *TRANSPORTS))
    link = open_link({"interface": "virtual", "channel": "of this test"})
    try:
        assert type(link) is Mine
    finally:
        link.close()
    assert limits_of("virtual:x") == limits()["mine"] == "everything but the frames"
