"""Fuzz: frames that nobody sent, before every tick of a run in one process.

``python -m hil_tests.fuzz --frames 1000000 --seed 1`` runs the published scenario twice, quietly and under fuzz; the
controller, the plant (as bus administrator) and the supervisor each get every such frame. It prints the figures; exit
code 1 if a node answered one, if any genuine frame, the log's hash or the score differs, or if memory grew.

Frames are random in identifier, length, flags and data, or genuine ones with up to three wrong bits. Left out is what a
receiver cannot tell from a genuine frame (it would be a forgery, not noise): a whole frame of a port that consists of a
single one, and a master frame whose check sequence is right.
"""

from __future__ import annotations

import argparse
import hashlib
import random
import resource
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.local import LocalBus
from railhil.bus.mvb import parse_master_frame
from railhil.judge.judging import judging_of
from railhil.judge.score import Score
from railhil.plant_sim.node import make_plant_node
from railhil.record.framelog import FrameLog, read_log
from railhil.record.session import make_session
from railhil.record.trace import trace_of
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.systems.ato.scenario.model import Scenario

#: Growth of the process between a quarter and the end of the fuzz that is not a leak: buffers, the allocator's arenas.
GROWTH_MAX_BYTES = 8 << 20
_FD_LENGTHS = (*range(9), 12, 16, 20, 24, 32, 48, 64)


