"""README of an export: its files, memory, stack, time on the target, and the limits of its tests."""

from __future__ import annotations

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.cost import CPU_MHZ, cost_of
from railhil.controller_node.export.control import Control, Source
from railhil.controller_node.export.fixed import NAMED_Q
from railhil.controller_node.export.source import BODIES, STACK_WORDS
from railhil.controller_node.export.text import comment
from railhil.controller_node.program.model import LawProgram

#: 16-bit words of the F28335: RAM M0, M1, L0..L7; flash (TI SPRS439).
RAM_WORDS = 34 * 1024
FLASH_WORDS = 256 * 1024
#: A constant whose relative rounding error is larger than this is listed.
_ROUNDING_NAMED = 1e-4
#: Lines on single precision.
_SINGLE = (
    "- A compiler that contracts products and sums gives other bits: `-ffp-contract=off`.",
    "- A quotient is computed as by TI's fast library, but from another table of estimates: TI's is not published.",
    "- An overflow is infinite and not counted.",
)


def memory_note(control: Control, source: Source) -> str:
    """The README as Markdown text."""
    programs, scenario, law, name = control.programs, control.scenario, control.law, source.name
    is_fixed, arithmetic = law.arithmetic == "iq", BODIES[law.arithmetic].header
    cost = cost_of(programs, make(law.arithmetic), scenario.timing.control_period_ns)
    tables = sum(source.table_words.values())
    constants = source.constant_words + tables
    stack = max(source.stack_words.values())
    table_rows = [f"| table `{name}` | {words} |" for name, words in source.table_words.items()]
    period_ms = scenario.timing.control_period_ns / 1e6
    own = ", ".join(f"`{file}`" for file in (*control.sources, *control.headers))
    return "\n".join(
        [
            f"# Control law `{programs.law}` in C99",
            "",
            f"Scenario `{comment(scenario.name)}`, {law.set_points}, control period {period_ms:g} ms.",
            f"Scenario SHA-256 `{scenario.sha256}`.",
            "",
            "| file | what it is |",
            "|---|---|",
            f"| `{name}.c`, `{name}.h` | the law: `{name}_inputs`, `{name}_start`, `{name}_step`, `{name}_sent` |",
            "| `railhil_iq.h` | the C28x arithmetic on a host; on the target it uses TI's `IQmathLib.h` instead |"
            if is_fixed
            else "| `railhil_f32.h` | the arithmetic `float32` |",
            f"| `{name}_mailboxes.h` | the eCAN mailbox table, checked against the port table |",
            "| `railhil_filters.h` | acceptance filters of other CAN controllers: bxCAN, FDCAN and M_CAN, ZynqMP |",
            f"| `{name}_log.txt` | reference log: inputs, state and outputs computed by the bench's Python |",
            "| `railhil_control.c`, `railhil_clock.c`, `.h` | frames in, answers to polls out; simulation time |",
            "| `railhil_law.c`, `.h` | control periods of the law |",
            f"| {own} | {control.comments(name).node} |",
            "| `railhil_mvb.h`, `railhil_ports.h` | telegrams on CAN frames; their members, from the port table |",
            f"| `{name}_node.h` | constants of bus and scenario |",
            "| `railhil_node.c`, `railhil_socket.c`, `.h`, `railhil_slcan.c` | host program: SocketCAN, hub, slcan |",
            "| `railhil_pipe.c`, `.h` | frames by two streams of octets: `pipe`, boards without CAN |",
            "| `railhil_run.c`, `railhil_result.h`, `Makefile` | host program for the log, and its build |",
            "| `controller.toml` | for `railhil run --controller ./`, which runs this C as the controller |",
            "",
            f"`make node` builds the controller as a program: `./{name}_node can vcan0`, `./{name}_node hub PATH`.",
            "`make check` compiles and recomputes the log, `make ubsan` does so with the undefined behaviour",
            "sanitizer, `make stack` prints the stack use of each function on the host; `CC=clang` works too.",
            "",
            "## Memory on the target (words of 16 bits)",
            "",
            f"RAM has {RAM_WORDS} words, flash {FLASH_WORDS}. No memory is allocated and nothing is recursive.",
            "",
            "| what | words |",
            "|---|---|",
            f"| RAM: inputs, state, outputs, event counters | {source.ram_words} |",
            *table_rows,
            f"| single constants | {source.constant_words} |",
            f"| all constants, in flash{_warning(constants, FLASH_WORDS)} | {constants} |",
            f"| stack, estimated for cl2000{_warning(stack, STACK_WORDS)} | {stack} |",
            "",
            "The stack is an estimate for one compiler, TI's cl2000: every local variable in memory and none in a",
            f"register, with the call, its arguments and the deepest function of `{arithmetic}`. It is no bound: a",
            "compiler that makes more temporary values of its own needs more (`make stack` prints what the host's",
            "compiler takes). The size of the code depends on the compiler, too,",
            f"and is not included. Block M1, the usual place of the stack, has {STACK_WORDS} words.",
            "",
            "## Time on the target",
            "",
            "Straight-line code: every control period executes the same operations.",
            "",
            "| operation | count |",
            "|---|---|",
            *(f"| {operation} | {count} |" for operation, count in cost.operations.items()),
            "",
            f"About {cost.cycles} cycles, {cost.ram_us:.1f} us at {CPU_MHZ} MHz, from RAM; {cost.cycles_flash} cycles,",
            f"{cost.share:.3%} of the control period, from flash.",
            "Cycles of IQmath functions are TI's (user's guide V1.70), the others are estimated."
            if is_fixed
            else "Cycles of division and root are TI's (FPU fast RTS library), the others are estimated.",
            "",
            "## What has been tested, and what has not",
            "",
            "- On a host, state and outputs equal those of the Python law bit for bit: `make check` tests this.",
            "- `railhil target qemu` on this folder tests the same on an emulated Cortex-M3 or Cortex-M4F.",
            "- **It has not been run on a C28x.** To test it there, replay the log on the hardware.",
            *(_differences(programs) if is_fixed else _SINGLE),
            "- The target's `int` has 16 bits: literals are `INT32_C`, structures have 32-bit members only.",
            "- Compiler: C99. cl2000 should accept it with `--c99`; that has not been tried.",
            *(_roundings(source.constants) if is_fixed else ()),
            "",
        ]
    )


