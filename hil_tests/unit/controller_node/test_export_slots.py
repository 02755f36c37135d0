"""Variables that the values of an exported function share."""

from __future__ import annotations

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.export.body import Data
from railhil.controller_node.export.fixed import FixedBody
from railhil.controller_node.program.model import Program, Value
from railhil.controller_node.program.tracer import Tracer


def traced() -> Program:
    """``twice`` is needed to the end, the others for a few operations."""
    tracer = Tracer()
    program = tracer.begin("step")
    x, y = tracer.input("x", 16), tracer.input("y", 16)
    weights = [tracer.const(Constant(name, value, 30)) for name, value in (("a", 0.5), ("b", 0.25))]
    twice = tracer.add(x, x)
    total = tracer.add(x, y)
    mean = tracer.dot(weights, (total, twice), 30)
    larger = tracer.gt(mean, x)
    out = tracer.where(larger, mean, tracer.sub(total, mean))
    outputs: list[tuple[str, Value]] = [("twice", twice), ("out", out)]
    program.outputs = outputs
    return program


def test_a_variable_is_used_again_once_its_value_is_not_needed() -> None:
    places = {"x": "in->x", "y": "in->y"}
    body = FixedBody(traced(), Data("law", FixedBody.literal), places, ("in",), shared=True)
    assert body.lines == [
        "int32_t w0, w1, w2;",
        "int c0;",
        "w0 = iq_add(in->x, in->x); /* Q16 */",
        "w1 = iq_add(in->x, in->y); /* Q16 */",
        "w2 = _IQ30rmpy(LAW_A, w1); /* Q16 */",
        "w2 = iq_add(w2, _IQ30rmpy(LAW_B, w0));",
        "c0 = w2 > in->x;",
        "w1 = iq_sub(w1, w2); /* Q16 */",
        "w1 = c0 ? w2 : w1; /* Q16 */",
    ]
    assert body.locals == 4
    apart = FixedBody(traced(), Data("law", FixedBody.literal), places, ("in",))
    assert apart.locals == 6
    assert all(line.startswith(("const ", "int32_t ", "v")) for line in apart.lines)
