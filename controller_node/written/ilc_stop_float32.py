"""Law ilc_stop in single precision. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from array import array

from railhil.controller_node.arithmetic.float32 import FLT_MAX, FLT_MIN
from railhil.controller_node.written.parts import Parts, Step, Values


def inputs(parts: Parts) -> Step:

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            speed1,
            speed2,
            speed3,
            speed4,
            speed5,
            speed_count,
            speed_valid,
            slide,
            odometer,
            balise,
            balise_odometer,
            load,
            wet,
            standstill,
            doors,
            run,
            report_run,
            report_error,
            level,
        ) = given
        return (
            (),
            (
                speed1,
                speed2,
                speed3,
                speed4,
                speed5,
                speed_count,
                speed_valid,
                slide,
                odometer,
                balise,
                balise_odometer,
                load,
                wet,
                standstill,
                doors,
                run,
                report_run,
                report_error,
                level,
            ),
            (
                speed1,
                speed2,
                speed3,
                speed4,
                speed5,
                speed_count,
                speed_valid,
                slide,
                odometer,
                balise,
                balise_odometer,
                load,
                wet,
                standstill,
                doors,
                run,
                report_run,
                report_error,
                level,
            ),
        )

    return period


def step(parts: Parts) -> Step:
    single = array("f", [0.0])
    (
        c_unit,
        c_report_1,
        c_report__1,
        c_zero,
        c_one,
        c_count_max,
        c_samples,
        c_held_cycles,
        c_warm_up,
        c_packet_0,
        c_packet_1,
        c_packet_2,
        c_packet_3,
        c_packet_4,
        c_packet_5,
        c_packet_6,
        c_packet_7,
        c_packet_8,
        c_packet_9,
        c_packet_10,
        c_packet_11,
        c_packet_12,
        c_packet_13,
        c_packet_14,
        c_packet_15,
        c_packet_16,
        c_packet_17,
        c_packet_18,
        c_packet_19,
        c_packet_20,
        c_packet_21,
        c_packet_22,
        c_packet_23,
        c_packet_24,
        c_packet_25,
        c_packet_26,
        c_packet_27,
        c_packet_28,
        c_packet_29,
        c_packet_30,
        c_packet_31,
        c_packet_32,
        c_packet_33,
        c_packet_34,
        c_packet_35,
        c_packet_36,
        c_packet_37,
        c_packet_38,
        c_packet_39,
        c_packet_40,
        c_packet_41,
        c_packet_42,
        c_packet_43,
        c_packet_44,
        c_packet_45,
        c_packet_46,
        c_packet_47,
        c_packet_48,
        c_packet_49,
        c_packet_50,
        c_packet_51,
        c_packet_52,
        c_packet_53,
        c_packet_54,
        c_packet_55,
        c_packet_56,
        c_packet_57,
        c_packet_58,
        c_packet_59,
        c_packet_60,
        c_packet_61,
        c_packet_62,
        c_packet_63,
        c_packet_64,
        c_packet_65,
        c_packet_66,
        c_packet_67,
        c_packet_68,
        c_packet_69,
        c_packet_70,
        c_packet_71,
        c_packet_72,
        c_packet_73,
        c_packet_74,
        c_packet_75,
        c_packet_76,
        c_packet_77,
        c_packet_78,
        c_packet_79,
        c_packet_80,
        c_packet_81,
        c_packet_82,
        c_packet_83,
        c_packet_84,
        c_packet_85,
        c_packet_86,
        c_packet_87,
        c_packet_88,
        c_packet_89,
        c_packet_90,
        c_packet_91,
        c_packet_92,
        c_packet_93,
        c_packet_94,
        c_packet_95,
        c_packet_96,
        c_packet_97,
        c_packet_98,
        c_packet_99,
        c_packet_100,
        c_packet_101,
        c_packet_102,
        c_packet_103,
        c_packet_104,
        c_packet_105,
        c_packet_106,
        c_packet_107,
        c_packet_108,
        c_packet_109,
        c_packet_110,
        c_packet_111,
        c_packet_112,
        c_packet_113,
        c_packet_114,
        c_packet_115,
        c_packet_116,
        c_packet_117,
        c_packet_118,
        c_packet_119,
        c_packet_120,
        c_packet_121,
        c_packet_122,
        c_packet_123,
        c_packet_124,
        c_packet_125,
        c_packet_126,
        c_packet_127,
        c_way,
        c_planned_wet,
        c_planned_dry,
        c_fastest,
        c_still,
        c_time_max,
        c_time_0,
        c_model_lag_twice,
        c_model_lag,
        c_exp_far,
        c_exp_zero,
        c_exp_scale,
        c_exp_part_0,
        c_exp_one,
        c_exp_part_1,
        c_exp_part_2,
        c_exp_part_3,
        c_exp_part_4,
        c_exp_part_5,
        c_slope_one,
        c_least_slope,
        c_time_min,
        c_half,
        c_mean_min,
        c_model_delay_and_lag,
        c_model_delay,
        c_way_max,
        c_way_min,
        c_no_reserve,
        c_epsilon,
        c_nothing,
        c_moving,
        c_stage_idle,
        c_stage_start,
        c_stage_track,
        c_stage_accelerate,
        c_reached,
        c_armed,
        c_stage_armed,
        c_stage_brake,
        c_stage_standstill,
        c_stage_learn,
        c_far,
        c_minus_far,
        c_hold,
        c_pull,
        c_minus_pull,
        c_grade_left_0,
        c_grade_base,
        c_grade_change_0,
        c_jerk,
        c_minus_jerk,
        c_accel_max,
        c_accel_min,
        c_mm,
        c_at_once,
        c_cut,
        c_error_max,
        c_memory_last_run,
        c_runs_max,
        c_gamma_least,
        c_five_1,
        c_five__1,
        c_variance_max,
        c_variance_min,
        c_minus_error_max,
        c_gamma,
        c_step_1,
        c_step__1,
        c_offset_1,
        c_offset__1,
        c_told_max,
        c_told_min,
        c_start_units,
        c_variance_units,
        c_u_highest,
        c_u_lowest,
        c_start_highest,
        c_start_lowest,
        c_valid_highest,
        c_valid_lowest,
        c_memory_source,
        c_memory_fault,
    ) = parts.constants
    div = parts.number.div
    sqrt = parts.number.sqrt
    quantise = parts.number.quantise

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_gap_number,
            state_gap_missed,
            state_gap_samples,
            state_gap_last,
            state_stage,
            state_cruise,
            state_cruising,
            state_accel,
            state_braking,
            state_learned_slot,
            state_learned_before_offset,
            state_learned_before_variance,
            state_learned_before_runs,
            state_learned_before_last_run,
            state_learned_after_offset,
            state_learned_after_variance,
            state_learned_after_runs,
            state_learned_after_last_run,
            state_learned_learned,
            state_learned_spoiled,
            state_learned_error,
            state_learned_gamma,
            _state_own_filter_0,
            _state_own_filter_1,
            _state_own_filter_2,
            _state_own_filter_3,
            _state_own_filter_4,
            state_own_filter_5,
            state_own_filter_6,
            state_own_filter_7,
            state_own_filter_8,
            state_own_filter_9,
            state_own_filter_10,
            state_own_filter_11,
            state_own_filter_12,
            state_own_filter_13,
            state_own_filter_14,
            state_own_filter_15,
            state_own_filter_16,
            state_own_filter_17,
            state_own_filter_18,
            state_own_filter_19,
            state_own_filter_20,
            state_own_filter_21,
            state_own_filter_22,
            state_own_filter_23,
            state_own_filter_24,
            state_own_filter_25,
            state_own_filter_26,
            state_own_filter_27,
            state_own_filter_28,
            state_own_filter_29,
            state_own_filter_30,
            state_own_filter_31,
            state_own_filter_32,
            state_own_filter_33,
            state_own_filter_34,
            state_own_filter_35,
            state_own_filter_36,
            state_own_filter_37,
            state_own_filter_38,
            state_own_filter_39,
            state_own_filter_40,
            state_own_filter_41,
            state_own_filter_42,
            state_own_filter_43,
            state_own_filter_44,
            state_own_filter_45,
            state_own_filter_46,
            state_own_filter_47,
            state_own_filter_48,
            state_own_filter_49,
            state_own_filter_50,
            state_own_filter_51,
            state_own_filter_52,
            state_own_filter_53,
            state_own_filter_54,
            state_own_filter_55,
            state_own_filter_56,
            state_own_filter_57,
            state_own_filter_58,
            state_own_filter_59,
            state_own_filter_60,
            state_own_filter_61,
            state_own_filter_62,
            state_own_filter_63,
            state_own_filter_64,
            state_own_filter_65,
            state_own_filter_66,
            state_own_filter_67,
            state_own_filter_68,
            state_own_filter_69,
            state_own_filter_70,
            state_own_filter_71,
            state_own_filter_72,
            state_own_filter_73,
            state_own_filter_74,
            state_own_filter_75,
            state_own_filter_76,
            state_own_filter_77,
            state_own_filter_78,
            state_own_filter_79,
            state_own_filter_80,
            state_own_filter_81,
            state_own_filter_82,
            state_own_filter_83,
            state_own_filter_84,
            state_own_filter_85,
            state_own_filter_86,
            state_own_filter_87,
            state_own_filter_88,
            state_own_filter_89,
            state_own_filter_90,
            state_own_filter_91,
            state_own_filter_92,
            state_own_filter_93,
            state_own_filter_94,
            state_own_filter_95,
            state_own_filter_96,
            state_own_filter_97,
            state_own_filter_98,
            state_own_filter_99,
            state_own_filter_100,
            state_own_filter_101,
            state_own_filter_102,
            state_own_filter_103,
            state_own_filter_104,
            state_own_filter_105,
            state_own_filter_106,
            state_own_filter_107,
            state_own_filter_108,
            state_own_filter_109,
            state_own_filter_110,
            state_own_filter_111,
            state_own_filter_112,
            state_own_filter_113,
            state_own_filter_114,
            state_own_filter_115,
            state_own_filter_116,
            state_own_filter_117,
            state_own_filter_118,
            state_own_filter_119,
            state_own_filter_120,
            state_own_filter_121,
            state_own_filter_122,
            state_own_filter_123,
            state_own_filter_124,
            state_own_filter_125,
            state_own_filter_126,
            state_own_filter_127,
            state_own_accel,
        ) = state
        (
            in_0,
            in_1,
            in_2,
            in_3,
            in_4,
            in_5,
            in_6,
            in_7,
            in_8,
            _in_9,
            in_10,
            _in_11,
            in_12,
            in_13,
            in_14,
            in_15,
            in_16,
            in_17,
            in_18,
        ) = given
        single[0] = in_0 * c_unit
        mpy_iqx_170 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_1 * c_unit
        mpy_iqx_171 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_2 * c_unit
        mpy_iqx_172 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_3 * c_unit
        mpy_iqx_173 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_4 * c_unit
        mpy_iqx_174 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_8 * c_unit
        mpy_iqx_175 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_10 * c_unit
        mpy_iqx_176 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_177 = c_report__1 if c_report__1 > in_17 else in_17
        if c_report_1 < clip_177:
            clip_177 = c_report_1
        single[0] = clip_177 * c_unit
        mpy_iqx_178 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = in_5 - state_gap_number
        sub_179 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_180 = abs(sub_179)
        gt_181 = abs_180 > c_zero
        where_182 = in_6 if gt_181 else c_zero
        gt_183 = where_182 > c_zero
        where_184 = mpy_iqx_170 if gt_183 else state_gap_last
        where_185 = mpy_iqx_171 if gt_183 else state_gap_last
        where_186 = mpy_iqx_172 if gt_183 else state_gap_last
        where_187 = mpy_iqx_173 if gt_183 else state_gap_last
        where_188 = mpy_iqx_174 if gt_183 else state_gap_last
        single[0] = state_gap_missed + c_one
        add_189 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        minimum_190 = c_count_max if c_count_max < add_189 else add_189
        where_191 = c_zero if gt_183 else minimum_190
        where_192 = c_samples if gt_183 else c_zero
        single[0] = state_gap_samples + where_192
        add_193 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        minimum_194 = c_count_max if c_count_max < add_193 else add_193
        gt_195 = where_191 > c_held_cycles
        where_196 = c_zero if gt_195 else minimum_194
        gt_197 = where_196 > c_warm_up
        where_198 = c_zero if gt_197 else c_one
        gt_199 = where_191 > c_held_cycles
        where_200 = c_one if gt_199 else where_198
        single[0] = c_packet_0 * state_own_filter_5
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_1 * state_own_filter_6
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_2 * state_own_filter_7
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_3 * state_own_filter_8
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_4 * state_own_filter_9
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_5 * state_own_filter_10
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_6 * state_own_filter_11
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_7 * state_own_filter_12
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_8 * state_own_filter_13
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_9 * state_own_filter_14
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_10 * state_own_filter_15
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_11 * state_own_filter_16
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_12 * state_own_filter_17
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_13 * state_own_filter_18
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_14 * state_own_filter_19
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_15 * state_own_filter_20
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_16 * state_own_filter_21
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_17 * state_own_filter_22
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_18 * state_own_filter_23
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_19 * state_own_filter_24
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_20 * state_own_filter_25
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_21 * state_own_filter_26
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_22 * state_own_filter_27
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_23 * state_own_filter_28
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_24 * state_own_filter_29
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_25 * state_own_filter_30
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_26 * state_own_filter_31
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_27 * state_own_filter_32
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_28 * state_own_filter_33
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_29 * state_own_filter_34
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_30 * state_own_filter_35
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_31 * state_own_filter_36
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_32 * state_own_filter_37
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_33 * state_own_filter_38
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_34 * state_own_filter_39
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_35 * state_own_filter_40
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_36 * state_own_filter_41
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_37 * state_own_filter_42
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_38 * state_own_filter_43
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_39 * state_own_filter_44
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_40 * state_own_filter_45
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_41 * state_own_filter_46
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_42 * state_own_filter_47
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_43 * state_own_filter_48
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_44 * state_own_filter_49
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_45 * state_own_filter_50
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_46 * state_own_filter_51
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_47 * state_own_filter_52
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_48 * state_own_filter_53
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_49 * state_own_filter_54
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_50 * state_own_filter_55
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_51 * state_own_filter_56
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_52 * state_own_filter_57
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_53 * state_own_filter_58
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_54 * state_own_filter_59
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_55 * state_own_filter_60
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_56 * state_own_filter_61
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_57 * state_own_filter_62
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_58 * state_own_filter_63
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_59 * state_own_filter_64
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_60 * state_own_filter_65
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_61 * state_own_filter_66
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_62 * state_own_filter_67
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_63 * state_own_filter_68
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_64 * state_own_filter_69
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_65 * state_own_filter_70
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_66 * state_own_filter_71
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_67 * state_own_filter_72
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_68 * state_own_filter_73
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_69 * state_own_filter_74
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_70 * state_own_filter_75
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_71 * state_own_filter_76
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_72 * state_own_filter_77
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_73 * state_own_filter_78
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_74 * state_own_filter_79
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_75 * state_own_filter_80
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_76 * state_own_filter_81
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_77 * state_own_filter_82
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_78 * state_own_filter_83
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_79 * state_own_filter_84
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_80 * state_own_filter_85
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_81 * state_own_filter_86
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_82 * state_own_filter_87
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_83 * state_own_filter_88
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_84 * state_own_filter_89
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_85 * state_own_filter_90
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_86 * state_own_filter_91
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_87 * state_own_filter_92
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_88 * state_own_filter_93
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_89 * state_own_filter_94
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_90 * state_own_filter_95
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_91 * state_own_filter_96
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_92 * state_own_filter_97
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_93 * state_own_filter_98
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_94 * state_own_filter_99
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_95 * state_own_filter_100
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_96 * state_own_filter_101
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_97 * state_own_filter_102
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_98 * state_own_filter_103
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_99 * state_own_filter_104
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_100 * state_own_filter_105
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_101 * state_own_filter_106
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_102 * state_own_filter_107
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_103 * state_own_filter_108
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_104 * state_own_filter_109
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_105 * state_own_filter_110
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_106 * state_own_filter_111
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_107 * state_own_filter_112
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_108 * state_own_filter_113
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_109 * state_own_filter_114
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_110 * state_own_filter_115
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_111 * state_own_filter_116
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_112 * state_own_filter_117
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_113 * state_own_filter_118
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_114 * state_own_filter_119
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_115 * state_own_filter_120
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_116 * state_own_filter_121
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_117 * state_own_filter_122
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_118 * state_own_filter_123
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_119 * state_own_filter_124
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_120 * state_own_filter_125
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_121 * state_own_filter_126
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_122 * state_own_filter_127
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_123 * where_184
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_124 * where_185
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_125 * where_186
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_126 * where_187
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_packet_127 * where_188
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat + product
        v_hat = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_way - mpy_iqx_175
        left = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_203 = in_12 > c_zero
        where_204 = c_planned_wet if gt_203 else c_planned_dry
        clip_205 = c_still if c_still > v_hat else v_hat
        if c_fastest < clip_205:
            clip_205 = c_fastest
        convert_206 = where_204
        div_207 = div(clip_205, convert_206, 20)
        clip_208 = c_time_0 if c_time_0 > div_207 else div_207
        if c_time_max < clip_208:
            clip_208 = c_time_max
        single[0] = c_model_lag_twice * clip_208
        mpy_209 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        sqrt_210 = sqrt(mpy_209, 20)
        clip_211 = c_time_0 if c_time_0 > sqrt_210 else sqrt_210
        if c_time_max < clip_211:
            clip_211 = c_time_max
        single[0] = clip_208 + c_model_lag
        add_212 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_208 + clip_211
        add_213 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        minimum_214 = add_213 if add_213 < add_212 else add_212
        clip_215 = c_time_0 if c_time_0 > minimum_214 else minimum_214
        if c_time_max < clip_215:
            clip_215 = c_time_max
        clip_216 = c_exp_zero if c_exp_zero > clip_215 else clip_215
        if c_exp_far < clip_216:
            clip_216 = c_exp_far
        single[0] = clip_216 * c_exp_scale
        mpy_iqx_217 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_217 * c_exp_part_0
        rmpy_218 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_218 * c_exp_one
        rmpy_219 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_219
        sub_220 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_217 * c_exp_part_1
        rmpy_221 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_221 * sub_220
        rmpy_222 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_222
        sub_223 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_217 * c_exp_part_2
        rmpy_224 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_224 * sub_223
        rmpy_225 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_225
        sub_226 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_217 * c_exp_part_3
        rmpy_227 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_227 * sub_226
        rmpy_228 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_228
        sub_229 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_217 * c_exp_part_4
        rmpy_230 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_230 * sub_229
        rmpy_231 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_231
        sub_232 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_217 * c_exp_part_5
        rmpy_233 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_233 * sub_232
        rmpy_234 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_234
        sub_235 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_217 * sub_235
        rmpy_236 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_236
        sub_237 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_237 * sub_237
        rmpy_238 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_238 * rmpy_238
        rmpy_239 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_239 * rmpy_239
        rmpy_240 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_240 * rmpy_240
        rmpy_241 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_241 * rmpy_241
        rmpy_242 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_242 * rmpy_242
        rmpy_243 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_243 * rmpy_243
        rmpy_244 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_244 * rmpy_244
        rmpy_245 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_slope_one - rmpy_245
        sub_246 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_lag * sub_246
        mpy_247 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_215 - mpy_247
        sub_248 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_248 - clip_208
        sub_249 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_250 = c_least_slope if c_least_slope > sub_246 else sub_246
        convert_251 = maximum_250
        div_252 = div(sub_249, convert_251, 20)
        clip_253 = c_time_min if c_time_min > div_252 else div_252
        if c_time_max < clip_253:
            clip_253 = c_time_max
        single[0] = clip_215 - clip_253
        sub_254 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_255 = c_time_0 if c_time_0 > sub_254 else sub_254
        if c_time_max < clip_255:
            clip_255 = c_time_max
        clip_256 = c_exp_zero if c_exp_zero > clip_255 else clip_255
        if c_exp_far < clip_256:
            clip_256 = c_exp_far
        single[0] = clip_256 * c_exp_scale
        mpy_iqx_257 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_257 * c_exp_part_0
        rmpy_258 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_258 * c_exp_one
        rmpy_259 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_259
        sub_260 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_257 * c_exp_part_1
        rmpy_261 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_261 * sub_260
        rmpy_262 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_262
        sub_263 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_257 * c_exp_part_2
        rmpy_264 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_264 * sub_263
        rmpy_265 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_265
        sub_266 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_257 * c_exp_part_3
        rmpy_267 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_267 * sub_266
        rmpy_268 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_268
        sub_269 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_257 * c_exp_part_4
        rmpy_270 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_270 * sub_269
        rmpy_271 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_271
        sub_272 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_257 * c_exp_part_5
        rmpy_273 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_273 * sub_272
        rmpy_274 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_274
        sub_275 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_257 * sub_275
        rmpy_276 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_276
        sub_277 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_277 * sub_277
        rmpy_278 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_278 * rmpy_278
        rmpy_279 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_279 * rmpy_279
        rmpy_280 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_280 * rmpy_280
        rmpy_281 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_281 * rmpy_281
        rmpy_282 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_282 * rmpy_282
        rmpy_283 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_283 * rmpy_283
        rmpy_284 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_284 * rmpy_284
        rmpy_285 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_slope_one - rmpy_285
        sub_286 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_lag * sub_286
        mpy_287 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_255 - mpy_287
        sub_288 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_288 - clip_208
        sub_289 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_290 = c_least_slope if c_least_slope > sub_286 else sub_286
        convert_291 = maximum_290
        div_292 = div(sub_289, convert_291, 20)
        clip_293 = c_time_min if c_time_min > div_292 else div_292
        if c_time_max < clip_293:
            clip_293 = c_time_max
        single[0] = clip_255 - clip_293
        sub_294 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_295 = c_time_0 if c_time_0 > sub_294 else sub_294
        if c_time_max < clip_295:
            clip_295 = c_time_max
        clip_296 = c_exp_zero if c_exp_zero > clip_295 else clip_295
        if c_exp_far < clip_296:
            clip_296 = c_exp_far
        single[0] = clip_296 * c_exp_scale
        mpy_iqx_297 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_297 * c_exp_part_0
        rmpy_298 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_298 * c_exp_one
        rmpy_299 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_299
        sub_300 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_297 * c_exp_part_1
        rmpy_301 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_301 * sub_300
        rmpy_302 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_302
        sub_303 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_297 * c_exp_part_2
        rmpy_304 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_304 * sub_303
        rmpy_305 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_305
        sub_306 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_297 * c_exp_part_3
        rmpy_307 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_307 * sub_306
        rmpy_308 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_308
        sub_309 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_297 * c_exp_part_4
        rmpy_310 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_310 * sub_309
        rmpy_311 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_311
        sub_312 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_297 * c_exp_part_5
        rmpy_313 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_313 * sub_312
        rmpy_314 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_314
        sub_315 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_297 * sub_315
        rmpy_316 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_316
        sub_317 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_317 * sub_317
        rmpy_318 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_318 * rmpy_318
        rmpy_319 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_319 * rmpy_319
        rmpy_320 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_320 * rmpy_320
        rmpy_321 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_321 * rmpy_321
        rmpy_322 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_322 * rmpy_322
        rmpy_323 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_323 * rmpy_323
        rmpy_324 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_324 * rmpy_324
        rmpy_325 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_slope_one - rmpy_325
        sub_326 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_lag * sub_326
        mpy_327 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_295 - mpy_327
        sub_328 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_328 - clip_208
        sub_329 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_330 = c_least_slope if c_least_slope > sub_326 else sub_326
        convert_331 = maximum_330
        div_332 = div(sub_329, convert_331, 20)
        clip_333 = c_time_min if c_time_min > div_332 else div_332
        if c_time_max < clip_333:
            clip_333 = c_time_max
        single[0] = clip_295 - clip_333
        sub_334 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_335 = c_time_0 if c_time_0 > sub_334 else sub_334
        if c_time_max < clip_335:
            clip_335 = c_time_max
        clip_336 = c_exp_zero if c_exp_zero > clip_335 else clip_335
        if c_exp_far < clip_336:
            clip_336 = c_exp_far
        single[0] = clip_336 * c_exp_scale
        mpy_iqx_337 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_337 * c_exp_part_0
        rmpy_338 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_338 * c_exp_one
        rmpy_339 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_339
        sub_340 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_337 * c_exp_part_1
        rmpy_341 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_341 * sub_340
        rmpy_342 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_342
        sub_343 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_337 * c_exp_part_2
        rmpy_344 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_344 * sub_343
        rmpy_345 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_345
        sub_346 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_337 * c_exp_part_3
        rmpy_347 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_347 * sub_346
        rmpy_348 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_348
        sub_349 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_337 * c_exp_part_4
        rmpy_350 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_350 * sub_349
        rmpy_351 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_351
        sub_352 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_337 * c_exp_part_5
        rmpy_353 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_353 * sub_352
        rmpy_354 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_354
        sub_355 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_337 * sub_355
        rmpy_356 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_exp_one - rmpy_356
        sub_357 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_357 * sub_357
        rmpy_358 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_358 * rmpy_358
        rmpy_359 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_359 * rmpy_359
        rmpy_360 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_360 * rmpy_360
        rmpy_361 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_361 * rmpy_361
        rmpy_362 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_362 * rmpy_362
        rmpy_363 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_363 * rmpy_363
        rmpy_364 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = rmpy_364 * rmpy_364
        rmpy_365 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_slope_one - rmpy_365
        sub_366 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_model_lag * sub_366
        mpy_367 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_335 - mpy_367
        sub_368 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_368 - clip_208
        sub_369 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_370 = c_least_slope if c_least_slope > sub_366 else sub_366
        convert_371 = maximum_370
        div_372 = div(sub_369, convert_371, 20)
        clip_373 = c_time_min if c_time_min > div_372 else div_372
        if c_time_max < clip_373:
            clip_373 = c_time_max
        single[0] = clip_335 - clip_373
        sub_374 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_375 = c_time_0 if c_time_0 > sub_374 else sub_374
        if c_time_max < clip_375:
            clip_375 = c_time_max
        single[0] = where_204 * c_half
        mpy_376 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_376 * clip_375
        mpy_iqx_377 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_205 - mpy_iqx_377
        sub_378 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_379 = c_mean_min if c_mean_min > sub_378 else sub_378
        if c_fastest < clip_379:
            clip_379 = c_fastest
        single[0] = clip_205 * c_model_delay_and_lag
        mpy_iqx_380 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_379 * clip_375
        mpy_iqx_381 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_380 + mpy_iqx_381
        add_382 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = clip_375 + c_model_delay
        add_383 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_384 = c_way_min if c_way_min > add_382 else add_382
        if c_way_max < clip_384:
            clip_384 = c_way_max
        single[0] = clip_384 + c_no_reserve
        f = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = left - f
        sub_386 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_386 - state_learned_before_offset
        margin_m = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = margin_m - c_epsilon
        sub_388 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_389 = sub_388 > c_nothing
        where_390 = c_zero if gt_389 else c_one
        gt_391 = v_hat > c_moving
        gt_392 = in_14 > c_zero
        where_393 = c_stage_idle if gt_392 else c_stage_start
        where_394 = c_stage_track if gt_391 else where_393
        where_395 = c_stage_accelerate if gt_391 else c_stage_start
        gt_396 = c_stage_start > state_stage
        where_397 = where_394 if gt_396 else where_395
        single[0] = state_cruise - c_reached
        sub_398 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_399 = v_hat > sub_398
        gt_400 = c_armed > margin_m
        where_401 = c_stage_track if gt_400 else c_stage_accelerate
        where_402 = c_stage_track if gt_399 else where_401
        gt_403 = c_stage_accelerate > state_stage
        where_404 = where_397 if gt_403 else where_402
        where_405 = c_stage_armed if gt_400 else c_stage_track
        gt_406 = where_200 > c_zero
        where_407 = c_stage_track if gt_406 else where_405
        gt_408 = c_stage_track > state_stage
        where_409 = where_404 if gt_408 else where_407
        gt_410 = where_390 > c_zero
        where_411 = c_stage_brake if gt_410 else c_stage_armed
        gt_412 = where_200 > c_zero
        where_413 = c_stage_track if gt_412 else where_411
        gt_414 = c_stage_armed > state_stage
        where_415 = where_409 if gt_414 else where_413
        gt_416 = in_13 > c_zero
        where_417 = c_stage_standstill if gt_416 else c_stage_brake
        gt_418 = c_stage_brake > state_stage
        where_419 = where_415 if gt_418 else where_417
        gt_420 = state_learned_learned > c_zero
        where_421 = c_stage_learn if gt_420 else c_stage_standstill
        gt_422 = c_stage_standstill > state_stage
        where_423 = where_419 if gt_422 else where_421
        gt_424 = state_stage > c_stage_standstill
        stage = c_stage_learn if gt_424 else where_423
        single[0] = c_one - where_200
        sub_426 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_427 = sub_426 if sub_426 > state_cruising else state_cruising
        gt_428 = maximum_427 > state_cruising
        where_429 = v_hat if gt_428 else state_cruise
        single[0] = where_429 - v_hat
        sub_430 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_431 = c_minus_far if c_minus_far > sub_430 else sub_430
        if c_far < clip_431:
            clip_431 = c_far
        single[0] = clip_431 * c_hold
        mpy_iqx_432 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_433 = maximum_427 > c_zero
        where_434 = mpy_iqx_432 if gt_433 else c_zero
        clip_435 = c_minus_pull if c_minus_pull > where_434 else where_434
        if c_pull < clip_435:
            clip_435 = c_pull
        gt_436 = c_grade_left_0 > left
        single[0] = c_grade_base + c_grade_change_0
        add_437 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        where_438 = add_437 if gt_436 else c_grade_base
        single[0] = clip_435 - where_438
        sub_439 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_439 - state_accel
        sub_440 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_441 = c_minus_jerk if c_minus_jerk > sub_440 else sub_440
        if c_jerk < clip_441:
            clip_441 = c_jerk
        single[0] = state_accel + clip_441
        add_442 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_443 = stage > c_stage_idle
        where_444 = add_442 if gt_443 else state_accel
        gt_445 = stage > c_stage_armed
        gt_446 = c_stage_brake > state_stage
        where_447 = c_one if gt_446 else c_zero
        where_448 = where_447 if gt_445 else c_zero
        gt_449 = where_191 > c_zero
        where_450 = c_one if gt_449 else c_zero
        gt_451 = where_448 > c_zero
        neg_452 = 0.0 - where_204
        where_453 = neg_452 if gt_451 else state_accel
        where_454 = where_453 if gt_445 else where_444
        accel = c_accel_min if c_accel_min > where_454 else where_454
        if c_accel_max < accel:
            accel = c_accel_max
        single[0] = accel * c_mm
        mpy_iqx_456 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        quantise_457 = quantise(mpy_iqx_456, 16, 0)
        single[0] = quantise_457 * c_unit
        mpy_iqx_458 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_459 = c_accel_min if c_accel_min > mpy_iqx_458 else mpy_iqx_458
        if c_accel_max < clip_459:
            clip_459 = c_accel_max
        gt_460 = where_448 > c_zero
        where_461 = c_at_once if gt_460 else c_at_once
        gt_462 = where_448 > c_zero
        where_463 = f if gt_462 else state_braking
        gt_464 = stage > c_stage_brake
        where_465 = c_one if gt_464 else c_zero
        gt_466 = in_18 > c_cut
        where_467 = c_one if gt_466 else c_zero
        gt_468 = where_465 > c_zero
        maximum_469 = where_467 if where_467 > in_7 else in_7
        where_470 = c_zero if gt_468 else maximum_469
        maximum_471 = where_470 if where_470 > state_learned_spoiled else state_learned_spoiled
        abs_472 = abs(mpy_iqx_178)
        gt_473 = c_error_max > abs_472
        where_474 = where_465 if gt_473 else c_zero
        single[0] = in_16 - in_15
        sub_475 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        abs_476 = abs(sub_475)
        gt_477 = abs_476 > c_zero
        where_478 = c_zero if gt_477 else where_474
        gt_479 = in_15 > c_memory_last_run
        where_480 = where_478 if gt_479 else c_zero
        gt_481 = state_learned_learned > c_zero
        where_482 = c_zero if gt_481 else where_480
        gt_483 = maximum_471 > c_zero
        where_484 = c_zero if gt_483 else where_482
        single[0] = state_learned_before_runs + c_one
        add_485 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        minimum_486 = c_runs_max if c_runs_max < add_485 else add_485
        div_487 = div(c_one, minimum_486, 28)
        maximum_488 = c_gamma_least if c_gamma_least > div_487 else div_487
        clip_489 = c_five__1 if c_five__1 > mpy_iqx_178 else mpy_iqx_178
        if c_five_1 < clip_489:
            clip_489 = c_five_1
        single[0] = clip_489 * clip_489
        mpy_iqx_490 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = mpy_iqx_490 - state_learned_before_variance
        sub_491 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_491 * maximum_488
        mpy_492 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_learned_before_variance + mpy_492
        add_493 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_494 = c_variance_min if c_variance_min > add_493 else add_493
        if c_variance_max < clip_494:
            clip_494 = c_variance_max
        clip_495 = c_minus_error_max if c_minus_error_max > mpy_iqx_178 else mpy_iqx_178
        if c_error_max < clip_495:
            clip_495 = c_error_max
        single[0] = clip_495 * c_gamma
        mpy_496 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_497 = c_step__1 if c_step__1 > mpy_496 else mpy_496
        if c_step_1 < clip_497:
            clip_497 = c_step_1
        single[0] = state_learned_before_offset + clip_497
        add_498 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_499 = c_offset__1 if c_offset__1 > add_498 else add_498
        if c_offset_1 < clip_499:
            clip_499 = c_offset_1
        gt_500 = where_484 > c_zero
        gt_501 = where_484 > c_zero
        where_502 = clip_499 if gt_500 else state_learned_after_offset
        where_503 = clip_494 if gt_501 else state_learned_after_variance
        where_504 = minimum_486 if gt_500 else state_learned_after_runs
        where_505 = in_15 if gt_500 else state_learned_after_last_run
        maximum_506 = where_482 if where_482 > state_learned_learned else state_learned_learned
        where_507 = mpy_iqx_178 if gt_500 else state_learned_error
        where_508 = c_gamma if gt_500 else state_learned_gamma
        gt_509 = maximum_506 > state_learned_learned
        single[0] = c_one - maximum_471
        sub_510 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        where_511 = sub_510 if gt_509 else c_zero
        clip_512 = c_told_min if c_told_min > state_learned_before_offset else state_learned_before_offset
        if c_told_max < clip_512:
            clip_512 = c_told_max
        single[0] = clip_512 * c_mm
        memory_offset = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_514 = quantise_457
        single[0] = where_461 * c_start_units
        mpy_iqx_515 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_516 = c_told_min if c_told_min > margin_m else margin_m
        if c_told_max < clip_516:
            clip_516 = c_told_max
        single[0] = clip_516 * c_mm
        margin = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_518 = c_told_min if c_told_min > f else f
        if c_told_max < clip_518:
            clip_518 = c_told_max
        single[0] = clip_518 * c_mm
        stop_distance = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = v_hat * c_mm
        speed_estimate = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_learned_before_variance * c_variance_units
        memory_variance = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        quantise_522 = quantise(convert_514, 16, 0)
        u = c_u_lowest if c_u_lowest > quantise_522 else quantise_522
        if c_u_highest < u:
            u = c_u_highest
        quantise_524 = quantise(mpy_iqx_515, 8, 0)
        start = c_start_lowest if c_start_lowest > quantise_524 else quantise_524
        if c_start_highest < start:
            start = c_start_highest
        convert_526 = c_one
        valid = c_valid_lowest if c_valid_lowest > convert_526 else convert_526
        if c_valid_highest < valid:
            valid = c_valid_highest
        return (
            (
                in_5,
                where_191,
                where_196,
                where_188,
                stage,
                where_429,
                maximum_427,
                clip_459,
                where_463,
                state_learned_slot,
                state_learned_before_offset,
                state_learned_before_variance,
                state_learned_before_runs,
                state_learned_before_last_run,
                where_502,
                where_503,
                where_504,
                where_505,
                maximum_506,
                maximum_471,
                where_507,
                where_508,
                state_own_filter_5,
                state_own_filter_6,
                state_own_filter_7,
                state_own_filter_8,
                state_own_filter_9,
                state_own_filter_10,
                state_own_filter_11,
                state_own_filter_12,
                state_own_filter_13,
                state_own_filter_14,
                state_own_filter_15,
                state_own_filter_16,
                state_own_filter_17,
                state_own_filter_18,
                state_own_filter_19,
                state_own_filter_20,
                state_own_filter_21,
                state_own_filter_22,
                state_own_filter_23,
                state_own_filter_24,
                state_own_filter_25,
                state_own_filter_26,
                state_own_filter_27,
                state_own_filter_28,
                state_own_filter_29,
                state_own_filter_30,
                state_own_filter_31,
                state_own_filter_32,
                state_own_filter_33,
                state_own_filter_34,
                state_own_filter_35,
                state_own_filter_36,
                state_own_filter_37,
                state_own_filter_38,
                state_own_filter_39,
                state_own_filter_40,
                state_own_filter_41,
                state_own_filter_42,
                state_own_filter_43,
                state_own_filter_44,
                state_own_filter_45,
                state_own_filter_46,
                state_own_filter_47,
                state_own_filter_48,
                state_own_filter_49,
                state_own_filter_50,
                state_own_filter_51,
                state_own_filter_52,
                state_own_filter_53,
                state_own_filter_54,
                state_own_filter_55,
                state_own_filter_56,
                state_own_filter_57,
                state_own_filter_58,
                state_own_filter_59,
                state_own_filter_60,
                state_own_filter_61,
                state_own_filter_62,
                state_own_filter_63,
                state_own_filter_64,
                state_own_filter_65,
                state_own_filter_66,
                state_own_filter_67,
                state_own_filter_68,
                state_own_filter_69,
                state_own_filter_70,
                state_own_filter_71,
                state_own_filter_72,
                state_own_filter_73,
                state_own_filter_74,
                state_own_filter_75,
                state_own_filter_76,
                state_own_filter_77,
                state_own_filter_78,
                state_own_filter_79,
                state_own_filter_80,
                state_own_filter_81,
                state_own_filter_82,
                state_own_filter_83,
                state_own_filter_84,
                state_own_filter_85,
                state_own_filter_86,
                state_own_filter_87,
                state_own_filter_88,
                state_own_filter_89,
                state_own_filter_90,
                state_own_filter_91,
                state_own_filter_92,
                state_own_filter_93,
                state_own_filter_94,
                state_own_filter_95,
                state_own_filter_96,
                state_own_filter_97,
                state_own_filter_98,
                state_own_filter_99,
                state_own_filter_100,
                state_own_filter_101,
                state_own_filter_102,
                state_own_filter_103,
                state_own_filter_104,
                state_own_filter_105,
                state_own_filter_106,
                state_own_filter_107,
                state_own_filter_108,
                state_own_filter_109,
                state_own_filter_110,
                state_own_filter_111,
                state_own_filter_112,
                state_own_filter_113,
                state_own_filter_114,
                state_own_filter_115,
                state_own_filter_116,
                state_own_filter_117,
                state_own_filter_118,
                state_own_filter_119,
                state_own_filter_120,
                state_own_filter_121,
                state_own_filter_122,
                state_own_filter_123,
                state_own_filter_124,
                state_own_filter_125,
                state_own_filter_126,
                state_own_filter_127,
                where_184,
                where_185,
                where_186,
                where_187,
                where_188,
                state_own_accel,
            ),
            (
                u,
                start,
                valid,
                stage,
                margin,
                stop_distance,
                memory_offset,
                speed_estimate,
                c_memory_source,
                memory_offset,
                memory_variance,
                state_learned_before_runs,
                c_memory_fault,
            ),
            (
                v_hat,
                left,
                f,
                margin_m,
                stage,
                accel,
                u,
                start,
                valid,
                stage,
                margin,
                stop_distance,
                memory_offset,
                speed_estimate,
                c_memory_source,
                memory_offset,
                memory_variance,
                state_learned_before_runs,
                c_memory_fault,
            ),
        )

    return period
