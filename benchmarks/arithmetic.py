"""Operations of the C28x fixed point, one pair at a time and on arrays, against the fixed-point libraries of Python."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import add, mul, truediv
from typing import Any, TypeAlias

import numpy as np
from apytypes import APyFixed, APyFixedArray, OverflowMode, QuantizationMode
from fxpmath import Fxp
from numpy.typing import NDArray

from benchmarks.figures import Figure, MeasurementError, Setting, cpu_ns
from railhil.controller_node.arithmetic import make

TITLE = "arithmetic"
METHOD = (
    "Q24 in 32 bit. Million operations per second of CPU time, best of the blocks, in turns, on the same operands, "
    "random in -8..8. Scalar: a loop over pairs. fxpmath and apytypes are set to the rounding and overflow of the "
    "operation; their objects are made before, operator and cast are timed. plain int, numpy: (a * b) >> 24 with "
    "nothing checked. Right results: share of operands from all over int32 (wraps and saturations included) for which "
    "a library gives what the C28x gives; ours are checked against whole numbers, scalar and array."
)

_Q = 24
_BITS = 32
_INT_BITS = _BITS - _Q
_MASK = 2**_BITS - 1
#: Products stay inside int32, as in a law without overflow.
_OPERAND_MAX = 8 << _Q
_SCALAR_PAIRS = 200
_ARRAYS = (1000, 100_000)
_CHECKED = 10_000
_SEED = 20210825

Ints: TypeAlias = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation: its exact result before overflow handling, and the names of its settings in the other
    libraries."""

    name: str
    exact: Callable[[int, int], int]
    saturates: bool
    #: The corresponding Python operator.
    operator: Callable[[Any, Any], Any]
    quantization: Any
    fxp_rounding: str

    def wanted(self, a: int, b: int) -> int:
        """Result in integers."""
        exact = self.exact(a, b)
        if self.saturates:
            return min(max(exact, -(2**31)), 2**31 - 1)
        return (exact + 2**31) % 2**32 - 2**31

    @property
    def more(self) -> tuple[int, ...]:
        """Arguments of railhil's method after the operands."""
        return () if self.name == "add" else (_Q,)

    @property
    def cast(self) -> tuple[Any, ...]:
        """Format and modes of apytypes' result."""
        return (_INT_BITS, _Q, self.quantization, OverflowMode.SAT if self.saturates else OverflowMode.WRAP)

    def fxp(self, raw: Any) -> Fxp:
        """An operand of fxpmath, which includes its modes."""
        overflow = "saturate" if self.saturates else "wrap"
        return Fxp(raw, True, _BITS, _Q, raw=True, rounding=self.fxp_rounding, overflow=overflow, op_sizing="same")


