"""The page's server: who may connect, who may order, and what a slow page costs."""

from __future__ import annotations

import asyncio
import json
import socket
import struct
import time
import urllib.error
import urllib.request
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from railhil.panel.wire import APPEND, SUBPROTOCOL, encode_batch

websockets = pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")

from hil_tests.support.panel_server import TOKEN, ScriptedSource, asked, page, served  # noqa: E402
from railhil.panel import server as server_module  # noqa: E402
from railhil.panel.server import PanelServer  # noqa: E402
from railhil.panel.tcp_to_unix import open_gateway  # noqa: E402


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "http://127.0.0.1", "null", "http://127.0.0.1:1", "https://localhost"]
)
def test_a_foreign_page_is_refused(origin):
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        with pytest.raises(websockets.InvalidStatus) as refused:
            async with page(panel, origin):
                pass
        assert refused.value.response.status_code == 403

    served(visit)


def test_a_program_without_an_origin_is_refused():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        with pytest.raises(websockets.InvalidStatus):
            async with websockets.connect(f"ws://127.0.0.1:{panel.port}/ws", subprotocols=[SUBPROTOCOL]):
                pass

    served(visit)


def test_commands_need_the_token():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        async with page(panel) as connection:
            for token in ("wrong", None, 7, "rightx", ""):
                assert "wrong token" in (await asked(connection, {"do": "stop", "token": token}))["refused"]
            assert "wrong token" in (await asked(connection, {"do": "stop"}))["refused"]
            assert (await asked(connection, "[]"))["refused"] == "not an object"
            assert (await asked(connection, "{"))["refused"] == "not JSON"
            assert source.commands == []
            assert await asked(connection, {"do": "stop", "token": TOKEN}) == {"done": "stop"}
            assert (await asked(connection, {"do": "fail", "token": TOKEN}))["refused"] == "it cannot be"

    assert [command["do"] for command in served(visit).commands] == ["stop", "fail"]


def test_the_kinds_of_faults_are_told_to_a_page_that_asks():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        async with page(panel) as connection:
            await connection.recv()
            await connection.recv()
            await connection.send(json.dumps({"kinds": True}))
            (kind,) = json.loads(await connection.recv())["kinds"]
            assert (kind["name"], kind["parameters"][0]["range"]) == ("TRN_SPEED loss", "0% to 100%")

    served(visit)


def test_a_page_without_commands_takes_none():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        async with page(panel) as connection:
            assert json.loads(await connection.recv())["header"]["commands"] is False
            assert "no commands" in (await asked(connection, {"do": "stop", "token": ""}))["refused"]

    assert served(visit, token="").commands == []


def test_frames_are_watched_while_a_page_wants_them():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        async with page(panel) as one, page(panel) as other:
            await one.send(json.dumps({"watch": 0x118}))
            await other.send(json.dumps({"watch": 0x110}))
            await asked(one, "{")
            await asked(other, "{")
            assert source.watched == {0x118, 0x110}
        while source.watched:
            await asyncio.sleep(0.01)

    served(visit)


def test_the_list_of_frames_goes_to_pages_that_show_it():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        async with page(panel) as shows, page(panel) as other:
            await shows.send(json.dumps({"frames": True}))
            await asked(shows, "{")
            await asked(other, "{")
            looks = iter([False, False, True])
            await panel.run(lambda: next(looks))
            assert [json.loads(await shows.recv()), json.loads(await shows.recv())] == [{"frames": 1}, {"frames": 2}]
            assert (await asked(other, "{")) == {"refused": "not JSON"}
            await shows.send(json.dumps({"frames": False}))
            await asked(shows, "{")
            looks = iter([False, True])
            await panel.run(lambda: next(looks))
        assert source.lists == 2

    served(visit)


def test_the_page_may_load_nothing_from_elsewhere():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        def fetched(path: str) -> Any:
            return urllib.request.urlopen(panel.address + path, timeout=10)

        for path in (
            "",
            "panel.js",
            "panel.css",
            "store.js",
            "curves.js",
            "gauges.js",
            "view.js",
            "charts.js",
            "uPlot.iife.min.js",
            "gridstack-all.js",
            "gridstack.min.css",
        ):
            answer = await asyncio.to_thread(fetched, path)
            assert answer.headers["Content-Security-Policy"].startswith("default-src 'self';")
            assert answer.read()
        for path in ("../server.py", "static/panel.js", "x"):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                await asyncio.to_thread(fetched, path)

    served(visit)


