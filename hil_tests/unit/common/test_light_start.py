"""A command loads matplotlib without its help texts; drawings are the same, and later classes have theirs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

DRAWN = """
import io
import matplotlib
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

matplotlib.rcParams["svg.hashsalt"] = "same"
figure = Figure(figsize=(4, 3))
axes = figure.add_axes((0.1, 0.1, 0.8, 0.8))
axes.set(xlabel="x", ylabel="y", title="t")
axes.plot([0, 1, 2], [1, 3, 2], label="a", color="red")
axes.xaxis.set_major_locator(MultipleLocator(0.5))
axes.legend()
out = io.StringIO()
figure.savefig(out, format="svg", metadata={"Date": None})
print(out.getvalue())
"""
LIGHT = """
from railhil.common.light_start import undocumented_matplotlib
with undocumented_matplotlib():
    from matplotlib.figure import Figure
"""
DESCRIBED = """
from matplotlib import artist, lines
assert "linewidth" not in str(lines.Line2D.set.__doc__)
class Later(artist.Artist):
    pass
assert "zorder" in Later.set.__doc__
assert "linewidth" in artist.kwdoc(lines.Line2D)
"""


def said(program: str) -> str:
    done = subprocess.run([sys.executable, "-P", "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_drawings_are_the_same() -> None:
    assert said(LIGHT + DRAWN) == said(DRAWN) != ""


@pytest.mark.slow
def test_only_what_is_loaded_inside_has_no_help() -> None:
    said(LIGHT + DESCRIBED)


def test_what_is_loaded_already_stays_as_it_is() -> None:
    said("from matplotlib import artist, lines\nbefore = artist.kwdoc\n" + LIGHT + "assert artist.kwdoc is before\n")
    said("from matplotlib import lines\n" + LIGHT + "assert 'linewidth' in lines.Line2D.set.__doc__\n")


def test_a_version_without_these_names_is_loaded_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "matplotlib").mkdir()
    (tmp_path / "matplotlib/__init__.py").touch()
    (tmp_path / "matplotlib/artist.py").write_text("class Artist:\n    pass\n", encoding="utf-8")
    first = f"import sys\nsys.path.insert(0, {str(tmp_path)!r})\n"
    within = (
        "with undocumented_matplotlib():\n    from matplotlib import artist\n    print(vars(artist.Artist).keys())\n"
    )
    assert "_update" not in said(f"{first}from railhil.common.light_start import undocumented_matplotlib\n{within}")
