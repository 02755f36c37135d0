"""``railhil doctor``: each finding from a simulated machine made of files, and the command on this machine."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.cli import railhil
from railhil.bus import select
from railhil.bus.can_settings import named_bus
from railhil.bus.transports import HUB_MODEL, limits
from railhil.cli.commands import parser
from railhil.cli.doctor import facts
from railhil.common.scheduling import NODE_PRIORITY
from railhil.judge.jitter import Jitter
from railhil.live.doctor import timing
from railhil.live.doctor.machine import (
    Finding,
    can_interfaces,
    clock,
    docker,
    inspect_cores,
    inspect_governor,
    inspect_host,
    interface,
    join_names,
    kernel_can,
    list_serial_ports,
    run_tool,
    virtual_machine,
)

CLOCK = "sys/devices/system/clocksource/clocksource0"


def put(root: Path, files: dict[str, str]) -> Path:
    """A root of the file system with these files."""
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def can0(root: Path, flags: str = "0x40081", queue: int = 1000, name: str = "can0") -> Path:
    folder = f"sys/class/net/{name}"
    return put(root, {f"{folder}/type": "280\n", f"{folder}/flags": flags, f"{folder}/tx_queue_len": str(queue)})


def linkinfo(state: str = "ERROR-ACTIVE", restart_ms: int = 100, bit_rate: int = 500_000) -> dict[str, Any]:
    data = {"state": state, "restart_ms": restart_ms, "bittiming": {"bitrate": bit_rate}}
    return {"info_kind": "can", "info_data": data}


# -- CAN in the kernel ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("info", "flags", "queue", "found", "advice"),
    [
        (linkinfo(), "0x40081", 1000, "can, up, 500000 bit/s, ERROR-ACTIVE, txqueuelen 1000", ""),
        (linkinfo(), "0x40081", 10, "can, up, 500000 bit/s, ERROR-ACTIVE, txqueuelen 10",
         "sudo ip link set can0 txqueuelen 1000"),
        (linkinfo("BUS-OFF"), "0x40081", 1000, "can, up, 500000 bit/s, BUS-OFF, txqueuelen 1000",
         "sudo ip link set can0 type can restart"),
        (linkinfo(restart_ms=0), "0x40081", 1000,
         "can, up, 500000 bit/s, ERROR-ACTIVE, txqueuelen 1000, no restart after bus-off",
         "sudo ip link set can0 down && sudo ip link set can0 type can restart-ms 100 && sudo ip link set can0 up"),
        (linkinfo(bit_rate=0), "0x40080", 1000, "can, down, txqueuelen 1000",
         "sudo ip link set can0 type can bitrate 500000 up"),
        (linkinfo(), "0x40080", 1000, "can, down, 500000 bit/s, txqueuelen 1000", "sudo ip link set can0 up"),
        ({"info_kind": "vcan"}, "0x80", 1000, "vcan, down, txqueuelen 1000", "sudo ip link set can0 up"),
        ({"info_kind": "vcan"}, "0x81", 1000, "vcan, up, txqueuelen 1000", ""),
        ({}, "0x81", 1000, "CAN, up, txqueuelen 1000", ""),
    ],
)  # fmt: skip
def test_interface(tmp_path: Path, info: dict[str, Any], flags: str, queue: int, found: str, advice: str) -> None:
    root = can0(tmp_path, flags, queue)
    assert interface(root, "can0", lambda name: info) == Finding("interface can0", found, advice)


def test_only_can_interfaces_are_taken(tmp_path: Path) -> None:
    can0(can0(tmp_path), name="vcan1")
    put(tmp_path, {"sys/class/net/eth0/type": "1\n"})
    assert can_interfaces(tmp_path) == ["can0", "vcan1"]


@pytest.mark.parametrize("installed", [True, False])
def test_kernel_without_can(tmp_path: Path, installed: bool) -> None:
    if installed:
        put(tmp_path, {"lib/modules/6.1/modules.dep": "kernel/drivers/net/can/vcan.ko.xz: kernel/net/can/can.ko.xz\n"})
    (found,) = kernel_can(tmp_path, "6.1", lambda: "address family not supported by protocol")
    assert found.found.startswith("no (address family not supported by protocol)")
    assert found.advice.startswith(
        "sudo modprobe vcan && sudo ip link add" if installed else "use the hub, or `railhil"
    )


def test_kernel_with_can_and_no_interface(tmp_path: Path) -> None:
    (found,) = kernel_can(tmp_path, refusal=str)
    assert (found.found, found.advice.startswith("no interface: sudo ip link add dev vcan0")) == ("yes", True)
    assert [item.subject for item in kernel_can(can0(tmp_path), refusal=str)] == ["kernel CAN", "interface can0"]


# -- permissions and kernel -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("granted", "found", "advised"),
    [
        ((45, ""), "permitted at the bench's priorities, up to 45", False),
        ((10, ""), "permitted up to 10 only: hub and nodes share a priority", True),
        ((0, "no CAP_SYS_NICE, rtprio limit 0"), "not permitted (no CAP_SYS_NICE, rtprio limit 0)", True),
    ],
)
def test_fifo(granted: tuple[int, str], found: str, advised: bool) -> None:
    finding = timing.fifo(*granted)
    assert finding.found == found
    assert bool(re.fullmatch(r"echo '\S+ - rtprio 45' \| sudo tee -a /etc/security/limits.conf.*", finding.advice)) is (
        advised
    )


@pytest.mark.parametrize(
    ("runtime", "words", "advised"),
    [
        ("950000", "at most 95% of the time", False),
        ("-1", "a runaway SCHED_FIFO process takes a processor for good", True),
        ("100000", "10% only", True),
        ("", "not known", False),
    ],
)
def test_throttle(tmp_path: Path, runtime: str, words: str, advised: bool) -> None:
    put(tmp_path, {"proc/sys/kernel/sched_rt_runtime_us": runtime, "proc/sys/kernel/sched_rt_period_us": "1000000"})
    finding = timing._throttle(tmp_path)
    assert words in finding.found
    assert bool(finding.advice) is advised


@pytest.mark.parametrize(
    ("files", "version", "begin", "advice"),
    [
        ({"sys/kernel/realtime": "1"}, "#1 SMP PREEMPT_RT", "PREEMPT_RT: latencies have a bound", ""),
        ({}, "#1 SMP PREEMPT_DYNAMIC Debian", "PREEMPT_DYNAMIC, its mode not known (root", "for a bound: a PREEMPT_RT"),
        ({"sys/kernel/debug/sched/preempt": "none voluntary (full)"}, "#1 SMP PREEMPT_DYNAMIC",
         "PREEMPT_DYNAMIC, now full: no bound; the 10 ms loop measures", "for a bound: a PREEMPT_RT"),
        ({"sys/kernel/debug/sched/preempt": "none (voluntary) full"}, "#1 SMP PREEMPT_DYNAMIC",
         "PREEMPT_DYNAMIC, now voluntary: latencies of milliseconds", "kernel parameter preempt=full"),
        ({}, "#1 SMP Debian", "none: latencies of milliseconds", "a kernel with PREEMPT or PREEMPT_RT"),
    ],
)  # fmt: skip
def test_preemption(tmp_path: Path, files: dict[str, str], version: str, begin: str, advice: str) -> None:
    finding = timing.preemption(put(tmp_path, files), version)
    assert finding.found.startswith(begin)
    assert finding.advice.startswith(advice)
    assert bool(finding.advice) is bool(advice)


# -- the machine ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("current", "available", "advice"),
    [
        ("tsc", "tsc hpet", ""),
        ("kvm-clock", "kvm-clock", ""),
        ("hpet", "tsc hpet acpi_pm", f"echo tsc | sudo tee /{CLOCK}/current_clocksource"),
        ("acpi_pm", "acpi_pm", "kernel parameter tsc=reliable, if the processor's counter is steady"),
    ],
)
def test_clock(tmp_path: Path, current: str, available: str, advice: str) -> None:
    files = {f"{CLOCK}/current_clocksource": current, f"{CLOCK}/available_clocksource": available}
    finding = clock(put(tmp_path, files), 60)
    assert finding.found.startswith(f"{current}, resolution 1 ns, a look at it costs 60 ns")
    assert finding.advice == advice


def test_processors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put(tmp_path, {"sys/devices/system/cpu/isolated": "2-3\n"})
    monkeypatch.setattr("os.cpu_count", lambda: 8)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {2, 3})
    assert inspect_cores(tmp_path) == Finding("processors", "2 of 8 may be used, isolated: 2-3")
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {2})
    assert inspect_cores(tmp_path).advice.startswith("two or more")


def test_governor(tmp_path: Path) -> None:
    assert inspect_governor(tmp_path) == []
    path = "sys/devices/system/cpu/cpu{}/cpufreq/scaling_governor"
    put(tmp_path, {path.format(0): "performance\n"})
    assert inspect_governor(tmp_path) == [Finding("frequency", "governor performance")]
    put(tmp_path, {path.format(1): "powersave\n"})
    advice = "sudo cpupower frequency-set -g performance"
    assert inspect_governor(tmp_path) == [Finding("frequency", "governor performance, powersave", advice)]


@pytest.mark.parametrize(
    ("files", "subjects"),
    [
        ({"proc/cpuinfo": "flags : fpu tsc"}, []),
        ({"proc/cpuinfo": "flags : fpu hypervisor"}, ["virtual machine"]),
        ({".dockerenv": ""}, ["container"]),
        ({"proc/1/cgroup": "0::/kubepods/x"}, ["container"]),
    ],
)
def test_what_is_below(tmp_path: Path, files: dict[str, str], subjects: list[str]) -> None:
    assert [finding.subject for finding in inspect_host(put(tmp_path, files))] == subjects


# -- lateness, tools --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("priority", "virtual", "p99_ms", "max_ms", "advice"),
    [
        (0, True, 1.0, 3.0, ""),
        (0, True, 1.1, 3.0, "p99 above 1 ms: fewer other processes, or SCHED_FIFO"),
        (NODE_PRIORITY, True, 0.3, 5.0, ""),
        (NODE_PRIORITY, True, 0.31, 5.0, "p99 above 0.3 ms: a PREEMPT_RT kernel"),
        (NODE_PRIORITY, True, 0.1, 5.1, "most likely stopped by the host: give the virtual machine whole processors"),
        (NODE_PRIORITY, False, 0.1, 5.1, "a driver, another realtime process or the firmware (SMI): a PREEMPT_RT"),
    ],
)
def test_lateness_is_judged(priority: int, virtual: bool, p99_ms: float, max_ms: float, advice: str) -> None:
    finding = timing.judge(Jitter(200, 0.05, p99_ms, p99_ms, max_ms, 0.0), priority, virtual)
    assert finding.advice.startswith(advice)
    assert bool(finding.advice) is bool(advice)
    assert f"p99 {p99_ms:.3f} ms, max {max_ms:.3f} ms late" in finding.found


def test_lateness_is_measured() -> None:
    jitter = timing.measure(0, cycles=3)
    assert (jitter.cycles, jitter.max_ms > 0) == (3, True)


def test_serial_ports(tmp_path: Path) -> None:
    assert list_serial_ports(tmp_path)[0].found.startswith("none ")
    put(tmp_path, {f"dev/ttyACM{number}": "" for number in range(6)})
    found = list_serial_ports(tmp_path)[0].found
    assert found == "/dev/ttyACM0, /dev/ttyACM1, /dev/ttyACM2, /dev/ttyACM3 and 2 more (`-i slcan -c PORT -b 500000`)"
    assert join_names(["a"]) == "a"


def test_tools(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert virtual_machine("").advice == "sudo apt install dpkg util-linux"
    assert docker() == Finding("docker", "not installed", "sudo apt install docker.io docker-compose")
    for name, script in {"docker": "exit 1", "dpkg-deb": "", "setpriv": ""}.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / name).chmod(0o755)
    assert virtual_machine("").advice == ""
    assert docker().found == "installed, no engine answers"
    (tmp_path / "docker").write_text("#!/bin/sh\necho 27.1\n")
    assert docker() == Finding("docker", "engine 27.1 with compose")
    assert run_tool("no-such-tool-here") is None


@pytest.mark.parametrize(
    ("words", "vcan", "begin"),
    [
        ([], False, "railhil:pipes ("),
        ([], True, "socketcan:vcan0 ("),
        (["-i", "railhil", "-c", "/tmp/x.sock"], False, "railhil:/tmp/x.sock ("),
    ],
)
def test_the_bus_is_the_one_that_a_run_gets(
    words: list[str], vcan: bool, begin: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(select, "vcan_available", lambda: vcan)
    given = named_bus(parser(["doctor"]).parse_args(["doctor", *words]))
    said = facts(given, select.choose_bus(given))["bus"]
    assert said.startswith(begin)
    assert ("user-space hub" in said) == (begin == "railhil:pipes (")


# -- the command ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_every_finding_stands_in_text_and_json() -> None:
    done = railhil("doctor", "--quick", "--json")
    assert done.exit_code == 0
    assert done.json["limits"] == limits()
    assert done.json["hub"] == [row._asdict() for row in HUB_MODEL]
    subjects = [item["subject"] for item in done.json["findings"]]
    assert {"kernel CAN", "SCHED_FIFO", "locked memory", "throttle", "preemption", "clock", "processors"} <= set(
        subjects
    )
    assert {"serial ports", "railhil vcan", "docker"} <= set(subjects)
    assert "10 ms loop" not in subjects
    text = railhil("doctor", "--quick").out
    words = " ".join(text.split())
    for row in HUB_MODEL:
        assert f"{row.subject} " in words
        assert row.without.split()[0] in words
    for item in done.json["findings"]:
        assert f"\n{item['subject']:18} " in text
        assert not item["advice"] or f"-> {item['advice']}\n" in text


@pytest.mark.slow
def test_a_bus_that_cannot_be_opened_is_exit_code_2(tmp_path: Path) -> None:
    patience = ("--bus-kwargs", "connect_timeout=0.2")
    done = railhil("doctor", "--quick", "--json", "-i", "railhil", "-c", tmp_path / "no.sock", *patience)
    assert done.exit_code == 2
    asked = json.loads(done.out)["findings"][-1]
    assert asked["subject"] == "bus asked for"
    assert "cannot be opened" in asked["found"]
    # Its driver library is not there, and python-can does not raise an error of its own for that.
    kvaser = railhil("doctor", "--quick", "-i", "kvaser", "-c", "0")
    (line,) = (line for line in kvaser.out.splitlines() if line.startswith("bus asked for"))
    assert (kvaser.exit_code, "bus kvaser:0 cannot be opened" in line) == (2, True)
    assert "Traceback" not in kvaser.err
    assert railhil("doctor", "--quick", "-i", "virtual", "-c", "x").out.count("virtual:x can be opened") == 1


@pytest.mark.parametrize("given", ["-c x", "-b 5"])
def test_a_channel_without_an_interface_is_one_line(given: str) -> None:
    done = railhil("doctor", "--quick", *given.split())
    line = f"railhil: command line: --interface: only {given}, expected -i INTERFACE beside it, or can.rc\n"
    assert (done.exit_code, done.out, done.err) == (2, "", line)
