"""``python -m railhil.plant_sim`` (``railhil node plant``): the train and its line as one process on the bus."""

from __future__ import annotations

import sys

from railhil.common.exit_codes import run_guarded


def main() -> int:
    """The command; its modules are loaded here, so that Ctrl-C during loading ends it like later."""
    from railhil.plant_sim import command

    return command.main()


if __name__ == "__main__":
    sys.exit(run_guarded("plant", main))
