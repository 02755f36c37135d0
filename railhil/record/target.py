"""``target.json``: what was measured on an emulated board that was the controller of a run; its keys are those of
:meth:`railhil.controller_node.boards.emulator.Emulator.figures`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from railhil.common.user_files import given_json
from railhil.scenarios.given import TARGET
from railhil.scenarios.validation import validate


class Instructions(BaseModel):
    """Of the control periods of a run."""

    min: int
    median: int
    max: int


class Target(BaseModel):
    """The document; ``rom_octets`` to ``sha256`` are those of the image."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    board: str
    title: str
    emulator: str
    compiler: str
    sha256: str
    rom_octets: int
    ram_octets: int
    stack_octets: int
    stack_used_octets: int | None
    control_periods: int
    instructions: Instructions | None
    console: list[str]

    @property
    def rows(self) -> list[tuple[str, str]]:
        """Headings and sentences, for tables and pages."""
        size = f"ROM {self.rom_octets}, RAM {self.ram_octets}"
        used = "unknown" if self.stack_used_octets is None else str(self.stack_used_octets)
        rows = [
            ("Board", f"{self.board}: {self.title}, {self.emulator}"),
            ("Image", f"SHA-256 {self.sha256}, {self.compiler}"),
            ("Octets", f"{size}, stack {used} used of {self.stack_octets}"),
        ]
        if (counts := self.instructions) is not None:
            said = f"{counts.min} to {counts.max}, median {counts.median}, of {self.control_periods} control periods"
            rows.append(("Instructions", said))
        return [*rows, *(("Console", line) for line in self.console)]


def read_target(folder: Path) -> Target | None:
    """The document of a run folder; None if it has none.

    :raises InputError: it is not one.
    """
    path = folder / TARGET
    return None if not path.is_file() else target_of(given_json(path, "figures of a board"), path)


def target_of(document: Any, file: Path) -> Target:
    """The document, as read from a file.

    :raises InputError: it is not one.
    """
    return validate(Target, document, lambda keys: file)
