"""Scenario files of short runs."""

from __future__ import annotations

#: 72 m in 24 s. Recording continues for 1 s after the stop: longer than the overtime.
RUN_72M_TOML = """\
extends = "lvshun_tieshan"
name = "short"
title = "72 m in 24 s"
[target]
nodes_s_mps2 = [[0, 0.5], [11.9, 0.5], [12.1, -0.5], [24, -0.5]]
[plan]
distance_m = 71.9983
running_time_s = 24
overtime_max_s = 0.9
"""


#: 2 m in 4 s.
RUN_2M_TOML = """\
extends = "lvshun_tieshan"
name = "short"
[target]
nodes_s_mps2 = [[0, 0.5], [1.9, 0.5], [2.1, -0.5], [4, -0.5]]
[plan]
distance_m = 1.9983
running_time_s = 4
overtime_max_s = 1
"""


#: 297 m in 42 s, with 12 s above 40 km/h: what the fault catalogue needs of a journey.
RUN_297M_TOML = """\
extends = "lvshun_tieshan"
name = "short"
title = "297 m in 42 s"
[target]
nodes_s_mps2 = [[0, 0.7], [16, 0.7], [18, 0], [24, 0], [26, -0.7], [42, -0.7]]
[plan]
distance_m = 297.2667
running_time_s = 42
overtime_max_s = 3
"""
