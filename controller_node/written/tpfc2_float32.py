"""Law tpfc2 in single precision. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from array import array

from railhil.controller_node.arithmetic.float32 import FLT_MAX, FLT_MIN
from railhil.controller_node.written.parts import Parts, Step, Values


def step(parts: Parts) -> Step:
    single = array("f", [0.0])
    (
        c_model_0_0,
        c_model_0_1,
        c_model_0_2,
        c_model_1_0,
        c_model_1_1,
        c_model_1_2,
        c_free_0_0,
        c_free_0_1,
        c_free_1_0,
        c_free_1_1,
        c_free_2_0,
        c_free_2_1,
        c_free_3_0,
        c_free_3_1,
        c_set_point_fit_0_0,
        c_set_point_fit_0_1,
        c_set_point_fit_0_2,
        c_set_point_fit_0_3,
        c_set_point_fit_0_4,
        c_set_point_fit_0_5,
        c_set_point_fit_0_6,
        c_set_point_fit_0_7,
        c_set_point_fit_0_8,
        c_set_point_fit_0_9,
        c_set_point_fit_1_0,
        c_set_point_fit_1_1,
        c_set_point_fit_1_2,
        c_set_point_fit_1_3,
        c_set_point_fit_1_4,
        c_set_point_fit_1_5,
        c_set_point_fit_1_6,
        c_set_point_fit_1_7,
        c_set_point_fit_1_8,
        c_set_point_fit_1_9,
        c_error_fit_0_0,
        c_error_fit_0_1,
        c_error_fit_0_2,
        c_error_fit_0_3,
        c_error_fit_0_4,
        c_error_fit_0_5,
        c_error_fit_0_6,
        c_error_fit_1_0,
        c_error_fit_1_1,
        c_error_fit_1_2,
        c_error_fit_1_3,
        c_error_fit_1_4,
        c_error_fit_1_5,
        c_error_fit_1_6,
        c_closed_0,
        c_point_powers_0_0,
        c_point_powers_0_1,
        c_closed_1,
        c_point_powers_1_0,
        c_point_powers_1_1,
        c_closed_2,
        c_point_powers_2_0,
        c_point_powers_2_1,
        c_closed_3,
        c_point_powers_3_0,
        c_point_powers_3_1,
        c_gains_wavelet_0,
        c_gains_wavelet_1,
        c_gains_wavelet_2,
        c_gains_wavelet_3,
        c_notch_max,
        c_minus_notch_max,
        c_basis_0,
        c_softening,
    ) = parts.constants
    quantise = parts.number.quantise

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_model_0,
            state_model_1,
            state_notch,
            _state_model_errors_0,
            state_model_errors_1,
            state_model_errors_2,
            state_model_errors_3,
            state_model_errors_4,
            state_model_errors_5,
            state_model_errors_6,
            state_model_errors_7,
        ) = state
        (
            in_speed,
            in_set_point,
            in_preview_0,
            in_preview_1,
            in_preview_2,
            in_preview_3,
            in_preview_4,
            in_preview_5,
            in_preview_6,
            in_preview_7,
            in_preview_8,
            in_preview_9,
        ) = given
        single[0] = c_model_0_0 * state_model_0
        model_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_0_1 * state_model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = model_0 + product
        model_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_0_2 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = model_0 + product
        model_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_1_0 * state_model_0
        model_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_1_1 * state_model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = model_1 + product
        model_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_1_2 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = model_1 + product
        model_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        y_m = model_0
        single[0] = in_speed - y_m
        model_error = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_set_point - in_speed
        tracking_error = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_0_0 * model_0
        free_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_0_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_0 + product
        free_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_1_0 * model_0
        free_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_1_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_1 + product
        free_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_2_0 * model_0
        free_2 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_2_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_2 + product
        free_2 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_3_0 * model_0
        free_3 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_3_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_3 + product
        free_3 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_0 - in_set_point
        sub_32 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_1 - in_set_point
        sub_33 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_2 - in_set_point
        sub_34 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_3 - in_set_point
        sub_35 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_4 - in_set_point
        sub_36 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_5 - in_set_point
        sub_37 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_6 - in_set_point
        sub_38 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_7 - in_set_point
        sub_39 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_8 - in_set_point
        sub_40 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_9 - in_set_point
        sub_41 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_0 * sub_32
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_1 * sub_33
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_2 * sub_34
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_3 * sub_35
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_4 * sub_36
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_5 * sub_37
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_6 * sub_38
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_7 * sub_39
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_8 * sub_40
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_9 * sub_41
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_0 * sub_32
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_1 * sub_33
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_2 * sub_34
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_3 * sub_35
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_4 * sub_36
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_5 * sub_37
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_6 * sub_38
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_7 * sub_39
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_8 * sub_40
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_9 * sub_41
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_model_errors_1 - model_error
        error_rise_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_model_errors_2 - model_error
        error_rise_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_model_errors_3 - model_error
        error_rise_2 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_model_errors_4 - model_error
        error_rise_3 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_model_errors_5 - model_error
        error_rise_4 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_model_errors_6 - model_error
        error_rise_5 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_model_errors_7 - model_error
        error_rise_6 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_0_0 * error_rise_0
        e_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_0_1 * error_rise_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_0 + product
        e_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_0_2 * error_rise_2
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_0 + product
        e_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_0_3 * error_rise_3
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_0 + product
        e_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_0_4 * error_rise_4
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_0 + product
        e_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_0_5 * error_rise_5
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_0 + product
        e_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_0_6 * error_rise_6
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_0 + product
        e_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_1_0 * error_rise_0
        e_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_1_1 * error_rise_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_1 + product
        e_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_1_2 * error_rise_2
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_1 + product
        e_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_1_3 * error_rise_3
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_1 + product
        e_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_1_4 * error_rise_4
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_1 + product
        e_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_1_5 * error_rise_5
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_1 + product
        e_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_error_fit_1_6 * error_rise_6
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = e_1 + product
        e_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 - e_0
        sub_53 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 - e_1
        sub_54 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_closed_0 * tracking_error
        rmpy_55 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_55 - free_0
        sub_56 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_57 = sub_56
        single[0] = sub_53 * c_point_powers_0_0
        rmpy_58 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_57 + rmpy_58
        add_59 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_54 * c_point_powers_0_1
        rmpy_60 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_59 + rmpy_60
        d_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_closed_1 * tracking_error
        rmpy_62 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_62 - free_1
        sub_63 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_64 = sub_63
        single[0] = sub_53 * c_point_powers_1_0
        rmpy_65 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_64 + rmpy_65
        add_66 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_54 * c_point_powers_1_1
        rmpy_67 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_66 + rmpy_67
        d_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_closed_2 * tracking_error
        rmpy_69 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_69 - free_2
        sub_70 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_71 = sub_70
        single[0] = sub_53 * c_point_powers_2_0
        rmpy_72 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_71 + rmpy_72
        add_73 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_54 * c_point_powers_2_1
        rmpy_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_73 + rmpy_74
        d_2 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_closed_3 * tracking_error
        rmpy_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_76 - free_3
        sub_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_78 = sub_77
        single[0] = sub_53 * c_point_powers_3_0
        rmpy_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_78 + rmpy_79
        add_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_54 * c_point_powers_3_1
        rmpy_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_80 + rmpy_81
        d_3 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_wavelet_0 * d_0
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_wavelet_1 * d_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = notch_raw + product
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_wavelet_2 * d_2
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = notch_raw + product
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_wavelet_3 * d_3
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = notch_raw + product
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_84 = c_minus_notch_max if c_minus_notch_max > notch_raw else notch_raw
        if c_notch_max < clip_84:
            clip_84 = c_notch_max
        notch = quantise(clip_84, 19, 8)
        convert_86 = notch
        return (
            (
                model_0,
                model_1,
                convert_86,
                state_model_errors_1,
                state_model_errors_2,
                state_model_errors_3,
                state_model_errors_4,
                state_model_errors_5,
                state_model_errors_6,
                state_model_errors_7,
                model_error,
            ),
            (
                notch_raw,
                notch,
                c_basis_0,
                c_softening,
            ),
            (
                model_0,
                model_1,
                y_m,
                model_error,
                tracking_error,
                free_0,
                free_1,
                free_2,
                free_3,
                c_0,
                c_1,
                error_rise_0,
                error_rise_1,
                error_rise_2,
                error_rise_3,
                error_rise_4,
                error_rise_5,
                error_rise_6,
                e_0,
                e_1,
                d_0,
                d_1,
                d_2,
                d_3,
                notch_raw,
                notch,
            ),
        )

    return period
