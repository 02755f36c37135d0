"""The keys of a scenario of the cart."""

from typing import Annotated, ClassVar

from pydantic import Field

from railhil.scenarios.task import Task


class CartTask(Task):
    """The section ``[task]``; ``duration_s`` is common to all tasks."""

    #: Keys that affect only the evaluation of a run, not its frames.
    JUDGING: ClassVar[tuple[str, ...]] = ("error_max_m",)

    mass_kg: Annotated[float, Field(gt=0, le=1000, description="mass of the cart")]
    friction_n_per_mps: Annotated[float, Field(ge=0, le=1000, description="friction, proportional to speed")] = 0.0
    target_m: Annotated[float, Field(ge=-40, le=40, description="position required at the end")]
    noise_sigma_m: Annotated[float, Field(ge=0, le=1, description="noise of the measured position")] = 0.0
    mass_spread: Annotated[float, Field(ge=0, lt=1, description="share by which --perturbed draws the mass")] = 0.0
    error_max_m: Annotated[float, Field(gt=0, le=10, description="limit of the end error: beyond it the run is FAIL")]

    @property
    def can_be_perturbed(self) -> bool:
        """Whether the seed of a perturbed run draws anything besides the noise."""
        return self.mass_spread > 0
