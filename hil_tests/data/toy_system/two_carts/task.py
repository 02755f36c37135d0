"""The keys of a scenario of two carts."""

from typing import Annotated, ClassVar

from pydantic import Field, Strict

from railhil.scenarios.task import Task

Number = Annotated[float, Field(ge=-1000, le=1000)]
Mass = Annotated[float, Field(gt=0, le=1000)]
Two = Annotated[tuple[Number, Number], Strict(False)]
Masses = Annotated[tuple[Mass, Mass], Strict(False)]


class CartsTask(Task):
    """The section ``[task]``: two carts start from rest at 0, and each moves to its own target."""

    JUDGING: ClassVar[tuple[str, ...]] = ("error_max_m",)

    mass_kg: Masses
    spring_n_per_m: Annotated[float, Field(ge=0, le=1000)]
    damping_n_per_mps: Annotated[float, Field(ge=0, le=1000)] = 0.0
    target_m: Two
    noise_sigma_m: Annotated[float, Field(ge=0, le=1)] = 0.0
    mass_spread: Annotated[float, Field(ge=0, lt=1)] = 0.0
    error_max_m: Annotated[float, Field(gt=0, le=10)]

    @property
    def can_be_perturbed(self) -> bool:
        """In a perturbed run both masses are drawn, each changed by at most this share."""
        return self.mass_spread > 0
