"""A train controller written from docs/reference/wire.md, without railhil.

Usage: controller.py INTERFACE CHANNEL DBC
"""

import hashlib
import math
import sys
from pathlib import Path

import can
import cantools

BRAKE_MPS2, TRACTION_MPS2, MARGIN_MPS, EARLY_M = 0.55, 0.8, 0.6, 0.3  # of the plan, with the margin to the limit
NOTCH_PER_MPS2, EFFORT_LEAD, GAIN_PER_S = 5.9, 4.0, 1.0  # of the train: notches for its mass, its slow actuator
dbc = cantools.database.load_file(sys.argv[3])
wire_hash = int(hashlib.sha256(Path(sys.argv[3]).read_bytes()).hexdigest()[:8], 16)
messages = {message.frame_id: message for message in dbc.messages}
bus = can.Bus(interface=sys.argv[1], channel=sys.argv[2])
blocks, values, counts, ticks = {}, {}, {}, 0  # by identifier; newest by port; own telegrams by address; of 10 ms


def check(block):
    """Remainder of x^7+x^6+x^5+x^2+1, even parity over data and remainder, all inverted."""
    data = remainder = int.from_bytes(block, "big") << 7
    for bit in range(8 * len(block) + 6, 6, -1):
        if remainder >> bit & 1:
            remainder ^= 0b11100101 << bit - 7
    return 0xFF ^ (remainder << 1 | (data | remainder).bit_count() & 1)


def take(can_id, data):
    """Take a frame; the port whose telegram it completes, if that is whole and right, else an empty text."""
    address, part = can_id & ~7, can_id & 7
    if part < 4 and address + 4 in messages:
        blocks[can_id] = data
        return ""
    parts = [blocks.pop(address + number, b"") for number in range(data[4] & 15)] if part else [data[:4]]
    if bytes(map(check, parts)) != data[0 if part else 4 :][: len(parts)] or check(data[5:7]) != data[7]:
        return ""
    values[port := messages[address].name] = {}
    for number, block in enumerate(parts):
        values[port] |= dbc.decode_message(address + number, block.ljust(8, b"\0"), decode_choices=False)
    return port


def send(can_id, data):
    bus.send(can.Message(arbitration_id=can_id, data=data, is_extended_id=False))


def answer(poll, address, signals):
    """Send a telegram, which ends as its poll; a signal that is not given is 0, a life sign counts."""
    counts[address] = count = (counts.get(address, -1) + 1) % 16
    own = [messages[can_id] for can_id in range(address, address + 4) if can_id in messages]
    given = {signal.name: 0 for message in own for signal in message.signals} | signals
    given |= {name: count for name in given if name.endswith("Life")}
    parts = [message.encode(given, scaling=False, strict=False) for message in own]
    if poll[0] >> 4 == 1:
        return send(address, parts[0][:4] + bytes([check(parts[0][:4])]) + poll)
    for number, part in enumerate(parts):
        send(address + number, part)
    return send(address + 4, bytes(map(check, parts)).ljust(4, b"\0") + bytes([count << 4 | len(parts)]) + poll)


def notch_256th():
    """Follow a speed that arrives in time and ends on a parabola at the stopping point."""
    track, position, speed = values["TRK_INFO"], values["TRN_POS"], values["TRN_SPEED"]["TrainSpeed"]
    left_m, left_s = max(track["TargetPos"] - EARLY_M - position["TrainPos"], 0), track["TargetTime"] - ticks / 100
    cruise = BRAKE_MPS2 * (left_s - math.sqrt(max(left_s**2 - 2 * left_m / BRAKE_MPS2, 0)))
    curve = math.sqrt(2 * BRAKE_MPS2 * left_m)
    target = min(max(cruise, 1.0), track["SpeedLimit"] - MARGIN_MPS, curve)
    wanted_mps2 = min(GAIN_PER_S * (target - speed), TRACTION_MPS2) - BRAKE_MPS2 * (target == curve)
    needed = NOTCH_PER_MPS2 * (wanted_mps2 + 0.00981 * track["Gradient"])
    notch = needed + EFFORT_LEAD * (needed - 0.07 * position["EffortActual"])
    return round(256 * max(-7.0, min(7.0, notch)))


while (message := bus.recv(timeout=120)) is not None:
    can_id, data = message.arbitration_id, bytes(message.data)
    if message.is_error_frame or message.is_extended_id or can_id not in messages:
        continue
    if can_id != 0x080:
        port = take(can_id, data) if len(data) == 8 else ""
        if port == "TRN_SPEED":  # opens each tick; its life sign counts them
            ticks += (values[port]["SpeedLife"] - ticks) % 16
        elif port == "RUN_EVENT" and values[port]["RunEvent"] >= 4:
            sys.exit()
    elif len(data) == 3 and check(data[:2]) == data[2]:
        word = int.from_bytes(data[:2], "big")
        if word == 0xF001:  # device status, F_code 15, of device 1: its check sequence is that of two octets
            send(0x088, b"\x10\0\0\0" + bytes([check(b"\x10\0")]) + data)
        elif word == 0x3170:  # CTL_IDENT: as the plant, which knows no law, with the own role and DBC
            stated = {"Ctl" + name[3:]: value for name, value in values["PLT_IDENT"].items()}
            answer(data, 0x170, stated | {"CtlRole": 1, "CtlWireHash": wire_hash})
        elif word == 0x1110:  # NOTCH_CMD
            answer(data, 0x110, {"NotchCmd": notch_256th(), "CtlMode": 1, "NotchChk": 1, "EmergencyBrake": 1})
        elif word == 0x3138:  # CTL_STAT, without telemetry
            answer(data, 0x138, {"TelemetryIndex": 127, "TelemetryHeadroom": 31, "CtlChk": 1, "CtlReady": 2})
