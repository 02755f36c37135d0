"""The C functions of the exported controller in isolation: MVB framing compared with Python's, fuzzing, sending."""

from __future__ import annotations

import ctypes
import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.exported import STRICT
from hil_tests.support.foreign import PORTABLE, SANITIZED, CFrame, build, export_node
from hil_tests.support.paths import TEST_DATA
from railhil.bus.frame import Frame
from railhil.bus.mvb import TelegramSource, check_sequence
from railhil.bus.store import CAUSES, TrafficStore
from railhil.dbc import Port
from railhil.scenarios.load import load

pytestmark = pytest.mark.needs_compiler

_MVB = """\
#include "railhil_mvb.h"
unsigned octet(const unsigned char *data, unsigned count) { return railhil_check_sequence(data, count); }
static railhil_sink_t sink;
void begin(void) { memset(&sink, 0, sizeof sink); }
int take(uint32_t address, uint32_t word, unsigned bytes, uint32_t can_id, unsigned length, const unsigned char *data,
         int64_t now_ns)
{
    railhil_port_t port = {address, word, bytes};
    const int part = railhil_part(&port, can_id);
    return part < 0 ? -1 : (int)railhil_take(&port, &sink, part, length, data, now_ns, INT64_C(5000000));
}
const unsigned char *accepted(void) { return sink.data; }
unsigned make(uint32_t address, uint32_t word, unsigned bytes, const unsigned char *process, unsigned sequence,
              railhil_frame_t *frames)
{
    railhil_port_t port = {address, word, bytes};
    return railhil_frames(&port, process, &sequence, frames);
}
int life(int last, int now) { return (int)railhil_life(last, now); }
"""
#: Ports with every possible length of process data.
PORTS = [Port(f"P{f_code}", 0x200 + 8 * f_code, f_code, 0, "plant", "publish", "", ()) for f_code in range(5)]
OUTCOMES = ("part", "complete", "wrong_length", "wrong_check_sequence", "wrong_master_word", "wrong_block_count",
            "missing_block", "assembly_timeout")  # fmt: skip
