"""Everything that is written for one law: C files, mailbox table, node, reference log, host program, memory note."""

from __future__ import annotations

import os
import shutil
import tempfile
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from railhil.common.errors import InputError, Words
from railhil.controller_node.export.body import NAMED_Q
from railhil.controller_node.export.mailboxes import mailbox_header
from railhil.controller_node.export.node_header import node_header
from railhil.controller_node.export.note import memory_note
from railhil.controller_node.export.reference import reference_log
from railhil.controller_node.export.source import Source, SourceWriter, c_name
from railhil.controller_node.node import mailboxes
from railhil.controller_node.program.model import BALISE_INPUTS, LawProgram
from railhil.controller_node.program.record import record
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec

#: Words of a record without a balise.
_RECORD_WORDS = 5
#: The controller around the law, the same for every law but for names.
_NODE_FILES = (
    "railhil_mvb.h",
    "railhil_guard.h",
    "railhil_guard.c",
    "railhil_position.c",
    "railhil_control.h",
    "railhil_control.c",
    "railhil_socket.h",
    "railhil_socket.c",
    "railhil_node.c",
)


@dataclass(frozen=True, slots=True)
class Bundle:
    """Files of one export by name, in the order in which they are listed, and what the C says of its size."""

    source: Source
    files: dict[str, str]


def _template(name: str, law: str) -> str:
    text = files("railhil.controller_node.export").joinpath("c", name).read_text(encoding="ascii")
    return text.replace("@LAW@", law)


def _host_program(name: str, programs: LawProgram) -> str:
    """The host program: a record holds the balise only for a law that is given it."""
    balise = range(_RECORD_WORDS, _RECORD_WORDS + (len(BALISE_INPUTS) if programs.track else 0))
    text = _template("railhil_run.c", name).replace("@RECORD_WORDS@", str(balise.stop))
    return text.replace("@BALISE@", "".join(f", record[{word}]" for word in balise))


def _node_file(file: str, name: str, programs: LawProgram) -> str:
    balise = "".join(f", balise[{word}]" for word in range(len(BALISE_INPUTS)))
    text = _template(file, name).replace("@PREFIX@", name.upper())
    return text.replace("@BALISE@", balise if programs.track else "")


def _names_of_iqmath() -> str:
    """The library's names for our functions, for every format that it has."""
    lines = []
    for q in NAMED_Q:
        lines += [
            f"#define _IQ{q}mpy(a, b) iq_mpy((a), (b), {q})",
            f"#define _IQ{q}rmpy(a, b) iq_rmpy((a), (b), {q})",
            f"#define _IQ{q}rsmpy(a, b) iq_rsmpy((a), (b), {q})",
            f"#define _IQ{q}mpyIQX(a, q_a, b, q_b) iq_mpy_iqx((a), (q_a), (b), (q_b), {q})",
            f"#define _IQ{q}div(a, b) iq_div((a), (b), {q})",
            f"#define _IQ{q}sqrt(a) iq_sqrt((a), {q})",
            f"#define _IQ{q}abs(a) iq_abs(a)",
        ]
    return "\n".join(lines)


def make_bundle(scenario: Scenario, law: LawSpec) -> Bundle:
    """The files of a law on a scenario; the same bytes for the same law, parameters and scenario.

    :param law: in fixed point, ``iq``.
    :raises InputError: unknown law or indexing, parameters of another law, or a law that cannot be written in C.
    """
    try:
        programs = record(scenario, law)
        name = c_name(law.controller)
        source = SourceWriter(programs, scenario, law).write()
    except ValueError as error:
        allowed = "operations of the arithmetic, formats that agree, no branch on data"
        raise InputError("controller", law.controller, Words(str(error)), allowed) from error
    return Bundle(
        source,
        {
            f"{name}.c": source.source,
            f"{name}.h": source.header,
            "railhil_iq.h": _template("railhil_iq.h", name).replace("@NAMES@", _names_of_iqmath()),
            f"{name}_mailboxes.h": mailbox_header(name, mailboxes()),
            f"{name}_node.h": node_header(name, programs, scenario, law),
            **{file: _node_file(file, name, programs) for file in _NODE_FILES},
            f"{name}_log.txt": reference_log(scenario, programs, law, source.columns),
            "railhil_run.c": _host_program(name, programs),
            "Makefile": _template("Makefile", name),
            "README.md": memory_note(programs, scenario, law, source),
        },
    )


def write_bundle(bundle: Bundle, folder: Path, *, force: bool = False) -> None:
    """Write the files; either all of them stand in the folder afterwards, or an error says why not.

    :param force: write into a folder that holds something already; other files there are left alone.
    :raises InputError: the folder is not empty, or cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not force and any(folder.iterdir()):
            found = Words("a folder that is not empty")
            raise InputError(folder, "", found, "an empty or new folder", "--force writes into it")
        staging = Path(tempfile.mkdtemp(prefix=".railhil-", dir=folder))
        try:
            for name, text in bundle.files.items():
                (staging / name).write_text(text, encoding="ascii", newline="\n")
            for name in bundle.files:
                os.replace(staging / name, folder / name)
        finally:
            shutil.rmtree(staging, ignore_errors=True)
    except OSError as error:
        why = Words(error.strerror or str(error))
        raise InputError(folder, "", why, "a folder that can be written") from error
