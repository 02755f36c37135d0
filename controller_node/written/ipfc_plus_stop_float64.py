"""Law ipfc_plus_stop in double precision. Written by ``make tables`` from the recorded program; do not edit."""

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
    quantise = parts.number.quantise

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
        clip_39 = c_zero if c_zero > in_track_balise_position_01mm else in_track_balise_position_01mm
        if c_odometer_max < clip_39:
            clip_39 = c_odometer_max
        clip_40 = c_zero if c_zero > in_track_balise_odometer_01mm else in_track_balise_odometer_01mm
        if c_odometer_max < clip_40:
            clip_40 = c_odometer_max
        rmpy_41 = clip_40 * c_per_distance
        sub_42 = clip_39 - clip_40
        rmpy_43 = sub_42 * c_per_distance
        rmpy_44 = rmpy_41 * rmpy_41
        add_45 = state_plus_balises_squares + rmpy_44
        clip_46 = c_minus_wheel_max if c_minus_wheel_max > rmpy_43 else rmpy_43
        if c_wheel_max < clip_46:
            clip_46 = c_wheel_max
        rmpy_47 = rmpy_41 * clip_46
        add_48 = state_plus_balises_errors + rmpy_47
        clip_49 = c_minus_sum_max if c_minus_sum_max > add_48 else add_48
        if c_sum_max < clip_49:
            clip_49 = c_sum_max
        sub_50 = in_track_balise_number - state_plus_balises_number
        abs_51 = abs(sub_50)
        gt_52 = abs_51 > c_zero
        rmpy_53 = rmpy_41 * c_wheel_max
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
        wheel = c_minus_wheel_max if c_minus_wheel_max > div_64 else div_64
        if c_wheel_max < wheel:
            wheel = c_wheel_max
        clip_66 = c_zero if c_zero > in_track_position_01mm else in_track_position_01mm
        if c_odometer_max < clip_66:
            clip_66 = c_odometer_max
        correction = clip_66 * wheel
        clip_68 = c_zero if c_zero > in_track_balise_position_01mm else in_track_balise_position_01mm
        if c_odometer_max < clip_68:
            clip_68 = c_odometer_max
        clip_69 = c_zero if c_zero > in_track_balise_odometer_01mm else in_track_balise_odometer_01mm
        if c_odometer_max < clip_69:
            clip_69 = c_odometer_max
        rmpy_70 = clip_69 * c_per_distance
        sub_71 = clip_68 - clip_69
        rmpy_72 = sub_71 * c_per_distance
        clip_73 = c_minus_bound_max if c_minus_bound_max > rmpy_72 else rmpy_72
        if c_bound_max < clip_73:
            clip_73 = c_bound_max
        maximum_74 = c_share_min if c_share_min > rmpy_70 else rmpy_70
        convert_75 = maximum_74
        sub_76 = clip_73 - c_tolerance
        div_77 = div(sub_76, convert_75, 30)
        add_78 = clip_73 + c_tolerance
        div_79 = div(add_78, convert_75, 30)
        gt_80 = balise_squares > state_plus_balises_squares
        gt_81 = rmpy_70 > c_share_min
        maximum_82 = state_wheel_low if state_wheel_low > div_77 else div_77
        clip_83 = c_minus_wheel_max_2 if c_minus_wheel_max_2 > maximum_82 else maximum_82
        if c_wheel_max < clip_83:
            clip_83 = c_wheel_max
        where_84 = clip_83 if gt_81 else state_wheel_low
        wheel_low = where_84 if gt_80 else state_wheel_low
        minimum_86 = state_wheel_high if state_wheel_high < div_79 else div_79
        clip_87 = c_minus_wheel_max_2 if c_minus_wheel_max_2 > minimum_86 else minimum_86
        if c_wheel_max < clip_87:
            clip_87 = c_wheel_max
        where_88 = clip_87 if gt_81 else state_wheel_high
        wheel_high = where_88 if gt_80 else state_wheel_high
        add_90 = wheel_low + wheel_high
        rmpy_91 = add_90 * c_half
        gt_92 = wheel_low > wheel_high
        wheel_bounded = wheel if gt_92 else rmpy_91
        place_correction = clip_66 * wheel_bounded
        lagged = 0.0 + c_lagged_0 * state_plus_observer_lagged
        lagged += c_lagged_1 * state_plus_notch_before
        lagged += c_lagged_2 * state_plus_notch
        dot_96 = 0.0 + c_integral_0 * state_plus_observer_lagged
        dot_96 += c_integral_1 * state_plus_notch_before
        dot_96 += c_integral_2 * state_plus_notch
        sub_97 = lagged - state_plus_observer_lagged
        rmpy_98 = state_plus_observer_lag * sub_97
        sub_99 = dot_96 - rmpy_98
        rmpy_100 = state_plus_observer_gain * sub_99
        add_101 = state_plus_observer_speed + rmpy_100
        rmpy_102 = state_plus_observer_disturbance * c_period
        add_103 = add_101 + rmpy_102
        sub_104 = add_103 - at_27
        gt_105 = in_speed > c_zero
        gt_106 = sub_104 > c_standstill
        where_107 = sub_104 if gt_106 else c_zero
        expected = sub_104 if gt_105 else where_107
        sub_109 = in_speed - expected
        clip_110 = c_minus_innovation_max if c_minus_innovation_max > sub_109 else sub_109
        if c_innovation_max < clip_110:
            clip_110 = c_innovation_max
        surprise = clip_110 if gt_105 else c_zero
        rmpy_112 = surprise * at_29
        add_113 = expected + rmpy_112
        observed_speed = c_minus_speed_max if c_minus_speed_max > add_113 else add_113
        if c_speed_max < observed_speed:
            observed_speed = c_speed_max
        rmpy_115 = surprise * at_30
        add_116 = state_plus_observer_disturbance + rmpy_115
        disturbance = c_minus_disturbance_max if c_minus_disturbance_max > add_116 else add_116
        if c_disturbance_max < disturbance:
            disturbance = c_disturbance_max
        rmpy_118 = surprise * at_31
        add_119 = state_plus_observer_gain + rmpy_118
        gain = c_gain_min if c_gain_min > add_119 else add_119
        if c_gain_max < gain:
            gain = c_gain_max
        rmpy_121 = surprise * at_32
        add_122 = state_plus_observer_lag + rmpy_121
        lag = c_minus_lag_max if c_minus_lag_max > add_122 else add_122
        if c_lag_max < lag:
            lag = c_lag_max
        dot_124 = 0.0 + c_delay_lagged_0 * lagged
        dot_124 += c_delay_lagged_1 * state_plus_notch
        dot_125 = 0.0 + c_delay_integral_0 * lagged
        dot_125 += c_delay_integral_1 * state_plus_notch
        sub_126 = state_plus_notch - dot_124
        rmpy_127 = sub_126 * c_pole
        rmpy_128 = lag * rmpy_127
        sub_129 = dot_124 - rmpy_128
        force = gain * sub_129
        sub_131 = dot_124 - lagged
        rmpy_132 = lag * sub_131
        sub_133 = dot_125 - rmpy_132
        rmpy_134 = gain * sub_133
        add_135 = observed_speed + rmpy_134
        rmpy_136 = disturbance * c_delay
        add_137 = add_135 + rmpy_136
        sub_138 = add_137 - at_28
        rmpy_139 = sub_138 * wheel_bounded
        speed_ahead = sub_138 + rmpy_139
        add_141 = observed_speed + speed_ahead
        rmpy_142 = add_141 * c_advance
        sub_143 = at_20 - clip_66
        clip_144 = c_minus_gap_max if c_minus_gap_max > sub_143 else sub_143
        if c_gap_max < clip_144:
            clip_144 = c_gap_max
        convert_145 = clip_144
        add_146 = place_correction + rmpy_142
        sub_147 = convert_145 - add_146
        position_error = c_minus_position_error_max if c_minus_position_error_max > sub_147 else sub_147
        if c_position_error_max < position_error:
            position_error = c_position_error_max
        sub_149 = at_21 - speed_ahead
        speed_error = c_minus_speed_error_max if c_minus_speed_error_max > sub_149 else sub_149
        if c_speed_error_max < speed_error:
            speed_error = c_speed_error_max
        rmpy_151 = at_23 * wheel_bounded
        sub_152 = at_23 - rmpy_151
        sub_153 = sub_152 - disturbance
        sub_154 = sub_153 - force
        rmpy_155 = position_error * at_33
        rmpy_156 = speed_error * at_34
        add_157 = rmpy_155 + rmpy_156
        rmpy_158 = sub_154 * c_by_force
        add_159 = add_157 + rmpy_158
        clip_160 = c_minus_capture_position if c_minus_capture_position > position_error else position_error
        if c_capture_position < clip_160:
            clip_160 = c_capture_position
        clip_161 = c_minus_capture_speed if c_minus_capture_speed > speed_error else speed_error
        if c_capture_speed < clip_161:
            clip_161 = c_capture_speed
        rmpy_162 = clip_160 * at_36
        rmpy_163 = clip_161 * at_37
        add_164 = rmpy_162 + rmpy_163
        rmpy_165 = sub_154 * at_38
        add_166 = add_164 + rmpy_165
        stop_correction = c_minus_correction_max if c_minus_correction_max > add_166 else add_166
        if c_correction_max < stop_correction:
            stop_correction = c_correction_max
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
        rmpy_178 = at_24 * lag
        add_179 = at_22 + rmpy_178
        rmpy_180 = add_179 * wheel_bounded
        sub_181 = add_179 - rmpy_180
        sub_182 = sub_181 - disturbance
        accel = sub_182 + where_177
        notch_raw = div(accel, gain, 19)
        clip_185 = at_26 if at_26 > notch_raw else notch_raw
        if at_25 < clip_185:
            clip_185 = at_25
        notch = quantise(clip_185, 19, 8)
        convert_187 = notch
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
