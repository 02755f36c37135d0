"""A cell of a notebook: tables and figures in the page of another program, as HTML.

Text and lines have the colour of that page's text, and the colours of curves are visible on a light and a dark ground:
a notebook's theme is not that of the system. The styles apply inside their own block only.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from functools import cache

from railhil.charts import static_text
from railhil.charts.figure import Figure
from railhil.charts.svg import markup
from railhil.charts.svg_shapes import escaped

#: Beside the light colours of ``charts.css``: those that depend on the ground, and the rest of the block.
_STYLES = """
  color-scheme: inherit; --rc-paper: transparent; --rc-ink: currentColor; --rc-4: currentColor; --rc-fault: #d1453b;
  --rc-dim: color-mix(in srgb, currentColor 72%, transparent);
  --rc-line: color-mix(in srgb, currentColor 20%, transparent);
  --rc-target: color-mix(in srgb, currentColor 38%, transparent);
  max-width: 912px; overflow-x: auto;
  .row { min-width: 0; flex-wrap: wrap; }
  .chart { min-width: 420px; }
  p { margin: .3rem 0; overflow-wrap: anywhere; }
  table { border-collapse: collapse; margin: .3rem 0; font-size: .9em; color: inherit; }
  caption { text-align: left; font-weight: 600; caption-side: top; }
  th, td { padding: .15rem .6rem .15rem 0; text-align: left; white-space: pre; background: none; }
  th { vertical-align: bottom; }
  thead th { border-bottom: 1px solid var(--rc-dim); }
  tbody th { font-weight: 400; }
  .number { text-align: right; font-variant-numeric: tabular-nums; }
  .missed { font-weight: 700; }
  .verdict { border: 2px solid currentColor; border-radius: 4px; padding: 0 .4rem; margin-right: .4rem; }
  .verdict.PASS { background: #d7f0df; color: #111; }
  .verdict.FAIL { background: #b22222; color: #fff; }
  .verdict.INVALID { border-style: dashed; }
"""


@cache
def _styles() -> str:
    colours = static_text("charts.css").partition("{")[2].partition("}")[0]
    # The class twice: notebooks have rules for tables, too.
    return f"<style>.railhil-cell.railhil-cell {{ {colours} {static_text('figures.css')} {_STYLES} }}</style>"


def html_cell(*parts: str) -> str:
    """One block with its styles.

    :param parts: HTML of this module's functions.
    """
    return f'{_styles()}<div class="railhil-cell">{"".join(parts)}</div>'


def html_paragraph(text: str) -> str:
    """A paragraph; nothing for an empty text."""
    return f"<p>{escaped(text)}</p>" if text else ""


def html_verdict(verdict: str, text: str) -> str:
    """PASS, FAIL or INVALID, and the text beside it."""
    return f'<p><b class="verdict {escaped(verdict)}">{escaped(verdict)}</b>{escaped(text)}</p>'


def html_table(
    title: str, heads: Sequence[str], rows: Iterable[Sequence[str]], numbers: Collection[int] = (), missed: str = ""
) -> str:
    """A table; the first cell of each row is its head.

    :param numbers: columns of numbers, counted from 0.
    :param missed: rows with a cell that begins with this text are emphasised; empty: none.
    """

    def cell(place: int, text: str, scope: str) -> str:
        name = "th" if scope else "td"
        shown = f' scope="{scope}"' if scope else ""
        shown += ' class="number"' if place in numbers else ""
        return f"<{name}{shown}>{escaped(text)}</{name}>"

    def line(row: Sequence[str]) -> str:
        is_missed = bool(missed) and any(text.startswith(missed) for text in row)
        cells = "".join(cell(place, text, "" if place else "row") for place, text in enumerate(row))
        return f'<tr class="missed">{cells}</tr>' if is_missed else f"<tr>{cells}</tr>"

    head = "".join(cell(place, text, "col") for place, text in enumerate(heads))
    caption = f"<caption>{escaped(title)}</caption>" if title else ""
    return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{''.join(map(line, rows))}</tbody></table>"


def text_table(title: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """The same for a plain terminal; the columns stand below each other."""
    cells = [heads, *rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join((title, *("  ".join(map(str.ljust, row, widths)).rstrip() for row in cells)))


def html_figure(figure: Figure) -> str:
    """The charts of a figure."""
    return markup(figure)


def first_chart(figure: Figure) -> Figure:
    """The figure with its first chart alone, which then names its horizontal axis itself."""
    chart = figure.charts[0]
    x_label = next((one.x_label for one in figure.charts if one.x_label), "")
    return replace(figure, charts=[replace(chart, x_label=x_label, share=1.0)])
