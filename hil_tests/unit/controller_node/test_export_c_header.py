"""``railhil_iq.h`` of an export against the fixed-point arithmetic in Python, on edges and random numbers."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.exported import SANITIZED, written
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.scenarios.load import load

SCENARIO = load("lvshun_tieshan")
EDGES = (INT32_MIN, INT32_MIN + 1, -65537, -3, -1, 0, 1, 2, 255, 65536, 0x5A827999, INT32_MAX - 1, INT32_MAX)
FORMATS = (1, 8, 15, 24, 30)


@pytest.mark.slow
@pytest.mark.needs_compiler
def test_header_functions_equal_the_python_arithmetic(tmp_path: Path) -> None:
    """Every product, quotient, root and sum of the header on edges and random numbers, with its events."""
    written(SCENARIO, tmp_path)
    body = ['#include "railhil_iq.h"', "typedef int32_t (*f2)(int32_t, int32_t);"]
    for q in FORMATS:
        for name in ("mpy", "rmpy", "rsmpy", "div"):
            body.append(f"int32_t {name}_{q}(int32_t a, int32_t b) {{ return _IQ{q}{name}(a, b); }}")
        body.append(f"int32_t sqrt_{q}(int32_t a, int32_t b) {{ (void)b; return _IQ{q}sqrt(a); }}")
        body.append(f"int32_t iqx_{q}(int32_t a, int32_t b) {{ return _IQ{q}mpyIQX(a, 20, b, 3); }}")
        for name in ("product", "division"):
            body.append(f"uint32_t note_{name}_{q}(int32_t a, int32_t b) {{ iq_events_t e = {{0, 0}};")
            body.append(f"iq_note_{name}(a, b, {q}, &e); return e.saturations + 16 * e.zero_divisions; }}")
    for name in ("add", "sub", "min", "max"):
        body.append(f"int32_t {name}(int32_t a, int32_t b) {{ return iq_{name}(a, b); }}")
    body.append("int32_t size(int32_t a, int32_t b) { (void)b; return _IQ20abs(a); }")
    body.append("int32_t sat(int32_t a, int32_t b) { return _IQsat(a, b, 7); }")
    body.append("int32_t limit(int32_t a, int32_t b) { iq_events_t e = {0, 0};")
    body.append("const int32_t limited = iq_limit(a, b, -7, &e); return limited ^ (int32_t)(e.saturations << 20); }")
    source = tmp_path / "all.c"
    source.write_text("\n".join(body) + "\n")
    library = tmp_path / "all.so"
    flags = [*SANITIZED, "-fPIC", "-shared", "-I", str(tmp_path)]
    subprocess.run(["gcc", *flags, "-fsanitize-undefined-trap-on-error", str(source), "-o", str(library)], check=True)
    c = ctypes.CDLL(str(library))
    random = np.random.default_rng(11)
    pairs = [(a, b) for a in EDGES for b in EDGES]
    wide, shifts = random.integers(INT32_MIN, INT32_MAX + 1, (400, 2)), random.integers(0, 31, (400, 2))
    pairs += [(int(a), int(b)) for a, b in wide >> shifts]
    for a, b in pairs:
        _compare(c, a, b)


def _compare(c: ctypes.CDLL, a: int, b: int) -> None:
    iq: Any = make("iq")
    for q in FORMATS:
        expected = {
            f"mpy_{q}": iq.mpy(a, b, q),
            f"rmpy_{q}": iq.rmpy(a, b, q),
            f"sqrt_{q}": iq.sqrt(a, q),
            f"iqx_{q}": iq.mpy_iqx(a, 20, b, 3, q),
        }
        for name, operation in (("product", "rsmpy"), ("division", "div")):
            fresh: Any = make("iq")
            expected[f"{operation}_{q}"] = getattr(fresh, operation)(a, b, q)
            expected[f"note_{name}_{q}"] = fresh.counters.saturations + 16 * fresh.counters.zero_divisions
        for name, value in expected.items():
            assert c[name](a, b) == value, f"{name} of {a} and {b}"
    fresh = make("iq")
    limited = fresh.sat(a, b, -7)
    signed = (limited ^ (fresh.counters.saturations << 20)) & 0xFFFFFFFF
    plain = {"add": iq.add(a, b), "sub": iq.sub(a, b), "min": min(a, b), "max": max(a, b), "size": iq.abs(a)}
    plain |= {"sat": iq.clip(a, b, 7), "limit": signed - (1 << 32) if signed >> 31 else signed}
    for name, value in plain.items():
        assert c[name](a, b) == value, f"{name} of {a} and {b}"
