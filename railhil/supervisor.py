"""Former names of modules that systems written for version 0.1.0 import; a system of today imports the new ones."""

from __future__ import annotations

import importlib
import sys

#: Each former name below this module, and where it is now.
MOVED = {
    "criteria": "railhil.judge.criteria",
    "events": "railhil.judge.events",
    "events.declared": "railhil.judge.declared",
    "judging": "railhil.judge.judging",
    "report": "railhil.report",
    "report.figures": "railhil.report.pictures",
    "report.panels": "railhil.report.pictures",
    "report.recorded": "railhil.report.recorded",
    "sampled": "railhil.record.sampling",
    "score": "railhil.judge.score",
    "sequence_measure": "railhil.judge.judging",
    "shown": "railhil.report.display_columns",
    "status": "railhil.record.notes",
    "stops": "railhil.judge.stops",
    "trace": "railhil.record.trace",
}

for _name, _place in MOVED.items():
    # `import railhil.supervisor.score` imports this module, then takes what stands under its name.
    sys.modules[f"{__name__}.{_name}"] = importlib.import_module(_place)
