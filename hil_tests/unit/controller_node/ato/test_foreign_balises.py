"""The balises of the exported controller, telegram by telegram, compared with those of the Python node."""

from __future__ import annotations

import ctypes

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.exported import STRICT
from hil_tests.support.foreign import build, export_node
from railhil.controller_node.ato.balises import Balises
from railhil.controller_node.ato.odometer import Odometer
from railhil.scenarios.load import load
from railhil.wire.ato import BalisePassed, TrnPos

pytestmark = pytest.mark.needs_compiler

SCENARIO = load("lvshun_tieshan_worn_wheels")
_SHIM = """\
#include "railhil_position.h"
#include "ipfc_plus_node.h"
static railhil_odometer_t odometer;
static railhil_balise_t balise;
static uint32_t counts[RAILHIL_POSITION_OUTCOMES];
void afresh(void)
{
    memset(&odometer, 0, sizeof odometer);
    odometer.life = -1;
    odometer.run = RAILHIL_GOOD_POSITIONS;
}
void begin(void)
{
    memset(&balise, 0, sizeof balise);
    memset(counts, 0, sizeof counts);
    afresh();
}
void position(int64_t now_ns, const unsigned char *process) { railhil_position(&odometer, now_ns, process, counts); }
void passed(int64_t now_ns, const unsigned char *process)
{
    railhil_balise(&balise, &odometer, now_ns, process, counts);
}
const int32_t *last(void) { return balise.last; }
unsigned late(void) { return (unsigned)counts[RAILHIL_BALISE_LATE]; }
int beyond(int32_t here_01mm, int64_t place_01mm) { return railhil_is_beyond(&balise, here_01mm, place_01mm); }
"""


@pytest.fixture(scope="module")
def c(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    folder = tmp_path_factory.mktemp("export")
    export_node(SCENARIO, folder, law="ipfc_plus")
    (folder / "balises.c").write_text(_SHIM)
    flags = (*STRICT, "-O1", "-fPIC", "-shared", "-fsanitize=undefined", "-fsanitize-undefined-trap-on-error")
    sources = ["balises.c", "railhil_position.c", "railhil_clock.c"]
    library = ctypes.CDLL(str(build(folder, sources, "balises.so", flags)))
    library.last.restype = ctypes.POINTER(ctypes.c_int32)
    return library


@pytest.mark.slow
@settings(max_examples=300)
@given(
    heard=st.booleans(),
    passings=st.lists(
        st.tuples(
            st.integers(1, 5),
            st.one_of(st.integers(0, 200_000), st.integers(0, 20_000_000)),
            st.integers(0, 140_000),
            st.integers(-160_000, 160_000),
        ),
        min_size=1,
        max_size=5,
    ),
)
def test_they_are_placed_as_by_our_node(c: ctypes.CDLL, heard: bool, passings: list[tuple[int, int, int, int]]) -> None:
    """A standing train each time, so that only the balises differ; with and without a position."""
    c.begin()
    odometer, balises, place_mm = Odometer(SCENARIO), Balises(), 0
    for number, since_mm, late_mm, off_mm in passings:
        at_mm = place_mm + since_mm
        place_mm = at_mm + late_mm
        if heard:
            # An odometer of its own each time: a jump of this one would be refused.
            odometer = Odometer(SCENARIO)
            odometer.position(TrnPos(place_mm), 0)
            c.afresh()
            c.position(ctypes.c_int64(0), TrnPos(place_mm).encode())
        told = BalisePassed(number, at_mm + off_mm, at_mm & 0xFFFF)
        balises.take(told, *odometer.reckoned(0))
        c.passed(ctypes.c_int64(0), told.encode())
        assert tuple(c.last()[:3]) == balises.last
        assert c.late() == balises.counters["balise_late"]
        for beyond_mm in (at_mm - 500, at_mm, at_mm + 2000):
            for here_mm in (at_mm, at_mm + 2526):
                found = bool(c.beyond(10 * here_mm, ctypes.c_int64(10 * beyond_mm)))
                assert found == balises.is_beyond(10 * here_mm, 10 * beyond_mm)
