"""Hubs in separate processes, and gateways between them."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from hil_tests.support.cli import command, wait_for
from railhil.bus.frame import Frame
from railhil.bus.hub.client import HubBus
from railhil.bus.hub.gateway import BusPort
from railhil.bus.hub.portspec import parse_port
from railhil.bus.packing import unpack_frames

#: Long enough for any machine: reaching it is a failure, not a measurement.
PATIENCE_S = 20.0


class HubProcess:
    """A hub in a separate process; its standard error goes to a file."""

    def __init__(self, channel: str, *options: str) -> None:
        self._stderr_file = tempfile.TemporaryFile("w+")  # noqa: SIM115 - closed with the process
        command = [sys.executable, "-m", "railhil.bus.hub", "-c", channel, *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self._stderr_file, text=True)
        assert self.process.stdout is not None
        self.ready_line = self.process.stdout.readline()
        #: The channel to connect to (TCP port 0 is replaced by the real one).
        self.channel = channel
        if self.ready_line:
            self.channel = self.ready_line.removeprefix("railhil hub ready at ").split(": ")[0]

    def bus(self, **options: object) -> HubBus:
        """A new client."""
        return HubBus(self.channel, **options)  # type: ignore[arg-type]

    def end(self, number: int | None = signal.SIGTERM) -> int:
        """Send a signal (None: just wait) and return the exit code."""
        if number is not None and self.process.poll() is None:
            self.process.send_signal(number)
        return self.process.wait(PATIENCE_S)

    def stderr(self) -> str:
        """The hub's messages so far."""
        self._stderr_file.seek(0)
        return self._stderr_file.read()

    def wait_for_stderr(self, words: str) -> None:
        """Wait until the hub has printed these words."""
        deadline_s = time.monotonic() + PATIENCE_S
        while words not in self.stderr():
            assert time.monotonic() < deadline_s, f"no {words!r} in {self.stderr()!r}"
            time.sleep(0.01)

    def close(self) -> None:
        """End the process and the files."""
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(PATIENCE_S)
        assert self.process.stdout is not None
        self.process.stdout.close()
        self._stderr_file.close()


@contextlib.contextmanager
def socket_folder() -> Iterator[Path]:
    """A folder with a short path: pytest's own can be too long for a socket."""
    with tempfile.TemporaryDirectory(prefix="rh-") as folder:
        yield Path(folder)


@contextlib.contextmanager
def running_hub(*options: str, channel: str | None = None) -> Iterator[HubProcess]:
    """A hub that accepts clients."""
    with socket_folder() as folder:
        hub = HubProcess(channel or str(folder / "hub.sock"), *options)
        try:
            assert hub.ready_line, hub.stderr()
            yield hub
        finally:
            hub.close()


@contextlib.contextmanager
def node(role: str, scenario: str | Path, channel: str, *options: str) -> Iterator[subprocess.Popen[str]]:
    """A node in its own process; killed when the test is finished with it."""
    words = command("node", role, scenario, "-i", "railhil", "-c", channel, *options)
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate(timeout=PATIENCE_S)


PLAIN = Frame(0x123, b"plain")


@contextlib.contextmanager
def gateway(*ports: str, options: tuple[str, ...] = ()) -> Iterator[HubProcess]:
    """A hub with these buses as ports."""
    with running_hub(*(word for port in ports for word in ("--port", port)), *options) as hub:
        yield hub


@contextlib.contextmanager
def two_hubs_and_a_gateway(
    *, options: tuple[str, ...] = (), settings: str = ""
) -> Iterator[tuple[HubProcess, HubProcess, HubProcess]]:
    """Hub A, hub B, and the gateway between them."""
    with (
        running_hub() as a,
        running_hub() as b,
        gateway(f"railhil:{a.channel}{settings}", f"railhil:{b.channel}{settings}", options=options) as between,
    ):
        yield a, b, between


def opened_port(text: str, *, lossless: bool = False) -> tuple[BusPort, list[str]]:
    """A port in this process, and the lines that it reports."""
    lines: list[str] = []
    return BusPort(parse_port(text), lossless=lossless, report=lines.append), lines


def taken(port: BusPort, enough: Callable[[list[Frame]], bool]) -> list[Frame]:
    """Frames that the port passes to the switch, until there are enough."""
    frames: list[Frame] = []

    def look() -> bool:
        frames.extend(frame for packet in port.receive() for frame in unpack_frames(packet))
        return enough(frames)

    wait_for(look, PATIENCE_S)
    return frames
