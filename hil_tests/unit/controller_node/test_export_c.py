"""The exported C against the law in Python: every word of state and output over a million control periods.

Each test compiles what ``railhil export-c`` writes, with the flags that the export promises.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from benchmarks.recording import record as recorded_run
from hil_tests.support.exported import (
    SANITIZED,
    STRICT,
    CompiledController,
    Ints,
    Wire,
    checked,
    compiled,
    from_c,
    from_python,
    written,
)
from railhil.bench import Result, local_run
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.export import Bundle
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.wire.ato import CtlStat

pytestmark = pytest.mark.needs_compiler

SCENARIO = load("lvshun_tieshan")
TRAINS, PERIODS = 1000, 250
_S24 = 2**23
#: Compiler and flags of each build that runs the million periods.
BUILDS = {
    "gcc -O2": ("gcc", (*STRICT, "-O2")),
    "clang -O2": ("clang", (*STRICT, "-O2")),
    "gcc, undefined behaviour is an error": ("gcc", SANITIZED),
    "clang, undefined behaviour traps": ("clang", ("-std=c99", "-O1", "-fsanitize=undefined", "-fsanitize-trap=all")),
}


@pytest.fixture(scope="module", params=["time", "distance"])
def exported(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path, Bundle]:
    folder = tmp_path_factory.mktemp(request.param)
    return request.param, folder, written(SCENARIO, folder, request.param)


@cache
def _recorded() -> tuple[Ints, Ints]:
    """Speeds and positions of a nominal run, as many control periods as are asked for."""
    run = recorded_run(SCENARIO)
    assert len(run.speeds_01mmps) >= PERIODS
    return np.array(run.speeds_01mmps[:PERIODS]), np.array(run.positions_01mm[:PERIODS])


def _periods(trains: int) -> Ints:
    return np.repeat(np.arange(PERIODS)[:, None], trains, axis=1)


def _recorded_inputs(random: np.random.Generator, trains: int) -> Wire:
    """The nominal run, exactly in the first train, with growing noise of the sensors in the others."""
    speeds, positions = _recorded()
    noise = np.arange(trains) * random.integers(-3, 4, (PERIODS, trains))
    told = np.zeros((PERIODS, trains), dtype=bool)
    return Wire(_periods(trains), speeds[:, None] + noise, positions[:, None] + 7 * noise, told, np.zeros_like(noise))


def _random_inputs(random: np.random.Generator, trains: int) -> Wire:
    """Plausible values without any order; every other train moves steadily."""
    shape = (PERIODS, trains)
    speeds = random.integers(0, 300_000, shape)
    speeds[:, ::2] = np.abs(np.cumsum(random.integers(-3_000, 3_300, (PERIODS, trains // 2)), axis=0))
    told = random.random(shape) < 0.2
    k = np.where(random.random(shape) < 0.9, _periods(trains), random.integers(0, 500, shape))
    return Wire(k, speeds, random.integers(0, 40_000_000, shape), told, random.integers(-2048, 2049, shape))


def _extreme_inputs(random: np.random.Generator, trains: int) -> Wire:
    """The limits of the wire and of int32, in every order, among anything that the wire can carry."""
    shape = (PERIODS, trains)
    speeds = random.integers(-_S24, _S24, shape)
    limits = random.random(shape) < 0.5
    speeds[limits] = random.choice([-_S24, -1, 0, 1, _S24 - 1], limits.sum())
    positions = random.integers(INT32_MIN, INT32_MAX + 1, shape)
    positions[limits] = random.choice([INT32_MIN, -1, 0, 50_000, 50_001, INT32_MAX], limits.sum())
    k = random.choice([INT32_MIN, -1, 0, 1, 200, 400, 420, INT32_MAX], shape)
    return Wire(k, speeds, positions, random.random(shape) < 0.3, random.integers(-(2**15), 2**15, shape))


def _faulty_inputs(random: np.random.Generator, trains: int) -> Wire:
    """The nominal run with a speed that drops to 0, sticks or spikes, and notches that the law did not ask for."""
    wire = _recorded_inputs(random, trains)
    speeds = wire.speed_01mmps.copy()
    at = random.integers(0, PERIODS, trains)
    long = random.integers(1, 40, trains)
    periods = np.arange(PERIODS)[:, None]
    hit = (periods >= at) & (periods < at + long)
    kind = np.arange(trains) % 4
    speeds[hit & (kind == 0)] = 0
    speeds = np.where(hit & (kind == 1), np.take_along_axis(speeds, at[None, :], axis=0), speeds)
    spikes = (random.random(speeds.shape) < 0.02) & (kind >= 2)
    speeds[spikes] = random.integers(-_S24, _S24, spikes.sum())
    told = hit & (kind == 3)
    return Wire(wire.k, speeds, wire.position_01mm, told, random.choice([0, -1792, 1792, 32767], speeds.shape))


def _settled_inputs(random: np.random.Generator, trains: int) -> Wire:
    """A train on a steady set-point whose speed is all but right: the law's satisfaction takes every value."""
    shape = (PERIODS, trains)
    steady = from_python(SCENARIO, _still(np.arange(400))).words[:, 0, 1:12]
    k = int(np.argmin(np.ptp(steady, axis=1)))
    near = np.where(np.arange(PERIODS)[:, None] % 2, 130, random.choice([130, 600, 6_000, 60_000], trains))
    speeds = int(steady[k, 0]) * 25_000 // (9 << 20) + random.integers(-near, near + 1, shape)
    sent = random.integers(-1, 2, shape) * random.integers(0, 12, trains)
    return Wire(np.full(shape, k), speeds, np.zeros(shape, dtype=np.int64), random.random(shape) < 0.95, sent)


