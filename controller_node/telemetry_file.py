"""The telemetry of a controller as a JSON document, written once when its process ends."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from railhil.bus.ident import PROFILES
from railhil.common.errors import InputError, describe_os_error
from railhil.common.user_files import whole_file
from railhil.controller_node.controller import AnyController
from railhil.controller_node.cost import CPU_MHZ, FLASH_FACTOR
from railhil.controller_node.laws import find
from railhil.controller_node.laws.note import slots
from railhil.controller_node.telemetry import QuantityTelemetry
from railhil.scenarios.given import TARGET
from railhil.scenarios.system import System


def _row(row: QuantityTelemetry) -> dict[str, Any]:
    """A row with JSON-compatible values: an infinite extreme of a float arithmetic becomes null."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in asdict(row).items()
    }


def law_document(name: str, law: Any) -> dict[str, Any]:
    """A law's declarations; seeds as the arguments of Python's ``range``, by name of the scenario.

    :param name: the name by which it was requested; ``law``: its class.
    """
    return {
        "law": name,
        "indexings": list(law.indexings),
        "parameters_origin": law.parameters_origin,
        "notes": [law.notes[number].document(signal) for signal, number in slots(law.notes).items()],
        "design_seeds": {
            scenario: [seeds.start, seeds.stop, seeds.step] for scenario, seeds in law.design_seeds.items()
        },
    }


def law_notes(system: System, law: str | None) -> list[dict[str, Any]] | None:
    """The notes declared by the law of a run; None: unknown, or the same for every law of the system.

    :raises InputError: there is no such law.
    """
    if law is None or system.interface is not None:
        return None
    notes: list[dict[str, Any]] = law_document(law, find(law, system.laws))["notes"]
    return notes


def telemetry_document(node: AnyController) -> dict[str, Any]:
    """All telemetry of the controller's arithmetic so far; times in us.

    ``totals`` count since the arithmetic was made, the quantities since the first control period. ``share`` is the
    share of the control period with the program in flash, where every step takes twice as long as from RAM.
    ``memory``, of a law that keeps one: :func:`railhil.controller_node.laws.memory.kept`.
    """
    controller, law = node.controller, node.law
    counters, cost = controller.counters, controller.cost
    return {
        **law_document(law.controller, node.law_type),
        **law.how,
        "profile": PROFILES[law.arithmetic],
        "steps": controller.telemetry.steps,
        "totals": {
            "wraps": counters.wraps,
            "saturations": counters.saturations,
            "zero_divisions": counters.zero_divisions,
        },
        "quantities": [_row(row) for row in controller.telemetry.rows],
        "operations": cost.operations,
        "cycles": {
            "ram": cost.cycles,
            "flash": cost.cycles_flash,
            "cpu_mhz": CPU_MHZ,
            "flash_factor": FLASH_FACTOR,
            "ram_us": cost.ram_us,
            "flash_us": cost.flash_us,
            "control_period_us": cost.period_ns / 1000,
            "share": cost.share,
        },
        "lost_messages": {"total": node.lost_messages, "mailboxes": dict(node.lost_by_mailbox)},
        **_memory(controller),
    }


def _memory(controller: Any) -> dict[str, Any]:
    """The memory that the law wants to keep. Nothing if it keeps none, or if it fails; a line then says so, because the
    run itself was sound."""
    try:
        found = controller.kept()
    except InputError as error:
        print(f"controller: memory is lost: {error}", file=sys.stderr)
        return {}
    return {} if found is None else {"memory": found}


def write_telemetry(node: AnyController, path: Path) -> None:
    """Write the complete document; for a controller that states nothing of its own, what was measured on its board, as
    :data:`railhil.scenarios.given.TARGET` beside it.

    If the disk is full, the file is lost and a line is printed to stderr, but the run itself is still valid.
    """
    if node.controller is not None:
        document = telemetry_document(node)
    elif (figures := node.figures()) is not None:
        document, path = figures, path.with_name(TARGET)
    else:
        return
    text = json.dumps(document, indent=2, allow_nan=False) + "\n"
    try:
        with whole_file(path) as draft:
            draft.write_text(text, encoding="utf-8")
    except OSError as error:
        print(f"controller: telemetry {path} is lost: {describe_os_error(error)}", file=sys.stderr)
