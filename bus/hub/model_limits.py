"""The list of properties that the hub models or leaves out, for `railhil doctor`, the report and docs/hub.md."""

from __future__ import annotations

from typing import NamedTuple


class Modelled(NamedTuple):
    """One property of a CAN bus. ``option``: of ``railhil bus hub``; empty: always. ``by``: the hub's behaviour, empty:
    not modelled at all. ``without``: the part that is missing even then."""

    subject: str
    option: str
    by: str
    without: str


HUB = (
    Modelled(
        "order",
        "",
        "every frame reaches every client, in one order for all",
        "sampling, propagation delay, receive overflow (a client 64 MiB behind, `--queue-limit`, is disconnected)",
    ),
    Modelled("acknowledgement", "", "", "a frame counts as sent when nobody hears it"),
    Modelled(
        "bit rate",
        "--bitrate-model",
        "a frame takes its exact length, stuff bits counted",
        "time of error frames and of repeated frames",
    ),
    Modelled(
        "arbitration",
        "--arbitration",
        "frames that wait at the same time leave by identifier",
        "the error of two senders of one identifier",
    ),
    Modelled(
        "bit errors",
        "--faults",
        "by order: TEC and REC of ISO 11898-1, error-passive, repetition, SocketCAN error frames",
        "their cause (bit, stuff, form, CRC), errors at one receiver only, the REC + 8 after an error flag",
    ),
    Modelled(
        "bus-off",
        "--faults",
        "TEC above 255 or by order; restart by order or --restart-ms, after 128 x 11 bits of the bit rate",
        "recovery delayed by traffic; without a bit rate it takes no time",
    ),
    Modelled(
        "two lines",
        "--faults",
        "by order dead at a client; switch-over at once and counted, guard of 16 frames",
        "a break in the middle, a frame lost at the switch-over, the master's order to switch",
    ),
    Modelled(
        "transmit queue",
        "--faults",
        "full by order: ENOBUFS; in real time retried for 20 ms, then dropped, in lockstep dropped at once",
        "its length: frames waiting in it are never sent later",
    ),
)


def sentence() -> str:
    """The limits of a hub without options, for a table of transports."""
    never = [row.subject for row in HUB if not row.by]
    options: dict[str, list[str]] = {}
    for row in HUB:
        if row.option:
            options.setdefault(row.option, []).append(row.subject)
    asked = "; ".join(f"{', '.join(subjects)} only with {option}" for option, subjects in options.items())
    return f"no {' and no '.join(never)}; {asked} (docs/hub.md)"


def markdown() -> str:
    """The list as a table of docs/hub.md."""
    lines = ["| property | option | what the hub does | what is not modelled |", "|---|---|---|---|"]
    for row in HUB:
        option = f"`{row.option}`" if row.option else "always" if row.by else "none"
        lines.append(f"| {row.subject} | {option} | {row.by or 'nothing'} | {row.without} |")
    return "\n".join(lines) + "\n"
