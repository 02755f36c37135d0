"""Makes text from outside safe to show: nothing in it controls the terminal or changes the reading direction."""

from __future__ import annotations

import re

#: Control characters except line feed and tab, line and paragraph separators, invisible marks (direction, width,
#: annotation, language), surrogates and noncharacters. Joiners and the soft hyphen count as text.
_UNSAFE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ufffe\uffff"
    "\ud800-\udfff\U000e0001-\U000e007f]"
)


def plain(text: str) -> str:
    r"""The text with such characters escaped: ``\x1b`` for the one that begins an escape sequence."""
    return text if text.isprintable() else _UNSAFE.sub(_written_out, text)


def _written_out(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"
