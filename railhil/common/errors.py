"""The one exception for bad input: file, key, value found, values allowed.

A message is always a single line, so that it can be printed unchanged before exit code 2.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

_SHOWN_MAX = 80
#: Characters and levels of a value of which a message makes the ``repr``: enough for those that it shows.
_MADE_MAX, _LEVELS_MAX = 400, 20
#: Python refuses to write longer whole numbers in digits (``sys.get_int_max_str_digits``).
_BITS_MAX = 4096
_BRACKETS = {list: ("[", "]"), tuple: ("(", ")"), dict: ("{", "}")}

#: Units that end a key, longest first so that ``_mps2`` is found before ``_mps``.
_UNIT_SUFFIXES = tuple(
    sorted(
        (
            *("kg", "t", "kn", "n", "kw", "w", "mw", "m", "km", "mm", "s", "ms", "us", "ns", "min", "h"),
            *("mps", "kmh", "mps2", "mps3", "per_s", "permil", "percent", "kj", "j", "mph", "hz"),
            *("n_per_kn", "n_per_kn_kmh", "n_per_kn_kmh2"),
        ),
        key=lambda unit: (-len(unit), unit),
    )
)


def _one_line(text: str) -> str:
    flat = " ".join(text.split())
    return flat if len(flat) <= _SHOWN_MAX else flat[: _SHOWN_MAX - 3] + "..."


def short_repr(value: object) -> str:
    """The ``repr`` of a user's value in one short line, made without the part that is not shown: a value may have parts
    that contain each other, or a number of thousands of digits."""
    text = ""
    for part in _repr_parts(value, 0):
        text += part
        if len(text) > _MADE_MAX:
            break
    return _one_line(text)


def _repr_parts(value: object, level: int) -> Iterator[str]:
    if isinstance(value, int) and value.bit_length() > _BITS_MAX:
        yield f"a whole number of {value.bit_length()} bits"
    elif isinstance(value, str | bytes):
        yield repr(value[:_MADE_MAX])
    elif type(value) not in _BRACKETS or not value:
        yield repr(value)
    elif level == _LEVELS_MAX:
        yield "..."
    else:
        assert isinstance(value, list | tuple | dict)
        opening, closing = _BRACKETS[type(value)]
        yield opening
        for place, item in enumerate(value):
            yield ", " if place else ""
            yield from _repr_parts(item, level + 1)
            if isinstance(value, dict):
                yield ": "
                yield from _repr_parts(value[item], level + 1)
        yield f",{closing}" if isinstance(value, tuple) and len(value) == 1 else closing


def _without_unit(key: str) -> str:
    for unit in _UNIT_SUFFIXES:
        if key.endswith("_" + unit):
            return key[: -len(unit) - 1]
    return key


def nearest_key(key: str, allowed: Iterable[str]) -> str | None:
    """The allowed key that was most likely meant by ``key``: first the same name with another unit, then similar
    spelling."""
    choices = sorted(allowed)
    stem = _without_unit(key)
    for choice in choices:
        if _without_unit(choice) == stem:
            return choice
    flat = {choice.lower(): choice for choice in reversed(choices)}
    close = difflib.get_close_matches(key.lower(), flat, n=1, cutoff=0.6)
    return flat[close[0]] if close else None


def did_you_mean(word: str, allowed: Iterable[str]) -> str | None:
    """The hint in every message about an unknown name; None when no allowed name is similar."""
    nearest = nearest_key(word, allowed)
    return f"did you mean {nearest}?" if nearest else None


def near_file(path: Path) -> str | None:
    """As :func:`hint`, for a file that does not exist: a file in its folder with a similar name and suffix."""
    try:
        names = [entry.name for entry in path.parent.iterdir() if entry.is_file() and entry.suffix == path.suffix]
    except OSError:
        # There is no such folder, or it cannot be listed: no hint.
        return None
    nearest = nearest_key(path.name, names)
    return f"did you mean {path.parent / nearest}?" if nearest else None


def describe_os_error(error: OSError) -> str:
    """The operating system's reason, such as "permission denied"."""
    return (error.strerror or str(error)).lower()


class Sentence(str):
    """What is wrong and what is allowed, as a sentence whose subject is the key, e.g. "used only with --fmu"."""

    __slots__ = ()


class InputError(Exception):
    """Bad input from outside (scenario, line or train file, DBC, log, command line).

    ``str()`` is one line: ``FILE: KEY: found X, allowed Y (HINT)``. ``found`` is shown as its ``repr``, shortened,
    and ``allowed`` in full. If ``found`` is no value but a finding in :class:`Words`, the line is
    ``FILE: KEY: WORDS, expected Y (HINT)``; if ``allowed`` is a :class:`Sentence`, ``FILE: KEY: SENTENCE (HINT)``.
    """

    exit_code = 2

    def __init__(self, file: str | Path, key: str, found: object, allowed: str, hint: str | None = None) -> None:
        self.file = str(file)
        self.key = key
        self.found = found
        self.allowed = allowed
        self.hint = hint
        super().__init__(file, key, found, allowed, hint)

    def __str__(self) -> str:
        tail = f" ({' '.join(self.hint.split())})" if self.hint else ""
        where = f"{_flat(self.file)}: {_flat(self.key)}: " if self.key else f"{_flat(self.file)}: "
        return f"{where}{self.difference}{tail}"

    @property
    def difference(self) -> str:
        """``found X, allowed Y``, the words and what was expected, or the sentence."""
        allowed = " ".join(self.allowed.split())
        if isinstance(self.allowed, Sentence):
            return allowed
        if isinstance(self.found, Words):
            return f"{_one_line(str(self.found))}, expected {allowed}"
        return f"found {short_repr(self.found)}, allowed {allowed}"


class OptionError(InputError):
    """An option of the command line that is not used here; ``said``: a sentence whose subject is the option."""

    def __init__(self, option: str, said: str) -> None:
        super().__init__("command line", option, Words(), Sentence(said))
        self.args = (option, said)


class InputErrors(InputError):
    """Several errors in one line; the fields come from the first."""

    def __init__(self, errors: Sequence[InputError]) -> None:
        first = errors[0]
        super().__init__(first.file, first.key, first.found, first.allowed, first.hint)
        self.args = (errors,)
        self.errors = tuple(errors)

    def __str__(self) -> str:
        return "; ".join(map(str, self.errors))


class Faults:
    """Collects bad input, to report all of it together."""

    def __init__(self) -> None:
        self.found: list[InputError] = []

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Keep bad input of the block; the code after the ``with`` continues."""
        try:
            yield
        except InputError as error:
            self.found.append(error)

    def raise_all(self) -> None:
        """:raises InputError: the kept errors, if there are any."""
        if self.found:
            raise self.found[0] if len(self.found) == 1 else InputErrors(self.found)


def _flat(text: str) -> str:
    return "".join(character if character.isprintable() else "?" for character in text)


class Words:
    """A finding in words whose subject is the file or the key, such as "does not exist": a missing value, or a state
    that is not a value."""

    def __init__(self, words: str = "missing") -> None:
        self.words = words

    def __str__(self) -> str:
        return self.words


class Finding:
    """A finding in words that stands in place of a value: ``found 1 stop, allowed at least 2``."""

    def __init__(self, words: str) -> None:
        self.words = words

    def __repr__(self) -> str:
        return self.words


def short_number(value: float) -> float:
    """A number for a message: a whole number without decimals, any other with six at most."""
    return int(value) if float(value).is_integer() else round(value, 6)
