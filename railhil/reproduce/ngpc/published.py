"""What the paper with one unit prints; that with three units prints curves only."""

from __future__ import annotations

from collections.abc import Mapping

from railhil.reproduce.ngpc.names import ADAPTIVE, BP, ELM

#: Sect. 6.1: RMSE of the model's output on 300 samples, km/h.
LINEAR_KMH, INTEGRATED_KMH = 1.454, 0.1653
#: Sect. 6.2: distance from the call for the emergency brake to the standstill, and the largest allowed one, m.
STOP_M, STOP_MAX_M = 4400.0, 4500.0
#: Table 1: average time of a simulation, min.
MINUTES: Mapping[str, float] = {BP: 12.6289, ELM: 2.30867, ADAPTIVE: 9.9892}
