"""Gaps of the paper, and how the bench reads them."""

from __future__ import annotations

from collections.abc import Sequence

from railhil.report.deviations import Deviation

#: Where, how this bench reads it, and the other reading with the parameter that selects it.
_READINGS = (
    (
        "Table 1, delay, lag, braking, speed (lost)",
        "chosen: model 0.6 s and 0.4 s, train 0.64 s and 0.42 s with gain 0.985, 0.8 m/s2 from 60 km/h",
        "any other as key of the scenario",
    ),
    (
        "Iteration (not defined)",
        "a run into the station: figure 6, and the title",
        "iterations of the equation for the stopping time, or control cycles of one approach",
    ),
    (
        "Learning (the update is not printed)",
        "P-type on the place where the brake begins: b + clip(gamma e, 8 m), within 12 m, gamma 0.5",
        '`gamma`; 0 is the rule max(1/j, 0.3). `learning = "rls_load"`: delay, gain and load by least squares',
    ),
    (
        "Eq. (7), |s - f| <= eps",
        "one-sided: the brake begins in the first cycle with a margin of at most eps",
        '`trigger = "window"`, as printed: the window can be jumped over; `"window_or_late"`: with a fallback',
    ),
    (
        "Brake command",
        "begins with a control cycle",
        "`start_inside_cycle`: at the instant at which the margin is eps",
    ),
    (
        "Sampling rate (not printed)",
        "312.5 Hz, five samples in 16 ms: three levels then keep 0 to 19.5 Hz, the 0 to 20 Hz of the text",
        "",
    ),
    (
        "Wavelet packet, use while driving (not printed)",
        "the last 128 samples, read 63 behind, extended symmetrically",
        '`filter = "packet_8"`, `"packet_newest"`, `"packet_antireflect"`',
    ),
    ("Noise (not printed)", "white, 10 mm/s a sample: both errors of table 3 then come near the printed ones", ""),
    ("Number of runs (not printed)", "one sequence for each curve and figure", ""),
)


def readings() -> Sequence[Deviation]:
    """All of them."""
    return [Deviation(*row) for row in _READINGS]
