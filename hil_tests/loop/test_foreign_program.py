"""The exported controller as a program on the hub: complete runs, refusals, and its exit."""

from __future__ import annotations

import json
import os
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.cli import Started, railhil, wait_for
from hil_tests.support.exported import STRICT
from hil_tests.support.foreign import SANITIZED, build, build_node, export_node, foreign_run, without_status
from railhil.bench import local_run
from railhil.bus.codes import Event
from railhil.bus.frame import EXTENDED, Frame
from railhil.bus.hub.client import HubBus
from railhil.bus.mvb import F_DEVICE_STATUS, device_status_frame, master_frame
from railhil.bus.telegrams import RunEvent
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth

pytestmark = [pytest.mark.needs_compiler, pytest.mark.loop]

#: Silence after which the program ends.
_SILENCE_S = 3.0


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """IPFC on the published scenario."""
    folder = tmp_path_factory.mktemp("ipfc")
    export_node(load("lvshun_tieshan"), folder)
    return build_node(folder)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
@pytest.mark.parametrize(
    ("name", "law", "indexing", "arithmetic", "arguments"),
    [
        ("lvshun_tieshan", "ipfc", "time", "iq", ("--seed", "0")),
        ("yizhuang_05", "ipfc_plus", "time", "iq", ("--seed", "1003", "--perturbed")),
        ("yizhuang_02_xiaocun_xiaohongmen", "ipfc", "distance", "iq", ("--seed", "7", "--perturbed")),
        ("lvshun_tieshan", "ipfc", "time", "float32", ("--seed", "0")),
    ],
)
def test_whole_runs_over_the_hub_have_the_same_frames(
    program: Path,
    name: str,
    law: str,
    indexing: str,
    arithmetic: str,
    arguments: tuple[str, ...],
    tmp_path: Path,
    socket_folder: Path,
) -> None:
    """The program as a process of its own: every frame of the record is the same, but for telemetry in CTL_STAT.

    IPFC+ runs with the sanitizers: an error in the C would end it.
    """
    scenario = load(name)
    if (name, law, indexing, arithmetic) != ("lvshun_tieshan", "ipfc", "time", "iq"):
        export_node(scenario, tmp_path / "export", indexing, law, arithmetic)
        flags = SANITIZED if law == "ipfc_plus" else (*STRICT, "-O2", "-ffp-contract=off")
        program = build_node(tmp_path / "export", law, flags)
    law_arguments = ("--controller", law, "--indexing", indexing, "--arithmetic", arithmetic)
    run = foreign_run(program, socket_folder / "hub.sock", tmp_path / "c", name, *law_arguments, *arguments)
    assert run.done.exit_code in (0, 1), run.done.err
    assert run.exit_code == 0, run.said
    assert re.search(r"\d+ control periods, run event 4$", run.said.strip()), run.said
    certificate = json.loads((tmp_path / "c/certificate.json").read_text())
    assert certificate["foreign"] is True
    assert certificate["not_witnessed"] == ["NOTCH_CMD", "CTL_STAT", "CTL_IDENT"]
    assert "parameters: not known: the controller was not railhil's" in run.done.out
    (tmp_path / "python").mkdir()
    seed, drawn = int(arguments[1]), "--perturbed" in arguments
    spec = RunSpec(law=LawSpec(law, arithmetic, indexing=indexing), seed=seed, perturbed=drawn)
    expected = local_run(scenario, tmp_path / "python", spec)
    assert expected.log is not None
    found = trace_of(read_log(tmp_path / "c/frames.log"), wire_contract())
    assert [int(code) for code in found.raw(NotchCmd.PORT, "NotchCmd")] == expected.commands("notch")
    assert without_status(tmp_path / "c/frames.log") == without_status(expected.log)
    assert len(set(expected.commands("notch"))) > 50
    for field in ("Note1", "LadderLevel", "OverflowFlags", "Note2", "Note3", "StepCount",
                   "StepCycles", "OverrunCount", "CtlReady", "CtlLife"):  # fmt: skip
        assert np.array_equal(found.raw(CtlStat.PORT, field), expected.trace.raw(CtlStat.PORT, field)), field


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("yizhuang_02_xiaocun_xiaohongmen",), "scenario differs: plant"),
        (("lvshun_tieshan", "--controller", "tpfc2"), "controller differs: controller ipfc, supervisor tpfc2; say"),
        (("lvshun_tieshan", "--indexing", "distance"), "indexing differs: controller time, supervisor distance"),
        (("lvshun_tieshan", "--arithmetic", "float32"), "arithmetic differs: controller iq, supervisor float32"),
    ],
)
def test_export_of_something_else_is_refused(
    program: Path, arguments: tuple[str, ...], words: str, tmp_path: Path, socket_folder: Path
) -> None:
    run = foreign_run(program, socket_folder / "hub.sock", tmp_path / "run", *arguments)
    assert run.done.exit_code == 2
    assert words in run.done.one_line()
    assert not (tmp_path / "run").exists()
    if "scenario" in words:
        assert run.exit_code == 2
        assert "the nodes do not agree on what to run; railhil run says in what" in run.said


