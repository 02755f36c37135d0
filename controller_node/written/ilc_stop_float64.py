"""Law ilc_stop in double precision. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

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
        mpy_iqx_170 = in_0 * c_unit
        mpy_iqx_171 = in_1 * c_unit
        mpy_iqx_172 = in_2 * c_unit
        mpy_iqx_173 = in_3 * c_unit
        mpy_iqx_174 = in_4 * c_unit
        mpy_iqx_175 = in_8 * c_unit
        mpy_iqx_176 = in_10 * c_unit
        clip_177 = c_report__1 if c_report__1 > in_17 else in_17
        if c_report_1 < clip_177:
            clip_177 = c_report_1
        mpy_iqx_178 = clip_177 * c_unit
        sub_179 = in_5 - state_gap_number
        abs_180 = abs(sub_179)
        gt_181 = abs_180 > c_zero
        where_182 = in_6 if gt_181 else c_zero
        gt_183 = where_182 > c_zero
        where_184 = mpy_iqx_170 if gt_183 else state_gap_last
        where_185 = mpy_iqx_171 if gt_183 else state_gap_last
        where_186 = mpy_iqx_172 if gt_183 else state_gap_last
        where_187 = mpy_iqx_173 if gt_183 else state_gap_last
        where_188 = mpy_iqx_174 if gt_183 else state_gap_last
        add_189 = state_gap_missed + c_one
        minimum_190 = c_count_max if c_count_max < add_189 else add_189
        where_191 = c_zero if gt_183 else minimum_190
        where_192 = c_samples if gt_183 else c_zero
        add_193 = state_gap_samples + where_192
        minimum_194 = c_count_max if c_count_max < add_193 else add_193
        gt_195 = where_191 > c_held_cycles
        where_196 = c_zero if gt_195 else minimum_194
        gt_197 = where_196 > c_warm_up
        where_198 = c_zero if gt_197 else c_one
        gt_199 = where_191 > c_held_cycles
        where_200 = c_one if gt_199 else where_198
        v_hat = 0.0 + c_packet_0 * state_own_filter_5
        v_hat += c_packet_1 * state_own_filter_6
        v_hat += c_packet_2 * state_own_filter_7
        v_hat += c_packet_3 * state_own_filter_8
        v_hat += c_packet_4 * state_own_filter_9
        v_hat += c_packet_5 * state_own_filter_10
        v_hat += c_packet_6 * state_own_filter_11
        v_hat += c_packet_7 * state_own_filter_12
        v_hat += c_packet_8 * state_own_filter_13
        v_hat += c_packet_9 * state_own_filter_14
        v_hat += c_packet_10 * state_own_filter_15
        v_hat += c_packet_11 * state_own_filter_16
        v_hat += c_packet_12 * state_own_filter_17
        v_hat += c_packet_13 * state_own_filter_18
        v_hat += c_packet_14 * state_own_filter_19
        v_hat += c_packet_15 * state_own_filter_20
        v_hat += c_packet_16 * state_own_filter_21
        v_hat += c_packet_17 * state_own_filter_22
        v_hat += c_packet_18 * state_own_filter_23
        v_hat += c_packet_19 * state_own_filter_24
        v_hat += c_packet_20 * state_own_filter_25
        v_hat += c_packet_21 * state_own_filter_26
        v_hat += c_packet_22 * state_own_filter_27
        v_hat += c_packet_23 * state_own_filter_28
        v_hat += c_packet_24 * state_own_filter_29
        v_hat += c_packet_25 * state_own_filter_30
        v_hat += c_packet_26 * state_own_filter_31
        v_hat += c_packet_27 * state_own_filter_32
        v_hat += c_packet_28 * state_own_filter_33
        v_hat += c_packet_29 * state_own_filter_34
        v_hat += c_packet_30 * state_own_filter_35
        v_hat += c_packet_31 * state_own_filter_36
        v_hat += c_packet_32 * state_own_filter_37
        v_hat += c_packet_33 * state_own_filter_38
        v_hat += c_packet_34 * state_own_filter_39
        v_hat += c_packet_35 * state_own_filter_40
        v_hat += c_packet_36 * state_own_filter_41
        v_hat += c_packet_37 * state_own_filter_42
        v_hat += c_packet_38 * state_own_filter_43
        v_hat += c_packet_39 * state_own_filter_44
        v_hat += c_packet_40 * state_own_filter_45
        v_hat += c_packet_41 * state_own_filter_46
        v_hat += c_packet_42 * state_own_filter_47
        v_hat += c_packet_43 * state_own_filter_48
        v_hat += c_packet_44 * state_own_filter_49
        v_hat += c_packet_45 * state_own_filter_50
        v_hat += c_packet_46 * state_own_filter_51
        v_hat += c_packet_47 * state_own_filter_52
        v_hat += c_packet_48 * state_own_filter_53
        v_hat += c_packet_49 * state_own_filter_54
        v_hat += c_packet_50 * state_own_filter_55
        v_hat += c_packet_51 * state_own_filter_56
        v_hat += c_packet_52 * state_own_filter_57
        v_hat += c_packet_53 * state_own_filter_58
        v_hat += c_packet_54 * state_own_filter_59
        v_hat += c_packet_55 * state_own_filter_60
        v_hat += c_packet_56 * state_own_filter_61
        v_hat += c_packet_57 * state_own_filter_62
        v_hat += c_packet_58 * state_own_filter_63
        v_hat += c_packet_59 * state_own_filter_64
        v_hat += c_packet_60 * state_own_filter_65
        v_hat += c_packet_61 * state_own_filter_66
        v_hat += c_packet_62 * state_own_filter_67
        v_hat += c_packet_63 * state_own_filter_68
        v_hat += c_packet_64 * state_own_filter_69
        v_hat += c_packet_65 * state_own_filter_70
        v_hat += c_packet_66 * state_own_filter_71
        v_hat += c_packet_67 * state_own_filter_72
        v_hat += c_packet_68 * state_own_filter_73
        v_hat += c_packet_69 * state_own_filter_74
        v_hat += c_packet_70 * state_own_filter_75
        v_hat += c_packet_71 * state_own_filter_76
        v_hat += c_packet_72 * state_own_filter_77
        v_hat += c_packet_73 * state_own_filter_78
        v_hat += c_packet_74 * state_own_filter_79
        v_hat += c_packet_75 * state_own_filter_80
        v_hat += c_packet_76 * state_own_filter_81
        v_hat += c_packet_77 * state_own_filter_82
        v_hat += c_packet_78 * state_own_filter_83
        v_hat += c_packet_79 * state_own_filter_84
        v_hat += c_packet_80 * state_own_filter_85
        v_hat += c_packet_81 * state_own_filter_86
        v_hat += c_packet_82 * state_own_filter_87
        v_hat += c_packet_83 * state_own_filter_88
        v_hat += c_packet_84 * state_own_filter_89
        v_hat += c_packet_85 * state_own_filter_90
        v_hat += c_packet_86 * state_own_filter_91
        v_hat += c_packet_87 * state_own_filter_92
        v_hat += c_packet_88 * state_own_filter_93
        v_hat += c_packet_89 * state_own_filter_94
        v_hat += c_packet_90 * state_own_filter_95
        v_hat += c_packet_91 * state_own_filter_96
        v_hat += c_packet_92 * state_own_filter_97
        v_hat += c_packet_93 * state_own_filter_98
        v_hat += c_packet_94 * state_own_filter_99
        v_hat += c_packet_95 * state_own_filter_100
        v_hat += c_packet_96 * state_own_filter_101
        v_hat += c_packet_97 * state_own_filter_102
        v_hat += c_packet_98 * state_own_filter_103
        v_hat += c_packet_99 * state_own_filter_104
        v_hat += c_packet_100 * state_own_filter_105
        v_hat += c_packet_101 * state_own_filter_106
        v_hat += c_packet_102 * state_own_filter_107
        v_hat += c_packet_103 * state_own_filter_108
        v_hat += c_packet_104 * state_own_filter_109
        v_hat += c_packet_105 * state_own_filter_110
        v_hat += c_packet_106 * state_own_filter_111
        v_hat += c_packet_107 * state_own_filter_112
        v_hat += c_packet_108 * state_own_filter_113
        v_hat += c_packet_109 * state_own_filter_114
        v_hat += c_packet_110 * state_own_filter_115
        v_hat += c_packet_111 * state_own_filter_116
        v_hat += c_packet_112 * state_own_filter_117
        v_hat += c_packet_113 * state_own_filter_118
        v_hat += c_packet_114 * state_own_filter_119
        v_hat += c_packet_115 * state_own_filter_120
        v_hat += c_packet_116 * state_own_filter_121
        v_hat += c_packet_117 * state_own_filter_122
        v_hat += c_packet_118 * state_own_filter_123
        v_hat += c_packet_119 * state_own_filter_124
        v_hat += c_packet_120 * state_own_filter_125
        v_hat += c_packet_121 * state_own_filter_126
        v_hat += c_packet_122 * state_own_filter_127
        v_hat += c_packet_123 * where_184
        v_hat += c_packet_124 * where_185
        v_hat += c_packet_125 * where_186
        v_hat += c_packet_126 * where_187
        v_hat += c_packet_127 * where_188
        left = c_way - mpy_iqx_175
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
        mpy_209 = c_model_lag_twice * clip_208
        sqrt_210 = sqrt(mpy_209, 20)
        clip_211 = c_time_0 if c_time_0 > sqrt_210 else sqrt_210
        if c_time_max < clip_211:
            clip_211 = c_time_max
        add_212 = clip_208 + c_model_lag
        add_213 = clip_208 + clip_211
        minimum_214 = add_213 if add_213 < add_212 else add_212
        clip_215 = c_time_0 if c_time_0 > minimum_214 else minimum_214
        if c_time_max < clip_215:
            clip_215 = c_time_max
        clip_216 = c_exp_zero if c_exp_zero > clip_215 else clip_215
        if c_exp_far < clip_216:
            clip_216 = c_exp_far
        mpy_iqx_217 = clip_216 * c_exp_scale
        rmpy_218 = mpy_iqx_217 * c_exp_part_0
        rmpy_219 = rmpy_218 * c_exp_one
        sub_220 = c_exp_one - rmpy_219
        rmpy_221 = mpy_iqx_217 * c_exp_part_1
        rmpy_222 = rmpy_221 * sub_220
        sub_223 = c_exp_one - rmpy_222
        rmpy_224 = mpy_iqx_217 * c_exp_part_2
        rmpy_225 = rmpy_224 * sub_223
        sub_226 = c_exp_one - rmpy_225
        rmpy_227 = mpy_iqx_217 * c_exp_part_3
        rmpy_228 = rmpy_227 * sub_226
        sub_229 = c_exp_one - rmpy_228
        rmpy_230 = mpy_iqx_217 * c_exp_part_4
        rmpy_231 = rmpy_230 * sub_229
        sub_232 = c_exp_one - rmpy_231
        rmpy_233 = mpy_iqx_217 * c_exp_part_5
        rmpy_234 = rmpy_233 * sub_232
        sub_235 = c_exp_one - rmpy_234
        rmpy_236 = mpy_iqx_217 * sub_235
        sub_237 = c_exp_one - rmpy_236
        rmpy_238 = sub_237 * sub_237
        rmpy_239 = rmpy_238 * rmpy_238
        rmpy_240 = rmpy_239 * rmpy_239
        rmpy_241 = rmpy_240 * rmpy_240
        rmpy_242 = rmpy_241 * rmpy_241
        rmpy_243 = rmpy_242 * rmpy_242
        rmpy_244 = rmpy_243 * rmpy_243
        rmpy_245 = rmpy_244 * rmpy_244
        sub_246 = c_slope_one - rmpy_245
        mpy_247 = c_model_lag * sub_246
        sub_248 = clip_215 - mpy_247
        sub_249 = sub_248 - clip_208
        maximum_250 = c_least_slope if c_least_slope > sub_246 else sub_246
        convert_251 = maximum_250
        div_252 = div(sub_249, convert_251, 20)
        clip_253 = c_time_min if c_time_min > div_252 else div_252
        if c_time_max < clip_253:
            clip_253 = c_time_max
        sub_254 = clip_215 - clip_253
        clip_255 = c_time_0 if c_time_0 > sub_254 else sub_254
        if c_time_max < clip_255:
            clip_255 = c_time_max
        clip_256 = c_exp_zero if c_exp_zero > clip_255 else clip_255
        if c_exp_far < clip_256:
            clip_256 = c_exp_far
        mpy_iqx_257 = clip_256 * c_exp_scale
        rmpy_258 = mpy_iqx_257 * c_exp_part_0
        rmpy_259 = rmpy_258 * c_exp_one
        sub_260 = c_exp_one - rmpy_259
        rmpy_261 = mpy_iqx_257 * c_exp_part_1
        rmpy_262 = rmpy_261 * sub_260
        sub_263 = c_exp_one - rmpy_262
        rmpy_264 = mpy_iqx_257 * c_exp_part_2
        rmpy_265 = rmpy_264 * sub_263
        sub_266 = c_exp_one - rmpy_265
        rmpy_267 = mpy_iqx_257 * c_exp_part_3
        rmpy_268 = rmpy_267 * sub_266
        sub_269 = c_exp_one - rmpy_268
        rmpy_270 = mpy_iqx_257 * c_exp_part_4
        rmpy_271 = rmpy_270 * sub_269
        sub_272 = c_exp_one - rmpy_271
        rmpy_273 = mpy_iqx_257 * c_exp_part_5
        rmpy_274 = rmpy_273 * sub_272
        sub_275 = c_exp_one - rmpy_274
        rmpy_276 = mpy_iqx_257 * sub_275
        sub_277 = c_exp_one - rmpy_276
        rmpy_278 = sub_277 * sub_277
        rmpy_279 = rmpy_278 * rmpy_278
        rmpy_280 = rmpy_279 * rmpy_279
        rmpy_281 = rmpy_280 * rmpy_280
        rmpy_282 = rmpy_281 * rmpy_281
        rmpy_283 = rmpy_282 * rmpy_282
        rmpy_284 = rmpy_283 * rmpy_283
        rmpy_285 = rmpy_284 * rmpy_284
        sub_286 = c_slope_one - rmpy_285
        mpy_287 = c_model_lag * sub_286
        sub_288 = clip_255 - mpy_287
        sub_289 = sub_288 - clip_208
        maximum_290 = c_least_slope if c_least_slope > sub_286 else sub_286
        convert_291 = maximum_290
        div_292 = div(sub_289, convert_291, 20)
        clip_293 = c_time_min if c_time_min > div_292 else div_292
        if c_time_max < clip_293:
            clip_293 = c_time_max
        sub_294 = clip_255 - clip_293
        clip_295 = c_time_0 if c_time_0 > sub_294 else sub_294
        if c_time_max < clip_295:
            clip_295 = c_time_max
        clip_296 = c_exp_zero if c_exp_zero > clip_295 else clip_295
        if c_exp_far < clip_296:
            clip_296 = c_exp_far
        mpy_iqx_297 = clip_296 * c_exp_scale
        rmpy_298 = mpy_iqx_297 * c_exp_part_0
        rmpy_299 = rmpy_298 * c_exp_one
        sub_300 = c_exp_one - rmpy_299
        rmpy_301 = mpy_iqx_297 * c_exp_part_1
        rmpy_302 = rmpy_301 * sub_300
        sub_303 = c_exp_one - rmpy_302
        rmpy_304 = mpy_iqx_297 * c_exp_part_2
        rmpy_305 = rmpy_304 * sub_303
        sub_306 = c_exp_one - rmpy_305
        rmpy_307 = mpy_iqx_297 * c_exp_part_3
        rmpy_308 = rmpy_307 * sub_306
        sub_309 = c_exp_one - rmpy_308
        rmpy_310 = mpy_iqx_297 * c_exp_part_4
        rmpy_311 = rmpy_310 * sub_309
        sub_312 = c_exp_one - rmpy_311
        rmpy_313 = mpy_iqx_297 * c_exp_part_5
        rmpy_314 = rmpy_313 * sub_312
        sub_315 = c_exp_one - rmpy_314
        rmpy_316 = mpy_iqx_297 * sub_315
        sub_317 = c_exp_one - rmpy_316
        rmpy_318 = sub_317 * sub_317
        rmpy_319 = rmpy_318 * rmpy_318
        rmpy_320 = rmpy_319 * rmpy_319
        rmpy_321 = rmpy_320 * rmpy_320
        rmpy_322 = rmpy_321 * rmpy_321
        rmpy_323 = rmpy_322 * rmpy_322
        rmpy_324 = rmpy_323 * rmpy_323
        rmpy_325 = rmpy_324 * rmpy_324
        sub_326 = c_slope_one - rmpy_325
        mpy_327 = c_model_lag * sub_326
        sub_328 = clip_295 - mpy_327
        sub_329 = sub_328 - clip_208
        maximum_330 = c_least_slope if c_least_slope > sub_326 else sub_326
        convert_331 = maximum_330
        div_332 = div(sub_329, convert_331, 20)
        clip_333 = c_time_min if c_time_min > div_332 else div_332
        if c_time_max < clip_333:
            clip_333 = c_time_max
        sub_334 = clip_295 - clip_333
        clip_335 = c_time_0 if c_time_0 > sub_334 else sub_334
        if c_time_max < clip_335:
            clip_335 = c_time_max
        clip_336 = c_exp_zero if c_exp_zero > clip_335 else clip_335
        if c_exp_far < clip_336:
            clip_336 = c_exp_far
        mpy_iqx_337 = clip_336 * c_exp_scale
        rmpy_338 = mpy_iqx_337 * c_exp_part_0
        rmpy_339 = rmpy_338 * c_exp_one
        sub_340 = c_exp_one - rmpy_339
        rmpy_341 = mpy_iqx_337 * c_exp_part_1
        rmpy_342 = rmpy_341 * sub_340
        sub_343 = c_exp_one - rmpy_342
        rmpy_344 = mpy_iqx_337 * c_exp_part_2
        rmpy_345 = rmpy_344 * sub_343
        sub_346 = c_exp_one - rmpy_345
        rmpy_347 = mpy_iqx_337 * c_exp_part_3
        rmpy_348 = rmpy_347 * sub_346
        sub_349 = c_exp_one - rmpy_348
        rmpy_350 = mpy_iqx_337 * c_exp_part_4
        rmpy_351 = rmpy_350 * sub_349
        sub_352 = c_exp_one - rmpy_351
        rmpy_353 = mpy_iqx_337 * c_exp_part_5
        rmpy_354 = rmpy_353 * sub_352
        sub_355 = c_exp_one - rmpy_354
        rmpy_356 = mpy_iqx_337 * sub_355
        sub_357 = c_exp_one - rmpy_356
        rmpy_358 = sub_357 * sub_357
        rmpy_359 = rmpy_358 * rmpy_358
        rmpy_360 = rmpy_359 * rmpy_359
        rmpy_361 = rmpy_360 * rmpy_360
        rmpy_362 = rmpy_361 * rmpy_361
        rmpy_363 = rmpy_362 * rmpy_362
        rmpy_364 = rmpy_363 * rmpy_363
        rmpy_365 = rmpy_364 * rmpy_364
        sub_366 = c_slope_one - rmpy_365
        mpy_367 = c_model_lag * sub_366
        sub_368 = clip_335 - mpy_367
        sub_369 = sub_368 - clip_208
        maximum_370 = c_least_slope if c_least_slope > sub_366 else sub_366
        convert_371 = maximum_370
        div_372 = div(sub_369, convert_371, 20)
        clip_373 = c_time_min if c_time_min > div_372 else div_372
        if c_time_max < clip_373:
            clip_373 = c_time_max
        sub_374 = clip_335 - clip_373
        clip_375 = c_time_0 if c_time_0 > sub_374 else sub_374
        if c_time_max < clip_375:
            clip_375 = c_time_max
        mpy_376 = where_204 * c_half
        mpy_iqx_377 = mpy_376 * clip_375
        sub_378 = clip_205 - mpy_iqx_377
        clip_379 = c_mean_min if c_mean_min > sub_378 else sub_378
        if c_fastest < clip_379:
            clip_379 = c_fastest
        mpy_iqx_380 = clip_205 * c_model_delay_and_lag
        mpy_iqx_381 = clip_379 * clip_375
        add_382 = mpy_iqx_380 + mpy_iqx_381
        add_383 = clip_375 + c_model_delay
        clip_384 = c_way_min if c_way_min > add_382 else add_382
        if c_way_max < clip_384:
            clip_384 = c_way_max
        f = clip_384 + c_no_reserve
        sub_386 = left - f
        margin_m = sub_386 - state_learned_before_offset
        sub_388 = margin_m - c_epsilon
        gt_389 = sub_388 > c_nothing
        where_390 = c_zero if gt_389 else c_one
        gt_391 = v_hat > c_moving
        gt_392 = in_14 > c_zero
        where_393 = c_stage_idle if gt_392 else c_stage_start
        where_394 = c_stage_track if gt_391 else where_393
        where_395 = c_stage_accelerate if gt_391 else c_stage_start
        gt_396 = c_stage_start > state_stage
        where_397 = where_394 if gt_396 else where_395
        sub_398 = state_cruise - c_reached
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
        sub_426 = c_one - where_200
        maximum_427 = sub_426 if sub_426 > state_cruising else state_cruising
        gt_428 = maximum_427 > state_cruising
        where_429 = v_hat if gt_428 else state_cruise
        sub_430 = where_429 - v_hat
        clip_431 = c_minus_far if c_minus_far > sub_430 else sub_430
        if c_far < clip_431:
            clip_431 = c_far
        mpy_iqx_432 = clip_431 * c_hold
        gt_433 = maximum_427 > c_zero
        where_434 = mpy_iqx_432 if gt_433 else c_zero
        clip_435 = c_minus_pull if c_minus_pull > where_434 else where_434
        if c_pull < clip_435:
            clip_435 = c_pull
        gt_436 = c_grade_left_0 > left
        add_437 = c_grade_base + c_grade_change_0
        where_438 = add_437 if gt_436 else c_grade_base
        sub_439 = clip_435 - where_438
        sub_440 = sub_439 - state_accel
        clip_441 = c_minus_jerk if c_minus_jerk > sub_440 else sub_440
        if c_jerk < clip_441:
            clip_441 = c_jerk
        add_442 = state_accel + clip_441
        gt_443 = stage > c_stage_idle
        where_444 = add_442 if gt_443 else state_accel
        gt_445 = stage > c_stage_armed
        gt_446 = c_stage_brake > state_stage
        where_447 = c_one if gt_446 else c_zero
        where_448 = where_447 if gt_445 else c_zero
        gt_449 = where_191 > c_zero
        where_450 = c_one if gt_449 else c_zero
        gt_451 = where_448 > c_zero
        neg_452 = -where_204
        where_453 = neg_452 if gt_451 else state_accel
        where_454 = where_453 if gt_445 else where_444
        accel = c_accel_min if c_accel_min > where_454 else where_454
        if c_accel_max < accel:
            accel = c_accel_max
        mpy_iqx_456 = accel * c_mm
        quantise_457 = quantise(mpy_iqx_456, 16, 0)
        mpy_iqx_458 = quantise_457 * c_unit
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
        sub_475 = in_16 - in_15
        abs_476 = abs(sub_475)
        gt_477 = abs_476 > c_zero
        where_478 = c_zero if gt_477 else where_474
        gt_479 = in_15 > c_memory_last_run
        where_480 = where_478 if gt_479 else c_zero
        gt_481 = state_learned_learned > c_zero
        where_482 = c_zero if gt_481 else where_480
        gt_483 = maximum_471 > c_zero
        where_484 = c_zero if gt_483 else where_482
        add_485 = state_learned_before_runs + c_one
        minimum_486 = c_runs_max if c_runs_max < add_485 else add_485
        div_487 = div(c_one, minimum_486, 28)
        maximum_488 = c_gamma_least if c_gamma_least > div_487 else div_487
        clip_489 = c_five__1 if c_five__1 > mpy_iqx_178 else mpy_iqx_178
        if c_five_1 < clip_489:
            clip_489 = c_five_1
        mpy_iqx_490 = clip_489 * clip_489
        sub_491 = mpy_iqx_490 - state_learned_before_variance
        mpy_492 = sub_491 * maximum_488
        add_493 = state_learned_before_variance + mpy_492
        clip_494 = c_variance_min if c_variance_min > add_493 else add_493
        if c_variance_max < clip_494:
            clip_494 = c_variance_max
        clip_495 = c_minus_error_max if c_minus_error_max > mpy_iqx_178 else mpy_iqx_178
        if c_error_max < clip_495:
            clip_495 = c_error_max
        mpy_496 = clip_495 * c_gamma
        clip_497 = c_step__1 if c_step__1 > mpy_496 else mpy_496
        if c_step_1 < clip_497:
            clip_497 = c_step_1
        add_498 = state_learned_before_offset + clip_497
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
        sub_510 = c_one - maximum_471
        where_511 = sub_510 if gt_509 else c_zero
        clip_512 = c_told_min if c_told_min > state_learned_before_offset else state_learned_before_offset
        if c_told_max < clip_512:
            clip_512 = c_told_max
        memory_offset = clip_512 * c_mm
        convert_514 = quantise_457
        mpy_iqx_515 = where_461 * c_start_units
        clip_516 = c_told_min if c_told_min > margin_m else margin_m
        if c_told_max < clip_516:
            clip_516 = c_told_max
        margin = clip_516 * c_mm
        clip_518 = c_told_min if c_told_min > f else f
        if c_told_max < clip_518:
            clip_518 = c_told_max
        stop_distance = clip_518 * c_mm
        speed_estimate = v_hat * c_mm
        memory_variance = state_learned_before_variance * c_variance_units
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
