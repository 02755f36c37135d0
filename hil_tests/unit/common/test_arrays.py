"""Distinct values are those of numpy."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from railhil.common.arrays import distinct


@pytest.mark.parametrize("kind", [np.int64, np.uint32, np.float64])
@pytest.mark.parametrize("values", [[], [3], [2, 2, 2], [3, 1, 2, 1, 3, 0], [0, 5, 5, 9]])
def test_distinct_is_unique(values: list[int], kind: type) -> None:
    given = np.array(values, kind)
    found = distinct(given)
    assert found.dtype == given.dtype
    assert found.tolist() == np.unique(given).tolist()


def test_no_masked_arrays_are_loaded_for_it() -> None:
    code = "import sys; from railhil.common.arrays import *; distinct(np.arange(3)); print('numpy.ma' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
