"""The law of a test as firmware of an emulated board (``--railhil-target``)."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from railhil.controller_node.boards.given import PREFIX, EmulatedController
from railhil.controller_node.export.bundle import make_bundle, write_bundle
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec


def exported(spec: RunSpec, target: str, folder: Path) -> RunSpec:
    """The run with an export of its law on a board.

    :param target: ``qemu:BOARD``.
    :param folder: of all exports, one folder each.
    :raises InputError: the law cannot be exported, or there is no such board.
    """
    # Faults are the bench's.
    bundle = make_bundle(load_any(spec.scenario, spec.settings), spec.law)
    digest = hashlib.sha256("\0".join(bundle.files.values()).encode()).hexdigest()
    place = folder / f"{bundle.source.name}-{digest[:12]}"
    write_bundle(bundle, place, force=True)
    given = EmulatedController(f"{PREFIX}{place}@{target.removeprefix(PREFIX)}")
    return replace(spec, law=LawSpec.of_given(given, spec.law.indexing, spec.law.task_period_ms))