def test_the_report_of_a_branch_asks_for_nothing_and_is_given_under_no_foreign_name():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        def fetched(number: str, host: str = "") -> Any:
            request = urllib.request.Request(f"{panel.address}branch/{number}")
            if host:
                request.add_header("Host", host)
            return urllib.request.urlopen(request, timeout=10)

        def refused(*asked: str) -> None:
            with pytest.raises(urllib.error.HTTPError, match="404"):
                fetched(*asked)

        await asyncio.to_thread(refused, "0")
        source.branches = SimpleNamespace(report=lambda number: b"<p>report" if number == "0" else None)
        answer = await asyncio.to_thread(fetched, "0")
        assert answer.read() == b"<p>report"
        assert answer.headers["Content-Security-Policy"].startswith("default-src 'none';")
        assert "sandbox allow-scripts;" in answer.headers["Content-Security-Policy"]
        for asked_for in (("1",), ("",), ("0/0",), ("0", f"evil.example:{panel.port}"), ("0", "127.0.0.1")):
            await asyncio.to_thread(refused, *asked_for)

    served(visit)


def test_the_report_of_the_run_that_has_ended_is_given_as_soon_as_there_is_one(tmp_path):
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        def fetched() -> Any:
            return urllib.request.urlopen(f"{panel.address}report", timeout=10)

        def refused() -> None:
            with pytest.raises(urllib.error.HTTPError, match="404"):
                fetched()

        await asyncio.to_thread(refused)
        source.report = tmp_path / "report.html"
        await asyncio.to_thread(refused)
        source.report.write_bytes(b"<p>report")
        answer = await asyncio.to_thread(fetched)
        assert answer.read() == b"<p>report"
        assert "sandbox allow-scripts;" in answer.headers["Content-Security-Policy"]

    served(visit)


def test_a_page_is_a_desk_once_it_has_shown_the_token():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        async with page(panel) as watching, page(panel) as desk:
            await asked(watching, {"do": "hello", "token": "wrong"})
            await desk.send(json.dumps({"do": "hello", "token": TOKEN}))
            while not panel.count_desks():
                await asyncio.sleep(0.01)
            assert panel.count_desks() == 1
        while panel.count_desks():
            await asyncio.sleep(0.01)

    assert served(visit).commands == []


def test_only_the_usual_port_is_replaced_by_a_free_one(monkeypatch):
    async def all_of_it() -> None:
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            with pytest.raises(OSError, match="in use"):
                await PanelServer(ScriptedSource(), TOKEN, port).listen()
            monkeypatch.setattr(server_module, "PANEL_PORT", port)
            panel = PanelServer(ScriptedSource(), TOKEN, port)
            server = await panel.listen()
            assert panel.port not in (0, port)
            server.close()
            await server.wait_closed()

    asyncio.run(all_of_it())


def test_a_batch_is_times_then_columns():
    rows = np.array([[0.5, 1.0, np.nan], [1.5, 3.0, 4.0]])
    data = encode_batch(APPEND, 3, rows)
    assert struct.unpack("<4I", data[:16]) == (APPEND, 3, 2, 2)
    assert np.frombuffer(data, "<f8", 2, 16).tolist() == [0.5, 1.5]
    np.testing.assert_array_equal(np.frombuffer(data, "<f4", 4, 32), np.array([1, 3, np.nan, 4], dtype=np.float32))


def test_a_door_leads_to_a_panel_at_a_socket(tmp_path):
    async def all_of_it() -> None:
        source, socket = ScriptedSource(), str(tmp_path / "panel.sock")
        door = await open_gateway(socket, "127.0.0.1", 0)
        port = door.sockets[0].getsockname()[1]
        panel = PanelServer(source, TOKEN, port, socket)
        with pytest.raises((websockets.InvalidMessage, websockets.InvalidHandshake, OSError, EOFError)):
            # The panel has not begun.
            async with page(panel):
                pass
        server = await panel.listen()
        async with page(panel) as connection:
            assert await asked(connection, {"do": "stop", "token": TOKEN}) == {"done": "stop"}
        server.close()
        await server.wait_closed()
        door.close()

    asyncio.run(all_of_it())


