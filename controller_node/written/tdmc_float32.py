"""Law tdmc in single precision. Written by ``make tables`` from the recorded program; do not edit."""

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
        at_10 = t_v_of_t[index_4 + 5]
        at_11 = t_v_of_t[index_4 + 6]
        at_12 = t_v_of_t[index_4 + 7]
        at_13 = t_v_of_t[index_4 + 8]
        at_14 = t_v_of_t[index_4 + 9]
        at_15 = t_v_of_t[index_4 + 10]
        at_16 = t_v_of_t[index_4 + 11]
        at_17 = t_v_of_t[index_4 + 12]
        at_18 = t_v_of_t[index_4 + 13]
        at_19 = t_v_of_t[index_4 + 14]
        at_20 = t_v_of_t[index_4 + 15]
        return (
            (),
            (
                speed,
                set_point,
                at_6,
                at_7,
                at_8,
                at_9,
                at_10,
                at_11,
                at_12,
                at_13,
                at_14,
                at_15,
                at_16,
                at_17,
                at_18,
                at_19,
                at_20,
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
        c_step_response_0,
        c_step_response_1,
        c_step_response_2,
        c_step_response_3,
        c_step_response_4,
        c_step_response_5,
        c_step_response_6,
        c_step_response_7,
        c_step_response_8,
        c_step_response_9,
        c_step_response_10,
        c_step_response_11,
        c_step_response_12,
        c_step_response_13,
        c_step_response_14,
        c_step_response_15,
        c_step_response_16,
        c_step_response_17,
        c_step_response_18,
        c_step_response_19,
        c_step_response_20,
        c_step_response_21,
        c_step_response_22,
        c_step_response_23,
        c_step_response_24,
        c_step_response_25,
        c_step_response_26,
        c_step_response_27,
        c_step_response_28,
        c_step_response_29,
        c_step_response_30,
        c_step_response_31,
        c_step_response_32,
        c_step_response_33,
        c_step_response_34,
        c_step_response_35,
        c_step_response_36,
        c_step_response_37,
        c_step_response_38,
        c_step_response_39,
        c_step_response_40,
        c_step_response_41,
        c_step_response_42,
        c_step_response_43,
        c_step_response_44,
        c_step_response_45,
        c_step_response_46,
        c_step_response_47,
        c_step_response_48,
        c_step_response_49,
        c_step_response_50,
        c_step_response_51,
        c_step_response_52,
        c_step_response_53,
        c_step_response_54,
        c_step_response_55,
        c_step_response_56,
        c_step_response_57,
        c_step_response_58,
        c_step_response_59,
        c_step_response_60,
        c_step_response_61,
        c_step_response_62,
        c_step_response_63,
        c_step_response_64,
        c_step_response_65,
        c_step_response_66,
        c_step_response_67,
        c_step_response_68,
        c_step_response_69,
        c_step_response_70,
        c_step_response_71,
        c_step_response_72,
        c_step_response_73,
        c_step_response_74,
        c_step_response_75,
        c_step_response_76,
        c_step_response_77,
        c_step_response_78,
        c_step_response_79,
        c_step_response_80,
        c_step_response_81,
        c_step_response_82,
        c_step_response_83,
        c_step_response_84,
        c_step_response_85,
        c_step_response_86,
        c_step_response_87,
        c_step_response_88,
        c_step_response_89,
        c_step_response_90,
        c_step_response_91,
        c_step_response_92,
        c_step_response_93,
        c_step_response_94,
        c_step_response_95,
        c_step_response_96,
        c_step_response_97,
        c_step_response_98,
        c_step_response_99,
        c_step_response_100,
        c_step_response_101,
        c_step_response_102,
        c_step_response_103,
        c_step_response_104,
        c_step_response_105,
        c_step_response_106,
        c_step_response_107,
        c_step_response_108,
        c_step_response_109,
        c_step_response_110,
        c_step_response_111,
        c_step_response_112,
        c_step_response_113,
        c_step_response_114,
        c_step_response_115,
        c_step_response_116,
        c_step_response_117,
        c_step_response_118,
        c_step_response_119,
        c_correction_level,
        c_correction_ramp,
        c_gains_0,
        c_gains_1,
        c_gains_2,
        c_gains_3,
        c_gains_4,
        c_gains_5,
        c_gains_6,
        c_gains_7,
        c_gains_8,
        c_gains_9,
        c_gains_10,
        c_gains_11,
        c_gains_12,
        c_gains_13,
        c_gains_14,
        c_notch_max,
        c_minus_notch_max,
    ) = parts.constants
    quantise = parts.number.quantise

    def period(state: Values, given: Values) -> tuple[Values, Values, Values] | None:
        (
            state_predictions_0,
            state_predictions_1,
            state_predictions_2,
            state_predictions_3,
            state_predictions_4,
            state_predictions_5,
            state_predictions_6,
            state_predictions_7,
            state_predictions_8,
            state_predictions_9,
            state_predictions_10,
            state_predictions_11,
            state_predictions_12,
            state_predictions_13,
            state_predictions_14,
            state_predictions_15,
            state_predictions_16,
            state_predictions_17,
            state_predictions_18,
            state_predictions_19,
            state_predictions_20,
            state_predictions_21,
            state_predictions_22,
            state_predictions_23,
            state_predictions_24,
            state_predictions_25,
            state_predictions_26,
            state_predictions_27,
            state_predictions_28,
            state_predictions_29,
            state_predictions_30,
            state_predictions_31,
            state_predictions_32,
            state_predictions_33,
            state_predictions_34,
            state_predictions_35,
            state_predictions_36,
            state_predictions_37,
            state_predictions_38,
            state_predictions_39,
            state_predictions_40,
            state_predictions_41,
            state_predictions_42,
            state_predictions_43,
            state_predictions_44,
            state_predictions_45,
            state_predictions_46,
            state_predictions_47,
            state_predictions_48,
            state_predictions_49,
            state_predictions_50,
            state_predictions_51,
            state_predictions_52,
            state_predictions_53,
            state_predictions_54,
            state_predictions_55,
            state_predictions_56,
            state_predictions_57,
            state_predictions_58,
            state_predictions_59,
            state_predictions_60,
            state_predictions_61,
            state_predictions_62,
            state_predictions_63,
            state_predictions_64,
            state_predictions_65,
            state_predictions_66,
            state_predictions_67,
            state_predictions_68,
            state_predictions_69,
            state_predictions_70,
            state_predictions_71,
            state_predictions_72,
            state_predictions_73,
            state_predictions_74,
            state_predictions_75,
            state_predictions_76,
            state_predictions_77,
            state_predictions_78,
            state_predictions_79,
            state_predictions_80,
            state_predictions_81,
            state_predictions_82,
            state_predictions_83,
            state_predictions_84,
            state_predictions_85,
            state_predictions_86,
            state_predictions_87,
            state_predictions_88,
            state_predictions_89,
            state_predictions_90,
            state_predictions_91,
            state_predictions_92,
            state_predictions_93,
            state_predictions_94,
            state_predictions_95,
            state_predictions_96,
            state_predictions_97,
            state_predictions_98,
            state_predictions_99,
            state_predictions_100,
            state_predictions_101,
            state_predictions_102,
            state_predictions_103,
            state_predictions_104,
            state_predictions_105,
            state_predictions_106,
            state_predictions_107,
            state_predictions_108,
            state_predictions_109,
            state_predictions_110,
            state_predictions_111,
            state_predictions_112,
            state_predictions_113,
            state_predictions_114,
            state_predictions_115,
            state_predictions_116,
            state_predictions_117,
            state_predictions_118,
            state_predictions_119,
            state_level,
            state_slope,
            state_notch,
            state_notch_before,
        ) = state
        (
            in_speed,
            _in_set_point,
            in_preview_0,
            in_preview_1,
            in_preview_2,
            in_preview_3,
            in_preview_4,
            in_preview_5,
            in_preview_6,
            in_preview_7,
            in_preview_8,
            in_preview_9,
            in_preview_10,
            in_preview_11,
            in_preview_12,
            in_preview_13,
            in_preview_14,
        ) = given
        single[0] = state_notch - state_notch_before
        move = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_0 * move
        rmpy_142 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_0 + rmpy_142
        add_143 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_1 * move
        rmpy_144 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_1 + rmpy_144
        add_145 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_2 * move
        rmpy_146 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_2 + rmpy_146
        add_147 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_3 * move
        rmpy_148 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_3 + rmpy_148
        add_149 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_4 * move
        rmpy_150 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_4 + rmpy_150
        add_151 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_5 * move
        rmpy_152 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_5 + rmpy_152
        add_153 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_6 * move
        rmpy_154 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_6 + rmpy_154
        add_155 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_7 * move
        rmpy_156 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_7 + rmpy_156
        add_157 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_8 * move
        rmpy_158 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_8 + rmpy_158
        add_159 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_9 * move
        rmpy_160 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_9 + rmpy_160
        add_161 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_10 * move
        rmpy_162 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_10 + rmpy_162
        add_163 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_11 * move
        rmpy_164 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_11 + rmpy_164
        add_165 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_12 * move
        rmpy_166 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_12 + rmpy_166
        add_167 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_13 * move
        rmpy_168 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_13 + rmpy_168
        add_169 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_14 * move
        rmpy_170 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_14 + rmpy_170
        add_171 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_15 * move
        rmpy_172 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_15 + rmpy_172
        add_173 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_16 * move
        rmpy_174 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_16 + rmpy_174
        add_175 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_17 * move
        rmpy_176 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_17 + rmpy_176
        add_177 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_18 * move
        rmpy_178 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_18 + rmpy_178
        add_179 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_19 * move
        rmpy_180 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_19 + rmpy_180
        add_181 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_20 * move
        rmpy_182 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_20 + rmpy_182
        add_183 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_21 * move
        rmpy_184 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_21 + rmpy_184
        add_185 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_22 * move
        rmpy_186 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_22 + rmpy_186
        add_187 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_23 * move
        rmpy_188 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_23 + rmpy_188
        add_189 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_24 * move
        rmpy_190 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_24 + rmpy_190
        add_191 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_25 * move
        rmpy_192 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_25 + rmpy_192
        add_193 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_26 * move
        rmpy_194 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_26 + rmpy_194
        add_195 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_27 * move
        rmpy_196 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_27 + rmpy_196
        add_197 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_28 * move
        rmpy_198 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_28 + rmpy_198
        add_199 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_29 * move
        rmpy_200 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_29 + rmpy_200
        add_201 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_30 * move
        rmpy_202 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_30 + rmpy_202
        add_203 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_31 * move
        rmpy_204 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_31 + rmpy_204
        add_205 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_32 * move
        rmpy_206 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_32 + rmpy_206
        add_207 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_33 * move
        rmpy_208 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_33 + rmpy_208
        add_209 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_34 * move
        rmpy_210 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_34 + rmpy_210
        add_211 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_35 * move
        rmpy_212 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_35 + rmpy_212
        add_213 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_36 * move
        rmpy_214 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_36 + rmpy_214
        add_215 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_37 * move
        rmpy_216 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_37 + rmpy_216
        add_217 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_38 * move
        rmpy_218 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_38 + rmpy_218
        add_219 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_39 * move
        rmpy_220 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_39 + rmpy_220
        add_221 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_40 * move
        rmpy_222 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_40 + rmpy_222
        add_223 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_41 * move
        rmpy_224 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_41 + rmpy_224
        add_225 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_42 * move
        rmpy_226 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_42 + rmpy_226
        add_227 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_43 * move
        rmpy_228 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_43 + rmpy_228
        add_229 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_44 * move
        rmpy_230 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_44 + rmpy_230
        add_231 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_45 * move
        rmpy_232 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_45 + rmpy_232
        add_233 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_46 * move
        rmpy_234 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_46 + rmpy_234
        add_235 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_47 * move
        rmpy_236 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_47 + rmpy_236
        add_237 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_48 * move
        rmpy_238 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_48 + rmpy_238
        add_239 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_49 * move
        rmpy_240 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_49 + rmpy_240
        add_241 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_50 * move
        rmpy_242 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_50 + rmpy_242
        add_243 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_51 * move
        rmpy_244 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_51 + rmpy_244
        add_245 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_52 * move
        rmpy_246 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_52 + rmpy_246
        add_247 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_53 * move
        rmpy_248 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_53 + rmpy_248
        add_249 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_54 * move
        rmpy_250 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_54 + rmpy_250
        add_251 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_55 * move
        rmpy_252 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_55 + rmpy_252
        add_253 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_56 * move
        rmpy_254 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_56 + rmpy_254
        add_255 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_57 * move
        rmpy_256 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_57 + rmpy_256
        add_257 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_58 * move
        rmpy_258 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_58 + rmpy_258
        add_259 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_59 * move
        rmpy_260 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_59 + rmpy_260
        add_261 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_60 * move
        rmpy_262 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_60 + rmpy_262
        add_263 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_61 * move
        rmpy_264 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_61 + rmpy_264
        add_265 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_62 * move
        rmpy_266 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_62 + rmpy_266
        add_267 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_63 * move
        rmpy_268 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_63 + rmpy_268
        add_269 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_64 * move
        rmpy_270 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_64 + rmpy_270
        add_271 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_65 * move
        rmpy_272 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_65 + rmpy_272
        add_273 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_66 * move
        rmpy_274 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_66 + rmpy_274
        add_275 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_67 * move
        rmpy_276 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_67 + rmpy_276
        add_277 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_68 * move
        rmpy_278 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_68 + rmpy_278
        add_279 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_69 * move
        rmpy_280 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_69 + rmpy_280
        add_281 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_70 * move
        rmpy_282 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_70 + rmpy_282
        add_283 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_71 * move
        rmpy_284 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_71 + rmpy_284
        add_285 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_72 * move
        rmpy_286 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_72 + rmpy_286
        add_287 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_73 * move
        rmpy_288 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_73 + rmpy_288
        add_289 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_74 * move
        rmpy_290 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_74 + rmpy_290
        add_291 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_75 * move
        rmpy_292 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_75 + rmpy_292
        add_293 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_76 * move
        rmpy_294 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_76 + rmpy_294
        add_295 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_77 * move
        rmpy_296 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_77 + rmpy_296
        add_297 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_78 * move
        rmpy_298 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_78 + rmpy_298
        add_299 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_79 * move
        rmpy_300 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_79 + rmpy_300
        add_301 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_80 * move
        rmpy_302 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_80 + rmpy_302
        add_303 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_81 * move
        rmpy_304 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_81 + rmpy_304
        add_305 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_82 * move
        rmpy_306 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_82 + rmpy_306
        add_307 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_83 * move
        rmpy_308 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_83 + rmpy_308
        add_309 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_84 * move
        rmpy_310 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_84 + rmpy_310
        add_311 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_85 * move
        rmpy_312 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_85 + rmpy_312
        add_313 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_86 * move
        rmpy_314 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_86 + rmpy_314
        add_315 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_87 * move
        rmpy_316 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_87 + rmpy_316
        add_317 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_88 * move
        rmpy_318 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_88 + rmpy_318
        add_319 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_89 * move
        rmpy_320 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_89 + rmpy_320
        add_321 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_90 * move
        rmpy_322 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_90 + rmpy_322
        add_323 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_91 * move
        rmpy_324 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_91 + rmpy_324
        add_325 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_92 * move
        rmpy_326 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_92 + rmpy_326
        add_327 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_93 * move
        rmpy_328 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_93 + rmpy_328
        add_329 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_94 * move
        rmpy_330 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_94 + rmpy_330
        add_331 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_95 * move
        rmpy_332 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_95 + rmpy_332
        add_333 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_96 * move
        rmpy_334 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_96 + rmpy_334
        add_335 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_97 * move
        rmpy_336 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_97 + rmpy_336
        add_337 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_98 * move
        rmpy_338 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_98 + rmpy_338
        add_339 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_99 * move
        rmpy_340 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_99 + rmpy_340
        add_341 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_100 * move
        rmpy_342 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_100 + rmpy_342
        add_343 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_101 * move
        rmpy_344 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_101 + rmpy_344
        add_345 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_102 * move
        rmpy_346 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_102 + rmpy_346
        add_347 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_103 * move
        rmpy_348 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_103 + rmpy_348
        add_349 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_104 * move
        rmpy_350 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_104 + rmpy_350
        add_351 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_105 * move
        rmpy_352 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_105 + rmpy_352
        add_353 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_106 * move
        rmpy_354 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_106 + rmpy_354
        add_355 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_107 * move
        rmpy_356 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_107 + rmpy_356
        add_357 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_108 * move
        rmpy_358 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_108 + rmpy_358
        add_359 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_109 * move
        rmpy_360 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_109 + rmpy_360
        add_361 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_110 * move
        rmpy_362 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_110 + rmpy_362
        add_363 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_111 * move
        rmpy_364 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_111 + rmpy_364
        add_365 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_112 * move
        rmpy_366 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_112 + rmpy_366
        add_367 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_113 * move
        rmpy_368 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_113 + rmpy_368
        add_369 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_114 * move
        rmpy_370 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_114 + rmpy_370
        add_371 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_115 * move
        rmpy_372 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_115 + rmpy_372
        add_373 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_116 * move
        rmpy_374 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_116 + rmpy_374
        add_375 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_117 * move
        rmpy_376 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_117 + rmpy_376
        add_377 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_118 * move
        rmpy_378 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_118 + rmpy_378
        add_379 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_step_response_119 * move
        rmpy_380 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_predictions_119 + rmpy_380
        add_381 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        y_m = add_143
        convert_383 = in_speed
        single[0] = convert_383 - y_m
        model_error = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_level + state_slope
        add_385 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = model_error - add_385
        missed = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_correction_level * missed
        rmpy_387 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_385 + rmpy_387
        level = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_correction_ramp * missed
        rmpy_389 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = state_slope + rmpy_389
        slope = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = level + slope
        add_391 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_392 = add_145
        single[0] = convert_392 + add_391
        add_393 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_394 = in_preview_0
        single[0] = convert_394 - add_393
        deviation_0 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_391 + slope
        add_396 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_397 = add_147
        single[0] = convert_397 + add_396
        add_398 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_399 = in_preview_1
        single[0] = convert_399 - add_398
        deviation_1 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_396 + slope
        add_401 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_402 = add_149
        single[0] = convert_402 + add_401
        add_403 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_404 = in_preview_2
        single[0] = convert_404 - add_403
        deviation_2 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_401 + slope
        add_406 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_407 = add_151
        single[0] = convert_407 + add_406
        add_408 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_409 = in_preview_3
        single[0] = convert_409 - add_408
        deviation_3 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_406 + slope
        add_411 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_412 = add_153
        single[0] = convert_412 + add_411
        add_413 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_414 = in_preview_4
        single[0] = convert_414 - add_413
        deviation_4 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_411 + slope
        add_416 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_417 = add_155
        single[0] = convert_417 + add_416
        add_418 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_419 = in_preview_5
        single[0] = convert_419 - add_418
        deviation_5 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_416 + slope
        add_421 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_422 = add_157
        single[0] = convert_422 + add_421
        add_423 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_424 = in_preview_6
        single[0] = convert_424 - add_423
        deviation_6 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_421 + slope
        add_426 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_427 = add_159
        single[0] = convert_427 + add_426
        add_428 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_429 = in_preview_7
        single[0] = convert_429 - add_428
        deviation_7 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_426 + slope
        add_431 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_432 = add_161
        single[0] = convert_432 + add_431
        add_433 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_434 = in_preview_8
        single[0] = convert_434 - add_433
        deviation_8 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_431 + slope
        add_436 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_437 = add_163
        single[0] = convert_437 + add_436
        add_438 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_439 = in_preview_9
        single[0] = convert_439 - add_438
        deviation_9 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_436 + slope
        add_441 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_442 = add_165
        single[0] = convert_442 + add_441
        add_443 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_444 = in_preview_10
        single[0] = convert_444 - add_443
        deviation_10 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_441 + slope
        add_446 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_447 = add_167
        single[0] = convert_447 + add_446
        add_448 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_449 = in_preview_11
        single[0] = convert_449 - add_448
        deviation_11 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_446 + slope
        add_451 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_452 = add_169
        single[0] = convert_452 + add_451
        add_453 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_454 = in_preview_12
        single[0] = convert_454 - add_453
        deviation_12 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_451 + slope
        add_456 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_457 = add_171
        single[0] = convert_457 + add_456
        add_458 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_459 = in_preview_13
        single[0] = convert_459 - add_458
        deviation_13 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = add_456 + slope
        add_461 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_462 = add_173
        single[0] = convert_462 + add_461
        add_463 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_464 = in_preview_14
        single[0] = convert_464 - add_463
        deviation_14 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_0 * deviation_0
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_1 * deviation_1
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_2 * deviation_2
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_3 * deviation_3
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_4 * deviation_4
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_5 * deviation_5
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_6 * deviation_6
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_7 * deviation_7
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_8 * deviation_8
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_9 * deviation_9
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_10 * deviation_10
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_11 * deviation_11
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_12 * deviation_12
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_13 * deviation_13
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = c_gains_14 * deviation_14
        product = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = change + product
        change = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        convert_467 = state_notch
        single[0] = convert_467 + change
        notch_raw = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_469 = c_minus_notch_max if c_minus_notch_max > notch_raw else notch_raw
        if c_notch_max < clip_469:
            clip_469 = c_notch_max
        notch = quantise(clip_469, 19, 8)
        return (
            (
                add_145,
                add_147,
                add_149,
                add_151,
                add_153,
                add_155,
                add_157,
                add_159,
                add_161,
                add_163,
                add_165,
                add_167,
                add_169,
                add_171,
                add_173,
                add_175,
                add_177,
                add_179,
                add_181,
                add_183,
                add_185,
                add_187,
                add_189,
                add_191,
                add_193,
                add_195,
                add_197,
                add_199,
                add_201,
                add_203,
                add_205,
                add_207,
                add_209,
                add_211,
                add_213,
                add_215,
                add_217,
                add_219,
                add_221,
                add_223,
                add_225,
                add_227,
                add_229,
                add_231,
                add_233,
                add_235,
                add_237,
                add_239,
                add_241,
                add_243,
                add_245,
                add_247,
                add_249,
                add_251,
                add_253,
                add_255,
                add_257,
                add_259,
                add_261,
                add_263,
                add_265,
                add_267,
                add_269,
                add_271,
                add_273,
                add_275,
                add_277,
                add_279,
                add_281,
                add_283,
                add_285,
                add_287,
                add_289,
                add_291,
                add_293,
                add_295,
                add_297,
                add_299,
                add_301,
                add_303,
                add_305,
                add_307,
                add_309,
                add_311,
                add_313,
                add_315,
                add_317,
                add_319,
                add_321,
                add_323,
                add_325,
                add_327,
                add_329,
                add_331,
                add_333,
                add_335,
                add_337,
                add_339,
                add_341,
                add_343,
                add_345,
                add_347,
                add_349,
                add_351,
                add_353,
                add_355,
                add_357,
                add_359,
                add_361,
                add_363,
                add_365,
                add_367,
                add_369,
                add_371,
                add_373,
                add_375,
                add_377,
                add_379,
                add_381,
                add_381,
                level,
                slope,
                notch,
                state_notch,
            ),
            (
                notch_raw,
                notch,
            ),
            (
                move,
                y_m,
                model_error,
                missed,
                level,
                slope,
                deviation_0,
                deviation_1,
                deviation_2,
                deviation_3,
                deviation_4,
                deviation_5,
                deviation_6,
                deviation_7,
                deviation_8,
                deviation_9,
                deviation_10,
                deviation_11,
                deviation_12,
                deviation_13,
                deviation_14,
                change,
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
        at_10 = t_v_of_t[index_4 + 5]
        at_11 = t_v_of_t[index_4 + 6]
        at_12 = t_v_of_t[index_4 + 7]
        at_13 = t_v_of_t[index_4 + 8]
        at_14 = t_v_of_t[index_4 + 9]
        at_15 = t_v_of_t[index_4 + 10]
        at_16 = t_v_of_t[index_4 + 11]
        at_17 = t_v_of_t[index_4 + 12]
        at_18 = t_v_of_t[index_4 + 13]
        at_19 = t_v_of_t[index_4 + 14]
        at_20 = t_v_of_t[index_4 + 15]
        locate_21 = min(max(bisect_right(t_x_of_t, position_01mm) - 1, 0), len(t_x_of_t) - 2)
        at_22 = t_x_of_t[locate_21]
        at_23 = t_x_of_t[locate_21 + 1]
        single[0] = at_23 - at_22
        sub_24 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        maximum_25 = c_one_01mm if c_one_01mm > sub_24 else sub_24
        single[0] = position_01mm - at_22
        sub_26 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        clip_27 = c_zero if c_zero > sub_26 else sub_26
        if maximum_25 < clip_27:
            clip_27 = maximum_25
        div_28 = div(clip_27, maximum_25, 20)
        minimum_29 = c_one if c_one < div_28 else div_28
        at_30 = t_v_of_x[locate_21]
        at_31 = t_v_of_x[locate_21 + 1]
        single[0] = at_31 - at_30
        sub_32 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_32 * minimum_29
        rmpy_33 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_30 + rmpy_33
        add_34 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_35 = t_v_of_x[locate_21 + 16]
        at_36 = t_v_of_x[locate_21 + 17]
        single[0] = at_36 - at_35
        sub_37 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_37 * minimum_29
        rmpy_38 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_35 + rmpy_38
        add_39 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_40 = t_v_of_x[locate_21 + 32]
        at_41 = t_v_of_x[locate_21 + 33]
        single[0] = at_41 - at_40
        sub_42 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_42 * minimum_29
        rmpy_43 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_40 + rmpy_43
        add_44 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_45 = t_v_of_x[locate_21 + 48]
        at_46 = t_v_of_x[locate_21 + 49]
        single[0] = at_46 - at_45
        sub_47 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_47 * minimum_29
        rmpy_48 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_45 + rmpy_48
        add_49 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_50 = t_v_of_x[locate_21 + 64]
        at_51 = t_v_of_x[locate_21 + 65]
        single[0] = at_51 - at_50
        sub_52 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_52 * minimum_29
        rmpy_53 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_50 + rmpy_53
        add_54 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_55 = t_v_of_x[locate_21 + 80]
        at_56 = t_v_of_x[locate_21 + 81]
        single[0] = at_56 - at_55
        sub_57 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_57 * minimum_29
        rmpy_58 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_55 + rmpy_58
        add_59 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_60 = t_v_of_x[locate_21 + 96]
        at_61 = t_v_of_x[locate_21 + 97]
        single[0] = at_61 - at_60
        sub_62 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_62 * minimum_29
        rmpy_63 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_60 + rmpy_63
        add_64 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_65 = t_v_of_x[locate_21 + 112]
        at_66 = t_v_of_x[locate_21 + 113]
        single[0] = at_66 - at_65
        sub_67 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_67 * minimum_29
        rmpy_68 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_65 + rmpy_68
        add_69 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_70 = t_v_of_x[locate_21 + 128]
        at_71 = t_v_of_x[locate_21 + 129]
        single[0] = at_71 - at_70
        sub_72 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_72 * minimum_29
        rmpy_73 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_70 + rmpy_73
        add_74 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_75 = t_v_of_x[locate_21 + 144]
        at_76 = t_v_of_x[locate_21 + 145]
        single[0] = at_76 - at_75
        sub_77 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_77 * minimum_29
        rmpy_78 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_75 + rmpy_78
        add_79 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_80 = t_v_of_x[locate_21 + 160]
        at_81 = t_v_of_x[locate_21 + 161]
        single[0] = at_81 - at_80
        sub_82 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_82 * minimum_29
        rmpy_83 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_80 + rmpy_83
        add_84 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_85 = t_v_of_x[locate_21 + 176]
        at_86 = t_v_of_x[locate_21 + 177]
        single[0] = at_86 - at_85
        sub_87 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_87 * minimum_29
        rmpy_88 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_85 + rmpy_88
        add_89 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_90 = t_v_of_x[locate_21 + 192]
        at_91 = t_v_of_x[locate_21 + 193]
        single[0] = at_91 - at_90
        sub_92 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_92 * minimum_29
        rmpy_93 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_90 + rmpy_93
        add_94 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_95 = t_v_of_x[locate_21 + 208]
        at_96 = t_v_of_x[locate_21 + 209]
        single[0] = at_96 - at_95
        sub_97 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_97 * minimum_29
        rmpy_98 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_95 + rmpy_98
        add_99 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_100 = t_v_of_x[locate_21 + 224]
        at_101 = t_v_of_x[locate_21 + 225]
        single[0] = at_101 - at_100
        sub_102 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_102 * minimum_29
        rmpy_103 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_100 + rmpy_103
        add_104 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        at_105 = t_v_of_x[locate_21 + 240]
        at_106 = t_v_of_x[locate_21 + 241]
        single[0] = at_106 - at_105
        sub_107 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = sub_107 * minimum_29
        rmpy_108 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        single[0] = at_105 + rmpy_108
        add_109 = value = single[0] + 0.0
        if not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value:
            return None
        gt_110 = position_01mm > c_from
        set_point = add_34 if gt_110 else at_5
        where_112 = add_39 if gt_110 else at_6
        where_113 = add_44 if gt_110 else at_7
        where_114 = add_49 if gt_110 else at_8
        where_115 = add_54 if gt_110 else at_9
        where_116 = add_59 if gt_110 else at_10
        where_117 = add_64 if gt_110 else at_11
        where_118 = add_69 if gt_110 else at_12
        where_119 = add_74 if gt_110 else at_13
        where_120 = add_79 if gt_110 else at_14
        where_121 = add_84 if gt_110 else at_15
        where_122 = add_89 if gt_110 else at_16
        where_123 = add_94 if gt_110 else at_17
        where_124 = add_99 if gt_110 else at_18
        where_125 = add_104 if gt_110 else at_19
        where_126 = add_109 if gt_110 else at_20
        return (
            (),
            (
                speed,
                set_point,
                where_112,
                where_113,
                where_114,
                where_115,
                where_116,
                where_117,
                where_118,
                where_119,
                where_120,
                where_121,
                where_122,
                where_123,
                where_124,
                where_125,
                where_126,
            ),
            (
                speed,
                set_point,
            ),
        )

    return period