_HALF = 1 << (_Q - 1)
OPERATIONS = (
    Operation("mpy", lambda a, b: (a * b) >> _Q, False, mul, QuantizationMode.TRN, "floor"),
    Operation("rmpy", lambda a, b: (a * b + _HALF) >> _Q, False, mul, QuantizationMode.RND, "around"),
    Operation("rsmpy", lambda a, b: (a * b + _HALF) >> _Q, True, mul, QuantizationMode.RND, "around"),
    Operation("div", lambda a, b: (2 * (a << _Q) + b) // (2 * b), True, truediv, QuantizationMode.RND, "around"),
    Operation("add", lambda a, b: a + b, False, add, QuantizationMode.TRN, "floor"),
)


def _operands(count: int, limit: int, seed: int) -> tuple[Ints, Ints]:
    """Two arrays of raw operands, none of them 0."""
    generator = np.random.Generator(np.random.PCG64(seed))
    first, second = (generator.integers(-limit, limit, count) for _ in range(2))
    return np.where(first == 0, 1, first), np.where(second == 0, 1, second)


def _apy_array(raw: Ints) -> Any:
    return APyFixedArray((raw & _MASK).tolist(), _INT_BITS, _Q)


def _apy_raw(numbers: Any) -> Ints:
    bits = np.array(numbers.to_bits(), dtype=np.int64)
    return np.where(bits >= 2**31, bits - 2**_BITS, bits)


def _right_figures(operation: Operation) -> list[Figure]:
    """Share of right results of the other libraries; railhil's must always be right."""
    a, b = _operands(_CHECKED, 2**31 - 1, _SEED)
    pairs = list(zip(a.tolist(), b.tolist(), strict=True))
    wanted = np.array([operation.wanted(x, y) for x, y in pairs])
    one, many = (getattr(make("iq", batch=batch), operation.name) for batch in (False, True))
    scalar = [one(x, y, *operation.more) for x, y in pairs]
    if scalar != wanted.tolist() or not np.array_equal(many(a, b, *operation.more), wanted):
        raise MeasurementError(f"arithmetic: {operation.name} does not give the C28x's results")
    fxp = operation.operator(operation.fxp(a), operation.fxp(b))
    apy = operation.operator(_apy_array(a), _apy_array(b)).cast(*operation.cast)
    theirs = {"apytypes": _apy_raw(apy), "fxpmath": np.asarray(fxp.val).astype(np.int64)}
    return [
        Figure(f"{operation.name}: right results of {name}", float(np.mean(found == wanted)) * 100, "%")
        for name, found in theirs.items()
    ]


def _speed_figures(what: str, per_call: int, taken_ns: dict[str, float]) -> list[Figure]:
    """Operations per second; the first entry is railhil's, the others are compared with it."""
    ours, ours_ns = next(iter(taken_ns.items()))
    return [
        Figure(
            f"{what}: {name}",
            per_call / ns * 1e3,
            "Mops/s",
            None if name == ours else ns / ours_ns,
            "" if name == ours else "ours to it",
        )
        for name, ns in taken_ns.items()
    ]


def _scalar_figures(operation: Operation, setting: Setting) -> list[Figure]:
    a, b = _operands(_SCALAR_PAIRS, _OPERAND_MAX, _SEED + 1)
    pairs = list(zip(a.tolist(), b.tolist(), strict=True))
    fxp_pairs = [(operation.fxp(x), operation.fxp(y)) for x, y in pairs]
    apy_pairs = [tuple(APyFixed(x & _MASK, _INT_BITS, _Q) for x in pair) for pair in pairs]
    arithmetic, operator = make("iq"), operation.operator
    method: Any = getattr(arithmetic, operation.name)
    int_bits, fraction_bits, quantization, overflow = operation.cast

    def ours() -> None:
        for x, y in pairs:
            method(x, y, _Q)

    def ours_add() -> None:
        for x, y in pairs:
            method(x, y)

    def apytypes() -> None:
        for x, y in apy_pairs:
            operator(x, y).cast(int_bits, fraction_bits, quantization, overflow)

    def fxpmath() -> None:
        for x, y in fxp_pairs:
            operator(x, y)

    def floor() -> None:
        for x, y in pairs:
            (x * y) >> _Q

    functions = {"ours": ours if operation.more else ours_add, "apytypes": apytypes}
    if operation.name == "mpy":
        functions["plain int"] = floor
    taken_ns = dict(zip(functions, cpu_ns(setting, *functions.values(), calls=20, blocks=30), strict=True))
    # Two calls with 200 operands take as long as a thousand of the others.
    (taken_ns["fxpmath"],) = cpu_ns(setting, fxpmath, calls=2, blocks=5)
    return _speed_figures(f"{operation.name}, scalar", _SCALAR_PAIRS, taken_ns)


def _array_figures(operation: Operation, count: int, setting: Setting) -> list[Figure]:
    a, b = _operands(count, _OPERAND_MAX, _SEED + 2)
    apy, fxp = (_apy_array(a), _apy_array(b)), (operation.fxp(a), operation.fxp(b))
    method, operator = getattr(make("iq", batch=True), operation.name), operation.operator
    functions: dict[str, Callable[[], object]] = {
        "ours": lambda: method(a, b, *operation.more),
        "apytypes": lambda: operator(*apy).cast(*operation.cast),
        "fxpmath": lambda: operator(*fxp),
    }
    if operation.name == "mpy":
        functions["numpy"] = lambda: (a * b) >> _Q
    calls = max(1, 20_000 // count)
    taken_ns = dict(zip(functions, cpu_ns(setting, *functions.values(), calls=calls, blocks=15), strict=True))
    return _speed_figures(f"{operation.name}, {count:,} at once", count, taken_ns)


def measure(setting: Setting) -> list[Figure]:
    """Speed of every operation scalar and on arrays, then the share of right results.

    :raises MeasurementError: one of railhil's operations gives a wrong result, scalar or batch.
    """
    figures: list[Figure] = []
    for operation in OPERATIONS:
        figures += _scalar_figures(operation, setting)
        for count in _ARRAYS:
            figures += _array_figures(operation, count, setting)
    for operation in OPERATIONS:
        figures += _right_figures(operation)
    return figures