def _warning(words: int, available: int) -> str:
    return "" if words <= available else f" (**more than the {available} available**)"


def _differences(programs: LawProgram) -> list[str]:
    """Lines on operations for which TI's library and the host may give different bits."""
    operations = [operation for part in (programs.inputs, programs.step) for operation in part.operations]
    inexact = sorted({operation.op for operation in operations if operation.op in ("div", "sqrt")})
    wide = [operation for operation in operations if operation.op in ("rmpy", "dot", "mpy", "rsmpy")]
    unnamed = sorted({operation.parameters[0] for operation in wide} - set(NAMED_Q))
    lines = []
    if inexact:
        lines += [
            f"- With TI's library, {' and '.join(inexact)} may differ from the host by a few LSB: TI's are accurate to",
            "  28 bits at full scale. With `RAILHIL_USE_TI_IQMATH=0` the target gives the host's bits, more slowly.",
        ]
    if unnamed:
        listed = ", ".join(str(q) for q in unnamed)
        lines.append(
            f"- Products shifted by {listed}: the library supports at most 30; `railhil_iq.h` computes them in 64 bits."
        )
    return [*lines, "- Wraps are not counted. Saturations and divisions by zero are, in `iq_events_t`."]


def _roundings(constants: tuple[Constant, ...]) -> list[str]:
    """Lines on constants with a large relative rounding error in their format."""
    return [
        f"- Constant `{constant.name}` = {constant.value:.6g} is rounded by {constant.relative_error:.1e} of its value "
        f"in Q{constant.q}."
        for constant in constants
        if constant.relative_error > _ROUNDING_NAMED
    ]
