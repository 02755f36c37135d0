"""Law fuzzy_pid in fixed point. Written by ``make tables`` from the recorded program; do not edit."""

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
    (
        c_error_max,
        c_minus_error_max,
        c_bend_max,
        c_minus_bend_max,
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
    (
        low_error,
        high_error,
        low_change,
        high_change,
        low_notch,
        high_notch,
    ) = parts.bounds

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
        if not low_error <= state_error <= high_error:
            return None
        if not low_change <= state_change <= high_change:
            return None
        if not low_notch <= state_notch <= high_notch:
            return None
        sub_9 = in_set_point - in_speed
        if not c_minus_error_max <= sub_9 <= c_error_max:
            return None
        error = sub_9
        change = error - state_error
        sub_12 = change - state_change
        if not c_minus_bend_max <= sub_12 <= c_bend_max:
            return None
        bend = sub_12
        clip_14 = error if error < c_error_big else c_error_big
        if clip_14 < c_minus_error_big:
            clip_14 = c_minus_error_big
        rmpy_15 = clip_14 * c_error_scale + 524288 >> 20
        clip_16 = rmpy_15 if rmpy_15 < c_peaks_6 else c_peaks_6
        if clip_16 < c_peaks_0:
            clip_16 = c_peaks_0
        sub_17 = clip_16 - c_peaks_0
        abs_18 = abs(sub_17)
        sub_19 = clip_16 - c_peaks_1
        abs_20 = abs(sub_19)
        sub_21 = clip_16 - c_peaks_2
        abs_22 = abs(sub_21)
        sub_23 = clip_16 - c_peaks_3
        abs_24 = abs(sub_23)
        sub_25 = clip_16 - c_peaks_4
        abs_26 = abs(sub_25)
        sub_27 = clip_16 - c_peaks_5
        abs_28 = abs(sub_27)
        sub_29 = clip_16 - c_peaks_6
        abs_30 = abs(sub_29)
        sub_31 = c_one - abs_18
        maximum_32 = c_zero if c_zero > sub_31 else sub_31
        sub_33 = c_one - abs_20
        maximum_34 = c_zero if c_zero > sub_33 else sub_33
        sub_35 = c_one - abs_22
        maximum_36 = c_zero if c_zero > sub_35 else sub_35
        sub_37 = c_one - abs_24
        maximum_38 = c_zero if c_zero > sub_37 else sub_37
        sub_39 = c_one - abs_26
        maximum_40 = c_zero if c_zero > sub_39 else sub_39
        sub_41 = c_one - abs_28
        maximum_42 = c_zero if c_zero > sub_41 else sub_41
        sub_43 = c_one - abs_30
        maximum_44 = c_zero if c_zero > sub_43 else sub_43
        clip_45 = change if change < c_change_big else c_change_big
        if clip_45 < c_minus_change_big:
            clip_45 = c_minus_change_big
        rmpy_46 = clip_45 * c_change_scale + 524288 >> 20
        clip_47 = rmpy_46 if rmpy_46 < c_peaks_6 else c_peaks_6
        if clip_47 < c_peaks_0:
            clip_47 = c_peaks_0
        sub_48 = clip_47 - c_peaks_0
        abs_49 = abs(sub_48)
        sub_50 = clip_47 - c_peaks_1
        abs_51 = abs(sub_50)
        sub_52 = clip_47 - c_peaks_2
        abs_53 = abs(sub_52)
        sub_54 = clip_47 - c_peaks_3
        abs_55 = abs(sub_54)
        sub_56 = clip_47 - c_peaks_4
        abs_57 = abs(sub_56)
        sub_58 = clip_47 - c_peaks_5
        abs_59 = abs(sub_58)
        sub_60 = clip_47 - c_peaks_6
        abs_61 = abs(sub_60)
        sub_62 = c_one - abs_49
        maximum_63 = c_zero if c_zero > sub_62 else sub_62
        sub_64 = c_one - abs_51
        maximum_65 = c_zero if c_zero > sub_64 else sub_64
        sub_66 = c_one - abs_53
        maximum_67 = c_zero if c_zero > sub_66 else sub_66
        sub_68 = c_one - abs_55
        maximum_69 = c_zero if c_zero > sub_68 else sub_68
        sub_70 = c_one - abs_57
        maximum_71 = c_zero if c_zero > sub_70 else sub_70
        sub_72 = c_one - abs_59
        maximum_73 = c_zero if c_zero > sub_72 else sub_72
        sub_74 = c_one - abs_61
        maximum_75 = c_zero if c_zero > sub_74 else sub_74
        dot_76 = c_rules_kp_0_0 * maximum_63 + 8388608 >> 24
        dot_76 += c_rules_kp_0_1 * maximum_65 + 8388608 >> 24
        dot_76 += c_rules_kp_0_2 * maximum_67 + 8388608 >> 24
        dot_76 += c_rules_kp_0_3 * maximum_69 + 8388608 >> 24
        dot_76 += c_rules_kp_0_4 * maximum_71 + 8388608 >> 24
        dot_76 += c_rules_kp_0_5 * maximum_73 + 8388608 >> 24
        dot_76 += c_rules_kp_0_6 * maximum_75 + 8388608 >> 24
        dot_77 = c_rules_kp_1_0 * maximum_63 + 8388608 >> 24
        dot_77 += c_rules_kp_1_1 * maximum_65 + 8388608 >> 24
        dot_77 += c_rules_kp_1_2 * maximum_67 + 8388608 >> 24
        dot_77 += c_rules_kp_1_3 * maximum_69 + 8388608 >> 24
        dot_77 += c_rules_kp_1_4 * maximum_71 + 8388608 >> 24
        dot_77 += c_rules_kp_1_5 * maximum_73 + 8388608 >> 24
        dot_77 += c_rules_kp_1_6 * maximum_75 + 8388608 >> 24
        dot_78 = c_rules_kp_2_0 * maximum_63 + 8388608 >> 24
        dot_78 += c_rules_kp_2_1 * maximum_65 + 8388608 >> 24
        dot_78 += c_rules_kp_2_2 * maximum_67 + 8388608 >> 24
        dot_78 += c_rules_kp_2_3 * maximum_69 + 8388608 >> 24
        dot_78 += c_rules_kp_2_4 * maximum_71 + 8388608 >> 24
        dot_78 += c_rules_kp_2_5 * maximum_73 + 8388608 >> 24
        dot_78 += c_rules_kp_2_6 * maximum_75 + 8388608 >> 24
        dot_79 = c_rules_kp_3_0 * maximum_63 + 8388608 >> 24
        dot_79 += c_rules_kp_3_1 * maximum_65 + 8388608 >> 24
        dot_79 += c_rules_kp_3_2 * maximum_67 + 8388608 >> 24
        dot_79 += c_rules_kp_3_3 * maximum_69 + 8388608 >> 24
        dot_79 += c_rules_kp_3_4 * maximum_71 + 8388608 >> 24
        dot_79 += c_rules_kp_3_5 * maximum_73 + 8388608 >> 24
        dot_79 += c_rules_kp_3_6 * maximum_75 + 8388608 >> 24
        dot_80 = c_rules_kp_4_0 * maximum_63 + 8388608 >> 24
        dot_80 += c_rules_kp_4_1 * maximum_65 + 8388608 >> 24
        dot_80 += c_rules_kp_4_2 * maximum_67 + 8388608 >> 24
        dot_80 += c_rules_kp_4_3 * maximum_69 + 8388608 >> 24
        dot_80 += c_rules_kp_4_4 * maximum_71 + 8388608 >> 24
        dot_80 += c_rules_kp_4_5 * maximum_73 + 8388608 >> 24
        dot_80 += c_rules_kp_4_6 * maximum_75 + 8388608 >> 24
        dot_81 = c_rules_kp_5_0 * maximum_63 + 8388608 >> 24
        dot_81 += c_rules_kp_5_1 * maximum_65 + 8388608 >> 24
        dot_81 += c_rules_kp_5_2 * maximum_67 + 8388608 >> 24
        dot_81 += c_rules_kp_5_3 * maximum_69 + 8388608 >> 24
        dot_81 += c_rules_kp_5_4 * maximum_71 + 8388608 >> 24
        dot_81 += c_rules_kp_5_5 * maximum_73 + 8388608 >> 24
        dot_81 += c_rules_kp_5_6 * maximum_75 + 8388608 >> 24
        dot_82 = c_rules_kp_6_0 * maximum_63 + 8388608 >> 24
        dot_82 += c_rules_kp_6_1 * maximum_65 + 8388608 >> 24
        dot_82 += c_rules_kp_6_2 * maximum_67 + 8388608 >> 24
        dot_82 += c_rules_kp_6_3 * maximum_69 + 8388608 >> 24
        dot_82 += c_rules_kp_6_4 * maximum_71 + 8388608 >> 24
        dot_82 += c_rules_kp_6_5 * maximum_73 + 8388608 >> 24
        dot_82 += c_rules_kp_6_6 * maximum_75 + 8388608 >> 24
        dot_83 = dot_76 * maximum_32 + 8388608 >> 24
        dot_83 += dot_77 * maximum_34 + 8388608 >> 24
        dot_83 += dot_78 * maximum_36 + 8388608 >> 24
        dot_83 += dot_79 * maximum_38 + 8388608 >> 24
        dot_83 += dot_80 * maximum_40 + 8388608 >> 24
        dot_83 += dot_81 * maximum_42 + 8388608 >> 24
        dot_83 += dot_82 * maximum_44 + 8388608 >> 24
        clip_84 = dot_83 if dot_83 < c_one else c_one
        if clip_84 < c_minus_one:
            clip_84 = c_minus_one
        rmpy_85 = c_spans_0 * clip_84 + 8388608 >> 24
        gain_0 = c_gains_0 + rmpy_85
        dot_87 = c_rules_ki_0_0 * maximum_63 + 8388608 >> 24
        dot_87 += c_rules_ki_0_1 * maximum_65 + 8388608 >> 24
        dot_87 += c_rules_ki_0_2 * maximum_67 + 8388608 >> 24
        dot_87 += c_rules_ki_0_3 * maximum_69 + 8388608 >> 24
        dot_87 += c_rules_ki_0_4 * maximum_71 + 8388608 >> 24
        dot_87 += c_rules_ki_0_5 * maximum_73 + 8388608 >> 24
        dot_87 += c_rules_ki_0_6 * maximum_75 + 8388608 >> 24
        dot_88 = c_rules_ki_1_0 * maximum_63 + 8388608 >> 24
        dot_88 += c_rules_ki_1_1 * maximum_65 + 8388608 >> 24
        dot_88 += c_rules_ki_1_2 * maximum_67 + 8388608 >> 24
        dot_88 += c_rules_ki_1_3 * maximum_69 + 8388608 >> 24
        dot_88 += c_rules_ki_1_4 * maximum_71 + 8388608 >> 24
        dot_88 += c_rules_ki_1_5 * maximum_73 + 8388608 >> 24
        dot_88 += c_rules_ki_1_6 * maximum_75 + 8388608 >> 24
        dot_89 = c_rules_ki_2_0 * maximum_63 + 8388608 >> 24
        dot_89 += c_rules_ki_2_1 * maximum_65 + 8388608 >> 24
        dot_89 += c_rules_ki_2_2 * maximum_67 + 8388608 >> 24
        dot_89 += c_rules_ki_2_3 * maximum_69 + 8388608 >> 24
        dot_89 += c_rules_ki_2_4 * maximum_71 + 8388608 >> 24
        dot_89 += c_rules_ki_2_5 * maximum_73 + 8388608 >> 24
        dot_89 += c_rules_ki_2_6 * maximum_75 + 8388608 >> 24
        dot_90 = c_rules_ki_3_0 * maximum_63 + 8388608 >> 24
        dot_90 += c_rules_ki_3_1 * maximum_65 + 8388608 >> 24
        dot_90 += c_rules_ki_3_2 * maximum_67 + 8388608 >> 24
        dot_90 += c_rules_ki_3_3 * maximum_69 + 8388608 >> 24
        dot_90 += c_rules_ki_3_4 * maximum_71 + 8388608 >> 24
        dot_90 += c_rules_ki_3_5 * maximum_73 + 8388608 >> 24
        dot_90 += c_rules_ki_3_6 * maximum_75 + 8388608 >> 24
        dot_91 = c_rules_ki_4_0 * maximum_63 + 8388608 >> 24
        dot_91 += c_rules_ki_4_1 * maximum_65 + 8388608 >> 24
        dot_91 += c_rules_ki_4_2 * maximum_67 + 8388608 >> 24
        dot_91 += c_rules_ki_4_3 * maximum_69 + 8388608 >> 24
        dot_91 += c_rules_ki_4_4 * maximum_71 + 8388608 >> 24
        dot_91 += c_rules_ki_4_5 * maximum_73 + 8388608 >> 24
        dot_91 += c_rules_ki_4_6 * maximum_75 + 8388608 >> 24
        dot_92 = c_rules_ki_5_0 * maximum_63 + 8388608 >> 24
        dot_92 += c_rules_ki_5_1 * maximum_65 + 8388608 >> 24
        dot_92 += c_rules_ki_5_2 * maximum_67 + 8388608 >> 24
        dot_92 += c_rules_ki_5_3 * maximum_69 + 8388608 >> 24
        dot_92 += c_rules_ki_5_4 * maximum_71 + 8388608 >> 24
        dot_92 += c_rules_ki_5_5 * maximum_73 + 8388608 >> 24
        dot_92 += c_rules_ki_5_6 * maximum_75 + 8388608 >> 24
        dot_93 = c_rules_ki_6_0 * maximum_63 + 8388608 >> 24
        dot_93 += c_rules_ki_6_1 * maximum_65 + 8388608 >> 24
        dot_93 += c_rules_ki_6_2 * maximum_67 + 8388608 >> 24
        dot_93 += c_rules_ki_6_3 * maximum_69 + 8388608 >> 24
        dot_93 += c_rules_ki_6_4 * maximum_71 + 8388608 >> 24
        dot_93 += c_rules_ki_6_5 * maximum_73 + 8388608 >> 24
        dot_93 += c_rules_ki_6_6 * maximum_75 + 8388608 >> 24
        dot_94 = dot_87 * maximum_32 + 8388608 >> 24
        dot_94 += dot_88 * maximum_34 + 8388608 >> 24
        dot_94 += dot_89 * maximum_36 + 8388608 >> 24
        dot_94 += dot_90 * maximum_38 + 8388608 >> 24
        dot_94 += dot_91 * maximum_40 + 8388608 >> 24
        dot_94 += dot_92 * maximum_42 + 8388608 >> 24
        dot_94 += dot_93 * maximum_44 + 8388608 >> 24
        clip_95 = dot_94 if dot_94 < c_one else c_one
        if clip_95 < c_minus_one_2:
            clip_95 = c_minus_one_2
        rmpy_96 = c_spans_1 * clip_95 + 8388608 >> 24
        gain_1 = c_gains_1 + rmpy_96
        dot_98 = c_rules_kd_0_0 * maximum_63 + 8388608 >> 24
        dot_98 += c_rules_kd_0_1 * maximum_65 + 8388608 >> 24
        dot_98 += c_rules_kd_0_2 * maximum_67 + 8388608 >> 24
        dot_98 += c_rules_kd_0_3 * maximum_69 + 8388608 >> 24
        dot_98 += c_rules_kd_0_4 * maximum_71 + 8388608 >> 24
        dot_98 += c_rules_kd_0_5 * maximum_73 + 8388608 >> 24
        dot_98 += c_rules_kd_0_6 * maximum_75 + 8388608 >> 24
        dot_99 = c_rules_kd_1_0 * maximum_63 + 8388608 >> 24
        dot_99 += c_rules_kd_1_1 * maximum_65 + 8388608 >> 24
        dot_99 += c_rules_kd_1_2 * maximum_67 + 8388608 >> 24
        dot_99 += c_rules_kd_1_3 * maximum_69 + 8388608 >> 24
        dot_99 += c_rules_kd_1_4 * maximum_71 + 8388608 >> 24
        dot_99 += c_rules_kd_1_5 * maximum_73 + 8388608 >> 24
        dot_99 += c_rules_kd_1_6 * maximum_75 + 8388608 >> 24
        dot_100 = c_rules_kd_2_0 * maximum_63 + 8388608 >> 24
        dot_100 += c_rules_kd_2_1 * maximum_65 + 8388608 >> 24
        dot_100 += c_rules_kd_2_2 * maximum_67 + 8388608 >> 24
        dot_100 += c_rules_kd_2_3 * maximum_69 + 8388608 >> 24
        dot_100 += c_rules_kd_2_4 * maximum_71 + 8388608 >> 24
        dot_100 += c_rules_kd_2_5 * maximum_73 + 8388608 >> 24
        dot_100 += c_rules_kd_2_6 * maximum_75 + 8388608 >> 24
        dot_101 = c_rules_kd_3_0 * maximum_63 + 8388608 >> 24
        dot_101 += c_rules_kd_3_1 * maximum_65 + 8388608 >> 24
        dot_101 += c_rules_kd_3_2 * maximum_67 + 8388608 >> 24
        dot_101 += c_rules_kd_3_3 * maximum_69 + 8388608 >> 24
        dot_101 += c_rules_kd_3_4 * maximum_71 + 8388608 >> 24
        dot_101 += c_rules_kd_3_5 * maximum_73 + 8388608 >> 24
        dot_101 += c_rules_kd_3_6 * maximum_75 + 8388608 >> 24
        dot_102 = c_rules_kd_4_0 * maximum_63 + 8388608 >> 24
        dot_102 += c_rules_kd_4_1 * maximum_65 + 8388608 >> 24
        dot_102 += c_rules_kd_4_2 * maximum_67 + 8388608 >> 24
        dot_102 += c_rules_kd_4_3 * maximum_69 + 8388608 >> 24
        dot_102 += c_rules_kd_4_4 * maximum_71 + 8388608 >> 24
        dot_102 += c_rules_kd_4_5 * maximum_73 + 8388608 >> 24
        dot_102 += c_rules_kd_4_6 * maximum_75 + 8388608 >> 24
        dot_103 = c_rules_kd_5_0 * maximum_63 + 8388608 >> 24
        dot_103 += c_rules_kd_5_1 * maximum_65 + 8388608 >> 24
        dot_103 += c_rules_kd_5_2 * maximum_67 + 8388608 >> 24
        dot_103 += c_rules_kd_5_3 * maximum_69 + 8388608 >> 24
        dot_103 += c_rules_kd_5_4 * maximum_71 + 8388608 >> 24
        dot_103 += c_rules_kd_5_5 * maximum_73 + 8388608 >> 24
        dot_103 += c_rules_kd_5_6 * maximum_75 + 8388608 >> 24
        dot_104 = c_rules_kd_6_0 * maximum_63 + 8388608 >> 24
        dot_104 += c_rules_kd_6_1 * maximum_65 + 8388608 >> 24
        dot_104 += c_rules_kd_6_2 * maximum_67 + 8388608 >> 24
        dot_104 += c_rules_kd_6_3 * maximum_69 + 8388608 >> 24
        dot_104 += c_rules_kd_6_4 * maximum_71 + 8388608 >> 24
        dot_104 += c_rules_kd_6_5 * maximum_73 + 8388608 >> 24
        dot_104 += c_rules_kd_6_6 * maximum_75 + 8388608 >> 24
        dot_105 = dot_98 * maximum_32 + 8388608 >> 24
        dot_105 += dot_99 * maximum_34 + 8388608 >> 24
        dot_105 += dot_100 * maximum_36 + 8388608 >> 24
        dot_105 += dot_101 * maximum_38 + 8388608 >> 24
        dot_105 += dot_102 * maximum_40 + 8388608 >> 24
        dot_105 += dot_103 * maximum_42 + 8388608 >> 24
        dot_105 += dot_104 * maximum_44 + 8388608 >> 24
        clip_106 = dot_105 if dot_105 < c_one else c_one
        if clip_106 < c_minus_one_3:
            clip_106 = c_minus_one_3
        rmpy_107 = c_spans_2 * clip_106 + 8388608 >> 24
        gain_2 = c_gains_2 + rmpy_107
        increment = gain_0 * change + 16777216 >> 25
        increment += gain_1 * error + 16777216 >> 25
        increment += gain_2 * bend + 16777216 >> 25
        convert_110 = state_notch << 11
        notch_raw = convert_110 + increment
        gt_112 = c_zero > in_preview_3
        where_113 = c_zero if gt_112 else c_notch_max
        if c_minus_notch_max > where_113:
            return None
        clip_114 = notch_raw if notch_raw < where_113 else where_113
        if clip_114 < c_minus_notch_max:
            clip_114 = c_minus_notch_max
        notch = clip_114 + 1024 >> 11
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
        locate_10 = min(max(bisect_right(t_x_of_t, position_01mm) - 1, 0), len(t_x_of_t) - 2)
        at_11 = t_x_of_t[locate_10]
        at_12 = t_x_of_t[locate_10 + 1]
        sub_13 = at_12 - at_11
        maximum_14 = c_one_01mm if c_one_01mm > sub_13 else sub_13
        sub_15 = position_01mm - at_11
        if c_zero > maximum_14:
            return None
        clip_16 = sub_15 if sub_15 < maximum_14 else maximum_14
        if clip_16 < c_zero:
            clip_16 = c_zero
        div_17 = div(clip_16, maximum_14, 20)
        minimum_18 = c_one if c_one < div_17 else div_17
        at_19 = t_v_of_x[locate_10]
        at_20 = t_v_of_x[locate_10 + 1]
        sub_21 = at_20 - at_19
        rmpy_22 = sub_21 * minimum_18 + 524288 >> 20
        add_23 = at_19 + rmpy_22
        at_24 = t_v_of_x[locate_10 + 16]
        at_25 = t_v_of_x[locate_10 + 17]
        sub_26 = at_25 - at_24
        rmpy_27 = sub_26 * minimum_18 + 524288 >> 20
        add_28 = at_24 + rmpy_27
        at_29 = t_v_of_x[locate_10 + 32]
        at_30 = t_v_of_x[locate_10 + 33]
        sub_31 = at_30 - at_29
        rmpy_32 = sub_31 * minimum_18 + 524288 >> 20
        add_33 = at_29 + rmpy_32
        at_34 = t_v_of_x[locate_10 + 48]
        at_35 = t_v_of_x[locate_10 + 49]
        sub_36 = at_35 - at_34
        rmpy_37 = sub_36 * minimum_18 + 524288 >> 20
        add_38 = at_34 + rmpy_37
        at_39 = t_v_of_x[locate_10 + 64]
        at_40 = t_v_of_x[locate_10 + 65]
        sub_41 = at_40 - at_39
        rmpy_42 = sub_41 * minimum_18 + 524288 >> 20
        add_43 = at_39 + rmpy_42
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
