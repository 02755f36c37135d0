"""JSON Schema of scenario files for editors: ``python -m railhil.scenarios.json_schema > scenario.schema.json``.

A scenario may take any key from another file (``extends``, ``file``), so the schema knows every key, its type and
bounds, but requires none; keys that are missing in the end are found when the file is loaded.
"""

from __future__ import annotations

import json
import signal
import sys
from typing import Any

from railhil.scenarios.reference import file_type

_REFERENCES = {
    "TrainTable": "a shipped train or a relative path to a .toml file",
    "LineTable": "a shipped line or a relative path to a .toml file",
    "TargetTable": "a shipped target curve or a relative path to a .toml file",
}


def scenario_json_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a scenario file as it is written, references included."""
    schema = file_type().model_json_schema()
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    schema["properties"]["extends"] = {"type": "string", "description": "scenario that this one changes"}
    schema["properties"]["without"] = {
        "type": "array",
        "items": {"type": "string"},
        "description": "keys of that scenario that this one does not inherit, such as watch.hold_ms",
    }
    train = schema["properties"]["train"]
    train["anyOf"] = train.pop("oneOf")
    for table in (schema, *schema["$defs"].values()):
        table.pop("required", None)
    for name, description in _REFERENCES.items():
        schema["$defs"][name]["properties"]["file"] = {"type": "string", "description": description}
    return schema


if __name__ == "__main__":
    # The reader of our output may close the pipe early (... | head).
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    json.dump(scenario_json_schema(), sys.stdout, indent=2, sort_keys=True)
    sys.stdout.write("\n")
