"""A page of the panel in a browser: the command that serves it, and what it says."""

from __future__ import annotations

import os
import re
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hil_tests.support.cli import command

WAIT_MS = 60_000


@contextmanager
def started(output: Path, *words: str | Path, cwd: Path | None = None) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """A command that serves a page, and the page's address."""
    with output.open("wb") as stream:
        process = subprocess.Popen(command(*words), stdout=stream, stderr=stream, env=os.environ, cwd=cwd)
    try:
        deadline_s = time.monotonic() + 60
        while (found := re.search(r"http://127\S+", output.read_text())) is None:
            assert process.poll() is None, output.read_text()
            assert time.monotonic() < deadline_s
            time.sleep(0.05)
        yield process, found[0]
    finally:
        process.kill()
        process.wait()


def said(page: Any, selector: str, pattern: str) -> str:
    """The text of an element, as soon as it matches."""
    place = page.locator(selector).first
    page.locator(selector, has_text=re.compile(pattern)).first.wait_for(timeout=WAIT_MS)
    return str(place.inner_text())
