"""All files exported for one law: C files, mailbox table, node, reference log, host program, memory note."""

from __future__ import annotations

import os
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from railhil.common.errors import InputError, Words, describe_os_error
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ecan import mailbox_table
from railhil.controller_node.export.control import Control, Play, Source, Word
from railhil.controller_node.export.filters import filters_header
from railhil.controller_node.export.fixed import names_of_iqmath
from railhil.controller_node.export.headers import mailbox_header, node_header
from railhil.controller_node.export.interface import InterfaceControl
from railhil.controller_node.export.note import memory_note
from railhil.controller_node.export.ports import port_constants, ports_header
from railhil.controller_node.export.reference import reference_log
from railhil.controller_node.export.source import BODIES, SourceWriter
from railhil.controller_node.export.text import SHARED, names_defined, names_of_files, template
from railhil.controller_node.law_loop import refuse_solver
from railhil.controller_node.laws import law_class
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import System


@dataclass(frozen=True, slots=True)
class Bundle:
    """Files of one export by name, in the order of their listing, and the C source with its size figures."""

    source: Source
    files: dict[str, str]


#: The controller around the law, the same for every kind of control: sources, headers.
_SOURCES = ("railhil_clock.c", "railhil_law.c", "railhil_control.c")
_HEADERS = ("railhil_mvb.h", "railhil_clock.h", "railhil_law.h", "railhil_control.h")
_PROGRAM = (
    "railhil_pipe.h",
    "railhil_pipe.c",
    "railhil_socket.h",
    "railhil_socket.c",
    "railhil_slcan.c",
    "railhil_node.c",
)


def control_kind(system: System) -> type[Control]:
    """The class that exports its laws: its part ``export``, else that of its ``interface``."""
    kind: type[Control] = system.optional_part("export") or InterfaceControl
    return kind


def control_of(scenario: AnyScenario, law: LawSpec) -> Control:
    """The :class:`Control` that exports a law: the part ``export`` of its system, else one for its ``interface``.

    :raises InputError: the system has neither, or does not export laws in this arithmetic; a solver computes it; or
        like :class:`~railhil.controller_node.export.control.Control`.
    """
    system = scenario.installed_system
    kind = control_kind(system)
    if law.arithmetic not in kind.arithmetics:
        allowed = f"{' or '.join(kind.arithmetics)} for a law of system {system.name}"
        raise InputError("command line", "--arithmetic", law.arithmetic, allowed)
    refuse_solver(law.controller, law_class(law, scenario), make(law.arithmetic))
    return kind(scenario, law)


def _host_program(name: str, control: Control) -> str:
    """The host program; its record holds this law's inputs and the commands sent."""
    comments = control.comments(name)

    def words(of: tuple[Word, ...]) -> str:
        return ", ".join(f"record[{1 + control.record.index(word)}]" for word in of)

    return template(
        "railhil_run.c",
        name,
        RECORD_WORDS=str(1 + len(control.record)),
        GIVEN=words(control.given),
        TOLD=words(control.told),
        WHAT=comments.what,
        OTHER=comments.other,
        RECORD=comments.record,
    )


def node_files(name: str, control: Control, source: Source, program: str) -> dict[str, str]:
    """The controller around a law, and its program for the host.

    :param name: of the law in C.
    :param program: name of the program.
    """
    received, sent = control.ports()
    table = mailbox_table(control.contract, received, sent)
    mailboxes, filters = mailbox_header(name, table), filters_header(name, table)
    node = node_header(name, control)
    taken = names_of_files(SHARED) | names_of_files(control.folder)
    taken |= names_defined(source.header) | names_defined(mailboxes) | names_defined(filters)
    taken |= names_defined(node)
    places = control.places(source, port_constants([*received, *sent], taken))
    shared = {
        "GIVEN": ", ".join(f"given[{i}]" for i in range(len(control.given))),
        "COMMANDS": "\n".join(f"    commands[{i}] = law->out.{name};" for i, name in enumerate(source.commands)),
        "SENT": ", ".join(f"commands[{i}]" for i in range(len(control.told))),
    }
    own = [*control.headers, *control.sources]
    return {
        f"{name}_mailboxes.h": mailboxes,
        "railhil_filters.h": filters,
        "railhil_ports.h": ports_header(control, taken),
        f"{name}_node.h": node,
        **{file: template(file, name, **shared) for file in (*_HEADERS, *_SOURCES)},
        **{file: template(file, name, control.folder, **places) for file in own},
        **{file: template(file, name, PROGRAM=program) for file in _PROGRAM},
    }


def make_bundle(scenario: AnyScenario, law: LawSpec, play: Play | None = None) -> Bundle:
    """The files for a law on a scenario; the same bytes for the same law, parameters and scenario.

    :param law: in fixed point, ``iq``, or in ``float32``.
    :param play: runs the bench with the controller passed to it, for a log that contains such a run.
    :raises InputError: unknown law or indexing, parameters of another law, or a law that cannot be written in C.
    """
    try:
        control = control_of(scenario, law)
        source = SourceWriter(control).write()
        return Bundle(source, _files(control, source, play))
    except ValueError as error:
        of_single = "operations of the arithmetic that single precision has"
        of_fixed = "operations of the arithmetic, formats that agree, no branch on data"
        allowed = of_single if law.arithmetic == "float32" else of_fixed
        raise InputError("controller", law.controller, Words(str(error)), allowed) from error


def _files(control: Control, source: Source, play: Play | None) -> dict[str, str]:
    name, body = source.name, BODIES[control.law.arithmetic]
    return {
        f"{name}.c": source.source,
        f"{name}.h": source.header,
        body.header: template(body.header, name, NAMES=names_of_iqmath()),
        **node_files(name, control, source, f"{name}_node"),
        f"{name}_log.txt": reference_log(control, source.columns, play),
        "railhil_result.h": template("railhil_result.h", name),
        "railhil_run.c": _host_program(name, control),
        "Makefile": template(
            "Makefile",
            name,
            ARITHMETIC=body.header,
            FLAGS=body.flags,
            LIBRARIES=body.libraries,
            NODE_C=" ".join(dict.fromkeys((*control.sources, *_SOURCES))),
            NODE_H=" ".join(dict.fromkeys((*control.headers, *_HEADERS))),
        ),
        "controller.toml": template(
            "controller.toml",
            name,
            NAME=control.law.controller,
            SYSTEM=control.scenario.system,
            ARITHMETIC=control.law.arithmetic,
            LABEL=control.law.label,
        ),
        "README.md": memory_note(control, source),
    }


def write_bundle(bundle: Bundle, folder: Path, *, force: bool = False) -> None:
    """Write the files: on return the folder contains all of them, otherwise an error is raised.

    :param force: write into a folder that is not empty; other files there are kept.
    :raises InputError: the folder is not empty, or cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not force and any(folder.iterdir()):
            found = Words("is not empty")
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
        why = Words(f"cannot be written: {describe_os_error(error)}")
        raise InputError(folder, "", why, "a folder that can be written") from error
