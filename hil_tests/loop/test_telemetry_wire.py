"""Telemetry on the wire: encoding of a law's quantities in CTL_STAT, and decoding."""

from __future__ import annotations

import dataclasses
from typing import Any

import cantools
import numpy as np
import pytest

from hil_tests.support.paths import ROOT
from railhil.bench import Result
from railhil.bus.frame import Frame
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.store import TrafficStore
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.telemetry import Telemetry
from railhil.controller_node.telemetry_file import telemetry_document
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log
from railhil.record.notes import Status
from railhil.record.telemetry import shown_telemetry
from railhil.record.trace import Trace
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.judge.events import STATUS
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlStat, TelemetryHeadroom, TelemetryIndex


def answer(node: ControllerNode, telegram: type[Any]) -> Any:
    """What the node answers to a poll."""
    store = TrafficStore([telegram.port()])
    for frame in node.handle(master_frame(telegram.port().f_code, telegram.port().address)):
        store.feed(frame, 0)
    return store.read(telegram, 0)[0]


def running_node(scenario: Scenario, run: Result, arithmetic: str = "iq") -> ControllerNode:
    """A controller that has heard the first seconds of a recorded run."""
    node = ControllerNode(scenario, LawSpec(arithmetic=arithmetic))
    assert run.log is not None
    for time_ns, frame in read_log(run.log):
        if time_ns > 5e9:
            break
        node.handle(Frame(*frame))
    return node


def decoded(extreme: int, headroom_bits: int) -> tuple[int, int]:
    """Raw value of TelemetryExtreme, and by how much the true one may be higher."""
    shift = 16 - headroom_bits
    return (extreme << shift, (1 << shift) - 1) if shift > 0 else (extreme >> -shift, 0)


