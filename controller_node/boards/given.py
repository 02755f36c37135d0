"""The kind ``qemu:FOLDER[@BOARD]``: the C of a folder as the firmware of an emulated board."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from railhil.bus.frame import Frame
from railhil.bus.mvb import F_DEVICE_STATUS, parse_master_frame
from railhil.controller_node.boards import Board, Image
from railhil.controller_node.boards.emulator import Emulator
from railhil.controller_node.c_controller.folder import BUILD, ControllerFolder, make_says, write_sources
from railhil.controller_node.foreign import OutsideController
from railhil.controller_node.pipe import ControllerFailed
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

PREFIX = "qemu:"
#: The board of a text that names none.
USUAL = "cortex_m4f"


class EmulatedBoard:
    """The board of a run, with the power on (:class:`railhil.controller_node.foreign.Outside`).

    A controller that fails before the handshake is bad input. One that fails later is silent from then on, as a board
    is: the train's own watch acts, and the figures have what the console said.
    """

    def __init__(self, emulator: Emulator) -> None:
        self._emulator = emulator
        self._has_begun = self._is_silent = False

    def exchange(self, frames: Sequence[Frame]) -> Sequence[Frame]:
        """Frames to the board and its answers; none from a silent one.

        :raises ControllerFailed: before the handshake.
        """
        if self._is_silent:
            return []
        try:
            answers = self._emulator.exchange(frames)
        except ControllerFailed as error:
            if not self._has_begun:
                raise
            self._emulator.console.append(error.difference)
            self._is_silent = True
            # What was on the bus when it failed.
            return error.frames
        polled = parse_master_frame(frames[-1].data)
        self._has_begun |= polled is not None and polled[0] != F_DEVICE_STATUS
        return answers

    def figures(self) -> dict[str, Any]:
        """See :meth:`railhil.controller_node.boards.emulator.Emulator.figures`."""
        return self._emulator.figures()

    def close(self) -> None:
        """Switch it off."""
        self._emulator.stop()


class EmulatedController(OutsideController):
    """See the module.

    :raises InputError: no such folder, or no such board.
    """

    form: ClassVar[str] = f"{PREFIX}FOLDER[@BOARD]"

    def __init__(self, text: str) -> None:
        super().__init__(text)
        before, at, board = text.removeprefix(PREFIX).rpartition("@")
        self.folder = ControllerFolder(before if at else board)
        self.board = Board.load(board if at else USUAL)
        self.name, self.arithmetic, self.law = self.folder.name, self.folder.arithmetic, self.folder.law
        self._run: RunSpec | None = None
        self._emulator: Emulator | None = None

    @classmethod
    def reads(cls, text: str) -> bool:
        return text.startswith(PREFIX)

    @property
    def label(self) -> str:
        return self.folder.label

    def files(self) -> tuple[Path, ...]:
        return self.folder.files()

    def as_json(self) -> dict[str, Any]:
        return {**super().as_json(), "board": self.board.name}

    def prepare(self, scenario: AnyScenario, run: RunSpec) -> None:
        self._build(self.folder.sources(scenario, run.law))

    def start(self, scenario: AnyScenario, run: RunSpec) -> EmulatedBoard:
        """The board, built and switched on; again in the same run: reset, and its figures go on."""
        if self._emulator is None or self._run is not run:
            contract = scenario.installed_system.contract
            image = self._build(self.folder.sources(scenario, run.law))
            self._emulator, self._run = Emulator(self.board, image, run.patience_s, contract), run
        self._emulator.reset()
        return EmulatedBoard(self._emulator)

    def _build(self, files: Mapping[str, bytes]) -> Image:
        """The image of the files; the folder's Makefile names those that a board compiles."""
        folder = self.folder.folder
        with tempfile.TemporaryDirectory(prefix="railhil-board-") as draft:
            write_sources(Path(draft), files)
            sources = make_says(Path(draft), self.text, "sources").split()
            include = sorted({str(Path(name).parent) for name in files if name.endswith((".h", ".hpp", ".hh"))})
            return self.board.build(Path(draft), sources, include, out=folder / BUILD)
