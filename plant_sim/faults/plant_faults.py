"""All faults of a run at the plant: those of the frames that it sends, and those inside it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.scenarios.model import AnyScenario

if TYPE_CHECKING:
    from railhil.bus.injector.node_faults import NodeFaults
    from railhil.plant_sim.faults.injections import Injections


@dataclass(slots=True)
class PlantFaults:
    """Faults of a run at the plant.

    ``sent``: faults of the frames that it sends; ``inside``: faults inside it; None: none. ``folder``: the run folder,
    for the logs; None: none are written.
    """

    sent: NodeFaults | None
    inside: Injections | None
    folder: Path | None

    def order(self, number: int, order: int) -> None:
        """An order of the supervisor for a fault with this number."""
        if self.inside is not None:
            self.inside.order(number, order)

    def adopt(self, scenario: AnyScenario, seed: int, folder: Path | None) -> None:
        """Have the faults of another scenario from the next tick on.

        :param folder: the run folder of the run that has them.
        :raises InputError: a fault has begun that is not in both scenarios.
        """
        from railhil.plant_sim.faults.plants import faults_inside
        from railhil.scenarios.fault_list import make_injection

        assert self.sent is not None, "this run has no branches"
        self.folder = folder
        self.sent.adopt(make_injection(scenario, seed), folder)
        if self.inside is not None:
            self.inside.adopt(faults_inside(scenario, seed))

    def write_logs(self) -> None:
        """Write the logs of the faults into the run folder."""
        if self.sent is not None:
            self.sent.write()
        if self.inside is not None and self.inside.activities and self.folder is not None:
            from railhil.bus.injector.activities import INSIDE

            self.inside.log.write(self.folder, INSIDE, self.inside.activities)
