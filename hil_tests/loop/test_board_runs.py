"""Runs in which an emulated board is the controller: word-equal commands, faults of node, processor and power."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.cli import Done, railhil
from hil_tests.support.short_runs import RUN_72M_TOML
from hil_tests.support.user_suite import run_suite
from railhil.controller_node.boards import Board
from railhil.record.framelog import log_sha256
from railhil.record.hash_list import HASH_LIST, write_hash_list
from railhil.record.target import read_target

pytest_plugins = ("pytester",)
pytestmark = [pytest.mark.needs_qemu, pytest.mark.slow, pytest.mark.faults]
#: A place in a run at which the train moves.
_AT = "law->steps == 20"


def _frames(folder: Path, can_id: str) -> list[str]:
    words = (line.split()[2] for line in (folder / "frames.log").read_text().splitlines())
    return [word for word in words if word.startswith(f"{can_id}#")]


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("scenario") / "short.toml"
    file.write_text(RUN_72M_TOML)
    return file


@pytest.fixture
def export(short: Path, tmp_path: Path) -> Callable[[str, str], Path]:
    """Exports ipfc for the short run, with a text in one of its files replaced."""

    def made(file: str, old: str, new: str) -> Path:
        folder = tmp_path / "export"
        done = railhil("export-c", "ipfc", short, "--out", folder)
        assert done.exit_code == 0, done.err
        text = (folder / file).read_text()
        assert old in text
        (folder / file).write_text(text.replace(old, new))
        return folder

    return made


def _run(scenario: str | Path, out: Path, *words: str | Path) -> Done:
    return railhil("run", scenario, "--bus", "local", "--no-report", "--quiet", "--out", out, *words)


@pytest.mark.long
def test_the_whole_published_run_is_equal_on_a_board(tmp_path: Path) -> None:
    assert railhil("export-c", "ipfc", "--out", tmp_path / "ipfc").exit_code == 0
    assert _run("lvshun_tieshan", tmp_path / "board", "--controller", f"qemu:{tmp_path / 'ipfc'}").exit_code == 0
    assert _run("lvshun_tieshan", tmp_path / "node").exit_code == 0
    notches = _frames(tmp_path / "board", "110")
    assert len(notches) == 9804
    assert notches == _frames(tmp_path / "node", "110")
    target = read_target(tmp_path / "board")
    assert target is not None
    assert target.control_periods == 393


def test_a_run_is_equal_on_a_board_and_can_be_made_again(short: Path, tmp_path: Path) -> None:
    assert railhil("export-c", "ipfc", short, "--out", tmp_path / "ipfc").exit_code == 0
    board = ("--controller", f"qemu:{tmp_path / 'ipfc'}")
    assert _run(short, tmp_path / "board", *board).exit_code in (0, 1)
    assert _run(short, tmp_path / "node").exit_code in (0, 1)
    notches = _frames(tmp_path / "board", "110")
    assert len(set(notches)) > 20
    assert notches == _frames(tmp_path / "node", "110")
    target = read_target(tmp_path / "board")
    assert target is not None
    assert target.instructions is not None
    assert 20 < target.control_periods < 100
    assert 500 < target.instructions.min <= target.instructions.median <= target.instructions.max < 5000
    assert target.stack_used_octets is not None
    assert 200 < target.stack_used_octets < target.stack_octets
    certificate = json.loads((tmp_path / "board" / "certificate.json").read_text())
    assert certificate["target"] == target.model_dump()
    assert "target.json" in (tmp_path / "board" / "SHA256SUMS").read_text()
    again = railhil("rerun", tmp_path / "board", *board)
    assert again.exit_code == 0, again.out + again.err
    for other in (
        (),
        ("--controller", f"{tmp_path / 'ipfc'}"),
        ("--controller", f"qemu:{tmp_path / 'ipfc'}@cortex-m3"),
    ):
        refused = railhil("rerun", tmp_path / "board", *other)
        assert (refused.exit_code, refused.err.count("\n")) == (2, 1), other
    certificate["target"]["instructions"]["max"] = 7
    (tmp_path / "board" / "certificate.json").write_text(json.dumps(certificate))
    (tmp_path / "board" / HASH_LIST).unlink()
    write_hash_list(tmp_path / "board", {})
    edited = railhil("verify", tmp_path / "board")
    assert edited.exit_code != 0
    assert "target: found" in edited.out + edited.err


@pytest.mark.long
def test_a_learning_law_on_a_board_has_the_bytes_of_the_node(tmp_path: Path) -> None:
    """Another system, over its interface: every frame, the law's notes among them."""
    assert railhil("export-c", "ilc_stop", "yizhuang_stop", "--out", tmp_path / "ilc").exit_code == 0
    board = ("--controller", f"qemu:{tmp_path / 'ilc'}@cortex-m3")
    assert _run("yizhuang_stop", tmp_path / "board", *board).exit_code in (0, 1)
    assert _run("yizhuang_stop", tmp_path / "node", "--arithmetic", "iq").exit_code in (0, 1)
    assert log_sha256(tmp_path / "board" / "frames.log") == log_sha256(tmp_path / "node" / "frames.log")


