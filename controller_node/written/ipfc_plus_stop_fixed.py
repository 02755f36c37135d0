"""Law ipfc_plus_stop in fixed point. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from railhil.controller_node.written.parts import Parts, Step, Values


def step(parts: Parts) -> Step:
    (
        c_odometer_max,
        c_zero,
        c_per_distance,
        c_wheel_max,
        c_minus_wheel_max,
        c_sum_max,
        c_minus_sum_max,
        c_balise_slack,
        c_bound_max,
        c_minus_bound_max,
        c_share_min,
        c_tolerance,
        c_minus_wheel_max_2,
        c_half,
        c_lagged_0,
        c_lagged_1,
        c_lagged_2,
        c_integral_0,
        c_integral_1,
        c_integral_2,
        c_period,
        c_standstill,
        c_innovation_max,
        c_minus_innovation_max,
        c_speed_max,
        c_minus_speed_max,
        c_disturbance_max,
        c_minus_disturbance_max,
        c_gain_max,
        c_gain_min,
        c_lag_max,
        c_minus_lag_max,
        c_delay_lagged_0,
        c_delay_lagged_1,
        c_delay_integral_0,
        c_delay_integral_1,
        c_pole,
        c_delay,
        c_advance,
        c_gap_max,
        c_minus_gap_max,
        c_position_error_max,
        c_minus_position_error_max,
        c_speed_error_max,
        c_minus_speed_error_max,
        c_by_force,
        c_capture_position,
        c_minus_capture_position,
        c_capture_speed,
        c_minus_capture_speed,
        c_correction_max,
        c_minus_correction_max,
        c_basis,
        c_one_softening,
    ) = parts.constants
    (
        t_target_position,
        t_target_speed,
        t_feed_forward,
        t_planned_force,
        t_force_rate,
        t_notch_upper,
        t_notch_lower,
        t_drag_over_period,
        t_drag_over_delay,
        t_observe_speed,
        t_observe_disturbance,
        t_observe_gain,
        t_observe_lag,
        t_by_position,
        t_by_speed,
        t_ending,
        t_stop_by_position,
        t_stop_by_speed,
        t_stop_by_force,
    ) = parts.tables
    (last_0,) = parts.lasts
    div = parts.number.div
    (
        low_plus_observer_speed,
        high_plus_observer_speed,
        low_plus_observer_disturbance,
        high_plus_observer_disturbance,
        low_plus_observer_gain,
        high_plus_observer_gain,
        low_plus_observer_lag,
        high_plus_observer_lag,
        low_plus_observer_lagged,
        high_plus_observer_lagged,
        low_plus_notch,
        high_plus_notch,
        low_plus_notch_before,
        high_plus_notch_before,
        low_plus_balises_number,
        high_plus_balises_number,
        low_plus_balises_squares,
        high_plus_balises_squares,
        low_plus_balises_errors,
        high_plus_balises_errors,
        low_wheel_low,
        high_wheel_low,
        low_wheel_high,
        high_wheel_high,
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_plus_observer_speed,
            state_plus_observer_disturbance,
            state_plus_observer_gain,
            state_plus_observer_lag,
            state_plus_observer_lagged,
            state_plus_notch,
            state_plus_notch_before,
            state_plus_balises_number,
            state_plus_balises_squares,
            state_plus_balises_errors,
            state_wheel_low,
            state_wheel_high,
        ) = state
        (
            in_speed,
            _in_set_point,
            in_track_k,
            in_track_position_01mm,
            in_track_balise_number,
            in_track_balise_position_01mm,
            in_track_balise_odometer_01mm,
        ) = given
        if not low_plus_observer_speed <= state_plus_observer_speed <= high_plus_observer_speed:
            return None
        if not low_plus_observer_disturbance <= state_plus_observer_disturbance <= high_plus_observer_disturbance:
            return None
        if not low_plus_observer_gain <= state_plus_observer_gain <= high_plus_observer_gain:
            return None
        if not low_plus_observer_lag <= state_plus_observer_lag <= high_plus_observer_lag:
            return None
        if not low_plus_observer_lagged <= state_plus_observer_lagged <= high_plus_observer_lagged:
            return None
        if not low_plus_notch <= state_plus_notch <= high_plus_notch:
            return None
        if not low_plus_notch_before <= state_plus_notch_before <= high_plus_notch_before:
            return None
        if not low_plus_balises_number <= state_plus_balises_number <= high_plus_balises_number:
            return None
        if not low_plus_balises_squares <= state_plus_balises_squares <= high_plus_balises_squares:
            return None
        if not low_plus_balises_errors <= state_plus_balises_errors <= high_plus_balises_errors:
            return None
        if not low_wheel_low <= state_wheel_low <= high_wheel_low:
            return None
        if not low_wheel_high <= state_wheel_high <= high_wheel_high:
            return None
        index_19 = min(max(in_track_k, 0), last_0)
        at_20 = t_target_position[index_19]
        at_21 = t_target_speed[index_19]
        at_22 = t_feed_forward[index_19]
        at_23 = t_planned_force[index_19]
        at_24 = t_force_rate[index_19]
        at_25 = t_notch_upper[index_19]
        at_26 = t_notch_lower[index_19]
        at_27 = t_drag_over_period[index_19]
        at_28 = t_drag_over_delay[index_19]
        at_29 = t_observe_speed[index_19]
        at_30 = t_observe_disturbance[index_19]
        at_31 = t_observe_gain[index_19]
        at_32 = t_observe_lag[index_19]
        at_33 = t_by_position[index_19]
        at_34 = t_by_speed[index_19]
        at_35 = t_ending[index_19]
        at_36 = t_stop_by_position[index_19]
        at_37 = t_stop_by_speed[index_19]
        at_38 = t_stop_by_force[index_19]
        clip_39 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_39 < c_zero:
            clip_39 = c_zero
        clip_40 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_40 < c_zero:
            clip_40 = c_zero
        rmpy_41 = clip_40 * c_per_distance + 33554432 >> 26
        sub_42 = clip_39 - clip_40
        rmpy_43 = sub_42 * c_per_distance + 8388608 >> 24
        rmpy_44 = rmpy_41 * rmpy_41 + 536870912 >> 30
        add_45 = state_plus_balises_squares + rmpy_44
        clip_46 = rmpy_43 if rmpy_43 < c_wheel_max else c_wheel_max
        if clip_46 < c_minus_wheel_max:
            clip_46 = c_minus_wheel_max
        rmpy_47 = rmpy_41 * clip_46 + 2147483648 >> 32
        add_48 = state_plus_balises_errors + rmpy_47
        clip_49 = add_48 if add_48 < c_sum_max else c_sum_max
        if clip_49 < c_minus_sum_max:
            clip_49 = c_minus_sum_max
        sub_50 = in_track_balise_number - state_plus_balises_number
        abs_51 = abs(sub_50)
        gt_52 = abs_51 > c_zero
        rmpy_53 = rmpy_41 * c_wheel_max + 134217728 >> 28
        add_54 = rmpy_53 + c_balise_slack
        abs_55 = abs(rmpy_43)
        gt_56 = add_54 > abs_55
        gt_57 = c_sum_max > add_45
        where_58 = add_45 if gt_57 else state_plus_balises_squares
        where_59 = where_58 if gt_56 else state_plus_balises_squares
        balise_squares = where_59 if gt_52 else state_plus_balises_squares
        where_61 = clip_49 if gt_57 else state_plus_balises_errors
        where_62 = where_61 if gt_56 else state_plus_balises_errors
        balise_errors = where_62 if gt_52 else state_plus_balises_errors
        div_64 = div(balise_errors, balise_squares, 30)
        wheel = div_64 if div_64 < c_wheel_max else c_wheel_max
        if wheel < c_minus_wheel_max:
            wheel = c_minus_wheel_max
        clip_66 = in_track_position_01mm if in_track_position_01mm < c_odometer_max else c_odometer_max
        if clip_66 < c_zero:
            clip_66 = c_zero
        correction = clip_66 * wheel + 8388608 >> 24
        clip_68 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_68 < c_zero:
            clip_68 = c_zero
        clip_69 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_69 < c_zero:
            clip_69 = c_zero
        rmpy_70 = clip_69 * c_per_distance + 33554432 >> 26
        sub_71 = clip_68 - clip_69
        rmpy_72 = sub_71 * c_per_distance + 8388608 >> 24
        clip_73 = rmpy_72 if rmpy_72 < c_bound_max else c_bound_max
        if clip_73 < c_minus_bound_max:
            clip_73 = c_minus_bound_max
        maximum_74 = c_share_min if c_share_min > rmpy_70 else rmpy_70
        convert_75 = maximum_74 << 2
        sub_76 = clip_73 - c_tolerance
        div_77 = div(sub_76, convert_75, 30)
        add_78 = clip_73 + c_tolerance
        div_79 = div(add_78, convert_75, 30)
        gt_80 = balise_squares > state_plus_balises_squares
        gt_81 = rmpy_70 > c_share_min
        maximum_82 = state_wheel_low if state_wheel_low > div_77 else div_77
        clip_83 = maximum_82 if maximum_82 < c_wheel_max else c_wheel_max
        if clip_83 < c_minus_wheel_max_2:
            clip_83 = c_minus_wheel_max_2
        where_84 = clip_83 if gt_81 else state_wheel_low
        wheel_low = where_84 if gt_80 else state_wheel_low
        minimum_86 = state_wheel_high if state_wheel_high < div_79 else div_79
        clip_87 = minimum_86 if minimum_86 < c_wheel_max else c_wheel_max
        if clip_87 < c_minus_wheel_max_2:
            clip_87 = c_minus_wheel_max_2
        where_88 = clip_87 if gt_81 else state_wheel_high
        wheel_high = where_88 if gt_80 else state_wheel_high
        add_90 = wheel_low + wheel_high
        rmpy_91 = add_90 * c_half + 8388608 >> 24
        gt_92 = wheel_low > wheel_high
        wheel_bounded = wheel if gt_92 else rmpy_91
        place_correction = clip_66 * wheel_bounded + 8388608 >> 24
        lagged = c_lagged_0 * state_plus_observer_lagged + 8388608 >> 24
        lagged += c_lagged_1 * state_plus_notch_before + 8388608 >> 24
        lagged += c_lagged_2 * state_plus_notch + 8388608 >> 24
        dot_96 = c_integral_0 * state_plus_observer_lagged + 8388608 >> 24
        dot_96 += c_integral_1 * state_plus_notch_before + 8388608 >> 24
        dot_96 += c_integral_2 * state_plus_notch + 8388608 >> 24
        sub_97 = lagged - state_plus_observer_lagged
        rmpy_98 = state_plus_observer_lag * sub_97 + 8388608 >> 24
        sub_99 = dot_96 - rmpy_98
        rmpy_100 = state_plus_observer_gain * sub_99 + 33554432 >> 26
        add_101 = state_plus_observer_speed + rmpy_100
        rmpy_102 = state_plus_observer_disturbance * c_period + 33554432 >> 26
        add_103 = add_101 + rmpy_102
        sub_104 = add_103 - at_27
        gt_105 = in_speed > c_zero
        gt_106 = sub_104 > c_standstill
        where_107 = sub_104 if gt_106 else c_zero
        expected = sub_104 if gt_105 else where_107
        sub_109 = in_speed - expected
        clip_110 = sub_109 if sub_109 < c_innovation_max else c_innovation_max
        if clip_110 < c_minus_innovation_max:
            clip_110 = c_minus_innovation_max
        surprise = clip_110 if gt_105 else c_zero
        rmpy_112 = surprise * at_29 + 8388608 >> 24
        add_113 = expected + rmpy_112
        observed_speed = add_113 if add_113 < c_speed_max else c_speed_max
        if observed_speed < c_minus_speed_max:
            observed_speed = c_minus_speed_max
        rmpy_115 = surprise * at_30 + 2097152 >> 22
        add_116 = state_plus_observer_disturbance + rmpy_115
        disturbance = add_116 if add_116 < c_disturbance_max else c_disturbance_max
        if disturbance < c_minus_disturbance_max:
            disturbance = c_minus_disturbance_max
        rmpy_118 = surprise * at_31 + 2097152 >> 22
        add_119 = state_plus_observer_gain + rmpy_118
        gain = add_119 if add_119 < c_gain_max else c_gain_max
        if gain < c_gain_min:
            gain = c_gain_min
        rmpy_121 = surprise * at_32 + 524288 >> 20
        add_122 = state_plus_observer_lag + rmpy_121
        lag = add_122 if add_122 < c_lag_max else c_lag_max
        if lag < c_minus_lag_max:
            lag = c_minus_lag_max
        dot_124 = c_delay_lagged_0 * lagged + 8388608 >> 24
        dot_124 += c_delay_lagged_1 * state_plus_notch + 8388608 >> 24
        dot_125 = c_delay_integral_0 * lagged + 8388608 >> 24
        dot_125 += c_delay_integral_1 * state_plus_notch + 8388608 >> 24
        sub_126 = state_plus_notch - dot_124
        rmpy_127 = sub_126 * c_pole + 8388608 >> 24
        rmpy_128 = lag * rmpy_127 + 8388608 >> 24
        sub_129 = dot_124 - rmpy_128
        force = gain * sub_129 + 8388608 >> 24
        sub_131 = dot_124 - lagged
        rmpy_132 = lag * sub_131 + 8388608 >> 24
        sub_133 = dot_125 - rmpy_132
        rmpy_134 = gain * sub_133 + 33554432 >> 26
        add_135 = observed_speed + rmpy_134
        rmpy_136 = disturbance * c_delay + 33554432 >> 26
        add_137 = add_135 + rmpy_136
        sub_138 = add_137 - at_28
        rmpy_139 = sub_138 * wheel_bounded + 536870912 >> 30
        speed_ahead = sub_138 + rmpy_139
        add_141 = observed_speed + speed_ahead
        rmpy_142 = add_141 * c_advance + 536870912 >> 30
        sub_143 = at_20 - clip_66
        clip_144 = sub_143 if sub_143 < c_gap_max else c_gap_max
        if clip_144 < c_minus_gap_max:
            clip_144 = c_minus_gap_max
        convert_145 = clip_144 << 6
        add_146 = place_correction + rmpy_142
        sub_147 = convert_145 - add_146
        position_error = sub_147 if sub_147 < c_position_error_max else c_position_error_max
        if position_error < c_minus_position_error_max:
            position_error = c_minus_position_error_max
        sub_149 = at_21 - speed_ahead
        speed_error = sub_149 if sub_149 < c_speed_error_max else c_speed_error_max
        if speed_error < c_minus_speed_error_max:
            speed_error = c_minus_speed_error_max
        rmpy_151 = at_23 * wheel_bounded + 536870912 >> 30
        sub_152 = at_23 - rmpy_151
        sub_153 = sub_152 - disturbance
        sub_154 = sub_153 - force
        rmpy_155 = position_error * at_33 + 8388608 >> 24
        rmpy_156 = speed_error * at_34 + 2097152 >> 22
        add_157 = rmpy_155 + rmpy_156
        rmpy_158 = sub_154 * c_by_force + 8388608 >> 24
        add_159 = add_157 + rmpy_158
        clip_160 = position_error if position_error < c_capture_position else c_capture_position
        if clip_160 < c_minus_capture_position:
            clip_160 = c_minus_capture_position
        clip_161 = speed_error if speed_error < c_capture_speed else c_capture_speed
        if clip_161 < c_minus_capture_speed:
            clip_161 = c_minus_capture_speed
        rmpy_162 = clip_160 * at_36 + 524288 >> 20
        rmpy_163 = clip_161 * at_37 + 2097152 >> 22
        add_164 = rmpy_162 + rmpy_163
        rmpy_165 = sub_154 * at_38 + 8388608 >> 24
        add_166 = add_164 + rmpy_165
        stop_correction = add_166 if add_166 < c_correction_max else c_correction_max
        if stop_correction < c_minus_correction_max:
            stop_correction = c_minus_correction_max
        sub_168 = position_error - clip_160
        abs_169 = abs(sub_168)
        sub_170 = speed_error - clip_161
        abs_171 = abs(sub_170)
        gt_172 = abs_169 > c_zero
        gt_173 = abs_171 > c_zero
        where_174 = add_159 if gt_173 else stop_correction
        where_175 = add_159 if gt_172 else where_174
        gt_176 = at_35 > c_zero
        where_177 = where_175 if gt_176 else add_159
        rmpy_178 = at_24 * lag + 8388608 >> 24
        add_179 = at_22 + rmpy_178
        rmpy_180 = add_179 * wheel_bounded + 536870912 >> 30
        sub_181 = add_179 - rmpy_180
        sub_182 = sub_181 - disturbance
        accel = sub_182 + where_177
        notch_raw = div(accel, gain, 19)
        if at_26 > at_25:
            return None
        clip_185 = notch_raw if notch_raw < at_25 else at_25
        if clip_185 < at_26:
            clip_185 = at_26
        notch = clip_185 + 1024 >> 11
        convert_187 = notch << 16
        return (
            (
                observed_speed,
                disturbance,
                gain,
                lag,
                lagged,
                convert_187,
                state_plus_notch,
                in_track_balise_number,
                balise_squares,
                balise_errors,
                wheel_low,
                wheel_high,
            ),
            (
                notch_raw,
                notch,
                c_basis,
                c_one_softening,
            ),
            (
                balise_squares,
                balise_errors,
                wheel,
                correction,
                wheel_low,
                wheel_high,
                wheel_bounded,
                place_correction,
                lagged,
                expected,
                surprise,
                observed_speed,
                disturbance,
                gain,
                lag,
                force,
                speed_ahead,
                position_error,
                speed_error,
                stop_correction,
                accel,
                notch_raw,
                notch,
            ),
        )

    return period


def step_1(parts: Parts) -> Step:
    (
        c_odometer_max,
        c_zero,
        c_per_distance,
        c_wheel_max,
        c_minus_wheel_max,
        c_sum_max,
        c_minus_sum_max,
        c_balise_slack,
        c_bound_max,
        c_minus_bound_max,
        c_share_min,
        c_tolerance,
        c_minus_wheel_max_2,
        c_half,
        c_lagged_0,
        c_lagged_1,
        c_lagged_2,
        c_integral_0,
        c_integral_1,
        c_integral_2,
        c_period,
        c_standstill,
        c_innovation_max,
        c_minus_innovation_max,
        c_speed_max,
        c_minus_speed_max,
        c_disturbance_max,
        c_minus_disturbance_max,
        c_gain_max,
        c_gain_min,
        c_lag_max,
        c_minus_lag_max,
        c_delay_lagged_0,
        c_delay_lagged_1,
        c_delay_integral_0,
        c_delay_integral_1,
        c_pole,
        c_delay,
        c_advance,
        c_gap_max,
        c_minus_gap_max,
        c_position_error_max,
        c_minus_position_error_max,
        c_speed_error_max,
        c_minus_speed_error_max,
        c_by_force,
        c_capture_position,
        c_minus_capture_position,
        c_capture_speed,
        c_minus_capture_speed,
        c_correction_max,
        c_minus_correction_max,
        c_basis,
        c_one_softening,
    ) = parts.constants
    (
        t_target_position,
        t_target_speed,
        t_feed_forward,
        t_planned_force,
        t_force_rate,
        t_notch_upper,
        t_notch_lower,
        t_drag_over_period,
        t_drag_over_delay,
        t_observe_speed,
        t_observe_disturbance,
        t_observe_gain,
        t_observe_lag,
        t_by_position,
        t_by_speed,
        t_ending,
        t_stop_by_position,
        t_stop_by_speed,
        t_stop_by_force,
    ) = parts.tables
    (last_0,) = parts.lasts
    div = parts.number.div
    (
        low_plus_observer_speed,
        high_plus_observer_speed,
        low_plus_observer_disturbance,
        high_plus_observer_disturbance,
        low_plus_observer_gain,
        high_plus_observer_gain,
        low_plus_observer_lag,
        high_plus_observer_lag,
        low_plus_observer_lagged,
        high_plus_observer_lagged,
        low_plus_notch,
        high_plus_notch,
        low_plus_notch_before,
        high_plus_notch_before,
        low_plus_balises_number,
        high_plus_balises_number,
        low_plus_balises_squares,
        high_plus_balises_squares,
        low_plus_balises_errors,
        high_plus_balises_errors,
        low_wheel_low,
        high_wheel_low,
        low_wheel_high,
        high_wheel_high,
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_plus_observer_speed,
            state_plus_observer_disturbance,
            state_plus_observer_gain,
            state_plus_observer_lag,
            state_plus_observer_lagged,
            state_plus_notch,
            state_plus_notch_before,
            state_plus_balises_number,
            state_plus_balises_squares,
            state_plus_balises_errors,
            state_wheel_low,
            state_wheel_high,
        ) = state
        (
            in_speed,
            _in_set_point,
            in_track_k,
            in_track_position_01mm,
            in_track_balise_number,
            in_track_balise_position_01mm,
            in_track_balise_odometer_01mm,
        ) = given
        if not low_plus_observer_speed <= state_plus_observer_speed <= high_plus_observer_speed:
            return None
        if not low_plus_observer_disturbance <= state_plus_observer_disturbance <= high_plus_observer_disturbance:
            return None
        if not low_plus_observer_gain <= state_plus_observer_gain <= high_plus_observer_gain:
            return None
        if not low_plus_observer_lag <= state_plus_observer_lag <= high_plus_observer_lag:
            return None
        if not low_plus_observer_lagged <= state_plus_observer_lagged <= high_plus_observer_lagged:
            return None
        if not low_plus_notch <= state_plus_notch <= high_plus_notch:
            return None
        if not low_plus_notch_before <= state_plus_notch_before <= high_plus_notch_before:
            return None
        if not low_plus_balises_number <= state_plus_balises_number <= high_plus_balises_number:
            return None
        if not low_plus_balises_squares <= state_plus_balises_squares <= high_plus_balises_squares:
            return None
        if not low_plus_balises_errors <= state_plus_balises_errors <= high_plus_balises_errors:
            return None
        if not low_wheel_low <= state_wheel_low <= high_wheel_low:
            return None
        if not low_wheel_high <= state_wheel_high <= high_wheel_high:
            return None
        index_19 = min(max(in_track_k, 0), last_0)
        at_20 = t_target_position[index_19]
        at_21 = t_target_speed[index_19]
        at_22 = t_feed_forward[index_19]
        at_23 = t_planned_force[index_19]
        at_24 = t_force_rate[index_19]
        at_25 = t_notch_upper[index_19]
        at_26 = t_notch_lower[index_19]
        at_27 = t_drag_over_period[index_19]
        at_28 = t_drag_over_delay[index_19]
        at_29 = t_observe_speed[index_19]
        at_30 = t_observe_disturbance[index_19]
        at_31 = t_observe_gain[index_19]
        at_32 = t_observe_lag[index_19]
        at_33 = t_by_position[index_19]
        at_34 = t_by_speed[index_19]
        at_35 = t_ending[index_19]
        at_36 = t_stop_by_position[index_19]
        at_37 = t_stop_by_speed[index_19]
        at_38 = t_stop_by_force[index_19]
        clip_39 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_39 < c_zero:
            clip_39 = c_zero
        clip_40 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_40 < c_zero:
            clip_40 = c_zero
        rmpy_41 = clip_40 * c_per_distance + 16777216 >> 25
        sub_42 = clip_39 - clip_40
        rmpy_43 = sub_42 * c_per_distance + 4194304 >> 23
        rmpy_44 = rmpy_41 * rmpy_41 + 536870912 >> 30
        add_45 = state_plus_balises_squares + rmpy_44
        clip_46 = rmpy_43 if rmpy_43 < c_wheel_max else c_wheel_max
        if clip_46 < c_minus_wheel_max:
            clip_46 = c_minus_wheel_max
        rmpy_47 = rmpy_41 * clip_46 + 2147483648 >> 32
        add_48 = state_plus_balises_errors + rmpy_47
        clip_49 = add_48 if add_48 < c_sum_max else c_sum_max
        if clip_49 < c_minus_sum_max:
            clip_49 = c_minus_sum_max
        sub_50 = in_track_balise_number - state_plus_balises_number
        abs_51 = abs(sub_50)
        gt_52 = abs_51 > c_zero
        rmpy_53 = rmpy_41 * c_wheel_max + 134217728 >> 28
        add_54 = rmpy_53 + c_balise_slack
        abs_55 = abs(rmpy_43)
        gt_56 = add_54 > abs_55
        gt_57 = c_sum_max > add_45
        where_58 = add_45 if gt_57 else state_plus_balises_squares
        where_59 = where_58 if gt_56 else state_plus_balises_squares
        balise_squares = where_59 if gt_52 else state_plus_balises_squares
        where_61 = clip_49 if gt_57 else state_plus_balises_errors
        where_62 = where_61 if gt_56 else state_plus_balises_errors
        balise_errors = where_62 if gt_52 else state_plus_balises_errors
        div_64 = div(balise_errors, balise_squares, 30)
        wheel = div_64 if div_64 < c_wheel_max else c_wheel_max
        if wheel < c_minus_wheel_max:
            wheel = c_minus_wheel_max
        clip_66 = in_track_position_01mm if in_track_position_01mm < c_odometer_max else c_odometer_max
        if clip_66 < c_zero:
            clip_66 = c_zero
        correction = clip_66 * wheel + 8388608 >> 24
        clip_68 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_68 < c_zero:
            clip_68 = c_zero
        clip_69 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_69 < c_zero:
            clip_69 = c_zero
        rmpy_70 = clip_69 * c_per_distance + 16777216 >> 25
        sub_71 = clip_68 - clip_69
        rmpy_72 = sub_71 * c_per_distance + 4194304 >> 23
        clip_73 = rmpy_72 if rmpy_72 < c_bound_max else c_bound_max
        if clip_73 < c_minus_bound_max:
            clip_73 = c_minus_bound_max
        maximum_74 = c_share_min if c_share_min > rmpy_70 else rmpy_70
        convert_75 = maximum_74 << 2
        sub_76 = clip_73 - c_tolerance
        div_77 = div(sub_76, convert_75, 30)
        add_78 = clip_73 + c_tolerance
        div_79 = div(add_78, convert_75, 30)
        gt_80 = balise_squares > state_plus_balises_squares
        gt_81 = rmpy_70 > c_share_min
        maximum_82 = state_wheel_low if state_wheel_low > div_77 else div_77
        clip_83 = maximum_82 if maximum_82 < c_wheel_max else c_wheel_max
        if clip_83 < c_minus_wheel_max_2:
            clip_83 = c_minus_wheel_max_2
        where_84 = clip_83 if gt_81 else state_wheel_low
        wheel_low = where_84 if gt_80 else state_wheel_low
        minimum_86 = state_wheel_high if state_wheel_high < div_79 else div_79
        clip_87 = minimum_86 if minimum_86 < c_wheel_max else c_wheel_max
        if clip_87 < c_minus_wheel_max_2:
            clip_87 = c_minus_wheel_max_2
        where_88 = clip_87 if gt_81 else state_wheel_high
        wheel_high = where_88 if gt_80 else state_wheel_high
        add_90 = wheel_low + wheel_high
        rmpy_91 = add_90 * c_half + 8388608 >> 24
        gt_92 = wheel_low > wheel_high
        wheel_bounded = wheel if gt_92 else rmpy_91
        place_correction = clip_66 * wheel_bounded + 8388608 >> 24
        lagged = c_lagged_0 * state_plus_observer_lagged + 8388608 >> 24
        lagged += c_lagged_1 * state_plus_notch_before + 8388608 >> 24
        lagged += c_lagged_2 * state_plus_notch + 8388608 >> 24
        dot_96 = c_integral_0 * state_plus_observer_lagged + 8388608 >> 24
        dot_96 += c_integral_1 * state_plus_notch_before + 8388608 >> 24
        dot_96 += c_integral_2 * state_plus_notch + 8388608 >> 24
        sub_97 = lagged - state_plus_observer_lagged
        rmpy_98 = state_plus_observer_lag * sub_97 + 8388608 >> 24
        sub_99 = dot_96 - rmpy_98
        rmpy_100 = state_plus_observer_gain * sub_99 + 33554432 >> 26
        add_101 = state_plus_observer_speed + rmpy_100
        rmpy_102 = state_plus_observer_disturbance * c_period + 33554432 >> 26
        add_103 = add_101 + rmpy_102
        sub_104 = add_103 - at_27
        gt_105 = in_speed > c_zero
        gt_106 = sub_104 > c_standstill
        where_107 = sub_104 if gt_106 else c_zero
        expected = sub_104 if gt_105 else where_107
        sub_109 = in_speed - expected
        clip_110 = sub_109 if sub_109 < c_innovation_max else c_innovation_max
        if clip_110 < c_minus_innovation_max:
            clip_110 = c_minus_innovation_max
        surprise = clip_110 if gt_105 else c_zero
        rmpy_112 = surprise * at_29 + 8388608 >> 24
        add_113 = expected + rmpy_112
        observed_speed = add_113 if add_113 < c_speed_max else c_speed_max
        if observed_speed < c_minus_speed_max:
            observed_speed = c_minus_speed_max
        rmpy_115 = surprise * at_30 + 2097152 >> 22
        add_116 = state_plus_observer_disturbance + rmpy_115
        disturbance = add_116 if add_116 < c_disturbance_max else c_disturbance_max
        if disturbance < c_minus_disturbance_max:
            disturbance = c_minus_disturbance_max
        rmpy_118 = surprise * at_31 + 2097152 >> 22
        add_119 = state_plus_observer_gain + rmpy_118
        gain = add_119 if add_119 < c_gain_max else c_gain_max
        if gain < c_gain_min:
            gain = c_gain_min
        rmpy_121 = surprise * at_32 + 524288 >> 20
        add_122 = state_plus_observer_lag + rmpy_121
        lag = add_122 if add_122 < c_lag_max else c_lag_max
        if lag < c_minus_lag_max:
            lag = c_minus_lag_max
        dot_124 = c_delay_lagged_0 * lagged + 8388608 >> 24
        dot_124 += c_delay_lagged_1 * state_plus_notch + 8388608 >> 24
        dot_125 = c_delay_integral_0 * lagged + 8388608 >> 24
        dot_125 += c_delay_integral_1 * state_plus_notch + 8388608 >> 24
        sub_126 = state_plus_notch - dot_124
        rmpy_127 = sub_126 * c_pole + 8388608 >> 24
        rmpy_128 = lag * rmpy_127 + 8388608 >> 24
        sub_129 = dot_124 - rmpy_128
        force = gain * sub_129 + 8388608 >> 24
        sub_131 = dot_124 - lagged
        rmpy_132 = lag * sub_131 + 8388608 >> 24
        sub_133 = dot_125 - rmpy_132
        rmpy_134 = gain * sub_133 + 33554432 >> 26
        add_135 = observed_speed + rmpy_134
        rmpy_136 = disturbance * c_delay + 33554432 >> 26
        add_137 = add_135 + rmpy_136
        sub_138 = add_137 - at_28
        rmpy_139 = sub_138 * wheel_bounded + 536870912 >> 30
        speed_ahead = sub_138 + rmpy_139
        add_141 = observed_speed + speed_ahead
        rmpy_142 = add_141 * c_advance + 536870912 >> 30
        sub_143 = at_20 - clip_66
        clip_144 = sub_143 if sub_143 < c_gap_max else c_gap_max
        if clip_144 < c_minus_gap_max:
            clip_144 = c_minus_gap_max
        convert_145 = clip_144 << 6
        add_146 = place_correction + rmpy_142
        sub_147 = convert_145 - add_146
        position_error = sub_147 if sub_147 < c_position_error_max else c_position_error_max
        if position_error < c_minus_position_error_max:
            position_error = c_minus_position_error_max
        sub_149 = at_21 - speed_ahead
        speed_error = sub_149 if sub_149 < c_speed_error_max else c_speed_error_max
        if speed_error < c_minus_speed_error_max:
            speed_error = c_minus_speed_error_max
        rmpy_151 = at_23 * wheel_bounded + 536870912 >> 30
        sub_152 = at_23 - rmpy_151
        sub_153 = sub_152 - disturbance
        sub_154 = sub_153 - force
        rmpy_155 = position_error * at_33 + 8388608 >> 24
        rmpy_156 = speed_error * at_34 + 2097152 >> 22
        add_157 = rmpy_155 + rmpy_156
        rmpy_158 = sub_154 * c_by_force + 8388608 >> 24
        add_159 = add_157 + rmpy_158
        clip_160 = position_error if position_error < c_capture_position else c_capture_position
        if clip_160 < c_minus_capture_position:
            clip_160 = c_minus_capture_position
        clip_161 = speed_error if speed_error < c_capture_speed else c_capture_speed
        if clip_161 < c_minus_capture_speed:
            clip_161 = c_minus_capture_speed
        rmpy_162 = clip_160 * at_36 + 524288 >> 20
        rmpy_163 = clip_161 * at_37 + 2097152 >> 22
        add_164 = rmpy_162 + rmpy_163
        rmpy_165 = sub_154 * at_38 + 8388608 >> 24
        add_166 = add_164 + rmpy_165
        stop_correction = add_166 if add_166 < c_correction_max else c_correction_max
        if stop_correction < c_minus_correction_max:
            stop_correction = c_minus_correction_max
        sub_168 = position_error - clip_160
        abs_169 = abs(sub_168)
        sub_170 = speed_error - clip_161
        abs_171 = abs(sub_170)
        gt_172 = abs_169 > c_zero
        gt_173 = abs_171 > c_zero
        where_174 = add_159 if gt_173 else stop_correction
        where_175 = add_159 if gt_172 else where_174
        gt_176 = at_35 > c_zero
        where_177 = where_175 if gt_176 else add_159
        rmpy_178 = at_24 * lag + 8388608 >> 24
        add_179 = at_22 + rmpy_178
        rmpy_180 = add_179 * wheel_bounded + 536870912 >> 30
        sub_181 = add_179 - rmpy_180
        sub_182 = sub_181 - disturbance
        accel = sub_182 + where_177
        notch_raw = div(accel, gain, 19)
        if at_26 > at_25:
            return None
        clip_185 = notch_raw if notch_raw < at_25 else at_25
        if clip_185 < at_26:
            clip_185 = at_26
        notch = clip_185 + 1024 >> 11
        convert_187 = notch << 16
        return (
            (
                observed_speed,
                disturbance,
                gain,
                lag,
                lagged,
                convert_187,
                state_plus_notch,
                in_track_balise_number,
                balise_squares,
                balise_errors,
                wheel_low,
                wheel_high,
            ),
            (
                notch_raw,
                notch,
                c_basis,
                c_one_softening,
            ),
            (
                balise_squares,
                balise_errors,
                wheel,
                correction,
                wheel_low,
                wheel_high,
                wheel_bounded,
                place_correction,
                lagged,
                expected,
                surprise,
                observed_speed,
                disturbance,
                gain,
                lag,
                force,
                speed_ahead,
                position_error,
                speed_error,
                stop_correction,
                accel,
                notch_raw,
                notch,
            ),
        )

    return period
