"""With what a run is made: written into its folder at the start, so that the record can be judged anywhere."""

from __future__ import annotations

import shutil
from pathlib import Path

from railhil import dbc
from railhil.dbc import DBC, PORTS
from railhil.scenarios.model import Scenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.stored import SCENARIO, document
from railhil.supervisor.json_file import write_json

#: Parameters of the law, when they did not come from the law itself.
PARAMETERS = "parameters.json"


def write_inputs(folder: Path, scenario: Scenario, parameters: ParameterSet | None) -> None:
    """Write resolved scenario, wire contract and parameters; the nominal scenario, whatever the seed draws.

    :raises OSError: it cannot be written.
    """
    write_json(folder / SCENARIO, document(scenario))
    for name in (PORTS, DBC):
        shutil.copyfile(Path(dbc.__file__).with_name(name), folder / name)
    if parameters is not None:
        write_json(folder / PARAMETERS, parameters.as_json())
