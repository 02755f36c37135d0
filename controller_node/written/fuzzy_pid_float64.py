"""Law fuzzy_pid in double precision. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from bisect import bisect_right

from railhil.controller_node.written.parts import Parts, Step, Values


def inputs_by_time(parts: Parts) -> Step:
    (c_kmh_per_01mmps,) = parts.constants
    (t_v_of_t,) = parts.tables
    (last_0,) = parts.lasts

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            k,
            speed_01mmps,
            _position_01mm,
        ) = given
        speed = speed_01mmps * c_kmh_per_01mmps
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
        error = in_set_point - in_speed
        change = error - state_error
        bend = change - state_change
        clip_12 = c_minus_error_big if c_minus_error_big > error else error
        if c_error_big < clip_12:
            clip_12 = c_error_big
        rmpy_13 = clip_12 * c_error_scale
        clip_14 = c_peaks_0 if c_peaks_0 > rmpy_13 else rmpy_13
        if c_peaks_6 < clip_14:
            clip_14 = c_peaks_6
        sub_15 = clip_14 - c_peaks_0
        abs_16 = abs(sub_15)
        sub_17 = clip_14 - c_peaks_1
        abs_18 = abs(sub_17)
        sub_19 = clip_14 - c_peaks_2
        abs_20 = abs(sub_19)
        sub_21 = clip_14 - c_peaks_3
        abs_22 = abs(sub_21)
        sub_23 = clip_14 - c_peaks_4
        abs_24 = abs(sub_23)
        sub_25 = clip_14 - c_peaks_5
        abs_26 = abs(sub_25)
        sub_27 = clip_14 - c_peaks_6
        abs_28 = abs(sub_27)
        sub_29 = c_one - abs_16
        maximum_30 = c_zero if c_zero > sub_29 else sub_29
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
        clip_43 = c_minus_change_big if c_minus_change_big > change else change
        if c_change_big < clip_43:
            clip_43 = c_change_big
        rmpy_44 = clip_43 * c_change_scale
        clip_45 = c_peaks_0 if c_peaks_0 > rmpy_44 else rmpy_44
        if c_peaks_6 < clip_45:
            clip_45 = c_peaks_6
        sub_46 = clip_45 - c_peaks_0
        abs_47 = abs(sub_46)
        sub_48 = clip_45 - c_peaks_1
        abs_49 = abs(sub_48)
        sub_50 = clip_45 - c_peaks_2
        abs_51 = abs(sub_50)
        sub_52 = clip_45 - c_peaks_3
        abs_53 = abs(sub_52)
        sub_54 = clip_45 - c_peaks_4
        abs_55 = abs(sub_54)
        sub_56 = clip_45 - c_peaks_5
        abs_57 = abs(sub_56)
        sub_58 = clip_45 - c_peaks_6
        abs_59 = abs(sub_58)
        sub_60 = c_one - abs_47
        maximum_61 = c_zero if c_zero > sub_60 else sub_60
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
        dot_74 = 0.0 + c_rules_kp_0_0 * maximum_61
        dot_74 += c_rules_kp_0_1 * maximum_63
        dot_74 += c_rules_kp_0_2 * maximum_65
        dot_74 += c_rules_kp_0_3 * maximum_67
        dot_74 += c_rules_kp_0_4 * maximum_69
        dot_74 += c_rules_kp_0_5 * maximum_71
        dot_74 += c_rules_kp_0_6 * maximum_73
        dot_75 = 0.0 + c_rules_kp_1_0 * maximum_61
        dot_75 += c_rules_kp_1_1 * maximum_63
        dot_75 += c_rules_kp_1_2 * maximum_65
        dot_75 += c_rules_kp_1_3 * maximum_67
        dot_75 += c_rules_kp_1_4 * maximum_69
        dot_75 += c_rules_kp_1_5 * maximum_71
        dot_75 += c_rules_kp_1_6 * maximum_73
        dot_76 = 0.0 + c_rules_kp_2_0 * maximum_61
        dot_76 += c_rules_kp_2_1 * maximum_63
        dot_76 += c_rules_kp_2_2 * maximum_65
        dot_76 += c_rules_kp_2_3 * maximum_67
        dot_76 += c_rules_kp_2_4 * maximum_69
        dot_76 += c_rules_kp_2_5 * maximum_71
        dot_76 += c_rules_kp_2_6 * maximum_73
        dot_77 = 0.0 + c_rules_kp_3_0 * maximum_61
        dot_77 += c_rules_kp_3_1 * maximum_63
        dot_77 += c_rules_kp_3_2 * maximum_65
        dot_77 += c_rules_kp_3_3 * maximum_67
        dot_77 += c_rules_kp_3_4 * maximum_69
        dot_77 += c_rules_kp_3_5 * maximum_71
        dot_77 += c_rules_kp_3_6 * maximum_73
        dot_78 = 0.0 + c_rules_kp_4_0 * maximum_61
        dot_78 += c_rules_kp_4_1 * maximum_63
        dot_78 += c_rules_kp_4_2 * maximum_65
        dot_78 += c_rules_kp_4_3 * maximum_67
        dot_78 += c_rules_kp_4_4 * maximum_69
        dot_78 += c_rules_kp_4_5 * maximum_71
        dot_78 += c_rules_kp_4_6 * maximum_73
        dot_79 = 0.0 + c_rules_kp_5_0 * maximum_61
        dot_79 += c_rules_kp_5_1 * maximum_63
        dot_79 += c_rules_kp_5_2 * maximum_65
        dot_79 += c_rules_kp_5_3 * maximum_67
        dot_79 += c_rules_kp_5_4 * maximum_69
        dot_79 += c_rules_kp_5_5 * maximum_71
        dot_79 += c_rules_kp_5_6 * maximum_73
        dot_80 = 0.0 + c_rules_kp_6_0 * maximum_61
        dot_80 += c_rules_kp_6_1 * maximum_63
        dot_80 += c_rules_kp_6_2 * maximum_65
        dot_80 += c_rules_kp_6_3 * maximum_67
        dot_80 += c_rules_kp_6_4 * maximum_69
        dot_80 += c_rules_kp_6_5 * maximum_71
        dot_80 += c_rules_kp_6_6 * maximum_73
        dot_81 = 0.0 + dot_74 * maximum_30
        dot_81 += dot_75 * maximum_32
        dot_81 += dot_76 * maximum_34
        dot_81 += dot_77 * maximum_36
        dot_81 += dot_78 * maximum_38
        dot_81 += dot_79 * maximum_40
        dot_81 += dot_80 * maximum_42
        clip_82 = c_minus_one if c_minus_one > dot_81 else dot_81
        if c_one < clip_82:
            clip_82 = c_one
        rmpy_83 = c_spans_0 * clip_82
        gain_0 = c_gains_0 + rmpy_83
        dot_85 = 0.0 + c_rules_ki_0_0 * maximum_61
        dot_85 += c_rules_ki_0_1 * maximum_63
        dot_85 += c_rules_ki_0_2 * maximum_65
        dot_85 += c_rules_ki_0_3 * maximum_67
        dot_85 += c_rules_ki_0_4 * maximum_69
        dot_85 += c_rules_ki_0_5 * maximum_71
        dot_85 += c_rules_ki_0_6 * maximum_73
        dot_86 = 0.0 + c_rules_ki_1_0 * maximum_61
        dot_86 += c_rules_ki_1_1 * maximum_63
        dot_86 += c_rules_ki_1_2 * maximum_65
        dot_86 += c_rules_ki_1_3 * maximum_67
        dot_86 += c_rules_ki_1_4 * maximum_69
        dot_86 += c_rules_ki_1_5 * maximum_71
        dot_86 += c_rules_ki_1_6 * maximum_73
        dot_87 = 0.0 + c_rules_ki_2_0 * maximum_61
        dot_87 += c_rules_ki_2_1 * maximum_63
        dot_87 += c_rules_ki_2_2 * maximum_65
        dot_87 += c_rules_ki_2_3 * maximum_67
        dot_87 += c_rules_ki_2_4 * maximum_69
        dot_87 += c_rules_ki_2_5 * maximum_71
        dot_87 += c_rules_ki_2_6 * maximum_73
        dot_88 = 0.0 + c_rules_ki_3_0 * maximum_61
        dot_88 += c_rules_ki_3_1 * maximum_63
        dot_88 += c_rules_ki_3_2 * maximum_65
        dot_88 += c_rules_ki_3_3 * maximum_67
        dot_88 += c_rules_ki_3_4 * maximum_69
        dot_88 += c_rules_ki_3_5 * maximum_71
        dot_88 += c_rules_ki_3_6 * maximum_73
        dot_89 = 0.0 + c_rules_ki_4_0 * maximum_61
        dot_89 += c_rules_ki_4_1 * maximum_63
        dot_89 += c_rules_ki_4_2 * maximum_65
        dot_89 += c_rules_ki_4_3 * maximum_67
        dot_89 += c_rules_ki_4_4 * maximum_69
        dot_89 += c_rules_ki_4_5 * maximum_71
        dot_89 += c_rules_ki_4_6 * maximum_73
        dot_90 = 0.0 + c_rules_ki_5_0 * maximum_61
        dot_90 += c_rules_ki_5_1 * maximum_63
        dot_90 += c_rules_ki_5_2 * maximum_65
        dot_90 += c_rules_ki_5_3 * maximum_67
        dot_90 += c_rules_ki_5_4 * maximum_69
        dot_90 += c_rules_ki_5_5 * maximum_71
        dot_90 += c_rules_ki_5_6 * maximum_73
        dot_91 = 0.0 + c_rules_ki_6_0 * maximum_61
        dot_91 += c_rules_ki_6_1 * maximum_63
        dot_91 += c_rules_ki_6_2 * maximum_65
        dot_91 += c_rules_ki_6_3 * maximum_67
        dot_91 += c_rules_ki_6_4 * maximum_69
        dot_91 += c_rules_ki_6_5 * maximum_71
        dot_91 += c_rules_ki_6_6 * maximum_73
        dot_92 = 0.0 + dot_85 * maximum_30
        dot_92 += dot_86 * maximum_32
        dot_92 += dot_87 * maximum_34
        dot_92 += dot_88 * maximum_36
        dot_92 += dot_89 * maximum_38
        dot_92 += dot_90 * maximum_40
        dot_92 += dot_91 * maximum_42
        clip_93 = c_minus_one_2 if c_minus_one_2 > dot_92 else dot_92
        if c_one < clip_93:
            clip_93 = c_one
        rmpy_94 = c_spans_1 * clip_93
        gain_1 = c_gains_1 + rmpy_94
        dot_96 = 0.0 + c_rules_kd_0_0 * maximum_61
        dot_96 += c_rules_kd_0_1 * maximum_63
        dot_96 += c_rules_kd_0_2 * maximum_65
        dot_96 += c_rules_kd_0_3 * maximum_67
        dot_96 += c_rules_kd_0_4 * maximum_69
        dot_96 += c_rules_kd_0_5 * maximum_71
        dot_96 += c_rules_kd_0_6 * maximum_73
        dot_97 = 0.0 + c_rules_kd_1_0 * maximum_61
        dot_97 += c_rules_kd_1_1 * maximum_63
        dot_97 += c_rules_kd_1_2 * maximum_65
        dot_97 += c_rules_kd_1_3 * maximum_67
        dot_97 += c_rules_kd_1_4 * maximum_69
        dot_97 += c_rules_kd_1_5 * maximum_71
        dot_97 += c_rules_kd_1_6 * maximum_73
        dot_98 = 0.0 + c_rules_kd_2_0 * maximum_61
        dot_98 += c_rules_kd_2_1 * maximum_63
        dot_98 += c_rules_kd_2_2 * maximum_65
        dot_98 += c_rules_kd_2_3 * maximum_67
        dot_98 += c_rules_kd_2_4 * maximum_69
        dot_98 += c_rules_kd_2_5 * maximum_71
        dot_98 += c_rules_kd_2_6 * maximum_73
        dot_99 = 0.0 + c_rules_kd_3_0 * maximum_61
        dot_99 += c_rules_kd_3_1 * maximum_63
        dot_99 += c_rules_kd_3_2 * maximum_65
        dot_99 += c_rules_kd_3_3 * maximum_67
        dot_99 += c_rules_kd_3_4 * maximum_69
        dot_99 += c_rules_kd_3_5 * maximum_71
        dot_99 += c_rules_kd_3_6 * maximum_73
        dot_100 = 0.0 + c_rules_kd_4_0 * maximum_61
        dot_100 += c_rules_kd_4_1 * maximum_63
        dot_100 += c_rules_kd_4_2 * maximum_65
        dot_100 += c_rules_kd_4_3 * maximum_67
        dot_100 += c_rules_kd_4_4 * maximum_69
        dot_100 += c_rules_kd_4_5 * maximum_71
        dot_100 += c_rules_kd_4_6 * maximum_73
        dot_101 = 0.0 + c_rules_kd_5_0 * maximum_61
        dot_101 += c_rules_kd_5_1 * maximum_63
        dot_101 += c_rules_kd_5_2 * maximum_65
        dot_101 += c_rules_kd_5_3 * maximum_67
        dot_101 += c_rules_kd_5_4 * maximum_69
        dot_101 += c_rules_kd_5_5 * maximum_71
        dot_101 += c_rules_kd_5_6 * maximum_73
        dot_102 = 0.0 + c_rules_kd_6_0 * maximum_61
        dot_102 += c_rules_kd_6_1 * maximum_63
        dot_102 += c_rules_kd_6_2 * maximum_65
        dot_102 += c_rules_kd_6_3 * maximum_67
        dot_102 += c_rules_kd_6_4 * maximum_69
        dot_102 += c_rules_kd_6_5 * maximum_71
        dot_102 += c_rules_kd_6_6 * maximum_73
        dot_103 = 0.0 + dot_96 * maximum_30
        dot_103 += dot_97 * maximum_32
        dot_103 += dot_98 * maximum_34
        dot_103 += dot_99 * maximum_36
        dot_103 += dot_100 * maximum_38
        dot_103 += dot_101 * maximum_40
        dot_103 += dot_102 * maximum_42
        clip_104 = c_minus_one_3 if c_minus_one_3 > dot_103 else dot_103
        if c_one < clip_104:
            clip_104 = c_one
        rmpy_105 = c_spans_2 * clip_104
        gain_2 = c_gains_2 + rmpy_105
        increment = 0.0 + gain_0 * change
        increment += gain_1 * error
        increment += gain_2 * bend
        convert_108 = state_notch
        notch_raw = convert_108 + increment
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
        speed = speed_01mmps * c_kmh_per_01mmps
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
        clip_16 = c_zero if c_zero > sub_15 else sub_15
        if maximum_14 < clip_16:
            clip_16 = maximum_14
        div_17 = div(clip_16, maximum_14, 20)
        minimum_18 = c_one if c_one < div_17 else div_17
        at_19 = t_v_of_x[locate_10]
        at_20 = t_v_of_x[locate_10 + 1]
        sub_21 = at_20 - at_19
        rmpy_22 = sub_21 * minimum_18
        add_23 = at_19 + rmpy_22
        at_24 = t_v_of_x[locate_10 + 16]
        at_25 = t_v_of_x[locate_10 + 17]
        sub_26 = at_25 - at_24
        rmpy_27 = sub_26 * minimum_18
        add_28 = at_24 + rmpy_27
        at_29 = t_v_of_x[locate_10 + 32]
        at_30 = t_v_of_x[locate_10 + 33]
        sub_31 = at_30 - at_29
        rmpy_32 = sub_31 * minimum_18
        add_33 = at_29 + rmpy_32
        at_34 = t_v_of_x[locate_10 + 48]
        at_35 = t_v_of_x[locate_10 + 49]
        sub_36 = at_35 - at_34
        rmpy_37 = sub_36 * minimum_18
        add_38 = at_34 + rmpy_37
        at_39 = t_v_of_x[locate_10 + 64]
        at_40 = t_v_of_x[locate_10 + 65]
        sub_41 = at_40 - at_39
        rmpy_42 = sub_41 * minimum_18
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
