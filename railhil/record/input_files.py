"""The inputs of a run, written into its folder at the start, so that the record can be judged anywhere."""

from __future__ import annotations

from pathlib import Path

from railhil.dbc import DBC, PORTS
from railhil.dbc.text import dbc_text, table_text
from railhil.record.json_file import write_json
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.stored import SCENARIO, any_document
from railhil.scenarios.system import system_named

#: Parameters of the law, if they are not the law's own.
PARAMETERS = "parameters.json"


def write_inputs(folder: Path, scenario: AnyScenario, parameters: ParameterSet | None) -> None:
    """Write resolved scenario, wire contract and parameters; always the nominal scenario.

    :raises OSError: it cannot be written.
    """
    write_json(folder / SCENARIO, any_document(scenario))
    system = system_named(scenario.system)
    (folder / PORTS).write_text(table_text(system.contract), encoding="utf-8")
    (folder / DBC).write_text(dbc_text(system.contract), encoding="utf-8")
    if parameters is not None:
        write_json(folder / PARAMETERS, parameters.as_json())
