"""The paper on precise stopping with a wavelet packet and iterative learning: figure 6 and tables 2 and 3; bounds of
railhil's specification, ours on a train with scatter, and memories that are damaged."""

from railhil.reproduce.ilc.figures import draw
from railhil.reproduce.ilc.findings import compare, judge
from railhil.reproduce.ilc.runs import TEXT, measure, plan
from railhil.reproduce.paper import Paper

PAPER = Paper("ilc", TEXT, plan, measure, compare, judge, draw)
