"""The faults of a scenario file; a file without them does not load the language of faults."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from railhil.scenarios.system import System


def faults_of_rows(
    rows: Sequence[Mapping[str, Any] | str], system: System, origin: Callable[[int], Path]
) -> tuple[str, ...]:
    """See :func:`railhil.scenarios.fault_list.fault_texts`."""
    if not rows:
        return ()
    # Loading it takes a tenth of the start of a node, and every node reads the scenario.
    from railhil.scenarios.fault_list import fault_texts

    return fault_texts(rows, system, origin)
