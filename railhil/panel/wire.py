"""What goes over the page's WebSocket: JSON texts, and rows of values as binary batches.

A batch: u32 kind, u32 run (place among the runs of the page), u32 rows, u32 columns, then the times as float64 and the
columns as float32, one column after the other, little-endian.
"""

from __future__ import annotations

import struct

import numpy as np

from railhil.supervisor.trace import FloatArray

SUBPROTOCOL = "railhil.panel.v1"
#: Kinds of a batch: rows that continue those sent before, or replace them.
APPEND, REPLACE = 1, 2


def batch(kind: int, run: int, rows: FloatArray) -> bytes:
    """A batch of rows of shape (n, 1 + columns), time first."""
    count, width = rows.shape
    times = np.ascontiguousarray(rows[:, 0], dtype="<f8").tobytes()
    values = np.ascontiguousarray(rows[:, 1:].T, dtype="<f4").tobytes()
    return struct.pack("<4I", kind, run, count, width - 1) + times + values
