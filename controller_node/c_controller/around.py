"""The C around a function of the user: that of an export, which calls the function in the place of a law.

Inputs, limits and rounding of the commands are those of the law without a program of the system
(:class:`railhil.controller_node.given.computing.SkeletonLaw`), recorded like any law; readings are its inputs times a
factor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.export.bundle import control_of, node_files
from railhil.controller_node.export.control import Control
from railhil.controller_node.export.source import BODIES, SourceWriter
from railhil.controller_node.export.text import comment, header, template
from railhil.controller_node.given.computing import Quantity, Terms, asked_name
from railhil.controller_node.program.model import Kind
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Name of the law in C; the user's function has the name of the controller.
PREFIX = "given"
ARITHMETIC = "float32"
_HOST = ("railhil_pipe.c", "railhil_socket.c", "railhil_slcan.c", "railhil_node.c")


def given_files(scenario: AnyScenario, law: LawSpec, terms: Terms) -> dict[str, str]:
    """Files by name: the C around the user's function ``NAME_step``, and ``NAME.h`` with its readings and commands.

    :param law: of a controller of the user, in :data:`ARITHMETIC`.
    :raises InputError: like :func:`~railhil.controller_node.export.bundle.control_of`.
    """
    name, control = law.controller, control_of(scenario, law)
    control.programs = replace(control.programs, law=PREFIX)
    source = _Writer(control, name, terms).write()
    body = BODIES[law.arithmetic]
    node = node_files(PREFIX, control, source, f"{name}_node")
    around = [file for file in node if file.endswith(".c") and file not in _HOST]
    return {
        f"{name}.h": _user_header(name, scenario.system, terms),
        f"{PREFIX}.c": source.source,
        f"{PREFIX}.h": source.header,
        body.header: template(body.header, PREFIX),
        **node,
        "given_interface.c": template("given_interface.c", PREFIX, NAME=name, INTERFACE=terms.interface),
        "given.mk": template(
            "given.mk", PREFIX, NAME=name, FLAGS=body.flags, AROUND=" ".join([f"{PREFIX}.c", *around]),
            HOST=" ".join(_HOST),
        ),
    }  # fmt: skip


def _user_header(name: str, system: str, terms: Terms) -> str:
    def members(quantities: Sequence[Quantity]) -> list[str]:
        return [f"    float {one.name};{f' /* {comment(one.unit)} */' if one.unit else ''}" for one in quantities]

    prefix = name.upper()
    return header(
        f"{prefix}_H",
        [
            f"{name}.h: what the controller {name} is given and what it answers, in system {system}.",
            "Generated with the C around the controller: do not edit.",
        ],
        [],
        [
            "#ifdef __cplusplus",
            'extern "C" {',
            "#endif",
            "",
            f"/* Contents of the symbol {name}_interface of a shared library. */",
            f'#define {prefix}_INTERFACE "{terms.interface}"',
            f"#define {prefix}_PERIOD_S {_literal(terms.period_s)}",
            *(line for one in terms.commands for line in _command_defines(prefix, one)),
            "",
            "typedef struct {",
            *members(terms.readings),
            f"}} {name}_readings_t;",
            "",
            "typedef struct {",
            *members(terms.commands),
            f"}} {name}_commands_t;",
            "",
            f"/* One control period of {prefix}_PERIOD_S: writes each member of out, a finite number. */",
            f"void {name}_step(const {name}_readings_t *in, {name}_commands_t *out);",
            "",
            "/* May be left out: before the first control period of a run. */",
            f"void {name}_reset(void);",
            "",
            "#ifdef __cplusplus",
            "}",
            "#endif",
            "",
        ],
    )


def _command_defines(prefix: str, one: Quantity) -> list[str]:
    """What the bench makes of a command, where that is stated."""
    name = f"{prefix}_{one.name.upper()}"
    return [
        *([] if one.least is None else [f"#define {name}_MIN {_literal(one.least)}"]),
        *([] if one.largest is None else [f"#define {name}_MAX {_literal(one.largest)}"]),
        *([] if one.step is None else [f"#define {name}_STEP {_literal(one.step)}"]),
    ]


def _literal(value: float) -> str:
    return f"{float(value)!r}f"


class _Writer(SourceWriter):
    """Writes the two files of the law without a program, with calls of the user's functions."""

    def __init__(self, control: Control, name: str, terms: Terms) -> None:
        super().__init__(control)
        self._name, self._terms = name, terms

    def _preamble(self) -> list[str]:
        name = self._name
        return [
            *super()._preamble()[:-1],
            f'#include "{name}.h"',
            "",
            "/* Functions that other files may have instead. */",
            f"__attribute__((weak)) void {name}_reset(void)",
            "{",
            "}",
            "",
            "__attribute__((weak)) void railhil_fail(const char *line)",
            "{",
            "    (void)line;",
            "    for (;;) {",
            "    }",
            "}",
            "",
        ]

    def _start(self) -> list[str]:
        places = self._in.places
        return self._function("start", self._programs.start, places, (self._state,), [f"{self._name}_reset();"])

    def _step(self) -> list[str]:
        name, commands = self._name, self._terms.commands
        asked = {asked_name(one): f"commands.{one.name}" for one in commands}
        opening = [
            f"{name}_readings_t readings;",
            f"{name}_commands_t commands;",
            *(f"readings.{one.name} = {self._reading(one)};" for one in self._terms.readings),
            *(f"commands.{one.name} = NAN;" for one in commands),
            f"{name}_step(&readings, &commands);",
        ]
        for one in commands:
            opening += [
                f"if (!(commands.{one.name} >= -FLT_MAX && commands.{one.name} <= FLT_MAX)) {{",
                f'    railhil_fail("{name}_step: {one.name} is no finite number");',
                "}",
            ]
        places = self._state.places | self._in.places | asked
        return self._function("step", self._programs.step, places, (self._state, self._out), opening)

    def _reading(self, one: Quantity) -> str:
        """The member of a law's inputs or state, in the unit of the reading."""
        places = self._in.places | self._state.places
        kinds = {leaf: value.kind for leaf, value in self._programs.inputs.outputs}
        place = places[one.leaf]
        if kinds.get(one.leaf) is Kind.INDEX:
            place = self._body.from_raw(place, 0)
        factor = self._body.literal(Constant(one.name, one.factor, 0))
        return place if one.factor == 1 else f"f32_mul({place}, {factor})"
