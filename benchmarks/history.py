"""The history of the figures: one line of JSON for each measurement, so that a loss shows."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, describe_os_error

#: A figure counts as lost when it is worse than the last one by more than this share.
LOSS_SHARE = 0.1
#: Values that must be equal in two comparable measurements. An older line without ``railhil_build`` is compared with
#: none.
_SAME = ("cpu", "cores", "python", "build", "railhil_build", "counting")
#: Units of which more is better; of all others (s, us, MB) less is.
_RATES = ("sim s/s", "frames/s", "runs/s")


def entry(document: dict[str, Any], now: datetime | None = None) -> dict[str, Any]:
    """The line for a measurement.

    :param document: the output of ``python -m benchmarks --json``.
    """
    figures = {
        f"{name}: {figure['name']}": [figure["value"], figure["unit"]]
        for name, result in document["benchmarks"].items()
        for figure in result["figures"]
    }
    machine = {key: document["machine"][key] for key in (*_SAME, "load_1min", "far_read_ns")}
    return {"utc": (now or datetime.now(UTC)).isoformat(timespec="seconds"), **machine, "figures": figures}


def read(path: Path) -> list[dict[str, Any]]:
    """The lines of a history, oldest first; none without the file.

    :raises InputError: a line is not one of a history.
    """
    if not path.is_file():
        return []
    lines = path.read_text(encoding="utf-8").splitlines()
    found = []
    for number, line in enumerate(lines, 1):
        try:
            found.append(json.loads(line))
            if not isinstance(found[-1]["figures"], dict):
                raise TypeError
        except (ValueError, KeyError, TypeError):
            raise InputError(str(path), f"line {number}", line[:40], "a line that --history has written") from None
    return found


def losses(before: list[dict[str, Any]], now: dict[str, Any]) -> list[str]:
    """One line for each figure that is worse than the last one measured in the same way on the same machine."""
    last = [item for item in before if all(item.get(key) == now[key] for key in _SAME)][-1:]
    found = []
    for item in last:
        for name, (value, unit) in now["figures"].items():
            was = item["figures"].get(name, [0.0])[0]
            if not was or not value:
                continue
            share = was / value - 1 if unit in _RATES else value / was - 1
            if share > LOSS_SHARE:
                found.append(
                    f"{name}: {value:.3g} {unit}, was {was:.3g} at {item['utc']} ({_state(item)} then, "
                    f"{_state(now)} now)"
                )
    return found


def _state(item: dict[str, Any]) -> str:
    """Possible causes of a different figure: the machine's load, and the latency of its memory if that was measured."""
    far_ns = item.get("far_read_ns")
    return f"load {item['load_1min']:.1f}" + ("" if far_ns is None else f", latency {far_ns:.0f} ns")


def append(path: Path, line: dict[str, Any]) -> None:
    """Add a line to the history.

    :raises InputError: the file cannot be written.
    """
    try:
        with path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(line) + "\n")
    except OSError as error:
        reason = describe_os_error(error)
        raise InputError("command line", "--history", str(path), "a file that can be written", reason) from None
