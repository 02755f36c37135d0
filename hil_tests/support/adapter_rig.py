"""A hub with the emulated adapter on it, as processes: for tests of a controller behind an adapter."""

from __future__ import annotations

import contextlib
import json
import select
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

#: Time for the processes to start, at a tenth of the usual speed.
_START_S = 60.0
_END_S = 10.0


class Rig:
    """Context manager that leaves no process behind.

    :param folder: with a path short enough for a Unix socket.
    :param options: the adapter's command-line options.
    """

    def __init__(self, folder: Path, *options: str) -> None:
        self._options = options
        self._channel = folder / "hub.sock"
        self._processes: list[subprocess.Popen[bytes]] = []
        self._unread_answers = 0
        #: The adapter's serial port.
        self.port = folder / "ttyEMU"

    def __enter__(self) -> Rig:
        try:
            self._start("railhil.bus.hub", "-c", str(self._channel))
            self._adapter = self._start(
                "railhil.machines.adapter", "--link", str(self.port), *self._options, "-i", "railhil", "-c",
                str(self._channel), "--bus-kwargs", f"connect_timeout={_START_S:g}",
            )  # fmt: skip
            self.status()
        except BaseException:
            self.__exit__()
            raise
        return self

    def _start(self, module: str, *arguments: str) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(
            [sys.executable, "-m", module, *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            # select does not see data that have already been read into a buffer.
            bufsize=0,
        )
        self._processes.append(process)
        return process

    def __exit__(self, *_: object) -> None:
        for process in reversed(self._processes):
            process.terminate()
            try:
                process.wait(_END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    with contextlib.suppress(BrokenPipeError):
                        pipe.close()

    @property
    def hub(self) -> dict[str, Any]:
        """Arguments of ``can.Bus`` for the hub."""
        return {"interface": "railhil", "channel": str(self._channel), "connect_timeout": _START_S}

    @property
    def adapter(self) -> dict[str, Any]:
        """Arguments of ``can.Bus`` for the adapter's port."""
        return {"interface": "slcan", "channel": str(self.port), "bitrate": 500_000, "sleep_after_open": 0}

    def controller_command(self, scenario: Path, *options: str) -> list[str]:
        """The controller behind the adapter, as started by a user."""
        return [
            sys.executable, "-m", "railhil.cli", "node", "controller", str(scenario), *options, "-i", "slcan", "-c",
            str(self.port), "-b", "500000", "--bus-kwargs", "sleep_after_open=0",
        ]  # fmt: skip

    def order(self, command: str) -> None:
        """Send a command to the adapter without waiting for its answer."""
        _pipe(self._adapter.stdin).write(f"{command}\n".encode())
        self._unread_answers += 1

    def status(self) -> dict[str, Any]:
        """State and counters of the adapter now."""
        self.order("status")
        pipe = _pipe(self._adapter.stdout)
        deadline_s = time.monotonic() + _START_S
        line = b""
        while self._unread_answers:
            if not select.select((pipe,), (), (), max(0.0, deadline_s - time.monotonic()))[0]:
                raise TimeoutError("the adapter does not answer")
            line = pipe.readline()
            if not line:
                raise ChildProcessError(f"the adapter has ended, exit code {self._adapter.wait(_END_S)}")
            self._unread_answers -= 1
        found: dict[str, Any] = json.loads(line)
        return found


def _pipe(stream: IO[bytes] | None) -> IO[bytes]:
    assert stream is not None
    return stream


class Timetable:
    """``on_progress`` callback of a run that sends commands to the adapter at instants of simulation time (s).

    :ivar given_s: instants at which the commands were actually sent.
    """

    def __init__(self, rig: Rig, orders: Mapping[float, str]) -> None:
        self._rig = rig
        self._orders = sorted(orders.items())
        self.given_s: list[float] = []

    def __call__(self, sim_time_s: float) -> None:
        """Send the commands that are due."""
        while self._orders and sim_time_s >= self._orders[0][0]:
            self._rig.order(self._orders.pop(0)[1])
            self.given_s.append(sim_time_s)
