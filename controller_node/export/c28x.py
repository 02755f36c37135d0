"""A recorded law as C28x instructions, and their cycles in one control period.

This is the code of a plain compiler of ours (:mod:`.c28x_writer`), which :mod:`.c28x_machine` executes. TI's compiler
may write shorter or longer code, and no chip has run this one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any, Final

from railhil.controller_node.export.c28x_machine import INSTRUCTIONS, Machine, signed
from railhil.controller_node.export.c28x_writer import Layout, Writer
from railhil.controller_node.program.model import LawProgram, Program

_MASK: Final = 0xFFFF_FFFF
#: Where the stack begins: block M1 of the F28335 (TI SPRS439).
_STACK = 0x0400


class Function:
    """One function of a law as instructions, run like the recorded program.

    :param machine: with the data of the law.
    :raises ValueError: the function has an operation for which there is no straight line of instructions.
    """

    def __init__(self, program: Program, layout: Layout, machine: Machine) -> None:
        self.stream = Writer(program, layout).stream
        self._machine = machine
        self._inputs = [(name, layout.place(name)) for name, _ in program.inputs]
        self._outputs = [(name, layout.place(name)) for name, _ in program.outputs]

    def run(self, inputs: Mapping[str, Any]) -> dict[str, Any]:
        """Outputs by name, raw integers like the inputs."""
        memory = self._machine.memory
        memory |= {address: inputs[name] & _MASK for name, address in self._inputs}
        self._machine.execute(self.stream)
        return {name: signed(memory[address]) for name, address in self._outputs}


class LawStream:
    """A law as instructions.

    ``period``: the instructions of one control period. ``cycles``: theirs, by operation, in memory without wait
    states. ``inactive``: how many of them the pipeline waits.

    :raises ValueError: like :class:`Function`.
    """

    def __init__(self, programs: LawProgram) -> None:
        self._layout, self._machine = Layout(), Machine()
        self._machine.sp = _STACK
        parts = (programs.step, programs.inputs, programs.start, programs.sent)
        self._functions = {part.name: Function(part, self._layout, self._machine) for part in parts}
        self._machine.memory |= self._layout.words
        self.period = [*self._functions["inputs"].stream, *self._functions["step"].stream]
        given = [name for part in (programs.inputs, programs.step) for name, _ in part.inputs]
        self._machine.memory |= {self._layout.place(name): 0 for name in given}
        taken = self._machine.measure(self.period)
        self.cycles: Counter[str] = Counter()
        for instruction, cycles in zip(self.period, taken, strict=True):
            self.cycles[instruction.operation] += cycles
        repeated = sum(of.number for of in self.period if of.syntax == "RPT #8bit")
        self.inactive = sum(taken) - repeated - sum(INSTRUCTIONS[of.syntax].cycles for of in self.period)

    @property
    def words(self) -> int:
        """Program memory of one control period, in 16-bit words."""
        return sum(INSTRUCTIONS[of.syntax].words for of in self.period)

    def function(self, program: Program) -> Function:
        """One function of the law, on data that all of them share."""
        return self._functions[program.name]

    def listing(self) -> str:
        """All functions and their data as text; an instruction is followed by the operation for which it is there."""
        lines = [
            "; C28x instructions of a recorded law: a model, which no chip has run and no tool of TI's has assembled."
        ]
        for name, function in self._functions.items():
            lines += ["", f"{name}:", *(f"    {of!s:<28}; {of.operation}" for of in function.stream)]
        lines += ["", "; data", *(f"{address:06X}  {name}" for name, address in self._layout.names.items())]
        return "\n".join(lines) + "\n"
