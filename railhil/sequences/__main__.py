"""``python -m railhil.sequences`` (the same as ``railhil learn``)."""

from __future__ import annotations

import sys

from railhil.common.exit_codes import run_guarded
from railhil.sequences.command import COMMAND

if __name__ == "__main__":
    sys.exit(run_guarded("railhil learn", COMMAND.main))
