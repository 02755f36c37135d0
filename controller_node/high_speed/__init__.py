"""Laws for high-speed trains, one a module; :mod:`.base` is their common part. Most are nonlinear predictive control.

Two papers are read here: "004", Xu et al. 2024 (one power unit, extreme learning machine), and "002", Geng et al. 2021
(three power units, BP network). D1 to D17 are the readings of places that they leave open or misprint; each is a named
option. The mathematics is written with the arithmetic, so that float64, float32, arrays and C come from one source.
"""
