"""The hub says which nodes of a bench are here: who has left a lockstep run is not waited for."""

from __future__ import annotations

import contextlib
import re
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from hil_tests.support.cli import TIMEOUT_S, Done, command, wait_for
from hil_tests.support.hub import PATIENCE_S, node, running_hub
from railhil.bus import packing
from railhil.bus.frame import Frame
from railhil.bus.hub.client import HubUnavailable
from railhil.bus.ident import Role
from railhil.bus.link import open_link
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of

#: Nobody who waits for it ends within a test.
_ENDLESS = ("--patience", "600")


def test_the_roles_are_those_of_the_bench() -> None:
    assert set(packing.ROLES) == {role.name.lower() for role in Role}


@pytest.mark.parametrize("roles", [[], ["plant"], ["plant", "controller"], ["plant", "plant", "supervisor"]])
def test_a_packet_of_roles_is_no_packet_of_frames(roles: list[str]) -> None:
    packet = packing.encode_roles(roles)
    assert packing.decode_notice(packet) == {"roles": sorted(set(roles))}
    assert len(packet) & packing.NOTICE_LENGTH_BIT
    for length in (packing.CLASSIC_SIZE, packing.FD_SIZE, len(packing.OWN_MARK)):
        assert not length & packing.NOTICE_LENGTH_BIT


@pytest.mark.parametrize("coalesce_frames", [0, 64])
@pytest.mark.parametrize("channel", [None, "tcp://127.0.0.1:0"])
def test_a_node_that_leaves_has_left_behind_its_last_frame(channel: str | None, coalesce_frames: int) -> None:
    with running_hub(channel=channel) as hub, hub.bus(role="plant", coalesce_frames=coalesce_frames) as plant:
        assert not plant.has_left("controller"), "it has never been here"
        controller = hub.bus(role="controller")
        controller.send_frames([Frame(0x100, b"last")])
        controller.shutdown()
        assert not plant.has_left("controller"), "its last frame is not read yet"
        assert plant.recv_frames(PATIENCE_S) == [Frame(0x100, b"last")]
        wait_for(lambda: plant.recv_frames(0.01) == [] and plant.has_left("controller"))
        with hub.bus(role="controller"):
            wait_for(lambda: plant.recv_frames(0.01) == [] and not plant.has_left("controller"))
        wait_for(lambda: plant.recv_frames(0.01) == [] and plant.has_left("controller"))


def test_of_two_with_one_role_one_is_left() -> None:
    with running_hub() as hub, hub.bus(role="plant") as plant, hub.bus(role="controller") as stays:
        hub.bus(role="controller").shutdown()
        stays.send_frames([Frame(0x100, b"")])
        assert plant.recv_frames(PATIENCE_S) == [Frame(0x100, b"")]
        assert not plant.has_left("controller")


def test_who_has_no_role_is_told_nothing() -> None:
    """Tools of others, and the controller in C: frames only."""
    with running_hub() as hub, hub.bus() as tool:
        node = hub.bus(role="plant")
        node.send_frames([Frame(0x100, b"")])
        node.shutdown()
        assert tool._open_link().receive_packet(None) == packing.pack_frame(Frame(0x100, b""))
        with hub.bus() as other:
            other.send_frames([Frame(0x101, b"")])
            assert tool._open_link().receive_packet(None) == packing.pack_frame(Frame(0x101, b""))


def test_an_unknown_role_is_refused() -> None:
    with running_hub() as hub, pytest.raises(HubUnavailable, match="'role': found 'driver', allowed: plant, contr"):
        hub.bus(role="driver")


def test_the_link_of_a_node_says_its_name() -> None:
    with running_hub() as hub:
        config = {"interface": "railhil", "channel": hub.channel}
        plant, controller = open_link(config, "plant"), open_link(config, "controller")
        tool = open_link(config)
        tool.close()
        controller.close()
        wait_for(lambda: plant.receive(0.01) == [] and plant.has_ended("controller"))
        assert (plant.may_deliver("controller"), plant.may_deliver("plant")) == (False, True)
        assert not plant.has_ended("supervisor")
        plant.close()


