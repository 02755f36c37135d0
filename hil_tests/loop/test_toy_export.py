"""``railhil export-c`` of a plug-in system: its law as C, which computes the same numbers as the bench's on a real run.

Nothing in the tree refers to the system: the export knows it only through its ``Interface``.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from hil_tests.support.foreign import PROGRAM_INTERFACE, SANITIZED, build, foreign_run
from hil_tests.support.toy_system import SCENARIO, install_toy, railhil

pytestmark = [pytest.mark.loop, pytest.mark.needs_compiler]


#: The Python node and the C on the same frames of a bus that loses, damages, doubles, delays and repeats some frames
#: and falsifies the check variable of others. Each cart is silent for a while (the first one's port is the clock port),
#: then stuck, then invalid. Prints the number of answers, and run event and counters of each controller.
_TWINS = """
import json, random, sys
from pathlib import Path
from hil_tests.support.foreign import PORTABLE_INTERFACE, CNode
from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.local import LocalBus
from railhil.bus.mvb import check_sequence
from railhil.controller_node.vector.node import VectorNode
from railhil.plant_sim.node import PlantNode
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.supervisor.session import Session
scenario, seed = load_any(sys.argv[1]), int(sys.argv[3])
spec = RunSpec(law=LawSpec("apart"), seed=seed, perturbed=bool(seed))
node, c = VectorNode(scenario, spec.law), CNode(Path(sys.argv[2]), "apart", PORTABLE_INTERFACE)
session = Session(scenario, lambda line: None, spec)
number, polls, answers, late = random.Random(seed), 0, 0, []
silent = {0x118: range(200, 350), 0x110: range(400, 550), 0x100: range(300, 450)}
stuck = {0x118: range(600, 700), 0x110: range(750, 850)}
invalid = {0x118: range(900, 1000), 0x110: range(1050, 1150)}
sent = {port: [] for port in stuck}
def with_check(frame, check):
    data = frame.data[:3] + bytes([frame.data[3] & 0x3F | check << 6])
    return frame._replace(data=data + bytes([check_sequence(data)]) + frame.data[5:])
def wire(frame):
    global polls, late
    due, late = late, []
    polls += frame.can_id == 0x080
    if not seed or frame.can_id == 0x080 or frame.can_id >= 0x160:
        return [*due, frame]
    if polls in silent.get(frame.can_id, ()):
        return due
    if frame.can_id in sent:
        before = sent[frame.can_id]
        if polls in stuck[frame.can_id]:
            return [*due, before[-1]]
        if polls in invalid[frame.can_id]:
            return [*due, with_check(frame, 0)]
        before.append(frame)
        kind = number.randrange(30)
        if kind < 2:
            return [*due, before[-min(len(before), 2 + 2 * kind)]]
        if kind == 2:
            check = number.choice([value for value in range(4) if value != CHECK_CORRECT])
            return [*due, with_check(frame, check)]
    kind = number.randrange(20)
    if kind == 0:
        return due
    if kind == 1:
        return [*due, frame, frame]
    if kind == 2:
        bits = int.from_bytes(frame.data) ^ 1 << number.randrange(64)
        return [*due, frame._replace(data=bits.to_bytes(8))]
    if kind == 3:
        late = [frame]
        return due
    return [*due, frame]
def both(frame):
    global answers
    found = []
    for item in wire(frame):
        ours, theirs = node.handle(item), c.handle(item)
        assert ours == theirs, f"{item} at {answers} answers: {ours} {theirs}"
        answers += bool(ours)
        found += ours
    return found
PlantNode(scenario, spec, LocalBus([both, session.handle])).run()
counters = {cause: count for cause, count in node.counters.items() if cause != "unknown_id"}
print(json.dumps([answers, int(node.ended), c.ended, counters, c.counters]))
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_toy(tmp_path_factory.mktemp("toy"))


