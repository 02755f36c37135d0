"""Scripts, styles and data that stand inside the pages, so that each is one file that fetches nothing."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from railhil.charts import SCRIPTS, STYLES, static_text


def scripts(*own: str) -> str:
    """The program of a page: uPlot, the charts, and files of this folder."""
    folder = files(__package__)
    return "\n".join([*map(static_text, SCRIPTS), *(folder.joinpath(name).read_text(encoding="utf-8") for name in own)])


def styles_text() -> str:
    """The style sheets of the charts, with the colours of both schemes."""
    return "\n".join(map(static_text, STYLES))


def as_json(document: Any) -> str:
    """JSON that cannot end a script element or be anything but data."""
    found = json.dumps(document, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return found.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