#: Number of random frames passed to the receive function.
FUZZED = 1_000_000
_FUZZ = """\
#include <stdio.h>
#include "railhil_control.h"
static uint64_t state = 1;
static unsigned draw(unsigned below)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (unsigned)((state >> 33) % below);
}
/* Any frame; every other one with an identifier of the bench, most of those with right check sequences. */
static void make(railhil_frame_t *frame, const railhil_sink_t *sinks, int64_t now_ns)
{
    const unsigned port_number = draw(RAILHIL_SINK_COUNT + 4);
    unsigned i;
    frame->can_id = draw(2) ? draw(0x800) : draw(2) ? (uint32_t)draw(0x7FFFFFFF) * 2u : RAILHIL_POLL_ID;
    frame->length = draw(8) ? 8u : draw(9);
    for (i = 0; i < 8; i++) {
        frame->data[i] = (unsigned char)(draw(3) ? draw(256) : draw(2) ? 0u : 0xFFu);
    }
    if (draw(4) == 0) {
        const railhil_port_t *polled = &railhil_ports[draw(sizeof railhil_ports / sizeof railhil_ports[0])];
        frame->can_id = RAILHIL_POLL_ID;
        frame->length = 3;
        railhil_put_tail(frame->data, polled->word);
    } else if (port_number < RAILHIL_SINK_COUNT) {
        const railhil_port_t *port = &railhil_ports[port_number];
        const unsigned blocks = railhil_blocks(port);
        const unsigned part = draw(blocks + 1);
        if (port->bytes < RAILHIL_BLOCK) {
            frame->can_id = port->address;
            frame->data[4] = (unsigned char)railhil_check_sequence(frame->data, port->bytes);
            railhil_put_tail(frame->data + 5, port->word);
        } else if (part < blocks) {
            frame->can_id = port->address + part;
            if (port_number == RAILHIL_RUN_EVENT && part == 0) {
                frame->data[0] &= 0xFu; /* else hardly ever an event that there is */
            }
            if (port_number == RAILHIL_TIME_SYNC && part == 0 && draw(2)) {
                /* The present: hardly any other time is taken. */
                railhil_put16(frame->data, (uint32_t)(now_ns / 1000000000 >> 16));
                railhil_put16(frame->data + 2, (uint32_t)(now_ns / 1000000000));
                railhil_put16(frame->data + 4, (uint32_t)(now_ns % 1000000000 * 65536 / 1000000000));
                frame->data[7] = (unsigned char)(0x40u | draw(16));
            }
        } else {
            frame->can_id = port->address + RAILHIL_TRAILER;
            for (i = 0; i < blocks; i++) {
                frame->data[i] = (unsigned char)railhil_check_sequence(sinks[port_number].staged[i], RAILHIL_BLOCK);
            }
            frame->data[4] = (unsigned char)blocks;
            railhil_put_tail(frame->data + 5, port->word);
        }
        if (draw(8) == 0) {
            frame->data[draw(8)] ^= (unsigned char)(1u << draw(8));
        }
    }
}
int main(void)
{
    static railhil_control_t control;
    const railhil_watch_t *watch = &control.law.guard.watch;
    railhil_frame_t frame;
    railhil_frame_t answer[RAILHIL_FRAMES_MAX];
    unsigned long n;
    unsigned i;
    unsigned ends = 0;
    uint32_t steps = 0;
    unsigned long counts[RAILHIL_COUNTS] = {0};
    railhil_init(&control);
    for (n = 0; n < @COUNT@ul; n++) {
        unsigned count;
        make(&frame, control.sinks, railhil_now_ns(&control.clock));
        count = railhil_receive(&control, frame.can_id, frame.length, frame.data, answer);
        if (count > 3 || watch->level > RAILHIL_WATCH_LEVEL_EMERGENCY || watch->level < 0) {
            return 1;
        }
        if (watch->code > RAILHIL_FULL_CODE || watch->code < -RAILHIL_FULL_CODE) {
            return 2;
        }
        if (watch->level >= RAILHIL_WATCH_LEVEL_TRACTION_CUT && frame.can_id == RAILHIL_POLL_ID && count == 1 &&
            answer[0].can_id == railhil_ports[RAILHIL_NOTCH_CMD].address && watch->code > 0) {
            return 3;
        }
        if (control.ended != 0 && draw(50) == 0) {
            ends++;
            steps += control.law.steps;
            control.ended = 0;
            if (draw(4) == 0) {
                for (i = 0; i < RAILHIL_COUNTS; i++) {
                    counts[i] += control.counts[i];
                }
                railhil_init(&control);
            }
        }
        for (i = 0; i < count; i++) {
            if (answer[i].length != 8) {
                return 4;
            }
        }
    }
    steps += control.law.steps;
    printf("%lu steps %lu ends %u", n, (unsigned long)steps, ends);
    for (i = 0; i < RAILHIL_COUNTS; i++) {
        printf(" %s %lu", railhil_count_name(i), counts[i] + control.counts[i]);
    }
    printf("\\n");
    return 0;
}
"""

#: The program's send function, with an interface that accepts nothing for a given number of attempts.
_SEND = """\
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <sys/socket.h>
static ssize_t refuse(int fd, const void *data, size_t size, int flags);
#define send refuse
#include "railhil_socket.c"
static int refusals;
static int reason;
static ssize_t refuse(int fd, const void *data, size_t size, int flags)
{
    (void)fd;
    (void)flags;
    if (refusals-- > 0) {
        errno = reason;
        return -1;
    }
    printf("%02x ", (unsigned)((const struct can_frame *)data)->can_id);
    return (ssize_t)size;
}
int main(int argc, char **argv)
{
    railhil_bus_t bus;
    railhil_frame_t answer[2];
    (void)argc;
    memset(&bus, 0, sizeof bus);
    memset(answer, 0, sizeof answer);
    answer[0].can_id = 0x138;
    answer[1].can_id = 0x139;
    refusals = atoi(argv[1]);
    reason = strcmp(argv[2], "full") == 0 ? ENOBUFS : ENETDOWN;
    bus.channel = "can0";
    bus.lockstep_ms = 2000;
    printf("%d ", railhil_bus_send(&bus, answer, 2, argv[3][0] == 'l'));
    printf("dropped %lu\\n", bus.dropped);
    return 0;
}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An export of the law that uses most of the controller's functions."""
    path = tmp_path_factory.mktemp("export")
    export_node(load("lvshun_tieshan_worn_wheels"), path, law="ipfc_plus")
    return path


