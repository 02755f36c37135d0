"""The controller around an exported law of a system that plugs in: answers and counters are those of ``VectorNode``.

No line of the tree knows of the system: what differs from railhil's own train is its ``Interface``.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from hil_tests.support.foreign import PROGRAM_INTERFACE, SANITIZED, build, foreign_run
from hil_tests.support.toy_export import KEEPING, PLAIN_FORCES, changed, export
from hil_tests.support.toy_system import SCENARIO, install_toy, python, railhil

pytestmark = [pytest.mark.loop, pytest.mark.slow, pytest.mark.needs_compiler]


#: Our node and the C on the same frames of a bus that loses, damages, doubles, delays and repeats some and makes the
#: check variable of others wrong. Each cart falls silent for a while (the first is the clock port), then it is stuck
#: for a while, then invalid. Prints answers, run events, and what each has counted.
_TWINS = """
import json, random, sys
from pathlib import Path
from hil_tests.support.foreign import PORTABLE_INTERFACE, CNode
from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.local import LocalBus
from railhil.bus.mvb import check_sequence
from railhil.controller_node.vector.node import VectorNode
from railhil.plant_sim.node import make_plant_node
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.record.session import make_session
scenario, seed = load_any(sys.argv[1]), int(sys.argv[3])
spec = RunSpec(law=LawSpec("apart"), seed=seed, perturbed=bool(seed))
node, c = VectorNode(scenario, spec.law), CNode(Path(sys.argv[2]), "apart", PORTABLE_INTERFACE)
session = make_session(scenario, lambda line: None, spec)
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
make_plant_node(scenario, spec, LocalBus([both, session.handle])).run()
counters = {cause: count for cause, count in node.counters.items() if cause != "unknown_id"}
print(json.dumps([answers, int(node.ended), c.ended, counters, c.counters]))
"""
#: Telegrams of readings without a check variable, and without a life sign that the interface knows of.
UNGUARDED = {
    "ports.toml": [
        ('  { name = "{p}Chk", at = "3.7:2", check = "chk" },\n', ""),
        ('"{p}Life", at = "3.3:4"', '"{p}Life", at = "3.3:4", field = "n"'),
    ],
    "plant.py": [("life=self.next_life(STATS[unit].PORT)", "n=self.next_life(STATS[unit].PORT)")],
}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_toy(tmp_path_factory.mktemp("toy"))


@pytest.fixture(scope="module")
def exported(site: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("c") / "apart"
    export(site, folder)
    return folder


@pytest.fixture(scope="module")
def run_folder(site: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of our own node in this process."""
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
    """Both controllers on the same frames, every answer equal; what each of them has counted."""
    ((answers, ended, ended_c, counted, counted_c),) = python(site, _TWINS, str(SCENARIO), str(folder), str(seed))
    assert answers > 1000
    assert ended == ended_c == 4
    assert counted == counted_c
    return dict(counted)


@pytest.mark.long_after(1)
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


def test_the_c_node_tells_the_law_what_was_sent(site: Path, tmp_path: Path) -> None:
    copy = changed(site, tmp_path, {"laws.py": KEEPING, "wire.py": PLAIN_FORCES})
    folder = tmp_path / "c"
    export(copy, folder)
    for seed in (0, 5):
        twins(copy, folder, seed)


@pytest.mark.long
def test_the_c_node_of_a_table_with_names_of_its_own_answers_as_ours(site: Path, tmp_path: Path) -> None:
    """Values that are called like a macro and like an enumerator of the files around the law."""
    folder = tmp_path / "c"
    signal = '{ name = "{p}Clock", at = "3.5:2", values = { 0 = "ticks", 1 = "port" }, enum = "Clock" },'
    life = '  { name = "{p}Life"'
    export(changed(site, tmp_path, {"ports.toml": [(life, f"  {signal}\n{life}")]}), folder)
    assert "    RAILHIL_CLOCK_TICKS_0 = 0,\n    RAILHIL_CLOCK_PORT_1 = 1," in (folder / "railhil_ports.h").read_text()
    twins(tmp_path / "site", folder, 1)
