"""The audit detects defects of an arithmetic: every limit can be missed, every figure is correct."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from types import SimpleNamespace
from typing import Any

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.plug import with_system
from hil_tests.support.scores import with_values
from railhil.audit.bars import bars
from railhil.audit.bounds import bounds_of
from railhil.audit.document import document
from railhil.audit.effect import Effect, ScoreEffect, compared, effect
from railhil.audit.result import Options, audit
from railhil.audit.shadow import (
    Codes,
    QuantityError,
    Shadowed,
    ShadowRun,
    Watched,
    compare_codes,
    errors,
    floored,
    shadow_run,
)
from railhil.audit.tables import show
from railhil.bench import local_run
from railhil.bus.frame import Frame
from railhil.common.errors import InputError
from railhil.common.output import Output
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, Counters
from railhil.controller_node.cost import cost_of
from railhil.controller_node.law_controller import CommandCode
from railhil.controller_node.program.model import Quantity, Value
from railhil.controller_node.program.tracer import record
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato import ATO
from railhil.systems.ato.judge.criteria import CRITERIA
from railhil.systems.ato.standstill import look
from railhil.wire.ato import TrnSpeed

FULL = load("lvshun_tieshan")
IQ: Any = type(make("iq"))


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """8 m in 8 s: a little more than 16 control periods."""
    path = tmp_path_factory.mktemp("audit") / "short.toml"
    path.write_text(QUICK_TOML)
    return load(str(path))


def shadowed(arithmetic: Arithmetic[Any], others: Sequence[Arithmetic[Any]] = (), scenario=FULL) -> ShadowRun:
    return shadow_run(scenario, LawSpec(), arithmetic, others=others)


def notch_codes(audited: Watched, reference: Watched) -> Codes:
    (found,) = compare_codes(audited, reference)
    assert found.command.name == "notch"
    return found


@pytest.fixture(scope="module")
def sound() -> ShadowRun:
    """The shipped fixed-point arithmetic, with its floored twin as a second shadow."""
    return shadowed(make("iq"), [floored(make("iq"))])


def missed(shadow: ShadowRun, arithmetic: Any = None) -> set[str]:
    """Names of the limits that are missed."""
    kind = arithmetic or type(make("iq"))
    price = cost_of(record(FULL, LawSpec()), kind(), FULL.timing.control_period_ns)
    return {bar.name for bar in bars(shadow, price, look=look(FULL, LawSpec(), kind)) if not bar.met}


def test_the_shipped_arithmetic_meets_every_bar(sound):
    assert missed(sound) == set()
    assert sound.run.score.values["stop_error_m"] is not None


def test_figures_of_the_shipped_arithmetic(sound):
    found = {error.name: error for error in errors(sound.quantities, sound.audited, sound.reference)}
    assert list(found) == [quantity.name for quantity in sound.quantities]
    # A rounded table entry is off by at most half an LSB, a floored product by one.
    assert 0.4 < found["set_point"].lsb(found["set_point"].maximum) <= 0.5
    assert -0.6 < found["speed"].lsb(found["speed"].bias) < -0.4
    assert 0.9 < found["speed"].lsb(found["speed"].maximum) < 1.01
    assert found["notch"].maximum <= 1 / 256
    assert found["notch_raw"].lsb(found["notch_raw"].maximum) < 50
    # In float64 the rise time for "never" is beyond the format: not an error of the arithmetic.
    assert found["t_s"].outside > 100
    assert {name for name, error in found.items() if error.outside} == {"t_s"}


def test_the_run_stays_inside_its_bounds(sound):
    bounds = bounds_of(sound.audited.controller)
    found = {bound.name: bound for bound in bounds.quantities}
    for row in sound.audited.telemetry.rows:
        bound = found[row.name]
        assert bound.minimum <= row.minimum, row.name
        assert row.maximum <= bound.maximum, row.name
        assert bound.headroom_bits <= row.headroom_bits, row.name
    # 7 notches are 1792 = 11 bits.
    assert (found["notch"].minimum, found["notch"].maximum, found["notch"].headroom_bits) == (-7.0, 7.0, 20)


def test_float64_has_no_error_against_itself():
    shadow = shadowed(make("float64"))
    for error in errors(shadow.quantities, shadow.audited, shadow.reference):
        assert (error.rms, error.maximum, error.bias, error.outside) == (0.0, 0.0, 0.0, 0), error.name
    assert notch_codes(shadow.audited, shadow.reference).equal_share == 1.0


class OffByOne(IQ):
    """Every sum of products is shifted by one bit too many."""

    def dot(self, coefficients: Sequence[int], values: Sequence[int], q: int) -> int:
        return super().dot(coefficients, values, q + 1)


class FlooredQuantiser(IQ):
    """The notch is truncated instead of rounded."""

    def quantise(self, a: int, q_from: int, q_to: int) -> int:
        return a >> (q_from - q_to)


class Narrow(IQ):
    """Speeds are a million times too large for their format: the first reading wraps."""

    def const(self, constant: Constant) -> int:
        return super().const(constant) << (20 if constant.name == "kmh_per_01mmps" else 0)


class Creeping(IQ):
    """Every sum of products is 4096 LSB too large: the model moves by itself."""

    def dot(self, coefficients: Sequence[int], values: Sequence[int], q: int) -> int:
        return super().dot(coefficients, values, q) + 4096


EQUAL, LARGEST = "notch codes equal to float64's", "largest difference of a notch code"
AT_REST, KICKED = "changes of the notch in 60 s at rest", "held train after one reading of 1 mm/s: difference"


@pytest.mark.parametrize(
    ("broken", "expected"),
    [
        (OffByOne, {EQUAL, LARGEST, KICKED}),
        (FlooredQuantiser, {EQUAL}),
        (Narrow, {"wraps in the run", EQUAL, LARGEST}),
        (Creeping, {EQUAL, LARGEST, AT_REST, KICKED}),
    ],
)
def test_a_broken_arithmetic_misses_its_bars(broken, expected):
    assert missed(shadowed(broken()), broken) == expected


def test_shadows_are_told_the_notch_really_sent():
    """Codes that differ by one do not make the states diverge: float64's model is given the same notches."""
    shadow = shadowed(FlooredQuantiser())
    assert notch_codes(shadow.audited, shadow.reference).equal_share < 0.7
    model = next(error for error in errors(shadow.quantities, shadow.audited, shadow.reference) if "y_m" in error.name)
    assert 0 < model.maximum < 5e-5


