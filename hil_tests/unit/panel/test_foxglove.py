"""The bridge for Lichtblick and PlotJuggler, with a client that knows only the protocol's description."""

from __future__ import annotations

import asyncio
import json
import struct
from itertools import pairwise
from typing import Any

import pytest

from hil_tests.support.panel import Recorded, ScriptedLink

websockets = pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")

from railhil.cli.run_identity import RunIdentity  # noqa: E402
from railhil.panel.foxglove import ROWS_A_LOOK, SUBPROTOCOLS, FoxgloveBridge  # noqa: E402
from railhil.panel.live import LiveRun  # noqa: E402
from railhil.panel.receiver import Receiver  # noqa: E402
from railhil.panel.server import RATE_HZ  # noqa: E402

TOKEN = "right"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return Recorded(tmp_path_factory.mktemp("run"))


def string(text: str) -> bytes:
    body = text.encode() + b"\0"
    return struct.pack("<I", len(body)) + body


def order(call: int, token: str, command: str) -> bytes:
    """A call of the service as a client sends it."""
    first = string(token)
    payload = b"\0\1\0\0" + first + bytes(-len(first) % 4) + string(command)
    return struct.pack("<BIII", 2, 1, call, 3) + b"cdr" + payload


async def visited(run: Recorded, subprotocol: str, sent: list[str | bytes], looks: int) -> dict[str, list[Any]]:
    """What a client is told that sends all this and then sees so many looks of 200 frames each."""
    parts = [part for look in range(looks) for part in (run.frames[200 * look : 200 * look + 200], [])]
    live = LiveRun(RunIdentity(run.scenario, "ipfc"), Receiver({}, lambda config, name: ScriptedLink(*parts)))
    live.execute = lambda command: "" if command["do"] == "stop" else "not that"  # type: ignore[method-assign]
    bridge = FoxgloveBridge(live, TOKEN, 0)
    server = await bridge.listen()
    told: dict[str, list[Any]] = {"json": [], "binary": []}
    address = f"ws://127.0.0.1:{bridge.port}"
    async with websockets.connect(address, subprotocols=[subprotocol], origin="http://localhost:8080") as client:
        for message in sent:
            await client.send(message)
        # A request that is answered: everything before it has been taken.
        await client.send("{")
        while True:
            message = await client.recv()
            if isinstance(message, bytes):
                told["binary"].append(message)
            else:
                told["json"].append(json.loads(message))
                if told["json"][-1].get("message") == "not understood":
                    break
        for _ in range(looks):
            live.look()
            bridge.tell()
        while client.state.name == "OPEN":
            try:
                told["binary"].append(await asyncio.wait_for(client.recv(), 0.2))
            except TimeoutError:
                break
    server.close()
    await server.wait_closed()
    return told


@pytest.mark.parametrize("subprotocol", SUBPROTOCOLS)
def test_a_subscriber_gets_the_columns_in_their_units(run, subprotocol):
    wanted = json.dumps({"op": "subscribe", "subscriptions": [{"id": 5, "channelId": 1}]})
    told = asyncio.run(visited(run, subprotocol, [wanted], 6))
    info, advertised = told["json"][0], told["json"][1]["channels"]
    assert info["op"] == "serverInfo"
    assert "time" in info["capabilities"]
    fields = advertised[0]["schema"].split()[1::2]
    assert fields[run.layout.speed] == "true_speed_mps"
    messages = [message for message in told["binary"] if message[0] == 1]
    assert ROWS_A_LOOK * RATE_HZ <= 60.0
    assert 2 <= len(messages) <= 6 * ROWS_A_LOOK
    for message in messages:
        _, subscription, time_ns = struct.unpack_from("<BIQ", message)
        assert subscription == 5
        assert message[13:17] == b"\0\1\0\0"
        values = struct.unpack(f"<{len(fields)}d", message[17:])
        row = run.rows[abs(run.rows[:, 0] - time_ns / 1e9).argmin()]
        assert values[run.layout.speed] == pytest.approx(row[1 + run.layout.speed] / 3.6, abs=1e-9)
    clocks = [struct.unpack("<BQ", message)[1] for message in told["binary"] if message[0] == 2]
    assert clocks == sorted(clocks)
    assert clocks[-1] > 100_000_000