@pytest.mark.long
def test_a_run_of_the_yizhuang_line_is_equal_on_a_board(tmp_path: Path) -> None:
    assert railhil("export-c", "ipfc", "yizhuang_05", "--out", tmp_path / "ipfc").exit_code == 0
    for name, controller in (("board", f"qemu:{tmp_path / 'ipfc'}"), ("node", "ipfc")):
        assert _run("yizhuang_05", tmp_path / name, "--controller", controller).exit_code in (0, 1)
    assert _frames(tmp_path / "board", "110") == _frames(tmp_path / "node", "110")


@pytest.mark.long
def test_a_law_and_its_export_on_a_board_are_compared(short: Path, tmp_path: Path) -> None:
    assert railhil("export-c", "ipfc", short, "--out", tmp_path / "ipfc").exit_code == 0
    laws = f"ipfc,qemu:{tmp_path / 'ipfc'},{tmp_path / 'ipfc'}/"
    words = ("--bus", "local", "--no-report", "--quiet", "--json", "--out", tmp_path / "compared")
    rows = railhil("compare", short, "--laws", laws, *words).json["runs"]
    assert [row["label"] for row in rows] == ["ipfc", "ipfc on cortex_m4f", "ipfc in C"]
    assert len({row["folder"] for row in rows}) == 3
    assert rows[0]["scores"] == rows[1]["scores"] == rows[2]["scores"]


def _talking_board(folder: Path) -> Path:
    """A copy of a board whose emulator prints a line of its own."""
    board, emulator = folder / "myboard", folder / "emulator"
    shutil.copytree(Board.load("cortex_m4f").folder, board)
    table = board / "board.toml"
    table.write_text(table.read_text().replace('program = "qemu-system-arm"', f'program = "{emulator}"'))
    emulator.write_text('#!/bin/sh\necho a word of the emulator >&2\nexec qemu-system-arm "$@"\n')
    emulator.chmod(0o755)
    return board


def test_a_run_over_a_bus_has_the_same_bytes(
    short: Path, tmp_path: Path, export: Callable[[str, str, str], Path]
) -> None:
    """Also target.json, with what the emulator itself has printed."""
    board = _talking_board(tmp_path)
    text = f"qemu:{export('ipfc.c', 'ipfc', 'ipfc')}@{board}"
    assert _run(short, tmp_path / "local", "--controller", text).exit_code in (0, 1)
    done = railhil("run", short, "--no-report", "--quiet", "--out", tmp_path / "bus", "--controller", text)
    assert done.exit_code in (0, 1), done.err
    assert log_sha256(tmp_path / "bus" / "frames.log") == log_sha256(tmp_path / "local" / "frames.log")
    found = read_target(tmp_path / "bus")
    assert found is not None
    assert (found.board, found.console) == ("myboard", ["a word of the emulator"])
    assert found == read_target(tmp_path / "local")


