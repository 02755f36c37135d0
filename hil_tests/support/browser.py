"""Opens a page in headless Chromium and evaluates what it shows."""

from __future__ import annotations

import html
import json
import re
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from hil_tests.machines.tools import BROWSERS
from railhil.machines.debian import find_command

_TIMEOUT_S = 90
_MARK = "railhil-found"
#: Forbids every fetch, and records attempted fetches in ``window.fetched``.
_WATCH = """<meta http-equiv="Content-Security-Policy"
content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<script>window.fetched = [];
document.addEventListener("securitypolicyviolation", event => window.fetched.push(event.blockedURI));</script>"""

#: An expression for :func:`asked`: what the texts of a page's charts do; lists name the offending texts.
TEXTS_OF_CHARTS = """
(() => {
  const overlaps = [], outside = [];
  const svgs = [...document.querySelectorAll(".chart > svg")].filter(svg => svg.checkVisibility());
  let texts = 0;
  for (const svg of svgs) {
    const frame = svg.getBoundingClientRect();
    const boxes = [...svg.querySelectorAll("text")]
      .filter(text => text.checkVisibility({visibilityProperty: true}))
      .map(text => [text.textContent, text.getBoundingClientRect()]);
    texts += boxes.length;
    boxes.forEach(([name, box], index) => {
      if (box.left < frame.left - 0.5 || box.right > frame.right + 0.5 || box.top < frame.top - 0.5
          || box.bottom > frame.bottom + 0.5) outside.push(name);
      for (const [other, next] of boxes.slice(index + 1)) {
        // Lines of text stand closer than their boxes, which hold room above and below the letters.
        const across = Math.min(box.right, next.right) - Math.max(box.left, next.left);
        const down = Math.min(box.bottom, next.bottom) - Math.max(box.top, next.top);
        if (across > 0.5 && down > 0.25 * Math.min(box.height, next.height)) overlaps.push([name, other]);
      }
    });
  }
  const root = document.documentElement;
  return {overlaps, outside, texts, figures: svgs.length, width: root.clientWidth,
          beyond: root.scrollWidth - root.clientWidth,
          table: Math.max(...[...document.querySelectorAll(".wide")].map(box => box.scrollWidth - box.clientWidth)),
          fetched: window.fetched};
})()
"""


def browser() -> str | None:
    """Path of Chromium, None when this machine has none."""
    return next((path for name in BROWSERS if (path := find_command(name))), None)


@contextmanager
def open_chromium() -> Iterator[Any]:
    """Headless Chromium, as playwright's ``Browser``.

    :raises ModuleNotFoundError: playwright is not installed.
    """
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=browser(), args=["--no-sandbox"])
        try:
            yield chromium
        finally:
            chromium.close()


@contextmanager
def chromium_or_skip() -> Iterator[Any]:
    """As :func:`open_chromium`; without playwright the test is skipped."""
    pytest.importorskip("playwright.sync_api", reason="MISSING CAPABILITY playwright")
    with open_chromium() as chromium:
        yield chromium


def asked(page: Path, expression: str, width_px: int = 1100) -> Any:
    """Value of a JavaScript expression on a page that has been loaded.

    A copy of the page with a script at its end is opened; the result is read from the dumped document. In the
    expression, ``window.fetched`` holds the addresses that the page tried to load.
    """
    program = browser()
    assert program is not None
    script = (
        f'<script>window.addEventListener("load", () => {{ const found = document.createElement("pre"); '
        f'found.id = "{_MARK}"; found.textContent = JSON.stringify({expression}); '
        f"document.body.appendChild(found); }});</script></body>"
    )
    text = page.read_text(encoding="utf-8")
    assert text.count("<head>") == text.count("</body>") == 1
    text = text.replace("<head>", f"<head>{_WATCH}")
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        copy = Path(folder) / "page.html"
        copy.write_text(text.replace("</body>", script), encoding="utf-8")
        command = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
        command += [f"--user-data-dir={folder}/profile", f"--window-size={width_px},1000", "--dump-dom", copy.as_uri()]
        done = subprocess.run(command, capture_output=True, text=True, timeout=_TIMEOUT_S, check=True)
    answer = re.search(rf'<pre id="{_MARK}">(.*?)</pre>', done.stdout, re.DOTALL)
    assert answer is not None, done.stderr[-500:]
    return json.loads(html.unescape(answer[1]))
