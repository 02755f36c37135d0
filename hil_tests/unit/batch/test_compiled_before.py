"""What ``make test`` compiles before the tests: every loop of every batch."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest

from hil_tests.prepared import BATCHES, compile_batches
from railhil.batch.compiled import FUNCTIONS
from railhil.scenarios.load import load_any
from railhil.scenarios.system import names, system_named


@pytest.mark.slow
def test_every_batch_is_compiled(tmp_path: Path) -> None:
    compile_batches(tmp_path)
    kernels = {system_named(load_any(name).system).kernel for name in BATCHES}
    every = {system_named(name).kernel for name in names()}
    # A system without a batch has no kernel.
    assert kernels == every - {None}
    modules = [import_module(str(kernel)) for kernel in kernels]
    loops = [one for one in FUNCTIONS if any(hasattr(module, one.name) for module in modules)]
    assert len(loops) >= len(modules)
    assert all(loop.is_there for loop in loops)