class Noise:
    """Frames that nobody sent, reproducible by their seed."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        contract = system_named(scenario.system).contract
        self._draw = random.Random(seed)
        self._poll_id = contract.poll_id
        self._single = {port.address: port.data_bytes for port in contract.ports if port.single_frame}
        self._fd_single = {port.fd_id for port in contract.ports if port.single_frame}
        self._blocks = {port.address + block for port in contract.ports for block in range(port.blocks)}
        self._ids = [
            *(can_id for port in contract.ports for can_id in (*port.can_ids, port.fd_id)),
            contract.poll_id, contract.device_status_id,
        ]  # fmt: skip
        self._trailers = {port.can_ids[-1] for port in contract.ports if not port.single_frame}
        #: Genuine telegrams of several frames and genuine master frames, newest last, of which some bits are turned.
        self._genuine: list[list[Frame]] = []
        self._begun: list[Frame] = []

    def frames(self, count: int) -> Iterator[Frame]:
        """The next ones."""
        made = 0
        while made < count:
            several = self._damaged() if self._genuine and self._draw.random() < 0.1 else [self._any()]
            for frame in several[: count - made]:
                if not self._forged(frame):
                    made += 1
                    yield frame

    def _any(self) -> Frame:
        draw = self._draw
        flags = draw.choice((0, 0, 0, 0, REMOTE, ERROR, EXTENDED, EXTENDED | REMOTE, FD, FD | BRS))
        can_id = draw.choice(self._ids) if draw.random() < 0.6 else draw.getrandbits(29 if flags & EXTENDED else 11)
        length = draw.choice(_FD_LENGTHS) if flags & FD else draw.randrange(9)
        return Frame(can_id, bytes(length) if flags & REMOTE else draw.randbytes(length), flags)

    def _damaged(self) -> list[Frame]:
        """A telegram with one to three wrong bits in one of its blocks, all of which the check sequence finds."""
        telegram = list(self._draw.choice(self._genuine))
        place = self._draw.randrange(max(len(telegram) - 1, 1))
        can_id, data, flags = telegram[place]
        word = int.from_bytes(data)
        for bit in self._draw.sample(range(8 * len(data)), self._draw.randint(1, 3)):
            word ^= 1 << bit
        telegram[place] = Frame(can_id, word.to_bytes(len(data)), flags)
        return telegram

    def _forged(self, frame: Frame) -> bool:
        if frame.can_id == self._poll_id:
            return not frame.flags and parse_master_frame(frame.data) is not None
        if frame.flags & FD:
            return frame.can_id in self._fd_single
        return not frame.flags and len(frame.data) == 8 and frame.can_id in self._single

    def note(self, frame: Frame) -> None:
        """Take a genuine frame, of which :meth:`_damaged` may turn bits."""
        if frame.can_id == self._poll_id:
            self._genuine.append([frame])
        elif frame.can_id in self._blocks and frame.can_id not in self._single:
            self._begun.append(frame)
        elif frame.can_id in self._trailers:
            self._genuine.append([*self._begun, frame])
            self._begun = []
        del self._genuine[:-64]


class NoisyBus(LocalBus):
    """A bus in one process on which every node, the administrator too, gets noise before each tick."""

    def __init__(
        self, nodes: dict[str, Callable[[Frame], list[Frame]]], noise: Noise, clock_id: int, per_tick: int, total: int
    ) -> None:
        super().__init__(list(nodes.values()))
        self._named, self._noise, self._clock_id = nodes, noise, clock_id
        self._per_tick, self._total = per_tick, total
        self.sent = 0
        self.answered: list[str] = []
        self.memory_bytes: list[tuple[int, int]] = []
        self._digest = hashlib.sha256()

    def _deliver(self, frames: Sequence[Frame], sender: Callable[[Frame], list[Frame]] | None) -> None:
        for frame in frames:
            # Between two blocks of a telegram a foreign block would be a loss: noise comes before a tick's first frame.
            if frame.can_id == self._clock_id and self.sent < self._total:
                self._make_noise()
            self._digest.update(repr(frame).encode())
            self._noise.note(frame)
            super()._deliver([frame], sender)

    def _make_noise(self) -> None:
        for junk in self._noise.frames(min(self._per_tick, self._total - self.sent)):
            self.sent += 1
            for name, handle in self._named.items():
                if answers := handle(junk):
                    self.answered.append(f"{name} answered {junk} with {answers}")
            self._inbox.append(junk)
        if not self.memory_bytes or self.sent - self.memory_bytes[-1][0] >= self._total // 100:
            self.memory_bytes.append((self.sent, resident_bytes()))

    @property
    def genuine_sha256(self) -> str:
        """Hash of the genuine frames in their order."""
        return self._digest.hexdigest()


@dataclass
class Fuzzed:
    """One run with noise (or none): what must not depend on it, and what it did."""

    genuine_sha256: str
    score: Score
    frames: int
    answered: list[str]
    refused: dict[str, int]
    memory_bytes: list[tuple[int, int]] = field(default_factory=list)

    @property
    def growth_bytes(self) -> int:
        """Growth of the process after the first quarter of the noise."""
        early = [size for sent, size in self.memory_bytes if sent <= self.frames / 4]
        return self.memory_bytes[-1][1] - max(early) if early else 0


def resident_bytes() -> int:
    """Resident memory of this process."""
    return int(Path("/proc/self/statm").read_text("ascii").split()[1]) * resource.getpagesize()


def fuzzed_run(scenario: Scenario, frames: int, seed: int) -> Fuzzed:
    """One run in this process with ``frames`` frames of noise, spread over it; the whole record is scored."""
    system = system_named(scenario.system)
    spec = RunSpec(law=LawSpec(system.law))
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        log = FrameLog(Path(folder))
        session = make_session(scenario, log.write, spec)
        node = system.part("controller")(scenario, spec.law, None)
        ticks = round(scenario.plan.running_time_s * 1e9) // scenario.timing.base_tick_ns
        bus = NoisyBus(
            {"controller": node.handle, "supervisor": session.handle}, Noise(scenario, seed),
            system.contract.clock_port.address, -(-frames // ticks), frames,
        )  # fmt: skip
        plant = make_plant_node(scenario, spec, bus)
        plant.run()
        log.close()
        score = judging_of(scenario).score(scenario, trace_of(read_log(log.path), system.contract))
    refused: dict[str, int] = {}
    for counters in (plant.counters, plant.plant.refused, node.counters, session.counters):
        for cause, count in counters.items():
            refused[cause] = refused.get(cause, 0) + count
    return Fuzzed(bus.genuine_sha256, score, bus.sent, bus.answered, refused, bus.memory_bytes)


def differences(quiet: Fuzzed, fuzzed: Fuzzed) -> list[str]:
    """What noise has changed; empty: nothing."""
    found = list(fuzzed.answered[:3])
    if quiet.genuine_sha256 != fuzzed.genuine_sha256:
        found.append("the genuine frames differ")
    if quiet.score != fuzzed.score:
        found.append(f"the score differs: {quiet.score.verdict}, {fuzzed.score.verdict} {fuzzed.score.failures}")
    return found


def main(arguments: list[str] | None = None) -> int:
    """Exit code 0: nothing changed, and memory is flat."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.fuzz", description=__doc__)
    parser.add_argument("--frames", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenario", default="lvshun_tieshan")
    given = parser.parse_args(arguments)
    scenario = load(given.scenario)
    quiet = fuzzed_run(scenario, 0, given.seed)
    fuzzed = fuzzed_run(scenario, given.frames, given.seed)
    found = differences(quiet, fuzzed)
    if fuzzed.growth_bytes > GROWTH_MAX_BYTES:
        found.append(f"memory grew by {fuzzed.growth_bytes / 1e6:.1f} MB")
    print(f"{fuzzed.frames} frames of noise (seed {given.seed}) to each of three nodes, verdict {fuzzed.score.verdict}")
    for cause in sorted(fuzzed.refused, key=lambda name: -fuzzed.refused[name]):
        print(f"  {cause}: {fuzzed.refused[cause]} ({quiet.refused.get(cause, 0)} without noise)")
    print(f"memory: {fuzzed.growth_bytes / 1e6:+.2f} MB after the first quarter")
    for line in found:
        print(f"FAIL: {line}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
