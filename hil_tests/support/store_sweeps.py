"""Dense sweeps of the stages before the gates (life sign, traffic store), compared with the mapping's layout diagrams.

As in :mod:`hil_tests.support.gate_sweeps` each sweep takes the module under test.
"""

from __future__ import annotations

import random
from itertools import product
from types import ModuleType
from typing import Any

from railhil.bus import lifesign, store
from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.mvb import TelegramSource
from railhil.dbc import Port, wire_contract
from railhil.wire.ato import TrnSpeed

MS = 1_000_000
#: A telegram of each size; the port table uses F1 to F3 only.
PORTS = [
    Port("X_F0", 0x200, 0, 0, "plant", "event", "", ()),
    wire_contract().port("TRN_SPEED"),
    wire_contract().port("TRN_POS"),
    wire_contract().port("TRK_INFO"),
    Port("X_F4", 0x208, 4, 0, "plant", "event", "", ()),
]

# -- life sign --------------------------------------------------------------------------------------------------------


def sweep_lifesign(module: ModuleType) -> None:
    """Every pair of life signs; the four verdicts as a ring."""
    ring = ["duplicate", "next", *["gap"] * 6, *["out_of_order"] * 8]
    assert module.MAX_STEP == 7
    for last in range(16):
        sign = module.LifeSign()
        for life in range(16):
            assert sign.judge(life) is module.Life.FIRST
        sign.accept(last)
        for life in range(16):
            assert sign.judge(life).value == ring[(life - last) % 16]
    assert [life.value for life in module.Life if life.fresh] == ["first", "next", "gap"]


# -- traffic store ----------------------------------------------------------------------------------------------------


def telegram_of(port: Port, fd: bool, seed: int = 1) -> tuple[bytes, list[Frame]]:
    data = random.Random(seed).randbytes(port.data_bytes)
    return data, TelegramSource(port, fd).frames(data)


def changed(frame: Frame, byte: int, mask: int) -> Frame:
    data = bytearray(frame.data)
    data[byte] ^= mask
    return frame._replace(data=bytes(data))


def expected_cause(port: Port, fd: bool, frame_index: int, byte: int, mask: int) -> str | None:
    """What the layout diagrams say about a flipped bit; None: the bit is not used."""
    if port.single_frame:
        if byte in (2, 3) and port.f_code == 0:
            return None
        return "wrong_check_sequence" if byte <= 4 else "wrong_master_word"
    trailer = byte - port.data_bytes if fd else (byte if frame_index == port.blocks else -1)
    if trailer < 0:
        return "wrong_check_sequence"
    if trailer < 4:
        return "wrong_check_sequence" if trailer < port.blocks else None
    if trailer == 4:
        return "wrong_block_count" if mask & 0x0F else None
    return "wrong_master_word" if trailer < 8 else None


def fed(traffic: Any, frames: list[Frame], now_ns: int = 0) -> str | None:
    results = [traffic.feed(frame, now_ns) for frame in frames]
    assert results[:-1] == [None] * (len(frames) - 1)
    return results[-1]  # type: ignore[no-any-return]


def sweep_store_accepts(module: ModuleType) -> None:
    """Whole telegrams of every size in both forms, with their age from time 0 on."""
    traffic = module.TrafficStore(PORTS)
    assert traffic.ports == tuple(port.name for port in PORTS)
    assert traffic.read(TrnSpeed, 5) == (None, 65_535_000_000)
    assert module.NEVER_NS == 65_535_000_000
    for count, fd in enumerate((False, True), 1):
        for port in PORTS:
            assert traffic.raw(port.name) == (b"" if count == 1 else telegram_of(port, False, 1)[0])
            data, frames = telegram_of(port, fd, count)
            assert fed(traffic, frames, 0) == port.name
            assert traffic.raw(port.name) == data
            assert traffic.accepted(port.name) == count
    assert traffic.read(TrnSpeed, 0)[1] == 0
    assert traffic.read(TrnSpeed, 777)[1] == 777
    assert fed(traffic, telegram_of(PORTS[1], False)[1], 500) == "TRN_SPEED"
    assert traffic.read(TrnSpeed, 777)[1] == 277
    assert not traffic.counters
    for wrong in (traffic.raw, traffic.accepted):
        # Not pytest.raises: what it raises ends a mutation test (hil_tests/mutation/in_memory.py).
        try:
            wrong("SIM_TRUTH")
        except KeyError:
            continue
        raise AssertionError("a port that is not in the store")


def sweep_store_empty(module: ModuleType) -> None:
    """Empty before and after a telegram, not between its frames; a whole telegram of another port changes nothing."""
    traffic = module.TrafficStore(PORTS)
    assert traffic.is_empty is True
    _, other = telegram_of(PORTS[1], False)
    for fd in (False, True):
        for port in PORTS:
            _, frames = telegram_of(port, fd)
            for frame in frames[:-1]:
                traffic.feed(frame, 0)
                assert traffic.is_empty is False
                assert fed(traffic, other) == PORTS[1].name
                assert traffic.is_empty is False
            assert traffic.feed(frames[-1], 0) == port.name
            assert traffic.is_empty is True


