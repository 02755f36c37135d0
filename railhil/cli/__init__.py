"""``railhil``."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from railhil.common.exit_codes import run_guarded


def main(words: Sequence[str] | None = None) -> int:
    """Entry point of the ``railhil`` command.

    Its modules take half a second to load; they are loaded here, so that Ctrl-C during loading ends the command like
    later. A command that starts another program does not need them.

    :param words: the command line; None: that of this process.
    """
    given = sys.argv[1:] if words is None else list(words)

    def work() -> int:
        from railhil.cli import programs as outside

        if given[:1] == ["help"]:
            from railhil.cli import help_words

            given[:] = help_words.as_options(given[1:])
        outside.become_program(given)
        from railhil.cli import commands

        return commands.work(given)

    return run_guarded("railhil", work)
