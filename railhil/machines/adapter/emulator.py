"""The adapter as a process: a serial port on one side, a bus on the other, and commands that cause faults.

The serial port (a pseudo-terminal) appears under PATH; the bus behind it is any python-can interface. Commands are read
from standard input, one per line (:class:`Emulator` lists them)::

    railhil bus hub -c hub.sock &
    python -m railhil.machines.adapter --link ttyEMU -i railhil -c hub.sock
    railhil node controller -i slcan -c ttyEMU -b 500000 --bus-kwargs sleep_after_open=0
"""

from __future__ import annotations

import json
import os
import select
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from railhil.bus.can_settings import add_bus_arguments, named_bus
from railhil.bus.frame import Frame
from railhil.bus.link import Link, open_link
from railhil.bus.select import choose_bus
from railhil.common.command_line import OneLineParser, parse, whole_number
from railhil.machines.adapter.device import BIT_RATES, Build, Device
from railhil.machines.adapter.terminal import SerialLine, Terminal

#: Maximum interval at which the loop checks signals and the bus.
_LOOK_S = 0.2
#: Packets taken from the bus before the host is served again.
_PACKETS_PER_TURN = 64
_COMMAND_BYTES = 4096


class CommandError(ValueError):
    """An unknown command; the text says which words were found and which are allowed."""