@pytest.fixture(scope="module")
def mvb(folder: Path) -> ctypes.CDLL:
    """``railhil_mvb.h`` as a library; the process ends at undefined behaviour."""
    (folder / "mvb.c").write_text(_MVB)
    flags = (*STRICT, "-O1", "-fPIC", "-shared", "-fsanitize=undefined", "-fsanitize-undefined-trap-on-error")
    library = ctypes.CDLL(str(build(folder, ["mvb.c"], "mvb.so", flags)))
    library.accepted.restype = ctypes.POINTER(ctypes.c_ubyte)
    return library


def _c_frames(mvb: ctypes.CDLL, address: int, f_code: int, data: bytes, sequence: int) -> list[Frame]:
    frames = (CFrame * 5)()
    count = mvb.make(address, f_code << 12 | address, len(data), data, sequence, frames)
    return [Frame(frame.can_id, bytes(frame.data[: frame.length])) for frame in frames[:count]]


def test_vectors(mvb: ctypes.CDLL) -> None:
    """Correct and wrong check sequences, and telegrams as CAN frames, from the shipped vectors."""
    path = TEST_DATA / "mvb" / "vectors.jsonl"
    vectors = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    kinds = {"block": 0, "shim": 0}
    for vector in vectors:
        if vector["kind"] == "block":
            data = bytes.fromhex(vector["data"])
            assert (mvb.octet(data, len(data)) == int(vector["cs"], 16)) == vector["ok"], vector["why"]
        elif vector["kind"] == "shim":
            frames = _c_frames(
                mvb, vector["address"], vector["f_code"], bytes.fromhex(vector["data"]), int(vector["seq"])
            )
            assert [[f"{frame.can_id:x}", frame.data.hex()] for frame in frames] == vector["can"]
        else:
            continue
        kinds[vector["kind"]] += 1
    assert kinds == {"block": 73, "shim": 27}


@given(data=st.binary(min_size=0, max_size=8))
def test_check_sequence_is_ours(mvb: ctypes.CDLL, data: bytes) -> None:
    assert mvb.octet(data, len(data)) == check_sequence(data)


@st.composite
def bus_traffic(draw: Callable[..., object]) -> tuple[Port, list[tuple[Frame, int]]]:
    """A port and the frames that arrive on it, with their times: some lost, damaged, cut, swapped or late."""
    port: Port = draw(st.sampled_from(PORTS))  # type: ignore[assignment]
    source = TelegramSource(port)
    arriving: list[tuple[Frame, int]] = []
    now_ns = 0
    for _ in range(draw(st.integers(1, 6))):  # type: ignore[call-overload]
        data = draw(st.binary(min_size=port.data_bytes, max_size=port.data_bytes))
        for frame in source.frames(data):  # type: ignore[arg-type]
            now_ns += draw(st.sampled_from((0, 0, 1_000_000, 6_000_000)))  # type: ignore[operator]
            kind = draw(st.sampled_from(("right", "right", "right", "lost", "flipped", "cut", "swapped", "doubled")))
            if kind == "flipped":
                bit: int = draw(st.integers(0, 63))  # type: ignore[assignment]
                frame = frame._replace(data=(int.from_bytes(frame.data) ^ 1 << bit).to_bytes(8))
            elif kind == "cut":
                frame = frame._replace(data=frame.data[: draw(st.integers(0, 7))])  # type: ignore[misc]
            elif kind == "swapped":
                frame = frame._replace(can_id=port.address + draw(st.integers(0, 7)))  # type: ignore[operator]
            arriving += [(frame, now_ns)] * {"lost": 0, "doubled": 2}.get(kind, 1)  # type: ignore[call-overload]
    return port, arriving


