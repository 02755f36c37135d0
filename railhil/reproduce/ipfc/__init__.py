"""The paper of IPFC: Tables 1 and 2 and figures 6 to 9, measured on the published scenario."""

from railhil.reproduce.ipfc.findings import compare, draw, judge
from railhil.reproduce.ipfc.runs import TEXT, curves, measure, plan
from railhil.reproduce.paper import Paper

PAPER = Paper("ipfc", TEXT, plan, measure, compare, judge, draw, curves)
