"""All faults of a run at the plant: those of the frames that it sends, and those inside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.bus.layout import Telegram
from railhil.plant_sim.any_plant import FaultTooLarge
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

    def limited(self, publish: Callable[[Telegram], None], truth: str) -> Callable[[Telegram], None]:
        """``publish`` for a plant whose values faults may drive beyond their signals: such a value is sent as the end
        of its range, and the telegram's check variables are erroneous.

        :param truth: the port that is never changed: its value raises
            :class:`~railhil.plant_sim.any_plant.FaultTooLarge`.
        """
        if self.inside is None:
            return publish
        activities = self.inside.activities

        def publish_limited(telegram: Telegram) -> None:
            try:
                publish(telegram)
            except OverflowError as misfit:
                from railhil.faults.language import fault_text

                begun = [fault_text(one.fault, judging=False) for one in activities if one.begun_ns is not None]
                if not begun:
                    raise
                if truth == telegram.PORT:
                    _, signal, raw = next(telegram.misfits())
                    low, high = (f"{end * signal.scale:g}" for end in signal.raw_range)
                    found = (
                        f"{truth}.{signal.name}: found {raw * signal.scale:g} {signal.unit}, allowed {low} to {high}"
                    )
                    raise FaultTooLarge(f"{'; '.join(begun)}: {FaultTooLarge.SAID}: {found}") from misfit
                telegram.limit()
                publish(telegram)

        return publish_limited

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
