"""The exported controller in C, for tests: as the program of ``make node``, and as a library in parallel with the
Python node."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from hil_tests.support.cli import Done, Started, railhil, wait_for
from hil_tests.support.exported import STRICT
from railhil.bus.frame import ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.ident import CtlIdent
from railhil.bus.local import LocalBus
from railhil.bus.packing import EFF_FLAG, ERR_FLAG, RTR_FLAG
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.export import make_bundle, write_bundle
from railhil.plant_sim.node import make_plant_node
from railhil.record.session import make_session
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlStat

#: The controller around the law; the program additionally has sockets and a loop.
PORTABLE = (
    "railhil_clock.c",
    "railhil_position.c",
    "railhil_motion.c",
    "railhil_guard.c",
    "railhil_telegrams.c",
    "railhil_law.c",
    "railhil_control.c",
)
_HOST = ("railhil_pipe.c", "railhil_socket.c", "railhil_slcan.c", "railhil_node.c")
PROGRAM = (*PORTABLE, *_HOST)
#: The same around a law of a system with an interface.
PORTABLE_INTERFACE = ("railhil_clock.c", "railhil_telegrams.c", "railhil_law.c", "railhil_control.c")
PROGRAM_INTERFACE = (*PORTABLE_INTERFACE, *_HOST)
#: Undefined behaviour and memory errors end the program.
SANITIZED = ("-std=c99", "-O1", "-g", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined",
             "-fno-sanitize-recover=all")  # fmt: skip
#: Additional code of the library: one controller, with access functions.
_SHIM = """\
#include "railhil_control.h"
static railhil_control_t control;
void begin(void) { railhil_init(&control); }
unsigned take(uint32_t can_id, unsigned length, const unsigned char *data, railhil_frame_t *answer)
{ return railhil_receive(&control, can_id, length, data, answer); }
void elapsed(int64_t ns) { railhil_elapsed(&control, ns); }
unsigned counted(unsigned index) { return (unsigned)control.counts[index]; }
unsigned counters(void) { return RAILHIL_COUNTS; }
int ended(void) { return control.ended; }
"""
_LEVEL = "int level(void) { return control.law.guard.watch.level; }\n"


def export_node(
    scenario: Scenario, folder: Path, indexing: str = "time", law: str = "ipfc", arithmetic: str = "iq"
) -> None:
    """An export without its reference log, which takes nine tenths of the time and is not used here."""
    with patch("railhil.controller_node.export.bundle.reference_log", return_value="# not computed\n"):
        write_bundle(make_bundle(scenario, LawSpec(law, arithmetic, indexing=indexing)), folder)


def build(folder: Path, sources: Sequence[str], name: str, flags: Sequence[str], compiler: str = "gcc") -> Path:
    """Compile files of an export; warnings are errors."""
    command = [compiler, *flags, "-o", name, *sources, "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stderr}"
    return folder / name


def build_node(folder: Path, law: str = "ipfc", flags: Sequence[str] = (*STRICT, "-O2"), name: str = "node") -> Path:
    """The program on the bus."""
    return build(folder, [f"{law}.c", *PROGRAM], name, flags)


class CFrame(ctypes.Structure):
    """``railhil_frame_t``."""

    _fields_ = (("can_id", ctypes.c_uint32), ("length", ctypes.c_uint), ("data", ctypes.c_ubyte * 8))


class CNode:
    """The C controller in this process: takes frames like :meth:`ControllerNode.handle`.

    :param folder: of the export; the library is compiled there once.
    :param portable: files of the controller around the law.
    """

    def __init__(self, folder: Path, law: str, portable: Sequence[str] = PORTABLE) -> None:
        path = folder / "library.so"
        if not path.exists():
            (folder / "shim.c").write_text(_SHIM + (_LEVEL if "railhil_guard.c" in portable else ""))
            flags = (
                *STRICT,
                "-O2",
                "-ffp-contract=off",
                "-fPIC",
                "-shared",
                "-fsanitize=undefined",
                "-fsanitize-undefined-trap-on-error",
            )
            build(folder, [f"{law}.c", *portable, "shim.c"], path.name, flags)
        self._c = ctypes.CDLL(str(path))
        self._c.railhil_count_name.restype = ctypes.c_char_p
        self._answer = (CFrame * 5)()
        self._c.begin()

    def handle(self, frame: Frame) -> list[Frame]:
        """Take one frame, flagged as Linux would; returns the answer."""
        can_id, data, flags = frame
        if flags & FD:
            return []
        for flag, bit in ((EXTENDED, EFF_FLAG), (REMOTE, RTR_FLAG), (ERROR, ERR_FLAG)):
            can_id |= bit if flags & flag else 0
        count = self._c.take(ctypes.c_uint32(can_id), len(data), data, self._answer)
        return [Frame(each.can_id, bytes(each.data[: each.length])) for each in self._answer[:count]]

    def was_stopped(self, sim_ns: int) -> None:
        """Nothing was received for so much simulation time."""
        self._c.elapsed(ctypes.c_int64(sim_ns))

    @property
    def ended(self) -> int:
        """Code of the event that ended the run, 0 before."""
        return int(self._c.ended())

    @property
    def level(self) -> int:
        """Level of the reaction ladder, of a train's controller."""
        return int(self._c.level())

    @property
    def counters(self) -> dict[str, int]:
        """Counters of refused telegrams, by the names of the Python node."""
        names = [self._c.railhil_count_name(index).decode() for index in range(self._c.counters())]
        return {name: count for index, name in enumerate(names) if index >= 2 and (count := self._c.counted(index))}


