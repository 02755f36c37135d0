"""The law of a test as firmware of an emulated board (``--railhil-target``)."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from railhil.common.errors import InputError
from railhil.controller_node.boards.given import PREFIX, EmulatedController
from railhil.controller_node.c_controller.folder import ControllerFolder
from railhil.controller_node.export.bundle import make_bundle, write_bundle
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec


def on_target(spec: RunSpec, target: str, folder: Path) -> RunSpec:
    """The run with its C controller, or an export of its law, on a board.

    :param target: ``qemu:BOARD``.
    :param folder: of all exports, one folder each.
    :raises InputError: the law cannot be exported, the controller is not in C, or there is no such board.
    """
    board, given = target.removeprefix(PREFIX), spec.law.given
    if isinstance(given, EmulatedController):
        return spec
    if isinstance(given, ControllerFolder):
        return _with(spec, given.folder, board)
    if given is not None:
        allowed = f"a law, or a folder in C: {given.text} does not run on a board"
        raise InputError("--railhil-target", "controller", given.text, allowed)
    # Faults are the bench's.
    bundle = make_bundle(load_any(spec.scenario, spec.settings), spec.law)
    digest = hashlib.sha256("\0".join(bundle.files.values()).encode()).hexdigest()
    place = folder / f"{bundle.source.name}-{digest[:12]}"
    write_bundle(bundle, place, force=True)
    return _with(spec, place, board)


def _with(spec: RunSpec, folder: Path, board: str) -> RunSpec:
    given = EmulatedController(f"{PREFIX}{folder}@{board}")
    return replace(spec, law=LawSpec.of_given(given, spec.law.indexing, spec.law.task_period_ms))
