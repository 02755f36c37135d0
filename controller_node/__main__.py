"""``python -m railhil.controller_node`` (``railhil node controller``): the train controller as one process."""

from __future__ import annotations

import sys

from railhil.common.exit_codes import run_guarded


def main() -> int:
    """The command; its modules are loaded here, so that Ctrl-C during loading ends it like later."""
    from railhil.controller_node import command

    return command.main()


if __name__ == "__main__":
    sys.exit(run_guarded("controller", main))
