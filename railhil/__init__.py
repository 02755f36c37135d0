"""railhil: a hardware-in-the-loop bench for train controllers.

Use as a library: docs/howto/library.md. Modules are loaded when a name is first used.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from railhil.common.errors import InputError
    from railhil.hunt.outcome import HuntOutcome, hunt
    from railhil.library import (
        CampaignOutcome,
        Comparison,
        Outcome,
        RecordedEvent,
        Signals,
        campaign,
        compare,
        open_run,
        run,
    )
    from railhil.probability.outcome import ProbabilityOutcome, probability
    from railhil.run.branch import branch
    from railhil.scenarios.load import load as load_scenario
    from railhil.scenarios.run_spec import LawSpec, RunSpec

#: Packages that lie beside this one in a checkout, where users find them, and in this one in a wheel (pyproject.toml,
#: package-dir).
AT_TOP = ("bus", "controller_node", "dbc", "plant_sim")
_TOP = os.path.dirname(__path__[0])
# A walk over all packages finds this one in its own folder, too: once is enough.
if __name__ == "railhil" and os.path.isfile(os.path.join(_TOP, "pyproject.toml")):
    __path__.append(_TOP)

if os.environ.get("RAILHIL_PURE", "0") not in ("", "0"):
    import_module("railhil.pure").use_sources()

#: Name -> module and name there. ``campaign``, ``hunt``, ``probability`` and ``run`` are packages of these names, which
#: can be called.
_PLACES = {
    "CampaignOutcome": ("railhil.library", "CampaignOutcome"),
    "Comparison": ("railhil.library", "Comparison"),
    "HuntOutcome": ("railhil.hunt.outcome", "HuntOutcome"),
    "InputError": ("railhil.common.errors", "InputError"),
    "LawSpec": ("railhil.scenarios.run_spec", "LawSpec"),
    "Outcome": ("railhil.library", "Outcome"),
    "ProbabilityOutcome": ("railhil.probability.outcome", "ProbabilityOutcome"),
    "RecordedEvent": ("railhil.library", "RecordedEvent"),
    "RunSpec": ("railhil.scenarios.run_spec", "RunSpec"),
    "Signals": ("railhil.library", "Signals"),
    "branch": ("railhil.run.branch", "branch"),
    "compare": ("railhil.library", "compare"),
    "load_scenario": ("railhil.scenarios.load", "load"),
    "open_run": ("railhil.library", "open_run"),
}
__all__ = [
    "CampaignOutcome",
    "Comparison",
    "HuntOutcome",
    "InputError",
    "LawSpec",
    "Outcome",
    "ProbabilityOutcome",
    "RecordedEvent",
    "RunSpec",
    "Signals",
    "branch",
    "campaign",
    "compare",
    "hunt",
    "load_scenario",
    "open_run",
    "probability",
    "run",
]


def __getattr__(name: str) -> Any:
    if name in ("campaign", "hunt", "probability", "run"):
        return import_module(f"railhil.{name}")
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, there = _PLACES[name]
    return getattr(import_module(module), there)


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