@pytest.mark.slow
def test_shadows_are_told_what_the_nodes_send_in_place_of_the_law_s_answer(tmp_path):
    """Through the nodes, 2 s without a reading: the controller's speed watch holds the notch, then brakes."""
    seen = 0

    def deaf(frame: Frame) -> list[Frame]:
        nonlocal seen
        seen += frame.can_id == TrnSpeed.port().address
        return [] if frame.can_id == TrnSpeed.port().address and 6000 <= seen < 6200 else [frame]

    law = LawSpec()
    reference = Watched(FULL, law, make("float64"))
    audited = Shadowed(FULL, law, make("iq"), [reference])
    run = local_run(FULL, tmp_path, RunSpec(law=law), wire=deaf, controller=audited)
    assert set(run.commands("notch")) - {code for (code,) in audited.codes}, (
        "the watch has sent what the law never answered"
    )
    assert notch_codes(audited, reference).largest <= 1
    model = next(error for error in errors(audited.quantities, audited, reference) if "y_m" in error.name)
    assert model.maximum < 5e-5


def test_an_audit_through_the_nodes_finds_the_same(short):
    """A system without a part ``direct``: every run goes through the nodes of the bench."""
    options = Options(runs=0)
    direct = document(audit(short, options))
    assert document(audit(with_system(short, replace(ATO, direct=None)), options)) == direct


def test_a_system_that_looks_at_nothing_more_has_no_such_section(short):
    plain = replace(ATO, audit=None)
    whole = document(audit(short, Options(runs=0)))
    result = audit(with_system(short, plain), Options(runs=0))
    found = document(result)
    assert set(whole) - set(found) == {"standstill"}
    assert [bar["name"] for bar in whole["bars"] if bar not in found["bars"]] == [AT_REST, KICKED]
    with redirect_stdout(StringIO()) as out:
        show(Output(), result)
    assert "Train held" not in out.getvalue()


def test_a_run_in_which_the_law_is_never_asked_is_refused(short, monkeypatch):
    monkeypatch.setattr("railhil.audit.shadow.unrecorded_run", lambda scenario, spec, controller: None)
    with pytest.raises(InputError, match="no control period: the readings never came"):
        shadow_run(with_system(short, replace(ATO, direct=None)), LawSpec(), make("iq"))