@pytest.mark.long_after(1)
@pytest.mark.parametrize(
    ("file", "old", "new", "words"),
    [
        pytest.param(
            "railhil_law.c",
            "    began = RAILHIL_TICKS();",
            f"    began = {_AT} ? *(volatile uint32_t *)0xF0000000u : RAILHIL_TICKS();",
            "hard fault at 0x0000",
            id="hard fault",
        ),
        pytest.param(
            "railhil_law.c",
            "    began = RAILHIL_TICKS();",
            f"    while ({_AT}) {{\n    }}\n    began = RAILHIL_TICKS();",
            "has not answered for 1 s",
            id="endless loop",
        ),
        pytest.param(
            "railhil_pipe.c",
            "                put_frame(&answers[i]);",
            "                put_frame(&answers[i]);\n"
            "                if (count == 3 && i == 1 && control->law.steps > 20) { flush(); board_stop(); }",
            "has ended",
            id="brown-out between the frames of a telegram",
        ),
    ],
)
def test_when_a_board_fails_the_train_stops_by_its_own_watch(
    file: str, old: str, new: str, words: str, short: Path, tmp_path: Path, export: Callable[[str, str, str], Path]
) -> None:
    folder = export(file, old, new.replace("board_stop", "extern void board_stop(void); board_stop"))
    done = _run(short, tmp_path / "run", "--controller", f"qemu:{folder}", "--patience", "1")
    # As with a board whose plug is pulled.
    assert done.exit_code == 3, done.out + done.err
    target = read_target(tmp_path / "run")
    assert target is not None
    assert words in " ".join(target.console)
    assert words in done.out
    assert "train's EMERGENCY" in done.out


@pytest.mark.long_after(1)
@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("volatile float table[9000]; table[0] = notch; out->notch = table[0];", "stack overflow"),
        ("out->notch = *(volatile float *)0x1FFF0000;", "hard fault"),
        ("*(volatile float *)0x100 = notch; out->notch = notch;", "hard fault"),
    ],
)
@pytest.mark.parametrize("board", ["cortex-m4f", "cortex-m3"])
def test_a_function_that_leaves_the_memory_is_named(
    board: str, body: str, words: str, short: Path, tmp_path: Path
) -> None:
    """A stack that is used up, also where the function jumps over its end; a place without memory; the program."""
    assert railhil("new", "c-controller", "mine", cwd=tmp_path).exit_code == 0
    code = tmp_path / "mine" / "mine.c"
    code.write_text(code.read_text().replace("out->notch = notch;", body))
    done = _run(short, tmp_path / "run", "--controller", f"qemu:{tmp_path / 'mine'}@{board}", "--patience", "2")
    assert done.exit_code == 3, done.out + done.err
    target = read_target(tmp_path / "run")
    assert target is not None
    assert target.console[0].startswith(words)


def test_a_board_that_fails_before_the_handshake_is_one_line(
    short: Path, tmp_path: Path, export: Callable[[str, str, str], Path]
) -> None:
    folder = export("railhil_law.c", "    law->period = -1;", "    law->period = *(volatile int *)0xF0000000u;")
    done = _run(short, tmp_path / "run", "--controller", f"qemu:{folder}")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert "hard fault at 0x0000" in done.err


@pytest.mark.long
def test_the_catalogue_of_node_faults_holds_on_a_board(tmp_path: Path) -> None:
    assert railhil("export-c", "ipfc", "--out", tmp_path / "ipfc").exit_code == 0
    words = ("--bus", "local", "--no-report", "--only", "N1,N2,N3,N4", "--controller", f"qemu:{tmp_path / 'ipfc'}")
    done = railhil("faults", *words)
    assert done.exit_code == 0, done.out + done.err
    assert "4 runs, 0 not as they must be" in done.out


