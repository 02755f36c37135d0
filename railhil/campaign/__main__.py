"""``python -m railhil.campaign`` (the same as ``railhil campaign``)."""

from __future__ import annotations

import sys

from railhil.campaign.command import COMMAND
from railhil.common.exit_codes import run_guarded

if __name__ == "__main__":
    sys.exit(run_guarded("railhil campaign", COMMAND.main))
