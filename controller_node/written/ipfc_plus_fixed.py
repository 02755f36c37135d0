"""Law ipfc_plus in fixed point. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

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
        low_balise,
        high_balise,
        low_balise_01mm,
        high_balise_01mm,
        low_balise_odometer_01mm,
        high_balise_odometer_01mm,
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            k,
            speed_01mmps,
            position_01mm,
            balise,
            balise_01mm,
            balise_odometer_01mm,
        ) = given
        if not low_speed_01mmps <= speed_01mmps <= high_speed_01mmps:
            return None
        if not low_position_01mm <= position_01mm <= high_position_01mm:
            return None
        if not low_balise <= balise <= high_balise:
            return None
        if not low_balise_01mm <= balise_01mm <= high_balise_01mm:
            return None
        if not low_balise_odometer_01mm <= balise_odometer_01mm <= high_balise_odometer_01mm:
            return None
        speed = speed_01mmps * c_kmh_per_01mmps >> 20
        index_7 = min(max(k, 0), last_0)
        set_point = t_v_of_t[index_7]
        return (
            (),
            (
                speed,
                set_point,
                k,
                position_01mm,
                balise,
                balise_01mm,
                balise_odometer_01mm,
            ),
            (
                speed,
                set_point,
            ),
        )

    return period


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
        low_observer_lagged,
        high_observer_lagged,
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
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_observer_speed,
            state_observer_disturbance,
            state_observer_gain,
            state_observer_lag,
            state_observer_lagged,
            state_notch,
            state_notch_before,
            state_balises_number,
            state_balises_squares,
            state_balises_errors,
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
        if not low_observer_lagged <= state_observer_lagged <= high_observer_lagged:
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
        index_17 = min(max(in_track_k, 0), last_0)
        at_18 = t_target_position[index_17]
        at_19 = t_target_speed[index_17]
        at_20 = t_feed_forward[index_17]
        at_21 = t_planned_force[index_17]
        at_22 = t_force_rate[index_17]
        at_23 = t_notch_upper[index_17]
        at_24 = t_notch_lower[index_17]
        at_25 = t_drag_over_period[index_17]
        at_26 = t_drag_over_delay[index_17]
        at_27 = t_observe_speed[index_17]
        at_28 = t_observe_disturbance[index_17]
        at_29 = t_observe_gain[index_17]
        at_30 = t_observe_lag[index_17]
        at_31 = t_by_position[index_17]
        at_32 = t_by_speed[index_17]
        clip_33 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_33 < c_zero:
            clip_33 = c_zero
        clip_34 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_34 < c_zero:
            clip_34 = c_zero
        rmpy_35 = clip_34 * c_per_distance + 33554432 >> 26
        sub_36 = clip_33 - clip_34
        rmpy_37 = sub_36 * c_per_distance + 8388608 >> 24
        rmpy_38 = rmpy_35 * rmpy_35 + 536870912 >> 30
        add_39 = state_balises_squares + rmpy_38
        clip_40 = rmpy_37 if rmpy_37 < c_wheel_max else c_wheel_max
        if clip_40 < c_minus_wheel_max:
            clip_40 = c_minus_wheel_max
        rmpy_41 = rmpy_35 * clip_40 + 2147483648 >> 32
        add_42 = state_balises_errors + rmpy_41
        clip_43 = add_42 if add_42 < c_sum_max else c_sum_max
        if clip_43 < c_minus_sum_max:
            clip_43 = c_minus_sum_max
        sub_44 = in_track_balise_number - state_balises_number
        abs_45 = abs(sub_44)
        gt_46 = abs_45 > c_zero
        rmpy_47 = rmpy_35 * c_wheel_max + 134217728 >> 28
        add_48 = rmpy_47 + c_balise_slack
        abs_49 = abs(rmpy_37)
        gt_50 = add_48 > abs_49
        gt_51 = c_sum_max > add_39
        where_52 = add_39 if gt_51 else state_balises_squares
        where_53 = where_52 if gt_50 else state_balises_squares
        balise_squares = where_53 if gt_46 else state_balises_squares
        where_55 = clip_43 if gt_51 else state_balises_errors
        where_56 = where_55 if gt_50 else state_balises_errors
        balise_errors = where_56 if gt_46 else state_balises_errors
        div_58 = div(balise_errors, balise_squares, 30)
        wheel = div_58 if div_58 < c_wheel_max else c_wheel_max
        if wheel < c_minus_wheel_max:
            wheel = c_minus_wheel_max
        clip_60 = in_track_position_01mm if in_track_position_01mm < c_odometer_max else c_odometer_max
        if clip_60 < c_zero:
            clip_60 = c_zero
        correction = clip_60 * wheel + 8388608 >> 24
        lagged = c_lagged_0 * state_observer_lagged + 8388608 >> 24
        lagged += c_lagged_1 * state_notch_before + 8388608 >> 24
        lagged += c_lagged_2 * state_notch + 8388608 >> 24
        dot_63 = c_integral_0 * state_observer_lagged + 8388608 >> 24
        dot_63 += c_integral_1 * state_notch_before + 8388608 >> 24
        dot_63 += c_integral_2 * state_notch + 8388608 >> 24
        sub_64 = lagged - state_observer_lagged
        rmpy_65 = state_observer_lag * sub_64 + 8388608 >> 24
        sub_66 = dot_63 - rmpy_65
        rmpy_67 = state_observer_gain * sub_66 + 33554432 >> 26
        add_68 = state_observer_speed + rmpy_67
        rmpy_69 = state_observer_disturbance * c_period + 33554432 >> 26
        add_70 = add_68 + rmpy_69
        sub_71 = add_70 - at_25
        gt_72 = in_speed > c_zero
        gt_73 = sub_71 > c_standstill
        where_74 = sub_71 if gt_73 else c_zero
        expected = sub_71 if gt_72 else where_74
        sub_76 = in_speed - expected
        clip_77 = sub_76 if sub_76 < c_innovation_max else c_innovation_max
        if clip_77 < c_minus_innovation_max:
            clip_77 = c_minus_innovation_max
        surprise = clip_77 if gt_72 else c_zero
        rmpy_79 = surprise * at_27 + 8388608 >> 24
        add_80 = expected + rmpy_79
        observed_speed = add_80 if add_80 < c_speed_max else c_speed_max
        if observed_speed < c_minus_speed_max:
            observed_speed = c_minus_speed_max
        rmpy_82 = surprise * at_28 + 2097152 >> 22
        add_83 = state_observer_disturbance + rmpy_82
        disturbance = add_83 if add_83 < c_disturbance_max else c_disturbance_max
        if disturbance < c_minus_disturbance_max:
            disturbance = c_minus_disturbance_max
        rmpy_85 = surprise * at_29 + 2097152 >> 22
        add_86 = state_observer_gain + rmpy_85
        gain = add_86 if add_86 < c_gain_max else c_gain_max
        if gain < c_gain_min:
            gain = c_gain_min
        rmpy_88 = surprise * at_30 + 524288 >> 20
        add_89 = state_observer_lag + rmpy_88
        lag = add_89 if add_89 < c_lag_max else c_lag_max
        if lag < c_minus_lag_max:
            lag = c_minus_lag_max
        dot_91 = c_delay_lagged_0 * lagged + 8388608 >> 24
        dot_91 += c_delay_lagged_1 * state_notch + 8388608 >> 24
        dot_92 = c_delay_integral_0 * lagged + 8388608 >> 24
        dot_92 += c_delay_integral_1 * state_notch + 8388608 >> 24
        sub_93 = state_notch - dot_91
        rmpy_94 = sub_93 * c_pole + 8388608 >> 24
        rmpy_95 = lag * rmpy_94 + 8388608 >> 24
        sub_96 = dot_91 - rmpy_95
        force = gain * sub_96 + 8388608 >> 24
        sub_98 = dot_91 - lagged
        rmpy_99 = lag * sub_98 + 8388608 >> 24
        sub_100 = dot_92 - rmpy_99
        rmpy_101 = gain * sub_100 + 33554432 >> 26
        add_102 = observed_speed + rmpy_101
        rmpy_103 = disturbance * c_delay + 33554432 >> 26
        add_104 = add_102 + rmpy_103
        sub_105 = add_104 - at_26
        rmpy_106 = sub_105 * wheel + 536870912 >> 30
        speed_ahead = sub_105 + rmpy_106
        add_108 = observed_speed + speed_ahead
        rmpy_109 = add_108 * c_advance + 536870912 >> 30
        sub_110 = at_18 - clip_60
        clip_111 = sub_110 if sub_110 < c_gap_max else c_gap_max
        if clip_111 < c_minus_gap_max:
            clip_111 = c_minus_gap_max
        convert_112 = clip_111 << 6
        add_113 = correction + rmpy_109
        sub_114 = convert_112 - add_113
        position_error = sub_114 if sub_114 < c_position_error_max else c_position_error_max
        if position_error < c_minus_position_error_max:
            position_error = c_minus_position_error_max
        sub_116 = at_19 - speed_ahead
        speed_error = sub_116 if sub_116 < c_speed_error_max else c_speed_error_max
        if speed_error < c_minus_speed_error_max:
            speed_error = c_minus_speed_error_max
        rmpy_118 = at_22 * lag + 8388608 >> 24
        add_119 = at_20 + rmpy_118
        sub_120 = add_119 - disturbance
        rmpy_121 = position_error * at_31 + 8388608 >> 24
        add_122 = sub_120 + rmpy_121
        rmpy_123 = speed_error * at_32 + 2097152 >> 22
        add_124 = add_122 + rmpy_123
        sub_125 = at_21 - disturbance
        sub_126 = sub_125 - force
        rmpy_127 = sub_126 * c_by_force + 8388608 >> 24
        accel = add_124 + rmpy_127
        notch_raw = div(accel, gain, 19)
        if at_24 > at_23:
            return None
        clip_130 = notch_raw if notch_raw < at_23 else at_23
        if clip_130 < at_24:
            clip_130 = at_24
        notch = clip_130 + 1024 >> 11
        convert_132 = notch << 16
        return (
            (
                observed_speed,
                disturbance,
                gain,
                lag,
                lagged,
                convert_132,
                state_notch,
                in_track_balise_number,
                balise_squares,
                balise_errors,
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
                accel,
                notch_raw,
                notch,
            ),
        )

    return period


def step_2(parts: Parts) -> Step:
    (
        c_odometer_max,
        c_zero,
        c_per_distance,
        c_wheel_max,
        c_minus_wheel_max,
        c_sum_max,
        c_minus_sum_max,
        c_balise_slack,
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
        low_observer_lagged,
        high_observer_lagged,
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
    ) = parts.bounds

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_observer_speed,
            state_observer_disturbance,
            state_observer_gain,
            state_observer_lag,
            state_observer_lagged,
            state_notch,
            state_notch_before,
            state_balises_number,
            state_balises_squares,
            state_balises_errors,
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
        if not low_observer_lagged <= state_observer_lagged <= high_observer_lagged:
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
        index_17 = min(max(in_track_k, 0), last_0)
        at_18 = t_target_position[index_17]
        at_19 = t_target_speed[index_17]
        at_20 = t_feed_forward[index_17]
        at_21 = t_planned_force[index_17]
        at_22 = t_force_rate[index_17]
        at_23 = t_notch_upper[index_17]
        at_24 = t_notch_lower[index_17]
        at_25 = t_drag_over_period[index_17]
        at_26 = t_drag_over_delay[index_17]
        at_27 = t_observe_speed[index_17]
        at_28 = t_observe_disturbance[index_17]
        at_29 = t_observe_gain[index_17]
        at_30 = t_observe_lag[index_17]
        at_31 = t_by_position[index_17]
        at_32 = t_by_speed[index_17]
        clip_33 = in_track_balise_position_01mm if in_track_balise_position_01mm < c_odometer_max else c_odometer_max
        if clip_33 < c_zero:
            clip_33 = c_zero
        clip_34 = in_track_balise_odometer_01mm if in_track_balise_odometer_01mm < c_odometer_max else c_odometer_max
        if clip_34 < c_zero:
            clip_34 = c_zero
        rmpy_35 = clip_34 * c_per_distance + 16777216 >> 25
        sub_36 = clip_33 - clip_34
        rmpy_37 = sub_36 * c_per_distance + 4194304 >> 23
        rmpy_38 = rmpy_35 * rmpy_35 + 536870912 >> 30
        add_39 = state_balises_squares + rmpy_38
        clip_40 = rmpy_37 if rmpy_37 < c_wheel_max else c_wheel_max
        if clip_40 < c_minus_wheel_max:
            clip_40 = c_minus_wheel_max
        rmpy_41 = rmpy_35 * clip_40 + 2147483648 >> 32
        add_42 = state_balises_errors + rmpy_41
        clip_43 = add_42 if add_42 < c_sum_max else c_sum_max
        if clip_43 < c_minus_sum_max:
            clip_43 = c_minus_sum_max
        sub_44 = in_track_balise_number - state_balises_number
        abs_45 = abs(sub_44)
        gt_46 = abs_45 > c_zero
        rmpy_47 = rmpy_35 * c_wheel_max + 134217728 >> 28
        add_48 = rmpy_47 + c_balise_slack
        abs_49 = abs(rmpy_37)
        gt_50 = add_48 > abs_49
        gt_51 = c_sum_max > add_39
        where_52 = add_39 if gt_51 else state_balises_squares
        where_53 = where_52 if gt_50 else state_balises_squares
        balise_squares = where_53 if gt_46 else state_balises_squares
        where_55 = clip_43 if gt_51 else state_balises_errors
        where_56 = where_55 if gt_50 else state_balises_errors
        balise_errors = where_56 if gt_46 else state_balises_errors
        div_58 = div(balise_errors, balise_squares, 30)
        wheel = div_58 if div_58 < c_wheel_max else c_wheel_max
        if wheel < c_minus_wheel_max:
            wheel = c_minus_wheel_max
        clip_60 = in_track_position_01mm if in_track_position_01mm < c_odometer_max else c_odometer_max
        if clip_60 < c_zero:
            clip_60 = c_zero
        correction = clip_60 * wheel + 8388608 >> 24
        lagged = c_lagged_0 * state_observer_lagged + 8388608 >> 24
        lagged += c_lagged_1 * state_notch_before + 8388608 >> 24
        lagged += c_lagged_2 * state_notch + 8388608 >> 24
        dot_63 = c_integral_0 * state_observer_lagged + 8388608 >> 24
        dot_63 += c_integral_1 * state_notch_before + 8388608 >> 24
        dot_63 += c_integral_2 * state_notch + 8388608 >> 24
        sub_64 = lagged - state_observer_lagged
        rmpy_65 = state_observer_lag * sub_64 + 8388608 >> 24
        sub_66 = dot_63 - rmpy_65
        rmpy_67 = state_observer_gain * sub_66 + 33554432 >> 26
        add_68 = state_observer_speed + rmpy_67
        rmpy_69 = state_observer_disturbance * c_period + 33554432 >> 26
        add_70 = add_68 + rmpy_69
        sub_71 = add_70 - at_25
        gt_72 = in_speed > c_zero
        gt_73 = sub_71 > c_standstill
        where_74 = sub_71 if gt_73 else c_zero
        expected = sub_71 if gt_72 else where_74
        sub_76 = in_speed - expected
        clip_77 = sub_76 if sub_76 < c_innovation_max else c_innovation_max
        if clip_77 < c_minus_innovation_max:
            clip_77 = c_minus_innovation_max
        surprise = clip_77 if gt_72 else c_zero
        rmpy_79 = surprise * at_27 + 8388608 >> 24
        add_80 = expected + rmpy_79
        observed_speed = add_80 if add_80 < c_speed_max else c_speed_max
        if observed_speed < c_minus_speed_max:
            observed_speed = c_minus_speed_max
        rmpy_82 = surprise * at_28 + 2097152 >> 22
        add_83 = state_observer_disturbance + rmpy_82
        disturbance = add_83 if add_83 < c_disturbance_max else c_disturbance_max
        if disturbance < c_minus_disturbance_max:
            disturbance = c_minus_disturbance_max
        rmpy_85 = surprise * at_29 + 2097152 >> 22
        add_86 = state_observer_gain + rmpy_85
        gain = add_86 if add_86 < c_gain_max else c_gain_max
        if gain < c_gain_min:
            gain = c_gain_min
        rmpy_88 = surprise * at_30 + 524288 >> 20
        add_89 = state_observer_lag + rmpy_88
        lag = add_89 if add_89 < c_lag_max else c_lag_max
        if lag < c_minus_lag_max:
            lag = c_minus_lag_max
        dot_91 = c_delay_lagged_0 * lagged + 8388608 >> 24
        dot_91 += c_delay_lagged_1 * state_notch + 8388608 >> 24
        dot_92 = c_delay_integral_0 * lagged + 8388608 >> 24
        dot_92 += c_delay_integral_1 * state_notch + 8388608 >> 24
        sub_93 = state_notch - dot_91
        rmpy_94 = sub_93 * c_pole + 8388608 >> 24
        rmpy_95 = lag * rmpy_94 + 8388608 >> 24
        sub_96 = dot_91 - rmpy_95
        force = gain * sub_96 + 8388608 >> 24
        sub_98 = dot_91 - lagged
        rmpy_99 = lag * sub_98 + 8388608 >> 24
        sub_100 = dot_92 - rmpy_99
        rmpy_101 = gain * sub_100 + 33554432 >> 26
        add_102 = observed_speed + rmpy_101
        rmpy_103 = disturbance * c_delay + 33554432 >> 26
        add_104 = add_102 + rmpy_103
        sub_105 = add_104 - at_26
        rmpy_106 = sub_105 * wheel + 536870912 >> 30
        speed_ahead = sub_105 + rmpy_106
        add_108 = observed_speed + speed_ahead
        rmpy_109 = add_108 * c_advance + 536870912 >> 30
        sub_110 = at_18 - clip_60
        clip_111 = sub_110 if sub_110 < c_gap_max else c_gap_max
        if clip_111 < c_minus_gap_max:
            clip_111 = c_minus_gap_max
        convert_112 = clip_111 << 6
        add_113 = correction + rmpy_109
        sub_114 = convert_112 - add_113
        position_error = sub_114 if sub_114 < c_position_error_max else c_position_error_max
        if position_error < c_minus_position_error_max:
            position_error = c_minus_position_error_max
        sub_116 = at_19 - speed_ahead
        speed_error = sub_116 if sub_116 < c_speed_error_max else c_speed_error_max
        if speed_error < c_minus_speed_error_max:
            speed_error = c_minus_speed_error_max
        rmpy_118 = at_22 * lag + 8388608 >> 24
        add_119 = at_20 + rmpy_118
        sub_120 = add_119 - disturbance
        rmpy_121 = position_error * at_31 + 8388608 >> 24
        add_122 = sub_120 + rmpy_121
        rmpy_123 = speed_error * at_32 + 2097152 >> 22
        add_124 = add_122 + rmpy_123
        sub_125 = at_21 - disturbance
        sub_126 = sub_125 - force
        rmpy_127 = sub_126 * c_by_force + 8388608 >> 24
        accel = add_124 + rmpy_127
        notch_raw = div(accel, gain, 19)
        if at_24 > at_23:
            return None
        clip_130 = notch_raw if notch_raw < at_23 else at_23
        if clip_130 < at_24:
            clip_130 = at_24
        notch = clip_130 + 1024 >> 11
        convert_132 = notch << 16
        return (
            (
                observed_speed,
                disturbance,
                gain,
                lag,
                lagged,
                convert_132,
                state_notch,
                in_track_balise_number,
                balise_squares,
                balise_errors,
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
                accel,
                notch_raw,
                notch,
            ),
        )

    return period
