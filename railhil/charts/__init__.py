"""Figures of pages and charts of the panel, and the code that draws both.

A figure is data (``figure.py``); a page has it as SVG (``svg.py``), which needs no script and is printed as it is;
``static/figures.js`` draws another range of it. The panel draws streams with uPlot 1.6.32 and arranges its tiles with
gridstack 14.1.0 (both MIT, licences beside them), in ``static/`` as published; ``SHA256SUMS`` are the digests of their
files; ``charts.js`` is ours. What a reader does with either (zoom, cursor, values, keys, fingers) is ``view.js``; its
first lines say how it is used. ``charts.css`` has the colours of both.
"""

from __future__ import annotations

from importlib.resources import files


def static_text(name: str) -> str:
    """Text of a file of ``static/``.

    :raises FileNotFoundError: there is none of that name.
    """
    return files(__package__).joinpath("static", name).read_text(encoding="utf-8")
