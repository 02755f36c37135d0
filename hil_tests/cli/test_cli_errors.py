"""Bad input on the command line: one line that names what was found, the right exit code, nothing left behind."""

from __future__ import annotations

import json
import os
import signal
import socket
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.cli import Done, Started, complaint, railhil, wait_for
from railhil.bus.codes import Event
from railhil.bus.errors import BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.ident import Role, make_ident
from railhil.bus.local import LocalBus
from railhil.bus.mvb import TelegramSource
from railhil.bus.select import BusChoice
from railhil.cli import programs as outside
from railhil.common.errors import InputError
from railhil.controller_node.ato.node import ControllerNode
from railhil.dbc import wire_contract
from railhil.plant_sim.handshake import Refused
from railhil.plant_sim.node import make_plant_node
from railhil.record.framelog import log_line, sha256_of
from railhil.record.run_folder import run_folder
from railhil.record.session import make_session
from railhil.run.bus_run import BusRun
from railhil.run.run import Plan
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec, StartUp

Railhil = Callable[..., Done]


def ident_frames(**changes: int) -> list[Frame]:
    """PLT_IDENT of a run of the published scenario, with changed fields and right check sequences."""
    ident = make_ident(Role.PLANT, load("lvshun_tieshan").sha256, contract=wire_contract())
    for name, value in changes.items():
        setattr(ident, name, value)
    return list(TelegramSource(wire_contract().port(ident.PORT), False).frames(ident.encode()))


def log_of(folder: Path, frames: list[Frame]) -> Path:
    path = folder / "frames.log"
    path.write_text("".join(log_line(0, frame) for frame in frames), encoding="ascii")
    return path


# -- usage ------------------------------------------------------------------------------------------------------------

USAGE = {
    "unknown command": (["rnu"], "there is no command 'rnu', did you mean run?"),
    "one word too many": (["run", "a", "b"], "railhil run: unrecognized arguments: b (see"),
    "unknown option": (["run", "--sede", "3"], "railhil run: unrecognized arguments: --sede, did you mean --seed? "),
    "unknown option of a kind": (["bus", "hub", "--prot", "a:b"], "bus hub: unrecognized arguments: --prot a:b, did"),
    "unknown scenario": (["run", "lvshun_tieshn"], "did you mean lvshun_tieshan?"),
    "no such file": (["run", "there.toml"], "there.toml: does not exist"),
    "unknown controller": (
        ["run", "--controller", "nix"],
        "--controller: found 'nix', allowed ipfc, tpfc2, tpfc1, ",
    ),
    "mistyped law": (["compare", "--laws", "ipfcc"], "(did you mean ipfc?)"),
    "arithmetic": (["run", "--arithmetic", "flaot64"], "--arithmetic: found flaot64, allowed float32, "),
    "negative seed": (["run", "--seed", "-1"], "--seed: found -1, allowed 0..4294967295"),
    "huge seed": (["run", "--seed", "4294967296"], "--seed: found 4294967296"),
    "text as seed": (["run", "--seed", "x"], "--seed: found x, allowed 0..4294967295"),
    "endless seed": (["run", "--seed", "9" * 5000], "--seed: found 999999"),
    "endless bit rate": (["bus", "hub", "--bitrate-model", "-b", "9" * 4000], "-b/--bitrate: found 999"),
    "endless queue": (["bus", "hub", "--queue-limit", "9" * 5000], "--queue-limit: found 999"),
    "endless TCP port": (["bus", "hub", "-c", f"tcp://127.0.0.1:{'9' * 5000}"], "found port '999"),
    "endless setting": (["bus", "hub", "--port", f"railhil:a,fd={'9' * 5000}"], "key 'fd': found 999"),
    "rate 0": (["run", "--rate", "0"], "--rate: found 0, allowed 0.01 to 1000"),
    "no rate": (["run", "--rate", "nan"], "--rate: found nan"),
    "no role": (["node"], "ROLE is missing: one of controller, plant"),
    "no log": (["score", "/etc/passwd"], "/etc/passwd: line 1: found 'root:"),
    "no log to plot": (["plot", "nix"], "nix: does not exist, expected a candump log"),
    "no entry": (["faults", "--only", ""], "--only: found '', allowed T1, "),
    "unknown entry": (["faults", "--only", "T1,nix"], "--only: found 'nix', allowed T1, "),
    "empty out": (["run", "--out", ""], "--out: found ''"),
    "interface": (["run", "-i", "nix"], "--interface: "),
    "one process only": (["run", "-i", "virtual"], "--interface: found 'virtual', allowed an interface that other"),
    "channel alone": (["run", "-c", "vcan0"], "--interface: only -c vcan0, expected -i INTERFACE"),
    "keyword": (["run", "-i", "railhil", "--bus-kwargs", "x"], "--bus-kwargs: "),
    "port": (["ports", "nix"], "port: found 'nix', allowed TIME_SYNC, "),
    "bit rate 0": (["ports", "-b", "0"], "--bitrate: found 0, allowed bit/s above 0"),
    "node": (["node", "nix"], "ROLE: found nix, allowed controller, plant"),
    "unknown name of a scenario": (["run", "nix"], "or a name that railhil scenarios lists"),
    "hub address": (["bus", "hub", "-c", "tcp://192.0.2.1:5"], "found host '192.0.2.1', allowed: tcp://127.0.0.1"),
}


