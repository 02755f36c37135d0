"""Messages of the page's WebSocket: JSON texts, and rows of values as binary batches.

A batch: u32 kind, u32 run (place among the runs of the page), u32 rows, u32 columns, then the times as float64 and the
columns as float32, one column after the other, little-endian.
"""

from __future__ import annotations

import hmac
import json
import struct
from typing import Any

import numpy as np

from railhil.record.trace import FloatArray

SUBPROTOCOL = "railhil.panel.v1"
#: Code with which a WebSocket is closed (RFC 6455, 7.4.1).
POLICY_VIOLATION = 1008
#: Kinds of a batch: its rows continue the rows sent before, or replace them.
APPEND, REPLACE = 1, 2


def encode_batch(kind: int, run: int, rows: FloatArray) -> bytes:
    """A batch of rows of shape (n, 1 + columns), time first."""
    count, width = rows.shape
    times = np.ascontiguousarray(rows[:, 0], dtype="<f8").tobytes()
    values = np.ascontiguousarray(rows[:, 1:].T, dtype="<f4").tobytes()
    return struct.pack("<4I", kind, run, count, width - 1) + times + values


class TooDeep(ValueError):
    """JSON that is nested too deeply for an honest sender: the connection is closed."""


def parse_object(text: str | bytes) -> dict[str, Any]:
    """The object of a message.

    :raises TooDeep: it cannot be read.
    :raises ValueError: it is none, in words.
    """
    try:
        found = json.loads(text)
    except RecursionError:
        raise TooDeep("nested too deeply") from None
    except ValueError:
        raise ValueError("not JSON") from None
    if not isinstance(found, dict):
        raise ValueError("not an object")
    return found


def is_token(found: Any, token: str) -> bool:
    """Whether a message carries the token; the time of the comparison does not reveal it."""
    return isinstance(found, str) and hmac.compare_digest(found.encode(errors="replace"), token.encode())
