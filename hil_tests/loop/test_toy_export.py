"""``railhil export-c`` of a plug-in system: its law as C, which computes the same numbers as the bench's on a real run.

Nothing in the tree refers to the system: the export knows it only through its ``Interface``.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from hil_tests.support.toy_export import KEEPING, PLAIN_FORCES, changed, export
from hil_tests.support.toy_system import SCENARIO, install_toy, railhil

pytestmark = [pytest.mark.loop, pytest.mark.slow, pytest.mark.needs_compiler]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_toy(tmp_path_factory.mktemp("toy"))


@pytest.fixture(scope="module")
def exported(site: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("c") / "apart"
    export(site, folder)
    return folder


def make(folder: Path, *targets: str) -> subprocess.CompletedProcess[str]:
    """Run ``make`` in the folder; tests use a copy of the export, which they share."""
    return subprocess.run(["make", *targets], cwd=folder, capture_output=True, text=True, timeout=120, check=False)


def rows(folder: Path) -> tuple[list[str], list[dict[str, int]]]:
    """Names of the log's words, and the log by these names."""
    lines = (folder / "apart_log.txt").read_text(encoding="ascii").splitlines()
    heads = [line for line in lines if line.startswith("#")]
    names = heads[-1].split()[1:]
    words = [[int(word, 16) for word in line.split()] for line in lines[len(heads) :]]
    return names, [dict(zip(names, (word - (word >> 31 << 32) for word in line), strict=True)) for line in words]


@pytest.mark.long_after(1)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_every_word_of_the_reference_log_comes_out_of_the_c(exported: Path, tmp_path: Path, compiler: str) -> None:
    copy = tmp_path / "c"
    shutil.copytree(exported, copy)
    done = make(copy, "check", "ubsan", f"CC={compiler}")
    assert done.returncode == 0, done.stdout + done.stderr
    _, log = rows(exported)
    assert done.stdout.count(f"{len(log)} control periods identical, 9 words each") == 2


def test_readings_commands_and_notes_have_the_names_of_the_interface(exported: Path) -> None:
    header = (exported / "apart.h").read_text(encoding="ascii")
    assert "void apart_inputs(int32_t position_0, int32_t position_1, apart_in_t *in, iq_events_t *events);" in header
    assert "void apart_sent(apart_state_t *state, int32_t force_0, int32_t force_1);" in header
    assert "force_1: UNIT2_CMD force_001n, -2000 to 2000, safe 0" in header
    assert "#define APART_STRETCH(out) iq_max(INT32_C(-8388608)" in header
    assert re.findall(r"int32_t (\w+); /\* Q0, 0.01 N \*/", header) == ["force_0", "force_1"]
    names, _ = rows(exported)
    assert names[:5] == ["flags", "position_0", "position_1", "sent.force_0", "sent.force_1"]
    text = "".join(path.read_text(encoding="ascii") for path in exported.iterdir())
    for foreign in ("notch", "balise", "CTL_STAT", "TRN_SPEED", "odometer"):
        assert foreign not in text


def test_the_log_begins_with_a_run_of_the_bench(site: Path, exported: Path, tmp_path: Path) -> None:
    """Its readings are those on the bus, its commands those sent in the same run."""
    done = railhil(site, "run", str(SCENARIO), "--bus", "local", "--out", str(tmp_path / "run"), "--no-report")
    assert done.returncode == 0, done.stderr
    sent: dict[str, list[int]] = {"110": [], "128": []}
    for line in (tmp_path / "run" / "frames.log").read_text(encoding="ascii").splitlines():
        can_id, _, data = line.split()[2].partition("#")
        if can_id in sent:
            size = 3 if can_id == "110" else 2
            sent[can_id].append(int.from_bytes(bytes.fromhex(data)[:size], signed=True))
    _, log = rows(exported)
    begins = [index for index, row in enumerate(log) if row["flags"] & 1]
    run = log[: begins[1]]
    assert len(begins) == 3
    assert len(run) == 121
    # A control period has ten ticks, each with readings, and five polls of each command.
    assert [row["position_0"] for row in run] == sent["110"][::10]
    assert [row["out.force_1"] for row in run] == sent["128"][::5][: len(run)]


def test_mailboxes_are_those_of_the_systems_own_ports(exported: Path, tmp_path: Path) -> None:
    copy = tmp_path / "c"
    shutil.copytree(exported, copy)
    assert make(copy, "all").returncode == 0
    found = subprocess.run([copy / "apart_run", "mailboxes"], capture_output=True, text=True, check=True).stdout
    received = [line.split()[1] for line in found.splitlines() if "receive" in line]
    answered = {line.split()[1] for line in found.splitlines() if "transmit" in line}
    assert received == ["0x110", "0x118", "0x100", "0x104", "0x160", "0x161", "0x164", "0x80"]
    assert answered == {"0x120", "0x128", "0x138", "0x13C", "0x170", "0x171", "0x174", "0x88"}


