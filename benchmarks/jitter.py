"""Lateness of a loop with absolute deadlines: on every transport, idle and loaded, with and without SCHED_FIFO."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

from benchmarks.buses import Transport, transports
from benchmarks.figures import Figure, Missing, Setting, p99, spread_of
from benchmarks.native import c_loop
from benchmarks.pairs import Pair, busy_cores, fifo
from benchmarks.transports import open_pairs, to_c

TITLE = "jitter"
METHOD = (
    "Lateness of the start of a cycle after its absolute deadline on the monotonic clock, every 10 ms, with one round "
    "trip to an echo process in each cycle; p99 of 1000 cycles. answer p99: from the deadline until the answer is "
    "there. Python: the nodes' pacer and Link; C: clock_nanosleep in benchmarks/c/loop.c. Both run at the same time on "
    "the same transport, their deadlines half a period apart. Busy: beside them a process on every core that does "
    "nothing but count. FIFO: ends at SCHED_FIFO 50 and their hubs at 51, memory not locked; else normal scheduling."
)
_PERIOD_NS = 10_000_000
#: Maximum lifetime of a load process that is not ended.
_LOAD_S = 300.0
_NOT_PERMITTED = "not permitted here; root, or `ulimit -r 60`"


def _lateness(pairs: list[Pair], name: str, setting: Setting) -> Iterator[Figure]:
    cycles = setting.count(1000, 5)
    for number, pair in enumerate(pairs):
        pair.tell(f"pace {cycles} {_PERIOD_NS} {number * _PERIOD_NS // len(pairs)}")
    late_us, answered_us = {}, {}
    for pair in pairs:
        taken_us = [taken_ns / 1000 for taken_ns in pair.answer()]
        late_us[pair.language], answered_us[pair.language] = taken_us[::2], taken_us[1::2]
    p99_us = {language: p99(samples) for language, samples in late_us.items()}
    for language, value in p99_us.items():
        spread = spread_of(late_us[language], 50, 99.9) | {"answer p99": p99(answered_us[language])}
        yield Figure(f"{name}, {language}", value, "us", *to_c(p99_us, language, ", p99"), spread)


def _figures(transport: Transport, loop: Path | Missing, setting: Setting) -> Iterator[Figure | Missing]:
    """All states on one transport."""
    folder = setting.folder / transport.short
    folder.mkdir()
    with open_pairs(transport, loop, folder) as pairs:
        for load in ("idle", "busy"):
            for scheduling in ("normal", "FIFO"):
                name = f"{transport.name}: {load}, {scheduling}"
                with ExitStack() as stack:
                    try:
                        if scheduling == "FIFO":
                            stack.enter_context(fifo(pairs))
                    except PermissionError:
                        yield Missing(name, _NOT_PERMITTED)
                        continue
                    if load == "busy":
                        stack.enter_context(busy_cores(_LOAD_S))
                    yield from _lateness(pairs, name, setting)


def measure(setting: Setting) -> list[Figure | Missing]:
    """Lateness in the four states of the machine.

    :raises MeasurementError: a process did not start or did not answer.
    """
    ways, missing = transports()
    loop = c_loop(setting.folder)
    found: list[Figure | Missing] = [*missing, *([loop] if isinstance(loop, Missing) else [])]
    for transport in ways:
        if transport.runs:
            found += _figures(transport, loop, setting)
    return found