@pytest.mark.long
def test_a_c_controller_of_a_user_runs_on_a_board_as_on_the_host(short: Path, tmp_path: Path) -> None:
    made = railhil("new", "c-controller", "mine", cwd=tmp_path)
    assert made.exit_code == 0, made.err
    for name, text in (("host", f"{tmp_path / 'mine'}"), ("board", f"qemu:{tmp_path / 'mine'}@cortex-m4")):
        assert _run(short, tmp_path / name, "--controller", text).exit_code in (0, 1)
    assert log_sha256(tmp_path / "board" / "frames.log") == log_sha256(tmp_path / "host" / "frames.log")


def test_what_does_not_fit_into_the_memory_is_named(short: Path, tmp_path: Path) -> None:
    assert railhil("new", "c-controller", "mine", cwd=tmp_path).exit_code == 0
    board = tmp_path / "board"
    shutil.copytree(Board.load("cortex_m4f").folder, board)
    script = (board / "board.ld").read_text()
    (board / "board.ld").write_text(script.replace("LENGTH = 1M", "LENGTH = 4K"))
    done = _run(short, tmp_path / "out", "--controller", f"qemu:{tmp_path / 'mine'}@{board}")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert "region `ROM' overflowed by" in done.err


def test_a_function_that_needs_an_operating_system_is_named(short: Path, tmp_path: Path) -> None:
    assert railhil("new", "c-controller", "mine", cwd=tmp_path).exit_code == 0
    code = tmp_path / "mine" / "mine.c"
    code.write_text("#include <stdio.h>\n" + code.read_text().replace("out->notch = notch;", 'printf("%d", 1);'))
    done = _run(short, tmp_path / "out", "--controller", f"qemu:{tmp_path / 'mine'}")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert "undefined reference to `_" in done.err


@pytest.mark.long
def test_the_laws_of_a_suite_run_on_the_board_of_the_session(short: Path, pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        f"""
        def test_it(bench):
            run = bench.run(scenario={str(short)!r}, faults=["controller stop @10s for 100ms"])
            assert run.certificate["target"]["board"] == "cortex_m3"
            assert run.certificate["controller"] == "ipfc"
        """
    )
    run_suite(pytester.path, "--railhil-target", "qemu:cortex-m3").assert_outcomes(passed=1)
    run_suite(pytester.path).assert_outcomes(failed=1)


def test_a_suite_with_a_target_runs_nothing_on_the_host_instead(short: Path, pytester: pytest.Pytester) -> None:
    assert railhil("new", "c-controller", "mine", cwd=pytester.path).exit_code == 0
    pytester.makepyfile(
        f"""
        def test_c(bench):
            run = bench.run(scenario={str(short)!r}, controller="./mine")
            assert run.certificate["target"]["board"] == "cortex_m4f"

        def test_python(bench):
            bench.run(scenario={str(short)!r}, controller=lambda reading: 0)
        """
    )
    done = run_suite(pytester.path, "--railhil-target", "qemu:cortex-m4f")
    done.assert_outcomes(passed=1, failed=1)
    done.stdout.fnmatch_lines(["*does not run on a board*"])


@pytest.mark.long
def test_target_qemu_says_size_log_instructions_and_the_estimate(short: Path, tmp_path: Path) -> None:
    assert railhil("export-c", "ipfc", short, "--out", tmp_path / "ipfc").exit_code == 0
    done = railhil("target", "qemu", tmp_path / "ipfc", short, "--board", "cortex_m3")
    assert done.exit_code == 0, done.err
    for words in ("control periods identical", "ROM ", "stack ", "instructions: ", "estimate for the C28x: "):
        assert words in done.out
    other = railhil("target", "qemu", tmp_path / "ipfc", "yizhuang_05")
    assert (other.exit_code, other.err.count("\n")) == (2, 1)
    assert "scenario differs" in other.err
    log = tmp_path / "ipfc" / "ipfc_log.txt"
    log.write_text(log.read_text()[:-2] + "1\n")
    assert railhil("target", "qemu", tmp_path / "ipfc", short).exit_code == 1
