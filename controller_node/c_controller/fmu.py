"""The FMU of a function of the user: the frame of an exported law's FMU, for readings and commands in their units."""

from __future__ import annotations

import hashlib

from railhil.controller_node.export.control import Wire
from railhil.controller_node.export.fmu import description, standard_headers
from railhil.controller_node.export.fmu_law import REALS, FmuLaw, Variable
from railhil.controller_node.export.text import template
from railhil.controller_node.given.computing import Terms
from railhil.fmu.instance import fmpy_for

_FMI = "2.0"


def fmu_files(name: str, terms: Terms, period_ns: int, command: str) -> dict[str, str]:
    """Files of the C around a controller with which ``make fmu`` builds ``build/NAME.fmu`` for this host, by name.

    The FMU has no states that an importer could keep, and one instance in a process: the state is the user's.

    :param command: for an error: needs them.
    :raises InputError: FMPy, whose copy of the standard's headers is used, is missing.
    """
    fmpy = fmpy_for(command)
    digest = hashlib.sha256(f"{_FMI} {name} {period_ns} {terms.interface}".encode()).hexdigest()[:32]
    places = REALS | {
        "TOKEN": f"{{{digest}}}",
        "PERIOD_NS": str(period_ns),
        "INPUTS": str(len(terms.readings)),
        "OTHER_SENT": "0",
        "COMMANDS": str(len(terms.commands)),
        "READINGS": ", ".join(f".{one.name} = (float)input[{at}]" for at, one in enumerate(terms.readings)),
        "NANS": ", ".join("NAN" for _ in terms.commands),
        "ANSWERS": "\n".join(f"    law->words[{at}] = out.{one.name};" for at, one in enumerate(terms.commands)),
        "NAME": name,
        "PLATFORM": fmpy.platform,
    }
    inputs, outputs = (
        tuple(Variable(one.name, at, Wire(""), one.unit) for at, one in enumerate(side))
        for side in (terms.readings, terms.commands)
    )
    law = FmuLaw(name, {}, inputs, outputs, period_ns, places["TOKEN"], keeps_state=False)
    return {
        "modelDescription.xml": description(law, _FMI, ()).decode(),
        "fmu.mk": template("given_fmu.mk", name, **places),
        "railhil_fmu_law.h": template("given_fmu_law.h", name, **places),
        **{file: template(file, name, **places) for file in ("railhil_fmu.h", "railhil_fmu.c", "railhil_fmi2.c")},
        **standard_headers(fmpy, _FMI),
    }
