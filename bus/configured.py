"""Settings of the bus in python-can's files and variables, each checked before it is used.

python-can passes over a file that it cannot open, and takes any text for a number or a switch. This module refuses a
wrong setting with the name of its file or variable.
"""

from __future__ import annotations

import configparser
import json
import os
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.common.errors import InputError, Words, did_you_mean
from railhil.common.user_files import refuse_unreadable

_SECTION = "default"
#: Key -> its variable in :func:`can.util.load_environment_config`; ``CAN_CONFIG`` holds further ones.
_VARIABLE_OF = {"interface": "CAN_INTERFACE", "channel": "CAN_CHANNEL", "bitrate": "CAN_BITRATE"}
_MANY = "CAN_CONFIG"
_ENVIRONMENT = "environment"
_BIT_RATES = ("bitrate", "data_bitrate")
_SWITCHES = ("fd", "receive_own_messages")


def configured(given: Mapping[str, Any]) -> dict[str, Any]:
    """``given``, completed by python-can's configuration; without an interface only if nothing is set at all.

    :param given: keyword arguments of ``can.Bus`` from the command line, which override the configuration.
    :raises InputError: a file cannot be read, a value is wrong, or a setting of a bus has no interface. The line names
        the file or the variable.
    """
    import can

    found: dict[str, Any] = dict(given)
    said: dict[str, tuple[str | Path, str]] = dict.fromkeys(given, ("command line", ""))
    for source, settings in _sources():
        for key, value in settings.items():
            # The older name of the interface.
            name = "interface" if key == "bustype" else key
            if name not in found:
                found[name] = can.util.cast_from_string(value) if isinstance(value, str) else value
                said[name] = (source, _VARIABLE_OF.get(key, _MANY) if source == _ENVIRONMENT else key)
    set_here = [key for key in found if key not in given]

    def refused(key: str, value: object, allowed: str, hint: str | None = None) -> InputError:
        source, name = said[key]
        return InputError(source, name if name != _MANY else f"{name}: {key}", value, allowed, hint)

    if set_here and "interface" not in found:
        value = Words(f"{set_here[0]} {found[set_here[0]]} without an interface")
        raise refused(set_here[0], value, "an interface beside it, or neither")
    interface = found.get("interface")
    if "interface" in set_here and interface not in can.VALID_INTERFACES:
        hint = did_you_mean(str(interface), can.VALID_INTERFACES)
        raise refused("interface", interface, f"an interface of python-can, such as socketcan or {HUB_INTERFACE}", hint)
    for key in set_here:
        value = found[key]
        if key in _BIT_RATES and (type(value) is not int or value <= 0):
            raise refused(key, value, "a whole number of bit/s")
        if key in _SWITCHES and value not in (True, False):
            raise refused(key, value, "true or false")
    if not set_here:
        return found
    try:
        return dict(can.util.load_config(config=dict(given)))
    except (TypeError, ValueError) as error:
        # The keys that python-can also checks: "port" and "state".
        key = next((key for key in set_here if key in str(error).lower()), set_here[0])
        raise refused(key, found[key], f"what python-can takes ({error})") from None


def _sources() -> Iterator[tuple[str | Path, Mapping[str, Any]]]:
    """Each source and its settings, in python-can's order: the first source that sets a key decides.

    :raises InputError: a source cannot be read.
    """
    import can

    yield "can.rc", can.rc
    text = os.environ.get(_MANY, "{}")
    try:
        many = json.loads(text)
    except ValueError:
        many = None
    if not isinstance(many, dict):
        raise InputError(_ENVIRONMENT, _MANY, text, "a JSON object of settings of python-can, or no such variable")
    yield _ENVIRONMENT, can.util.load_environment_config()
    # The later file overrides the earlier one.
    for name in reversed(can.util.CONFIG_FILES):
        path = Path(os.path.expanduser(name))
        yield path, _of_file(path)


def _of_file(path: Path) -> Mapping[str, str]:
    import can

    allowed = f"a file of python-can, with settings under [{_SECTION}]"
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            return {}
    except OSError:
        # There is no such file, or this user may not look into the home: python-can finds none there either.
        return {}
    try:
        with refuse_unreadable(path, allowed):
            path.open("rb").close()
            return can.util.load_file_config(str(path), _SECTION)
    except configparser.Error as error:
        raise InputError(path, "", Words("cannot be read"), allowed, str(error)) from None