@pytest.fixture(scope="module")
def exported(site: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("c") / "apart"
    export(site, folder)
    return folder


def export(site: Path, folder: Path, *words: str) -> str:
    """Export into the folder; returns the output of the command."""
    done = railhil(site, "export-c", "apart", str(SCENARIO), "--out", str(folder), *words)
    assert done.returncode == 0, done.stderr
    return done.stdout


def changed(site: Path, folder: Path, changes: Mapping[str, Sequence[tuple[str, str]]]) -> Path:
    """A copy of the toy system with text replaced in some of its files."""
    copy = folder / "site"
    shutil.copytree(site, copy)
    for file, pairs in changes.items():
        path = copy / "two_carts" / file
        text = path.read_text(encoding="utf-8")
        for old, new in pairs:
            assert old in text
            text = text.replace(old, new)
        path.write_text(text, encoding="utf-8")
    return copy


#: A law that keeps the commands sent and reports the first of them in its note.
KEEPING = (
    ("    position: tuple[Any, ...]\n", "    position: tuple[Any, ...]\n    sent: tuple[Any, ...]\n"),
    (
        "return State(tuple(self._ar.clip(reading, *self._far) for reading in readings))",
        "position = tuple(self._ar.clip(reading, *self._far) for reading in readings)\n"
        "        return State(position, position)\n\n"
        "    def with_sent(self, state: State, commands: Sequence[T]) -> State:\n"
        "        return State(state.position, tuple(commands))",
    ),
    ("return State(position), Answer", "return State(position, tuple(forces)), Answer"),
    ("forces.append(ar.note(f", "forces.append(ar.quantise(force, FORCE_Q, 0))\n            ar.note(f"),
    ('FORCE_Q, "0.01 N"))', 'FORCE_Q, "0.01 N")'),
    ("Answer(tuple(forces), (ar.sub(position[1], position[0]),))", "Answer(tuple(forces), (state.sent[0],))"),
)
#: Its outputs have the format of the commands sent.
PLAIN_FORCES = (('"force_001n", FORCE_Q,', '"force_001n", 0,'),)
#: Signals that begin and end inside octets.
CROOKED = (
    ('"{p}Pos", at = "0.7:24"', '"{p}Pos", at = "0.4:21"'),
    ('"{p}Force", at = "0.7:16"', '"{p}Force", at = "0.2:13"'),
    ('"LawStretch", at = "0.7:24"', '"LawStretch", at = "0.6:21"'),
    ('"LawFlags", at = "3.7:8"', '"LawFlags", at = "3.4:7"'),
    ('"LawSteps", at = "4.7:16"', '"LawSteps", at = "4.4:16"'),
)


#: Telegrams with readings that have no check variable and no field named ``life``.
UNGUARDED = {
    "wire.py": [
        (
            '    check: int = signal("{p}Chk", CHECK_CORRECT)\n    life: int = signal("{p}Life")',
            '    n: int = signal("{p}Life")',
        )
    ],
    "ports.toml": [('  { name = "{p}Chk", at = "3.7:2", check = "chk" },\n', "")],
    "plant.py": [("life=self.next_life(STATS[unit].PORT)", "n=self.next_life(STATS[unit].PORT)")],
}


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
    done = railhil(site, "run", str(SCENARIO), "--bus", "local", "--out", str(tmp_path / "run"), "--quiet")
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
    assert "allowed a law whose fixed point cannot wrap at 0.1 s on two_carts_2m" in done.stderr
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
    for words in (("export-c", "apart"), ("run",)):
        done = railhil(copy, *words, str(SCENARIO), "--out", str(tmp_path / "c"))
        assert done.returncode == 2
        assert "reading seconds: found TIME_SYNC.seconds_s with 0 to 4294967295, allowed -2147483648" in done.stderr
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
    copy = changed(site, tmp_path, {"__init__.py": [(', "interface": "two_carts.wire:INTERFACE"', "")]})
    done = railhil(copy, "export-c", "apart", str(SCENARIO), "--out", str(tmp_path / "c"))
    assert done.returncode == 2
    assert "system two_carts: interface: found no such part" in done.stderr


# -- the controller around the law ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def run_folder(site: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of the Python node in this process."""
    folder = tmp_path_factory.mktemp("runs") / "ours"
    done = railhil(site, "run", str(SCENARIO), "--bus", "local", "--out", str(folder), "--quiet", "--no-report")
    assert done.returncode == 0, done.stderr
    return folder


def test_the_c_node_over_the_hub_gives_the_bytes_of_our_own(
    site: Path, exported: Path, run_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = tmp_path / "c"
    shutil.copytree(exported, copy)
    program = build(copy, ["apart.c", *PROGRAM_INTERFACE], "node", SANITIZED)
    monkeypatch.setenv("PYTHONPATH", str(site))
    run = foreign_run(program, tmp_path / "hub", tmp_path / "run", str(SCENARIO))
    assert run.done.exit_code == 0, run.done.err
    assert run.exit_code == 0, run.said
    assert "121 control periods, run event 4\n" in run.said
    ours, theirs = (json.loads((folder / "certificate.json").read_text()) for folder in (run_folder, tmp_path / "run"))
    assert theirs["frames_sha256"] == ours["frames_sha256"]
    assert theirs["foreign"]


def twins(site: Path, folder: Path, seed: int) -> dict[str, int]:
    """Run both controllers on the same frames and compare every answer; returns their counters, which must be equal."""
    words = [sys.executable, "-c", _TWINS, str(SCENARIO), str(folder), str(seed)]
    environment = {**os.environ, "PYTHONPATH": str(site)}
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, env=environment)
    assert done.returncode == 0, done.stderr
    answers, ended, ended_c, counted, counted_c = json.loads(done.stdout)
    assert answers > 1000
    assert ended == ended_c == 4
    assert counted == counted_c
    return dict(counted)


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_the_c_node_answers_as_ours_on_any_bus(site: Path, exported: Path, tmp_path: Path, seed: int) -> None:
    copy = tmp_path / "c"
    shutil.copytree(exported, copy)
    counted = twins(site, copy, seed)
    if seed:
        assert {"wrong_check_sequence", "wrong_master_word", "missing_block", "stale"} <= set(counted)
        assert {"duplicate", "out_of_order", "gap", "check_variable"} <= set(counted)
    else:
        assert not counted


def test_the_c_node_takes_telegrams_without_life_sign_and_check_variable_as_ours(site: Path, tmp_path: Path) -> None:
    folder = tmp_path / "c"
    copy = changed(site, tmp_path, UNGUARDED)
    export(copy, folder)
    counted = twins(copy, folder, 1)
    assert "stale" in counted
    assert {"duplicate", "out_of_order", "gap", "check_variable"}.isdisjoint(counted)


def test_the_c_node_reads_and_writes_any_bits_and_tells_the_law_what_was_sent(site: Path, tmp_path: Path) -> None:
    copy = changed(site, tmp_path, {"laws.py": KEEPING, "wire.py": PLAIN_FORCES, "ports.toml": CROOKED})
    folder = tmp_path / "c"
    export(copy, folder)
    for seed in (0, 5):
        twins(copy, folder, seed)