@pytest.mark.parametrize(("alone", "looks"), [(True, True), (False, False)])
def test_a_record_is_read_only_while_there_is_a_page(monkeypatch, alone, looks):
    looked: list[int] = []
    monkeypatch.setattr(ScriptedSource, "look", lambda source: looked.append(1) or [])

    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        panel.looks_alone = alone
        for _ in range(2):
            await panel.run(iter((False, False, True)).__next__)
        assert bool(looked) is looks
        async with page(panel) as connection:
            await connection.recv()
            while not panel._pages:
                await asyncio.sleep(0.01)
            await panel.run(lambda: bool(looked))
        assert looked

    served(visit)


def test_what_is_nested_too_deeply_is_refused_in_one_line_and_its_sender_too(caplog):
    """Without a token too; nothing is raised where the server runs, and other pages stay."""

    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        async with page(panel) as other, page(panel) as connection:
            await connection.send("[" * 54000)
            await asyncio.wait_for(connection.wait_closed(), 20)
            assert (connection.close_code, connection.close_reason) == (1008, "nested too deeply")
            assert "wrong token" in (await asked(other, '{"do": "stop", "token": "\\ud800"}'))["refused"]

    assert served(visit).commands == []
    assert not [record for record in caplog.records if record.exc_info]


def test_a_page_that_did_not_keep_up_gets_everything_once_it_has_caught_up(monkeypatch):
    """Rows of another run behind those of the last one would be values that no record has."""
    monkeypatch.setattr(server_module, "_BACKLOG_MAX_BYTES", 1000)
    past: list[str | bytes] = ["{}"]
    news: list[str | bytes] = []

    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        source.read_past = lambda: list(past)  # type: ignore[method-assign]
        source.look = lambda: [news.pop()] if news else []  # type: ignore[method-assign]
        async with page(panel) as connection:
            assert "header" in json.loads(await connection.recv())
            assert await connection.recv() == "{}"
            (shown,) = panel._pages.values()
            monkeypatch.setattr(shown.connection.transport, "get_write_buffer_size", lambda: 10_000)
            news.append(encode_batch(APPEND, 0, np.zeros((1, 2))))
            panel.tell_news()
            monkeypatch.undo()
            # The rows that were left out are in the past now; no further one comes before it.
            past[0] = "past"
            news.append("news")
            panel.tell_news()
            assert "header" in json.loads(await connection.recv())
            assert await connection.recv() == "past"
            news.append("later")
            panel.tell_news()
            assert await connection.recv() == "later"

    served(visit)


def test_no_news_comes_between_the_past_and_the_first_batch_of_a_page():
    """A page that came while much was sent missed what was heard meanwhile, without a gap in its curves."""
    count = 50

    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        heard: list[str | bytes] = []

        def look() -> list[str | bytes]:
            heard.append(f"{len(heard)} {'x' * 100_000}")
            return heard[-1:]

        source.read_past = lambda: list(heard)  # type: ignore[method-assign]
        source.look = look  # type: ignore[method-assign]
        for _ in range(count):
            look()
        async with page(panel) as connection:
            for _ in range(5):
                panel.tell_news()
                await asyncio.sleep(0.01)
            await connection.recv()
            found = [
                int(str(await asyncio.wait_for(connection.recv(), 20)).partition(" ")[0]) for _ in range(len(heard))
            ]
            assert found == [*range(len(heard))]

    served(visit)


def test_a_page_with_the_token_of_another_command_is_told_that_it_only_watches():
    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        async with page(panel) as connection:
            assert (await asked(connection, {"do": "hello", "token": "of the run before"}))["stale"]
            assert "stale" not in await asked(connection, {"do": "fail", "token": TOKEN})

    served(visit)


def test_a_page_is_served_between_two_readings_that_take_longer_than_their_period(monkeypatch):
    """As on a busy machine: without a pause each step of the page's opening would wait for a reading."""
    monkeypatch.setattr(server_module, "RATE_HZ", 20.0)
    looks: list[float] = []

    def look() -> list[str | bytes]:
        time.sleep(0.1)
        looks.append(time.monotonic())
        return []

    async def visit(panel: PanelServer, source: ScriptedSource) -> None:
        source.look = look  # type: ignore[method-assign]
        is_over: list[bool] = []
        reading = asyncio.create_task(panel.run(lambda: bool(is_over)))
        await asyncio.sleep(0.0)
        before = len(looks)
        async with page(panel) as connection:
            await connection.recv()
            assert len(looks) - before <= 2
        is_over.append(True)
        await reading

    served(visit)
