"""Write the laws out as straight-line functions: ``python -m railhil.controller_node.written.generate``.

``make tables`` does it too. One module for each shipped law and family of arithmetics, as :mod:`..program.writer`
writes it, and ``index.py``, which finds a function by the shape of a recorded program.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path

from railhil.controller_node.laws import load as load_law
from railhil.controller_node.program.model import Program
from railhil.controller_node.program.record import record
from railhil.controller_node.program.writer import FIXED, FLOAT32, FLOAT64, written
from railhil.controller_node.vector.controller import vector_program
from railhil.scenarios.load import load, load_any
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import system_named

#: The shipped laws of the system ``ato``.
LAWS = ("ipfc", "tpfc1", "tpfc2", "tdmc", "fuzzy_pid", "ipfc_plus", "ipfc_plus_stop")
#: Lines for which the programs are recorded: those of the other shipped lines have the same shapes. The formats of some
#: laws depend on the length of a run.
_SCENARIOS = ("lvshun_tieshan", "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan")
#: The law of the system ``stop`` that a sequence of runs teaches. It has one shape on all shipped scenarios but that in
#: which the train begins at rest; the shapes of the system's other laws depend on the balises.
STOP_LAW = "ilc_stop"
_STOP_SCENARIO = "yizhuang_stop"
_FAMILIES = {FIXED: "fixed point", FLOAT64: "double precision", FLOAT32: "single precision"}
_WRITER = "Written by ``make tables`` from the recorded program; do not edit."


def _programs(law: str, wide: bool) -> Iterator[tuple[Program, str]]:
    """Programs of a law, each with the name that its function shall have."""
    if law == STOP_LAW:
        scenario = load_any(_STOP_SCENARIO)
        program = vector_program(system_named(scenario.system), scenario, law, None, None, wide)
        yield from ((program.inputs, "inputs"), (program.step, "step"))
        return
    for indexing, name in product(load_law(law).indexings, _SCENARIOS):
        program = record(load(name), LawSpec(law, indexing=indexing), wide=wide)
        yield from ((program.inputs, f"inputs_by_{indexing}"), (program.step, "step"))


def texts() -> Iterator[tuple[str, str]]:
    """Name and text of every generated module."""
    functions: dict[str, str] = {}
    for law in (*LAWS, STOP_LAW):
        for family, title in _FAMILIES.items():
            module = f"{law}_{family}"
            parts: dict[str, str] = {}
            for part, wanted in _programs(law, family != FIXED):
                name = wanted if wanted not in parts else f"{wanted}_{len(parts)}"
                digest, text = written(part, family, name)
                if digest not in functions:
                    functions[digest], parts[name] = f"{module}:{name}", text
            yield f"{module}.py", _module(f"Law {law} in {title}. {_WRITER}", list(parts.values()))
    rows = "".join(f'    "{digest}": "{place}",\n' for digest, place in functions.items())
    text = (
        f'"""Functions by the digest of a program\'s shape. {_WRITER}"""\n\n'
        "from __future__ import annotations\n\n"
        "#: Digest -> module and function.\n"
        f"FUNCTIONS: dict[str, str] = {{\n{rows}}}\n"
    )
    yield "index.py", text


def _module(title: str, parts: list[str]) -> str:
    body = "\n\n".join(parts)
    names = {"array": "array", "bisect": "bisect_right"}
    imports = "".join(f"from {module} import {name}\n" for module, name in names.items() if f"{name}(" in body)
    imports += "\n" if imports else ""
    ours = "from railhil.controller_node.arithmetic.float32 import FLT_MAX, FLT_MIN\n" if "FLT_MAX" in body else ""
    return (
        f'"""{title}"""\n\nfrom __future__ import annotations\n\n{imports}{ours}'
        f"from railhil.controller_node.written.parts import Parts, Step, Values\n\n\n{body}"
    )


def main() -> None:
    """Write the modules beside this file."""
    folder = Path(__file__).parent
    count = 0
    for name, text in texts():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
        count += 1
    print(f"{folder.name}: {count} modules")


if __name__ == "__main__":
    main()
