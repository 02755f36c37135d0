"""What the faults of actuators and adhesion make of the forces of one tick, with numbers of no train."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from hil_tests.support.plant_faults import SCENARIO, fault
from railhil.faults.model import Fault
from railhil.plant_sim.ato import dynamics
from railhil.plant_sim.ato.dynamics import Motion, Window
from railhil.plant_sim.ato.faults.equipment import cap_limit, share_limit
from railhil.plant_sim.ato.faults.forces import Allowed, Demand, FaultyForces, FeltChecks
from railhil.plant_sim.ato.force_tables import train_constants
from railhil.plant_sim.faults.injections import Injections
from railhil.systems.ato.scenario.model import Effort
from railhil.wire.ato import WatchCause

TICK_NS, TICK_S = 100_000_000, 0.1
#: 1 t, 10 kN; a notch code is 1 N. Traction of 500 N, a brake of 800 N, of both half at 20 m/s.
TRAIN = replace(
    SCENARIO.train, mass_kg=1000.0, inertial_mass_kg=1100.0, gravity_mps2=10.0, force_per_notch_n=256.0,
    actuator_pole_per_s=2.0, traction=Effort(500.0, power_max_w=5000.0), brake=Effort(800.0, power_max_w=8000.0),
)  # fmt: skip
HEALTHY = train_constants(TRAIN)
FREE = Window(True, 0.0)
PULL, PUSH = "actuator.traction", "actuator.brake"


class Forces:
    """Forces under faults, tick by tick."""

    def __init__(self, *faults: Fault) -> None:
        self.injections = Injections(list(enumerate(faults, 1)), 0, TICK_NS)
        self.forces = FaultyForces(self.injections, TICK_S)
        self.tick = -1
        self.next()

    def next(self, motion: Motion = dynamics.AT_REST, force_n: float = 0.0) -> Motion:
        """The next tick begins: the motion from there on."""
        self.tick += 1
        self.injections.look(self.tick, 0.0, 0.0)
        return self.forces.change(TRAIN, motion, force_n)

    def allowed(
        self, code: int = 0, speed: float = 10.0, window: Window = FREE, powered: bool = True, emergency: bool = False
    ) -> Allowed:
        return self.forces.allowed(HEALTHY, window, Demand(code, speed, powered, emergency))

    def said(self) -> list[tuple[int, str, str]]:
        return [(hit.fault, hit.before, hit.after) for hit in self.injections.log.hits]


def weak(where: str, share: float, **more: Any) -> Fault:
    return fault(where, "weak", 0.0, {"share": share}, **more)


def test_without_faults_the_forces_are_those_of_the_train() -> None:
    found = Forces(fault(PULL, "off", 9.0))
    assert found.allowed(300) == Allowed(HEALTHY, FREE, 0.0)
    assert (found.forces.runaway_n, found.forces.demanded_n) == (0.0, 0.0)
    assert [found.forces.acting(code) for code in (-5, 0, 5)] == [-5, 0, 5]
    train, factors = found.forces.mover(5, 0.0)
    assert train is TRAIN
    assert factors == dynamics.lag(2.0, TICK_S)
    assert found.allowed(window=Window(False, 70.0)) == Allowed(HEALTHY, Window(False, 70.0), 0.0)
    assert found.forces.demanded_n == 70.0


def test_weak_sides_have_shares_of_their_limits() -> None:
    found = Forces(weak(PULL, 0.5), weak(PUSH, 0.25))
    window = Window(True, 100.0)
    wanted = HEALTHY._replace(traction=share_limit(HEALTHY.traction, 0.5), brake=share_limit(HEALTHY.brake, 0.25))
    # The service brake of the watch is weak, too; what it demanded is remembered.
    assert found.allowed(window=window) == Allowed(wanted, Window(True, 25.0), 0.0)
    assert found.forces.demanded_n == 100.0
    # The emergency brake does not depend on the actuators.
    assert found.allowed(window=window, emergency=True) == Allowed(HEALTHY, window, 0.0)
    for where in (PULL, PUSH):
        constants = Forces(weak(where, 0.5)).allowed().constants
        assert (constants.traction != HEALTHY.traction, constants.brake != HEALTHY.brake) == (
            where == PULL, where == PUSH,
        )  # fmt: skip
    assert Forces(weak(PULL, 0.5)).allowed(window=window).window == window


def test_strong_sides_have_more() -> None:
    for factor in (1.5, 1.01):
        pull, push = (fault(where, "scale", 0.0, {"factor": factor}) for where in (PULL, PUSH))
        assert Forces(pull).allowed().constants == HEALTHY._replace(traction=share_limit(HEALTHY.traction, factor))
        wanted = HEALTHY._replace(brake=share_limit(HEALTHY.brake, factor))
        assert Forces(push).allowed(window=Window(True, 100.0)) == Allowed(wanted, Window(True, 100.0 * factor), 0.0)


def test_before_the_first_tick_there_is_no_force() -> None:
    forces = FaultyForces(Injections([], 0, TICK_NS), TICK_S)
    assert (forces.runaway_n, forces.demanded_n) == (0.0, 0.0)
    forces.moved(dynamics.AT_REST, 0)
    assert forces.axle.slip_mps == 0.0


def test_small_forces_that_are_stuck() -> None:
    for where in (PULL, PUSH):
        assert Forces(fault(where, "stuck")).allowed().extra_n == 0.0
    found = Forces(fault(PULL, "stuck", 0.1))
    found.next(Motion(0.0, 10.0, 0.5, 0.0), 0.5)
    assert found.allowed().constants.resistance_a_n == HEALTHY.resistance_a_n - 0.5


def test_the_side_that_acts_moves_the_train() -> None:
    slow = fault(PUSH, "slow", 0.0, {"factor": 0.25})
    found = Forces(weak(PULL, 0.5), slow).forces
    pull = replace(TRAIN, force_per_notch_n=128.0), dynamics.lag(2.0, TICK_S)
    push = replace(TRAIN, actuator_pole_per_s=0.5), dynamics.lag(0.5, TICK_S)
    # Without a notch the side of the force that is left.
    for code, actuator_n, side in ((1, -9.0, pull), (-1, 9.0, push), (0, -1.0, push), (0, 0.0, pull), (0, 1.0, pull)):
        assert found.mover(code, actuator_n) == side


def test_a_force_that_is_present_follows_its_side_at_once() -> None:
    for actuator_n, faults, wanted_n in (
        (100.0, (weak(PULL, 0.5),), 50.0),
        (0.4, (weak(PULL, 0.5),), 0.2),
        (100.0, (weak(PUSH, 0.5),), 100.0),
        (-100.0, (weak(PUSH, 0.5),), -50.0),
        (-100.0, (weak(PULL, 0.5),), -100.0),
        (100.0, (fault(PULL, "full"),), 0.0),
        (100.0, (fault(PULL, "stuck"),), 0.0),
        (-100.0, (fault(PULL, "full"),), -100.0),
        (-100.0, (fault(PUSH, "stuck"),), 0.0),
        # Without force: of the brake.
        (0.0, (fault(PULL, "full"),), 0.0),
    ):
        waiting = tuple(replace(one, trigger=replace(one.trigger, value=0.1)) for one in faults)
        found = Forces(*waiting)
        motion = Motion(1.0, 2.0, actuator_n, 3.0)
        assert found.next(motion, actuator_n) == Motion(1.0, 2.0, wanted_n, 3.0)
    # Each side compares with its own share.
    found = Forces(weak(PULL, 0.5), replace(weak(PUSH, 0.5), trigger=fault(PUSH, "off", 0.1).trigger))
    assert found.next(Motion(0.0, 0.0, -100.0, 0.0), -100.0).actuator_n == -50.0
    # At its end the force is again what it was; from nothing it builds up anew.
    for share, before_n, after_n in ((0.5, 50.0, 100.0), (0.0, 50.0, 0.0)):
        found = Forces(weak(PULL, share, duration_s=0.1))
        assert found.next(Motion(0.0, 0.0, before_n, 0.0), 50.0).actuator_n == after_n


def test_traction_that_nobody_commands() -> None:
    found = Forces(fault(PULL, "full"))
    # All that it has at this speed; it is in the constants as a negative resistance.
    for speed, force_n in ((10.0, 500.0), (20.0, 250.0)):
        extra = found.allowed(speed=speed)
        assert extra.extra_n == found.forces.runaway_n == force_n
        assert extra.constants == HEALTHY._replace(
            traction=cap_limit(HEALTHY.traction, 0.0), resistance_a_n=HEALTHY.resistance_a_n - force_n
        )
    assert found.forces.acting(300) == 0
    assert found.said() == [(1, "0 N", "500 N")]
    # Without power, and at EMERGENCY, there is none.
    for given in ({"powered": False}, {"emergency": True}):
        none = found.allowed(**given)  # type: ignore[arg-type]
        assert (none.extra_n, found.forces.runaway_n) == (0.0, 0.0)
        assert none.constants == HEALTHY._replace(traction=cap_limit(HEALTHY.traction, 0.0))
    stuck = Forces(fault(PULL, "stuck", 0.1))
    stuck.next(Motion(0.0, 10.0, 120.0, 0.0), 120.0)
    assert stuck.allowed().extra_n == 120.0
    assert stuck.allowed(speed=50.0).extra_n == 100.0


def test_a_brake_that_drags() -> None:
    found = Forces(fault(PUSH, "full"))
    extra = found.allowed(speed=20.0)
    assert extra.extra_n == -400.0
    assert found.forces.runaway_n == 0.0
    assert extra.constants == HEALTHY._replace(
        brake=cap_limit(HEALTHY.brake, 0.0), resistance_a_n=HEALTHY.resistance_a_n + 400.0
    )
    # Without power as well, but not at EMERGENCY, where the whole brake acts.
    assert found.allowed(powered=False).extra_n == -800.0
    assert found.allowed(emergency=True) == Allowed(HEALTHY, FREE, 0.0)
    stuck = Forces(fault(PUSH, "stuck", 0.1))
    stuck.next(Motion(0.0, 10.0, -120.0, 0.0), -120.0)
    assert stuck.allowed().extra_n == -120.0
    both = Forces(fault(PULL, "full"), fault(PUSH, "full"))
    assert both.allowed().extra_n == -300.0
    # A weak side gives its share of all that it has.
    assert Forces(fault(PULL, "full"), weak(PULL, 0.5)).allowed().extra_n == 250.0
    assert Forces(fault(PUSH, "full"), weak(PUSH, 0.5)).allowed().extra_n == -400.0


def test_what_a_healthy_side_would_give_is_noted() -> None:
    for where, code, window, wanted in (
        (PULL, 300, FREE, "300 N"), (PULL, 300, Window(False, 0.0), None), (PULL, 300, Window(True, 1.0), None),
        (PULL, -300, FREE, None), (PUSH, -300, FREE, "300 N"), (PUSH, -300, Window(True, 350.0), "350 N"),
        (PUSH, 300, Window(True, 350.0), "350 N"), (PUSH, 300, FREE, None), (PUSH, -300, Window(False, 0.0), "300 N"),
    ):  # fmt: skip
        found = Forces(weak(where, 0.5))
        found.allowed(code, window=window)
        assert [row[1] for row in found.said()] == ([wanted] if wanted else [])
    # A side that cannot act has no effect.
    for where, code, given, counts in (
        (PULL, 300, {"powered": False}, False), (PULL, 300, {"emergency": True}, False),
        (PUSH, -300, {"powered": False}, True), (PUSH, -300, {"emergency": True}, False),
    ):  # fmt: skip
        found = Forces(weak(where, 0.5))
        found.allowed(code, **given)  # type: ignore[arg-type]
        assert bool(found.said()) == counts


def slippery(*faults: Fault, coefficient: float = 0.02) -> Forces:
    """A rail that carries a share of 10 kN."""
    return Forces(fault("train.adhesion", "low", 0.0, {"coefficient": coefficient}), *faults)


def test_a_rail_carries_so_much() -> None:
    found = slippery()
    assert found.allowed() == Allowed(
        HEALTHY._replace(traction=cap_limit(HEALTHY.traction, 200.0), brake=cap_limit(HEALTHY.brake, 200.0)), FREE, 0.0
    )
    # What nobody commands needs its share of it.
    found = slippery(fault(PULL, "stuck", 0.1))
    found.next(Motion(0.0, 10.0, 50.0, 0.0), 50.0)
    extra = found.allowed()
    assert extra.extra_n == 50.0
    assert extra.constants.brake == cap_limit(HEALTHY.brake, 250.0)
    assert extra.constants.resistance_a_n == HEALTHY.resistance_a_n - 50.0
    assert slippery(fault(PULL, "full")).allowed().extra_n == 200.0
    assert slippery(fault(PUSH, "full")).allowed().extra_n == -200.0
    drags = slippery(fault(PUSH, "stuck", 0.1))
    drags.next(Motion(0.0, 10.0, -50.0, 0.0), -50.0)
    assert drags.allowed().constants.traction == cap_limit(HEALTHY.traction, 250.0)
    # Of two the worse one.
    other = fault("train.adhesion", "low", 0.0, {"coefficient": 0.01})
    assert slippery(other).allowed().constants.brake.force_max_n == 100.0


def test_the_axle_slips_by_what_the_rail_does_not_carry() -> None:
    found = slippery()
    found.allowed(300)
    motion = Motion(0.0, 10.0, 250.0, 0.0)
    found.forces.moved(motion, 300)
    # 50 N on 100 kg for 0.1 s.
    assert found.forces.axle.slip_mps == pytest.approx(0.05)
    assert found.said() == [(1, "250 N", "200 N")]
    # Without slip and with enough adhesion there is nothing to compute.
    good = Forces(fault("train.adhesion", "low", 9.0, {"coefficient": 0.02}))
    good.forces.moved(motion, 300)
    assert (good.forces.axle.slip_mps, good.said()) == (0.0, [])
    # Exactly what the rail carries does nothing.
    edge = slippery()
    edge.allowed()
    edge.forces.moved(motion._replace(actuator_n=-200.0), 0)
    assert (edge.forces.axle.slip_mps, edge.said()) == (0.0, [])
    # The force that nobody commands counts, and the limits of the axle's own speed.
    pushed = slippery(fault(PULL, "full"))
    pushed.allowed(speed=10.0)
    pushed.forces.moved(motion._replace(actuator_n=0.0), 0)
    assert pushed.forces.axle.slip_mps == pytest.approx(0.3)
    slid = slippery()
    slid.allowed(-800)
    slid.forces.axle.slip_mps = -9.0
    slid.forces.moved(motion._replace(actuator_n=-800.0), -800)
    # At 1 m/s of the rim all of 800 N: 600 N more than the rail gives, down to a locked wheel.
    assert slid.forces.axle.slip_mps == pytest.approx(-9.6)
    fast = slippery()
    fast.allowed(800)
    fast.forces.axle.slip_mps = 15.0
    fast.forces.moved(motion._replace(actuator_n=500.0), 500)
    # At 25 m/s of the rim 200 N: as much as the rail carries.
    assert fast.forces.axle.slip_mps == pytest.approx(15.0)
    # A standing axle: 500 N, of which at walking pace little would be left.
    still = slippery()
    falling = replace(TRAIN, traction=Effort(500.0, curve=((0.0, 500.0), (1.0, 100.0))))
    still.forces.allowed(train_constants(falling), FREE, Demand(500, 0.0, True, False))
    still.forces.moved(motion._replace(speed_mps=0.0, actuator_n=500.0), 500)
    assert still.forces.axle.slip_mps == pytest.approx(0.3)
    # When the adhesion is good again it rolls at once.
    back = slippery()
    back.injections.activities[0].order(False, 0)
    back.next()
    back.forces.axle.slip_mps = 1.0
    assert back.allowed() == Allowed(HEALTHY, FREE, 0.0)
    back.forces.moved(motion, 0)
    assert back.forces.axle.slip_mps == 0.0


@pytest.mark.parametrize("demand_n", [-800.0, -150.0, 0.0, 150.0, 500.0])
@pytest.mark.parametrize("slip_mps", [-7.7, 3.0])
def test_friction_acts_against_the_slip_whatever_is_demanded(demand_n: float, slip_mps: float) -> None:
    """A locked wheel brakes the train until it rolls again, also while traction already turns it."""
    found = slippery()
    found.forces.axle.slip_mps = slip_mps
    for window in (FREE, Window(False, 300.0)):
        allowed = found.allowed(round(demand_n), window=window)
        motion = Motion(0.0, 10.0, demand_n, 0.0)
        force_n = dynamics.applied_n(allowed.constants, allowed.window, motion) + allowed.extra_n
        assert force_n == (200.0 if slip_mps > 0 else -200.0)
        running_n = HEALTHY.resistance_a_n - allowed.constants.resistance_a_n
        assert running_n == force_n


def test_notches_are_remembered_for_a_dead_time() -> None:
    late = {"delay_s": 0.1}
    found = Forces(fault(PULL, "dead_time", 0.0, late), fault(PUSH, "dead_time", 0.0, late))
    acted = []
    for code in (5, -6, 7):
        found.forces.moved(dynamics.AT_REST, code)
        acted.append(found.forces.acting(code))
    assert acted == [0, 5, -6]


def test_the_train_s_own_checks_see_the_drive_as_it_is() -> None:
    scenario = replace(SCENARIO, train=TRAIN)

    def causes(runaway_n: float, actuator_n: float, demanded_n: float = 0.0, floor_n: float = 0.0) -> set[WatchCause]:
        found = Forces()
        checks = FeltChecks(scenario, HEALTHY, found.forces)
        causes = set()
        for look in range(60):
            found.forces.runaway_n = runaway_n if look else 0.0
            found.forces.demanded_n = demanded_n
            felt = actuator_n if look else min(actuator_n, 0.0)
            causes.add(checks.finding(look * 5, 0, Motion(0.0, 10.0, felt, 0.0), floor_n))
        return causes - {WatchCause.NONE}

    assert causes(0.0, 0.0) == set()
    assert causes(400.0, 0.0) == {WatchCause.RUNAWAY}
    # Braking of the actuator does not hide it.
    assert causes(400.0, -400.0) == {WatchCause.RUNAWAY}
    assert causes(0.0, 0.0, demanded_n=1100.0) == causes(0.0, 0.0, floor_n=1100.0) == {WatchCause.BRAKE_NOT_ANSWERING}
