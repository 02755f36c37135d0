"""Law tpfc2 in fixed point. Written by ``make tables`` from the recorded program; do not edit."""

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
        c_rise_max,
        c_minus_rise_max,
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
        c_deviation_max,
        c_minus_deviation_max,
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
    (
        low_model_0,
        high_model_0,
        low_model_1,
        high_model_1,
        low_notch,
        high_notch,
        low_model_errors_0,
        high_model_errors_0,
        low_model_errors_1,
        high_model_errors_1,
        low_model_errors_2,
        high_model_errors_2,
        low_model_errors_3,
        high_model_errors_3,
        low_model_errors_4,
        high_model_errors_4,
        low_model_errors_5,
        high_model_errors_5,
        low_model_errors_6,
        high_model_errors_6,
        low_model_errors_7,
        high_model_errors_7,
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_model_0,
            state_model_1,
            state_notch,
            state_model_errors_0,
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
        if not low_model_0 <= state_model_0 <= high_model_0:
            return None
        if not low_model_1 <= state_model_1 <= high_model_1:
            return None
        if not low_notch <= state_notch <= high_notch:
            return None
        if not low_model_errors_0 <= state_model_errors_0 <= high_model_errors_0:
            return None
        if not low_model_errors_1 <= state_model_errors_1 <= high_model_errors_1:
            return None
        if not low_model_errors_2 <= state_model_errors_2 <= high_model_errors_2:
            return None
        if not low_model_errors_3 <= state_model_errors_3 <= high_model_errors_3:
            return None
        if not low_model_errors_4 <= state_model_errors_4 <= high_model_errors_4:
            return None
        if not low_model_errors_5 <= state_model_errors_5 <= high_model_errors_5:
            return None
        if not low_model_errors_6 <= state_model_errors_6 <= high_model_errors_6:
            return None
        if not low_model_errors_7 <= state_model_errors_7 <= high_model_errors_7:
            return None
        model_0 = c_model_0_0 * state_model_0 + 8388608 >> 24
        model_0 += c_model_0_1 * state_model_1 + 8388608 >> 24
        model_0 += c_model_0_2 * state_notch + 8388608 >> 24
        model_1 = c_model_1_0 * state_model_0 + 8388608 >> 24
        model_1 += c_model_1_1 * state_model_1 + 8388608 >> 24
        model_1 += c_model_1_2 * state_notch + 8388608 >> 24
        y_m = model_0 >> 4
        model_error = in_speed - y_m
        tracking_error = in_set_point - in_speed
        free_0 = c_free_0_0 * model_0 + 134217728 >> 28
        free_0 += c_free_0_1 * model_1 + 134217728 >> 28
        free_1 = c_free_1_0 * model_0 + 134217728 >> 28
        free_1 += c_free_1_1 * model_1 + 134217728 >> 28
        free_2 = c_free_2_0 * model_0 + 134217728 >> 28
        free_2 += c_free_2_1 * model_1 + 134217728 >> 28
        free_3 = c_free_3_0 * model_0 + 134217728 >> 28
        free_3 += c_free_3_1 * model_1 + 134217728 >> 28
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
        if not c_minus_rise_max <= sub_32 <= c_rise_max:
            return None
        sat_42 = sub_32
        if not c_minus_rise_max <= sub_33 <= c_rise_max:
            return None
        sat_43 = sub_33
        if not c_minus_rise_max <= sub_34 <= c_rise_max:
            return None
        sat_44 = sub_34
        if not c_minus_rise_max <= sub_35 <= c_rise_max:
            return None
        sat_45 = sub_35
        if not c_minus_rise_max <= sub_36 <= c_rise_max:
            return None
        sat_46 = sub_36
        if not c_minus_rise_max <= sub_37 <= c_rise_max:
            return None
        sat_47 = sub_37
        if not c_minus_rise_max <= sub_38 <= c_rise_max:
            return None
        sat_48 = sub_38
        if not c_minus_rise_max <= sub_39 <= c_rise_max:
            return None
        sat_49 = sub_39
        if not c_minus_rise_max <= sub_40 <= c_rise_max:
            return None
        sat_50 = sub_40
        if not c_minus_rise_max <= sub_41 <= c_rise_max:
            return None
        sat_51 = sub_41
        c_0 = c_set_point_fit_0_0 * sat_42 + 1048576 >> 21
        c_0 += c_set_point_fit_0_1 * sat_43 + 1048576 >> 21
        c_0 += c_set_point_fit_0_2 * sat_44 + 1048576 >> 21
        c_0 += c_set_point_fit_0_3 * sat_45 + 1048576 >> 21
        c_0 += c_set_point_fit_0_4 * sat_46 + 1048576 >> 21
        c_0 += c_set_point_fit_0_5 * sat_47 + 1048576 >> 21
        c_0 += c_set_point_fit_0_6 * sat_48 + 1048576 >> 21
        c_0 += c_set_point_fit_0_7 * sat_49 + 1048576 >> 21
        c_0 += c_set_point_fit_0_8 * sat_50 + 1048576 >> 21
        c_0 += c_set_point_fit_0_9 * sat_51 + 1048576 >> 21
        c_1 = c_set_point_fit_1_0 * sat_42 + 1048576 >> 21
        c_1 += c_set_point_fit_1_1 * sat_43 + 1048576 >> 21
        c_1 += c_set_point_fit_1_2 * sat_44 + 1048576 >> 21
        c_1 += c_set_point_fit_1_3 * sat_45 + 1048576 >> 21
        c_1 += c_set_point_fit_1_4 * sat_46 + 1048576 >> 21
        c_1 += c_set_point_fit_1_5 * sat_47 + 1048576 >> 21
        c_1 += c_set_point_fit_1_6 * sat_48 + 1048576 >> 21
        c_1 += c_set_point_fit_1_7 * sat_49 + 1048576 >> 21
        c_1 += c_set_point_fit_1_8 * sat_50 + 1048576 >> 21
        c_1 += c_set_point_fit_1_9 * sat_51 + 1048576 >> 21
        sub_54 = state_model_errors_1 - model_error
        sub_55 = state_model_errors_2 - model_error
        sub_56 = state_model_errors_3 - model_error
        sub_57 = state_model_errors_4 - model_error
        sub_58 = state_model_errors_5 - model_error
        sub_59 = state_model_errors_6 - model_error
        sub_60 = state_model_errors_7 - model_error
        if not c_minus_rise_max <= sub_54 <= c_rise_max:
            return None
        error_rise_0 = sub_54
        if not c_minus_rise_max <= sub_55 <= c_rise_max:
            return None
        error_rise_1 = sub_55
        if not c_minus_rise_max <= sub_56 <= c_rise_max:
            return None
        error_rise_2 = sub_56
        if not c_minus_rise_max <= sub_57 <= c_rise_max:
            return None
        error_rise_3 = sub_57
        if not c_minus_rise_max <= sub_58 <= c_rise_max:
            return None
        error_rise_4 = sub_58
        if not c_minus_rise_max <= sub_59 <= c_rise_max:
            return None
        error_rise_5 = sub_59
        if not c_minus_rise_max <= sub_60 <= c_rise_max:
            return None
        error_rise_6 = sub_60
        e_0 = c_error_fit_0_0 * error_rise_0 + 1048576 >> 21
        e_0 += c_error_fit_0_1 * error_rise_1 + 1048576 >> 21
        e_0 += c_error_fit_0_2 * error_rise_2 + 1048576 >> 21
        e_0 += c_error_fit_0_3 * error_rise_3 + 1048576 >> 21
        e_0 += c_error_fit_0_4 * error_rise_4 + 1048576 >> 21
        e_0 += c_error_fit_0_5 * error_rise_5 + 1048576 >> 21
        e_0 += c_error_fit_0_6 * error_rise_6 + 1048576 >> 21
        e_1 = c_error_fit_1_0 * error_rise_0 + 1048576 >> 21
        e_1 += c_error_fit_1_1 * error_rise_1 + 1048576 >> 21
        e_1 += c_error_fit_1_2 * error_rise_2 + 1048576 >> 21
        e_1 += c_error_fit_1_3 * error_rise_3 + 1048576 >> 21
        e_1 += c_error_fit_1_4 * error_rise_4 + 1048576 >> 21
        e_1 += c_error_fit_1_5 * error_rise_5 + 1048576 >> 21
        e_1 += c_error_fit_1_6 * error_rise_6 + 1048576 >> 21
        sub_70 = c_0 - e_0
        sub_71 = c_1 - e_1
        rmpy_72 = c_closed_0 * tracking_error + 536870912 >> 30
        sub_73 = rmpy_72 - free_0
        convert_74 = sub_73 >> 1
        rmpy_75 = sub_70 * c_point_powers_0_0 + 8 >> 4
        add_76 = convert_74 + rmpy_75
        rmpy_77 = sub_71 * c_point_powers_0_1 + 8 >> 4
        add_78 = add_76 + rmpy_77
        if not c_minus_deviation_max <= add_78 <= c_deviation_max:
            return None
        d_0 = add_78
        rmpy_80 = c_closed_1 * tracking_error + 536870912 >> 30
        sub_81 = rmpy_80 - free_1
        convert_82 = sub_81 >> 1
        rmpy_83 = sub_70 * c_point_powers_1_0 + 8 >> 4
        add_84 = convert_82 + rmpy_83
        rmpy_85 = sub_71 * c_point_powers_1_1 + 8 >> 4
        add_86 = add_84 + rmpy_85
        if not c_minus_deviation_max <= add_86 <= c_deviation_max:
            return None
        d_1 = add_86
        rmpy_88 = c_closed_2 * tracking_error + 536870912 >> 30
        sub_89 = rmpy_88 - free_2
        convert_90 = sub_89 >> 1
        rmpy_91 = sub_70 * c_point_powers_2_0 + 8 >> 4
        add_92 = convert_90 + rmpy_91
        rmpy_93 = sub_71 * c_point_powers_2_1 + 8 >> 4
        add_94 = add_92 + rmpy_93
        if not c_minus_deviation_max <= add_94 <= c_deviation_max:
            return None
        d_2 = add_94
        rmpy_96 = c_closed_3 * tracking_error + 536870912 >> 30
        sub_97 = rmpy_96 - free_3
        convert_98 = sub_97 >> 1
        rmpy_99 = sub_70 * c_point_powers_3_0 + 8 >> 4
        add_100 = convert_98 + rmpy_99
        rmpy_101 = sub_71 * c_point_powers_3_1 + 8 >> 4
        add_102 = add_100 + rmpy_101
        if not c_minus_deviation_max <= add_102 <= c_deviation_max:
            return None
        d_3 = add_102
        notch_raw = c_gains_wavelet_0 * d_0 + 8388608 >> 24
        notch_raw += c_gains_wavelet_1 * d_1 + 8388608 >> 24
        notch_raw += c_gains_wavelet_2 * d_2 + 8388608 >> 24
        notch_raw += c_gains_wavelet_3 * d_3 + 8388608 >> 24
        clip_105 = notch_raw if notch_raw < c_notch_max else c_notch_max
        if clip_105 < c_minus_notch_max:
            clip_105 = c_minus_notch_max
        notch = clip_105 + 1024 >> 11
        convert_107 = notch << 16
        return (
            (
                model_0,
                model_1,
                convert_107,
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
