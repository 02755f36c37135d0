"""Compares the step of IPFC with a step of do-mpc, a general tool for model predictive control, on one tracking
problem."""

from __future__ import annotations

import time
import warnings
from typing import Any

import numpy as np
from casadi import DM

from benchmarks.figures import Figure, MeasurementError, Setting, median, p99
from railhil.bench import Result, coupled_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.ipfc_constants import IpfcParameters, internal_model
from railhil.controller_node.ato.pfc_model import polynomial_fit
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario

with warnings.catch_warnings():
    # It prints a line for every optional part that is not installed.
    warnings.simplefilter("ignore")
    import do_mpc

TITLE = "predictive control: step against do-mpc"
METHOD = (
    "Both drive the nominal train through the whole run, every step timed by itself on the wall clock. do-mpc solves "
    "with IPOPT (its default) at every step: eq. (2) sampled at the control period, horizon of ten periods, set-points "
    "ahead, sum of squared speed errors plus a small weight on the change of notch, notch range as bounds, "
    "the model error extrapolated as IPFC does it. IPFC has the same model, horizon and set-points, and its gains made "
    "beforehand. "
    "Ratios of step times are do-mpc over IPFC. The scores of one run stand beside it: a law, not a tuned rival."
)
#: Weight of a squared change of notch relative to a squared km/h: enough to make the optimum unique.
_CHANGE_WEIGHT = 1e-2
_CODES_PER_NOTCH = 256


class _DoMpc:
    """Model predictive control of the train's speed with do-mpc; a step takes km/h and returns notches."""

    def __init__(self, scenario: Scenario) -> None:
        period_s = scenario.timing.control_period_ns / 1e9
        self._own = internal_model(IpfcParameters(), period_s)
        self._state = np.zeros(2)
        self._sent = 0.0
        self._ahead = np.zeros(IpfcParameters().horizon + 1)
        own = IpfcParameters()
        self._fit = polynomial_fit(range(1 - own.error_window, 0), own.error_order)
        self._past = np.zeros(own.error_window)
        #: Model error now and in the future periods.
        self._errors = np.zeros_like(self._ahead)
        with warnings.catch_warnings():
            # do-mpc calls numpy on symbols, about which casadi warns.
            warnings.simplefilter("ignore", FutureWarning)
            self._mpc = self._made(period_s, scenario.train.notch_max)

    def _made(self, period_s: float, notch_max: float) -> Any:
        model = do_mpc.model.Model("discrete")
        state = model.set_variable("_x", "state", shape=(2, 1))
        notch = model.set_variable("_u", "notch")
        target = model.set_variable("_tvp", "target")
        error = model.set_variable("_tvp", "error")
        model.set_rhs("state", DM(self._own.a) @ state + DM(self._own.b) * notch)
        model.setup()
        mpc = do_mpc.controller.MPC(model)
        mpc.settings.n_horizon = len(self._ahead) - 1
        mpc.settings.t_step = period_s
        mpc.settings.store_full_solution = False
        mpc.settings.supress_ipopt_output()
        miss = (state[0] + error - target) ** 2
        mpc.set_objective(mterm=miss, lterm=miss)
        mpc.set_rterm(notch=_CHANGE_WEIGHT)
        mpc.bounds["lower", "_u", "notch"] = -notch_max
        mpc.bounds["upper", "_u", "notch"] = notch_max
        template = mpc.get_tvp_template()

        def known(_: float) -> Any:
            for i, target_kmh in enumerate(self._ahead):
                template["_tvp", i, "target"] = target_kmh
                template["_tvp", i, "error"] = self._errors[i]
            return template

        mpc.set_tvp_fun(known)
        mpc.setup()
        mpc.x0 = self._state.reshape(-1, 1)
        mpc.set_initial_guess()
        return mpc

    def step(self, speed_kmh: float, ahead_kmh: list[float]) -> float:
        """One control period; set-points from now on."""
        self._state = self._own.a @ self._state + self._own.b * self._sent
        self._past = np.append(self._past[1:], speed_kmh - self._state[0])
        periods = np.arange(len(self._ahead))
        slopes = self._fit @ (self._past[:-1] - self._past[-1])
        self._errors = self._past[-1] + sum(slope * periods**n for n, slope in enumerate(slopes, start=1))
        self._ahead = np.array(ahead_kmh)
        self._sent = round(float(self._mpc.make_step(self._state.reshape(-1, 1))[0, 0]) * _CODES_PER_NOTCH)
        self._sent /= _CODES_PER_NOTCH
        return self._sent


def _driven(scenario: Scenario, peer: bool) -> tuple[Result, list[float]]:
    """A complete run, and the time of each step in us."""
    number = make("float64")
    loop: ControlLoop[float] = ControlLoop(scenario, LawSpec(), number)
    mpc = _DoMpc(scenario) if peer else None
    taken_us: list[float] = []

    def law(k: int, speed_01mmps: int, position_01mm: int, *_: object) -> int:
        if mpc is None:
            start_ns = time.perf_counter_ns()
            notch = loop.step(k, speed_01mmps, position_01mm)[1].notch
        else:
            given = loop.inputs(k, speed_01mmps, position_01mm)
            start_ns = time.perf_counter_ns()
            notch = mpc.step(given.speed, [given.set_point, *given.preview])
        taken_us.append((time.perf_counter_ns() - start_ns) / 1000)
        return round(notch * _CODES_PER_NOTCH)

    return coupled_run(scenario, law), taken_us


def measure(setting: Setting) -> list[Figure]:
    """Step times and the scores of each run.

    :raises MeasurementError: a run did not stop.
    """
    figures: list[Figure] = []
    ours_us = 0.0
    for name, peer in (("ipfc", False), ("do-mpc", True)):
        run, taken_us = _driven(setting.scenario, peer)
        found = run.score
        if not setting.quick and found.values["stop_error_m"] is None:
            raise MeasurementError(f"{name} did not stop the train")
        typical = median(taken_us)
        ours_us = ours_us or typical
        ratio = (typical / ours_us, "do-mpc to ipfc") if peer else (None, "")
        figures += [
            Figure(f"{name}: step, median", typical, "us", *ratio),
            Figure(f"{name}: step, p99", p99(taken_us), "us"),
            Figure(f"{name}: ITAE of the nominal run", found.values["itae"] or 0.0, "km/h s2"),
            Figure(f"{name}: comfort of the nominal run", found.values["comfort"] or 0.0, "m/s2/km"),
            Figure(f"{name}: stop error of the nominal run", found.values["stop_error_m"] or 0.0, "m"),
        ]
    return figures
