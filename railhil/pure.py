"""``RAILHIL_PURE=1``: a compiled build (setup.py) runs its Python sources, which it contains, too."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import SOURCE_SUFFIXES, FileFinder, ModuleSpec, SourceFileLoader
from types import ModuleType


class _Sources(MetaPathFinder):
    """Finds railhil's modules as ``.py`` files only."""

    def __init__(self) -> None:
        self._folders: dict[str, FileFinder] = {}

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        """The module's source; None for a module of another package."""
        if path is None or not name.startswith("railhil."):
            return None
        for folder in path:
            if folder not in self._folders:
                self._folders[folder] = FileFinder(folder, (SourceFileLoader, SOURCE_SUFFIXES))
            spec = self._folders[folder].find_spec(name)
            if spec is not None:
                return spec
        return None


def use_sources() -> None:
    """From now on import railhil's sources, even if compiled modules are beside them."""
    sys.meta_path.insert(0, _Sources())
