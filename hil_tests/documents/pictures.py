"""``python -m hil_tests.documents.pictures``: makes every picture in docs/pictures anew.

Diagrams (:mod:`hil_tests.documents.diagrams`), the picture of ``railhil plot``, and photographs of a report and of the
panel in Chromium. A photograph carries the words of the page that it shows, without figures: a browser draws other
bytes on another machine, and the words tell whether the page has changed.
"""

from __future__ import annotations

import io
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image
from PIL.PngImagePlugin import PngInfo

from hil_tests.documents.diagrams import DIAGRAMS
from hil_tests.support.browser import open_chromium
from hil_tests.support.cli import command
from hil_tests.support.paths import ROOT

FOLDER = ROOT / "docs/pictures"
#: The run of the photographs: its fault is that of README and tutorial.
RUN = ("run", "--controller", "ipfc_plus", "--bus", "local", "--fault", "TRN_SPEED loss @170s for 2s")
#: File -> selector of the words of its page.
PHOTOGRAPHS = {"report.png": "h1, h2, h3, th, .keys b", "panel.png": "#values, #lamps, button, summary, .handle h2"}
_SIZE = {"width": 1000, "height": 840}
_SERVED_S = 60
_DRAWN_MS = 500
_FAILED = 1


def words_of(path: Path) -> list[str]:
    """The words that a photograph carries."""
    with Image.open(path) as image:
        return str(image.info["words"]).split("\n")


def photographs(folder: Path) -> Iterator[tuple[str, list[str], bytes]]:
    """File, words of the page and picture (PNG) of each photograph.

    :param folder: empty or not there yet, for the run that they show.
    """
    done = subprocess.run(command(*RUN, "--out", folder), capture_output=True, text=True, timeout=120, check=False)
    if done.returncode != _FAILED:
        raise ValueError(f"the run of the photographs ended with {done.returncode}: {done.stdout}{done.stderr}")
    with open_chromium() as chromium, _panel(folder) as address:
        for name, page_address in (("report.png", (folder / "report.html").as_uri()), ("panel.png", address)):
            page = chromium.new_page(viewport=_SIZE, color_scheme="light")
            page.goto(page_address)
            if name == "panel.png":
                page.locator("#connection", has_text="connected").wait_for()
                page.locator(".rc-chart canvas").nth(3).wait_for()
                page.locator("#events tr").first.wait_for()
                # Curves are drawn a little after the charts are there.
                page.wait_for_timeout(_DRAWN_MS)
            yield name, _words(page, PHOTOGRAPHS[name]), page.screenshot()


def _words(page: Any, selector: str) -> list[str]:
    texts = page.evaluate(f"[...document.querySelectorAll({selector!r})].map(one => one.innerText)")
    return [" ".join(re.sub(r"[\d.]+", "", text).split()) for text in texts if text.strip()]


@contextmanager
def _panel(folder: Path) -> Iterator[str]:
    """The address of a panel of a run."""
    words = command("panel", "--port", "0", folder)
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None
        try:
            begun_s, line = time.monotonic(), ""
            while (found := re.search(r"http://127\S+", line)) is None:
                if process.poll() is not None or time.monotonic() > begun_s + _SERVED_S:
                    raise ValueError(f"railhil panel does not serve its page: {line}")
                line = process.stdout.readline()
            yield found[0]
        finally:
            process.kill()


def _written(path: Path, words: list[str], picture: bytes) -> None:
    """A photograph in few colours, with its words."""
    info = PngInfo()
    info.add_text("words", "\n".join(words))
    with Image.open(io.BytesIO(picture)) as image:
        image.convert("RGB").quantize(64, dither=Image.Dither.NONE).save(path, pnginfo=info, optimize=True)


def main() -> int:
    """Make all pictures."""
    FOLDER.mkdir(exist_ok=True)
    for name, draw in DIAGRAMS.items():
        (FOLDER / name).write_text(draw(), encoding="utf-8")
    with tempfile.TemporaryDirectory(prefix="railhil-pictures-") as name:
        plain = Path(name) / "plain"
        for line in (
            ("run", "--bus", "local", "--no-report", "--out", plain),
            ("plot", plain, "--out", FOLDER / "run.svg"),
        ):
            subprocess.run(command(*line), stdout=subprocess.DEVNULL, timeout=120, check=True)
        for file, words, picture in photographs(Path(name) / "broken"):
            _written(FOLDER / file, words, picture)
    print("\n".join(f"{path.relative_to(ROOT)}: {path.stat().st_size} bytes" for path in sorted(FOLDER.iterdir())))
    return 0


if __name__ == "__main__":
    sys.exit(main())
