"""A short run, and both controllers, ours and the exported C, on it with any speeds."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Container, Sequence
from pathlib import Path

from hil_tests.support.foreign import CNode, without_telemetry
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.telegrams import TimeSync
from railhil.controller_node.ato.node import ControllerNode
from railhil.dbc import wire_contract
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario, TargetCurve, WatchLimits
from railhil.systems.ato.scenario.target import Target
from railhil.wire.ato import CtlStat, NotchCmd, TrkInfo, TrnSpeed

#: Off, coast, brake: short, because every frame passes two controllers.
_SHORT = TargetCurve(((0.0, 0.0), (1.0, 1.0), (7.0, 1.0), (8.0, 0.0), (11.0, 0.0), (12.0, -1.0)))


def short(name: str = "lvshun_tieshan") -> Scenario:
    """A short run with another train's limits, so that every constant of the header is its own."""
    whole = load(name)
    target = Target(_SHORT)
    plan = dataclasses.replace(whole.plan, distance_m=target.stop_position_m, running_time_s=target.stop_time_s)
    watch = WatchLimits(hold_ms=30, traction_cut_ms=70, service_brake_ms=200, emergency_ms=600, overspeed_margin_mps=1)
    return dataclasses.replace(whole, target=_SHORT, plan=plan, watch=watch)


def told(tick: int) -> TrkInfo | None:
    """TRK_INFO on its period."""
    return None if tick % 16 else TrkInfo(speed_limit_4mmps=60_000, life=tick // 16 % 4)


def driven(
    exported: Callable[[Scenario], Path],
    speeds: Sequence[int | None],
    unpolled: Container[int] = (),
    track: Callable[[int], TrkInfo | None] = told,
) -> tuple[list[int], bytes]:
    """Both controllers with one speed (0.1 mm/s; None: no telegram) in each tick and their two polls in every other.

    :param unpolled: ticks without polls.
    :param track: TRK_INFO of a tick.
    :returns: the level after each tick, and the second block of the last CTL_STAT.
    """
    scenario = short()
    node, c = ControllerNode(scenario, LawSpec()), CNode(exported(scenario), "ipfc")
    source, contract = TelegramSource(TrnSpeed.port()), wire_contract()
    polls = [master_frame(port.f_code, port.address) for port in map(contract.port, (NotchCmd.PORT, CtlStat.PORT))]
    levels, status = [], b""
    for tick, speed in enumerate(speeds):
        frames = [] if speed is None else source.frames(TrnSpeed(speed, life=tick & 0xF).encode())
        if tick == 0:
            frames += TelegramSource(TimeSync.port()).frames(TimeSync().encode())
        if (info := track(tick)) is not None:
            frames += TelegramSource(TrkInfo.port()).frames(info.encode())
        for frame in [*frames, *(polls if tick % 2 == 0 and tick not in unpolled else [])]:
            expected = node.handle(frame)
            assert without_telemetry(c.handle(frame)) == without_telemetry(expected), tick
            assert c.level == node.guard.level, tick
            status = expected[1].data if len(expected) == 3 else status
        levels.append(c.level)
    return levels, status
