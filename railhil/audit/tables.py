"""Output of an audit on the terminal: tables at most 100 columns wide."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.table import Table

from railhil.audit.effect import Effect
from railhil.audit.result import Audit, Floor
from railhil.audit.shadow import QuantityError
from railhil.common.digits import percent
from railhil.common.output import Output, titled_table
from railhil.controller_node.cost import CPU_MHZ, FLASH_FACTOR
from railhil.controller_node.laws.constant_table import COARSE
from railhil.judge.score import Score

#: Bits of headroom below which a quantity is flagged.
_HEADROOM_MIN_BITS = 1
#: Errors above this are printed with an exponent.
_LSB_PLAIN_MAX = 1e5


def _columns(title: str, left: Sequence[str], right: Sequence[str], rows: Iterable[Sequence[str]] = ()) -> Table:
    return titled_table(title, left, right, rows, is_whole=False)


def _number(value: float | None, digits: int = 4) -> str:
    return "-" if value is None else f"{value:.{digits}g}"


def _left(bits: int | None) -> str:
    """Headroom, flagged if below the minimum."""
    if bits is None:
        return "-"
    return f"{bits} !" if bits < _HEADROOM_MIN_BITS else f"{bits}  "


def _ranges(result: Audit) -> Table:
    made = _columns(
        "Range and headroom",
        ("quantity", "unit"),
        ("Q", "minimum", "maximum", "bits", "headroom", "at bound", "wraps", "sat", "x/0"),
    )
    at_bound = {} if result.bounds is None else {bound.name: bound.headroom_bits for bound in result.bounds.quantities}
    for row in result.ranges:
        made.add_row(
            row.name,
            row.unit,
            str(row.q),
            _number(row.minimum),
            _number(row.maximum),
            "-" if row.used_bits is None else str(row.used_bits),
            _left(row.headroom_bits),
            _left(at_bound.get(row.name)),
            str(row.wraps),
            str(row.saturations),
            str(row.zero_divisions),
        )
    return made


def _errors(result: Audit) -> Table:
    period_s = result.scenario.timing.control_period_ns / 1e9
    made = _columns(
        f"Error of {result.options.law.arithmetic} against float64 on the same inputs (LSB: last bit of the format)",
        ("quantity", "unit"),
        ("RMS", "max", "bias", "RMS LSB", "max LSB", "bias LSB", "max at s", "out"),
    )
    for error in result.errors:
        made.add_row(
            error.name,
            error.unit,
            _number(error.rms, 2),
            _number(error.maximum, 2),
            _number(error.bias, 2),
            *(_lsb(error, value) for value in (error.rms, error.maximum, error.bias)),
            "-" if error.worst_step is None else f"{error.worst_step * period_s:g}",
            str(error.outside or ""),
        )
    return made


def _lsb(error: QuantityError, value: float | None) -> str:
    if value is None:
        return "-"
    lsb = error.lsb(value)
    return f"{lsb:.2f}" if abs(lsb) < _LSB_PLAIN_MAX else f"{lsb:.1e}"


def _floor(result: Audit, floor: Floor) -> Table:
    rows = (
        [one.name, *(_lsb(one, value) for value in (one.bias, floored.bias, one.rms, floored.rms))]
        for one, floored in zip(result.errors, floor.errors, strict=True)
    )
    heads = ("bias rmpy", "bias mpy", "RMS rmpy", "RMS mpy")
    return _columns("Rounded (rmpy) and floored (mpy) products, LSB", ("quantity",), heads, rows)


def _scores(result: Audit) -> Table:
    names = [result.options.law.arithmetic, "float64"]
    columns: list[Score] = [result.score, result.reference_score]
    if result.floor is not None:
        names.append("floored products")
        columns.append(result.floor.score)
    rows = ([one.key, one.unit, *(_number(score.values[one.key], 6) for score in columns)] for one in result.criteria)
    return _columns(f"Scores of the run (nominal, seed {result.options.seed})", ("score", "unit"), names, rows)


def _effects(result: Audit, effect: Effect) -> Table:
    heads = (result.options.law.arithmetic, "float64", "difference", "allowed", "largest of one run")
    rows = (
        [one.score, one.unit, _number(one.audited, 6), _number(one.reference, 6),
         *(_number(value, 3) for value in (one.difference, one.allowed, one.largest_single))]
        for one in effect.scores
    )  # fmt: skip
    return _columns(f"Medians of {result.options.runs} perturbed runs, same draws", ("score", "unit"), heads, rows)


def _bars(result: Audit) -> Table:
    made = _columns("Limits", ("", "requirement", "found", "allowed"), ())
    for bar in result.bars:
        verdict, style = ("PASS", None) if bar.met else ("FAIL", "bold red")
        made.add_row(verdict, bar.name, bar.found, bar.allowed, style=style)
    return made


def _say_cost(out: Output, result: Audit) -> None:
    cost, look = result.cost, result.look
    out.print("Cycles of one control period (estimate; straight-line, so every step is the worst step)", style="bold")
    out.print(", ".join(f"{count} {name}" for name, count in cost.operations.items()))
    out.print(
        f"{cost.cycles} cycles with program and data in RAM, {cost.cycles_flash} from flash (times {FLASH_FACTOR}); "
        f"at {CPU_MHZ} MHz {cost.ram_us:.1f} us and {cost.flash_us:.1f} us, {cost.share:.4%} of the control period "
        f"from flash"
    )
    out.print()
    if look is not None:
        out.print(look.title, style="bold")
        out.print(look.text)
        out.print()
    out.print(f"Constants rounded by more than {COARSE:g} of their value", style="bold")
    for constant in result.coarse_constants:
        out.print(f"{constant.name} = {constant.value:.6g}, Q{constant.q}: off by {constant.relative_error:.2g}")
    if not result.coarse_constants:
        out.print("none")
    out.print()


def show(out: Output, result: Audit) -> None:
    """Print everything."""
    options = result.options
    law = options.law
    out.say(f"{result.scenario.name}: {law.controller} in {law.arithmetic}, {law.set_points}, seed {options.seed}")
    out.print()
    out.print(_ranges(result))
    if result.bounds is not None:
        out.print(
            "headroom: bits left in the run; at bound: for any reading on the wire, by interval analysis, which "
            f"cannot exclude a wrap in {result.bounds.may_wrap} operations; !: less than {_HEADROOM_MIN_BITS} bit"
        )
    out.print()
    out.print(_errors(result))
    out.print()
    if any(error.outside for error in result.errors):
        out.print(
            "out: periods in which float64's value does not fit the format; the law limits it there, and they are "
            "left out of the figures"
        )
        out.print()
    if result.floor is not None:
        out.print(_floor(result, result.floor))
        for codes in result.floor.codes:
            out.print(
                f"{codes.command.name} codes with floored products: {percent(codes.equal_share)} equal to float64's, "
                f"largest difference {codes.command.shown(codes.largest)}"
            )
        out.print()
    out.print(_scores(result))
    out.print()
    if result.effect is not None:
        counters = result.effect.counters
        out.print(_effects(result, result.effect))
        out.print(
            f"{result.options.law.arithmetic} in all of them: {counters.wraps} wraps, "
            f"{counters.saturations} saturations, {counters.zero_divisions} divisions by zero"
        )
        out.print()
    _say_cost(out, result)
    out.print(_bars(result))
    out.print("all limits met" if result.met else "NOT all limits met", style=None if result.met else "bold red")
