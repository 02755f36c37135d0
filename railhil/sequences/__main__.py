"""``python -m railhil.sequences`` (the same as ``railhil learn``)."""

from __future__ import annotations

import sys

from railhil.common.exit_codes import guarded
from railhil.sequences.command import COMMAND

if __name__ == "__main__":
    sys.exit(guarded("railhil learn", COMMAND.main))
