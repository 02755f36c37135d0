"""The toy system with changes, and its export to C."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from hil_tests.support.toy_system import SCENARIO, railhil


def export(site: Path, folder: Path, *words: str) -> str:
    """What the command prints; the folder holds the files."""
    done = railhil(site, "export-c", "apart", str(SCENARIO), "--out", str(folder), *words)
    assert done.returncode == 0, done.stderr
    return done.stdout


def changed(site: Path, folder: Path, changes: Mapping[str, Sequence[tuple[str, str]]]) -> Path:
    """The toy system with other text in files of it."""
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


#: A law that keeps the commands that were sent, and tells of the first in its note.
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
#: Its answers are in the format of what is sent.
PLAIN_FORCES = (('"force_001n", FORCE_Q,', '"force_001n", 0,'),)