@pytest.mark.slow
@settings(max_examples=400)
@given(traffic=bus_traffic())
def test_telegrams_are_taken_and_refused_as_by_our_store(
    mvb: ctypes.CDLL, traffic: tuple[Port, list[tuple[Frame, int]]]
) -> None:
    port, arriving = traffic
    store = TrafficStore([port])
    counts: dict[str, int] = {}
    mvb.begin()
    word = port.f_code << 12 | port.address
    for frame, now_ns in arriving:
        committed = store.feed(frame, now_ns)
        outcome = mvb.take(
            port.address, word, port.data_bytes, frame.can_id, len(frame.data), frame.data, ctypes.c_int64(now_ns)
        )
        assert (outcome == OUTCOMES.index("complete")) == (committed is not None)
        # Identifiers that belong to no port, and that of the CAN FD form, are not compared here.
        if outcome >= 2:
            counts[OUTCOMES[outcome]] = counts.get(OUTCOMES[outcome], 0) + 1
        if frame.can_id == port.fd_id:
            store.counters["wrong_length"] -= 1
        if committed:
            assert bytes(mvb.accepted()[: port.data_bytes]) == store.raw(port.name)
    assert counts == {cause: store.counters[cause] for cause in CAUSES[4:] if store.counters[cause]}


@pytest.mark.parametrize("port", PORTS[2:], ids=lambda port: port.name)
def test_what_is_left_over_of_one_telegram_does_not_spoil_the_next(mvb: ctypes.CDLL, port: Port) -> None:
    """All of one telegram except the trailer arrived, or a stray frame of zeros; the next one comes seconds later."""
    word = port.f_code << 12 | port.address

    def take(frame: Frame, now_ns: int) -> str:
        return OUTCOMES[
            mvb.take(port.address, word, port.data_bytes, frame.can_id, 8, frame.data, ctypes.c_int64(now_ns))
        ]

    whole = TelegramSource(port).frames(bytes(range(port.data_bytes)))
    for left_over in (whole[:-1], whole[:1], [Frame(whole[-2].can_id, bytes(8))]):
        mvb.begin()
        assert {take(frame, 5_000_000_000) for frame in left_over} == {"part"}
        assert [take(frame, 14_000_000_000) for frame in whole][-1] == "complete"
    mvb.begin()
    assert take(whole[0], 0) == "part"
    late = [take(frame, 5_000_001) for frame in whole[1:]]
    assert late[-1] == "assembly_timeout"


def test_life_signs_are_judged_as_ours(mvb: ctypes.CDLL) -> None:
    from railhil.bus.lifesign import Life, LifeSign

    kinds = {Life.FIRST: 0, Life.NEXT: 0, Life.GAP: 1, Life.DUPLICATE: 2, Life.OUT_OF_ORDER: 3}
    for last in range(-1, 16):
        for life in range(16):
            sign = LifeSign()
            if last >= 0:
                sign.accept(last)
            assert mvb.life(last, life) == kinds[sign.judge(life)]


@pytest.mark.long
@pytest.mark.slow
def test_a_million_random_frames_do_no_harm(folder: Path) -> None:
    """Any identifier, length and content, half of them with correct check sequences: no undefined behaviour, no invalid
    memory access, no notch beyond the largest, no traction from TRACTION_CUT on, and every path taken."""
    (folder / "fuzz.c").write_text(_FUZZ.replace("@COUNT@", str(FUZZED)))
    program = build(folder, ["ipfc_plus.c", *PORTABLE, "fuzz.c"], "fuzz", SANITIZED)
    done = subprocess.run([program], capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    words = done.stdout.split()
    assert int(words[0]) == FUZZED
    counts = {name: int(count) for name, count in zip(words[1::2], words[2::2], strict=True)}
    assert min(counts["steps"], counts["ends"]) > 100
    assert {name for name, count in counts.items() if count == 0} <= {"assembly_timeout", "balise_late"}


def test_an_answer_in_lockstep_waits_for_the_interface(folder: Path) -> None:
    """In real time the answer is dropped, since a newer one follows; in lockstep none follows."""
    (folder / "send.c").write_text(_SEND)
    program = build(folder, ["send.c", "railhil_slcan.c"], "send", STRICT)

    def sent(*arguments: object) -> str:
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=60, check=False)
        return done.stdout.strip()

    whole, nothing = "138 139 0 dropped 0", "0 dropped 1"
    assert sent(3, "full", "realtime") == whole
    assert sent(10_000, "full", "realtime") == nothing
    assert sent(200, "full", "lockstep") == whole
    assert sent(1, "down", "realtime") == nothing
    assert sent(5, "down", "lockstep") == whole
    assert sent(10_000, "full", "lockstep") == nothing
