"""One part of ``make test``: a command that ends with pytest's summary line, after installing the tools that it needs.

A missing capability (a tool; a machine that ends with 77) is reported prominently; with ``RAILHIL_REQUIRE_ALL=1`` it is
a failure, so that continuous integration never skips silently. With ``--behind`` the command has only the time that no
other process wants (``SCHED_IDLE``).

Exit code: 0 if everything that could run has passed, else 1. With ``--counts FILE`` the counts are written there and
the exit code is 0, so the next part runs in any case; ``--total N`` prints the sum of the N parts and sets the exit
code.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from hil_tests.machines import tools
from railhil.machines import debian

TOOLS = {
    "compilers": tools.install_compilers,
    "emulation": tools.install_emulation,
    "browser": tools.install_browser,
    "can-utils": tools.install_can_tools,
    "ssh": tools.install_ssh,
}
_CLOSING_LINE = re.compile(r"\d+ (?:passed|failed|skipped|error|deselected).* in \d+\.\d+s\b")
_COUNT = re.compile(r"(\d+) (passed|failed|skipped|error)")


def _counted(text: str) -> Counter[str]:
    """The counts of all summary lines in a text; an error counts as a failure."""
    counts: Counter[str] = Counter()
    for number, word in _COUNT.findall(text):
        counts["failed" if word == "error" else word] += int(number)
    return counts


def _missing(what: str) -> Counter[str]:
    print(f"MISSING CAPABILITY: {what}: its tests did NOT run on this machine", flush=True)
    return Counter({"failed" if os.environ.get("RAILHIL_REQUIRE_ALL") else "skipped": 1})


def _install(tools: Sequence[str]) -> Counter[str]:
    counts: Counter[str] = Counter()
    for tool in tools:
        try:
            TOOLS[tool]()
        except (debian.CapabilityError, debian.MachineError) as error:
            counts += _missing(f"{tool}: {error}")
    return counts


def _run(name: str, command: Sequence[str]) -> Counter[str]:
    """Run the command and pass on its output; returns the counts of its summary line."""
    closing = ""
    running: list[subprocess.Popen[str]] = []
    told = False

    def end(*_: object) -> None:
        """End the command, which shuts down the machines that it started."""
        nonlocal told
        told = True
        for one in running:
            one.terminate()

    signal.signal(signal.SIGTERM, end)
    # Ctrl-C reaches the command directly.
    signal.signal(signal.SIGINT, lambda *_: None)
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        running.append(process)
        if told:
            # Before the command was known here, which may have begun already.
            process.terminate()
        assert process.stdout is not None
        for line in process.stdout:
            print(line, end="", flush=True)
            closing = line if _CLOSING_LINE.search(line) else closing
    if process.returncode == debian.EXIT_NO_CAPABILITY:
        return _missing(name)
    counts = _counted(closing)
    if process.returncode != 0:
        print(f"FAILED: {name}: exit code {process.returncode}", flush=True)
        counts["failed"] = max(1, counts["failed"])
    return counts


def main(words: Sequence[str] | None = None) -> int:
    """Command line; see the module's docstring."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.part")
    parser.add_argument("--tool", action="append", choices=TOOLS, default=[])
    parser.add_argument("--behind", action="store_true")
    parser.add_argument("--counts", type=Path)
    parser.add_argument("--total", type=int)
    parser.add_argument("command", nargs=argparse.REMAINDER, metavar="NAME COMMAND")
    options = parser.parse_args(words)
    if options.total is not None:
        lines = options.counts.read_text().splitlines() if options.counts.exists() else []
        counts = _counted("\n".join(lines))
        # A part that was killed has written no counts.
        counts["failed"] += options.total - len(lines)
        print("\n=== all parts ===", *lines, sep="\n", flush=True)
    else:
        name, *command = options.command
        print(f"\n=== {name} ===", flush=True)
        if options.behind:
            os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
        counts = _install(options.tool) + _run(name, command)
    closing = ", ".join(f"{counts[word]} {word}" for word in ("passed", "failed", "skipped"))
    if options.counts is None or options.total is not None:
        print(closing, flush=True)
        return 1 if counts["failed"] else 0
    options.counts.parent.mkdir(exist_ok=True)
    with options.counts.open("a") as file:
        print(f"{name}: {closing}", file=file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
