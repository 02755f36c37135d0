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
        c_twice_0,
        c_twice_1,
        c_twice_2,
        c_twice_3,
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
        c_delay_max,
        c_minus_delay_max,
        c_delay_lagged_0,
        c_delay_lagged_1,
        c_delay_integral_0,
        c_delay_integral_1,
        c_delay_twice_0,
        c_delay_twice_1,
        c_delay_twice_2,
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
        c_force_error_max,
        c_minus_force_error_max,
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
        t_observe_delay,
        t_ending,
        t_stop_by_position,
        t_stop_by_speed,
        t_stop_by_force,
    ) = parts.tables
    (last_0,) = parts.lasts
    div = parts.number.div
    (
        low_observer_speed,
        high_observer_speed,
        low_observer_disturbance,
        high_observer_disturbance,
        low_observer_gain,
        high_observer_gain,
        low_observer_lag,
        high_observer_lag,
        low_observer_delay,
        high_observer_delay,
        low_observer_lagged,
        high_observer_lagged,
        low_observer_lagged_twice,
        high_observer_lagged_twice,
        low_notch,
        high_notch,
        low_notch_before,
        high_notch_before,
        low_balises_number,
        high_balises_number,
        low_balises_squares,
        high_balises_squares,
        low_balises_errors,
        high_balises_errors,
        low_wheel_low,
        high_wheel_low,
        low_wheel_high,
        high_wheel_high,
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_observer_speed,
            state_observer_disturbance,
            state_observer_gain,
            state_observer_lag,
            state_observer_delay,
            state_observer_lagged,
            state_observer_lagged_twice,
            state_notch,
            state_notch_before,
            state_balises_number,
            state_balises_squares,
            state_balises_errors,
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
        if not low_observer_speed <= state_observer_speed <= high_observer_speed:
            return None
        if not low_observer_disturbance <= state_observer_disturbance <= high_observer_disturbance:
            return None
        if not low_observer_gain <= state_observer_gain <= high_observer_gain:
            return None
        if not low_observer_lag <= state_observer_lag <= high_observer_lag:
            return None
        if not low_observer_delay <= state_observer_delay <= high_observer_delay:
            return None
        if not low_observer_lagged <= state_observer_lagged <= high_observer_lagged:
            return None
        if not low_observer_lagged_twice <= state_observer_lagged_twice <= high_observer_lagged_twice:
            return None
        if not low_notch <= state_notch <= high_notch:
            return None
        if not low_notch_before <= state_notch_before <= high_notch_before:
            return None
        if not low_balises_number <= state_balises_number <= high_balises_number:
            return None
        if not low_balises_squares <= state_balises_squares <= high_balises_squares:
            return None
        if not low_balises_errors <= state_balises_errors <= high_balises_errors:
            return None
        if not low_wheel_low <= state_wheel_low <= high_wheel_low:
            return None
        if not low_wheel_high <= state_wheel_high <= high_wheel_high:
            return None
        index_21 = min(max(in_track_k, 0), last_0)
        at_22 = t_target_position[index_21]
        at_23 = t_target_speed[index_21]
        at_24 = t_feed_forward[index_21]
        at_25 = t_planned_force[index_21]
        at_26 = t_force_rate[index_21]
        at_27 = t_notch_upper[index_21]
        at_28 = t_notch_lower[index_21]
        at_29 = t_drag_over_period[index_21]
        at_30 = t_drag_over_delay[index_21]
        at_31 = t_observe_speed[index_21]
        at_32 = t_observe_disturbance[index_21]
        at_33 = t_observe_gain[index_21]
        at_34 = t_observe_lag[index_21]
        at_35 = t_by_position[index_21]
        at_36 = t_by_speed[index_21]
        at_37 = t_observe_delay[index_21]
        at_38 = t_ending[index_21]
        at_39 = t_stop_by_position[index_21]
        at_40 = t_stop_by_speed[index_21]
        at_41 = t_stop_by_force[index_21]
        clip_42 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_42 < c_zero:
            clip_42 = c_zero
        clip_43 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_43 < c_zero:
            clip_43 = c_zero
        rmpy_44 = clip_43 * c_per_distance + 33554432 >> 26
        sub_45 = clip_42 - clip_43
        rmpy_46 = sub_45 * c_per_distance + 8388608 >> 24
        rmpy_47 = rmpy_44 * rmpy_44 + 536870912 >> 30
        add_48 = state_balises_squares + rmpy_47
        clip_49 = rmpy_46 if rmpy_46 < c_wheel_max else c_wheel_max
        if clip_49 < c_minus_wheel_max:
            clip_49 = c_minus_wheel_max
        rmpy_50 = rmpy_44 * clip_49 + 2147483648 >> 32
        add_51 = state_balises_errors + rmpy_50
        clip_52 = add_51 if add_51 < c_sum_max else c_sum_max
        if clip_52 < c_minus_sum_max:
            clip_52 = c_minus_sum_max
        sub_53 = in_track_balise_number - state_balises_number
        abs_54 = abs(sub_53)
        gt_55 = abs_54 > c_zero
        rmpy_56 = rmpy_44 * c_wheel_max + 134217728 >> 28
        add_57 = rmpy_56 + c_balise_slack
        abs_58 = abs(rmpy_46)
        gt_59 = add_57 > abs_58
        gt_60 = c_sum_max > add_48
        where_61 = add_48 if gt_60 else state_balises_squares
        where_62 = where_61 if gt_59 else state_balises_squares
        balise_squares = where_62 if gt_55 else state_balises_squares
        where_64 = clip_52 if gt_60 else state_balises_errors
        where_65 = where_64 if gt_59 else state_balises_errors
        balise_errors = where_65 if gt_55 else state_balises_errors
        div_67 = div(balise_errors, balise_squares, 30)
        wheel = div_67 if div_67 < c_wheel_max else c_wheel_max
        if wheel < c_minus_wheel_max:
            wheel = c_minus_wheel_max
        clip_69 = in_track_position_01mm if in_track_position_01mm < c_odometer_max else c_odometer_max
        if clip_69 < c_zero:
            clip_69 = c_zero
        correction = clip_69 * wheel + 8388608 >> 24
        clip_71 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_71 < c_zero:
            clip_71 = c_zero
        clip_72 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_72 < c_zero:
            clip_72 = c_zero
        rmpy_73 = clip_72 * c_per_distance + 33554432 >> 26
        sub_74 = clip_71 - clip_72
        rmpy_75 = sub_74 * c_per_distance + 8388608 >> 24
        clip_76 = rmpy_75 if rmpy_75 < c_bound_max else c_bound_max
        if clip_76 < c_minus_bound_max:
            clip_76 = c_minus_bound_max
        maximum_77 = c_share_min if c_share_min > rmpy_73 else rmpy_73
        convert_78 = maximum_77 << 2
        sub_79 = clip_76 - c_tolerance
        div_80 = div(sub_79, convert_78, 30)
        add_81 = clip_76 + c_tolerance
        div_82 = div(add_81, convert_78, 30)
        gt_83 = balise_squares > state_balises_squares
        gt_84 = rmpy_73 > c_share_min
        maximum_85 = state_wheel_low if state_wheel_low > div_80 else div_80
        clip_86 = maximum_85 if maximum_85 < c_wheel_max else c_wheel_max
        if clip_86 < c_minus_wheel_max_2:
            clip_86 = c_minus_wheel_max_2
        where_87 = clip_86 if gt_84 else state_wheel_low
        wheel_low = where_87 if gt_83 else state_wheel_low
        minimum_89 = state_wheel_high if state_wheel_high < div_82 else div_82
        clip_90 = minimum_89 if minimum_89 < c_wheel_max else c_wheel_max
        if clip_90 < c_minus_wheel_max_2:
            clip_90 = c_minus_wheel_max_2
        where_91 = clip_90 if gt_84 else state_wheel_high
        wheel_high = where_91 if gt_83 else state_wheel_high
        add_93 = wheel_low + wheel_high
        rmpy_94 = add_93 * c_half + 8388608 >> 24
        gt_95 = wheel_low > wheel_high
        wheel_bounded = wheel if gt_95 else rmpy_94
        place_correction = clip_69 * wheel_bounded + 8388608 >> 24
        lagged = c_lagged_0 * state_observer_lagged + 8388608 >> 24
        lagged += c_lagged_1 * state_notch_before + 8388608 >> 24
        lagged += c_lagged_2 * state_notch + 8388608 >> 24
        lagged_twice = c_twice_0 * state_observer_lagged_twice + 8388608 >> 24
        lagged_twice += c_twice_1 * state_observer_lagged + 8388608 >> 24
        lagged_twice += c_twice_2 * state_notch_before + 8388608 >> 24
        lagged_twice += c_twice_3 * state_notch + 8388608 >> 24
        dot_100 = c_integral_0 * state_observer_lagged + 8388608 >> 24
        dot_100 += c_integral_1 * state_notch_before + 8388608 >> 24
        dot_100 += c_integral_2 * state_notch + 8388608 >> 24
        sub_101 = lagged_twice - state_observer_lagged_twice
        rmpy_102 = state_observer_lag * sub_101 + 8388608 >> 24
        sub_103 = lagged - state_observer_lagged
        rmpy_104 = state_observer_delay * sub_103 + 8388608 >> 24
        add_105 = rmpy_102 + rmpy_104
        sub_106 = dot_100 - add_105
        rmpy_107 = state_observer_gain * sub_106 + 33554432 >> 26
        add_108 = state_observer_speed + rmpy_107
        rmpy_109 = state_observer_disturbance * c_period + 33554432 >> 26
        add_110 = add_108 + rmpy_109
        sub_111 = add_110 - at_29
        gt_112 = in_speed > c_zero
        gt_113 = sub_111 > c_standstill
        where_114 = sub_111 if gt_113 else c_zero
        expected = sub_111 if gt_112 else where_114
        sub_116 = in_speed - expected
        clip_117 = sub_116 if sub_116 < c_innovation_max else c_innovation_max
        if clip_117 < c_minus_innovation_max:
            clip_117 = c_minus_innovation_max
        surprise = clip_117 if gt_112 else c_zero
        rmpy_119 = surprise * at_31 + 8388608 >> 24
        add_120 = expected + rmpy_119
        observed_speed = add_120 if add_120 < c_speed_max else c_speed_max
        if observed_speed < c_minus_speed_max:
            observed_speed = c_minus_speed_max
        rmpy_122 = surprise * at_32 + 2097152 >> 22
        add_123 = state_observer_disturbance + rmpy_122
        disturbance = add_123 if add_123 < c_disturbance_max else c_disturbance_max
        if disturbance < c_minus_disturbance_max:
            disturbance = c_minus_disturbance_max
        rmpy_125 = surprise * at_33 + 2097152 >> 22
        add_126 = state_observer_gain + rmpy_125
        gain = add_126 if add_126 < c_gain_max else c_gain_max
        if gain < c_gain_min:
            gain = c_gain_min
        rmpy_128 = surprise * at_34 + 524288 >> 20
        add_129 = state_observer_lag + rmpy_128
        lag = add_129 if add_129 < c_lag_max else c_lag_max
        if lag < c_minus_lag_max:
            lag = c_minus_lag_max
        rmpy_131 = surprise * at_37 + 524288 >> 20
        add_132 = state_observer_delay + rmpy_131
        delay = add_132 if add_132 < c_delay_max else c_delay_max
        if delay < c_minus_delay_max:
            delay = c_minus_delay_max
        dot_134 = c_delay_lagged_0 * lagged + 8388608 >> 24
        dot_134 += c_delay_lagged_1 * state_notch + 8388608 >> 24
        dot_135 = c_delay_integral_0 * lagged + 8388608 >> 24
        dot_135 += c_delay_integral_1 * state_notch + 8388608 >> 24
        dot_136 = c_delay_twice_0 * lagged_twice + 8388608 >> 24
        dot_136 += c_delay_twice_1 * lagged + 8388608 >> 24
        dot_136 += c_delay_twice_2 * state_notch + 8388608 >> 24
        sub_137 = dot_134 - dot_136
        rmpy_138 = lag * sub_137 + 8388608 >> 24
        sub_139 = state_notch - dot_134
        rmpy_140 = delay * sub_139 + 8388608 >> 24
        add_141 = rmpy_138 + rmpy_140
        rmpy_142 = add_141 * c_pole + 8388608 >> 24
        sub_143 = dot_134 - rmpy_142
        force = gain * sub_143 + 8388608 >> 24
        sub_145 = dot_136 - lagged_twice
        rmpy_146 = lag * sub_145 + 8388608 >> 24
        sub_147 = dot_134 - lagged
        rmpy_148 = delay * sub_147 + 8388608 >> 24
        add_149 = rmpy_146 + rmpy_148
        sub_150 = dot_135 - add_149
        rmpy_151 = gain * sub_150 + 33554432 >> 26
        add_152 = observed_speed + rmpy_151
        rmpy_153 = disturbance * c_delay + 33554432 >> 26
        add_154 = add_152 + rmpy_153
        sub_155 = add_154 - at_30
        rmpy_156 = sub_155 * wheel_bounded + 536870912 >> 30
        speed_ahead = sub_155 + rmpy_156
        add_158 = observed_speed + speed_ahead
        rmpy_159 = add_158 * c_advance + 536870912 >> 30
        sub_160 = at_22 - clip_69
        clip_161 = sub_160 if sub_160 < c_gap_max else c_gap_max
        if clip_161 < c_minus_gap_max:
            clip_161 = c_minus_gap_max
        convert_162 = clip_161 << 6
        add_163 = place_correction + rmpy_159
        sub_164 = convert_162 - add_163
        position_error = sub_164 if sub_164 < c_position_error_max else c_position_error_max
        if position_error < c_minus_position_error_max:
            position_error = c_minus_position_error_max
        sub_166 = at_23 - speed_ahead
        speed_error = sub_166 if sub_166 < c_speed_error_max else c_speed_error_max
        if speed_error < c_minus_speed_error_max:
            speed_error = c_minus_speed_error_max
        rmpy_168 = at_25 * wheel_bounded + 536870912 >> 30
        sub_169 = at_25 - rmpy_168
        sub_170 = sub_169 - disturbance
        sub_171 = sub_170 - force
        rmpy_172 = position_error * at_35 + 8388608 >> 24
        rmpy_173 = speed_error * at_36 + 2097152 >> 22
        add_174 = rmpy_172 + rmpy_173
        rmpy_175 = sub_171 * c_by_force + 8388608 >> 24
        add_176 = add_174 + rmpy_175
        clip_177 = position_error if position_error < c_capture_position else c_capture_position
        if clip_177 < c_minus_capture_position:
            clip_177 = c_minus_capture_position
        clip_178 = speed_error if speed_error < c_capture_speed else c_capture_speed
        if clip_178 < c_minus_capture_speed:
            clip_178 = c_minus_capture_speed
        rmpy_179 = clip_177 * at_39 + 524288 >> 20
        rmpy_180 = clip_178 * at_40 + 2097152 >> 22
        add_181 = rmpy_179 + rmpy_180
        clip_182 = sub_171 if sub_171 < c_force_error_max else c_force_error_max
        if clip_182 < c_minus_force_error_max:
            clip_182 = c_minus_force_error_max
        rmpy_183 = clip_182 * at_41 + 8388608 >> 24
        add_184 = add_181 + rmpy_183
        stop_correction = add_184 if add_184 < c_correction_max else c_correction_max
        if stop_correction < c_minus_correction_max:
            stop_correction = c_minus_correction_max
        sub_186 = position_error - clip_177
        abs_187 = abs(sub_186)
        sub_188 = speed_error - clip_178
        abs_189 = abs(sub_188)
        gt_190 = abs_187 > c_zero
        gt_191 = abs_189 > c_zero
        where_192 = add_176 if gt_191 else stop_correction
        where_193 = add_176 if gt_190 else where_192
        gt_194 = at_38 > c_zero
        where_195 = where_193 if gt_194 else add_176
        add_196 = lag + delay
        rmpy_197 = at_26 * add_196 + 8388608 >> 24
        add_198 = at_24 + rmpy_197
        rmpy_199 = add_198 * wheel_bounded + 536870912 >> 30
        sub_200 = add_198 - rmpy_199
        sub_201 = sub_200 - disturbance
        accel = sub_201 + where_195
        notch_raw = div(accel, gain, 19)
        if at_28 > at_27:
            return None
        clip_204 = notch_raw if notch_raw < at_27 else at_27
        if clip_204 < at_28:
            clip_204 = at_28
        notch = clip_204 + 1024 >> 11
        convert_206 = notch << 16
        return (
            (
                observed_speed,
                disturbance,
                gain,
                lag,
                delay,
                lagged,
                lagged_twice,
                convert_206,
                state_notch,
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
                lagged_twice,
                expected,
                surprise,
                observed_speed,
                disturbance,
                gain,
                lag,
                delay,
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
        c_twice_0,
        c_twice_1,
        c_twice_2,
        c_twice_3,
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
        c_delay_max,
        c_minus_delay_max,
        c_delay_lagged_0,
        c_delay_lagged_1,
        c_delay_integral_0,
        c_delay_integral_1,
        c_delay_twice_0,
        c_delay_twice_1,
        c_delay_twice_2,
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
        c_force_error_max,
        c_minus_force_error_max,
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
        t_observe_delay,
        t_ending,
        t_stop_by_position,
        t_stop_by_speed,
        t_stop_by_force,
    ) = parts.tables
    (last_0,) = parts.lasts
    div = parts.number.div
    (
        low_observer_speed,
        high_observer_speed,
        low_observer_disturbance,
        high_observer_disturbance,
        low_observer_gain,
        high_observer_gain,
        low_observer_lag,
        high_observer_lag,
        low_observer_delay,
        high_observer_delay,
        low_observer_lagged,
        high_observer_lagged,
        low_observer_lagged_twice,
        high_observer_lagged_twice,
        low_notch,
        high_notch,
        low_notch_before,
        high_notch_before,
        low_balises_number,
        high_balises_number,
        low_balises_squares,
        high_balises_squares,
        low_balises_errors,
        high_balises_errors,
        low_wheel_low,
        high_wheel_low,
        low_wheel_high,
        high_wheel_high,
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_observer_speed,
            state_observer_disturbance,
            state_observer_gain,
            state_observer_lag,
            state_observer_delay,
            state_observer_lagged,
            state_observer_lagged_twice,
            state_notch,
            state_notch_before,
            state_balises_number,
            state_balises_squares,
            state_balises_errors,
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
        if not low_observer_speed <= state_observer_speed <= high_observer_speed:
            return None
        if not low_observer_disturbance <= state_observer_disturbance <= high_observer_disturbance:
            return None
        if not low_observer_gain <= state_observer_gain <= high_observer_gain:
            return None
        if not low_observer_lag <= state_observer_lag <= high_observer_lag:
            return None
        if not low_observer_delay <= state_observer_delay <= high_observer_delay:
            return None
        if not low_observer_lagged <= state_observer_lagged <= high_observer_lagged:
            return None
        if not low_observer_lagged_twice <= state_observer_lagged_twice <= high_observer_lagged_twice:
            return None
        if not low_notch <= state_notch <= high_notch:
            return None
        if not low_notch_before <= state_notch_before <= high_notch_before:
            return None
        if not low_balises_number <= state_balises_number <= high_balises_number:
            return None
        if not low_balises_squares <= state_balises_squares <= high_balises_squares:
            return None
        if not low_balises_errors <= state_balises_errors <= high_balises_errors:
            return None
        if not low_wheel_low <= state_wheel_low <= high_wheel_low:
            return None
        if not low_wheel_high <= state_wheel_high <= high_wheel_high:
            return None
        index_21 = min(max(in_track_k, 0), last_0)
        at_22 = t_target_position[index_21]
        at_23 = t_target_speed[index_21]
        at_24 = t_feed_forward[index_21]
        at_25 = t_planned_force[index_21]
        at_26 = t_force_rate[index_21]
        at_27 = t_notch_upper[index_21]
        at_28 = t_notch_lower[index_21]
        at_29 = t_drag_over_period[index_21]
        at_30 = t_drag_over_delay[index_21]
        at_31 = t_observe_speed[index_21]
        at_32 = t_observe_disturbance[index_21]
        at_33 = t_observe_gain[index_21]
        at_34 = t_observe_lag[index_21]
        at_35 = t_by_position[index_21]
        at_36 = t_by_speed[index_21]
        at_37 = t_observe_delay[index_21]
        at_38 = t_ending[index_21]
        at_39 = t_stop_by_position[index_21]
        at_40 = t_stop_by_speed[index_21]
        at_41 = t_stop_by_force[index_21]
        clip_42 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_42 < c_zero:
            clip_42 = c_zero
        clip_43 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_43 < c_zero:
            clip_43 = c_zero
        rmpy_44 = clip_43 * c_per_distance + 16777216 >> 25
        sub_45 = clip_42 - clip_43
        rmpy_46 = sub_45 * c_per_distance + 4194304 >> 23
        rmpy_47 = rmpy_44 * rmpy_44 + 536870912 >> 30
        add_48 = state_balises_squares + rmpy_47
        clip_49 = rmpy_46 if rmpy_46 < c_wheel_max else c_wheel_max
        if clip_49 < c_minus_wheel_max:
            clip_49 = c_minus_wheel_max
        rmpy_50 = rmpy_44 * clip_49 + 2147483648 >> 32
        add_51 = state_balises_errors + rmpy_50
        clip_52 = add_51 if add_51 < c_sum_max else c_sum_max
        if clip_52 < c_minus_sum_max:
            clip_52 = c_minus_sum_max
        sub_53 = in_track_balise_number - state_balises_number
        abs_54 = abs(sub_53)
        gt_55 = abs_54 > c_zero
        rmpy_56 = rmpy_44 * c_wheel_max + 134217728 >> 28
        add_57 = rmpy_56 + c_balise_slack
        abs_58 = abs(rmpy_46)
        gt_59 = add_57 > abs_58
        gt_60 = c_sum_max > add_48
        where_61 = add_48 if gt_60 else state_balises_squares
        where_62 = where_61 if gt_59 else state_balises_squares
        balise_squares = where_62 if gt_55 else state_balises_squares
        where_64 = clip_52 if gt_60 else state_balises_errors
        where_65 = where_64 if gt_59 else state_balises_errors
        balise_errors = where_65 if gt_55 else state_balises_errors
        div_67 = div(balise_errors, balise_squares, 30)
        wheel = div_67 if div_67 < c_wheel_max else c_wheel_max
        if wheel < c_minus_wheel_max:
            wheel = c_minus_wheel_max
        clip_69 = in_track_position_01mm if in_track_position_01mm < c_odometer_max else c_odometer_max
        if clip_69 < c_zero:
            clip_69 = c_zero
        correction = clip_69 * wheel + 8388608 >> 24
        clip_71 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_71 < c_zero:
            clip_71 = c_zero
        clip_72 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_72 < c_zero:
            clip_72 = c_zero
        rmpy_73 = clip_72 * c_per_distance + 16777216 >> 25
        sub_74 = clip_71 - clip_72
        rmpy_75 = sub_74 * c_per_distance + 4194304 >> 23
        clip_76 = rmpy_75 if rmpy_75 < c_bound_max else c_bound_max
        if clip_76 < c_minus_bound_max:
            clip_76 = c_minus_bound_max
        maximum_77 = c_share_min if c_share_min > rmpy_73 else rmpy_73
        convert_78 = maximum_77 << 2
        sub_79 = clip_76 - c_tolerance
        div_80 = div(sub_79, convert_78, 30)
        add_81 = clip_76 + c_tolerance
        div_82 = div(add_81, convert_78, 30)
        gt_83 = balise_squares > state_balises_squares
        gt_84 = rmpy_73 > c_share_min
        maximum_85 = state_wheel_low if state_wheel_low > div_80 else div_80
        clip_86 = maximum_85 if maximum_85 < c_wheel_max else c_wheel_max
        if clip_86 < c_minus_wheel_max_2:
            clip_86 = c_minus_wheel_max_2
        where_87 = clip_86 if gt_84 else state_wheel_low
        wheel_low = where_87 if gt_83 else state_wheel_low
        minimum_89 = state_wheel_high if state_wheel_high < div_82 else div_82
        clip_90 = minimum_89 if minimum_89 < c_wheel_max else c_wheel_max
        if clip_90 < c_minus_wheel_max_2:
            clip_90 = c_minus_wheel_max_2
        where_91 = clip_90 if gt_84 else state_wheel_high
        wheel_high = where_91 if gt_83 else state_wheel_high
        add_93 = wheel_low + wheel_high
        rmpy_94 = add_93 * c_half + 8388608 >> 24
        gt_95 = wheel_low > wheel_high
        wheel_bounded = wheel if gt_95 else rmpy_94
        place_correction = clip_69 * wheel_bounded + 8388608 >> 24
        lagged = c_lagged_0 * state_observer_lagged + 8388608 >> 24
        lagged += c_lagged_1 * state_notch_before + 8388608 >> 24
        lagged += c_lagged_2 * state_notch + 8388608 >> 24
        lagged_twice = c_twice_0 * state_observer_lagged_twice + 8388608 >> 24
        lagged_twice += c_twice_1 * state_observer_lagged + 8388608 >> 24
        lagged_twice += c_twice_2 * state_notch_before + 8388608 >> 24
        lagged_twice += c_twice_3 * state_notch + 8388608 >> 24
        dot_100 = c_integral_0 * state_observer_lagged + 8388608 >> 24
        dot_100 += c_integral_1 * state_notch_before + 8388608 >> 24
        dot_100 += c_integral_2 * state_notch + 8388608 >> 24
        sub_101 = lagged_twice - state_observer_lagged_twice
        rmpy_102 = state_observer_lag * sub_101 + 8388608 >> 24
        sub_103 = lagged - state_observer_lagged
        rmpy_104 = state_observer_delay * sub_103 + 8388608 >> 24
        add_105 = rmpy_102 + rmpy_104
        sub_106 = dot_100 - add_105
        rmpy_107 = state_observer_gain * sub_106 + 33554432 >> 26
        add_108 = state_observer_speed + rmpy_107
        rmpy_109 = state_observer_disturbance * c_period + 33554432 >> 26
        add_110 = add_108 + rmpy_109
        sub_111 = add_110 - at_29
        gt_112 = in_speed > c_zero
        gt_113 = sub_111 > c_standstill
        where_114 = sub_111 if gt_113 else c_zero
        expected = sub_111 if gt_112 else where_114
        sub_116 = in_speed - expected
        clip_117 = sub_116 if sub_116 < c_innovation_max else c_innovation_max
        if clip_117 < c_minus_innovation_max:
            clip_117 = c_minus_innovation_max
        surprise = clip_117 if gt_112 else c_zero
        rmpy_119 = surprise * at_31 + 8388608 >> 24
        add_120 = expected + rmpy_119
        observed_speed = add_120 if add_120 < c_speed_max else c_speed_max
        if observed_speed < c_minus_speed_max:
            observed_speed = c_minus_speed_max
        rmpy_122 = surprise * at_32 + 2097152 >> 22
        add_123 = state_observer_disturbance + rmpy_122
        disturbance = add_123 if add_123 < c_disturbance_max else c_disturbance_max
        if disturbance < c_minus_disturbance_max:
            disturbance = c_minus_disturbance_max
        rmpy_125 = surprise * at_33 + 2097152 >> 22
        add_126 = state_observer_gain + rmpy_125
        gain = add_126 if add_126 < c_gain_max else c_gain_max
        if gain < c_gain_min:
            gain = c_gain_min
        rmpy_128 = surprise * at_34 + 524288 >> 20
        add_129 = state_observer_lag + rmpy_128
        lag = add_129 if add_129 < c_lag_max else c_lag_max
        if lag < c_minus_lag_max:
            lag = c_minus_lag_max
        rmpy_131 = surprise * at_37 + 524288 >> 20
        add_132 = state_observer_delay + rmpy_131
        delay = add_132 if add_132 < c_delay_max else c_delay_max
        if delay < c_minus_delay_max:
            delay = c_minus_delay_max
        dot_134 = c_delay_lagged_0 * lagged + 8388608 >> 24
        dot_134 += c_delay_lagged_1 * state_notch + 8388608 >> 24
        dot_135 = c_delay_integral_0 * lagged + 8388608 >> 24
        dot_135 += c_delay_integral_1 * state_notch + 8388608 >> 24
        dot_136 = c_delay_twice_0 * lagged_twice + 8388608 >> 24
        dot_136 += c_delay_twice_1 * lagged + 8388608 >> 24
        dot_136 += c_delay_twice_2 * state_notch + 8388608 >> 24
        sub_137 = dot_134 - dot_136
        rmpy_138 = lag * sub_137 + 8388608 >> 24
        sub_139 = state_notch - dot_134
        rmpy_140 = delay * sub_139 + 8388608 >> 24
        add_141 = rmpy_138 + rmpy_140
        rmpy_142 = add_141 * c_pole + 8388608 >> 24
        sub_143 = dot_134 - rmpy_142
        force = gain * sub_143 + 8388608 >> 24
        sub_145 = dot_136 - lagged_twice
        rmpy_146 = lag * sub_145 + 8388608 >> 24
        sub_147 = dot_134 - lagged
        rmpy_148 = delay * sub_147 + 8388608 >> 24
        add_149 = rmpy_146 + rmpy_148
        sub_150 = dot_135 - add_149
        rmpy_151 = gain * sub_150 + 33554432 >> 26
        add_152 = observed_speed + rmpy_151
        rmpy_153 = disturbance * c_delay + 33554432 >> 26
        add_154 = add_152 + rmpy_153
        sub_155 = add_154 - at_30
        rmpy_156 = sub_155 * wheel_bounded + 536870912 >> 30
        speed_ahead = sub_155 + rmpy_156
        add_158 = observed_speed + speed_ahead
        rmpy_159 = add_158 * c_advance + 536870912 >> 30
        sub_160 = at_22 - clip_69
        clip_161 = sub_160 if sub_160 < c_gap_max else c_gap_max
        if clip_161 < c_minus_gap_max:
            clip_161 = c_minus_gap_max
        convert_162 = clip_161 << 6
        add_163 = place_correction + rmpy_159
        sub_164 = convert_162 - add_163
        position_error = sub_164 if sub_164 < c_position_error_max else c_position_error_max
        if position_error < c_minus_position_error_max:
            position_error = c_minus_position_error_max
        sub_166 = at_23 - speed_ahead
        speed_error = sub_166 if sub_166 < c_speed_error_max else c_speed_error_max
        if speed_error < c_minus_speed_error_max:
            speed_error = c_minus_speed_error_max
        rmpy_168 = at_25 * wheel_bounded + 536870912 >> 30
        sub_169 = at_25 - rmpy_168
        sub_170 = sub_169 - disturbance
        sub_171 = sub_170 - force
        rmpy_172 = position_error * at_35 + 8388608 >> 24
        rmpy_173 = speed_error * at_36 + 2097152 >> 22
        add_174 = rmpy_172 + rmpy_173
        rmpy_175 = sub_171 * c_by_force + 8388608 >> 24
        add_176 = add_174 + rmpy_175
        clip_177 = position_error if position_error < c_capture_position else c_capture_position
        if clip_177 < c_minus_capture_position:
            clip_177 = c_minus_capture_position
        clip_178 = speed_error if speed_error < c_capture_speed else c_capture_speed
        if clip_178 < c_minus_capture_speed:
            clip_178 = c_minus_capture_speed
        rmpy_179 = clip_177 * at_39 + 524288 >> 20
        rmpy_180 = clip_178 * at_40 + 2097152 >> 22
        add_181 = rmpy_179 + rmpy_180
        clip_182 = sub_171 if sub_171 < c_force_error_max else c_force_error_max
        if clip_182 < c_minus_force_error_max:
            clip_182 = c_minus_force_error_max
        rmpy_183 = clip_182 * at_41 + 8388608 >> 24
        add_184 = add_181 + rmpy_183
        stop_correction = add_184 if add_184 < c_correction_max else c_correction_max
        if stop_correction < c_minus_correction_max:
            stop_correction = c_minus_correction_max
        sub_186 = position_error - clip_177
        abs_187 = abs(sub_186)
        sub_188 = speed_error - clip_178
        abs_189 = abs(sub_188)
        gt_190 = abs_187 > c_zero
        gt_191 = abs_189 > c_zero
        where_192 = add_176 if gt_191 else stop_correction
        where_193 = add_176 if gt_190 else where_192
        gt_194 = at_38 > c_zero
        where_195 = where_193 if gt_194 else add_176
        add_196 = lag + delay
        rmpy_197 = at_26 * add_196 + 8388608 >> 24
        add_198 = at_24 + rmpy_197
        rmpy_199 = add_198 * wheel_bounded + 536870912 >> 30
        sub_200 = add_198 - rmpy_199
        sub_201 = sub_200 - disturbance
        accel = sub_201 + where_195
        notch_raw = div(accel, gain, 19)
        if at_28 > at_27:
            return None
        clip_204 = notch_raw if notch_raw < at_27 else at_27
        if clip_204 < at_28:
            clip_204 = at_28
        notch = clip_204 + 1024 >> 11
        convert_206 = notch << 16
        return (
            (
                observed_speed,
                disturbance,
                gain,
                lag,
                delay,
                lagged,
                lagged_twice,
                convert_206,
                state_notch,
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
                lagged_twice,
                expected,
                surprise,
                observed_speed,
                disturbance,
                gain,
                lag,
                delay,
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
