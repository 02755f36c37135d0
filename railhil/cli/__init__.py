"""``railhil``."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from railhil.common.exit_codes import guarded


def main(words: Sequence[str] | None = None) -> int:
    """Entry point of the ``railhil`` command.

    Its modules take half a second to load: here, so that Ctrl-C while they are ends as it does later. A command that
    is another program does without them.

    :param words: the command line; None: this process's own.
    """
    given = sys.argv[1:] if words is None else list(words)

    def work() -> int:
        from railhil.cli import programs as outside

        outside.become_program(given)
        from railhil.cli import commands

        return commands.work(given)

    return guarded("railhil", work)