def test_a_change_of_the_c_is_noticed(exported: Path, tmp_path: Path) -> None:
    copy = tmp_path / "c"
    shutil.copytree(exported, copy)
    source = copy / "apart.c"
    text = source.read_text(encoding="ascii")
    changed, constants = re.subn(
        r"(APART_STIFFNESS = INT32_C\()(\d+)", lambda found: f"{found[1]}{int(found[2]) + 16}", text
    )
    assert constants == 1
    source.write_text(changed, encoding="ascii")
    done = make(copy, "check")
    assert done.returncode != 0
    assert "in the log" in done.stdout


def test_parameters_and_settings_change_the_constants(site: Path, exported: Path, tmp_path: Path) -> None:
    soft = tmp_path / "soft.toml"
    soft.write_text('law = "apart"\n[parameters]\nstiffness_n_per_m = 3.0\n', encoding="utf-8")
    folder = tmp_path / "c"
    export(site, folder, "--parameters", str(soft), "--set", "task.target_m=[1.5, 1.0]")
    text = (folder / "apart.c").read_text(encoding="ascii")
    assert "APART_STIFFNESS = INT32_C(31457); /* 0.03, Q20, parameters */" in text
    assert "APART_TARGET_0 = INT32_C(15000)" in text
    assert make(folder, "check").returncode == 0
    # Exporting again over the existing files gives the same bytes.
    shutil.copytree(exported, tmp_path / "again")
    export(site, tmp_path / "again", "--force")
    for path in exported.iterdir():
        assert (tmp_path / "again" / path.name).read_bytes() == path.read_bytes()


def test_the_law_is_told_every_command_that_was_sent(site: Path, tmp_path: Path) -> None:
    """A law that keeps the commands sent: checked in the words of the log, and in the C."""
    folder = tmp_path / "c"
    export(changed(site, tmp_path, {"laws.py": KEEPING, "wire.py": PLAIN_FORCES}), folder)
    assert make(folder, "check").returncode == 0
    _, log = rows(folder)
    told = [row for row in log if row["flags"] & 2]
    assert len(told) > 10
    for row in told:
        assert (row["state.sent_0"], row["state.sent_1"]) == (row["sent.force_0"], row["sent.force_1"])


def test_a_law_that_could_wrap_is_refused(site: Path, tmp_path: Path) -> None:
    old, new = "ar.clip(reading, *self._far)", "ar.mpy(reading, self._far[0], 0)"
    copy = changed(site, tmp_path, {"laws.py": [(old, new)]})
    done = railhil(copy, "export-c", "apart", str(SCENARIO), "--out", str(tmp_path / "c"))
    assert done.returncode == 2
    assert "expected a law whose fixed point cannot wrap at 0.1 s on two_carts_2m" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "c").exists()


def test_a_reading_that_no_int32_holds_is_refused(site: Path, tmp_path: Path) -> None:
    """``run`` refuses it too: Python's unlimited integers would hide the chip's overflow."""
    own = "from railhil.controller_node.vector.law"
    changes = [
        ("    readings=tuple(\n", '    readings=(Reading("seconds", TimeSync, "seconds_s"),) + tuple(\n'),
        (own, f"from railhil.bus.telegrams import TimeSync\n{own}"),
    ]
    copy = changed(site, tmp_path, {"wire.py": changes})
    for words in (("export-c", "apart"), ("run", "--bus", "local")):
        done = railhil(copy, *words, str(SCENARIO), "--out", str(tmp_path / "c"))
        assert done.returncode == 2
        assert "reading seconds: TIME_SYNC.seconds_s with 0 to 4294967295, expected -2147483648" in done.stderr
        assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("apart", str(SCENARIO), "--indexing", "distance"), "--indexing: found 'distance', allowed time with system"),
        (("ipfc", str(SCENARIO)), "controller: name: found 'ipfc', allowed one of apart"),
        (("apart",), "controller: name: found 'apart', allowed one of ipfc"),
    ],
    ids=["indexing", "law of another system", "scenario of another system"],
)
def test_bad_input_is_one_line(site: Path, words: tuple[str, ...], said: str, tmp_path: Path) -> None:
    done = railhil(site, "export-c", *words, "--out", str(tmp_path / "c"))
    assert done.returncode == 2
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "c").exists()


def test_a_system_without_interface_says_what_it_lacks(site: Path, tmp_path: Path) -> None:
    copy = changed(site, tmp_path, {"__init__.py": [('    interface="two_carts.wire:INTERFACE",\n', "")]})
    done = railhil(copy, "export-c", "apart", str(SCENARIO), "--out", str(tmp_path / "c"))
    assert done.returncode == 2
    assert "system two_carts: interface: no such part" in done.stderr