def test_floor_shows_as_bias_of_the_products(sound):
    rounded, twin = (
        {error.name: error for error in errors(sound.quantities, watched, sound.reference)}
        for watched in (sound.audited, sound.others[0])
    )
    # Sums of 9 and 7 products: each product is half an LSB too low on average.
    for name, products in (("c[0]", 9), ("e[0]", 7)):
        assert abs(rounded[name].lsb(rounded[name].bias)) < 0.5
        assert twin[name].lsb(twin[name].bias) < -products / 4
        assert twin[name].rms > rounded[name].rms
    # Quantities computed without rounded products are unchanged.
    for name in ("speed", "set_point", "tracking_error"):
        assert twin[name].bias == rounded[name].bias


def test_floored_products_and_a_rounded_quantiser():
    rounded, twin = make("iq"), floored(make("iq"))
    assert (rounded.rmpy(3, 1, 1), twin.rmpy(3, 1, 1), twin.rmpy(-3, 1, 1)) == (2, 1, -2)
    assert (rounded.dot([1, 1], [3, 3], 1), twin.dot([1, 1], [3, 3], 1)) == (4, 2)
    assert twin.quantise(3, 1, 0) == rounded.quantise(3, 1, 0) == 2
    assert twin.dot([2**30], [8], 1) == 0
    assert twin.counters.wraps == 1


def test_error_figures_by_hand():
    """Two periods of three quantities: errors of +1 and -3 LSB; one value outside the format; both outside."""
    quantities = [Quantity(name, q, "m", Value(0, q)) for name, q in (("a", 1), ("b", 30), ("c", 30))]
    reference = SimpleNamespace(rows=[[10.0, 1.0, 2.0], [10.0, 2.0, -2.0]])
    audited = SimpleNamespace(rows=[[10.5, 1.25, 0.0], [8.5, 0.0, 0.0]], arithmetic=SimpleNamespace(wide=False))
    a, b, c = errors(quantities, audited, reference)
    assert (a.rms, a.maximum, a.bias, a.worst_step, a.outside) == (pytest.approx(1.25**0.5), 1.5, -0.5, 1, 0)
    assert (a.lsb(a.maximum), a.lsb(a.bias)) == (3.0, -1.0)
    assert (b.rms, b.maximum, b.bias, b.worst_step, b.outside) == (0.25, 0.25, 0.25, 0, 1)
    assert c == QuantityError("c", 30, "m", None, None, None, None, 2)
    audited.arithmetic.wide = True
    audited.rows[0][2] = float("inf")
    assert [error.outside for error in errors(quantities, audited, reference)] == [0, 0, 1]


def test_an_infinite_value_misses_a_bar_and_leaves_the_result_readable(short):
    class Endless(type(make("float32"))):
        def note(self, name, a, q, unit=""):
            super().note(name, type(a)("inf") if name == "alpha" else a, q, unit)
            return a

    shadow = shadowed(Endless(), scenario=short)
    assert shadow.audited.not_finite == len(shadow.audited.rows)
    assert "infinite values" in missed(shadow, type(make("float32")))
    result = audit(short, Options(LawSpec(arithmetic="float32"), runs=0))
    rows = tuple(shadow.audited.telemetry.rows)
    found = {row["name"]: row for row in document(replace(result, ranges=rows))["ranges"]}
    assert found["alpha"]["maximum"] is None
    assert 0 < found["notch"]["maximum"] <= 7


def test_code_figures_by_hand():
    """Two commands, four periods."""
    commands = (CommandCode("notch", 8, "notch"), CommandCode("force", 0, "0.01 N"))
    audited = SimpleNamespace(codes=[(1, 7), (2, 7), (3, 7), (-4, 0)], controller=SimpleNamespace(commands=commands))
    notch, force = compare_codes(audited, SimpleNamespace(codes=[(1, 7), (2, 7), (1, 7), (-5, 9)]))
    assert (notch.command, force.command) == commands
    assert (notch.steps, notch.equal, notch.largest, notch.equal_share) == (4, 2, 2, 0.5)
    assert (force.steps, force.equal, force.largest, force.equal_share) == (4, 3, 9, 0.75)


@pytest.mark.parametrize(
    ("q", "unit", "shown"),
    [(8, "notch", "3/256 notch"), (0, "N", "3 N"), (0, "0.01 N", "3 x 0.01 N"), (-2, "N", "12 N"), (0, "", "3")],
)
def test_a_code_in_its_unit(q, unit, shown):
    assert CommandCode("force", q, unit).shown(3) == shown