@pytest.mark.parametrize("case", USAGE)
def test_usage(here, tmp_path, case):
    arguments, words = USAGE[case]
    assert words in complaint(here(*arguments))
    assert not list(tmp_path.iterdir())


PARAMETERS = {
    "digits": (
        f"softening_max = {'9' * 5000}",
        "thousands of digits",
    ),
    "depth": (f"{'a.' * 4000}a = 1", "more than 32 deep"),
}


@pytest.mark.parametrize("case", PARAMETERS)
def test_parameter_file(here, case):
    text, words = PARAMETERS[case]
    Path("mine.toml").write_text(f'law = "ipfc"\n[parameters]\n{text}\n', encoding="utf-8")
    assert words in complaint(here("run", "--parameters", "mine.toml"))


SCENARIOS = {
    "no TOML": ("= 3", "TOML 1.0"),
    "unknown key": ("[plan]\ndistanze_m = 3", "plan.distanze_m: unknown key"),
    "other unit": ("[train]\nmass_kg = 3", "train.mass_kg: unknown key"),
}


@pytest.mark.parametrize("command", ["run", "scenarios"])
@pytest.mark.parametrize("case", SCENARIOS)
def test_scenario_file(here, tmp_path, case, command):
    text, words = SCENARIOS[case]
    head = 'extends = "lvshun_tieshan"\nname = "mine"\ntitle = "t"\n'
    Path("mine.toml").write_text(head + text, encoding="utf-8")
    line = complaint(here(command, "mine.toml"))
    assert "mine.toml: " in line
    assert words in line
    if "key" in case or "unit" in case:
        assert "did you mean " in line
    assert [path.name for path in tmp_path.iterdir()] == ["mine.toml"]


def test_out_that_cannot_be_used(here, tmp_path):
    Path("occupied").mkdir()
    Path("occupied/file").touch()
    for out, words in (
        ("occupied", "an empty or new folder"),
        ("occupied/file", "file exists"),
        ("occupied/file/below", "not a directory"),
        ("/proc/nothing/here", "no such file or directory"),
    ):
        line = complaint(here("run", "--out", out))
        assert (" --out: " in line, out in line, words in line) == (True, True, True), line
    assert [path.name for path in tmp_path.rglob("*")] == ["occupied", "file"]


def test_out_without_permission(tmp_path):
    """Root may write everywhere, so the check is made with the rights of an ordinary user."""
    folder = tmp_path / "closed"
    folder.mkdir()
    user = os.geteuid()
    for path in (tmp_path, *tmp_path.parents):
        if path.stat().st_uid == user and str(path).startswith("/tmp/"):
            path.chmod(0o755)
    folder.chmod(0o555)
    if user == 0:
        os.seteuid(65534)
    try:
        with pytest.raises(Exception, match=r"--out: .*permission denied") as caught:
            run_folder(str(folder), "s", "c")
        assert caught.value.exit_code == 2
    finally:
        os.seteuid(user)


def test_missing_parents_of_out_are_made(tmp_path):
    folder, made = run_folder(str(tmp_path / "a" / "b"), "s", "c")
    assert (folder.is_dir(), made) == (True, True)
    assert run_folder(str(folder), "s", "c") == (folder, False)


# -- the bus ----------------------------------------------------------------------------------------------------------


def test_bus_that_cannot_be_opened(here, tmp_path, socket_folder):
    stale, stream, plain = (socket_folder / name for name in ("stale.sock", "stream.sock", "plain.sock"))
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
        listener.bind(str(stale))
    plain.touch()
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        listener.bind(str(stream))
        listener.listen()
        for interface, channel, words in (
            ("socketcan", "vcan9", "bus socketcan:vcan9 cannot be opened: "),
            ("railhil", socket_folder / "no.sock", "no.sock: no such file or directory"),
            ("railhil", stale, "stale.sock: connection refused"),
            ("railhil", stream, "stream.sock: protocol wrong type for socket"),
            ("railhil", plain, "plain.sock: connection refused"),
            ("railhil", "tcp://192.0.2.1:5", "found host '192.0.2.1', allowed"),
        ):
            patience = () if interface == "socketcan" else ("--bus-kwargs", "connect_timeout=0.2")
            attach = here("run", "--attach", "-i", interface, "-c", channel, *patience, "--out", "run")
            assert words in complaint(attach)
    # An empty folder of the user's own stays, one that was made for the run goes.
    assert not list(tmp_path.iterdir())
    Path("mine").mkdir()
    complaint(here("run", "--attach", "-i", "railhil", "-c", plain, *patience, "--out", "mine"))
    assert [path.name for path in tmp_path.rglob("*")] == ["mine"]


