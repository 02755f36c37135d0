"""Boards: their files, images, and the emulated processor that computes what the host computes."""

from __future__ import annotations

import itertools
import os
import shutil
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.foreign import PORTABLE, export_node
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bus.frame import Frame
from railhil.bus.mvb import master_frame
from railhil.common.errors import InputError
from railhil.controller_node.boards import Board, Image, shipped_boards
from railhil.controller_node.boards.emulator import Emulator
from railhil.controller_node.pipe import ControllerFailed
from railhil.run.local import local_run
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario

_SOURCES = ("ipfc.c", *PORTABLE, "railhil_pipe.c")
_NO_IMAGE = Image(file="", sha256="", board="", compiler="", rom_octets=0, ram_octets=0, stack_octets=0)
_POLLED = {master_frame(*polled).data for polled in ((1, 0x110), (3, 0x138), (3, 0x170), (15, 1))}


@pytest.mark.parametrize("name", shipped_boards())
def test_every_shipped_board_can_be_loaded(name: str) -> None:
    assert Board.load(name).name == Board.load(name.replace("_", "-")).name == name


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("cortex_m5", "found 'cortex_m5', allowed"),
        ("", "found ''"),
        ("cortex", "found 'cortex'"),
        ("./nowhere", "does not exist"),
    ],
)
def test_a_board_that_there_is_not_is_one_line(text: str, words: str) -> None:
    with pytest.raises(InputError, match=r"allowed|expected") as error:
        Board.load(text)
    assert words in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"pipe"', '"mail"', "link: found 'mail'"),
        ("1024", "1000", "instruction_ns: found 1000, allowed a power of two"),
        ('"board.c"', '"bord.c"', "sources: found 'bord.c'"),
        ("tick_ns", "tick", "tick: unknown key"),
        ('"none"', '"{can}"', "emulator.arguments: found '{can}', allowed text with {image}"),
        ('"none"', '"{"', "emulator.arguments: found '{'"),
    ],
)
def test_a_wrong_board_file_is_one_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    shutil.copytree(Board.load("cortex_m4f").folder, mine)
    (mine / "board.toml").write_text((mine / "board.toml").read_text().replace(old, new))
    with pytest.raises(InputError) as error:
        Board.load(str(mine))
    assert words in str(error.value)


def test_a_missing_compiler_or_emulator_is_named_with_its_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    board = Board.load("cortex_m4f")
    with pytest.raises(InputError, match=r"arm-none-eabi-gcc is not installed, .*gcc-arm-none-eabi"):
        board.build(tmp_path, ())
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match=r"setpriv is not installed, .*util-linux"):
        Emulator(board, _NO_IMAGE, 1.0)
    (tmp_path / "setpriv").touch(0o755)
    with pytest.raises(InputError, match=r"qemu-system-arm is not installed, .*qemu-system-arm"):
        Emulator(board, _NO_IMAGE, 1.0)


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    file = tmp_path_factory.mktemp("scenario") / "short.toml"
    file.write_text(RUN_72M_TOML)
    return load(str(file))


