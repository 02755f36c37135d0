"""Law fuzzy_pid in single precision. Written by ``make tables`` from the recorded program; do not edit."""

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
        return (
            (),
            (
                speed,
                set_point,
                at_6,
                at_7,
                at_8,
                at_9,
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
        c_error_big,
        c_minus_error_big,
        c_error_scale,
        c_peaks_6,
        c_peaks_0,
        c_peaks_1,
        c_peaks_2,
        c_peaks_3,
        c_peaks_4,
        c_peaks_5,
        c_one,
        c_zero,
        c_change_big,
        c_minus_change_big,
        c_change_scale,
        c_rules_kp_0_0,
        c_rules_kp_0_1,
        c_rules_kp_0_2,
        c_rules_kp_0_3,
        c_rules_kp_0_4,
        c_rules_kp_0_5,
        c_rules_kp_0_6,
        c_rules_kp_1_0,
        c_rules_kp_1_1,
        c_rules_kp_1_2,
        c_rules_kp_1_3,
        c_rules_kp_1_4,
        c_rules_kp_1_5,
        c_rules_kp_1_6,
        c_rules_kp_2_0,
        c_rules_kp_2_1,
        c_rules_kp_2_2,
        c_rules_kp_2_3,
        c_rules_kp_2_4,
        c_rules_kp_2_5,
        c_rules_kp_2_6,
        c_rules_kp_3_0,
        c_rules_kp_3_1,
        c_rules_kp_3_2,
        c_rules_kp_3_3,
        c_rules_kp_3_4,
        c_rules_kp_3_5,
        c_rules_kp_3_6,
        c_rules_kp_4_0,
        c_rules_kp_4_1,
        c_rules_kp_4_2,
        c_rules_kp_4_3,
        c_rules_kp_4_4,
        c_rules_kp_4_5,
        c_rules_kp_4_6,
        c_rules_kp_5_0,
        c_rules_kp_5_1,
        c_rules_kp_5_2,
        c_rules_kp_5_3,
        c_rules_kp_5_4,
        c_rules_kp_5_5,
        c_rules_kp_5_6,
        c_rules_kp_6_0,
        c_rules_kp_6_1,
        c_rules_kp_6_2,
        c_rules_kp_6_3,
        c_rules_kp_6_4,
        c_rules_kp_6_5,
        c_rules_kp_6_6,
        c_minus_one,
        c_spans_0,
        c_gains_0,
        c_rules_ki_0_0,
        c_rules_ki_0_1,
        c_rules_ki_0_2,
        c_rules_ki_0_3,
        c_rules_ki_0_4,
        c_rules_ki_0_5,
        c_rules_ki_0_6,
        c_rules_ki_1_0,
        c_rules_ki_1_1,
        c_rules_ki_1_2,
        c_rules_ki_1_3,
        c_rules_ki_1_4,
        c_rules_ki_1_5,
        c_rules_ki_1_6,
        c_rules_ki_2_0,
        c_rules_ki_2_1,
        c_rules_ki_2_2,
        c_rules_ki_2_3,
        c_rules_ki_2_4,
        c_rules_ki_2_5,
        c_rules_ki_2_6,
        c_rules_ki_3_0,
        c_rules_ki_3_1,
        c_rules_ki_3_2,
        c_rules_ki_3_3,
        c_rules_ki_3_4,
        c_rules_ki_3_5,
        c_rules_ki_3_6,
        c_rules_ki_4_0,
        c_rules_ki_4_1,
        c_rules_ki_4_2,
        c_rules_ki_4_3,
        c_rules_ki_4_4,
        c_rules_ki_4_5,
        c_rules_ki_4_6,
        c_rules_ki_5_0,
        c_rules_ki_5_1,
        c_rules_ki_5_2,
        c_rules_ki_5_3,
        c_rules_ki_5_4,
        c_rules_ki_5_5,
        c_rules_ki_5_6,
        c_rules_ki_6_0,
        c_rules_ki_6_1,
        c_rules_ki_6_2,
        c_rules_ki_6_3,
        c_rules_ki_6_4,
        c_rules_ki_6_5,
        c_rules_ki_6_6,
        c_minus_one_2,
        c_spans_1,
        c_gains_1,
        c_rules_kd_0_0,
        c_rules_kd_0_1,
        c_rules_kd_0_2,
        c_rules_kd_0_3,
        c_rules_kd_0_4,
        c_rules_kd_0_5,
        c_rules_kd_0_6,
        c_rules_kd_1_0,
        c_rules_kd_1_1,
        c_rules_kd_1_2,
        c_rules_kd_1_3,
        c_rules_kd_1_4,
        c_rules_kd_1_5,
        c_rules_kd_1_6,
        c_rules_kd_2_0,
        c_rules_kd_2_1,
        c_rules_kd_2_2,
        c_rules_kd_2_3,
        c_rules_kd_2_4,
        c_rules_kd_2_5,
        c_rules_kd_2_6,
        c_rules_kd_3_0,
        c_rules_kd_3_1,
        c_rules_kd_3_2,
        c_rules_kd_3_3,
        c_rules_kd_3_4,
        c_rules_kd_3_5,
        c_rules_kd_3_6,
        c_rules_kd_4_0,
        c_rules_kd_4_1,
        c_rules_kd_4_2,
        c_rules_kd_4_3,
        c_rules_kd_4_4,
        c_rules_kd_4_5,
        c_rules_kd_4_6,
        c_rules_kd_5_0,
        c_rules_kd_5_1,
        c_rules_kd_5_2,
        c_rules_kd_5_3,
        c_rules_kd_5_4,
        c_rules_kd_5_5,
        c_rules_kd_5_6,
        c_rules_kd_6_0,
        c_rules_kd_6_1,
        c_rules_kd_6_2,
        c_rules_kd_6_3,
        c_rules_kd_6_4,
        c_rules_kd_6_5,
        c_rules_kd_6_6,
        c_minus_one_3,
        c_spans_2,
        c_gains_2,
        c_notch_max,
        c_minus_notch_max,
    ) = parts.constants
    quantise = parts.number.quantise

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_error,
            state_change,
            state_notch,
        ) = state
        (
            in_speed,
            in_set_point,
            _in_preview_0,
            _in_preview_1,
            _in_preview_2,
            in_preview_3,
        ) = given
        single[0] = in_set_point - in_speed
        error = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = error - state_error
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change - state_change
        bend = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_12 = c_minus_error_big if c_minus_error_big > error else error
        if c_error_big < clip_12:
            clip_12 = c_error_big
        single[0] = clip_12 * c_error_scale
        rmpy_13 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_14 = c_peaks_0 if c_peaks_0 > rmpy_13 else rmpy_13
        if c_peaks_6 < clip_14:
            clip_14 = c_peaks_6
        single[0] = clip_14 - c_peaks_0
        sub_15 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_16 = abs(sub_15)
        single[0] = clip_14 - c_peaks_1
        sub_17 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_18 = abs(sub_17)
        single[0] = clip_14 - c_peaks_2
        sub_19 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_20 = abs(sub_19)
        single[0] = clip_14 - c_peaks_3
        sub_21 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_22 = abs(sub_21)
        single[0] = clip_14 - c_peaks_4
        sub_23 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_24 = abs(sub_23)
        single[0] = clip_14 - c_peaks_5
        sub_25 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_26 = abs(sub_25)
        single[0] = clip_14 - c_peaks_6
        sub_27 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_28 = abs(sub_27)
        single[0] = c_one - abs_16
        sub_29 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_30 = c_zero if c_zero > sub_29 else sub_29
        single[0] = c_one - abs_18
        sub_31 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_32 = c_zero if c_zero > sub_31 else sub_31
        single[0] = c_one - abs_20
        sub_33 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_34 = c_zero if c_zero > sub_33 else sub_33
        single[0] = c_one - abs_22
        sub_35 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_36 = c_zero if c_zero > sub_35 else sub_35
        single[0] = c_one - abs_24
        sub_37 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_38 = c_zero if c_zero > sub_37 else sub_37
        single[0] = c_one - abs_26
        sub_39 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_40 = c_zero if c_zero > sub_39 else sub_39
        single[0] = c_one - abs_28
        sub_41 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_42 = c_zero if c_zero > sub_41 else sub_41
        clip_43 = c_minus_change_big if c_minus_change_big > change else change
        if c_change_big < clip_43:
            clip_43 = c_change_big
        single[0] = clip_43 * c_change_scale
        rmpy_44 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_45 = c_peaks_0 if c_peaks_0 > rmpy_44 else rmpy_44
        if c_peaks_6 < clip_45:
            clip_45 = c_peaks_6
        single[0] = clip_45 - c_peaks_0
        sub_46 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_47 = abs(sub_46)
        single[0] = clip_45 - c_peaks_1
        sub_48 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_49 = abs(sub_48)
        single[0] = clip_45 - c_peaks_2
        sub_50 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_51 = abs(sub_50)
        single[0] = clip_45 - c_peaks_3
        sub_52 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_53 = abs(sub_52)
        single[0] = clip_45 - c_peaks_4
        sub_54 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_55 = abs(sub_54)
        single[0] = clip_45 - c_peaks_5
        sub_56 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_57 = abs(sub_56)
        single[0] = clip_45 - c_peaks_6
        sub_58 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_59 = abs(sub_58)
        single[0] = c_one - abs_47
        sub_60 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_61 = c_zero if c_zero > sub_60 else sub_60
        single[0] = c_one - abs_49
        sub_62 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_63 = c_zero if c_zero > sub_62 else sub_62
        single[0] = c_one - abs_51
        sub_64 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_65 = c_zero if c_zero > sub_64 else sub_64
        single[0] = c_one - abs_53
        sub_66 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_67 = c_zero if c_zero > sub_66 else sub_66
        single[0] = c_one - abs_55
        sub_68 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_69 = c_zero if c_zero > sub_68 else sub_68
        single[0] = c_one - abs_57
        sub_70 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_71 = c_zero if c_zero > sub_70 else sub_70
        single[0] = c_one - abs_59
        sub_72 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_73 = c_zero if c_zero > sub_72 else sub_72
        single[0] = c_rules_kp_0_0 * maximum_61
        dot_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_0_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_74 + product
        dot_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_0_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_74 + product
        dot_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_0_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_74 + product
        dot_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_0_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_74 + product
        dot_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_0_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_74 + product
        dot_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_0_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_74 + product
        dot_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_1_0 * maximum_61
        dot_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_1_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_75 + product
        dot_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_1_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_75 + product
        dot_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_1_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_75 + product
        dot_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_1_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_75 + product
        dot_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_1_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_75 + product
        dot_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_1_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_75 + product
        dot_75 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_2_0 * maximum_61
        dot_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_2_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_76 + product
        dot_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_2_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_76 + product
        dot_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_2_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_76 + product
        dot_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_2_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_76 + product
        dot_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_2_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_76 + product
        dot_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_2_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_76 + product
        dot_76 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_3_0 * maximum_61
        dot_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_3_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_77 + product
        dot_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_3_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_77 + product
        dot_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_3_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_77 + product
        dot_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_3_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_77 + product
        dot_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_3_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_77 + product
        dot_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_3_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_77 + product
        dot_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_4_0 * maximum_61
        dot_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_4_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_78 + product
        dot_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_4_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_78 + product
        dot_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_4_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_78 + product
        dot_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_4_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_78 + product
        dot_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_4_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_78 + product
        dot_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_4_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_78 + product
        dot_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_5_0 * maximum_61
        dot_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_5_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_79 + product
        dot_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_5_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_79 + product
        dot_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_5_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_79 + product
        dot_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_5_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_79 + product
        dot_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_5_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_79 + product
        dot_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_5_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_79 + product
        dot_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_6_0 * maximum_61
        dot_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_6_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_80 + product
        dot_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_6_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_80 + product
        dot_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_6_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_80 + product
        dot_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_6_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_80 + product
        dot_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_6_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_80 + product
        dot_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kp_6_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_80 + product
        dot_80 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_74 * maximum_30
        dot_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_75 * maximum_32
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_81 + product
        dot_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_76 * maximum_34
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_81 + product
        dot_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_77 * maximum_36
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_81 + product
        dot_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_78 * maximum_38
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_81 + product
        dot_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_79 * maximum_40
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_81 + product
        dot_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_80 * maximum_42
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_81 + product
        dot_81 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_82 = c_minus_one if c_minus_one > dot_81 else dot_81
        if c_one < clip_82:
            clip_82 = c_one
        single[0] = c_spans_0 * clip_82
        rmpy_83 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_0 + rmpy_83
        gain_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_0_0 * maximum_61
        dot_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_0_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_85 + product
        dot_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_0_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_85 + product
        dot_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_0_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_85 + product
        dot_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_0_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_85 + product
        dot_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_0_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_85 + product
        dot_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_0_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_85 + product
        dot_85 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_1_0 * maximum_61
        dot_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_1_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_86 + product
        dot_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_1_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_86 + product
        dot_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_1_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_86 + product
        dot_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_1_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_86 + product
        dot_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_1_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_86 + product
        dot_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_1_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_86 + product
        dot_86 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_2_0 * maximum_61
        dot_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_2_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_87 + product
        dot_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_2_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_87 + product
        dot_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_2_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_87 + product
        dot_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_2_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_87 + product
        dot_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_2_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_87 + product
        dot_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_2_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_87 + product
        dot_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_3_0 * maximum_61
        dot_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_3_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_88 + product
        dot_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_3_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_88 + product
        dot_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_3_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_88 + product
        dot_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_3_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_88 + product
        dot_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_3_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_88 + product
        dot_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_3_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_88 + product
        dot_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_4_0 * maximum_61
        dot_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_4_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_89 + product
        dot_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_4_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_89 + product
        dot_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_4_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_89 + product
        dot_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_4_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_89 + product
        dot_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_4_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_89 + product
        dot_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_4_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_89 + product
        dot_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_5_0 * maximum_61
        dot_90 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_5_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_90 + product
        dot_90 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_5_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_90 + product
        dot_90 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_5_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_90 + product
        dot_90 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_5_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_90 + product
        dot_90 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_5_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_90 + product
        dot_90 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_5_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_90 + product
        dot_90 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_6_0 * maximum_61
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_6_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 + product
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_6_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 + product
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_6_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 + product
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_6_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 + product
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_6_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 + product
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_ki_6_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 + product
        dot_91 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_85 * maximum_30
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_86 * maximum_32
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_92 + product
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_87 * maximum_34
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_92 + product
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_88 * maximum_36
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_92 + product
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_89 * maximum_38
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_92 + product
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_90 * maximum_40
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_92 + product
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_91 * maximum_42
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_92 + product
        dot_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_93 = c_minus_one_2 if c_minus_one_2 > dot_92 else dot_92
        if c_one < clip_93:
            clip_93 = c_one
        single[0] = c_spans_1 * clip_93
        rmpy_94 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_1 + rmpy_94
        gain_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_0_0 * maximum_61
        dot_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_0_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_96 + product
        dot_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_0_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_96 + product
        dot_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_0_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_96 + product
        dot_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_0_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_96 + product
        dot_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_0_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_96 + product
        dot_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_0_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_96 + product
        dot_96 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_1_0 * maximum_61
        dot_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_1_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_97 + product
        dot_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_1_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_97 + product
        dot_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_1_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_97 + product
        dot_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_1_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_97 + product
        dot_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_1_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_97 + product
        dot_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_1_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_97 + product
        dot_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_2_0 * maximum_61
        dot_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_2_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_98 + product
        dot_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_2_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_98 + product
        dot_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_2_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_98 + product
        dot_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_2_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_98 + product
        dot_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_2_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_98 + product
        dot_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_2_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_98 + product
        dot_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_3_0 * maximum_61
        dot_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_3_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_99 + product
        dot_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_3_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_99 + product
        dot_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_3_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_99 + product
        dot_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_3_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_99 + product
        dot_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_3_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_99 + product
        dot_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_3_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_99 + product
        dot_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_4_0 * maximum_61
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_4_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 + product
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_4_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 + product
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_4_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 + product
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_4_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 + product
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_4_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 + product
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_4_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 + product
        dot_100 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_5_0 * maximum_61
        dot_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_5_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_101 + product
        dot_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_5_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_101 + product
        dot_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_5_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_101 + product
        dot_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_5_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_101 + product
        dot_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_5_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_101 + product
        dot_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_5_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_101 + product
        dot_101 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_6_0 * maximum_61
        dot_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_6_1 * maximum_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_102 + product
        dot_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_6_2 * maximum_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_102 + product
        dot_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_6_3 * maximum_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_102 + product
        dot_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_6_4 * maximum_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_102 + product
        dot_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_6_5 * maximum_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_102 + product
        dot_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_rules_kd_6_6 * maximum_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_102 + product
        dot_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_96 * maximum_30
        dot_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_97 * maximum_32
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_103 + product
        dot_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_98 * maximum_34
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_103 + product
        dot_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_99 * maximum_36
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_103 + product
        dot_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_100 * maximum_38
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_103 + product
        dot_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_101 * maximum_40
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_103 + product
        dot_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_102 * maximum_42
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = dot_103 + product
        dot_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_104 = c_minus_one_3 if c_minus_one_3 > dot_103 else dot_103
        if c_one < clip_104:
            clip_104 = c_one
        single[0] = c_spans_2 * clip_104
        rmpy_105 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_2 + rmpy_105
        gain_2 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = gain_0 * change
        increment = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = gain_1 * error
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = increment + product
        increment = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = gain_2 * bend
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = increment + product
        increment = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_108 = state_notch
        single[0] = convert_108 + increment
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_110 = c_zero > in_preview_3
        where_111 = c_zero if gt_110 else c_notch_max
        clip_112 = c_minus_notch_max if c_minus_notch_max > notch_raw else notch_raw
        if where_111 < clip_112:
            clip_112 = where_111
        notch = quantise(clip_112, 19, 8)
        return (
            (
                error,
                change,
                notch,
            ),
            (
                notch_raw,
                notch,
            ),
            (
                error,
                change,
                bend,
                gain_0,
                gain_1,
                gain_2,
                increment,
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
        locate_10 = min(max(bisect_right(t_x_of_t, position_01mm) - 1, 0), len(t_x_of_t) - 2)
        at_11 = t_x_of_t[locate_10]
        at_12 = t_x_of_t[locate_10 + 1]
        single[0] = at_12 - at_11
        sub_13 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_14 = c_one_01mm if c_one_01mm > sub_13 else sub_13
        single[0] = position_01mm - at_11
        sub_15 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_16 = c_zero if c_zero > sub_15 else sub_15
        if maximum_14 < clip_16:
            clip_16 = maximum_14
        div_17 = div(clip_16, maximum_14, 20)
        minimum_18 = c_one if c_one < div_17 else div_17
        at_19 = t_v_of_x[locate_10]
        at_20 = t_v_of_x[locate_10 + 1]
        single[0] = at_20 - at_19
        sub_21 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_21 * minimum_18
        rmpy_22 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_19 + rmpy_22
        add_23 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_24 = t_v_of_x[locate_10 + 16]
        at_25 = t_v_of_x[locate_10 + 17]
        single[0] = at_25 - at_24
        sub_26 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_26 * minimum_18
        rmpy_27 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_24 + rmpy_27
        add_28 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_29 = t_v_of_x[locate_10 + 32]
        at_30 = t_v_of_x[locate_10 + 33]
        single[0] = at_30 - at_29
        sub_31 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_31 * minimum_18
        rmpy_32 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_29 + rmpy_32
        add_33 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_34 = t_v_of_x[locate_10 + 48]
        at_35 = t_v_of_x[locate_10 + 49]
        single[0] = at_35 - at_34
        sub_36 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_36 * minimum_18
        rmpy_37 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_34 + rmpy_37
        add_38 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_39 = t_v_of_x[locate_10 + 64]
        at_40 = t_v_of_x[locate_10 + 65]
        single[0] = at_40 - at_39
        sub_41 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_41 * minimum_18
        rmpy_42 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_39 + rmpy_42
        add_43 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_44 = position_01mm > c_from
        set_point = add_23 if gt_44 else at_5
        where_46 = add_28 if gt_44 else at_6
        where_47 = add_33 if gt_44 else at_7
        where_48 = add_38 if gt_44 else at_8
        where_49 = add_43 if gt_44 else at_9
        return (
            (),
            (
                speed,
                set_point,
                where_46,
                where_47,
                where_48,
                where_49,
            ),
            (
                speed,
                set_point,
            ),
        )

    return period
