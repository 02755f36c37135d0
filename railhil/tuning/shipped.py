"""Parameter files that come with the package: ``controller_node/<system>/tuned/<scenario>/<law>.toml``."""

from __future__ import annotations

from pathlib import Path

import railhil.controller_node
from railhil.scenarios.parameters import ParameterSet, load_parameters

FOLDER = Path(railhil.controller_node.__file__).parent


def shipped() -> list[ParameterSet]:
    """All of them, by scenario and law. Raises InputError for an invalid file."""
    return [load_parameters(path) for path in sorted(FOLDER.glob("*/tuned/*/*.toml"))]
