"""Dense sweeps of the safety gate against independently written models.

Each ``sweep_*`` takes the module under test, so that the mutation test can run the same checks on changed source.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any

from hil_tests.support.guard_sweeps import GUARD_SWEEPS
from railhil.controller_node.ato import guard
from railhil.plant_sim.ato import gate
from railhil.scenarios.load import load
from railhil.wire.ato import NotchCmd, WatchCause

SCENARIO = load("lvshun_tieshan")
MS = 1_000_000


def sweep_gate(module: ModuleType) -> None:
    """Every life sign, check variable and boundary of the notch after every accepted life sign."""
    for maximum in (0, 1792):
        notches = [*range(-maximum - 3, -maximum + 4), -1, 0, 1, *range(maximum - 3, maximum + 4), 32767, -32768]
        for check in range(4):
            for notch in notches:
                for step in range(-1, 16):
                    fresh_gate = module.CommandGate(maximum, 65536, 6)
                    if step >= 0:
                        assert fresh_gate.accept(NotchCmd(0, life=9))
                    before = int(step >= 0)
                    wrong = [
                        cause
                        for cause, holds in (
                            ("duplicate", step == 0),
                            ("out_of_order", step > 7),
                            ("check_variable", check != 1),
                            ("out_of_range", not -maximum <= notch <= maximum),
                        )
                        if holds
                    ]
                    life = (9 + max(step, 0)) % 16
                    assert fresh_gate.accept(NotchCmd(notch, check=check, life=life)) == (not wrong)
                    expected = {"accepted": before} if before else {}
                    if wrong:
                        expected[wrong[0]] = 1
                    else:
                        expected["accepted"] = before + 1
                        if 2 <= step <= 7:
                            expected["gap"] = 1
                    assert fresh_gate.counters == expected
                    ranged = wrong[:1] == ["out_of_range"]
                    assert fresh_gate.suspicion is (WatchCause.NOTCH_RANGE if ranged else WatchCause.NONE)
                    assert fresh_gate.notch_256th == (0 if wrong else notch)
                    # Refused telegrams are not remembered, accepted ones are.
                    again = fresh_gate.accept(NotchCmd(0, life=life))
                    assert again == (bool(wrong) and (step == -1 or 1 <= step <= 7))
    _sweep_steps(module)
    _sweep_order(module)
    _sweep_counts(module)
    _sweep_bad(module)
    assert [module.CommandGate.emergency(NotchCmd(emergency=code)) for code in range(4)] == [True, False, True, True]


def _sweep_counts(module: ModuleType) -> None:
    """Each cause counts on: three commands of one kind after a good one."""
    commands = {
        "duplicate": [NotchCmd(0, life=9)] * 3,
        "out_of_order": [NotchCmd(0, life=8)] * 3,
        "check_variable": [NotchCmd(0, check=0, life=10)] * 3,
        "out_of_range": [NotchCmd(1793, life=10)] * 3,
        "gap": [NotchCmd(0, life=life) for life in (11, 13, 15)],
        "notch_step": [NotchCmd(notch, life=life) for notch, life in ((1000, 10), (0, 11), (1000, 12))],
    }
    for cause, given in commands.items():
        subject = module.CommandGate(1792, 500, 6)
        for command in (NotchCmd(0, life=9), *given):
            subject.accept(command)
        accepted = 4 if cause in ("gap", "notch_step") else 1
        assert subject.counters == {"accepted": accepted, cause: 3}, cause


def _sweep_steps(module: ModuleType) -> None:
    """Every step around the largest, from either side: never more traction than before, braking followed."""
    for before in (-500, 0, 500):
        for step in (-101, -100, -1, 0, 1, 100, 101):
            subject = module.CommandGate(1792, 100, 6)
            for life, notch in enumerate(range(0, before + (before > 0) - (before < 0), before // 5 or 1)):
                assert subject.accept(NotchCmd(notch, life=life))
            assert subject.notch_256th == before
            assert subject.accept(NotchCmd(before + step, life=life + 1))
            assert subject.suspicion is (WatchCause.NOTCH_STEP if abs(step) > 100 else WatchCause.NONE)
            assert subject.notch_256th == (before if step > 100 else before + step)
            assert subject.counters["notch_step"] == (abs(step) > 100)
            # The command after it is compared with what was given, and followed.
            assert subject.accept(NotchCmd(before + step, life=life + 2))
            assert subject.suspicion is WatchCause.NONE
            assert subject.notch_256th == before + step


def _sweep_order(module: ModuleType) -> None:
    """Good and old commands, in every order that matters: six in sixteen, each after a good one."""
    assert (module.ORDER, module.RECENT, module.BAD_FOR_SUSPICION) == (16, 10, 3)
    for most in (1, 5, 6):
        for goods in (1, 2, 3, 4):
            subject, life, olds = module.CommandGate(1792, 65536, most), 0, []
            for count in range(60):
                old = count % (goods + 1) == goods
                life += not old
                assert subject.accept(NotchCmd(0, life=(life - 3 * old) % 16)) == (not old)
                olds.append(old)
                found = old and sum(olds[-16:]) >= most
                assert subject.suspicion is (WatchCause.TWO_SOURCES if found else WatchCause.NONE), (most, goods, count)
    # Old ones in a row are no second sender, nor are repeated ones.
    for shift in (3, 0):
        subject = module.CommandGate(1792, 65536, 2)
        for life in range(5):
            subject.accept(NotchCmd(0, life=life + 5))
            assert not subject.accept(NotchCmd(0, life=life + 5 - shift)) or not shift
            for _ in range(30 if shift else 0):
                assert not subject.accept(NotchCmd(0, life=life + 5 - shift))
                assert subject.suspicion is WatchCause.NONE
            if not shift:
                assert subject.suspicion is WatchCause.NONE


def _sweep_bad(module: ModuleType) -> None:
    """Two bad ones, some good ones, a third: three in ten."""
    for gap in range(12):
        subject, life = module.CommandGate(1792, 65536, 6), 0
        for check in (1, 0, 3, *[1] * gap, 2):
            life += check == 1
            assert subject.suspicion is WatchCause.NONE
            assert subject.accept(NotchCmd(0, check=check, life=(life + (check != 1)) % 16)) == (check == 1)
        assert subject.suspicion is (WatchCause.BAD_COMMANDS if gap <= 7 else WatchCause.NONE), gap


SWEEPS: dict[ModuleType, tuple[Any, ...]] = {gate: (sweep_gate,), guard: GUARD_SWEEPS}
