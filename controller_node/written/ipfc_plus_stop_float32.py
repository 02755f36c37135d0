"""Law ipfc_plus_stop in single precision. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from array import array

from railhil.controller_node.arithmetic.float32 import FLT_MAX, FLT_MIN
from railhil.controller_node.written.parts import Parts, Step, Values


def step(parts: Parts) -> Step:
    single = array("f", [0.0])
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
    quantise = parts.number.quantise

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
        clip_42 = c_zero if c_zero > in_track_balise_position_01mm else in_track_balise_position_01mm
        if c_odometer_max < clip_42:
            clip_42 = c_odometer_max
        clip_43 = c_zero if c_zero > in_track_balise_odometer_01mm else in_track_balise_odometer_01mm
        if c_odometer_max < clip_43:
            clip_43 = c_odometer_max
        single[0] = clip_43 * c_per_distance
        rmpy_44 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_42 - clip_43
        sub_45 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_45 * c_per_distance
        rmpy_46 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_44 * rmpy_44
        rmpy_47 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_balises_squares + rmpy_47
        add_48 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_49 = c_minus_wheel_max if c_minus_wheel_max > rmpy_46 else rmpy_46
        if c_wheel_max < clip_49:
            clip_49 = c_wheel_max
        single[0] = rmpy_44 * clip_49
        rmpy_50 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_balises_errors + rmpy_50
        add_51 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_52 = c_minus_sum_max if c_minus_sum_max > add_51 else add_51
        if c_sum_max < clip_52:
            clip_52 = c_sum_max
        single[0] = in_track_balise_number - state_balises_number
        sub_53 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_54 = abs(sub_53)
        gt_55 = abs_54 > c_zero
        single[0] = rmpy_44 * c_wheel_max
        rmpy_56 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_56 + c_balise_slack
        add_57 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
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
        wheel = c_minus_wheel_max if c_minus_wheel_max > div_67 else div_67
        if c_wheel_max < wheel:
            wheel = c_wheel_max
        clip_69 = c_zero if c_zero > in_track_position_01mm else in_track_position_01mm
        if c_odometer_max < clip_69:
            clip_69 = c_odometer_max
        single[0] = clip_69 * wheel
        correction = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_71 = c_zero if c_zero > in_track_balise_position_01mm else in_track_balise_position_01mm
        if c_odometer_max < clip_71:
            clip_71 = c_odometer_max
        clip_72 = c_zero if c_zero > in_track_balise_odometer_01mm else in_track_balise_odometer_01mm
        if c_odometer_max < clip_72:
            clip_72 = c_odometer_max
        single[0] = clip_72 * c_per_distance
        rmpy_73 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_71 - clip_72
        sub_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_74 * c_per_distance
        rmpy_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_76 = c_minus_bound_max if c_minus_bound_max > rmpy_75 else rmpy_75
        if c_bound_max < clip_76:
            clip_76 = c_bound_max
        maximum_77 = c_share_min if c_share_min > rmpy_73 else rmpy_73
        convert_78 = maximum_77
        single[0] = clip_76 - c_tolerance
        sub_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        div_80 = div(sub_79, convert_78, 30)
        single[0] = clip_76 + c_tolerance
        add_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        div_82 = div(add_81, convert_78, 30)
        gt_83 = balise_squares > state_balises_squares
        gt_84 = rmpy_73 > c_share_min
        maximum_85 = state_wheel_low if state_wheel_low > div_80 else div_80
        clip_86 = c_minus_wheel_max_2 if c_minus_wheel_max_2 > maximum_85 else maximum_85
        if c_wheel_max < clip_86:
            clip_86 = c_wheel_max
        where_87 = clip_86 if gt_84 else state_wheel_low
        wheel_low = where_87 if gt_83 else state_wheel_low
        minimum_89 = state_wheel_high if state_wheel_high < div_82 else div_82
        clip_90 = c_minus_wheel_max_2 if c_minus_wheel_max_2 > minimum_89 else minimum_89
        if c_wheel_max < clip_90:
            clip_90 = c_wheel_max
        where_91 = clip_90 if gt_84 else state_wheel_high
        wheel_high = where_91 if gt_83 else state_wheel_high
        single[0] = wheel_low + wheel_high
        add_93 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_93 * c_half
        rmpy_94 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_95 = wheel_low > wheel_high
        wheel_bounded = wheel if gt_95 else rmpy_94
        single[0] = clip_69 * wheel_bounded
        place_correction = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_lagged_0 * state_observer_lagged
        lagged = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_lagged_1 * state_notch_before
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lagged + product
        lagged = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_lagged_2 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lagged + product
        lagged = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_twice_0 * state_observer_lagged_twice
        lagged_twice = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_twice_1 * state_observer_lagged
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lagged_twice + product
        lagged_twice = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_twice_2 * state_notch_before
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lagged_twice + product
        lagged_twice = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_twice_3 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lagged_twice + product
        lagged_twice = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_integral_0 * state_observer_lagged
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_integral_1 * state_notch_before
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 + product
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_integral_2 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 + product
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lagged_twice - state_observer_lagged_twice
        sub_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_lag * sub_101
        rmpy_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lagged - state_observer_lagged
        sub_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_delay * sub_103
        rmpy_104 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_102 + rmpy_104
        add_105 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 - add_105
        sub_106 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_gain * sub_106
        rmpy_107 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_speed + rmpy_107
        add_108 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_disturbance * c_period
        rmpy_109 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_108 + rmpy_109
        add_110 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_110 - at_29
        sub_111 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_112 = in_speed > c_zero
        gt_113 = sub_111 > c_standstill
        where_114 = sub_111 if gt_113 else c_zero
        expected = sub_111 if gt_112 else where_114
        single[0] = in_speed - expected
        sub_116 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_117 = c_minus_innovation_max if c_minus_innovation_max > sub_116 else sub_116
        if c_innovation_max < clip_117:
            clip_117 = c_innovation_max
        surprise = clip_117 if gt_112 else c_zero
        single[0] = surprise * at_31
        rmpy_119 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = expected + rmpy_119
        add_120 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        observed_speed = c_minus_speed_max if c_minus_speed_max > add_120 else add_120
        if c_speed_max < observed_speed:
            observed_speed = c_speed_max
        single[0] = surprise * at_32
        rmpy_122 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_disturbance + rmpy_122
        add_123 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        disturbance = c_minus_disturbance_max if c_minus_disturbance_max > add_123 else add_123
        if c_disturbance_max < disturbance:
            disturbance = c_disturbance_max
        single[0] = surprise * at_33
        rmpy_125 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_gain + rmpy_125
        add_126 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gain = c_gain_min if c_gain_min > add_126 else add_126
        if c_gain_max < gain:
            gain = c_gain_max
        single[0] = surprise * at_34
        rmpy_128 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_lag + rmpy_128
        add_129 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        lag = c_minus_lag_max if c_minus_lag_max > add_129 else add_129
        if c_lag_max < lag:
            lag = c_lag_max
        single[0] = surprise * at_37
        rmpy_131 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_delay + rmpy_131
        add_132 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        delay = c_minus_delay_max if c_minus_delay_max > add_132 else add_132
        if c_delay_max < delay:
            delay = c_delay_max
        single[0] = c_delay_lagged_0 * lagged
        dot_134 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_lagged_1 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_134 + product
        dot_134 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_integral_0 * lagged
        dot_135 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_integral_1 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_135 + product
        dot_135 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_twice_0 * lagged_twice
        dot_136 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_twice_1 * lagged
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_136 + product
        dot_136 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_twice_2 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_136 + product
        dot_136 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_134 - dot_136
        sub_137 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lag * sub_137
        rmpy_138 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_notch - dot_134
        sub_139 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = delay * sub_139
        rmpy_140 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_138 + rmpy_140
        add_141 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_141 * c_pole
        rmpy_142 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_134 - rmpy_142
        sub_143 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = gain * sub_143
        force = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_136 - lagged_twice
        sub_145 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lag * sub_145
        rmpy_146 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_134 - lagged
        sub_147 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = delay * sub_147
        rmpy_148 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_146 + rmpy_148
        add_149 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_135 - add_149
        sub_150 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = gain * sub_150
        rmpy_151 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = observed_speed + rmpy_151
        add_152 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = disturbance * c_delay
        rmpy_153 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_152 + rmpy_153
        add_154 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_154 - at_30
        sub_155 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_155 * wheel_bounded
        rmpy_156 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_155 + rmpy_156
        speed_ahead = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = observed_speed + speed_ahead
        add_158 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_158 * c_advance
        rmpy_159 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_22 - clip_69
        sub_160 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_161 = c_minus_gap_max if c_minus_gap_max > sub_160 else sub_160
        if c_gap_max < clip_161:
            clip_161 = c_gap_max
        convert_162 = clip_161
        single[0] = place_correction + rmpy_159
        add_163 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_162 - add_163
        sub_164 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        position_error = c_minus_position_error_max if c_minus_position_error_max > sub_164 else sub_164
        if c_position_error_max < position_error:
            position_error = c_position_error_max
        single[0] = at_23 - speed_ahead
        sub_166 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        speed_error = c_minus_speed_error_max if c_minus_speed_error_max > sub_166 else sub_166
        if c_speed_error_max < speed_error:
            speed_error = c_speed_error_max
        single[0] = at_25 * wheel_bounded
        rmpy_168 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_25 - rmpy_168
        sub_169 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_169 - disturbance
        sub_170 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_170 - force
        sub_171 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = position_error * at_35
        rmpy_172 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = speed_error * at_36
        rmpy_173 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_172 + rmpy_173
        add_174 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_171 * c_by_force
        rmpy_175 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_174 + rmpy_175
        add_176 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_177 = c_minus_capture_position if c_minus_capture_position > position_error else position_error
        if c_capture_position < clip_177:
            clip_177 = c_capture_position
        clip_178 = c_minus_capture_speed if c_minus_capture_speed > speed_error else speed_error
        if c_capture_speed < clip_178:
            clip_178 = c_capture_speed
        single[0] = clip_177 * at_39
        rmpy_179 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_178 * at_40
        rmpy_180 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_179 + rmpy_180
        add_181 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_182 = c_minus_force_error_max if c_minus_force_error_max > sub_171 else sub_171
        if c_force_error_max < clip_182:
            clip_182 = c_force_error_max
        single[0] = clip_182 * at_41
        rmpy_183 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_181 + rmpy_183
        add_184 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        stop_correction = c_minus_correction_max if c_minus_correction_max > add_184 else add_184
        if c_correction_max < stop_correction:
            stop_correction = c_correction_max
        single[0] = position_error - clip_177
        sub_186 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_187 = abs(sub_186)
        single[0] = speed_error - clip_178
        sub_188 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_189 = abs(sub_188)
        gt_190 = abs_187 > c_zero
        gt_191 = abs_189 > c_zero
        where_192 = add_176 if gt_191 else stop_correction
        where_193 = add_176 if gt_190 else where_192
        gt_194 = at_38 > c_zero
        where_195 = where_193 if gt_194 else add_176
        single[0] = lag + delay
        add_196 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_26 * add_196
        rmpy_197 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_24 + rmpy_197
        add_198 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_198 * wheel_bounded
        rmpy_199 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_198 - rmpy_199
        sub_200 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_200 - disturbance
        sub_201 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_201 + where_195
        accel = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        notch_raw = div(accel, gain, 19)
        clip_204 = at_28 if at_28 > notch_raw else notch_raw
        if at_27 < clip_204:
            clip_204 = at_27
        notch = quantise(clip_204, 19, 8)
        convert_206 = notch
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
