"""The safety gate under dense sweeps."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import pytest

from hil_tests.support.gate_sweeps import SWEEPS
from hil_tests.support.store_sweeps import PORTS, STORE_SWEEPS
from railhil.wire.ato import TrkInfo, TrnPos


@pytest.mark.parametrize(
    ("module", "sweep"),
    [(module, sweep) for module, sweeps in {**STORE_SWEEPS, **SWEEPS}.items() for sweep in sweeps],
    ids=lambda item: item.__name__,
)
def test_sweep(module: ModuleType, sweep: Any) -> None:
    sweep(module)


def test_sweeps_use_every_size_of_telegram() -> None:
    assert [port.f_code for port in PORTS] == [0, 1, 2, 3, 4]
    assert {TrnPos.PORT, TrkInfo.PORT} <= {port.name for port in PORTS}
