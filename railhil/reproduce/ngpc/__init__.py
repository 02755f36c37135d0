"""The papers on nonlinear generalized predictive control of high-speed trains: with an extreme learning machine (one
power unit, DOI 10.12677/mos.2024.135479) and of three power units."""

from railhil.reproduce.ngpc.findings import compare, draw, judge
from railhil.reproduce.ngpc.runs import TEXT, curves, measure, plan
from railhil.reproduce.paper import Paper

PAPER = Paper("ngpc", TEXT, plan, measure, compare, judge, draw, curves)
