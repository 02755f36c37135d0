"""A sequence that is being recorded: what its law has learned, as soon as another run has ended."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError
from railhil.panel.learning import SEQUENCE, learning_charts, run_folders
from railhil.scenarios.model import AnyScenario

#: Wall time between two looks at a folder.
_LOOK_S = 0.5


class Growing:
    """The sequences among some folders; one that is complete does not change any more, and looking costs one stat.

    :param folders: as they were asked for.
    """

    def __init__(self, scenario: AnyScenario, folders: Sequence[str]) -> None:
        self._scenario = scenario
        self._folders = list(folders)
        self._files = [path for folder in folders if (path := Path(folder) / SEQUENCE).is_file()]
        self._stamps = self._seen()
        self._look_s = time.monotonic()

    def look(self) -> list[dict[str, Any]] | None:
        """The charts of :func:`railhil.panel.learning.learning_charts`, if another run has ended since the last look;
        else None."""
        now_s = time.monotonic()
        if not self._files or now_s - self._look_s < _LOOK_S:
            return None
        self._look_s = now_s
        stamps = self._seen()
        if stamps == self._stamps:
            return None
        try:
            charts = learning_charts(self._scenario, run_folders(self._folders)[1])
        except InputError:
            # The next run is being written: at the next look it is whole, or has not begun.
            return None
        self._stamps = stamps
        return charts

    def _seen(self) -> list[int]:
        # ``railhil sequence run`` writes it anew after each run, when the folder of the run is complete.
        return [path.stat().st_mtime_ns if path.exists() else 0 for path in self._files]
