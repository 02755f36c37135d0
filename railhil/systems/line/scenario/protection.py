"""Settings of the train protection (``[atp]``): defaults of its profiles, schema of the table, checks of the values.

Sources of the defaults of ``metro``: guaranteed rate within 0.6 to 1.1 m/s2 (Istanbul study, ELECO 2021), emergency
curve 1.0 to 1.3 m/s2 and service brake 0.8 to 1.0 m/s2 (cbtcbook.com); factors, times and overlaps are chosen. The
fixed times of ``subset026`` are those of a public program that cites SUBSET-026-3, A.3.1. No conformity is claimed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import cycle, pairwise
from math import ceil, inf
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from railhil.common.errors import Finding, short_number
from railhil.scenarios.profiles import Profile
from railhil.scenarios.schema import NotNegative, Pairs, Positive, Table
from railhil.scenarios.validation import Refuse
from railhil.systems.ato.scenario.model import Balise, Train
from railhil.systems.line.braking.brake import BrakeModel, constant
from railhil.systems.line.braking.limits import INCREMENTS, Increments

ProfileName = Literal["metro", "subset026"]

_KMH = 3.6
_ROUNDING_S = 1e-9
#: Numbers of the protection's own balises.
_OWN_NUMBERS = range(201, 256)
#: Least distance between them (chosen): as between the balises of a shipped line.
_LEAST_SPACING_M = 10.0
_EMERGENCY_MPS2, _K_DRY, _K_WET, _SERVICE_MPS2 = map(constant, (1.2, 0.85, 0.9, 0.9))


@dataclass(frozen=True, slots=True)
class Protection:
    """Train protection of a run; the defaults are those of the profile ``metro``.

    Brakes and factors are step functions ``(from_mps, value)``, each value valid from its speed on.

    :ivar t_be_s: equivalent dead time of the emergency brake: at least its dead time plus its lag.
    :ivar balise_spacing_m: the protection has balises of its own where those of the line lie further apart; 0: none.
    :ivar rotating_percent: rotating masses, in percent; None: not known.
    :ivar heed_atp: the controller takes traction off before it would reach the permitted speed.
    """

    enabled: bool = True
    profile: ProfileName = "metro"
    emergency_mps2: Profile = _EMERGENCY_MPS2
    k_dry: Profile = _K_DRY
    k_wet: Profile = _K_WET
    m_avadh: float = 0.0
    #: None: adhesion does not limit it.
    a_max_reduced_mps2: float | None = None
    service_mps2: Profile = _SERVICE_MPS2
    t_be_s: float = 1.2
    t_bs_s: float = 0.8
    t_cut_s: float = 0.7
    t_warning_s: float = 0.5
    t_driver_s: float = 1.0
    t_ind_min_s: float = 3.0
    eoa_overlap_m: float = 10.0
    svl_overlap_m: float = 30.0
    v_release_mps: float = 5 / _KMH
    d_trip_m: float = 2.0
    rotating_percent: float | None = 6.0
    increments: ProfileName = "metro"
    over_reading: float = 0.02
    under_reading: float = 0.02
    balise_accuracy_m: float = 0.5
    balise_spacing_m: float = 300.0
    ato_margin_m: float = 2.0
    ato_margin_mps: float = 1 / _KMH
    heed_atp: bool = False

    def brake_model(self, gravity_mps2: float) -> BrakeModel:
        """The brakes as the curves count on them; the traction is cut off at the warning."""
        most_mps2 = self.a_max_reduced_mps2
        return BrakeModel(
            emergency_mps2=self.emergency_mps2,
            service_mps2=self.service_mps2,
            k_dry=self.k_dry,
            k_wet=self.k_wet,
            m_avadh=self.m_avadh,
            a_max_reduced_mps2=inf if most_mps2 is None else most_mps2,
            t_be_s=self.t_be_s,
            t_bs1_s=self.t_bs_s,
            t_bs2_s=self.t_bs_s,
            t_cut_s=self.t_cut_s,
            t_warning_s=self.t_warning_s,
            t_driver_s=self.t_driver_s,
            t_ind_min_s=self.t_ind_min_s,
            rotating_percent=self.rotating_percent,
            gravity_mps2=gravity_mps2,
        )

    @property
    def increments_mps(self) -> Increments:
        """Speeds above a ceiling at which the reactions begin."""
        return INCREMENTS[self.increments]


_METRO = Protection()
#: Values that are not given, by profile.
PROFILES: Mapping[ProfileName, Protection] = {
    "metro": _METRO,
    "subset026": replace(
        _METRO,
        profile="subset026",
        t_be_s=3.0,
        t_bs_s=4.0,
        t_cut_s=8.0,
        t_warning_s=2.0,
        t_driver_s=4.0,
        t_ind_min_s=5.0,
        increments="subset026",
    ),
}

Seconds = Annotated[float, Field(ge=0, le=60)]
Share = Annotated[float, Field(gt=0, le=1)]
_Reading = Annotated[float, Field(ge=0, le=0.2)]


def _shape(value: Any) -> str:
    return "rows" if isinstance(value, list) else "value"


#: A number, or a step function ``[[from km/h, value], ...]``; the tags never appear in messages.
ATP_TAGS = ("value", "rows")
Steps = Annotated[Annotated[Positive, Tag("value")] | Annotated[Pairs, Tag("rows")], Discriminator(_shape)]
ShareSteps = Annotated[Annotated[Share, Tag("value")] | Annotated[Pairs, Tag("rows")], Discriminator(_shape)]


class AtpTable(Table):
    """Train protection; a key that is missing has the value of its profile."""

    enabled: bool = True
    profile: ProfileName = "metro"
    emergency_mps2: Steps | None = None
    k_dry: ShareSteps | None = None
    k_wet: ShareSteps | None = None
    m_avadh: Annotated[float, Field(ge=0, le=1)] | None = None
    a_max_reduced_mps2: Positive | None = None
    service_mps2: Steps | None = None
    t_be_s: Seconds | None = None
    t_bs_s: Seconds | None = None
    t_cut_s: Seconds | None = None
    t_warning_s: Seconds | None = None
    t_driver_s: Seconds | None = None
    t_ind_min_s: Seconds | None = None
    eoa_overlap_m: NotNegative | None = None
    svl_overlap_m: NotNegative | None = None
    v_release_kmh: NotNegative | None = None
    d_trip_m: NotNegative | None = None
    rotating_percent: Annotated[float, Field(ge=0, le=100)] | Literal["unknown"] | None = None
    increments: ProfileName | None = None
    over_reading: _Reading | None = None
    under_reading: _Reading | None = None
    balise_accuracy_m: Positive | None = None
    balise_spacing_m: NotNegative | None = None
    ato_margin_m: NotNegative | None = None
    ato_margin_kmh: NotNegative | None = None
    heed_atp: bool = False

    #: Key of the file -> field of :class:`Protection` in m/s.
    SPEEDS: ClassVar[Mapping[str, str]] = {"v_release_kmh": "v_release_mps", "ato_margin_kmh": "ato_margin_mps"}
    STEPS: ClassVar[tuple[str, ...]] = ("emergency_mps2", "k_dry", "k_wet", "service_mps2")


def protection_of(table: AtpTable, train: Train) -> Protection:
    """The settings of a table: what it does not give has the value of its profile, rotating masses that of the train.

    The values are those of the file; :func:`check_protection` refuses the ones that do not fit together.
    """
    rotating = (train.inertial_mass_kg / train.mass_kg - 1.0) * 100.0
    values: dict[str, Any] = {"rotating_percent": round(rotating, 9)}
    for key in table.model_fields_set:
        value = getattr(table, key)
        if value is None:
            continue
        if key in AtpTable.STEPS:
            value = constant(value) if isinstance(value, float) else tuple((kmh / _KMH, one) for kmh, one in value)
        elif key in AtpTable.SPEEDS:
            key, value = AtpTable.SPEEDS[key], value / _KMH
        elif value == "unknown":
            value = None
        values[key] = value
    return replace(PROFILES[table.profile], **values)


def check_protection(protection: Protection, refuse: Refuse) -> None:
    """Values that contradict each other.

    :raises InputError: with the key and what is allowed.
    """
    check_overlaps(protection.eoa_overlap_m, protection.svl_overlap_m, ("atp", "eoa_overlap_m"), refuse)
    if protection.heed_atp and not protection.enabled:
        raise refuse(("atp", "heed_atp"), Finding("true"), "false with enabled = false: no protection permits a speed")
    if 0.0 < protection.balise_spacing_m < _LEAST_SPACING_M:
        allowed = f"0 (none) or at least {_LEAST_SPACING_M:g}"
        raise refuse(("atp", "balise_spacing_m"), short_number(protection.balise_spacing_m), allowed)
    for key in AtpTable.STEPS:
        rows: Profile = getattr(protection, key)
        if rows[0][0] != 0.0:
            raise refuse(("atp", key, 0), [short_number(rows[0][0] * _KMH), rows[0][1]], "the first row from 0 km/h on")
        for row, (before, after) in enumerate(pairwise(rows), start=1):
            if after[0] <= before[0]:
                allowed = f"more than {before[0] * _KMH:g}: rows are in increasing order"
                raise refuse(("atp", key, row), short_number(after[0] * _KMH), allowed)
        most = 1.0 if key.startswith("k_") else inf
        for row, (_, value) in enumerate(rows):
            if not 0.0 < value <= most:
                raise refuse(("atp", key, row), short_number(value), f"above 0{', at most 1' if most == 1.0 else ''}")


def list_uncovered(protection: Protection, braking_mps2: float, delay_s: float) -> tuple[str, ...]:
    """A sentence if the train's emergency brake is not the one that the curves count on.

    :param delay_s: its dead time and its lag together.
    """
    k_wet = max(value for _, value in protection.k_wet)
    share = max(value for _, value in protection.k_dry) * (k_wet + protection.m_avadh * (1.0 - k_wet))
    counted_mps2 = share * max(value for _, value in protection.emergency_mps2)
    if not protection.enabled or (braking_mps2 >= counted_mps2 and delay_s <= protection.t_be_s + _ROUNDING_S):
        return ()
    return (
        f"train: its emergency brake, {braking_mps2:g} m/s2 after {delay_s:g} s, is weaker or later than the train "
        f"protection counts on, {counted_mps2:g} m/s2 after {protection.t_be_s:g} s: the protection does not cover it",
    )


def check_overlaps(eoa_overlap_m: float, svl_overlap_m: float, key: tuple[str | int, ...], refuse: Refuse) -> None:
    """The supervised location does not lie before the end of authority, of the whole run or of one stop.

    :param key: of the overlap of the end of authority.
    :raises InputError: it does.
    """
    if eoa_overlap_m > svl_overlap_m:
        raise refuse(key, short_number(eoa_overlap_m), f"at most svl_overlap_m = {svl_overlap_m:g}")


def protection_balises(spacing_m: float, balises: Iterable[Balise], from_m: float, to_m: float) -> tuple[Balise, ...]:
    """The protection's own balises between two places: none lies further than ``spacing_m`` from the one before.

    They lie exactly where they are surveyed. Numbers repeat; the interval of the position tells them apart.

    :param spacing_m: 0: none.
    :param balises: those of the line.
    """
    if spacing_m <= 0.0:
        return ()
    known_m = sorted({from_m, to_m, *(one.surveyed_m for one in balises if from_m <= one.surveyed_m <= to_m)})
    places_m = []
    for before_m, after_m in pairwise(known_m):
        parts = ceil((after_m - before_m) / spacing_m)
        places_m += [before_m + (after_m - before_m) * part / parts for part in range(1, parts)]
    numbers = cycle(_OWN_NUMBERS)
    return tuple(Balise(number, at_m, at_m) for number, at_m in zip(numbers, places_m, strict=False))
