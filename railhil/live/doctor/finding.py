"""Result of an examination."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

#: Longest time to wait for a tool.
TOOL_TIMEOUT_S = 5.0


@dataclass(frozen=True, slots=True)
class Finding:
    """One line: subject, what was found, and the command or step that improves it (empty: nothing to do)."""

    subject: str
    found: str
    advice: str = ""


def text_of(path: Path) -> str:
    """Stripped content of a small kernel file; empty when it cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        # Not in this kernel, or not for this user.
        return ""


def said_by(*command: str) -> str | None:
    """Standard output of a tool; None when it is missing, fails or does not answer."""
    if shutil.which(command[0]) is None:
        return None
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TOOL_TIMEOUT_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout if done.returncode == 0 else None


def and_so_on(names: Sequence[str], shown: int = 4) -> str:
    """A list of names, truncated when it is long."""
    return ", ".join(names[:shown]) + (f" and {len(names) - shown} more" if len(names) > shown else "")
