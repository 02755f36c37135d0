"""Charts of the report and of the panel: uPlot and what both pages draw with it.

``static/`` holds uPlot 1.6.32 (MIT, its licence beside it) as published; ``SHA256SUMS`` are the digests of its files.
``charts.js`` and ``charts.css`` are ours: charts, tracks and colours of both pages; the first lines of the former say
how they are used.
"""

from __future__ import annotations

from importlib.resources import files

#: In the order in which a page takes them.
SCRIPTS = ("uPlot.iife.min.js", "charts.js")
STYLES = ("uPlot.min.css", "charts.css")


def static_text(name: str) -> str:
    """Text of a file of ``static/``.

    :param name: one of :data:`SCRIPTS` or :data:`STYLES`.
    :raises FileNotFoundError: there is none of that name.
    """
    return files(__package__).joinpath("static", name).read_text(encoding="utf-8")