def test_interface_without_its_driver(tmp_path):
    """python-can's plugins raise anything when the vendor's library is missing; kvaser a NameError."""
    choice = BusChoice({"interface": "kvaser", "channel": "0"}, "test")
    run = BusRun(Plan(RunSpec(start_up=StartUp(attach=True)), load("lvshun_tieshan"), choice, tmp_path))
    with pytest.raises(BusUnavailable, match=r"^bus kvaser:0 cannot be opened: ."):
        run.execute()


@pytest.mark.slow
def test_attach_with_nobody_there(tmp_path):
    """Frames of somebody else on the bus do not keep the wait going."""

    class Chatter:
        counters: dict[str, int] = {}  # noqa: RUF012
        is_down = False
        packed = None
        take_gap_ns = tell_trouble = close = staticmethod(int)

        def receive(self, timeout_s: float) -> list[Frame]:
            return [Frame(0x7FF, b"\0")]

    choice = BusChoice({"interface": "socketcan", "channel": "can0"}, "test")
    spec = RunSpec(start_up=StartUp(attach=True, appear_s=0.3))
    plan = Plan(spec, load("lvshun_tieshan"), choice, tmp_path)
    run = BusRun(plan, open_bus=lambda _config, _name: Chatter())
    result = run.execute()
    assert (result.exit_code, result.frames) == (3, 0)
    assert result.line == "no plant on socketcan:can0 within 0.3 s"


@pytest.mark.slow
@pytest.mark.loop
def test_nodes_that_do_not_agree(tmp_path, socket_folder):
    """A hub, a controller with another scenario, a plant: refused, and everybody says why."""
    channel = str(socket_folder / "hub.sock")
    bus = ("-i", "railhil", "-c", channel)
    hub = Started("bus", "hub", "-c", channel)
    wait_for(lambda: Path(channel).exists())
    try:
        busy = railhil("bus", "hub", "-c", channel)
        assert "is in use by a running hub" in complaint(busy)
        other = "yizhuang_12_ciqu_nan_ciqu"
        plant = Started("node", "plant", *bus)
        controller = Started("node", "controller", other, *bus)
        done = railhil("run", "--attach", "--out", tmp_path / "run", *bus)
        ours, theirs = load("lvshun_tieshan").sha256[:8], load(other).sha256[:8]
        assert f"scenario differs: plant {ours}, controller {theirs}" in complaint(done)
        assert not (tmp_path / "run").exists()
        assert plant.finish()[0].exit_code == 2
        assert controller.finish()[0].exit_code == 0
    finally:
        hub.process.send_signal(signal.SIGTERM)
        assert hub.finish()[0].exit_code == 0


def test_controller_that_is_not_the_one_asked_for(lvshun):
    """Only the supervisor knows what was asked for: the plant has no opinion on the controller's arithmetic."""
    lines: list[str] = []
    session = make_session(lvshun, lines.append, RunSpec())
    node = ControllerNode(lvshun, LawSpec("ipfc", "float64"))
    plant = make_plant_node(lvshun, RunSpec(), LocalBus([node.handle, session.handle]))
    with pytest.raises(Refused):
        plant.run()
    assert session.handshake.disagreements == ["arithmetic differs: controller float64, supervisor iq"]
    assert (session.sim_time_s, session.ended) == (0, Event.ENDED_REFUSED)


def test_a_supervisor_that_takes_the_plant_for_another_pace(lvshun):
    """A realtime run recorded as lockstep would be judged without its jitter."""
    session = make_session(lvshun, lambda line: None, RunSpec())
    node = ControllerNode(lvshun, LawSpec())
    plant = make_plant_node(lvshun, RunSpec(pace="realtime", rate=100.0), LocalBus([node.handle, session.handle]))
    with pytest.raises(Refused, match="pace differs: plant realtime, supervisor lockstep"):
        plant.run()


def test_a_program_that_the_installation_lacks(monkeypatch):
    """The container image leaves the tests out, and the audit with them."""
    monkeypatch.setitem(sys.modules, "railhil.audit", None)
    with pytest.raises(InputError, match=r"^railhil: command: railhil.audit is not part of this inst"):
        outside.become_program(["audit", "lvshun_tieshan"])


# -- logs -------------------------------------------------------------------------------------------------------------