def sweep_store_bits(module: ModuleType) -> None:
    """One bit of every byte of every frame flipped."""
    for port in PORTS:
        for fd in (False, True):
            _, frames = telegram_of(port, fd)
            for index, frame in enumerate(frames):
                for byte in range(len(frame.data)):
                    for mask in (0x01, 0x10):
                        traffic = module.TrafficStore([port])
                        result = fed(traffic, [*frames[:index], changed(frame, byte, mask), *frames[index + 1 :]])
                        cause = expected_cause(port, fd, index, byte, mask)
                        assert result == (None if cause else port.name)
                        assert traffic.counters == ({cause: 1} if cause else {})
                        assert traffic.accepted(port.name) == (0 if cause else 1)


def sweep_store_forms(module: ModuleType) -> None:
    """Every flag, every length, every identifier around the right one."""
    reasons = {ERROR: "error_frame", REMOTE: "remote_frame", EXTENDED: "extended_id"}
    for port in PORTS:
        for fd in (False, True):
            _, frames = telegram_of(port, fd)
            for frame in frames:
                for flags in range(32):
                    cause = next((name for bit, name in reasons.items() if flags & bit), None)
                    if cause is None and (flags & ~BRS != FD if fd else flags):
                        cause = "wrong_length"
                    traffic = module.TrafficStore([port])
                    traffic.feed(frame._replace(flags=flags), 0)
                    assert not cause or traffic.counters == {cause: 1}
                    assert cause or "wrong_length" not in traffic.counters
                for size in range(66):
                    traffic = module.TrafficStore([port])
                    traffic.feed(frame._replace(data=frame.data[:size].ljust(size, b"\0")), 0)
                    assert (traffic.counters == {"wrong_length": 1}) == (size != len(frame.data))
        known = {*port.can_ids, port.fd_id}
        for can_id in range(port.address - 2, port.address + 8):
            traffic = module.TrafficStore([port])
            traffic.feed(Frame(can_id, b"123"), 0)
            assert traffic.counters == {"wrong_length" if can_id in known else "unknown_id": 1}


def sweep_store_assembly(module: ModuleType) -> None:
    """Which blocks have arrived, and how long they took."""
    assert module.ASSEMBLY_NS == 5 * MS
    for port in PORTS[2:]:
        data, frames = telegram_of(port, False)
        blocks, trailer = frames[:-1], frames[-1]
        for present in range(1 << len(blocks)):
            traffic = module.TrafficStore([port])
            some = [block for k, block in enumerate(blocks) if present >> k & 1]
            whole = len(some) == len(blocks)
            assert fed(traffic, [*some, trailer]) == (port.name if whole else None)
            assert traffic.counters == ({} if whole else {"missing_block": 1})
            # Whatever the result of the trailer, the blocks are discarded.
            assert traffic.feed(trailer, 0) is None
            assert traffic.counters["missing_block"] == (1 if whole else 2)
            assert fed(traffic, frames) == port.name
        for limit_ns in (None, 0, 3):
            allowed_ns = 5 * MS if limit_ns is None else limit_ns
            for over_ns in (0, 1):
                arguments = () if limit_ns is None else (limit_ns,)
                traffic = module.TrafficStore([port], *arguments)
                # The time counts from the first block, regardless of their order.
                traffic.feed(blocks[-1], 1000)
                for block in blocks[:-1]:
                    traffic.feed(block, 1000 + allowed_ns)
                result = traffic.feed(trailer, 1000 + allowed_ns + over_ns)
                assert result == (None if over_ns else port.name)
                assert traffic.counters == ({"assembly_timeout": 1} if over_ns else {})
        # Frames that waited in mailboxes are read in block order, whatever the order in which they arrived; the first
        # frame of all has no effect on those of the next telegram.
        for times_ns in product((0, 5 * MS, 5 * MS + 1), repeat=len(frames)):
            traffic = module.TrafficStore([port])
            assert fed(traffic, frames, 20 * MS) == port.name
            results = [traffic.feed(frame, time_ns) for frame, time_ns in zip(frames, times_ns, strict=True)]
            too_long = max(times_ns) - min(times_ns) > 5 * MS
            assert results[-1] == (None if too_long else port.name)
            assert traffic.counters == ({"assembly_timeout": 1} if too_long else {})
        # Blocks left over long ago, or stray ones, are replaced by the next telegram.
        for stray in blocks:
            traffic = module.TrafficStore([port])
            traffic.feed(stray._replace(data=bytes(8)), 5_000 * MS)
            assert fed(traffic, frames, 14_000 * MS) == port.name
            assert not traffic.counters
        traffic = module.TrafficStore([port])
        assert fed(traffic, telegram_of(port, True)[1], 10**12) == port.name
        assert fed(traffic, telegram_of(port, True)[1], 0) == port.name
        assert traffic.raw(port.name) == data


STORE_SWEEPS: dict[ModuleType, tuple[Any, ...]] = {
    lifesign: (sweep_lifesign,),
    store: (sweep_store_accepts, sweep_store_empty, sweep_store_assembly, sweep_store_forms, sweep_store_bits),
}
