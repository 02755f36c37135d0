"""``railhil vcan``: its messages when it is not possible; a namespace passes everything on and leaves nothing
behind."""

from __future__ import annotations

import multiprocessing
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

import pytest

from hil_tests.machines import kinds
from hil_tests.machines.bytecode import compile_by
from hil_tests.support.cli import wait_for
from railhil.machines import debian, namespace, vcan, vcan_vm
from railhil.machines.vm_image import USER_MODE, Kind, VmImage, too_large_for

_FAMILY = OSError(97, "Address family not supported by protocol")


def namespaces_permitted() -> bool:
    user = [] if os.geteuid() == 0 else ["-r"]
    return subprocess.run(["unshare", "-n", *user, "true"], capture_output=True, check=False).returncode == 0


needs_namespaces = pytest.mark.skipif(not namespaces_permitted(), reason="MISSING CAPABILITY network namespaces")


@pytest.fixture
def no_machine(monkeypatch):
    def refuse(_: object) -> None:
        raise debian.CapabilityError("a virtual machine needs Debian")

    monkeypatch.setattr(vcan_vm, "ensure_machine", refuse)


@pytest.fixture
def no_can(monkeypatch):
    def refuse(*_: object) -> None:
        raise _FAMILY

    monkeypatch.setattr(socket, "socket", refuse)


@pytest.mark.parametrize(
    ("via", "named"),
    [
        ([], ["neither a namespace", "no CAN sockets", "modprobe", "nor a virtual machine", "needs Debian"]),
        (["--via", "namespace"], ["no CAN sockets", "linux-modules-extra"]),
        (["--via", "machine"], ["needs Debian"]),
        (["--via", "user-mode"], ["needs Debian"]),
    ],
)
def test_what_was_tried_stands_in_one_line(no_can, no_machine, capsys, via, named):
    assert vcan.main([*via, "--", "true"]) == debian.EXIT_NO_CAPABILITY
    captured = capsys.readouterr()
    assert captured.out == ""
    assert len(captured.err.splitlines()) == 1
    assert [word for word in named if word not in captured.err] == []


def booting(words: Sequence[str], monkeypatch) -> Kind:
    """A kind of machine whose command line is a script; it needs no image."""
    monkeypatch.setattr(vcan_vm, "ensure_machine", lambda kind: VmImage(Path("kernel"), Path("initrd")))
    return Kind("a script", USER_MODE.recipe, {}, lambda boot: [*words, str(boot.control)])


def test_a_machine_that_does_not_boot_gives_way_to_the_next(monkeypatch, capfd):
    bad = booting(["sh", "-c", "echo ptrace: not permitted", "sh"], monkeypatch)
    good = booting(["sh", "-c", "cd $0; touch began; echo 7 >exit_code"], monkeypatch)
    failed = booting(["sh", "-c", "cd $0; touch began; echo panic"], monkeypatch)

    def run(kind: Kind) -> int:
        return vcan_vm.run(kind, ["true"])

    assert vcan_vm.first_that_boots(run, [bad, good]) == 7
    with pytest.raises(debian.MachineError, match="without an exit code: ptrace: not permitted"):
        vcan_vm.first_that_boots(run, [bad])
    # The command may have done something: it is not run again.
    with pytest.raises(debian.MachineError, match="panic"):
        vcan_vm.first_that_boots(run, [failed, good])
    assert capfd.readouterr().out == ""


def test_a_kind_that_this_processor_cannot_have_gives_way_without_being_installed(monkeypatch):
    monkeypatch.setattr(debian, "require_debian", lambda purpose: None)
    monkeypatch.setattr(vcan_vm, "ensure_image", lambda recipe: VmImage(Path("kernel"), Path("initrd")))
    no = Kind(
        "a large one", USER_MODE.recipe, {"no-such-command": "no-such-package"}, lambda _: [], lambda: "too large"
    )
    yes = Kind("a small one", USER_MODE.recipe, {}, lambda _: [])
    assert kinds.first_available({"no": no, "yes": yes}) == "yes"
    with pytest.raises(debian.CapabilityError, match=r"^a large one: too large$"):
        kinds.first_available({"no": no})