def test_effect_bars():
    near = ScoreEffect("stop_error_m", "m", 0.31, 0.3, 0.0101, 0.1, 0)
    assert near.met
    assert near.difference == pytest.approx(0.01)
    assert not replace(near, audited=0.2).met
    assert not replace(near, audited=0.311).met
    # A train that stops in only one arithmetic is a difference that no median shows.
    assert not replace(near, missing=1).met
    assert not replace(near, audited=None, reference=None).met, "no run has it"


def test_effect_runs_the_same_draws_in_both(short):
    found = effect(short, 2, LawSpec("ipfc", "float64"))
    assert found.counters == Counters()
    assert [one.score for one in found.scores] == ["itae", "energy_kj", "punctuality_s", "stop_error_m", "comfort"]
    for one in found.scores:
        assert (one.difference, one.largest_single, one.missing) == (0.0, 0.0, 0)
        assert one.met
    allowed = {one.score: one.allowed for one in found.scores}
    assert allowed["stop_error_m"] == allowed["punctuality_s"] == 0.01
    assert allowed["itae"] == pytest.approx(0.01 * found.scores[0].reference)


def test_effect_compares_each_draw_with_its_own_twin(sound):
    """Fixed point: ITAE 12, 11, 10, no stop in the last run; float64: 10, 10, 10."""
    fixed, real = (
        [
            with_values(sound.run.score, itae=itae, stop_error_m=stop_m)
            for itae, stop_m in zip(itaes, stops_m, strict=True)
        ]
        for itaes, stops_m in (((12.0, 11.0, 10.0), (0.1, 0.1, None)), ((10.0,) * 3, (0.1,) * 3))
    )
    found = {one.score: one for one in compared(fixed, real, CRITERIA)}
    itae = found["itae"]
    assert (itae.audited, itae.reference, itae.difference, itae.largest_single) == (11.0, 10.0, 1.0, 2.0)
    assert not itae.met
    assert (found["stop_error_m"].missing, found["stop_error_m"].difference) == (1, 0.0)
    assert found["energy_kj"].met


@pytest.mark.slow
def test_a_wrap_in_a_perturbed_run_misses_a_bar_that_the_nominal_run_meets(short, sound):
    result = audit(short, Options(runs=2))
    assert {bar.found for bar in result.bars if bar.name == "wraps in the perturbed runs"} == {"0"}
    scores = [sound.run.score] * 2
    over_runs = Effect(compared(scores, scores, CRITERIA), Counters(1, 10, 2))
    result = replace(result, effect=over_runs, bars=bars(sound, result.cost, over_runs=over_runs))
    found = {bar.name: (bar.found, bar.met) for bar in result.bars}
    assert found["wraps in the run"] == ("0", True)
    assert found["wraps in the perturbed runs"] == ("1", False)
    assert found["divisions by zero in the perturbed runs"] == ("2", False)
    assert not result.met
    assert document(result)["effect_counters"] == {"wraps": 1, "saturations": 10, "zero_divisions": 2}
    with redirect_stdout(StringIO()) as out:
        show(Output(), result)
    assert "iq in all of them: 1 wraps, 10 saturations, 2 divisions by zero" in out.getvalue()


@pytest.mark.parametrize("indexing", ["time", "distance"])
def test_an_audit_is_deterministic_and_whole(short, indexing):
    found = [document(audit(short, Options(LawSpec(indexing=indexing), runs=0))) for _ in range(2)]
    assert found[0] == found[1]
    names = [quantity.name for quantity in record(short, LawSpec(indexing=indexing)).quantities]
    assert [row["name"] for row in found[0]["ranges"]] == names
    assert [error["name"] for error in found[0]["errors"]] == names
    assert [error["name"] for error in found[0]["floor"]["errors"]] == names
    assert found[0]["met"] == all(bar["met"] for bar in found[0]["bars"])
    assert found[0]["cost"]["flash_us"] == pytest.approx(2 * found[0]["cost"]["cycles"] / 150)


def test_an_arithmetic_without_formats_has_no_floor(short):
    result = audit(short, Options(LawSpec(arithmetic="float32"), runs=0))
    assert result.floor is None
    fixed_point = cost_of(record(short, LawSpec()), make("iq"), short.timing.control_period_ns)
    assert 0 < result.cost.cycles < fixed_point.cycles / 2