class Emulator:
    """Moves bytes and frames until the bus ends or ``quit`` is commanded.

    ============== =====================================================================================
    command        what happens; with a number of seconds it is undone by itself after that time
    ============== =====================================================================================
    ``unplug [S]`` the port vanishes with the adapter's power: host reads end of file and gets EIO
    ``replug``     a new port under the same name; the adapter has forgotten bit rate and open channel
    ``busoff [S]`` nothing comes or goes on the bus, the transmit queue fills
    ``restart``    on the bus again
    ``stall [S]``  the adapter reads nothing from the host, so the host's buffers fill
    ``resume``     reads again
    ``garble N``   the next N bytes to the host are turned into other bytes
    ``status``     nothing
    ``quit``       the adapter is unplugged for good
    ============== =====================================================================================

    Each command is answered by one line: its state and counters as JSON.

    :param link: the bus.
    :param serial_rate_baud: baud rate of the serial line in both directions; 0: unlimited.
    :param commands_fd: descriptor with one command per line; its end of file does not end the adapter.
    :param say: called with each answer.
    """

    def __init__(
        self,
        terminal: Terminal,
        build: Build,
        link: Link,
        *,
        serial_rate_baud: int = 0,
        commands_fd: int | None = None,
        say: Callable[[str], object] = print,
    ) -> None:
        self._terminal = terminal
        self._build = build
        self._link = link
        self._from_host, self._to_host = SerialLine(serial_rate_baud), SerialLine(serial_rate_baud)
        self._commands_fd = commands_fd
        self._command = b""
        self._say = say
        self._device = Device(build)
        #: Counters of the devices before the last unplugging.
        self._counters: Counter[str] = Counter()
        self._is_stalled = False
        self._garble_bytes = 0
        #: Commands that are undone automatically, and when (monotonic ns).
        self._later: dict[str, int] = {}
        self._is_over = False

    def run(self) -> None:
        """Serve.

        :raises BusLost: the bus is gone.
        """
        self._terminal.plug_in()
        try:
            while not self._is_over:
                self._turn()
        finally:
            self._terminal.pull_out()

    # -- bytes and frames -------------------------------------------------------------------------------------------

    def _turn(self) -> None:
        """Wait until there is something to do, and process it once."""
        now_ns = time.monotonic_ns()
        plugged = self._terminal.is_plugged_in
        read = plugged and not self._is_stalled
        write = plugged and bool(self._device.to_host)
        wait_s = [_LOOK_S, *(max(0, due_ns - now_ns) / 1e9 for due_ns in self._later.values())]
        # Queried each time: the link may have reopened its interface.
        bus_fd = self._link.bus.fileno()
        readers: list[int] = [bus_fd]
        writers: list[int] = []
        for line, wanted, ends in ((self._from_host, read, readers), (self._to_host, write, writers)):
            if wanted and line.room_bytes(now_ns):
                ends.append(self._terminal.fileno())
            elif wanted:
                wait_s.append(line.wait_s(now_ns))
        if self._commands_fd is not None:
            readers.append(self._commands_fd)
        readable, writable, _ = select.select(readers, writers, [], min(wait_s))
        self._undo(time.monotonic_ns())
        if bus_fd in readable:
            self._take_from_bus()
        # The port may have been unplugged meanwhile.
        if self._terminal.is_plugged_in and self._terminal.fileno() in readable:
            self._take_from_host()
        if self._terminal.is_plugged_in and self._terminal.fileno() in writable:
            self._hand_to_host()
        if self._commands_fd in readable:
            self._take_commands()

    def _take_from_bus(self) -> None:
        for _ in range(_PACKETS_PER_TURN):
            frames = self._link.receive(0.0)
            if not frames:
                return
            if self._terminal.is_plugged_in:
                self._device.bus_sent(frames, time.monotonic_ns() // 1_000_000)

    def _take_from_host(self) -> None:
        now_ns = time.monotonic_ns()
        data = self._terminal.read(self._from_host.room_bytes(now_ns))
        self._from_host.moved(len(data), now_ns)
        frames: list[Frame] = []
        # Line by line: a frame leaves the queue before the next one is read.
        for line in data.splitlines(keepends=True):
            if self._device.host_wrote(line):
                self._terminal.forget_unread()
            frames += self._device.transmit()
        self._send(frames)

    def _send(self, frames: list[Frame]) -> None:
        if frames:
            self._link.send(frames)

    def _hand_to_host(self) -> None:
        now_ns = time.monotonic_ns()
        data = bytes(self._device.to_host[: self._to_host.room_bytes(now_ns)])
        garbled = bytes(octet ^ 0x5A for octet in data[: self._garble_bytes])
        taken = self._terminal.write(garbled + data[len(garbled) :])
        self._garble_bytes -= min(self._garble_bytes, taken)
        self._to_host.moved(taken, now_ns)
        del self._device.to_host[:taken]

    # -- commands ---------------------------------------------------------------------------------------------------

    def _take_commands(self) -> None:
        assert self._commands_fd is not None
        data = os.read(self._commands_fd, _COMMAND_BYTES)
        if not data:
            self._commands_fd = None
        *lines, self._command = (self._command + data).split(b"\n")
        for line in lines:
            words = line.decode(errors="replace").split()
            try:
                if words:
                    self.obey(words)
                    self._say(self.status())
            except CommandError as error:
                self._say(f"adapter: {error}")

    def obey(self, words: list[str]) -> None:
        """Execute one command.

        :raises CommandError: there is no such command, or not with these arguments.
        """
        name, arguments = words[0], words[1:]
        action, undo = self._actions().get(name, (None, ""))
        if action is None:
            raise CommandError(f"command: found {name}, allowed {', '.join(self._actions())}")
        takes = 1 if undo or name == "garble" else 0
        try:
            numbers = [float(word) for word in arguments]
        except ValueError:
            numbers = [-1.0]
        if len(numbers) > takes or not all(0 < number < 1e6 for number in numbers):
            raise CommandError(f"command {name}: found {' '.join(arguments)}, allowed at most {takes} number above 0")
        self._later = {later: due_ns for later, due_ns in self._later.items() if later != undo}
        action(*numbers)
        if undo and numbers:
            self._later[undo] = time.monotonic_ns() + int(numbers[0] * 1e9)

    def _actions(self) -> dict[str, tuple[Callable[..., object], str]]:
        """Each command: its action, and the command that undoes it."""
        return {
            "unplug": (lambda *_: self._unplug(), "replug"),
            "replug": (self._replug, ""),
            "busoff": (lambda *_: self._device.go_bus_off(), "restart"),
            "restart": (self._restart, ""),
            "stall": (lambda *_: self._stall(True), "resume"),
            "resume": (lambda: self._stall(False), ""),
            "garble": (self._garble, ""),
            "status": (lambda: None, ""),
            "quit": (self._quit, ""),
        }

    def _undo(self, now_ns: int) -> None:
        for name in [name for name, due_ns in self._later.items() if due_ns <= now_ns]:
            del self._later[name]
            self.obey([name])

    def _unplug(self) -> None:
        self._terminal.pull_out()

    def _replug(self) -> None:
        if not self._terminal.is_plugged_in:
            self._counters.update(self._device.counters)
            self._device = Device(self._build)
            self._terminal.plug_in()

    def _restart(self) -> None:
        self._device.restart()
        self._send(self._device.transmit())

    def _stall(self, stalled: bool) -> None:
        self._is_stalled = stalled

    def _garble(self, count: float = 1.0) -> None:
        self._garble_bytes += int(count)

    def _quit(self) -> None:
        self._is_over = True

    def status(self) -> str:
        """State and counters as one line of JSON."""
        device = self._device
        return json.dumps(
            {
                "plugged_in": self._terminal.is_plugged_in,
                "open": device.is_open,
                "bit_rate": device.bit_rate,
                "bus_off": device.is_bus_off,
                "stalled": self._is_stalled,
                "waiting_frames": device.waiting_frames,
                **dict(sorted((self._counters + device.counters).items())),
            }
        )


_COMMANDS = """\
commands on standard input, one a line; with S seconds it is undone by itself after that time:
  unplug [S]   the port vanishes with the adapter's power; replug: a new port under the same name
  busoff [S]   nothing comes or goes on the bus; restart: on the bus again
  stall [S]    the adapter reads nothing from the host; resume: it reads again
  garble N     the next N bytes to the host are turned into other bytes
  status       the state as one line of JSON, with which every command is answered
  quit         unplugged for good

exit codes: 0 after quit, 2 for a wrong command line or a bus that cannot be opened, 3 when the bus is gone, 130 after
Ctrl-C"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Serve until SIGTERM, Ctrl-C, ``quit`` or the end of the bus."""
    parser = OneLineParser(
        prog="python -m railhil.machines.adapter", description="Emulated serial CAN adapter (slcan).", epilog=_COMMANDS
    )
    parser.add_argument("--link", type=Path, required=True, metavar="PATH", help="where the serial port appears")
    parser.add_argument("--serial-rate", type=whole_number(0, 12_000_000), default=0, metavar="BAUD",
                        help="pace of the serial line (default 0: as fast as it goes, as over USB)")  # fmt: skip
    parser.add_argument("--queue", type=whole_number(1, 4096), default=Build().transmit_queue_frames, metavar="FRAMES",
                        help="size of the transmit queue (default %(default)s)")  # fmt: skip
    parser.add_argument("--bus-bit-rate", type=int, choices=BIT_RATES, metavar="BPS",
                        help="only a host that sets this bit rate hears the bus (default: any does)")  # fmt: skip
    parser.add_argument("--no-answers", action="store_true",
                        help="firmware that does not answer commands and frames")  # fmt: skip
    add_bus_arguments(parser)
    namespace = parse(parser, arguments)
    if namespace.link.exists() and not namespace.link.is_symlink():
        parser.error(f"--link: {namespace.link} is there and is no symbolic link")
    choice = choose_bus(named_bus(namespace))
    build = Build(
        transmit_queue_frames=namespace.queue, bus_bit_rate=namespace.bus_bit_rate, answers=not namespace.no_answers
    )
    link = open_link(choice.config)
    try:
        emulator = Emulator(
            Terminal(namespace.link), build, link, serial_rate_baud=namespace.serial_rate,
            commands_fd=sys.stdin.fileno(), say=lambda line: print(line, flush=True),
        )  # fmt: skip
        print(f"adapter: {namespace.link} on {choice.transport}", file=sys.stderr, flush=True)
        emulator.run()
    finally:
        link.close()
    return 0
