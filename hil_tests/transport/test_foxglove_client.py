"""The bridge with the client library of Lichtblick (``@foxglove/ws-protocol``) under node."""

from __future__ import annotations

import asyncio
import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.panel import Recorded, ScriptedLink
from hil_tests.support.paths import TEST_DATA

websockets = pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")

from railhil.cli.run_identity import RunIdentity  # noqa: E402
from railhil.panel.foxglove import SUBPROTOCOLS, FoxgloveBridge  # noqa: E402
from railhil.panel.live import LiveRun  # noqa: E402
from railhil.panel.receiver import Receiver  # noqa: E402

pytestmark = [pytest.mark.needs_node, pytest.mark.slow]


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The client with its libraries, from npm's registry."""
    folder = tmp_path_factory.mktemp("node")
    for path in (TEST_DATA / "foxglove").iterdir():
        shutil.copy(path, folder)
    command = ["npm", "install", "--ignore-scripts", "--no-audit", "--no-fund"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=100, check=False)
    if done.returncode:
        pytest.skip(f"MISSING CAPABILITY npm's registry: {done.stderr[-200:]}")
    return folder / "client.cjs"


@pytest.mark.long_after(1)
@pytest.mark.parametrize("subprotocol", SUBPROTOCOLS)
def test_lichtblicks_client_reads_values_clock_and_service(client, tmp_path, subprotocol):
    run = Recorded(tmp_path)
    frames = list(run.frames)

    class Slow(ScriptedLink):
        """Hands over 60 frames at each look."""

        def receive(self, timeout_s: float) -> list[Any]:
            self.begun = not getattr(self, "begun", False)
            taken = frames[:60] if self.begun else []
            del frames[: len(taken)]
            return taken

    async def visited() -> dict[str, Any]:
        live = LiveRun(RunIdentity(run.scenario, "ipfc"), Receiver({}, lambda config, name: Slow()))
        live.execute = lambda command: ""  # type: ignore[method-assign]
        bridge = FoxgloveBridge(live, "right", 0)
        server = await bridge.listen()
        command = ["node", str(client), f"ws://127.0.0.1:{bridge.port}", subprotocol, "right", "800"]
        node = await asyncio.create_subprocess_exec(*command, stdout=asyncio.subprocess.PIPE)
        assert node.stdout is not None
        reading = asyncio.ensure_future(node.stdout.read())
        while not reading.done():
            if bridge._viewers:
                live.look()
                bridge.tell()
            await asyncio.sleep(0.02)
        await node.wait()
        server.close()
        await server.wait_closed()
        return dict(json.loads(reading.result()))

    found = asyncio.run(visited())
    assert found["subprotocol"] == subprotocol
    assert found["channels"] == 1 + len(run.contract.ports)
    assert found["answers"] == [
        {"callId": 0, "done": False, "why": "wrong token"},
        {"callId": 1, "done": True, "why": ""},
    ]
    signals = found["signals"]
    row = run.rows[abs(run.rows[:, 0] - signals["at"]).argmin()]
    assert signals["true_speed_mps"] == pytest.approx(row[1 + run.layout.speed] / 3.6, abs=1e-9)
    assert found["full"]["speed_chk"] == 1
    assert found["time"] >= found["full"]["at"] > 0.0
