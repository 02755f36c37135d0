"""The hub under load: one total order for all clients, and no losses for a slow reader."""

from __future__ import annotations

import hashlib
import itertools
import subprocess
import sys

import pytest

from hil_tests.support.hub import PATIENCE_S, running_hub
from railhil.bus.frame import Frame

_FRAMES_PER_CLIENT = 4000
_SENDER = """
import hashlib, random, sys
import can
from railhil.bus.frame import Frame
from railhil.bus.hub.client import HubBus

channel, number, count, clients = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
rng = random.Random(number)
bus = HubBus(channel, receive_own_messages=True, connect_timeout=20.0)
# Everybody starts when the last one has come: each says hello until all have been heard.
bus.send_frames([Frame(0x7F0 + number, b"")])
assert sys.stdin.readline() == "go\\n"
order = []
sent = 0
seen = [0] * clients
while len(order) < clients * count:
    # Nobody runs ahead of the others by more than this, or one could be through before the next one starts.
    may_send = sent < count and sent - min(seen) < 300
    if may_send:
        size = min(rng.choice((0, 1, 1, 2, 5, 60)), count - sent)
        batch = [Frame(0x100 + number, (sent + k).to_bytes(4, "big")) for k in range(max(size, 1))]
        if size == 0:
            bus.send(can.Message(arbitration_id=batch[0].can_id, data=batch[0].data, is_extended_id=False))
        else:
            bus.send_frames(batch)
        sent += len(batch)
    timeout_s = 0.0 if may_send else 20.0
    if rng.random() < 0.5:
        frames = bus.recv_frames(timeout_s)
    else:
        message = bus.recv(timeout_s)
        frames = [] if message is None else [Frame(message.arbitration_id, bytes(message.data))]
    assert frames or may_send, "silence"
    for frame in frames:
        if frame.can_id < 0x7F0:
            order.append(frame)
            seen[frame.can_id - 0x100] += 1
for client in range(clients):
    mine = [int.from_bytes(frame.data, "big") for frame in order if frame.can_id == 0x100 + client]
    assert mine == list(range(count)), f"client {client}"
print(hashlib.sha256(repr(order).encode()).hexdigest())
bus.shutdown()
"""


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("options", [(), ("--arbitration",)], ids=["plain", "arbitration"])
def test_three_clients_under_load_see_one_total_order(options: tuple[str, ...]) -> None:
    clients = 3
    with running_hub(*options) as hub, hub.bus() as watcher:
        senders = [
            subprocess.Popen(
                [sys.executable, "-c", _SENDER, hub.channel, str(k), str(_FRAMES_PER_CLIENT), str(clients)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
            for k in range(clients)
        ]
        present: set[int] = set()
        while len(present) < clients:
            frames = watcher.recv_frames(PATIENCE_S)
            assert frames
            present |= {frame.can_id for frame in frames}
        for sender in senders:
            assert sender.stdin is not None
            sender.stdin.write("go\n")
            sender.stdin.flush()
        order: list[Frame] = []
        while len(order) < clients * _FRAMES_PER_CLIENT:
            frames = watcher.recv_frames(PATIENCE_S)
            assert frames, f"silence after {len(order)} frames"
            order += frames
        hashes = {sender.communicate(timeout=PATIENCE_S)[0].strip() for sender in senders}
        assert hashes == {hashlib.sha256(repr(order).encode()).hexdigest()}
        assert all(sender.returncode == 0 for sender in senders)
        # The frames are interleaved: two clients are never more than 300 + 60 frames apart, so no run of one client
        # is longer than twice that.
        runs = [len(list(run)) for _, run in itertools.groupby(order, key=lambda frame: frame.can_id)]
        assert max(runs) <= 2 * 360


@pytest.mark.slow
def test_large_packets_wait_for_a_slow_tcp_reader() -> None:
    """More than the kernel holds, so that packets are cut where the socket buffer ends."""
    packets = 4000
    with running_hub(channel="tcp://127.0.0.1:0") as hub, hub.bus() as writer, hub.bus() as reader:
        rest = [Frame(0x200, b"12345678")] * 255
        for number in range(packets):
            writer.send_frames([Frame(0x100, number.to_bytes(4, "big")), *rest])
        for number in range(packets):
            assert reader.recv_frames(PATIENCE_S) == [Frame(0x100, number.to_bytes(4, "big")), *rest]
        assert hub.stderr() == ""


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("channel", [None, "tcp://127.0.0.1:0"], ids=["path", "tcp"])
def test_a_hundred_thousand_frames_wait_for_a_slow_reader(channel: str | None) -> None:
    count = 100_000
    with running_hub(channel=channel) as hub, hub.bus() as writer, hub.bus() as reader:
        sent = 0
        while sent < count:
            # Mostly packets of a single frame: those cost the hub most per byte.
            size = min(50 if sent % 1000 == 0 else 1, count - sent)
            writer.send_frames([Frame(0x100, (sent + k).to_bytes(4, "big")) for k in range(size)])
            sent += size
        received = 0
        while received < count:
            frames = reader.recv_frames(PATIENCE_S)
            assert frames, f"only {received} of {count} frames"
            for frame in frames:
                assert frame.data == received.to_bytes(4, "big")
                received += 1
        assert hub.stderr() == ""
