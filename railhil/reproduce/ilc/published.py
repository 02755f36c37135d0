"""What the paper prints. The other values of its table 2 and all of its table 1 are lost."""

from __future__ import annotations

from collections.abc import Mapping

from railhil.reproduce.ilc.names import EPSILON_M, NONE, PACKET

#: Tolerance (m) -> stop error (m) and iterations, table 2.
TABLE_2: Mapping[float, tuple[float, int]] = {EPSILON_M: (0.1, 5)}
#: Filter -> stop error (m) and iterations, table 3.
TABLE_3: Mapping[str, tuple[float, int]] = {NONE: (0.24, 8), PACKET: (0.11, 5)}
#: Figure 6: stop error after so many iterations.
ITERATIONS, ERROR_M = 5, 0.1
#: The limit, m.
LIMIT_M = 0.3
