"""C99 in single precision for laws that have no fixed-point formats: the law only, without the controller around it.

One line of C for each recorded operation; the functions ``f32_*`` of ``railhil_f32.h`` give the bits of the arithmetic
``float32``.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Mapping, Sequence

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.arithmetic.float32 import nearest
from railhil.controller_node.export.body import Body
from railhil.controller_node.export.control import Source
from railhil.controller_node.export.source import c_name
from railhil.controller_node.export.text import Names, comment, header, identifier, template
from railhil.controller_node.program.model import Kind, LawProgram, Operation, Program, name_leaves
from railhil.controller_node.vector.controller import VectorController
from railhil.controller_node.vector.law import Interface, raw_range
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Operations whose formats have no meaning here.
_CALLS = dict.fromkeys(("mpy", "rmpy", "rsmpy", "mpy_iqx"), "f32_mul") | {
    "add": "f32_add",
    "sub": "f32_sub",
    "neg": "f32_neg",
    "abs": "f32_abs",
    "sqrt": "f32_sqrt",
    "div": "f32_div",
    "minimum": "f32_min",
    "maximum": "f32_max",
    "sat": "f32_clip",
    "clip": "f32_clip",
}


def number(value: float) -> str:
    """A constant as a hexadecimal literal of the nearest single."""
    return f"{nearest(value).hex()}f"


class SingleBody(Body):
    """The body of a function in single precision, with the operations on which an output depends.

    :param tables: of the C file, by name; those of the program are added.
    :param live: numbers of the values on which the outputs depend.
    :raises ValueError: an operation that single precision does not have.
    """

    number = "float"

    def __init__(
        self,
        names: Names,
        program: Program,
        tables: dict[str, Sequence[Constant]],
        places: Mapping[str, str],
        live: set[int],
    ) -> None:
        super().__init__(program, places, names)
        self._tables = tables
        for operation in program.operations:
            if operation.result.number in live:
                self._write(operation)

    def _constant(self, constant: Constant) -> str:
        return number(constant.value)

    def _write(self, operation: Operation) -> None:
        result = operation.result
        arguments = [self.expression(value) for value in operation.arguments]
        if operation.op == "convert":
            self._expressions[result.number] = arguments[0]
            return
        name = self._named(result)
        kind = "int" if result.kind is Kind.CONDITION else self.number
        self.lines.append(f"const {kind} {name} = {self._right(operation, arguments)};")
        self._expressions[result.number] = name

    def _call(self, operation: Operation, arguments: list[str]) -> str:
        listed = ", ".join(arguments)
        match operation.op:
            case "dot":
                half = len(arguments) // 2
                pairs = zip(arguments[:half], arguments[half:], strict=True)
                total, *rest = [f"f32_mul({a}, {b})" for a, b in pairs]
                for term in rest:
                    total = f"f32_add({total}, {term})"
                return total
            case "quantise":
                return f"f32_quantise({listed}, {operation.parameters[1]})"
            case "curve":
                assert operation.curve is not None
                table = identifier(operation.curve.name)
                if self._tables.setdefault(table, operation.curve.samples) != operation.curve.samples:
                    raise ValueError(f"two tables of the law are called {operation.curve.name}")
                return f"f32_curve({table}_table, {listed})"
        if operation.op not in _CALLS:
            raise ValueError(f"{operation.op} in single precision")
        return f"{_CALLS[operation.op]}({listed})"


def single_source(name: str, programs: LawProgram, interface: Interface, origin: str) -> Source:
    """The law as C: ``start(raw, state)``, ``step(state, raw, commands, notes)``, ``sent(state, told)``, each with the
    name before it.

    :param name: prefix in C.
    :param programs: recorded without formats (``wide``).
    :param origin: law and scenario, for the comment.
    :raises ValueError: an operation that single precision does not have.
    """
    tables: dict[str, Sequence[Constant]] = {}
    names = Names(taken=("raw", "told", "commands", "notes"))
    member_names = Names()
    leaves = [leaf for leaf, _ in programs.step.outputs if leaf.startswith("state")]
    members = {leaf: member_names.new(leaf.removeprefix("state.")) for leaf in leaves}
    state = {leaf: f"state->{member}" for leaf, member in members.items()}
    raws = {item.name: f"f32_from(raw[{i}], {item.q})" for i, item in enumerate(interface.readings)}
    read: dict[str, list[str]] = {}
    bodies: dict[str, SingleBody] = {}
    for word, program, places in (("start", programs.start, {}), ("step", programs.step, state)):
        live = _live(program, {leaf for leaf, _ in program.outputs})
        wanted = {leaf for leaf, value in program.inputs if value.number in live}
        reading = SingleBody(names, programs.inputs, tables, raws, _live(programs.inputs, wanted))
        given = {leaf: reading.expression(value) for leaf, value in programs.inputs.outputs if leaf in wanted}
        read[word] = reading.lines
        bodies[word] = SingleBody(names, program, tables, {**places, **given}, live)
    told = {item.name: f"f32_from(told[{i}], {item.q})" for i, item in enumerate(interface.commands)}
    live = _live(programs.sent, {leaf for leaf, _ in programs.sent.outputs})
    bodies["sent"] = SingleBody(names, programs.sent, tables, state | told, live)
    after = {word: body.assignments(state) for word, body in bodies.items()}
    step, outputs = bodies["step"], dict(programs.step.outputs)
    answers = [
        f"commands[{i}] = f32_raw({step.expression(outputs[f'out.commands[{i}]'])}, {item.q});"
        for i, item in enumerate(interface.commands)
    ]
    answers += [
        f"notes[{i}] = f32_raw({step.expression(outputs[f'out.notes[{i}]'])}, {item.law_q}) >> {item.law_q - item.q};"
        for i, item in enumerate(interface.notes)
    ]
    kind = f"{name}_state_t"
    signatures = {
        "start": f"void {name}_start(const int32_t *raw, {kind} *state)",
        "step": f"void {name}_step({kind} *state, const int32_t *raw, int32_t *commands, int32_t *notes)",
        "sent": f"void {name}_sent({kind} *state, const int32_t *told)",
    }
    functions = {
        "start": ["(void)raw;", *read["start"], *bodies["start"].lines, *after["start"]],
        "step": [*read["step"], *step.lines, *answers, *after["step"]],
        "sent": ["(void)told;", *bodies["sent"].lines, *after["sent"]],
    }
    head = [f"{comment(origin)}.", "Generated: change the law, not this file. Single precision, no branch except ?:."]
    wire = [
        "",
        f"raw: {', '.join(comment(item.name) for item in interface.readings)}.",
        f"commands, told: {', '.join(comment(item.name) for item in interface.commands)}.",
        f"notes: {', '.join(comment(item.name) for item in interface.notes)}.",
        "All are the raw integers of their telegrams, commands within the bounds of the law's interface.",
    ]
    structure = ["typedef struct {", *(f"    float {member};" for member in members.values()), f"}} {kind};", ""]
    body = [*structure, *(f"{signature};" for signature in signatures.values()), ""]
    source = [f"/* {head[0]}", f" * {head[1]}", " */", f'#include "{name}.h"', "", '#include "railhil_f32.h"', ""]
    for table, samples in tables.items():
        source += [f"static const float {table}_table[{len(samples)}] = {{"]
        source += [*(f"    {number(sample.value)}," for sample in samples), "};", ""]
    for word, signature in signatures.items():
        source += [signature, "{", *(f"    {line}" for line in functions[word]), "}", ""]
    text = header(f"{name.upper()}_H", [*head, *wire], ["<stdint.h>"], body)
    return Source(name, text, "\n".join(source), tuple(members.values()))


def _live(program: Program, outputs: set[str]) -> set[int]:
    """Numbers of the values on which these outputs depend."""
    live = {value.number for leaf, value in program.outputs if leaf in outputs}
    for operation in reversed(program.operations):
        if operation.result.number in live:
            live.update(argument.number for argument in operation.arguments)
    return live


#: Control periods of the log, and every how many of them other commands were sent.
_PERIODS = 400
_SENT_EVERY = 37


def single_files(scenario: AnyScenario, law: LawSpec) -> tuple[Source, dict[str, str]]:
    """The C source of a law on a scenario, and all files by name, in the order of their listing.

    :param law: in ``float32``.
    :raises InputError: the law cannot be made.
    :raises ValueError: it cannot be written in C.
    """
    controller = VectorController(scenario, law)
    interface, name = controller.interface, c_name(law.controller)
    source = single_source(name, controller.program, interface, f"law {law.controller}, scenario {scenario.name}")
    places = {
        "READINGS": str(len(interface.readings)),
        "COMMANDS": str(len(interface.commands)),
        "NOTES": str(len(interface.notes)),
    }
    return source, {
        f"{name}.c": source.source,
        f"{name}.h": source.header,
        "railhil_f32.h": template("railhil_f32.h", name),
        f"{name}_log.txt": _log(controller, interface),
        "railhil_single.c": template("railhil_single.c", name, **places),
        "Makefile": template("Makefile.single", name),
    }


def _log(controller: VectorController, interface: Interface) -> str:
    """Answers of the law in Python to smooth and sudden readings over their ranges."""
    lines = []
    told = [item.safe for item in interface.commands]
    for k, raws in enumerate(_readings(interface)):
        output = controller.step(raws)
        sent = k % _SENT_EVERY == _SENT_EVERY - 1
        if sent:
            controller.sent(*told)
        state = [_word(value) for _, value in name_leaves(controller.state)]
        flag = 2 if sent else int(k == 0)
        numbers = (flag, *raws, *told, *output.commands, *output.notes, *state)
        lines.append(" ".join(f"{number & 0xFFFFFFFF:08x}" for number in numbers))
    return "\n".join(lines) + "\n"


def _word(value: float) -> int:
    word: int = struct.unpack("<I", struct.pack("<f", value))[0]
    return word


def _readings(interface: Interface) -> Iterator[Sequence[int]]:
    """Each reading swings over a part of its range, all of them in step, with a small wave of its own and jumps."""
    ranges = [raw_range(item.telegram, item.field) for item in interface.readings]
    for k in range(_PERIODS):
        swing = 0.25 + 0.2 * math.sin(k / 40.0)
        row = []
        for i, (low, high) in enumerate(ranges):
            part = swing + 0.0005 * math.sin(k * 1.7 + i) + (0.3 if k % 90 == 89 else 0.0)
            row.append(min(high, max(low, low + round((high - low) * part))))
        yield row
