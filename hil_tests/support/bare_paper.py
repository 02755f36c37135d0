"""A paper whose figures need a library that is not installed."""

from __future__ import annotations

from dataclasses import replace

from hil_tests.support import short_paper
from railhil.reproduce.paper import Results


def figures(results: Results) -> list[object]:
    raise ModuleNotFoundError("No module named 'matplotlib'", name="matplotlib")


PAPER = replace(short_paper.PAPER, name="bare", figures=figures)