@pytest.mark.parametrize(
    ("flags", "able"), [("fpu avx512f avx512vl pku", True), ("fpu avx512f amx_bf16 amx_tile amx_int8", False)]
)
def test_the_user_mode_kernel_is_not_tried_on_a_processor_with_tiles(flags, able):
    said = too_large_for(f"processor\t: 0\nflags\t\t: {flags}\nbugs\t\t: amx_tile\n")
    assert ("AMX" not in said) is able
    assert too_large_for("") == ""


@pytest.mark.slow
@pytest.mark.timeout(240)
@pytest.mark.long_after(1)
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_nothing_of_a_machine_outlives_the_command(tmp_path, number):
    try:
        kind = kinds.first_available()
    except debian.CapabilityError as error:
        pytest.skip(f"MISSING CAPABILITY virtual machine: {error}")
    if kind != "user-mode":
        warnings.warn(f"MISSING CAPABILITY user-mode kernel: {USER_MODE.unable()}; seen with: {kind}", stacklevel=1)
    (tmp_path / "runs").mkdir()
    words = [sys.executable, "-m", "railhil.cli", "vcan", "--via", kind, "--ram", "256", "--processors", "1", "--"]
    command = subprocess.Popen([*words, "sh", "-c", "touch runs/began; sleep 60"], cwd=tmp_path, stderr=subprocess.PIPE)
    # The emulated machine takes 13 s to boot when nothing else runs.
    wait_for((tmp_path / "runs/began").exists, 30 if kind == "user-mode" else 170)

    def machines() -> set[str]:
        """Control folders of all machines: they are named on the command line."""
        args = subprocess.run(["ps", "-eww", "-o", "args"], capture_output=True, text=True, check=True).stdout
        return set(re.findall(r"/[^\s,=]*railhil-vm-\w+", args))

    def own(control: str) -> bool:
        command = Path(control, "command")
        return command.exists() and str(tmp_path) in command.read_text()

    (control,) = filter(own, machines())
    command.send_signal(number)
    command.communicate()
    wait_for(lambda: control not in machines())
    if number == signal.SIGKILL:
        shutil.rmtree(control)
    assert not Path(control).exists()


@needs_namespaces
def test_kernel_that_knows_can_but_not_vcan_says_so(monkeypatch):
    monkeypatch.setattr(namespace, "_require_can", lambda: None)
    monkeypatch.setattr(namespace, "_prepared", lambda *_: ["sh", "-c", "echo Error: Unknown device type. >&2; exit 2"])
    with pytest.raises(debian.CapabilityError, match=r"Unknown device type \(modprobe vcan, or apt install"):
        namespace.require_namespace(["vcan0"])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "command"),
        (["--interfaces", "vcan0,", "--", "true"], "found 'vcan0,', allowed: different interface names"),
        (["--interfaces", "a;reboot", "--", "true"], "found 'a;reboot'"),
        (["--interfaces", "vcan0,vcan0", "--", "true"], "found 'vcan0,vcan0'"),
        (["--share", "/no/such", "--", "true"], "found /no/such, allowed: a folder that is there"),
        (["--via", "hope", "--", "true"], "found hope, allowed namespace, "),
        (["--timeout", "0", "--", "true"], "found 0, allowed 1 to 86400 s"),
        (["--ram", "12", "--", "true"], "found 12, allowed 256..1048576"),
        (["--processors", "0", "--", "true"], "found 0, allowed 1..16"),
    ],
)
def test_wrong_command_line_is_one_line(capsys, words, said):
    with pytest.raises(SystemExit) as ended:
        vcan.main(words)
    assert ended.value.code == 2
    captured = capsys.readouterr()
    assert (captured.out, len(captured.err.splitlines())) == ("", 1)
    assert said in captured.err