@pytest.fixture(scope="module")
def folder(scenario: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("ipfc")
    export_node(scenario, folder)
    return folder


@pytest.mark.needs_qemu
@pytest.mark.slow
def test_an_image_is_built_once_and_its_bytes_do_not_depend_on_the_place(folder: Path, tmp_path: Path) -> None:
    board = Board.load("cortex_m4f")
    image = board.build(folder, _SOURCES)
    time = os.stat(image.file).st_mtime_ns
    assert board.build(folder, _SOURCES) == image
    assert os.stat(image.file).st_mtime_ns == time
    shutil.copytree(folder, tmp_path / "other", ignore=shutil.ignore_patterns("build"))
    assert board.build(tmp_path / "other", _SOURCES).sha256 == image.sha256
    assert board.build(folder, _SOURCES, optimisation="-Os").rom_octets < image.rom_octets


@pytest.mark.long
@pytest.mark.needs_qemu
@pytest.mark.slow
def test_a_change_of_any_file_that_takes_part_makes_another_image(folder: Path, tmp_path: Path) -> None:
    board, mine = tmp_path / "myboard", tmp_path / "mine"
    shutil.copytree(Board.load("cortex_m4f").folder, board)
    shutil.copytree(folder, mine, ignore=shutil.ignore_patterns("build"))
    (mine / "sub").mkdir()
    parts = [board / "pins.h", mine / "gains.hpp", mine / "sub" / "limits.inc"]
    for place, source, before, names in (
        (board, "board.c", "    TIMER0->control = 1;\n", ("pins.h",)),
        (mine, "railhil_law.c", "    law->period = -1;\n", ("gains.hpp", "sub/limits.inc")),
    ):
        text = (place / source).read_text()
        assert before in text
        lines = "".join(f'#include "{name}"\n' for name in names)
        (place / source).write_text(text.replace(before, before + lines))
    for part in parts:
        part.write_text("*(volatile int *)0x20000000 = 1;\n")
    images = [Board.load(str(board)).build(mine, _SOURCES)]
    for part in parts:
        part.write_text("*(volatile int *)0x20000000 = 2;\n")
        images.append(Board.load(str(board)).build(mine, _SOURCES))
    assert len({image.file for image in images}) == len({image.sha256 for image in images}) == 4


@pytest.mark.needs_qemu
@pytest.mark.slow
def test_an_image_with_other_figures_than_these_is_one_line(folder: Path, tmp_path: Path) -> None:
    image = Board.load("cortex_m4f").build(folder, _SOURCES, out=tmp_path)
    figures = Path(image.file).with_name("image.json")
    for text in ("{", "{}", '{"title": "of an older version"}'):
        figures.write_text(text)
        with pytest.raises(InputError, match=r"image\.json") as error:
            Board.load("cortex_m4f").build(folder, _SOURCES, out=tmp_path)
        assert "\n" not in str(error.value)


@pytest.mark.needs_qemu
@pytest.mark.slow
def test_a_file_that_does_not_compile_is_one_line_and_leaves_nothing(folder: Path, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    shutil.copytree(folder, mine, ignore=shutil.ignore_patterns("build"))
    (mine / "ipfc.c").write_text("int x = ;\n")
    with pytest.raises(InputError, match=r"arm-none-eabi-gcc: ipfc\.c:1:9: error: expected") as error:
        Board.load("cortex_m3").build(mine, _SOURCES)
    assert "\n" not in str(error.value)
    assert list((mine / "build").iterdir()) == []


@pytest.mark.long_after(1)
@pytest.mark.needs_qemu
@pytest.mark.slow
@pytest.mark.parametrize("name", ["cortex_m4f", "cortex_m3"])
def test_an_emulated_board_answers_as_the_node(name: str, scenario: Scenario, folder: Path, tmp_path: Path) -> None:
    local_run(scenario, tmp_path)
    lines = [line.split()[2].split("#") for line in (tmp_path / "frames.log").read_text().splitlines()]
    frames = [Frame(int(can_id, 16), bytes.fromhex(data)) for can_id, data in lines]
    board = Board.load(name)
    emulator = Emulator(board, board.build(folder, _SOURCES), 20.0)
    counts = []
    for _ in range(2):
        emulator.reset()
        waiting: list[Frame] = []
        answers: list[Frame] = []
        for frame in frames:
            waiting.append(frame)
            if frame.can_id == 0x80 and frame.data in _POLLED:
                answers += emulator.exchange(waiting)
                waiting = []
        notches = [frame for frame in frames if frame.can_id == 0x110]
        assert len(notches) > 900
        assert [frame for frame in answers if frame.can_id == 0x110] == notches
        counts.append(emulator.figures())
    emulator.stop()
    assert emulator.console == []
    figures = counts[0]
    assert 48 <= figures["control_periods"] <= 53
    assert 500 < figures["instructions"]["min"] <= figures["instructions"]["median"] <= figures["instructions"]["max"]
    assert 200 < figures["stack_used_octets"] < 4000
    assert counts[1]["instructions"] == figures["instructions"]
    assert "QEMU emulator version" in figures["emulator"]


def _checked(name: str, folder: Path, law: str, optimisation: str) -> str:
    """What the board says of the reference log, without the ticks of each control period."""
    board = Board.load(name)
    emulator = Emulator(board, board.build_log(folder, law, optimisation), 20.0)
    lines = emulator.run(folder / f"{law}_log.txt", 100.0).splitlines()
    ticks = [int(line.split()[1]) for line in lines if line.startswith("ticks ")]
    instructions = emulator.instructions(ticks)
    assert instructions is not None
    assert 300 < instructions.min <= instructions.median <= instructions.max < 10_000_000
    (said,) = [line for line in lines if not line.startswith("ticks ")]
    assert said.startswith(f"{len(ticks)} ")
    return said


@pytest.mark.needs_qemu
@pytest.mark.slow
@pytest.mark.long_after(1)
@pytest.mark.parametrize(
    ("law", "scenario"),
    [
        *((law, "lvshun_tieshan") for law in ("ipfc", "ipfc_plus", "tpfc1", "tpfc2", "tdmc", "fuzzy_pid")),
        ("ipfc_plus_stop", "lvshun_tieshan"),
        ("ilc_stop", "yizhuang_stop"),
        ("delay_gpc", "hst"),
        ("elm_ngpc", "hst"),
    ],
)
def test_every_word_of_a_reference_log_is_equal_on_every_board(law: str, scenario: str, tmp_path: Path) -> None:
    done = railhil("export-c", law, scenario, "--out", tmp_path)
    assert done.exit_code == 0, done.err
    for name, optimisation in itertools.product(("cortex_m4f", "cortex_m3"), ("-O2", "-Os")):
        assert "control periods identical" in _checked(name, tmp_path, law, optimisation)


@pytest.mark.needs_qemu
@pytest.mark.slow
def test_a_word_that_differs_on_a_board_is_named(tmp_path: Path) -> None:
    assert railhil("export-c", "ipfc", "--out", tmp_path / "ipfc").exit_code == 0
    log = tmp_path / "ipfc" / "ipfc_log.txt"
    lines = log.read_text().splitlines()
    assert lines[4].endswith("0")
    log.write_text("\n".join([*lines[:4], lines[4][:-1] + "1"]) + "\n")
    board = Board.load("cortex_m4f")
    said = Emulator(board, board.build_log(log.parent, "ipfc"), 20.0).run(log, 100.0)
    assert said.splitlines()[-1].startswith("line 5, word 36: 00000001 in the log, 00000000 here")


@pytest.mark.needs_qemu
@pytest.mark.slow
def test_a_fault_of_the_processor_is_said_and_a_reset_ends_it(folder: Path, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    shutil.copytree(folder, mine, ignore=shutil.ignore_patterns("build"))
    source = mine / "railhil_law.c"
    text = source.read_text()
    source.write_text(text.replace("    law->period = -1;", "    law->period = *(volatile int *)0xF0000000u;"))
    assert source.read_text() != text
    board = Board.load("cortex_m4f")
    emulator = Emulator(board, board.build(mine, _SOURCES), 20.0)
    for _ in range(2):
        emulator.reset()
        with pytest.raises(ControllerFailed, match="has failed: hard fault at 0x0000"):
            emulator.exchange([master_frame(15, 1)])
    assert len(emulator.console) == 2
