"""Telegrams to frames and back, check sequence, and the line of the frame log, compared with common libraries."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import cantools
from can.io import CanutilsLogWriter

from benchmarks.figures import Figure, MeasurementError, Setting, cpu_ns
from railhil import dbc
from railhil.bus.frame import Frame, to_message
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, check_sequence
from railhil.bus.store import TrafficStore
from railhil.record.framelog import log_line
from railhil.wire.ato import SimTruth, TrnSpeed

TITLE = "codec"
METHOD = (
    "CPU time per telegram, best of 60 blocks of 500, in turns. Encode: fields to CAN frames, check sequences and "
    "master word computed. Decode: fields of process data. Receive: traffic store (all checks) and decode. cantools "
    "encodes and decodes the same frames with raw values; it is given the check sequences and does not verify them. "
    "Log: one candump line into the null device, python-can's writer with the message it needs."
)
_DBC = Path(dbc.__file__).with_name("railhil.dbc")
_TIME_NS = 123_450_000_000


def _telegram_figures(telegram: Telegram, database: Any, setting: Setting) -> list[Figure]:
    """Encode, decode and receive of one telegram."""
    kind, port = type(telegram), telegram.port()
    source = TelegramSource(port)
    frames = source.frames(telegram.encode())
    messages = [database.get_message_by_frame_id(frame.can_id) for frame in frames]
    packets = [frame.data for frame in frames]
    pairs = list(zip(messages, packets, strict=True))
    data = telegram.encode()
    store = TrafficStore([port])

    def receive() -> Telegram | None:
        for frame in frames:
            store.feed(frame, _TIME_NS)
        return store.read(kind, _TIME_NS)[0]

    def theirs_encoded() -> list[bytes]:
        return [message.encode(values, scaling=False) for message, values in encodings]

    def theirs_decoded() -> list[Any]:
        return [message.decode(packet, decode_choices=False, scaling=False) for message, packet in pairs]

    encodings = list(zip(messages, theirs_decoded(), strict=True))
    if theirs_encoded() != packets or receive() != telegram or kind.decode(data) != telegram:
        raise MeasurementError(f"codec: {port.name} does not come back as it was")
    encode_ns, their_encode_ns = cpu_ns(setting, lambda: source.frames(telegram.encode()), theirs_encoded)
    decode_ns, receive_ns, their_decode_ns = cpu_ns(setting, lambda: kind.decode(data), receive, theirs_decoded)
    what = f"{port.name} ({len(frames)} frame{'s' * (len(frames) > 1)})"
    against = "cantools to ours"
    return [
        Figure(f"{what}: encode", encode_ns, "ns", their_encode_ns / encode_ns, against),
        Figure(f"{what}: encode with cantools", their_encode_ns, "ns"),
        Figure(f"{what}: decode", decode_ns, "ns", their_decode_ns / decode_ns, against),
        Figure(f"{what}: receive, all checks and decode", receive_ns, "ns", their_decode_ns / receive_ns, against),
        Figure(f"{what}: decode with cantools", their_decode_ns, "ns"),
    ]


def _log_figures(frame: Frame, setting: Setting) -> list[Figure]:
    with open(os.devnull, "w", encoding="ascii") as ours, open(os.devnull, "w", encoding="ascii") as theirs:
        writer = CanutilsLogWriter(theirs)
        line_ns, their_ns = cpu_ns(
            setting,
            lambda: ours.write(log_line(_TIME_NS, frame)),
            lambda: writer.on_message_received(to_message(frame, _TIME_NS / 1e9)),
        )
    return [
        Figure("candump line", line_ns, "ns", their_ns / line_ns, "python-can's writer to ours"),
        Figure("candump line with python-can's writer", their_ns, "ns"),
    ]


def measure(setting: Setting) -> list[Figure]:
    """Figures of a single-frame and of a three-frame telegram, of the check sequence and of the log line.

    :raises MeasurementError: the two codecs do not agree.
    """
    database = cantools.database.load_file(_DBC)
    speed = TrnSpeed(215_678, life=7)
    truth = SimTruth(12_345_678, 215_678, life=7, accel_01mmps2=-4321, traction_20n=1234, grade_001permil=-600)
    figures = [figure for telegram in (speed, truth) for figure in _telegram_figures(telegram, database, setting)]
    short, block = truth.encode()[:4], truth.encode()[:8]
    short_ns, block_ns = cpu_ns(setting, lambda: check_sequence(short), lambda: check_sequence(block))
    figures += [
        Figure("check sequence of 4 bytes", short_ns, "ns"),
        Figure("check sequence of 8 bytes", block_ns, "ns"),
    ]
    return figures + _log_figures(TelegramSource(speed.port()).frames(speed.encode())[0], setting)