def _still(k: Ints) -> Wire:
    """One control period of a train that stands, for each k."""
    zeros = np.zeros((1, len(k)), dtype=np.int64)
    return Wire(k[None, :], zeros, zeros, zeros.astype(bool), zeros)


KINDS = {
    "recorded": _recorded_inputs,
    "random": _random_inputs,
    "extremes": _extreme_inputs,
    "faults": _faulty_inputs,
    "settled": _settled_inputs,
}


@pytest.fixture(scope="module")
def programs(exported: tuple[str, Path, Bundle]) -> dict[str, Path]:
    """All builds of one export."""
    _, folder, _ = exported
    return {
        name: compiled(folder, compiler, flags, f"run{i}") for i, (name, (compiler, flags)) in enumerate(BUILDS.items())
    }


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_million_periods_are_equal_word_for_word(
    exported: tuple[str, Path, Bundle], programs: dict[str, Path], kind: str
) -> None:
    """Five kinds of inputs, 250 000 control periods each, with every compiler and under the sanitizers."""
    indexing, _, bundle = exported
    wire = KINDS[kind](np.random.default_rng(list(KINDS).index(kind)), TRAINS)
    expected = from_python(SCENARIO, wire, indexing)
    assert expected.words.shape[2] == len(bundle.source.columns) - 2
    for build, program in programs.items():
        found = from_c(program, wire)
        if not np.array_equal(found.words, expected.words):
            train, period, word = np.argwhere(found.words != expected.words)[0]
            pytest.fail(f"{build}: train {train}, period {period}: {bundle.source.columns[word]}")
        assert (found.saturations, found.zero_divisions) == (expected.saturations, expected.zero_divisions), build
    # The inputs do what their name says: limits act only where speeds are wrong.
    assert (expected.saturations > 0) == (kind != "recorded")


def test_the_million_is_a_million() -> None:
    assert len(KINDS) * TRAINS * PERIODS >= 1_000_000


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_inputs_reach_every_output(kind: str) -> None:
    """The comparison would say little if the law sat at a limit all the time."""
    words = from_python(SCENARIO, KINDS[kind](np.random.default_rng(1), 40)).words
    notches, softening = words[:, :, -4], words[:, :, -2]
    inside = np.unique(notches[abs(notches) < notches.max()])
    assert len(inside) > 20
    assert (inside > 0).any()
    assert (inside < 0).any()
    assert len(np.unique(softening)) > (100 if kind == "settled" else 0)


@pytest.mark.long
@pytest.mark.slow
def test_compiled_controller_drives_the_train_like_the_python_node(
    exported: tuple[str, Path, Bundle], tmp_path: Path
) -> None:
    """A whole run on the bench, with the C in the place of the Python law: the same notches, the same log bytes.

    CTL_STAT alone differs: it also tells the telemetry of quantities, which is taken inside the Python law.
    """
    indexing, folder, bundle = exported
    for name in ("python", "c"):
        (tmp_path / name).mkdir()
    expected = local_run(SCENARIO, tmp_path / "python", RunSpec(law=LawSpec(indexing=indexing)))
    subprocess.run(["gcc", *STRICT, "-O2", "-fPIC", "-shared", "-o", "libipfc.so", "ipfc.c"], cwd=folder, check=True)
    law = CompiledController(SCENARIO, folder, bundle, indexing)
    found = local_run(SCENARIO, tmp_path / "c", RunSpec(law=LawSpec(indexing=indexing)), controller=law)
    assert law.steps > 300
    assert len(set(found.commands("notch"))) > 50
    assert found.commands("notch") == expected.commands("notch")
    assert _without_status(found) == _without_status(expected)
    for signal in ("Note1", "OverflowFlags", "Note2", "Note3"):
        assert np.array_equal(found.trace.raw(CtlStat.PORT, signal), expected.trace.raw(CtlStat.PORT, signal))


def _without_status(run: Result) -> list[str]:
    """Lines of the frame log but those of CTL_STAT."""
    assert run.log is not None
    own = {f"{can_id:X}" for can_id in CtlStat.port().can_ids}
    return [line for line in run.log.read_text().splitlines() if line.split()[2].partition("#")[0] not in own]


