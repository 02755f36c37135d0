"""Misprints, gaps and choices of the papers with one and with three power units, and the options of the laws."""

from __future__ import annotations

from collections.abc import Sequence

from railhil.report.deviations import Deviation

#: Where, how this bench reads it, and the other reading with the parameter that selects it.
_READINGS = (
    (
        "Sampling period (not printed)",
        "1 s: a horizon of 3 samples must end after the transport delay",
        "`sample_period_s`; a horizon that ends before the command acts is refused unless `override`",
    ),
    (
        "Eqs. (14), (19), identification error",
        "e = v - v_hat",
        '`ident_error = "reference"`: w - v_hat, as the paper with three units prints it: the tracking error, which '
        "drives the parameters away",
    ),
    (
        "Eqs. (12) to (19), regressors of the projection",
        '`ident = "off"`: the parameters of the model are kept',
        '`ident = "paper"`: regressors of whole speeds, so that A(1) leaves 0 and B hardly learns; `ident = '
        '"differenced"`: differences of speeds, so that A(1) stays 0',
    ),
    ("Eq. (14), dead zone", "an error of at most 2 Delta identifies nothing; Delta is a speed", "`dead_zone_mps`"),
    (
        "Eqs. (6) to (8), discretisation",
        "zero-order hold, as the text says; it gives eq. (8) with its three coefficients",
        '`discretisation = "bilinear"`: the printed transform has four coefficients, of which the first is dropped; '
        "eq. (7) has lambda for lambda (1 + q) and lost a factor 2/T0",
    ),
    ("Eq. (4), lambda of the delay", "2/T; the same letter is the weight of the command in eq. (21)", ""),
    (
        "Eqs. (24), (27), (30), weighting polynomials",
        "those that satisfy eq. (30) exactly, also with a weight of the command",
        '`weighting = "unit"`: M_j = E_j(1), r_j = 1, which satisfy eq. (30) only without it',
    ),
    (
        "Matrix G, commands after the control horizon",
        "zero, as the printed Toeplitz matrix says",
        '`after_control_horizon = "held"`',
    ),
    (
        "Reference vector (three units, eq. (17))",
        "from w(k+1) on",
        '`reference_start = "now"`: from w(k) on, as printed, with one row too many',
    ),
    ("Eqs. (26), (27), index of xi", "xi(k-1); eq. (27) has xi(k), which needs the command that it computes", ""),
    ("Comparators", "citations are off by one; [3], [24] are taken as multi-model GPC, [25] as A-GPC", ""),
    (
        "One model or two",
        "one model, with the traction delay",
        "`model_delay_s`, `model_lag_s`: those of another",
    ),
    ("Delay at the change of mode", "traction and braking commands travel in delays of their own and add", ""),
    (
        "Mutation",
        "windows in which the train's gain and lag change and return: faults of the scenario",
        "any other as `--fault`; the papers do not say what changes, when and by how much",
    ),
    (
        "Training data (not described)",
        "the record of a run with a dithered PID",
        "without dither the network explains the record better and controls worse",
    ),
    (
        "Output weights of the ELM, eq. (16)",
        "least squares with a ridge",
        "`railhil train-model --pinv`: the pseudo-inverse, as printed",
    ),
    (
        "Emergency braking",
        "a profile that the speed controller follows, without preview of it before the trigger",
        "in practice an emergency brake bypasses the speed controller",
    ),
    ("Standstill", "not scored below a target of 0.5 m/s: the holding brake acts", ""),
)


def readings() -> Sequence[Deviation]:
    """All of them, in the order of the papers."""
    return [Deviation(*row) for row in _READINGS]
