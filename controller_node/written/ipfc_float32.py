"""Law ipfc in single precision. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from array import array
from bisect import bisect_right

from railhil.controller_node.arithmetic.float32 import FLT_MAX, FLT_MIN
from railhil.controller_node.written.parts import Parts, Step, Values


def inputs_by_time(parts: Parts) -> Step:
    single = array("f", [0.0])
    (c_kmh_per_01mmps,) = parts.constants
    (t_v_of_t,) = parts.tables
    (last_0,) = parts.lasts

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            k,
            speed_01mmps,
            _position_01mm,
        ) = given
        single[0] = speed_01mmps * c_kmh_per_01mmps
        speed = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        index_4 = min(max(k, 0), last_0)
        set_point = t_v_of_t[index_4]
        at_6 = t_v_of_t[index_4 + 1]
        at_7 = t_v_of_t[index_4 + 2]
        at_8 = t_v_of_t[index_4 + 3]
        at_9 = t_v_of_t[index_4 + 4]
        at_10 = t_v_of_t[index_4 + 5]
        at_11 = t_v_of_t[index_4 + 6]
        at_12 = t_v_of_t[index_4 + 7]
        at_13 = t_v_of_t[index_4 + 8]
        at_14 = t_v_of_t[index_4 + 9]
        at_15 = t_v_of_t[index_4 + 10]
        return (
            (),
            (
                speed,
                set_point,
                at_6,
                at_7,
                at_8,
                at_9,
                at_10,
                at_11,
                at_12,
                at_13,
                at_14,
                at_15,
            ),
            (
                speed,
                set_point,
            ),
        )

    return period


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
        c_free_4_0,
        c_free_4_1,
        c_free_5_0,
        c_free_5_1,
        c_free_6_0,
        c_free_6_1,
        c_free_7_0,
        c_free_7_1,
        c_free_8_0,
        c_free_8_1,
        c_free_9_0,
        c_free_9_1,
        c_zero,
        c_per_period,
        c_one_speed,
        c_rise_never,
        c_rise_window_0,
        c_minus_rise_widths_0,
        c_rise_window_1,
        c_rise_widths_1,
        c_rise_slopes_0,
        c_one_satisfaction,
        c_rise_slopes_1,
        c_step_response_0,
        c_step_response_1,
        c_step_response_2,
        c_step_response_3,
        c_step_response_4,
        c_step_response_5,
        c_step_response_6,
        c_step_response_7,
        c_step_response_8,
        c_step_response_9,
        c_speed_window_0,
        c_minus_speed_widths_0,
        c_speed_window_1,
        c_speed_widths_1,
        c_speed_slopes_0,
        c_speed_slopes_1,
        c_one_softening,
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
        c_point_powers_0_0,
        c_point_powers_0_1,
        c_point_powers_1_0,
        c_point_powers_1_1,
        c_point_powers_2_0,
        c_point_powers_2_1,
        c_point_powers_3_0,
        c_point_powers_3_1,
        c_wavelet_change,
        c_gains_wavelet_0,
        c_gains_step_0,
        c_gains_wavelet_1,
        c_gains_step_1,
        c_gains_wavelet_2,
        c_gains_step_2,
        c_gains_wavelet_3,
        c_gains_step_3,
        c_basis_1,
        c_basis_0,
        c_notch_max,
        c_minus_notch_max,
    ) = parts.constants
    (f_softening,) = parts.curves
    div = parts.number.div
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
            state_tracking_error,
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
        single[0] = c_free_4_0 * model_0
        free_4 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_4_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_4 + product
        free_4 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_5_0 * model_0
        free_5 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_5_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_5 + product
        free_5 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_6_0 * model_0
        free_6 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_6_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_6 + product
        free_6 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_7_0 * model_0
        free_7 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_7_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_7 + product
        free_7 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_8_0 * model_0
        free_8 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_8_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_8 + product
        free_8 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_9_0 * model_0
        free_9 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_free_9_1 * model_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = free_9 + product
        free_9 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_39 = abs(tracking_error)
        abs_40 = abs(state_tracking_error)
        single[0] = abs_40 - abs_39
        sub_41 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_42 = sub_41 > c_zero
        single[0] = sub_41 * c_per_period
        rsmpy_43 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        where_44 = rsmpy_43 if gt_42 else c_one_speed
        div_45 = div(abs_39, where_44, 24)
        gt_46 = abs_39 > c_zero
        where_47 = c_rise_never if gt_46 else c_zero
        t_s = div_45 if gt_42 else where_47
        single[0] = t_s - c_rise_window_0
        sub_49 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_50 = c_minus_rise_widths_0 if c_minus_rise_widths_0 > sub_49 else sub_49
        if c_zero < clip_50:
            clip_50 = c_zero
        single[0] = t_s - c_rise_window_1
        sub_51 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_52 = c_zero if c_zero > sub_51 else sub_51
        if c_rise_widths_1 < clip_52:
            clip_52 = c_rise_widths_1
        single[0] = clip_50 * c_rise_slopes_0
        rmpy_53 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_one_satisfaction + rmpy_53
        add_54 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_52 * c_rise_slopes_1
        rmpy_55 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_one_satisfaction - rmpy_55
        sub_56 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        minimum_57 = sub_56 if sub_56 < add_54 else add_54
        clip_58 = c_zero if c_zero > minimum_57 else minimum_57
        if c_one_satisfaction < clip_58:
            clip_58 = c_one_satisfaction
        gt_59 = t_s > c_zero
        mu_ts = clip_58 if gt_59 else c_one_satisfaction
        single[0] = in_speed + free_0
        add_61 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_0 * state_notch
        rmpy_62 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_61 + rmpy_62
        add_63 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_63 - in_preview_0
        sub_64 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_1
        add_65 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_1 * state_notch
        rmpy_66 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_65 + rmpy_66
        add_67 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_67 - in_preview_1
        sub_68 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_2
        add_69 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_2 * state_notch
        rmpy_70 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_69 + rmpy_70
        add_71 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_71 - in_preview_2
        sub_72 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_3
        add_73 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_3 * state_notch
        rmpy_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_73 + rmpy_74
        add_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_75 - in_preview_3
        sub_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_4
        add_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_4 * state_notch
        rmpy_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_77 + rmpy_78
        add_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_79 - in_preview_4
        sub_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_5
        add_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_5 * state_notch
        rmpy_82 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_81 + rmpy_82
        add_83 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_83 - in_preview_5
        sub_84 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_6
        add_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_6 * state_notch
        rmpy_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_85 + rmpy_86
        add_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_87 - in_preview_6
        sub_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_7
        add_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_7 * state_notch
        rmpy_90 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_89 + rmpy_90
        add_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_91 - in_preview_7
        sub_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_8
        add_93 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_8 * state_notch
        rmpy_94 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_93 + rmpy_94
        add_95 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_95 - in_preview_8
        sub_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_speed + free_9
        add_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_9 * state_notch
        rmpy_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_97 + rmpy_98
        add_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_99 - in_preview_9
        sub_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        minimum_101 = sub_68 if sub_68 < sub_64 else sub_64
        maximum_102 = sub_68 if sub_68 > sub_64 else sub_64
        minimum_103 = sub_72 if sub_72 < minimum_101 else minimum_101
        maximum_104 = sub_72 if sub_72 > maximum_102 else maximum_102
        minimum_105 = sub_76 if sub_76 < minimum_103 else minimum_103
        maximum_106 = sub_76 if sub_76 > maximum_104 else maximum_104
        minimum_107 = sub_80 if sub_80 < minimum_105 else minimum_105
        maximum_108 = sub_80 if sub_80 > maximum_106 else maximum_106
        minimum_109 = sub_84 if sub_84 < minimum_107 else minimum_107
        maximum_110 = sub_84 if sub_84 > maximum_108 else maximum_108
        minimum_111 = sub_88 if sub_88 < minimum_109 else minimum_109
        maximum_112 = sub_88 if sub_88 > maximum_110 else maximum_110
        minimum_113 = sub_92 if sub_92 < minimum_111 else minimum_111
        maximum_114 = sub_92 if sub_92 > maximum_112 else maximum_112
        minimum_115 = sub_96 if sub_96 < minimum_113 else minimum_113
        maximum_116 = sub_96 if sub_96 > maximum_114 else maximum_114
        miss_low = sub_100 if sub_100 < minimum_115 else minimum_115
        miss_high = sub_100 if sub_100 > maximum_116 else maximum_116
        single[0] = miss_low - c_speed_window_0
        sub_119 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_120 = c_minus_speed_widths_0 if c_minus_speed_widths_0 > sub_119 else sub_119
        if c_zero < clip_120:
            clip_120 = c_zero
        single[0] = miss_high - c_speed_window_1
        sub_121 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_122 = c_zero if c_zero > sub_121 else sub_121
        if c_speed_widths_1 < clip_122:
            clip_122 = c_speed_widths_1
        single[0] = clip_120 * c_speed_slopes_0
        rmpy_123 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_one_satisfaction + rmpy_123
        add_124 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_122 * c_speed_slopes_1
        rmpy_125 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_one_satisfaction - rmpy_125
        sub_126 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        minimum_127 = sub_126 if sub_126 < add_124 else add_124
        mu_y = c_zero if c_zero > minimum_127 else minimum_127
        if c_one_satisfaction < mu_y:
            mu_y = c_one_satisfaction
        mu = mu_y if mu_y < mu_ts else mu_ts
        scaled = mu * 256.0
        cell = int(min(scaled, 255.0))
        single[0] = f_softening[cell + 1] - f_softening[cell]
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = product * (scaled - cell)
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = f_softening[cell] + product
        alpha = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = alpha * alpha
        rmpy_131 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_131 * alpha
        rmpy_132 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_132 * alpha
        rmpy_133 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_133 * alpha
        rmpy_134 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_134 * alpha
        rmpy_135 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_135 * alpha
        rmpy_136 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_136 * alpha
        rmpy_137 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_137 * alpha
        rmpy_138 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_one_softening - rmpy_132
        sub_139 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_one_softening - rmpy_134
        sub_140 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_one_softening - rmpy_137
        sub_141 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_one_softening - rmpy_138
        sub_142 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_0 - in_set_point
        sub_143 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_1 - in_set_point
        sub_144 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_2 - in_set_point
        sub_145 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_3 - in_set_point
        sub_146 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_4 - in_set_point
        sub_147 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_5 - in_set_point
        sub_148 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_6 - in_set_point
        sub_149 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_7 - in_set_point
        sub_150 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_8 - in_set_point
        sub_151 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_9 - in_set_point
        sub_152 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_0 * sub_143
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_1 * sub_144
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_2 * sub_145
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_3 * sub_146
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_4 * sub_147
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_5 * sub_148
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_6 * sub_149
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_7 * sub_150
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_8 * sub_151
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_0_9 * sub_152
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_0 + product
        c_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_0 * sub_143
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_1 * sub_144
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_2 * sub_145
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_3 * sub_146
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_4 * sub_147
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_5 * sub_148
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_6 * sub_149
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_7 * sub_150
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_8 * sub_151
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 + product
        c_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_set_point_fit_1_9 * sub_152
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
        sub_164 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_1 - e_1
        sub_165 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_139 * tracking_error
        rmpy_166 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_166 - free_2
        sub_167 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_168 = sub_167
        single[0] = sub_164 * c_point_powers_0_0
        rmpy_169 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_168 + rmpy_169
        add_170 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_165 * c_point_powers_0_1
        rmpy_171 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_170 + rmpy_171
        d_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_140 * tracking_error
        rmpy_173 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_173 - free_4
        sub_174 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_175 = sub_174
        single[0] = sub_164 * c_point_powers_1_0
        rmpy_176 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_175 + rmpy_176
        add_177 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_165 * c_point_powers_1_1
        rmpy_178 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_177 + rmpy_178
        d_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_141 * tracking_error
        rmpy_180 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_180 - free_7
        sub_181 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_182 = sub_181
        single[0] = sub_164 * c_point_powers_2_0
        rmpy_183 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_182 + rmpy_183
        add_184 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_165 * c_point_powers_2_1
        rmpy_185 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_184 + rmpy_185
        d_2 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_142 * tracking_error
        rmpy_187 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_187 - free_8
        sub_188 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_189 = sub_188
        single[0] = sub_164 * c_point_powers_3_0
        rmpy_190 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_189 + rmpy_190
        add_191 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_165 * c_point_powers_3_1
        rmpy_192 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_191 + rmpy_192
        d_3 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_preview_9 - in_set_point
        sub_194 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        change = abs(sub_194)
        gt_196 = change > c_wavelet_change
        where_197 = c_gains_wavelet_0 if gt_196 else c_gains_step_0
        where_198 = c_gains_wavelet_1 if gt_196 else c_gains_step_1
        where_199 = c_gains_wavelet_2 if gt_196 else c_gains_step_2
        where_200 = c_gains_wavelet_3 if gt_196 else c_gains_step_3
        where_201 = c_basis_1 if gt_196 else c_basis_0
        single[0] = where_197 * d_0
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = where_198 * d_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = notch_raw + product
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = where_199 * d_2
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = notch_raw + product
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = where_200 * d_3
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = notch_raw + product
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_203 = c_minus_notch_max if c_minus_notch_max > notch_raw else notch_raw
        if c_notch_max < clip_203:
            clip_203 = c_notch_max
        notch = quantise(clip_203, 19, 8)
        convert_205 = notch
        return (
            (
                model_0,
                model_1,
                convert_205,
                state_model_errors_1,
                state_model_errors_2,
                state_model_errors_3,
                state_model_errors_4,
                state_model_errors_5,
                state_model_errors_6,
                state_model_errors_7,
                model_error,
                tracking_error,
            ),
            (
                notch_raw,
                notch,
                where_201,
                alpha,
                mu,
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
                free_4,
                free_5,
                free_6,
                free_7,
                free_8,
                free_9,
                t_s,
                mu_ts,
                miss_low,
                miss_high,
                mu_y,
                mu,
                alpha,
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
                change,
                notch_raw,
                notch,
            ),
        )

    return period


def inputs_by_distance(parts: Parts) -> Step:
    single = array("f", [0.0])
    (
        c_kmh_per_01mmps,
        c_one_01mm,
        c_zero,
        c_one,
        c_from,
    ) = parts.constants
    (
        t_v_of_t,
        t_x_of_t,
        t_v_of_x,
    ) = parts.tables
    (last_0,) = parts.lasts
    div = parts.number.div

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            k,
            speed_01mmps,
            position_01mm,
        ) = given
        single[0] = speed_01mmps * c_kmh_per_01mmps
        speed = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        index_4 = min(max(k, 0), last_0)
        at_5 = t_v_of_t[index_4]
        at_6 = t_v_of_t[index_4 + 1]
        at_7 = t_v_of_t[index_4 + 2]
        at_8 = t_v_of_t[index_4 + 3]
        at_9 = t_v_of_t[index_4 + 4]
        at_10 = t_v_of_t[index_4 + 5]
        at_11 = t_v_of_t[index_4 + 6]
        at_12 = t_v_of_t[index_4 + 7]
        at_13 = t_v_of_t[index_4 + 8]
        at_14 = t_v_of_t[index_4 + 9]
        at_15 = t_v_of_t[index_4 + 10]
        locate_16 = min(max(bisect_right(t_x_of_t, position_01mm) - 1, 0), len(t_x_of_t) - 2)
        at_17 = t_x_of_t[locate_16]
        at_18 = t_x_of_t[locate_16 + 1]
        single[0] = at_18 - at_17
        sub_19 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_20 = c_one_01mm if c_one_01mm > sub_19 else sub_19
        single[0] = position_01mm - at_17
        sub_21 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_22 = c_zero if c_zero > sub_21 else sub_21
        if maximum_20 < clip_22:
            clip_22 = maximum_20
        div_23 = div(clip_22, maximum_20, 20)
        minimum_24 = c_one if c_one < div_23 else div_23
        at_25 = t_v_of_x[locate_16]
        at_26 = t_v_of_x[locate_16 + 1]
        single[0] = at_26 - at_25
        sub_27 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_27 * minimum_24
        rmpy_28 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_25 + rmpy_28
        add_29 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_30 = t_v_of_x[locate_16 + 16]
        at_31 = t_v_of_x[locate_16 + 17]
        single[0] = at_31 - at_30
        sub_32 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_32 * minimum_24
        rmpy_33 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_30 + rmpy_33
        add_34 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_35 = t_v_of_x[locate_16 + 32]
        at_36 = t_v_of_x[locate_16 + 33]
        single[0] = at_36 - at_35
        sub_37 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_37 * minimum_24
        rmpy_38 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_35 + rmpy_38
        add_39 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_40 = t_v_of_x[locate_16 + 48]
        at_41 = t_v_of_x[locate_16 + 49]
        single[0] = at_41 - at_40
        sub_42 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_42 * minimum_24
        rmpy_43 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_40 + rmpy_43
        add_44 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_45 = t_v_of_x[locate_16 + 64]
        at_46 = t_v_of_x[locate_16 + 65]
        single[0] = at_46 - at_45
        sub_47 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_47 * minimum_24
        rmpy_48 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_45 + rmpy_48
        add_49 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_50 = t_v_of_x[locate_16 + 80]
        at_51 = t_v_of_x[locate_16 + 81]
        single[0] = at_51 - at_50
        sub_52 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_52 * minimum_24
        rmpy_53 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_50 + rmpy_53
        add_54 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_55 = t_v_of_x[locate_16 + 96]
        at_56 = t_v_of_x[locate_16 + 97]
        single[0] = at_56 - at_55
        sub_57 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_57 * minimum_24
        rmpy_58 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_55 + rmpy_58
        add_59 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_60 = t_v_of_x[locate_16 + 112]
        at_61 = t_v_of_x[locate_16 + 113]
        single[0] = at_61 - at_60
        sub_62 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_62 * minimum_24
        rmpy_63 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_60 + rmpy_63
        add_64 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_65 = t_v_of_x[locate_16 + 128]
        at_66 = t_v_of_x[locate_16 + 129]
        single[0] = at_66 - at_65
        sub_67 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_67 * minimum_24
        rmpy_68 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_65 + rmpy_68
        add_69 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_70 = t_v_of_x[locate_16 + 144]
        at_71 = t_v_of_x[locate_16 + 145]
        single[0] = at_71 - at_70
        sub_72 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_72 * minimum_24
        rmpy_73 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_70 + rmpy_73
        add_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_75 = t_v_of_x[locate_16 + 160]
        at_76 = t_v_of_x[locate_16 + 161]
        single[0] = at_76 - at_75
        sub_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_77 * minimum_24
        rmpy_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_75 + rmpy_78
        add_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_80 = position_01mm > c_from
        set_point = add_29 if gt_80 else at_5
        where_82 = add_34 if gt_80 else at_6
        where_83 = add_39 if gt_80 else at_7
        where_84 = add_44 if gt_80 else at_8
        where_85 = add_49 if gt_80 else at_9
        where_86 = add_54 if gt_80 else at_10
        where_87 = add_59 if gt_80 else at_11
        where_88 = add_64 if gt_80 else at_12
        where_89 = add_69 if gt_80 else at_13
        where_90 = add_74 if gt_80 else at_14
        where_91 = add_79 if gt_80 else at_15
        return (
            (),
            (
                speed,
                set_point,
                where_82,
                where_83,
                where_84,
                where_85,
                where_86,
                where_87,
                where_88,
                where_89,
                where_90,
                where_91,
            ),
            (
                speed,
                set_point,
            ),
        )

    return period