@pytest.mark.long
@pytest.mark.faults
@pytest.mark.slow
def test_killed_program_is_a_lost_controller(program: Path, tmp_path: Path, socket_folder: Path) -> None:
    """The train stops by itself, the record says so, the verdict is INVALID."""
    channel, folder = socket_folder / "hub.sock", tmp_path / "run"
    bus = ("-i", "railhil", "-c", channel)
    hub = Started("bus", "hub", *bus[2:])
    wait_for(channel.exists)
    node = subprocess.Popen([program, "hub", channel], stderr=subprocess.PIPE)
    try:
        # The hub tells the plant that it has left.
        patience = ("--patience", "600")
        run = Started(
            "run", "--no-controller", "--seed", "1", "--out", folder, "--quiet", "--no-report", *patience, *bus
        )
        # 1.5 of 4 MB: the train is under way.
        wait_for(lambda: (folder / "frames.log").stat().st_size > 1_500_000)
        node.send_signal(signal.SIGKILL)
        done, _ = run.finish()
    finally:
        node.kill()
        node.communicate()
        hub.process.terminate()
        hub.finish()
    assert done.exit_code == 3
    assert "Traceback" not in done.out + done.err
    trace = trace_of(read_log(folder / "frames.log"), wire_contract())
    assert trace.raw(RunEvent.PORT, "RunEvent")[-1] == Event.ENDED_CONTROLLER_LOST
    speeds, commanded = trace.values(SimTruth.PORT, "TrueSpeed"), trace.times_s(NotchCmd.PORT)[-1]
    assert speeds[np.searchsorted(trace.times_s(SimTruth.PORT), commanded)] > 5
    assert speeds[-1] == 0


def test_silence_ends_the_program(program: Path, socket_folder: Path) -> None:
    """A bus on which only others talk any more; the device status answer shows that it was listening.

    Nobody has said that time goes by the wall clock: its patience is that of lockstep.
    """
    channel = socket_folder / "hub.sock"
    hub = Started("bus", "hub", "-c", channel)
    wait_for(channel.exists)
    node = subprocess.Popen([program, "-p", "3", "hub", channel], stderr=subprocess.PIPE, text=True)
    bus = HubBus(str(channel))
    try:

        def answer() -> list[Frame]:
            bus.send_frames([master_frame(F_DEVICE_STATUS, 1)])
            return bus.recv_frames(0.2)

        assert wait_for(answer) == [device_status_frame(1, 0x1000)]
        begun_s = time.monotonic()
        own = wire_contract().poll_id
        while node.poll() is None and time.monotonic() < begun_s + 20:
            bus.send_frames([Frame(0x7F0, bytes(8)), Frame(own, bytes(3), EXTENDED)])
            time.sleep(0.1)
        _, said = node.communicate(timeout=1)
        assert node.returncode == 3
        expected = "waits for the bus administrator (plant): no frame of the bench for 3 s"
        assert said.splitlines()[0].endswith(expected)
        assert time.monotonic() - begun_s >= _SILENCE_S - 0.3
    finally:
        node.kill()
        node.wait()
        bus.shutdown()
        hub.process.terminate()
        hub.finish()


def test_first_frame_is_waited_for_as_long_as_is_said(program: Path, socket_folder: Path) -> None:
    channel = socket_folder / "hub.sock"
    hub = Started("bus", "hub", "-c", channel)
    try:
        wait_for(channel.exists)
        done = subprocess.run(
            [program, "-w", "1", "hub", channel], capture_output=True, text=True, timeout=60, check=False
        )
    finally:
        hub.process.terminate()
        hub.finish()
    assert done.returncode == 3
    assert done.stderr.splitlines()[0].endswith(
        "waits for the bus administrator (plant): no frame of the bench for 1 s"
    )


