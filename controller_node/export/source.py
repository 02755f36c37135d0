"""The C file and header of a law: structures, tables and four functions."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from railhil.controller_node.export.body import Body, Data, remark, type_of
from railhil.controller_node.export.control import Control, Source, Word
from railhil.controller_node.export.fixed import FixedBody
from railhil.controller_node.export.single import SingleBody
from railhil.controller_node.export.text import LENGTH_MAX, Names, comment, header, literal
from railhil.controller_node.program.model import Kind, Program, Value, identifier

#: Arithmetics of the C.
BODIES: dict[str, type[Body]] = {"iq": FixedBody, "float32": SingleBody}
_PER_LINE = 5
#: Words (16 bits) on the target: return address of a call, a pointer, an int32.
_CALL_WORDS = 2
_POINTER_WORDS = 2
LONG_WORDS = 2
#: Deepest function of ``railhil_iq.h``: five 64-bit locals, three arguments, saved registers. Estimated.
_HELPER_WORDS = 40
#: Words of block M1 of the F28335, the usual place of the stack (TI SPRS439), and the words that a function of the law
#: may take; the rest is for the program around it and for interrupts.
STACK_WORDS = 1024
_FRAME_WORDS = 768
#: Longest name of a law that leaves room for the longest suffix.
_LAW_LENGTH_MAX = LENGTH_MAX - len("_MAILBOXES_H")


def c_name(law: str) -> str:
    """The law's name as a prefix in C and as a file name.

    :raises ValueError: it has too many characters.
    """
    name = identifier(law).lower()
    if len(name) > _LAW_LENGTH_MAX:
        raise ValueError(f"name of the law has {len(name)} characters, allowed {_LAW_LENGTH_MAX}")
    return name


class Struct:
    """A structure of members of 32 bits, one for each leaf of a law's state, inputs or outputs.

    :param number: C type of the members.
    :param group: ``state``, ``in`` or ``out``, the first part of the leaves' names.
    :param member_of: text from which the name of a leaf's member is made.
    :param remark_of: comment on a leaf.
    """

    def __init__(
        self,
        law: str,
        number: str,
        group: str,
        what: str,
        leaves: Sequence[tuple[str, Value]],
        member_of: Callable[[str], str],
        remark_of: Callable[[str, Value], str],
    ) -> None:
        names = Names()
        self.group, self.what = group, what
        self.type = f"{law}_{group}_t"
        self._types = {name: type_of(value, number) for name, value in leaves}
        self.members = {name: names.new(member_of(name)) for name, _ in leaves}
        self._remarks = {name: remark_of(name, value) for name, value in leaves}

    def place(self, leaf: str) -> str:
        """C expression of the leaf's member, through the pointer that the functions receive."""
        return f"{self.group}->{self.members[leaf]}"

    @property
    def places(self) -> dict[str, str]:
        """These expressions for all members, by leaf."""
        return {leaf: self.place(leaf) for leaf in self.members}

    def declaration(self) -> list[str]:
        """The structure in C."""
        lines = [f"/* {self.what} */", "typedef struct {"]
        for leaf, member in self.members.items():
            lines.append(f"    {self._types[leaf]} {member};{self._remarks[leaf]}")
        return [*lines, f"}} {self.type};"]


