"""Packed classic frames (:mod:`railhil.bus.packing`) as columns. This is a module of its own so that the hub does not
load numpy."""

from __future__ import annotations

from typing import Final

import numpy as np

#: ``struct can_frame``: identifier with its flags, length of the data in bytes, data with zeros behind.
PACKED: Final = np.dtype(
    {"names": ["can_id", "length", "data"], "formats": ["=u4", "u1", "(8,)u1"], "offsets": [0, 4, 8], "itemsize": 16}
)
