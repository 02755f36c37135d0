"""How the laws of this system are tuned: its part ``tuning``."""

from __future__ import annotations

from railhil.systems.ato.batch.stacked import run_parameter_sets
from railhil.tuning.trials import Tuning

TUNING = Tuning(
    reference="ipfc",
    scale_of="limits of the plan; medians of ipfc with its published parameters",
    run_sets=run_parameter_sets,
)
