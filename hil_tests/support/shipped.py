"""Names of the shipped scenarios, by system."""

from __future__ import annotations

from railhil.scenarios.layers import Layers
from railhil.scenarios.load import RUNS, names

#: Of the system ``ato``, and of all others.
ATO = [name for name in names() if "system" not in Layers(RUNS / f"{name}.toml").merge()]
OTHERS = sorted({*names()} - {*ATO})
