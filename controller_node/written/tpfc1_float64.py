"""Law tpfc1 in double precision. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from railhil.controller_node.written.parts import Parts, Step, Values


def step(parts: Parts) -> Step:
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
        c_ramp_change,
        c_gains_ramp_0,
        c_gains_step_0,
        c_gains_ramp_1,
        c_gains_step_1,
        c_gains_ramp_2,
        c_gains_step_2,
        c_gains_ramp_3,
        c_gains_step_3,
        c_basis_1,
        c_basis_0,
        c_notch_max,
        c_minus_notch_max,
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
        model_0 = 0.0 + c_model_0_0 * state_model_0
        model_0 += c_model_0_1 * state_model_1
        model_0 += c_model_0_2 * state_notch
        model_1 = 0.0 + c_model_1_0 * state_model_0
        model_1 += c_model_1_1 * state_model_1
        model_1 += c_model_1_2 * state_notch
        y_m = model_0
        model_error = in_speed - y_m
        tracking_error = in_set_point - in_speed
        free_0 = 0.0 + c_free_0_0 * model_0
        free_0 += c_free_0_1 * model_1
        free_1 = 0.0 + c_free_1_0 * model_0
        free_1 += c_free_1_1 * model_1
        free_2 = 0.0 + c_free_2_0 * model_0
        free_2 += c_free_2_1 * model_1
        free_3 = 0.0 + c_free_3_0 * model_0
        free_3 += c_free_3_1 * model_1
        sub_32 = in_preview_0 - in_set_point
        sub_33 = in_preview_1 - in_set_point
        sub_34 = in_preview_2 - in_set_point
        sub_35 = in_preview_3 - in_set_point
        sub_36 = in_preview_4 - in_set_point
        sub_37 = in_preview_5 - in_set_point
        sub_38 = in_preview_6 - in_set_point
        sub_39 = in_preview_7 - in_set_point
        sub_40 = in_preview_8 - in_set_point
        sub_41 = in_preview_9 - in_set_point
        c_0 = 0.0 + c_set_point_fit_0_0 * sub_32
        c_0 += c_set_point_fit_0_1 * sub_33
        c_0 += c_set_point_fit_0_2 * sub_34
        c_0 += c_set_point_fit_0_3 * sub_35
        c_0 += c_set_point_fit_0_4 * sub_36
        c_0 += c_set_point_fit_0_5 * sub_37
        c_0 += c_set_point_fit_0_6 * sub_38
        c_0 += c_set_point_fit_0_7 * sub_39
        c_0 += c_set_point_fit_0_8 * sub_40
        c_0 += c_set_point_fit_0_9 * sub_41
        c_1 = 0.0 + c_set_point_fit_1_0 * sub_32
        c_1 += c_set_point_fit_1_1 * sub_33
        c_1 += c_set_point_fit_1_2 * sub_34
        c_1 += c_set_point_fit_1_3 * sub_35
        c_1 += c_set_point_fit_1_4 * sub_36
        c_1 += c_set_point_fit_1_5 * sub_37
        c_1 += c_set_point_fit_1_6 * sub_38
        c_1 += c_set_point_fit_1_7 * sub_39
        c_1 += c_set_point_fit_1_8 * sub_40
        c_1 += c_set_point_fit_1_9 * sub_41
        error_rise_0 = state_model_errors_1 - model_error
        error_rise_1 = state_model_errors_2 - model_error
        error_rise_2 = state_model_errors_3 - model_error
        error_rise_3 = state_model_errors_4 - model_error
        error_rise_4 = state_model_errors_5 - model_error
        error_rise_5 = state_model_errors_6 - model_error
        error_rise_6 = state_model_errors_7 - model_error
        e_0 = 0.0 + c_error_fit_0_0 * error_rise_0
        e_0 += c_error_fit_0_1 * error_rise_1
        e_0 += c_error_fit_0_2 * error_rise_2
        e_0 += c_error_fit_0_3 * error_rise_3
        e_0 += c_error_fit_0_4 * error_rise_4
        e_0 += c_error_fit_0_5 * error_rise_5
        e_0 += c_error_fit_0_6 * error_rise_6
        e_1 = 0.0 + c_error_fit_1_0 * error_rise_0
        e_1 += c_error_fit_1_1 * error_rise_1
        e_1 += c_error_fit_1_2 * error_rise_2
        e_1 += c_error_fit_1_3 * error_rise_3
        e_1 += c_error_fit_1_4 * error_rise_4
        e_1 += c_error_fit_1_5 * error_rise_5
        e_1 += c_error_fit_1_6 * error_rise_6
        sub_53 = c_0 - e_0
        sub_54 = c_1 - e_1
        rmpy_55 = c_closed_0 * tracking_error
        sub_56 = rmpy_55 - free_0
        convert_57 = sub_56
        rmpy_58 = sub_53 * c_point_powers_0_0
        add_59 = convert_57 + rmpy_58
        rmpy_60 = sub_54 * c_point_powers_0_1
        d_0 = add_59 + rmpy_60
        rmpy_62 = c_closed_1 * tracking_error
        sub_63 = rmpy_62 - free_1
        convert_64 = sub_63
        rmpy_65 = sub_53 * c_point_powers_1_0
        add_66 = convert_64 + rmpy_65
        rmpy_67 = sub_54 * c_point_powers_1_1
        d_1 = add_66 + rmpy_67
        rmpy_69 = c_closed_2 * tracking_error
        sub_70 = rmpy_69 - free_2
        convert_71 = sub_70
        rmpy_72 = sub_53 * c_point_powers_2_0
        add_73 = convert_71 + rmpy_72
        rmpy_74 = sub_54 * c_point_powers_2_1
        d_2 = add_73 + rmpy_74
        rmpy_76 = c_closed_3 * tracking_error
        sub_77 = rmpy_76 - free_3
        convert_78 = sub_77
        rmpy_79 = sub_53 * c_point_powers_3_0
        add_80 = convert_78 + rmpy_79
        rmpy_81 = sub_54 * c_point_powers_3_1
        d_3 = add_80 + rmpy_81
        sub_83 = in_preview_9 - in_set_point
        change = abs(sub_83)
        gt_85 = change > c_ramp_change
        where_86 = c_gains_ramp_0 if gt_85 else c_gains_step_0
        where_87 = c_gains_ramp_1 if gt_85 else c_gains_step_1
        where_88 = c_gains_ramp_2 if gt_85 else c_gains_step_2
        where_89 = c_gains_ramp_3 if gt_85 else c_gains_step_3
        where_90 = c_basis_1 if gt_85 else c_basis_0
        notch_raw = 0.0 + where_86 * d_0
        notch_raw += where_87 * d_1
        notch_raw += where_88 * d_2
        notch_raw += where_89 * d_3
        clip_92 = c_minus_notch_max if c_minus_notch_max > notch_raw else notch_raw
        if c_notch_max < clip_92:
            clip_92 = c_notch_max
        notch = quantise(clip_92, 19, 8)
        convert_94 = notch
        return (
            (
                model_0,
                model_1,
                convert_94,
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
                where_90,
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
                change,
                notch_raw,
                notch,
            ),
        )

    return period