@pytest.mark.long_after(1)
@pytest.mark.slow
def test_log_as_text_is_checked_by_every_build(
    exported: tuple[str, Path, Bundle], programs: dict[str, Path], tmp_path: Path
) -> None:
    """Reference log and a log written by the program itself; one wrong digit is found and named."""
    _, folder, bundle = exported
    for program in programs.values():
        done = checked(program, folder / "ipfc_log.txt")
        assert done.returncode == 0, done.stdout + done.stderr
        assert done.stdout == f"480 control periods identical, {len(bundle.source.columns)} words each\n"
    program = next(iter(programs.values()))
    wire = _random_inputs(np.random.default_rng(5), 4)
    text = subprocess.run([program, "log"], input=wire.records(), capture_output=True, check=True).stdout
    own = tmp_path / "own.txt"
    own.write_bytes(text)
    assert checked(program, own).returncode == 0
    lines = (folder / "ipfc_log.txt").read_text().splitlines()
    changed = lines[100][:-1] + ("0" if lines[100][-1] != "0" else "1")
    own.write_text("\n".join([*lines[:100], changed, *lines[101:]]))
    done = checked(program, own)
    assert done.returncode == 1
    assert done.stdout.startswith(f"line 101, word {5 + len(bundle.source.columns)}: ")


@pytest.mark.long_after(1)
@pytest.mark.slow
def test_broken_records_and_logs_are_refused(programs: dict[str, Path], tmp_path: Path) -> None:
    program = next(iter(programs.values()))
    for text in (b"", b"# only a comment\n", b"00000001 0000", b"what\n"):
        done = subprocess.run([program, "check"], input=text, capture_output=True, check=False)
        assert done.returncode == 2, text
        assert len(done.stderr.splitlines()) == 1
    assert subprocess.run([program], input=bytes(21), capture_output=True, check=False).returncode == 2
    assert subprocess.run([program, "what"], capture_output=True, check=False).returncode == 2


def _changed_texts(text: str) -> Iterator[tuple[str, str]]:
    """One change of the law at a time: constants, rounding, limits, tables, order of the past."""
    constants = list(re.finditer(r"(static const int32_t (\w+) = INT32_C\()(-?\d+)\)", text))
    for found in constants:
        number = int(found[3])
        yield found[2], f"{text[: found.start(3)]}{number + max(1, abs(number) >> 6)}{text[found.end(3) :]}"
    for name in ("y_m", "model_0", "t_s", "alpha", "notch"):
        line = re.search(rf"^    (const )?int32_t {name} = (.*)$", text, re.MULTILINE)
        assert line is not None
        value = line[2].partition(";")[0]
        yield f"{name} one more", text.replace(f" {name} = {value};", f" {name} = 1 + ({value});", 1)
    yield "rounding", text.replace("rmpy(", "mpy(", 1)
    last = text.rindex("rmpy(")
    yield "rounding of the notch", f"{text[:last]}mpy({text[last + 5 :]}"
    yield "oldest error", text.replace("state->model_errors_0 = before_model_errors_1", "(void)before_model_errors_1")
    yield "notch sent", text.replace("= iq_shl(notch_code, 16)", "= iq_shl(notch_code, 15)")
    yield "look-ahead", text.replace("ipfc_v_of_t_table[v4 + INT32_C(7)]", "ipfc_v_of_t_table[v4 + INT32_C(8)]")


#: No input shows a small change of these: a rate that nobody uses, a time that is too long in any case, and a cut
#: where the membership is 0 already. The responses in mid-horizon show only when the largest miss lies there.
_HARDLY_SEEN = ("IPFC_ONE_SPEED", "IPFC_RISE_NEVER_NARROW", "IPFC_SPEED_WIDTHS_1", "IPFC_STEP_RESPONSE", "IPFC_FREE")


@pytest.mark.long
@pytest.mark.slow
def test_comparison_notices_a_changed_law(tmp_path: Path) -> None:
    """Mutants of the C: the comparison with Python refuses each one, most of them also the log shipped with it."""
    written(SCENARIO, tmp_path)
    wires = [KINDS[kind](np.random.default_rng(7), 100) for kind in ("settled", "random")]
    expected = [from_python(SCENARIO, wire).words for wire in wires]
    text = (tmp_path / "ipfc.c").read_text()
    mutants = [(name, changed) for name, changed in _changed_texts(text) if not name.startswith(_HARDLY_SEEN)]
    # Some from everywhere: to compile all of them takes too long for every test run.
    chosen = [*mutants[:-10:4], *mutants[-10:]]
    assert len(chosen) >= 25
    seen_by_log = 0
    for name, changed in chosen:
        assert changed != text, name
        (tmp_path / "ipfc.c").write_text(changed)
        program = compiled(tmp_path, "gcc", ("-std=c99", "-O0", "-fwrapv"), "mutant")
        equal = [
            np.array_equal(from_c(program, wire).words, words) for wire, words in zip(wires, expected, strict=True)
        ]
        assert not all(equal), f"{name}: nobody noticed"
        seen_by_log += checked(program, tmp_path / "ipfc_log.txt").returncode == 1
    assert seen_by_log >= len(chosen) - 2
