"""Names of the entries of the protocol and of their figures."""

from __future__ import annotations

from collections.abc import Mapping

#: Runs of a sequence, and where nothing is learned.
RUNS, FEW = 15, 3
#: Filters of table 3: that of the paper, none, and others.
PACKET, NONE = "packet", "none"
FILTERS = (NONE, PACKET, "packet_8", "packet_newest", "packet_antireflect", "mean16", "fir65", "iir", "kalman")
#: Learning gains; 0: the rule max(1/j, 0.3).
GAMMA, GAMMAS = 0.5, (0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 0.0)
#: Tolerances of table 2 (m), and the cycles of the controller (ms).
EPSILON_M, EPSILONS_M = 0.4, (0.2, 0.4, 0.6, 0.8)
CYCLES_MS = (16, 48)
#: Standard deviations of the brake's gain from run to run.
SCATTERS = (0.001, 0.005, 0.01, 0.02)
#: A tolerance with two sides, without a fallback.
WINDOW = "window-0.1"
#: Where memories are damaged.
MEMORY = "memory-faults"

#: The paper's law, and ours, on the train with scatter.
OPEN_FIXED, OPEN_LEARNED = "open-fixed", "open-learned"
REAIM, REAIM_BALISES, REAIM_OBSERVER = "reaim", "reaim-balises", "reaim-observer"
OURS_FIXED, OURS = "reaim-observer-balises", "reaim-learned"
NO_BALISES, LOSS_FIXED, LOSS, SLIDE = "reaim-no-balises-learned", "reaim-loss", "reaim-loss-learned", "reaim-slide"


def filter_key(name: str) -> str:
    """A filter, with the paper's gain and tolerance."""
    return f"filter-{name}"


#: The case of the paper's figure 6.
PAPER_CASE = filter_key(PACKET)


def gamma_key(gamma: float) -> str:
    """A learning gain."""
    return PAPER_CASE if gamma == GAMMA else f"gamma-{gamma:g}" if gamma else "gamma-rule"


def epsilon_key(epsilon_m: float, cycle_ms: int, *, learned: bool) -> str:
    """A tolerance of table 2."""
    if learned and epsilon_m == EPSILON_M and cycle_ms == CYCLES_MS[0]:
        return PAPER_CASE
    return f"eps-{'learned' if learned else 'fixed'}-{epsilon_m:g}-{cycle_ms}ms"


def scatter_key(sigma: float, filtered: str = PACKET) -> str:
    """A scatter of the brake's gain."""
    return f"scatter-{sigma:g}{'' if filtered == PACKET else f'-{filtered}'}"


#: Figures of some runs: title, unit, digits.
MEAN, RMS, P95, WITHIN_10, WITHIN_30 = "mean_error", "rms", "p95", "within_0.1", "within_0.3"
FIGURES: Mapping[str, tuple[str, str, int]] = {
    MEAN: ("mean error", "m", 3),
    RMS: ("rms", "m", 3),
    P95: ("95 % of the errors", "m", 3),
    WITHIN_10: ("within 0.1 m", "%", 0),
    WITHIN_30: ("within 0.3 m", "%", 0),
}
#: Runs until the first of three in a row within 0.3 m: median, and 90 % of the sequences.
CONVERGED, CONVERGED_P90 = "runs_median", "runs_p90"
#: Share of the runs that did not stop by themselves.
NOT_STOPPED = "not_stopped"


def of_run(figure: str, number: int) -> str:
    """A figure over all runs of one number."""
    return f"{figure}_of_run_{number}"


def of_last(figure: str) -> str:
    """A figure over the last third of the runs."""
    return f"{figure}_of_last"


def of_all(figure: str) -> str:
    """A figure over all runs."""
    return f"{figure}_of_all"


#: The same without the runs in which the wheels slid.
LAST_RMS_HELD = of_last("rms_without_slide")