def test_a_full_topic_has_every_telegram_once(run):
    number = 100 + [port.name for port in run.contract.ports].index("TRN_SPEED")
    wanted = json.dumps({"op": "subscribe", "subscriptions": [{"id": 9, "channelId": number}]})
    told = asyncio.run(visited(run, SUBPROTOCOLS[0], [wanted], 6))
    times_ns = [struct.unpack_from("<BIQ", message)[2] for message in told["binary"] if message[0] == 1]
    assert len(times_ns) > 100
    assert [after - before for before, after in pairwise(times_ns)] == [10_000_000] * (len(times_ns) - 1)


def test_orders_need_the_token(run):
    calls = [order(1, "wrong", "{}"), order(2, TOKEN, '{"do": "stop"}'), order(3, TOKEN, '{"do": "x"}'), b"\2abc"]
    told = asyncio.run(visited(run, SUBPROTOCOLS[0], list(calls), 0))
    answers = [message for message in told["binary"] if message[0] == 3]
    assert [struct.unpack_from("<BIII", message)[2] for message in answers] == [1, 2, 3]
    bodies = [message[16:] for message in answers]
    assert bodies[0].endswith(b"wrong token\0")
    assert [body[4] for body in bodies] == [0, 1, 0]
    assert bodies[2].endswith(b"not that\0")
    assert any("service call" in message.get("message", "") for message in told["json"])


async def _closed(run: Recorded, message: str | bytes) -> tuple[int, str]:
    """Code and reason with which a viewer is sent away."""
    live = LiveRun(RunIdentity(run.scenario), Receiver({}, lambda config, name: ScriptedLink()))
    bridge = FoxgloveBridge(live, TOKEN, 0)
    server = await bridge.listen()
    async with websockets.connect(f"ws://127.0.0.1:{bridge.port}", subprotocols=SUBPROTOCOLS) as client:
        await client.send(message)
        await asyncio.wait_for(client.wait_closed(), 20)
    server.close()
    await server.wait_closed()
    return client.close_code, client.close_reason


@pytest.mark.parametrize("message", ["[" * 54000, order(1, TOKEN, "[" * 54000)], ids=["text", "order"])
def test_what_is_nested_too_deeply_is_refused_in_one_line_and_its_sender_too(run, message, caplog):
    assert asyncio.run(_closed(run, message)) == (1008, "nested too deeply")
    assert not [record for record in caplog.records if record.exc_info]


@pytest.mark.parametrize("number", ["1e999", "4294967296", "-1", '"5"', "null"])
def test_a_number_that_no_viewer_has_ends_nothing(run, number, caplog):
    wanted = f'{{"op": "subscribe", "subscriptions": [{{"id": {number}, "channelId": 1}}]}}'
    told = asyncio.run(visited(run, SUBPROTOCOLS[0], [wanted], 3))
    assert [one["message"] for one in told["json"] if one["op"] == "status"] == ["not understood"]
    assert not [record for record in caplog.records if record.exc_info]


@pytest.mark.parametrize(
    ("origin", "is_taken"),
    [
        (None, True),
        ("http://localhost:8080", True),
        ("http://[::1]:8080", True),
        ("https://app.foxglove.dev", True),
        ("foxglove://desktop", True),
        ("https://viewer.example", False),
        ("http://localhost.example", False),
        ("https://app.foxglove.dev.example", False),
        ("null", False),
    ],
)
def test_the_page_of_anybody_else_is_refused(run, origin, is_taken):
    async def visit() -> str:
        live = LiveRun(RunIdentity(run.scenario), Receiver({}, lambda config, name: ScriptedLink()))
        bridge = FoxgloveBridge(live, "", 0)
        server = await bridge.listen()
        try:
            address = f"ws://127.0.0.1:{bridge.port}"
            async with websockets.connect(address, subprotocols=SUBPROTOCOLS, origin=origin) as client:
                return str(json.loads(await client.recv())["op"])
        except websockets.InvalidStatus as refused:
            return refused.response.body.decode()
        finally:
            server.close()
            await server.wait_closed()

    wanted = "serverInfo" if is_taken else f"origin: found {origin!r}, allowed a viewer of this machine"
    assert asyncio.run(visit()).startswith(wanted)
