"""``python -m railhil.panel`` (the same as ``railhil panel``)."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from railhil.common.errors import describe_os_error
from railhil.common.exit_codes import run_guarded


def main(words: Sequence[str] | None = None) -> int:
    """Serve the page until a signal, or until the displayed run has ended.

    Its modules are loaded here: python-can, which they need, must not load asammdf (:func:`run_guarded`).
    """
    from railhil.common.command_line import parse
    from railhil.common.errors import InputError
    from railhil.common.extras import missing_library
    from railhil.common.streams import accept_any_text, flush_output
    from railhil.panel.command import arguments

    accept_any_text()
    namespace = parse(arguments(), words)
    try:
        try:
            from railhil.panel.service import serve_panel
        except ImportError as error:
            if (error.name or "").partition(".")[0] != "websockets":
                raise
            raise missing_library("railhil panel", error, "panel") from error
        return serve_panel(namespace)
    except OSError as error:
        if error.filename is not None:
            # An error of a file, not of the port.
            raise
        reason = describe_os_error(error)
        raise InputError("command line", "--port", namespace.port, f"a free port ({reason})") from None
    finally:
        flush_output()


if __name__ == "__main__":
    sys.exit(run_guarded("railhil panel", main))