class SourceWriter:
    """Writes the two files of one law.

    :param control: the law, in one of :data:`BODIES`.
    :raises ValueError: the name is too long; from :meth:`write`, the law cannot be expressed in C or with the library.
    """

    def __init__(self, control: Control) -> None:
        programs, scenario = control.programs, control.scenario
        self._law = name = c_name(programs.law)
        self._programs = programs
        self._control = control
        self._comments = control.comments(name)
        self._origin = comment(f"law {programs.law}, scenario {scenario.name}, {control.law.set_points}")
        self._sha256 = scenario.sha256
        self._period_ns = scenario.timing.control_period_ns
        given, outputs = programs.inputs.outputs, programs.step.outputs
        units = {quantity.value.number: quantity.unit for quantity in programs.step.quantities}
        self._body = body = BODIES[control.law.arithmetic]

        def of_input(leaf: str, value: Value) -> str:
            return remark(value.q if body.has_formats else None, control.input_unit(leaf, value))

        def of_result(leaf: str, value: Value) -> str:
            q = value.q if body.has_formats else control.formats.get(leaf)
            return remark(q, units.get(value.number, "") if value.constant is None else "")

        member, state_member = control.member, lambda leaf: leaf.removeprefix("state.")
        number, state = body.number, _group(outputs, "state")
        self._in = Struct(name, number, "in", "Inputs of the law in a control period.", given, member, of_input)
        self._state = Struct(name, number, "state", "Memory of the law.", state, state_member, of_result)
        self._out = Struct(name, "int32_t", "out", "Outputs of the law.", _group(outputs, "out"), member, of_result)
        self._macros = control.macros()
        macro_names = Names(f"{name.upper()}_", taken=(f"{name.upper()}_{end}" for end in ("H", "PERIOD_NS")))
        self._macro_names = [macro_names.new(macro.signal.upper()) for macro in self._macros]
        self._data = Data(name, body.literal)
        self._stack: dict[str, int] = {}

    def write(self) -> Source:
        """The files and their size figures."""
        functions = [*self._inputs(), "", *self._start(), "", *self._step(), "", *self._sent()]
        structs = (self._in, self._state, self._out)
        columns = [f"{struct.group}.{member}" for struct in structs for member in struct.members.values()]
        columns += ["events.saturations", "events.zero_divisions"]
        tables = {name: LONG_WORDS * len(table.constants) for name, table in self._data.tables.values()}
        return Source(
            self._law,
            self._header(),
            "\n".join([*self._preamble(), *self._constants(), *self._tables(), "", *functions, ""]),
            tuple(columns),
            tuple(self._macro_names),
            tuple(self._out.members[leaf] for leaf in self._control.commands),
            tuple(constant for _, constant in self._data.constants.values()),
            tables,
            LONG_WORDS * len(self._data.constants),
            LONG_WORDS * len(columns),
            self._stack,
        )

    def _signatures(self) -> dict[str, list[str]]:
        events = "iq_events_t *events"
        taken = f"const {self._in.type} *in"
        return {
            "inputs": [
                *(f"int32_t {word.parameter}" for word in self._control.given),
                f"{self._in.type} *in",
                events,
            ],
            "start": [taken, f"{self._state.type} *state"],
            "step": [f"{self._state.type} *state", taken, f"{self._out.type} *out", events],
            "sent": [f"{self._state.type} *state", *(f"int32_t {word.parameter}" for word in self._control.told)],
        }

    def _header(self) -> str:
        law, signatures, comments = self._law, self._signatures(), self._comments
        structs = [line for struct in (self._in, self._state, self._out) for line in (*struct.declaration(), "")]

        def prototype(name: str) -> str:
            return f"void {law}_{name}({', '.join(signatures[name])});"

        return header(
            f"{law.upper()}_H",
            [
                f"{law}.h: {self._origin}.",
                f"Scenario SHA-256 {self._sha256}.",
                f"Generated: change the law, not this file. {self._body.value_words}",
                "",
                *comments.use,
            ],
            [self._body.header],
            [
                f"#define {law.upper()}_PERIOD_NS {literal(self._period_ns)} /* control period */",
                "",
                *structs,
                f"/* {comments.inputs}. */",
                prototype("inputs"),
                "",
                "/* State before the first control period, from the inputs of that period. */",
                prototype("start"),
                "",
                "/* One control period. */",
                prototype("step"),
                "",
                f"/* {comments.sent}. */",
                prototype("sent"),
                "",
                *self._note_macros(),
            ],
        )

    def _note_macros(self) -> list[str]:
        """Macros for the law's notes in the status: fraction bits are dropped, values limited to the signal."""
        if not self._macros:
            return []
        lines = [f"/* Notes of the law, in the format of {self._comments.status}. */"]
        for macro, macro_name in zip(self._macros, self._macro_names, strict=True):
            name = f"{macro_name}(out)"
            if macro.leaf is None:
                lines += [f"/* {macro.signal}: none */", f"#define {name} INT32_C(0)"]
                continue
            value = self._body.note(f"(out).{self._out.members[macro.leaf]}", macro.shift, *macro.limits)
            lines += [f"/* {macro.signal}: {comment(macro.words)} */", f"#define {name} {value}"]
        return [*lines, ""]

    def _preamble(self) -> list[str]:
        first, *others = self._body.code_words
        return [
            f"/* {self._law}.c: {self._origin}.",
            f" * Scenario SHA-256 {self._sha256}.",
            f" * Generated: change the law, not this file. {first}",
            *(f" * {line}" for line in others),
            " */",
            f'#include "{self._law}.h"',
            "",
        ]

    def _constants(self) -> list[str]:
        body = self._body
        lines = [f"/* Constants: {body.constant_words}. */"]
        for name, constant in self._data.constants.values():
            origin = constant.origin or f"law {self._law}, {constant.name}"
            form = f", Q{constant.q}" if body.has_formats else ""
            words = comment(f"{constant.value:.10g}{form}, {origin}")
            lines.append(f"static const {body.number} {name} = {body.literal(constant)}; /* {words} */")
        return lines

    def _tables(self) -> list[str]:
        body, lines = self._body, []
        for name, table in self._data.tables.values():
            raws = [body.literal(constant) for constant in table.constants]
            lines += ["", *([f"/* Q{table.constants[0].q} */"] if body.has_formats else [])]
            lines.append(f"static const {body.number} {name}[{len(raws)}] = {{")
            lines += [f"    {', '.join(raws[i : i + _PER_LINE])}," for i in range(0, len(raws), _PER_LINE)]
            lines.append("};")
        return lines

    def _inputs(self) -> list[str]:
        places = self._places(self._programs.inputs, self._control.given)
        return self._function("inputs", self._programs.inputs, places, (self._in,))

    def _start(self) -> list[str]:
        return self._function("start", self._programs.start, self._in.places, (self._state,))

    def _step(self) -> list[str]:
        places = self._state.places | self._in.places
        return self._function("step", self._programs.step, places, (self._state, self._out))

    def _sent(self) -> list[str]:
        told = self._places(self._programs.sent, self._control.told)
        return self._function("sent", self._programs.sent, self._state.places | told, (self._state,))

    def _places(self, program: Program, words: Sequence[Word]) -> dict[str, str]:
        """C expressions of the integers passed to a function, as the program's numbers."""
        values = dict(program.inputs)

        def place(word: Word) -> str:
            value = values[word.name]
            is_index = value.kind is Kind.INDEX
            return word.parameter if is_index else self._body.from_raw(word.parameter, value.q or 0)

        return {word.name: place(word) for word in words}

    def _function(
        self,
        name: str,
        program: Program,
        places: dict[str, str],
        into: Sequence[Struct],
        opening: Sequence[str] = (),
    ) -> list[str]:
        """A function of the law; its values share variables if they would need too much of the stack otherwise.

        :param opening: lines before its first operation.
        """
        signature = self._signatures()[name]
        parameters = [parameter.replace("*", " ").split()[-1] for parameter in signature]
        targets = {leaf: place for struct in into for leaf, place in struct.places.items()}
        for shared in (False, True):
            body = self._body(program, self._data, places, parameters, shared=shared)
            writes = body.assignments(targets, self._control.formats)
            frame = _CALL_WORDS + LONG_WORDS * body.locals + _POINTER_WORDS * len(parameters) + _HELPER_WORDS
            if frame <= _FRAME_WORDS:
                break
        self._stack[f"{self._law}_{name}"] = frame
        lines = [*opening, *body.lines, *writes]
        text = "\n".join(lines)
        if "events" not in parameters and _uses(text, "events"):
            raise ValueError(f"{name} of the law counts saturations or divisions by zero: clip limits without counting")
        unused = [f"(void){parameter};" for parameter in parameters if not _uses(text, parameter)]
        head = f"void {self._law}_{name}({', '.join(signature)})"
        return [head, "{", *(f"    {line}" for line in (*lines, *unused)), "}"]


def _group(leaves: Sequence[tuple[str, Value]], group: str) -> list[tuple[str, Value]]:
    return [(name, value) for name, value in leaves if name.startswith(f"{group}.")]


def _uses(text: str, parameter: str) -> bool:
    return re.search(rf"\b{parameter}\b", text) is not None