def test_hub_that_is_mute_is_one_line(program: Path, socket_folder: Path) -> None:
    """It takes the connection, and never says hello."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as mute:
        mute.bind(str(socket_folder / "mute.sock"))
        mute.listen()
        done = subprocess.run(
            [program, "hub", socket_folder / "mute.sock"], capture_output=True, text=True, timeout=60, check=False
        )
    assert done.returncode == 2
    assert done.stderr.endswith("mute.sock: hub: it takes the connection and does not answer\n")
    assert len(done.stderr.splitlines()) == 1


def test_hub_that_goes_is_one_line(program: Path, socket_folder: Path) -> None:
    channel = socket_folder / "hub.sock"
    hub = subprocess.Popen([sys.executable, "-m", "railhil.bus.hub", "-c", str(channel)], stderr=subprocess.DEVNULL)
    wait_for(channel.exists)
    node = subprocess.Popen([program, "hub", channel], stderr=subprocess.PIPE, text=True)
    bus = HubBus(str(channel))

    def answer() -> list[Frame]:
        bus.send_frames([master_frame(F_DEVICE_STATUS, 1)])
        return bus.recv_frames(0.2)

    wait_for(answer)
    hub.kill()
    hub.wait()
    bus.shutdown()
    _, said = node.communicate(timeout=20)
    assert node.returncode == 3
    assert "lost: connection closed by the hub" in said or "lost: Connection reset by peer" in said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "found 0 arguments, allowed can INTERFACE, hub PATH, slcan DEVICE, or pipe"),
        (("-w", "0", "can", "can0"), "found 0, allowed -w S, -p S with 1 to 3600 s"),
        (("-p", "soon", "can", "can0"), "found soon, allowed"),
        (("-x", "can", "can0"), "found -x, allowed"),
        (("-w",), "found -w, allowed"),
        (("serial", "/dev/null"), "allowed can INTERFACE, hub PATH, slcan DEVICE, or pipe"),
        (("can", "no_such_can9"), "no_such_can9: "),
        (("hub", "/" + "x" * 200), "the path is too long for a Unix socket"),
        (("hub", "/proc/none"), "no hub: "),
    ],
)
def test_wrong_use_is_one_line(program: Path, arguments: tuple[str, ...], words: str) -> None:
    done = subprocess.run([program, *arguments], capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--no-controller", "--attach"), "--no-controller: cannot be given with --attach"),
        (("--no-controller", "--task-period-ms", "50"), "--task-period-ms: found 50, allowed 0 with --no-controller"),
        (("--rerun-command", "make again"), "--rerun-command: used only with --attach"),
        (("--fault-logs", "logs"), "--fault-logs: used only with --attach"),
    ],
)
def test_run_without_controller_refuses_what_it_cannot_have(arguments: tuple[str, ...], words: str) -> None:
    done = railhil("run", *arguments)
    assert done.exit_code == 2
    assert words in done.one_line()


_OPEN = """\
#include "railhil_socket.h"
#include <errno.h>
#include <stdio.h>
int main(int argc, char **argv)
{ (void)argc; if (railhil_slcan_open(argv[1]) < 0) { puts(strerror(errno)); } return 0; }
"""


@pytest.mark.parametrize(
    ("bit_rate", "said", "opening"),
    [
        (500_000, "", b"C\rS6\rO\r"),
        (10_000, "", b"C\rS0\rO\r"),
        (400_000, "Invalid argument", b""),
        (2_000_000, "Invalid argument", b""),
    ],
)
def test_a_bit_rate_that_a_serial_adapter_does_not_have_is_refused(
    program: Path, bit_rate: int, said: str, opening: bytes, tmp_path: Path
) -> None:
    shutil.copytree(program.parent, tmp_path, dirs_exist_ok=True)
    header = tmp_path / "ipfc_node.h"
    assert "BIT_RATE 500000L" in header.read_text()
    header.write_text(header.read_text().replace("BIT_RATE 500000L", f"BIT_RATE {bit_rate}L"))
    (tmp_path / "open.c").write_text(_OPEN)
    opener = build(tmp_path, ["open.c", "railhil_socket.c", "railhil_slcan.c"], "open", STRICT)
    adapter, line = os.openpty()
    try:
        done = subprocess.run([opener, os.ttyname(line)], capture_output=True, text=True, timeout=60, check=True)
        assert done.stdout.strip() == said
        arrived = select.select([adapter], [], [], 0)[0]
        assert (os.read(adapter, 100) if arrived else b"") == opening
    finally:
        os.close(adapter)
        os.close(line)
