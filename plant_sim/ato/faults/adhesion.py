"""Low adhesion: the force that the rail can carry, and an axle that slips or slides when more is demanded.

The train is one equivalent axle that carries the whole weight ``m g``, is driven and braked, and is the one whose
speed is measured. With the coefficient of adhesion ``mu``, the force ``F`` demanded of the axle, its speed ``w`` at the
wheel's rim, the train's speed ``v``, and the rotating mass ``J`` (inertial mass minus mass)::

    force on the train   = F                                 |F| <= mu m g, and w = v
                         = mu m g sign(w - v)                otherwise
    J d(w - v)/dt        = F - mu m g sign(w - v)            w >= 0: a locked wheel stands

``sign(w - v)`` is that of ``F`` when a slide begins, and the axle rolls again when ``w`` reaches ``v``. This is
Coulomb's friction and Newton's law for the rotating mass, a model of our own: no creep curve, no slip or slide
protection, one coefficient whatever the speed. The train's acceleration keeps the full inertial mass while the axle
slips. When the adhesion is good again, the axle rolls at once.
"""

from __future__ import annotations

from math import copysign

#: Rotating mass as a share of the mass, for a train whose data has less.
_ROTATING_MIN = 0.01


class AxleSlip:
    """The difference between the axle and the train: ``slip_mps`` = w - v, ``slip_m`` its integral over time."""

    def __init__(self) -> None:
        self.slip_mps = 0.0
        self.slip_m = 0.0

    def step(
        self, demand_n: float, carried_n: float, speed_mps: float, mass_kg: float, inertial_kg: float, step_s: float
    ) -> None:
        """One step of the axle.

        :param demand_n: force demanded of the axle, traction positive.
        :param carried_n: largest force that the rail carries; infinite: good adhesion.
        :param speed_mps: of the train.
        """
        before = self.slip_mps
        if before == 0.0 and abs(demand_n) <= carried_n:
            return
        if carried_n == float("inf"):
            self.slip_mps = 0.0
            return
        rotating_kg = max(inertial_kg - mass_kg, _ROTATING_MIN * mass_kg)
        rate_mps2 = (demand_n - copysign(carried_n, before or demand_n)) / rotating_kg
        after = max(before + rate_mps2 * step_s, -speed_mps)
        if before * after < 0.0:
            after = 0.0
        self.slip_mps = after
        self.slip_m += (before + after) / 2 * step_s