def without_telemetry(answer: list[Frame]) -> list[Frame]:
    """An answer in the form that C can give: in CTL_STAT, the second block without telemetry and its check sequence."""
    first, second, _, *_ = CtlStat.port().can_ids
    if not answer or answer[0].can_id != first:
        return answer
    block, trailer = answer[1].data, answer[2].data
    assert answer[1].can_id == second
    return [answer[0], Frame(second, block[:2] + block[6:]), Frame(answer[2].can_id, trailer[:1] + trailer[2:])]


@dataclass(slots=True)
class TwinRun:
    """A run of both controllers on the same frames: number of equal answers, counters of each, levels passed."""

    answers: int
    python: dict[str, int]
    c: dict[str, int]
    levels: set[int]
    ended: tuple[int, int]


def twin_run(
    scenario: Scenario,
    c: CNode,
    folder: Path,
    *,
    seed: int = 0,
    drawn: bool = False,
    law: str = "ipfc",
    indexing: str = "time",
    arithmetic: str = "iq",
    wire: Callable[[Frame], list[Frame]] | None = None,
) -> TwinRun:
    """A run in this process in which the C gets every frame that the Python node gets, and must give the same answers.

    :param wire: applied to each frame on its way to both (faults).
    :raises AssertionError: at the first answer that differs.
    """
    spec = RunSpec(law=LawSpec(law, arithmetic, indexing=indexing), seed=seed, perturbed=drawn)
    node = ControllerNode(scenario, spec.law)
    session = make_session(scenario, lambda line: None, spec)
    run = TwinRun(0, {}, {}, set(), (0, 0))
    met = False

    def both(frame: Frame) -> list[Frame]:
        nonlocal met
        answers = []
        for item in [frame] if wire is None else wire(frame):
            expected, found = node.handle(item), c.handle(item)
            assert without_telemetry(found) == without_telemetry(expected), f"{item} at {run.answers} answers"
            # Before the handshake the C may still have the state of an earlier run.
            met = met or [each.can_id for each in expected] == [*CtlIdent.port().can_ids]
            if met:
                assert c.level == node.guard.level, f"{item} at {run.answers} answers"
                run.levels.add(c.level)
            run.answers += bool(expected)
            answers += expected
        return answers

    make_plant_node(scenario, spec, LocalBus([both, session.handle])).run()
    run.python, run.c = node.counters, c.counters
    run.ended = (int(node.ended or 0), c.ended)
    return run


@dataclass(frozen=True, slots=True)
class ForeignRun:
    """A run over the hub with the C program as the controller: the command, and how the program ended."""

    done: Done
    exit_code: int
    said: str


def foreign_run(program: Path, channel: Path, out: Path, *arguments: str) -> ForeignRun:
    """``railhil run --no-controller`` with the program on a private hub.

    :param channel: path for the hub's socket.
    """
    hub = Started("bus", "hub", "-c", channel)
    try:
        wait_for(channel.exists)
        node = subprocess.Popen([program, "hub", channel], stderr=subprocess.PIPE, text=True)
        try:
            bus = ("-i", "railhil", "-c", channel)
            done = railhil("run", *arguments, "--no-controller", "--out", out, "--quiet", "--no-report", *bus)
            _, said = node.communicate(timeout=10)
        finally:
            node.kill()
            node.wait()
        return ForeignRun(done, node.returncode, said)
    finally:
        hub.process.terminate()
        hub.finish()


def without_status(log: Path) -> list[str]:
    """Lines of a frame log except those of CTL_STAT."""
    own = {f"{can_id:X}" for can_id in CtlStat.port().can_ids}
    return [line for line in log.read_text().splitlines() if line.split()[2].partition("#")[0] not in own]