#: Beyond 64 bit of nanoseconds, beyond what Python converts, before the start of the run.
HUGE_STAMPS = ("9223372037.000000", f"{10**30}.000000", f"{'9' * 5000}.000000", "-00000005.000000", "1_000_000.000000")


def test_logs_that_are_none(here, tmp_path):
    whole = log_of(tmp_path, ident_frames()).read_text()
    two_lines = "".join(whole.splitlines(keepends=True)[:2])
    for text, words in (
        (whole[:-9], "my.log: line 3: found '(0.000000) mvb0 "),
        (whole + "garbage line\n", "my.log: line 4: found 'garbage line', allowed candump lines"),
        (whole + "(1.000000) mvb0 118#ZZ R\n", "my.log: line 4: found '(1.000000) mvb0 118#ZZ R'"),
        ("", "my.log: is empty, expected a candump log with at least one frame"),
        ("LOGG\x90\xff", "my.log: after line 0: found b'LOGG\\x90\\xff', allowed a candump log (text)"),
        (two_lines, "my.log: PLT_IDENT: no such telegram"),
        *((whole + f"({stamp}) mvb0 118#00 R\n", f"my.log: line 4: found '({stamp[:9]}") for stamp in HUGE_STAMPS),
    ):
        Path("my.log").write_bytes(text.encode("latin-1"))
        for command in ("score", "plot"):
            assert words in complaint(here(command, "my.log", "--scenario", "lvshun_tieshan"))
    Path("empty").mkdir()
    for name, words in (("nix.log", "does not exist"), ("/dev/null", "no regular file"), ("empty", "empty/frames.log")):
        assert words in complaint(here("score", name))


def test_log_of_something_else(here, tmp_path):
    log = log_of(tmp_path, ident_frames(wire_hash=0xDEADBEEF))
    ours = wire_contract().sha256[:8]
    line = complaint(here("score", log, "--scenario", "lvshun_tieshan"))
    assert f"DBC hash: found 'deadbeef', allowed {ours}" in line
    log = log_of(tmp_path, ident_frames())
    other = "yizhuang_12_ciqu_nan_ciqu"
    line = complaint(here("score", log, "--scenario", other))
    assert f"found '{load('lvshun_tieshan').sha256[:8]}', allowed {load(other).sha256[:8]} ({other})" in line


def test_a_certificate_names_its_run(here, tmp_path):
    log_of(tmp_path, ident_frames())
    (tmp_path / "certificate.json").write_text("{}")
    done = here("score", tmp_path / "certificate.json", "--scenario", "lvshun_tieshan")
    assert (done.exit_code, done.out) == (3, "INVALID: run record_incomplete\n")


def test_certificates_that_do_not_help(here, tmp_path):
    log_of(tmp_path, ident_frames())
    path = tmp_path / "certificate.json"
    for text, words in (
        (None, "does not exist"),
        ('{"scenario": "lvs', "cannot be read"),
        ("\xff", "is not UTF-8"),
        ("[]", "has no JSON object"),
        ("{}", "scenario: missing"),
        ('{"scenario": 3}', "scenario: found 3, allowed a text"),
        ('{"scenario": "lvshun_tieshan", "seed": "7"}', "certificate.json: seed: found '7', allowed a whole number"),
        ('{"scenario": "gone.toml"}', "gone.toml: does not exist"),
        ('{"scenario": "lvshun_tieshan", "frames_sha256": "00"}', "allowed 00 (certificate.json beside it)"),
    ):
        if text is not None:
            path.write_bytes(text.encode("latin-1"))
        assert words in complaint(here("score", tmp_path))
    # With the scenario named, a broken certificate is of no importance; the record itself is incomplete.
    for text in ("{}", "[]", '{"scenario": "lvs'):
        path.write_text(text)
        done = here("score", tmp_path, "--scenario", "lvshun_tieshan")
        assert (done.exit_code, done.out) == (3, "INVALID: run record_incomplete\n")
    assert "SIM_TRUTH: found 0" in complaint(here("plot", tmp_path, "--scenario", "lvshun_tieshan"))


@pytest.mark.parametrize("named", [(), ("--scenario", "lvshun_tieshan")])
def test_score_of_a_killed_run_says_what_killed_it(here, tmp_path, named):
    log = log_of(tmp_path, ident_frames())
    known = {"scenario": "lvshun_tieshan", "verdict": "INVALID", "frames_sha256": sha256_of(log)}
    # What the log says as well is said once.
    for line, shown in (("plant lost: SIGKILL", "; plant lost: SIGKILL\n"), ("run record_incomplete", "\n")):
        (tmp_path / "certificate.json").write_text(json.dumps({**known, "line": line}))
        done = here("score", tmp_path, *named)
        assert (done.exit_code, done.out) == (3, f"INVALID: run record_incomplete{shown}")
