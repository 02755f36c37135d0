"""``python -m railhil.machines.adapter --link PATH -i INTERFACE -c CHANNEL``: an emulated serial CAN adapter."""

from __future__ import annotations

import sys

from railhil.common.exit_codes import run_guarded


def main() -> int:
    """The program; its modules are loaded here, so that Ctrl-C during loading ends it like later."""
    from railhil.machines.adapter import emulator

    return emulator.main()


if __name__ == "__main__":
    sys.exit(run_guarded("adapter", main))
