"""Law ipfc in fixed point. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from bisect import bisect_right

from railhil.controller_node.written.parts import Parts, Step, Values


def inputs_by_time(parts: Parts) -> Step:
    (c_kmh_per_01mmps,) = parts.constants
    (t_v_of_t,) = parts.tables
    (last_0,) = parts.lasts
    (
        low_speed_01mmps,
        high_speed_01mmps,
        low_position_01mm,
        high_position_01mm,
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            k,
            speed_01mmps,
            position_01mm,
        ) = given
        if not low_speed_01mmps <= speed_01mmps <= high_speed_01mmps:
            return None
        if not low_position_01mm <= position_01mm <= high_position_01mm:
            return None
        speed = speed_01mmps * c_kmh_per_01mmps >> 20
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
        c_rise_never_narrow,
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
        c_point_powers_0_0,
        c_point_powers_0_1,
        c_deviation_max,
        c_minus_deviation_max,
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
        low_tracking_error,
        high_tracking_error,
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
        if not low_tracking_error <= state_tracking_error <= high_tracking_error:
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
        free_4 = c_free_4_0 * model_0 + 134217728 >> 28
        free_4 += c_free_4_1 * model_1 + 134217728 >> 28
        free_5 = c_free_5_0 * model_0 + 134217728 >> 28
        free_5 += c_free_5_1 * model_1 + 134217728 >> 28
        free_6 = c_free_6_0 * model_0 + 134217728 >> 28
        free_6 += c_free_6_1 * model_1 + 134217728 >> 28
        free_7 = c_free_7_0 * model_0 + 134217728 >> 28
        free_7 += c_free_7_1 * model_1 + 134217728 >> 28
        free_8 = c_free_8_0 * model_0 + 134217728 >> 28
        free_8 += c_free_8_1 * model_1 + 134217728 >> 28
        free_9 = c_free_9_0 * model_0 + 134217728 >> 28
        free_9 += c_free_9_1 * model_1 + 134217728 >> 28
        abs_39 = abs(tracking_error)
        abs_40 = abs(state_tracking_error)
        sub_41 = abs_40 - abs_39
        gt_42 = sub_41 > c_zero
        rsmpy_43 = sub_41 * c_per_period + 524288 >> 20
        if not -2147483648 <= rsmpy_43 <= 2147483647:
            return None
        where_44 = rsmpy_43 if gt_42 else c_one_speed
        maximum_45 = abs_39 if abs_39 > where_44 else where_44
        div_46 = div(abs_39, maximum_45, 24)
        gt_47 = abs_39 > c_zero
        where_48 = c_rise_never_narrow if gt_47 else c_zero
        t_s = div_46 if gt_42 else where_48
        sub_50 = t_s - c_rise_window_0
        clip_51 = sub_50 if sub_50 < c_zero else c_zero
        if clip_51 < c_minus_rise_widths_0:
            clip_51 = c_minus_rise_widths_0
        sub_52 = t_s - c_rise_window_1
        clip_53 = sub_52 if sub_52 < c_rise_widths_1 else c_rise_widths_1
        if clip_53 < c_zero:
            clip_53 = c_zero
        rmpy_54 = clip_51 * c_rise_slopes_0 + 524288 >> 20
        add_55 = c_one_satisfaction + rmpy_54
        rmpy_56 = clip_53 * c_rise_slopes_1 + 524288 >> 20
        sub_57 = c_one_satisfaction - rmpy_56
        minimum_58 = sub_57 if sub_57 < add_55 else add_55
        clip_59 = minimum_58 if minimum_58 < c_one_satisfaction else c_one_satisfaction
        if clip_59 < c_zero:
            clip_59 = c_zero
        gt_60 = t_s > c_zero
        mu_ts = clip_59 if gt_60 else c_one_satisfaction
        add_62 = in_speed + free_0
        rmpy_63 = c_step_response_0 * state_notch + 134217728 >> 28
        add_64 = add_62 + rmpy_63
        sub_65 = add_64 - in_preview_0
        add_66 = in_speed + free_1
        rmpy_67 = c_step_response_1 * state_notch + 134217728 >> 28
        add_68 = add_66 + rmpy_67
        sub_69 = add_68 - in_preview_1
        add_70 = in_speed + free_2
        rmpy_71 = c_step_response_2 * state_notch + 134217728 >> 28
        add_72 = add_70 + rmpy_71
        sub_73 = add_72 - in_preview_2
        add_74 = in_speed + free_3
        rmpy_75 = c_step_response_3 * state_notch + 134217728 >> 28
        add_76 = add_74 + rmpy_75
        sub_77 = add_76 - in_preview_3
        add_78 = in_speed + free_4
        rmpy_79 = c_step_response_4 * state_notch + 134217728 >> 28
        add_80 = add_78 + rmpy_79
        sub_81 = add_80 - in_preview_4
        add_82 = in_speed + free_5
        rmpy_83 = c_step_response_5 * state_notch + 134217728 >> 28
        add_84 = add_82 + rmpy_83
        sub_85 = add_84 - in_preview_5
        add_86 = in_speed + free_6
        rmpy_87 = c_step_response_6 * state_notch + 134217728 >> 28
        add_88 = add_86 + rmpy_87
        sub_89 = add_88 - in_preview_6
        add_90 = in_speed + free_7
        rmpy_91 = c_step_response_7 * state_notch + 134217728 >> 28
        add_92 = add_90 + rmpy_91
        sub_93 = add_92 - in_preview_7
        add_94 = in_speed + free_8
        rmpy_95 = c_step_response_8 * state_notch + 134217728 >> 28
        add_96 = add_94 + rmpy_95
        sub_97 = add_96 - in_preview_8
        add_98 = in_speed + free_9
        rmpy_99 = c_step_response_9 * state_notch + 134217728 >> 28
        add_100 = add_98 + rmpy_99
        sub_101 = add_100 - in_preview_9
        minimum_102 = sub_69 if sub_69 < sub_65 else sub_65
        maximum_103 = sub_69 if sub_69 > sub_65 else sub_65
        minimum_104 = sub_73 if sub_73 < minimum_102 else minimum_102
        maximum_105 = sub_73 if sub_73 > maximum_103 else maximum_103
        minimum_106 = sub_77 if sub_77 < minimum_104 else minimum_104
        maximum_107 = sub_77 if sub_77 > maximum_105 else maximum_105
        minimum_108 = sub_81 if sub_81 < minimum_106 else minimum_106
        maximum_109 = sub_81 if sub_81 > maximum_107 else maximum_107
        minimum_110 = sub_85 if sub_85 < minimum_108 else minimum_108
        maximum_111 = sub_85 if sub_85 > maximum_109 else maximum_109
        minimum_112 = sub_89 if sub_89 < minimum_110 else minimum_110
        maximum_113 = sub_89 if sub_89 > maximum_111 else maximum_111
        minimum_114 = sub_93 if sub_93 < minimum_112 else minimum_112
        maximum_115 = sub_93 if sub_93 > maximum_113 else maximum_113
        minimum_116 = sub_97 if sub_97 < minimum_114 else minimum_114
        maximum_117 = sub_97 if sub_97 > maximum_115 else maximum_115
        miss_low = sub_101 if sub_101 < minimum_116 else minimum_116
        miss_high = sub_101 if sub_101 > maximum_117 else maximum_117
        sub_120 = miss_low - c_speed_window_0
        clip_121 = sub_120 if sub_120 < c_zero else c_zero
        if clip_121 < c_minus_speed_widths_0:
            clip_121 = c_minus_speed_widths_0
        sub_122 = miss_high - c_speed_window_1
        clip_123 = sub_122 if sub_122 < c_speed_widths_1 else c_speed_widths_1
        if clip_123 < c_zero:
            clip_123 = c_zero
        rmpy_124 = clip_121 * c_speed_slopes_0 + 32768 >> 16
        add_125 = c_one_satisfaction + rmpy_124
        rmpy_126 = clip_123 * c_speed_slopes_1 + 32768 >> 16
        sub_127 = c_one_satisfaction - rmpy_126
        minimum_128 = sub_127 if sub_127 < add_125 else add_125
        mu_y = minimum_128 if minimum_128 < c_one_satisfaction else c_one_satisfaction
        if mu_y < c_zero:
            mu_y = c_zero
        mu = mu_y if mu_y < mu_ts else mu_ts
        cell = min(mu >> 16, 255)
        alpha = f_softening[cell]
        alpha += (f_softening[cell + 1] - alpha) * (mu - (cell << 16)) >> 16
        rmpy_132 = alpha * alpha + 536870912 >> 30
        rmpy_133 = rmpy_132 * alpha + 536870912 >> 30
        rmpy_134 = rmpy_133 * alpha + 536870912 >> 30
        rmpy_135 = rmpy_134 * alpha + 536870912 >> 30
        rmpy_136 = rmpy_135 * alpha + 536870912 >> 30
        rmpy_137 = rmpy_136 * alpha + 536870912 >> 30
        rmpy_138 = rmpy_137 * alpha + 536870912 >> 30
        rmpy_139 = rmpy_138 * alpha + 536870912 >> 30
        sub_140 = c_one_softening - rmpy_133
        sub_141 = c_one_softening - rmpy_135
        sub_142 = c_one_softening - rmpy_138
        sub_143 = c_one_softening - rmpy_139
        sub_144 = in_preview_0 - in_set_point
        sub_145 = in_preview_1 - in_set_point
        sub_146 = in_preview_2 - in_set_point
        sub_147 = in_preview_3 - in_set_point
        sub_148 = in_preview_4 - in_set_point
        sub_149 = in_preview_5 - in_set_point
        sub_150 = in_preview_6 - in_set_point
        sub_151 = in_preview_7 - in_set_point
        sub_152 = in_preview_8 - in_set_point
        sub_153 = in_preview_9 - in_set_point
        if not c_minus_rise_max <= sub_144 <= c_rise_max:
            return None
        sat_154 = sub_144
        if not c_minus_rise_max <= sub_145 <= c_rise_max:
            return None
        sat_155 = sub_145
        if not c_minus_rise_max <= sub_146 <= c_rise_max:
            return None
        sat_156 = sub_146
        if not c_minus_rise_max <= sub_147 <= c_rise_max:
            return None
        sat_157 = sub_147
        if not c_minus_rise_max <= sub_148 <= c_rise_max:
            return None
        sat_158 = sub_148
        if not c_minus_rise_max <= sub_149 <= c_rise_max:
            return None
        sat_159 = sub_149
        if not c_minus_rise_max <= sub_150 <= c_rise_max:
            return None
        sat_160 = sub_150
        if not c_minus_rise_max <= sub_151 <= c_rise_max:
            return None
        sat_161 = sub_151
        if not c_minus_rise_max <= sub_152 <= c_rise_max:
            return None
        sat_162 = sub_152
        if not c_minus_rise_max <= sub_153 <= c_rise_max:
            return None
        sat_163 = sub_153
        c_0 = c_set_point_fit_0_0 * sat_154 + 1048576 >> 21
        c_0 += c_set_point_fit_0_1 * sat_155 + 1048576 >> 21
        c_0 += c_set_point_fit_0_2 * sat_156 + 1048576 >> 21
        c_0 += c_set_point_fit_0_3 * sat_157 + 1048576 >> 21
        c_0 += c_set_point_fit_0_4 * sat_158 + 1048576 >> 21
        c_0 += c_set_point_fit_0_5 * sat_159 + 1048576 >> 21
        c_0 += c_set_point_fit_0_6 * sat_160 + 1048576 >> 21
        c_0 += c_set_point_fit_0_7 * sat_161 + 1048576 >> 21
        c_0 += c_set_point_fit_0_8 * sat_162 + 1048576 >> 21
        c_0 += c_set_point_fit_0_9 * sat_163 + 1048576 >> 21
        c_1 = c_set_point_fit_1_0 * sat_154 + 1048576 >> 21
        c_1 += c_set_point_fit_1_1 * sat_155 + 1048576 >> 21
        c_1 += c_set_point_fit_1_2 * sat_156 + 1048576 >> 21
        c_1 += c_set_point_fit_1_3 * sat_157 + 1048576 >> 21
        c_1 += c_set_point_fit_1_4 * sat_158 + 1048576 >> 21
        c_1 += c_set_point_fit_1_5 * sat_159 + 1048576 >> 21
        c_1 += c_set_point_fit_1_6 * sat_160 + 1048576 >> 21
        c_1 += c_set_point_fit_1_7 * sat_161 + 1048576 >> 21
        c_1 += c_set_point_fit_1_8 * sat_162 + 1048576 >> 21
        c_1 += c_set_point_fit_1_9 * sat_163 + 1048576 >> 21
        sub_166 = state_model_errors_1 - model_error
        sub_167 = state_model_errors_2 - model_error
        sub_168 = state_model_errors_3 - model_error
        sub_169 = state_model_errors_4 - model_error
        sub_170 = state_model_errors_5 - model_error
        sub_171 = state_model_errors_6 - model_error
        sub_172 = state_model_errors_7 - model_error
        if not c_minus_rise_max <= sub_166 <= c_rise_max:
            return None
        error_rise_0 = sub_166
        if not c_minus_rise_max <= sub_167 <= c_rise_max:
            return None
        error_rise_1 = sub_167
        if not c_minus_rise_max <= sub_168 <= c_rise_max:
            return None
        error_rise_2 = sub_168
        if not c_minus_rise_max <= sub_169 <= c_rise_max:
            return None
        error_rise_3 = sub_169
        if not c_minus_rise_max <= sub_170 <= c_rise_max:
            return None
        error_rise_4 = sub_170
        if not c_minus_rise_max <= sub_171 <= c_rise_max:
            return None
        error_rise_5 = sub_171
        if not c_minus_rise_max <= sub_172 <= c_rise_max:
            return None
        error_rise_6 = sub_172
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
        sub_182 = c_0 - e_0
        sub_183 = c_1 - e_1
        rmpy_184 = sub_140 * tracking_error + 536870912 >> 30
        sub_185 = rmpy_184 - free_2
        convert_186 = sub_185 >> 1
        rmpy_187 = sub_182 * c_point_powers_0_0 + 8 >> 4
        add_188 = convert_186 + rmpy_187
        rmpy_189 = sub_183 * c_point_powers_0_1 + 8 >> 4
        add_190 = add_188 + rmpy_189
        if not c_minus_deviation_max <= add_190 <= c_deviation_max:
            return None
        d_0 = add_190
        rmpy_192 = sub_141 * tracking_error + 536870912 >> 30
        sub_193 = rmpy_192 - free_4
        convert_194 = sub_193 >> 1
        rmpy_195 = sub_182 * c_point_powers_1_0 + 8 >> 4
        add_196 = convert_194 + rmpy_195
        rmpy_197 = sub_183 * c_point_powers_1_1 + 8 >> 4
        add_198 = add_196 + rmpy_197
        if not c_minus_deviation_max <= add_198 <= c_deviation_max:
            return None
        d_1 = add_198
        rmpy_200 = sub_142 * tracking_error + 536870912 >> 30
        sub_201 = rmpy_200 - free_7
        convert_202 = sub_201 >> 1
        rmpy_203 = sub_182 * c_point_powers_2_0 + 8 >> 4
        add_204 = convert_202 + rmpy_203
        rmpy_205 = sub_183 * c_point_powers_2_1 + 8 >> 4
        add_206 = add_204 + rmpy_205
        if not c_minus_deviation_max <= add_206 <= c_deviation_max:
            return None
        d_2 = add_206
        rmpy_208 = sub_143 * tracking_error + 536870912 >> 30
        sub_209 = rmpy_208 - free_8
        convert_210 = sub_209 >> 1
        rmpy_211 = sub_182 * c_point_powers_3_0 + 8 >> 4
        add_212 = convert_210 + rmpy_211
        rmpy_213 = sub_183 * c_point_powers_3_1 + 8 >> 4
        add_214 = add_212 + rmpy_213
        if not c_minus_deviation_max <= add_214 <= c_deviation_max:
            return None
        d_3 = add_214
        sub_216 = in_preview_9 - in_set_point
        change = abs(sub_216)
        gt_218 = change > c_wavelet_change
        where_219 = c_gains_wavelet_0 if gt_218 else c_gains_step_0
        where_220 = c_gains_wavelet_1 if gt_218 else c_gains_step_1
        where_221 = c_gains_wavelet_2 if gt_218 else c_gains_step_2
        where_222 = c_gains_wavelet_3 if gt_218 else c_gains_step_3
        where_223 = c_basis_1 if gt_218 else c_basis_0
        notch_raw = where_219 * d_0 + 8388608 >> 24
        notch_raw += where_220 * d_1 + 8388608 >> 24
        notch_raw += where_221 * d_2 + 8388608 >> 24
        notch_raw += where_222 * d_3 + 8388608 >> 24
        clip_225 = notch_raw if notch_raw < c_notch_max else c_notch_max
        if clip_225 < c_minus_notch_max:
            clip_225 = c_minus_notch_max
        notch = clip_225 + 1024 >> 11
        convert_227 = notch << 16
        return (
            (
                model_0,
                model_1,
                convert_227,
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
                where_223,
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
    (
        low_speed_01mmps,
        high_speed_01mmps,
        low_position_01mm,
        high_position_01mm,
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            k,
            speed_01mmps,
            position_01mm,
        ) = given
        if not low_speed_01mmps <= speed_01mmps <= high_speed_01mmps:
            return None
        if not low_position_01mm <= position_01mm <= high_position_01mm:
            return None
        speed = speed_01mmps * c_kmh_per_01mmps >> 20
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
        sub_19 = at_18 - at_17
        maximum_20 = c_one_01mm if c_one_01mm > sub_19 else sub_19
        sub_21 = position_01mm - at_17
        if c_zero > maximum_20:
            return None
        clip_22 = sub_21 if sub_21 < maximum_20 else maximum_20
        if clip_22 < c_zero:
            clip_22 = c_zero
        div_23 = div(clip_22, maximum_20, 20)
        minimum_24 = c_one if c_one < div_23 else div_23
        at_25 = t_v_of_x[locate_16]
        at_26 = t_v_of_x[locate_16 + 1]
        sub_27 = at_26 - at_25
        rmpy_28 = sub_27 * minimum_24 + 524288 >> 20
        add_29 = at_25 + rmpy_28
        at_30 = t_v_of_x[locate_16 + 16]
        at_31 = t_v_of_x[locate_16 + 17]
        sub_32 = at_31 - at_30
        rmpy_33 = sub_32 * minimum_24 + 524288 >> 20
        add_34 = at_30 + rmpy_33
        at_35 = t_v_of_x[locate_16 + 32]
        at_36 = t_v_of_x[locate_16 + 33]
        sub_37 = at_36 - at_35
        rmpy_38 = sub_37 * minimum_24 + 524288 >> 20
        add_39 = at_35 + rmpy_38
        at_40 = t_v_of_x[locate_16 + 48]
        at_41 = t_v_of_x[locate_16 + 49]
        sub_42 = at_41 - at_40
        rmpy_43 = sub_42 * minimum_24 + 524288 >> 20
        add_44 = at_40 + rmpy_43
        at_45 = t_v_of_x[locate_16 + 64]
        at_46 = t_v_of_x[locate_16 + 65]
        sub_47 = at_46 - at_45
        rmpy_48 = sub_47 * minimum_24 + 524288 >> 20
        add_49 = at_45 + rmpy_48
        at_50 = t_v_of_x[locate_16 + 80]
        at_51 = t_v_of_x[locate_16 + 81]
        sub_52 = at_51 - at_50
        rmpy_53 = sub_52 * minimum_24 + 524288 >> 20
        add_54 = at_50 + rmpy_53
        at_55 = t_v_of_x[locate_16 + 96]
        at_56 = t_v_of_x[locate_16 + 97]
        sub_57 = at_56 - at_55
        rmpy_58 = sub_57 * minimum_24 + 524288 >> 20
        add_59 = at_55 + rmpy_58
        at_60 = t_v_of_x[locate_16 + 112]
        at_61 = t_v_of_x[locate_16 + 113]
        sub_62 = at_61 - at_60
        rmpy_63 = sub_62 * minimum_24 + 524288 >> 20
        add_64 = at_60 + rmpy_63
        at_65 = t_v_of_x[locate_16 + 128]
        at_66 = t_v_of_x[locate_16 + 129]
        sub_67 = at_66 - at_65
        rmpy_68 = sub_67 * minimum_24 + 524288 >> 20
        add_69 = at_65 + rmpy_68
        at_70 = t_v_of_x[locate_16 + 144]
        at_71 = t_v_of_x[locate_16 + 145]
        sub_72 = at_71 - at_70
        rmpy_73 = sub_72 * minimum_24 + 524288 >> 20
        add_74 = at_70 + rmpy_73
        at_75 = t_v_of_x[locate_16 + 160]
        at_76 = t_v_of_x[locate_16 + 161]
        sub_77 = at_76 - at_75
        rmpy_78 = sub_77 * minimum_24 + 524288 >> 20
        add_79 = at_75 + rmpy_78
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
