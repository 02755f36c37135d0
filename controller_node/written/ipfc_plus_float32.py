"""Law ipfc_plus in single precision. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from array import array

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
            position_01mm,
            balise,
            balise_01mm,
            balise_odometer_01mm,
        ) = given
        single[0] = speed_01mmps * c_kmh_per_01mmps
        speed = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
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
    quantise = parts.number.quantise

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
        clip_33 = c_zero if c_zero > in_track_balise_position_01mm else in_track_balise_position_01mm
        if c_odometer_max < clip_33:
            clip_33 = c_odometer_max
        clip_34 = c_zero if c_zero > in_track_balise_odometer_01mm else in_track_balise_odometer_01mm
        if c_odometer_max < clip_34:
            clip_34 = c_odometer_max
        single[0] = clip_34 * c_per_distance
        rmpy_35 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_33 - clip_34
        sub_36 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_36 * c_per_distance
        rmpy_37 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_35 * rmpy_35
        rmpy_38 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_balises_squares + rmpy_38
        add_39 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_40 = c_minus_wheel_max if c_minus_wheel_max > rmpy_37 else rmpy_37
        if c_wheel_max < clip_40:
            clip_40 = c_wheel_max
        single[0] = rmpy_35 * clip_40
        rmpy_41 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_balises_errors + rmpy_41
        add_42 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_43 = c_minus_sum_max if c_minus_sum_max > add_42 else add_42
        if c_sum_max < clip_43:
            clip_43 = c_sum_max
        single[0] = in_track_balise_number - state_balises_number
        sub_44 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_45 = abs(sub_44)
        gt_46 = abs_45 > c_zero
        single[0] = rmpy_35 * c_wheel_max
        rmpy_47 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_47 + c_balise_slack
        add_48 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
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
        wheel = c_minus_wheel_max if c_minus_wheel_max > div_58 else div_58
        if c_wheel_max < wheel:
            wheel = c_wheel_max
        clip_60 = c_zero if c_zero > in_track_position_01mm else in_track_position_01mm
        if c_odometer_max < clip_60:
            clip_60 = c_odometer_max
        single[0] = clip_60 * wheel
        correction = value = single[0] + 0.0
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
        single[0] = c_integral_0 * state_observer_lagged
        dot_63 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_integral_1 * state_notch_before
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_63 + product
        dot_63 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_integral_2 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_63 + product
        dot_63 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lagged - state_observer_lagged
        sub_64 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_lag * sub_64
        rmpy_65 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_63 - rmpy_65
        sub_66 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_gain * sub_66
        rmpy_67 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_speed + rmpy_67
        add_68 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_disturbance * c_period
        rmpy_69 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_68 + rmpy_69
        add_70 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_70 - at_25
        sub_71 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_72 = in_speed > c_zero
        gt_73 = sub_71 > c_standstill
        where_74 = sub_71 if gt_73 else c_zero
        expected = sub_71 if gt_72 else where_74
        single[0] = in_speed - expected
        sub_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_77 = c_minus_innovation_max if c_minus_innovation_max > sub_76 else sub_76
        if c_innovation_max < clip_77:
            clip_77 = c_innovation_max
        surprise = clip_77 if gt_72 else c_zero
        single[0] = surprise * at_27
        rmpy_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = expected + rmpy_79
        add_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        observed_speed = c_minus_speed_max if c_minus_speed_max > add_80 else add_80
        if c_speed_max < observed_speed:
            observed_speed = c_speed_max
        single[0] = surprise * at_28
        rmpy_82 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_disturbance + rmpy_82
        add_83 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        disturbance = c_minus_disturbance_max if c_minus_disturbance_max > add_83 else add_83
        if c_disturbance_max < disturbance:
            disturbance = c_disturbance_max
        single[0] = surprise * at_29
        rmpy_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_gain + rmpy_85
        add_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gain = c_gain_min if c_gain_min > add_86 else add_86
        if c_gain_max < gain:
            gain = c_gain_max
        single[0] = surprise * at_30
        rmpy_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_observer_lag + rmpy_88
        add_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        lag = c_minus_lag_max if c_minus_lag_max > add_89 else add_89
        if c_lag_max < lag:
            lag = c_lag_max
        single[0] = c_delay_lagged_0 * lagged
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_lagged_1 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 + product
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_integral_0 * lagged
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_delay_integral_1 * state_notch
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_92 + product
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_notch - dot_91
        sub_93 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_93 * c_pole
        rmpy_94 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lag * rmpy_94
        rmpy_95 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 - rmpy_95
        sub_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = gain * sub_96
        force = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 - lagged
        sub_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = lag * sub_98
        rmpy_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_92 - rmpy_99
        sub_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = gain * sub_100
        rmpy_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = observed_speed + rmpy_101
        add_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = disturbance * c_delay
        rmpy_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_102 + rmpy_103
        add_104 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_104 - at_26
        sub_105 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_105 * wheel
        rmpy_106 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_105 + rmpy_106
        speed_ahead = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = observed_speed + speed_ahead
        add_108 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_108 * c_advance
        rmpy_109 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_18 - clip_60
        sub_110 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_111 = c_minus_gap_max if c_minus_gap_max > sub_110 else sub_110
        if c_gap_max < clip_111:
            clip_111 = c_gap_max
        convert_112 = clip_111
        single[0] = correction + rmpy_109
        add_113 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = convert_112 - add_113
        sub_114 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        position_error = c_minus_position_error_max if c_minus_position_error_max > sub_114 else sub_114
        if c_position_error_max < position_error:
            position_error = c_position_error_max
        single[0] = at_19 - speed_ahead
        sub_116 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        speed_error = c_minus_speed_error_max if c_minus_speed_error_max > sub_116 else sub_116
        if c_speed_error_max < speed_error:
            speed_error = c_speed_error_max
        single[0] = at_22 * lag
        rmpy_118 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_20 + rmpy_118
        add_119 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_119 - disturbance
        sub_120 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = position_error * at_31
        rmpy_121 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_120 + rmpy_121
        add_122 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = speed_error * at_32
        rmpy_123 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_122 + rmpy_123
        add_124 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_21 - disturbance
        sub_125 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_125 - force
        sub_126 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_126 * c_by_force
        rmpy_127 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_124 + rmpy_127
        accel = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        notch_raw = div(accel, gain, 19)
        clip_130 = at_24 if at_24 > notch_raw else notch_raw
        if at_23 < clip_130:
            clip_130 = at_23
        notch = quantise(clip_130, 19, 8)
        convert_132 = notch
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