@contextlib.contextmanager
def _bench(folder: Path, *pace: str) -> Iterator[dict[str, subprocess.Popen[str]]]:
    """Three nodes on a hub, each started by itself, in the middle of a run."""
    scenario = "lvshun_tieshan"
    with (
        running_hub() as hub,
        node("controller", scenario, hub.channel, *_ENDLESS) as controller,
        node("plant", scenario, hub.channel, *_ENDLESS, *pace) as plant,
    ):
        words = ("--attach", "-i", "railhil", "-c", hub.channel, "--out", folder, "--quiet", "--no-report")
        run = subprocess.Popen(
            command("run", scenario, *words, *_ENDLESS, *pace),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            wait_for(lambda: (folder / "frames.log").stat().st_size > 300_000)
            yield {"controller": controller, "plant": plant, "supervisor": run}
        finally:
            run.kill()
            run.communicate(timeout=PATIENCE_S)


def _done(process: subprocess.Popen[str]) -> Done:
    out, err = process.communicate(timeout=TIMEOUT_S)
    return Done(process.returncode, out or "", err)


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.loop
@pytest.mark.faults
@pytest.mark.parametrize("killed", ["controller", "plant"])
def test_a_run_of_attached_nodes_names_who_has_left(tmp_path: Path, killed: str) -> None:
    with _bench(tmp_path / "run") as nodes:
        nodes[killed].send_signal(signal.SIGKILL)
        done = _done(nodes["supervisor"])
        assert done.exit_code == 3, done.err
        assert done.out.splitlines()[-1].startswith(f"INVALID: {killed} left the bus at simulation time ")
        if killed == "plant":
            other = _done(nodes["controller"])
            assert "controller waits for the bus administrator, which has ended" in other.err
        else:
            other = _done(nodes["plant"])
            # The poll that it did not answer may be of either of its ports.
            assert re.search(
                r"waits for controller \((NOTCH_CMD|CTL_STAT)\), which has ended, at simulation time", other.err
            )
        assert other.exit_code == 3
    trace = trace_of(read_log(tmp_path / "run" / "frames.log"), wire_contract())
    assert (trace.raw("RUN_EVENT", "RunEvent")[-1] == 7) == (killed == "controller"), "the train brakes by itself"


@pytest.mark.slow
@pytest.mark.loop
@pytest.mark.faults
def test_nodes_whose_recorder_has_left_end(tmp_path: Path) -> None:
    with _bench(tmp_path / "run") as nodes:
        nodes["supervisor"].send_signal(signal.SIGKILL)
        assert "waits for supervisor (SUP_CMD), which has ended" in _done(nodes["plant"]).err
        assert nodes["controller"].wait(PATIENCE_S) == 0, "the plant has told it the end"


@pytest.mark.long
@pytest.mark.loop
@pytest.mark.faults
@pytest.mark.slow
def test_in_realtime_nobody_gives_up_earlier(tmp_path: Path) -> None:
    """The ladder reacts, and the record ends 4 s after the loss."""
    with _bench(tmp_path / "run", "--pace", "realtime", "--rate", "20") as nodes:
        nodes["controller"].send_signal(signal.SIGKILL)
        done = _done(nodes["supervisor"])
        assert done.exit_code == 3, done.err
        assert "left the bus" not in done.out
    trace = trace_of(read_log(tmp_path / "run" / "frames.log"), wire_contract())
    assert trace.raw("RUN_EVENT", "RunEvent")[-1] == 7
    last_notch_s = trace.times_s("NOTCH_CMD")[-1]
    assert trace.times_s("SIM_TRUTH")[-1] > last_notch_s + 1, "braked by the train's own watch, in the record"
