"""The weights of the filters, from ``taps.json`` (written by ``make_taps.py``, which needs PyWavelets)."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError

PATH = Path(__file__).with_name("taps.json")


@cache
def document(path: Path = PATH) -> dict[str, Any]:
    """The file: ``low_pass`` (16 numbers of db8), ``rate_hz``, and ``taps`` by filter, oldest sample first.

    :raises InputError: its numbers are not those that were recorded.
    """
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    text = json.dumps(found["taps"], sort_keys=True, separators=(",", ":"))
    sha256 = hashlib.sha256(text.encode()).hexdigest()
    if sha256 != found["taps_sha256"]:
        raise InputError(path, "taps_sha256", sha256, f"{found['taps_sha256']}, as recorded")
    return found


def taps(name: str) -> tuple[float, ...]:
    """Weights of one filter.

    :raises KeyError: there is no such filter.
    """
    return tuple(document()["taps"][name])
