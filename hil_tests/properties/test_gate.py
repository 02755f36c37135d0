"""The safety gate under dense sweeps, and the sweeps themselves: they must detect each mutant of the gate."""

from __future__ import annotations

import inspect
from types import ModuleType
from typing import Any

import pytest

from hil_tests.mutation.in_memory import survivors
from hil_tests.mutation.operators import mutants
from hil_tests.support.gate_sweeps import GATE_SWEEPS
from hil_tests.support.guard_sweeps import GUARD_SWEEPS
from hil_tests.support.store_sweeps import PORTS, STORE_SWEEPS
from railhil.bus import lifesign, store
from railhil.bus.telegrams import TrkInfo, TrnPos
from railhil.controller_node import guard
from railhil.plant_sim import gate

ALL_SWEEPS = {**STORE_SWEEPS, **GATE_SWEEPS, **GUARD_SWEEPS}
#: Equivalent mutants, which no test can detect, by module: (source line, change) and why.
EQUIVALENT: dict[ModuleType, dict[tuple[str, str], str]] = {
    lifesign: {
        ("self._last = -1", "1 -> 2"): "any negative number says 'none yet'",
    },
    store: {
        ("self.committed_ns = -1", "1 -> 2"): "any negative number says 'never'",
        ("part: int = 0", "0 -> 1"): "a refused frame has no part",
        ("part: int = 0", "0 -> -1"): "a refused frame has no part",
        # A trailer is refused as long as a block is missing.
        ("self.times_ns = [0] * port.blocks", "0 -> 1"): "read only when all blocks have come with their times",
        ("self.times_ns = [0] * port.blocks", "0 -> -1"): "read only when all blocks have come with their times",
        # The CAN FD length of F4, the only one that needs padding.
        ("self.fd_bytes = -(-self.fd_bytes // 16) * 16", "16 -> 17 (no. 2)"): "divisor: 40 / 17 is rounded up to 3 too",
        ("self.fd_bytes = -(-self.fd_bytes // 16) * 16", "16 -> 15 (no. 2)"): "divisor: 40 / 15 is rounded up to 3 too",
    },
    gate: {
        ("_RECENT_MASK = (1 << RECENT) - 1", "1 -> 2"): "bit 0 is free after the shift",
        ("_ORDER_MASK = (1 << ORDER) - 1", "1 -> 2"): "bit 0 is free after the shift",
        ("self._was_good = False", "False -> True"): "in __init__: the first command is never an old one",
    },
    guard: {
        # The first speed is a sample.
        ("self._sample_01mmps = 0", "self._sample_01mmps = 0 -> pass"): "read only after the first sample",
        ("self._sample_01mmps = 0", "0 -> 1"): "read only after the first sample",
        ("self._sample_01mmps = 0", "0 -> -1"): "read only after the first sample",
        ("self._speed_ns = -1", "1 -> 0"): "read only after the first speed",
        ("self._speed_ns = -1", "1 -> 2"): "read only after the first speed",
        # Without a safe channel.
        **{
            ("unconfirmed_ns = 0 if self.safe is None else self.safe.age_ns(now_ns)", change): "the watch sees whole ms"
            for change in ("0 -> 1", "0 -> -1")
        },
        # The quick comparison; the exact one decides at its edge.
        (
            "if not -self._step_01mmps <= change <= self._step_01mmps and not self._motion_limits.fits(",
            "-self._step_01mmps -> self._step_01mmps",
        ): "the exact comparison says the same",
        **{
            (
                "if not -self._step_01mmps <= change <= self._step_01mmps and not self._motion_limits.fits(",
                f"-self._step_01mmps <= change <= self._step_01mmps -> -self._step_01mmps {signs} self._step_01mmps",
            ): "the exact comparison says the same"
            for signs in ("< change <=", "<= change <")
        },
    },
}


@pytest.mark.parametrize(
    ("module", "sweep"),
    [(module, sweep) for module, sweeps in ALL_SWEEPS.items() for sweep in sweeps],
    ids=lambda item: item.__name__,
)
def test_sweep(module: ModuleType, sweep: Any) -> None:
    sweep(module)


def test_sweeps_use_every_size_of_telegram() -> None:
    assert [port.f_code for port in PORTS] == [0, 1, 2, 3, 4]
    assert {TrnPos.PORT, TrkInfo.PORT} <= {port.name for port in PORTS}


@pytest.mark.parametrize("module", ALL_SWEEPS, ids=lambda module: module.__name__)
def test_every_mutant_is_noticed(module: ModuleType) -> None:
    lines = inspect.getsource(module).splitlines()
    count, alive = survivors(module, ALL_SWEEPS[module])
    found = {(lines[mutant.line - 1].strip(), mutant.text) for mutant in alive}
    # Compared in both directions: a stale entry of the list would hide a mutant that is now detected.
    assert found == set(EQUIVALENT[module])
    assert count >= 20


def test_the_mutator_itself() -> None:
    source = '"""Doc."""\n\ndef f(a: int = 1) -> bool:\n    """Doc."""\n    b = not a\n    return a < 2 and b or True\n'
    texts = [mutant.text for mutant in mutants(source)]
    assert sorted(texts) == sorted(
        [
            "1 -> 2",
            "1 -> 0",
            "b = not a -> pass",
            "not a -> a",
            "a < 2 -> a <= 2",
            "a < 2 -> a >= 2",
            "2 -> 3",
            "2 -> 1",
            "a < 2 and b -> a < 2 or b",
            "a < 2 and b or True -> (a < 2 and b) and True",
            "True -> False",
            "return a < 2 and b or True -> return True",
            "return a < 2 and b or True -> return False",
        ]
    )


def test_a_check_that_sees_nothing_leaves_mutants_alive() -> None:
    count, alive = survivors(lifesign, [lambda module: None])
    # Those that do not even load (the enum's own machinery) are the only ones noticed.
    assert len(alive) >= count - 3