@pytest.mark.slow
def test_each_quantity_is_shown_twice_in_a_row(nominal: Result) -> None:
    shown, maximum, extreme, headroom = (
        nominal.trace.raw(CtlStat.PORT, f"Telemetry{name}") for name in ("Index", "Maximum", "Extreme", "Headroom")
    )
    first = int(np.argmax(shown != TelemetryIndex.NONE))
    quantities = nominal.telemetry["quantities"]
    assert set(shown[:first].tolist()) <= {TelemetryIndex.NONE}
    assert shown[first:].tolist() == [i // 2 % len(quantities) for i in range(len(shown) - first)]
    assert maximum[first:].tolist() == [i % 2 for i in range(len(shown) - first)]
    for index, quantity in enumerate(quantities):
        seen = headroom[shown == index].tolist()
        assert seen == sorted(seen, reverse=True), quantity["name"]
        assert seen[-1] >= quantity["headroom_bits"]
        for kind, key in enumerate(("minimum_raw", "maximum_raw")):
            row = np.flatnonzero((shown == index) & (maximum == kind))[-1]
            value, below = decoded(int(extreme[row]), int(headroom[row]))
            if kind:
                assert value <= quantity[key], quantity["name"]
            else:
                assert value + below >= quantity[key], quantity["name"]


def test_status_telegram_is_the_telemetry_of_the_moment(lvshun: Scenario, nominal: Result) -> None:
    node = running_node(lvshun, nominal)
    telemetry = node.controller.telemetry
    for kind in (SATURATION, WRAP, DIVISION_BY_ZERO):
        # Between two periods an event belongs to the last quantity.
        number = make("iq")
        number.noted, number.events = [], [(0, kind, 1)]
        telemetry.take(number)
        seen = {}
        for _ in range(2 * len(telemetry.quantities)):
            status = answer(node, CtlStat)
            seen[status.telemetry_index, status.telemetry_maximum] = status
        assert sorted(seen) == [(i, kind) for i in range(len(telemetry.quantities)) for kind in (0, 1)]
        for (index, maximum), status in seen.items():
            row = telemetry.row(index)
            assert status.telemetry_headroom_bits == row.headroom_bits
            value, below = decoded(status.telemetry_extreme, status.telemetry_headroom_bits)
            true = row.maximum_raw if maximum else row.minimum_raw
            assert true is not None
            assert value <= true <= value + below
            assert status.telemetry_wrapped == min(row.wraps, 1)
            assert status.telemetry_saturated == min(row.saturations, 1)
            assert status.telemetry_zero_division == min(row.zero_divisions, 1)
    assert [row.wraps for row in telemetry.rows] == [0] * (len(telemetry.quantities) - 1) + [1]


def test_floats_have_no_headroom_on_the_wire(lvshun: Scenario, nominal: Result) -> None:
    node = running_node(lvshun, nominal, "float64")
    assert any(row.minimum for row in node.controller.telemetry.rows)
    for _ in range(2 * len(node.controller.telemetry.quantities)):
        status = answer(node, CtlStat)
        assert (status.telemetry_headroom_bits, status.telemetry_extreme) == (TelemetryHeadroom.UNUSED, 0)
        assert status.step_cycles == 0
    fresh = answer(ControllerNode(lvshun, LawSpec()), CtlStat)
    assert (fresh.telemetry_index, fresh.telemetry_headroom_bits) == (TelemetryIndex.NONE, TelemetryHeadroom.UNUSED)


def test_extremes_of_every_size_and_the_first_127_quantities(lvshun: Scenario, nominal: Result) -> None:
    """The larger extreme is sent with 15 bits beside its sign, the other one cut off at the same place."""
    sizes = [0, 1, 2, 0x7FFF, 0x8000, 0xFFFF, 0x10000, 0x12345, 0x7FFF_FFFE, 0x7FFF_FFFF]
    values = [*sizes, *(-size for size in sizes[1:]), -(2**31)]
    pairs = [(low, high) for low in values for high in values if low <= high][-130:]
    assert (-(2**31), 2**31 - 1) in pairs[: TelemetryIndex.NONE]
    node = running_node(lvshun, nominal)
    like = node.controller.telemetry.quantities[0]
    telemetry = Telemetry([dataclasses.replace(like, name=f"x{i}") for i in range(len(pairs))])
    number = make("iq")
    for noted in zip(*pairs, strict=True):
        number.noted = list(noted)
        telemetry.take(number)
    node.controller.telemetry, node._reports._shown = telemetry, 0
    for _ in range(2):
        for index, pair in enumerate(pairs[:127]):
            used_bits = min(max(map(abs, pair)).bit_length(), 31)
            for maximum, raw in enumerate(pair):
                status = answer(node, CtlStat)
                assert (status.telemetry_index, status.telemetry_maximum) == (index, maximum)
                assert status.telemetry_headroom_bits == 31 - used_bits
                value, below = decoded(status.telemetry_extreme, status.telemetry_headroom_bits)
                assert value <= raw <= value + below
                assert below == max(0, (1 << used_bits >> 15) - 1)


@pytest.mark.parametrize(("cycles", "sent"), [(65_534, 65_534), (65_535, 65_535), (65_536, 65_535), (9**9, 65_535)])
def test_cycles_saturate_on_the_wire_only(lvshun: Scenario, nominal: Result, cycles: int, sent: int) -> None:
    node = ControllerNode(lvshun, LawSpec())
    node.controller.cost = dataclasses.replace(node.controller.cost, cycles=cycles)
    assert nominal.log is not None
    for time_ns, frame in read_log(nominal.log):
        if time_ns > 1e9:
            break
        node.handle(frame)
    status = answer(node, CtlStat)
    assert status.step_cycles == sent
    assert telemetry_document(node)["cycles"]["ram"] == cycles


def test_cantools_reads_the_telemetry() -> None:
    database = cantools.database.load_file(ROOT / "dbc" / "railhil.dbc")
    telegram = CtlStat(
        step_cycles=0xFFFF,
        telemetry_extreme=-0x1234,
        telemetry_index=126,
        telemetry_maximum=1,
        telemetry_headroom_bits=18,
        telemetry_saturated=1,
        overruns=200,
    )
    block = TelegramSource(CtlStat.port()).frames(telegram.encode())[1]
    decoded: Any = database.decode_message(block.can_id, block.data)
    assert {name: decoded[name] for name in decoded if name.startswith(("Step", "Tele", "Over"))} == {
        "StepCycles": 65_535,
        "TelemetryExtreme": -0x1234,
        "TelemetryIndex": 126,
        "TelemetryMaximum": "maximum",
        "TelemetryHeadroom": 18,
        "TelemetryWrapped": "no",
        "TelemetrySaturated": "yes",
        "TelemetryZeroDivision": "no",
        "OverrunCount": 200,
    }
    nothing: Any = database.decode_message(
        block.can_id, TelegramSource(CtlStat.port()).frames(CtlStat().encode())[1].data
    )
    assert (nothing["TelemetryIndex"], nothing["TelemetryHeadroom"]) == ("none", "unused")
    assert (nothing["TelemetryExtreme"], nothing["TelemetryMaximum"]) == (0, "minimum")


def test_each_quantity_counts_as_it_was_last_shown() -> None:
    trace = Trace(wire_contract())
    for index, maximum, extreme, headroom_bits, wrapped, flags in (
        (0, 0, -12, 18, 0, 0),
        (0, 1, 8, 17, 0, 8),
        (1, 0, 0, TelemetryHeadroom.UNUSED, 0, 0),
        (1, 1, 20_000, 3, 0, 0),
        (0, 0, -32_768, 4, 1, 1),
    ):
        status = CtlStat(
            overflow_flags=flags,
            step_cycles=100,
            telemetry_index=index,
            telemetry_maximum=maximum,
            telemetry_extreme=extreme,
            telemetry_headroom_bits=headroom_bits,
            telemetry_wrapped=wrapped,
        )
        trace.add(CtlStat.PORT, 0, status.encode())
    found = shown_telemetry(trace, STATUS)
    assert found is not None
    none = {"saturated": False, "zero_division": False}
    assert found.as_json() == {
        "source": "CTL_STAT",
        "happened": ("wrap", "message_lost"),
        "least_headroom": {"name": "quantity 1", "bits": 3},
        "cycles": 100,
        "quantities": (
            {"index": 0, "minimum_raw": -(2**27), "maximum_raw": 4, "headroom_bits": 4, "wrapped": True} | none,
            {"index": 1, "minimum_raw": None, "maximum_raw": 20_000 << 13, "headroom_bits": 3, "wrapped": False} | none,
        ),
    }


def test_any_port_that_declares_these_signals_is_read_by_the_words_of_its_contract() -> None:
    own = wire_contract()
    words = {"TelemetryIndex": {5: "none"}, "TelemetryHeadroom": {30: "unused"}}
    port = own.port(CtlStat.PORT)
    signals = tuple(dataclasses.replace(one, values=words.get(one.name, one.values)) for one in port.signals)
    trace = Trace(dataclasses.replace(own, ports=(dataclasses.replace(port, name="LAW_STAT", signals=signals),)))
    for index, headroom_bits in ((5, 12), (6, 30), (7, 31)):
        telegram = CtlStat(telemetry_index=index, telemetry_headroom_bits=headroom_bits, telemetry_extreme=1)
        trace.add("LAW_STAT", 0, telegram.encode())
    found = shown_telemetry(trace, Status("LAW_STAT", "OverflowFlags"))
    assert found is not None
    assert [(row["index"], row["headroom_bits"]) for row in found.quantities] == [(6, None), (7, 31)]