def test_results_are_kept_and_an_empty_folder_is_not_left_behind(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with vcan._kept_folders(None) as folders:
        assert [path.is_dir() for path in folders] == [True]
    assert not (tmp_path / "runs").exists()
    with vcan._kept_folders(None) as folders:
        (folders[0] / "result").touch()
    assert (tmp_path / "runs/result").exists()
    with vcan._kept_folders([tmp_path]) as folders:
        assert folders == [tmp_path]


# -- a namespace without CAN, which any Linux has -----------------------------------------------------------------


def in_namespace(command: Sequence[str], **options: float) -> int:
    return namespace.run(command, (), environment=dict(os.environ), **options)


def alive(pid_file: Path) -> bool:
    return Path(f"/proc/{pid_file.read_text().strip()}").exists()


@needs_namespaces
def test_exit_code_output_and_interfaces(tmp_path, capfd):
    assert in_namespace(["sh", "-c", f"ip -o link | wc -l; pwd > {tmp_path}/where; exit 7"]) == 7
    assert capfd.readouterr().out == "1\n"
    assert (tmp_path / "where").read_text() == f"{Path.cwd()}\n"
    assert in_namespace(["sh", "-c", "kill -KILL $$"]) == 128 + signal.SIGKILL
    with pytest.raises(debian.MachineError, match="no command nosuch"):
        in_namespace(["nosuch"])


@needs_namespaces
@pytest.mark.parametrize("ends", ["by itself", "by the time-out"])
def test_what_the_command_leaves_running_is_ended(tmp_path, ends):
    left = tmp_path / "left"
    script = f"setsid sleep 600 & echo $! > {left}; "
    if ends == "by itself":
        assert in_namespace(["sh", "-c", script]) == 0
    else:
        assert in_namespace(["sh", "-c", script + "sleep 600"], timeout_s=1.0) == debian.EXIT_TIMEOUT
    assert not alive(left)


@needs_namespaces
def test_children_of_the_caller_are_left_alone(tmp_path):
    """A process of the caller's own, one that has ended and waits to be reaped, and an orphan of another child."""
    orphan = tmp_path / "orphan"
    mine = subprocess.Popen(["sleep", "600"])
    ended = subprocess.Popen(["true"])
    parent = subprocess.Popen(["sh", "-c", f"sleep 600 & echo $! > {orphan}; read _"], stdin=subprocess.PIPE)
    try:
        wait_for(orphan.exists)
        # The other child ends while the command runs.
        assert in_namespace(["sh", "-c", f"kill {parent.pid}"]) == 0
        assert (mine.poll(), ended.wait(5.0), alive(orphan)) == (None, 0, True)
    finally:
        for process in (mine, parent):
            process.kill()
            process.communicate()
        os.kill(int(orphan.read_text()), signal.SIGKILL)


@needs_namespaces
@pytest.mark.parametrize(
    ("trap", "rest", "number", "code"),
    [
        ("true", "sleep 600", signal.SIGTERM, 128 + signal.SIGTERM),
        ("trap 'exit 9' INT", "while :; do sleep 0.01; done", signal.SIGINT, 9),
    ],
)
def test_signals_are_passed_on_and_the_whole_tree_ends(tmp_path, trap, rest, number, code):
    left = tmp_path / "left"
    script = f"setsid sleep 600 & {trap}; echo $! > {left}.new; mv {left}.new {left}; {rest}"
    process = multiprocessing.get_context("fork").Process(target=lambda: os._exit(in_namespace(["sh", "-c", script])))
    process.start()
    wait_for(left.exists)
    os.kill(process.pid, number)
    process.join(20.0)
    assert (process.exitcode, alive(left)) == (code, False)


# -- modules compiled for a machine -------------------------------------------------------------------------------


def test_modules_are_compiled_into_the_cache_and_found_there_even_where_writing_them_is_forbidden(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("RAILHIL_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setenv("PYTHONPYCACHEPREFIX", "")
    (tmp_path / "mine.py").write_text("print(__cached__)")
    monkeypatch.chdir(tmp_path)
    done = compile_by([sys.executable, "-c", "import mine"])
    made = Path(done.stdout.strip())
    assert made.is_relative_to(tmp_path / "cache")
    assert made.is_file()
    # What is started from here finds it: a text of the same time and length is not looked at.
    times = (tmp_path / "mine.py").stat()
    (tmp_path / "mine.py").write_text("print(not_here__)")
    os.utime(tmp_path / "mine.py", ns=(times.st_atime_ns, times.st_mtime_ns))
    found = subprocess.run([sys.executable, "-c", "import mine"], capture_output=True, text=True, check=True)
    assert found.stdout == done.stdout
