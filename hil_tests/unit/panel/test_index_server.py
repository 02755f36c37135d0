"""``railhil panel DIR``: the index of a directory, and from it the pages of its runs."""

from __future__ import annotations

import asyncio
import json
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.cli import Railhil
from hil_tests.support.run_folders import record_two_runs, write_run
from railhil.index.find import has_runs_below
from railhil.panel.wire import SUBPROTOCOL

websockets = pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")

from railhil.panel.index_server import IndexServer  # noqa: E402


def _visit(root: Path, visit: Callable[[IndexServer], Any]) -> None:
    """A server while ``visit`` (a coroutine function) is at it."""

    async def all_of_it() -> None:
        panel = IndexServer(root, (), "right", 0)
        server = await panel.listen()
        try:
            await visit(panel)
        finally:
            panel.close()
            server.close()
            await server.wait_closed()

    asyncio.run(all_of_it())


async def _get(panel: IndexServer, path: str, host: str = "") -> tuple[int, str, str, str]:
    """Status, final address, policy and text."""

    def fetch() -> tuple[int, str, str, str]:
        request = urllib.request.Request(f"http://127.0.0.1:{panel.port}{path}")
        if host:
            request.add_header("Host", host)
        try:
            with urllib.request.urlopen(request, timeout=10) as found:
                policy = found.headers["Content-Security-Policy"]
                return found.status, found.url, policy, found.read().decode()
        except urllib.error.HTTPError as error:
            return error.code, path, "", error.read().decode()

    return await asyncio.to_thread(fetch)


def test_a_directory_with_runs_below_is_an_index_and_a_run_is_none(tmp_path: Path) -> None:
    assert not has_runs_below(tmp_path)
    write_run(tmp_path / "a")
    assert has_runs_below(tmp_path)
    assert not has_runs_below(tmp_path / "a")
    assert not has_runs_below(tmp_path / "nowhere")
    (tmp_path / "sequence.json").write_text("{}")
    assert not has_runs_below(tmp_path)


def test_only_folders_of_the_index_are_served(tmp_path: Path) -> None:
    write_run(tmp_path / "runs" / "a")
    (tmp_path / "runs" / "a" / "report.html").write_text("report of a")
    write_run(tmp_path / "secret")
    (tmp_path / "secret" / "report.html").write_text("secret")

    async def visit(panel: IndexServer) -> None:
        status, _, policy, text = await _get(panel, "/")
        assert status == 200
        assert "Runs below runs" in text
        assert "default-src 'none'" in policy
        assert (await _get(panel, "/report?run=a"))[3] == "report of a"
        for path in (
            "/signals?run=../secret", "/signals", "/report?run=../secret", "/report?run=%2e%2e/secret", "/report?run=",
            "/report", "/panel/open?run=../secret",
            "/panel/open", "/panel/", "/panel/x/", "/panel/x/ws", "/a/report.html", "/.railhil-index/runs.parquet",
        ):  # fmt: skip
            assert (await _get(panel, path))[0] == 404, path
        assert (await _get(panel, "/", "evil.example"))[0] == 404

    _visit(tmp_path / "runs", visit)


def test_a_run_that_cannot_be_shown_is_told_in_a_line(tmp_path: Path) -> None:
    write_run(tmp_path / "a")

    async def visit(panel: IndexServer) -> None:
        status, _, _, text = await _get(panel, "/panel/open?run=a")
        assert status == 409
        assert "frames.log" in text
        assert text.count("\n") == 1

    _visit(tmp_path, visit)


@pytest.mark.slow
def test_the_page_of_two_runs_has_an_address_with_their_values(here: Railhil, tmp_path: Path) -> None:
    record_two_runs(here, tmp_path)

    async def visit(panel: IndexServer) -> None:
        status, address, _, text = await _get(panel, "/panel/open?run=0&run=1")
        assert status == 200
        assert "panel.js" in text
        place = address.partition(f":{panel.port}")[2]
        assert (await _get(panel, f"{place}panel.js"))[0] == 200
        origin = f"http://127.0.0.1:{panel.port}"
        socket = websockets.connect(f"ws://127.0.0.1:{panel.port}{place}ws", origin=origin, subprotocols=[SUBPROTOCOL])
        async with socket as connection:
            header = json.loads(await connection.recv())["header"]
        assert header["kind"] == "recorded"
        assert len(header["runs"]) == 2
        foreign = websockets.connect(
            f"ws://127.0.0.1:{panel.port}{place}ws", origin="http://evil.example", subprotocols=[SUBPROTOCOL]
        )
        with pytest.raises(websockets.exceptions.InvalidStatus):
            async with foreign:
                pytest.fail("a foreign page was let in")
        assert (await _get(panel, "/panel/open?run=0&run=1"))[1] == address
        signals = json.loads((await _get(panel, "/signals?run=0"))[3])
        assert signals["columns"]["true_speed_mps"][:3] == ["true speed", "km/h", 3.6]

    _visit(tmp_path / "runs", visit)
