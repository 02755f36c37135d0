"""``railhil``."""

from __future__ import annotations

import sys

from railhil.common.exit_codes import guarded


def main() -> int:
    """Entry point of the ``railhil`` command.

    Its modules take half a second to load: here, so that Ctrl-C while they are ends as it does later. A command that
    is another program does without them.
    """

    def work() -> int:
        from railhil.cli import programs as outside

        outside.become_program(sys.argv[1:])
        from railhil.cli import commands

        return commands.work()

    return guarded("railhil", work)
