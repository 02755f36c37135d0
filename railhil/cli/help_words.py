"""``railhil help COMMAND``: the same as ``railhil COMMAND --help``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from railhil.cli.completion import whole_parser


def as_options(words: Sequence[str]) -> list[str]:
    """The words that show the help of a command, or of one kind of it. A command that does not exist is left to the
    command line. Ends the process with exit code 2 if a later word is no kind.

    :param words: after ``help``.
    """
    if not words or list(words) == ["help"]:
        return ["--help"]
    if len(words) == 1 and not words[0].startswith("-"):
        return [*words, "--help"]
    at = whole_parser()
    for word in words:
        kinds = next((action.choices for action in at._actions if action.choices and not action.option_strings), ())
        if kinds is None or word not in kinds:
            at.error(f"help: found {word}, allowed {', '.join(kinds or ()) or f'nothing after {at.prog}'}")
        if isinstance(kinds, Mapping):
            at = kinds[word]
    return [*words, "--help"]
