"""One second of a run, told tick by tick, as a record for the rules that hold in every run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from railhil.bus.ident import PltIdent, Role, make_ident
from railhil.dbc import wire_contract
from railhil.record.trace import NodeCounters, Trace
from railhil.scenarios.load import load
from railhil.wire.ato import CtlMode, NotchCmd, SimTruth, TrnPos, TrnSpeed, TrnWatch

SCENARIO = load("lvshun_tieshan")
TICK_NS = 10_000_000


@dataclass
class Story:
    """One second of a run, tick by tick; each field gives a value for a tick."""

    train_level: Callable[[int], int] = lambda tick: 0
    controller_level: Callable[[int], int] = lambda tick: 0
    notch_256th: Callable[[int], int] = lambda tick: 256
    traction_20n: Callable[[int], int] = lambda tick: 0
    notch_actual_16th: Callable[[int], int] = lambda tick: 0
    position_life: Callable[[int], int] = lambda tick: tick // 2 & 15
    speed_01mmps: Callable[[int], int] = lambda tick: 100_000
    check: Callable[[int], int] = lambda tick: 1
    without: set[int] = field(default_factory=set)
    watch_lost: set[int] = field(default_factory=set)
    speed_lost: set[int] = field(default_factory=set)
    truth_lost: set[int] = field(default_factory=set)
    #: As ``without``, for the speed alone; the time goes on.
    speed_unseen: set[int] = field(default_factory=set)
    #: Whether the record is known to have every frame.
    whole: bool = True
    pace: str = "lockstep"
    #: Ticks whose report the record has behind the command of the tick.
    report_late: set[int] = field(default_factory=set)
    #: Ticks whose command the record has only with the next one, behind the speeds until then.
    command_late: set[int] = field(default_factory=set)
    #: Number of the first TRN_SPEED in the record that a fault kept from the controller, and how many there are.
    unheard: tuple[int, int] | None = None

    def trace(self) -> Trace:
        made, told, life, now_ns = Trace(wire_contract()), -1, 0, 0
        if self.pace != "lockstep":
            made.add(
                PltIdent.PORT,
                0,
                make_ident(Role.PLANT, SCENARIO.sha256, pace=self.pace, contract=wire_contract()).encode(),
            )
        late: list[NotchCmd] = []
        for tick in range(100):
            # Without the port that opens the ticks, the record's clock stands still.
            now_ns = now_ns if tick in self.speed_lost or not self.check(tick) else tick * TICK_NS
            if tick not in self.without | self.speed_lost | self.speed_unseen:
                speed = TrnSpeed(self.speed_01mmps(tick), check=self.check(tick), life=tick & 15)
                made.add(TrnSpeed.PORT, now_ns, speed.encode())
            level = self.train_level(tick)
            reports = []
            if level != told or tick % 16 == 0:
                told, life = level, life + 1 & 15
                reports = [TrnWatch(level, life=life)] * (tick not in self.watch_lost)
            if tick not in self.report_late:
                for report in reports:
                    made.add(TrnWatch.PORT, now_ns, report.encode())
            if tick % 2 == 0:
                truth = SimTruth(0, self.speed_01mmps(tick), life=tick // 2 & 15, traction_20n=self.traction_20n(tick))
                if tick not in self.truth_lost:
                    made.add(SimTruth.PORT, now_ns, truth.encode())
                position = TrnPos(0, 0, self.notch_actual_16th(tick), life=self.position_life(tick))
                made.add(TrnPos.PORT, now_ns, position.encode())
                mode = int(CtlMode.RUNNING) + self.controller_level(tick)
                if tick not in self.without:
                    late.append(NotchCmd(self.notch_256th(tick), mode, life=tick // 2 & 15))
                if tick not in self.command_late:
                    for command in late:
                        made.add(NotchCmd.PORT, now_ns, command.encode())
                    late = []
            if tick in self.report_late:
                for report in reports:
                    made.add(TrnWatch.PORT, now_ns, report.encode())
        made.reported = NodeCounters(self.whole, self.counters(made.count(TrnSpeed.PORT)))
        return made

    def counters(self, speeds: int) -> dict[str, Any]:
        """What the controller reports of the TRN_SPEED in the record."""
        if self.unheard is None:
            return {}
        first, count = self.unheard
        gap = {"ports": {TrnSpeed.PORT: {"first": first, "count": count}}, "restarted": False}
        return {"controller": {"ports": {TrnSpeed.PORT: {"committed": speeds - count}}, "gaps": [gap], "frames": {}}}
