"""``railhil``."""

from __future__ import annotations

from bus.exitcodes import guarded


def main() -> int:
    """Entry point of the ``railhil`` command.

    Its modules take half a second to load: here, so that Ctrl-C while they are ends as it does later.
    """

    def work() -> int:
        from supervisor.cli import commands

        return commands.work()

    return guarded("railhil", work)
