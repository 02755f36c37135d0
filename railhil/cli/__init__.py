"""``railhil``."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from railhil.common.exit_codes import guarded
from railhil.common.leaving import leave
from railhil.common.light_start import rare_collection

#: Commands that have closed all that they have opened.
_LEFT_AT_ONCE = (["run"], ["score"])


def main(words: Sequence[str] | None = None) -> int:
    """Entry point of the ``railhil`` command.

    Its modules take half a second to load; they are loaded here, so that Ctrl-C during loading ends the command like
    later. A command that starts another program does not need them.

    :param words: the command line; None: that of this process.
    """
    given = sys.argv[1:] if words is None else list(words)

    def work() -> int:
        from railhil.cli import programs as outside

        outside.become_program(given)
        from railhil.common.quick_dataclasses import quick_dataclasses

        with rare_collection(), quick_dataclasses():
            from railhil.cli import commands

            return commands.work(given)

    code = guarded("railhil", work)
    if words is None and given[:1] in _LEFT_AT_ONCE:
        leave(code)
    return code
