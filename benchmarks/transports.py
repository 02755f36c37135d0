"""Compares every transport of the bench with a plain C loop on the same transport and with the transports of
python-can, and makes a lockstep run over each."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path

from benchmarks.buses import GATEWAY, UNIX_HUB, Transport, transports
from benchmarks.figures import Figure, MeasurementError, Missing, Setting, median, spread_of
from benchmarks.foreign import foreign_transports
from benchmarks.machine import is_emulated
from benchmarks.native import c_loop
from benchmarks.pairs import PYTHON, C, Pair, pinned
from benchmarks.peer import BATCH_FRAMES, WINDOW_BATCHES
from benchmarks.processes import Finished, attached_run

TITLE = "transports"
METHOD = (
    "Round trip: one 8-byte frame to an echo process and back; median. Python: both ends send and receive as the nodes "
    "do. C: both ends are benchmarks/c/loop.c (-O2), same transport, in turns, 250 trips each. What lies between the "
    "ends, the hub in Python or the kernel, is the same for both; each pair has hub processes of its own. Free: the "
    "kernel places the processes. One CPU: ends and hubs share one. One way: batches of 8 frames, counted at the far "
    "end every 128 frames. Lockstep run: law ipfc, iq, recorded, three processes; hubs, plant and controller on one "
    "CPU, the supervisor on the others; simulated seconds per wall second from the first frame to the last, median of "
    "three (emulated machine: one run of 8 s). The frame logs are checked to be the same. Over the gateway, plant and "
    "supervisor are on one side, the controller on the other. python-can: the same loop in Python over transports that "
    "python-can brings, beside that over our hub. socketcand: its daemon on loopback, without beacon, a TCP connection "
    "for each end, tuned for latency at both ends (tcp_tune, -q), between them the kernel's vcan0. udp_multicast: hop "
    "limit 0, so that no packet leaves this machine."
)
_PLACES = ("free", "one CPU")


@contextmanager
def open_pairs(transport: Transport, loop: Path | Missing, folder: Path) -> Iterator[list[Pair]]:
    """The Python pair on a transport, and the C pair if there is one; both ready.

    :raises MeasurementError: a process did not start or did not answer.
    """
    programs = {PYTHON: None} if isinstance(loop, Missing) or not transport.in_c else {PYTHON: None, C: loop}
    with ExitStack() as stack:
        pairs = []
        for language, program in programs.items():
            own = folder / language
            own.mkdir()
            ends = stack.enter_context(transport.opened(own))
            pairs.append(stack.enter_context(Pair(language, program, ends)))
        for pair in pairs:
            pair.wait_until_ready()
        yield pairs


def to_c(values: dict[str, float], language: str, more: str = "") -> tuple[float | None, str]:
    """Ratio of a language's value to C's, and its description; nothing for C itself or without C."""
    if language == C or C not in values:
        return None, ""
    return values[language] / values[C], f"Python to C{more}"


def _trip_figures(pairs: list[Pair], name: str, place: str, setting: Setting) -> list[Figure]:
    trips = setting.count(250, 5)
    samples_us: defaultdict[str, list[float]] = defaultdict(list)
    for turn in range(setting.count(5 if is_emulated() else 11, 3)):
        for pair in pairs:
            taken_us = [taken_ns / 1000 for taken_ns in pair.ask(f"trips {trips}")]
            # The first turn is a warm-up.
            samples_us[pair.language] += taken_us if turn else []
    medians_us = {language: median(taken_us) for language, taken_us in samples_us.items()}
    return [
        Figure(
            f"{name}: round trip, {place}, {language}",
            medians_us[language],
            "us",
            *to_c(medians_us, language, f", {place}"),
            spread_of(taken_us, 99),
        )
        for language, taken_us in samples_us.items()
    ]


def _stream_figures(pairs: list[Pair], name: str, setting: Setting) -> list[Figure]:
    windows = setting.count(40, 2)
    frames = windows * WINDOW_BATCHES * BATCH_FRAMES
    found: defaultdict[str, list[float]] = defaultdict(list)
    for _ in range(setting.count(5, 1)):
        for pair in pairs:
            (taken_ns,) = pair.ask(f"stream {windows}")
            found[pair.language].append(frames / taken_ns * 1e9)
    rates = {language: median(values) for language, values in found.items()}
    return [
        Figure(f"{name}: one way, {language}", rate, "frames/s", *to_c(rates, language))
        for language, rate in rates.items()
    ]


def _loop_figures(transport: Transport, loop: Path | Missing, setting: Setting) -> list[Figure]:
    """Round trips and streams on one transport."""
    folder = setting.folder / transport.short
    folder.mkdir()
    figures = []
    with open_pairs(transport, loop, folder) as pairs:
        pids = [pid for pair in pairs for pid in (*pair.hub_pids, *pair.pids)]
        for place in _PLACES:
            with nullcontext() if place == "free" else pinned(pids):
                figures += _trip_figures(pairs, transport.name, place, setting)
        figures += _stream_figures(pairs, transport.name, setting)
    return figures


def _added_by_the_gateway(figures: list[Figure]) -> Figure:
    """Time added to a round trip by the second hub and the gateway."""
    trips_us = {figure.name: figure.value for figure in figures}
    through, direct = (trips_us[f"{way.name}: round trip, one CPU, {PYTHON}"] for way in (GATEWAY, UNIX_HUB))
    return Figure(
        f"{GATEWAY.name}: added to the round trip, one CPU",
        through - direct,
        "us",
        through / direct,
        f"through it to {UNIX_HUB.name}",
    )


def _beside_the_hub(transport: Transport, figures: list[Figure]) -> list[Figure]:
    """The figures of a transport of python-can, each with its ratio to that of the hub.

    :param figures: with the figures of the hub.
    """
    values = {figure.name: figure.value for figure in figures}
    return [
        replace(
            figure,
            ratio=figure.value / values[figure.name.replace(transport.name, UNIX_HUB.name)],
            against=f"to {UNIX_HUB.name}",
        )
        for figure in figures
        if figure.name.startswith(transport.name)
    ]


def _run_over(transport: Transport, setting: Setting, number: int) -> Finished:
    folder = setting.folder / f"{transport.short}{number}"
    folder.mkdir()
    with transport.opened(folder) as ends:
        return attached_run(setting, folder / "run", ends.near_flags, ends.far_flags, ends.hub_pids)


def _run_figures(ways: list[Transport], setting: Setting) -> list[Figure]:
    """Speed of a complete run over each transport.

    :raises MeasurementError: a run failed, or the frame logs are not all the same.
    """
    short = is_emulated()
    factors: defaultdict[str, list[float]] = defaultdict(list)
    hashes = set()
    for number in range(1 if short else setting.count(3, 1)):
        for transport in ways:
            done = _run_over(transport, setting.short() if short else setting, number)
            factors[transport.name].append(done.score["run"]["speed_factor"])
            hashes.add(done.frames_sha256)
    if len(hashes) != 1:
        raise MeasurementError(f"the runs over {', '.join(factors)} have different frame logs")
    base = median(factors[UNIX_HUB.name])
    figures = []
    for name, found in factors.items():
        compared = (None, "") if name == UNIX_HUB.name else (median(found) / base, f"to {UNIX_HUB.name}")
        figures.append(Figure(f"{name}: lockstep run", median(found), "sim s/s", *compared))
    return figures


def measure(setting: Setting) -> list[Figure | Missing]:
    """Round trips, streams and runs; what this machine lacks is reported as missing.

    :raises MeasurementError: a process did not start or did not answer, a frame was lost, or frame logs differ.
    """
    ways, missing = transports()
    loop = c_loop(setting.folder)
    figures: list[Figure] = []
    for transport in ways:
        figures += _loop_figures(transport, loop, setting)
    others, missing_others = foreign_transports(setting.multicast)
    for transport in others:
        found = _loop_figures(transport, loop, setting)
        figures += _beside_the_hub(transport, [*figures, *found])
    if GATEWAY in ways:
        figures.append(_added_by_the_gateway(figures))
    figures += _run_figures([transport for transport in ways if transport.runs], setting)
    return [*figures, *missing, *missing_others, *([loop] if isinstance(loop, Missing) else [])]
