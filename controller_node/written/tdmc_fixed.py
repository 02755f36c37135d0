"""Law tdmc in fixed point. Written by ``make tables`` from the recorded program; do not edit."""

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
        c_trend_max,
        c_minus_trend_max,
        c_deviation_max,
        c_minus_deviation_max,
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
    (
        low_predictions_0,
        high_predictions_0,
        low_predictions_1,
        high_predictions_1,
        low_predictions_2,
        high_predictions_2,
        low_predictions_3,
        high_predictions_3,
        low_predictions_4,
        high_predictions_4,
        low_predictions_5,
        high_predictions_5,
        low_predictions_6,
        high_predictions_6,
        low_predictions_7,
        high_predictions_7,
        low_predictions_8,
        high_predictions_8,
        low_predictions_9,
        high_predictions_9,
        low_predictions_10,
        high_predictions_10,
        low_predictions_11,
        high_predictions_11,
        low_predictions_12,
        high_predictions_12,
        low_predictions_13,
        high_predictions_13,
        low_predictions_14,
        high_predictions_14,
        low_predictions_15,
        high_predictions_15,
        low_predictions_16,
        high_predictions_16,
        low_predictions_17,
        high_predictions_17,
        low_predictions_18,
        high_predictions_18,
        low_predictions_19,
        high_predictions_19,
        low_predictions_20,
        high_predictions_20,
        low_predictions_21,
        high_predictions_21,
        low_predictions_22,
        high_predictions_22,
        low_predictions_23,
        high_predictions_23,
        low_predictions_24,
        high_predictions_24,
        low_predictions_25,
        high_predictions_25,
        low_predictions_26,
        high_predictions_26,
        low_predictions_27,
        high_predictions_27,
        low_predictions_28,
        high_predictions_28,
        low_predictions_29,
        high_predictions_29,
        low_predictions_30,
        high_predictions_30,
        low_predictions_31,
        high_predictions_31,
        low_predictions_32,
        high_predictions_32,
        low_predictions_33,
        high_predictions_33,
        low_predictions_34,
        high_predictions_34,
        low_predictions_35,
        high_predictions_35,
        low_predictions_36,
        high_predictions_36,
        low_predictions_37,
        high_predictions_37,
        low_predictions_38,
        high_predictions_38,
        low_predictions_39,
        high_predictions_39,
        low_predictions_40,
        high_predictions_40,
        low_predictions_41,
        high_predictions_41,
        low_predictions_42,
        high_predictions_42,
        low_predictions_43,
        high_predictions_43,
        low_predictions_44,
        high_predictions_44,
        low_predictions_45,
        high_predictions_45,
        low_predictions_46,
        high_predictions_46,
        low_predictions_47,
        high_predictions_47,
        low_predictions_48,
        high_predictions_48,
        low_predictions_49,
        high_predictions_49,
        low_predictions_50,
        high_predictions_50,
        low_predictions_51,
        high_predictions_51,
        low_predictions_52,
        high_predictions_52,
        low_predictions_53,
        high_predictions_53,
        low_predictions_54,
        high_predictions_54,
        low_predictions_55,
        high_predictions_55,
        low_predictions_56,
        high_predictions_56,
        low_predictions_57,
        high_predictions_57,
        low_predictions_58,
        high_predictions_58,
        low_predictions_59,
        high_predictions_59,
        low_predictions_60,
        high_predictions_60,
        low_predictions_61,
        high_predictions_61,
        low_predictions_62,
        high_predictions_62,
        low_predictions_63,
        high_predictions_63,
        low_predictions_64,
        high_predictions_64,
        low_predictions_65,
        high_predictions_65,
        low_predictions_66,
        high_predictions_66,
        low_predictions_67,
        high_predictions_67,
        low_predictions_68,
        high_predictions_68,
        low_predictions_69,
        high_predictions_69,
        low_predictions_70,
        high_predictions_70,
        low_predictions_71,
        high_predictions_71,
        low_predictions_72,
        high_predictions_72,
        low_predictions_73,
        high_predictions_73,
        low_predictions_74,
        high_predictions_74,
        low_predictions_75,
        high_predictions_75,
        low_predictions_76,
        high_predictions_76,
        low_predictions_77,
        high_predictions_77,
        low_predictions_78,
        high_predictions_78,
        low_predictions_79,
        high_predictions_79,
        low_predictions_80,
        high_predictions_80,
        low_predictions_81,
        high_predictions_81,
        low_predictions_82,
        high_predictions_82,
        low_predictions_83,
        high_predictions_83,
        low_predictions_84,
        high_predictions_84,
        low_predictions_85,
        high_predictions_85,
        low_predictions_86,
        high_predictions_86,
        low_predictions_87,
        high_predictions_87,
        low_predictions_88,
        high_predictions_88,
        low_predictions_89,
        high_predictions_89,
        low_predictions_90,
        high_predictions_90,
        low_predictions_91,
        high_predictions_91,
        low_predictions_92,
        high_predictions_92,
        low_predictions_93,
        high_predictions_93,
        low_predictions_94,
        high_predictions_94,
        low_predictions_95,
        high_predictions_95,
        low_predictions_96,
        high_predictions_96,
        low_predictions_97,
        high_predictions_97,
        low_predictions_98,
        high_predictions_98,
        low_predictions_99,
        high_predictions_99,
        low_predictions_100,
        high_predictions_100,
        low_predictions_101,
        high_predictions_101,
        low_predictions_102,
        high_predictions_102,
        low_predictions_103,
        high_predictions_103,
        low_predictions_104,
        high_predictions_104,
        low_predictions_105,
        high_predictions_105,
        low_predictions_106,
        high_predictions_106,
        low_predictions_107,
        high_predictions_107,
        low_predictions_108,
        high_predictions_108,
        low_predictions_109,
        high_predictions_109,
        low_predictions_110,
        high_predictions_110,
        low_predictions_111,
        high_predictions_111,
        low_predictions_112,
        high_predictions_112,
        low_predictions_113,
        high_predictions_113,
        low_predictions_114,
        high_predictions_114,
        low_predictions_115,
        high_predictions_115,
        low_predictions_116,
        high_predictions_116,
        low_predictions_117,
        high_predictions_117,
        low_predictions_118,
        high_predictions_118,
        low_predictions_119,
        high_predictions_119,
        low_level,
        high_level,
        low_slope,
        high_slope,
        low_notch,
        high_notch,
        low_notch_before,
        high_notch_before,
    ) = parts.bounds

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
        if not low_predictions_0 <= state_predictions_0 <= high_predictions_0:
            return None
        if not low_predictions_1 <= state_predictions_1 <= high_predictions_1:
            return None
        if not low_predictions_2 <= state_predictions_2 <= high_predictions_2:
            return None
        if not low_predictions_3 <= state_predictions_3 <= high_predictions_3:
            return None
        if not low_predictions_4 <= state_predictions_4 <= high_predictions_4:
            return None
        if not low_predictions_5 <= state_predictions_5 <= high_predictions_5:
            return None
        if not low_predictions_6 <= state_predictions_6 <= high_predictions_6:
            return None
        if not low_predictions_7 <= state_predictions_7 <= high_predictions_7:
            return None
        if not low_predictions_8 <= state_predictions_8 <= high_predictions_8:
            return None
        if not low_predictions_9 <= state_predictions_9 <= high_predictions_9:
            return None
        if not low_predictions_10 <= state_predictions_10 <= high_predictions_10:
            return None
        if not low_predictions_11 <= state_predictions_11 <= high_predictions_11:
            return None
        if not low_predictions_12 <= state_predictions_12 <= high_predictions_12:
            return None
        if not low_predictions_13 <= state_predictions_13 <= high_predictions_13:
            return None
        if not low_predictions_14 <= state_predictions_14 <= high_predictions_14:
            return None
        if not low_predictions_15 <= state_predictions_15 <= high_predictions_15:
            return None
        if not low_predictions_16 <= state_predictions_16 <= high_predictions_16:
            return None
        if not low_predictions_17 <= state_predictions_17 <= high_predictions_17:
            return None
        if not low_predictions_18 <= state_predictions_18 <= high_predictions_18:
            return None
        if not low_predictions_19 <= state_predictions_19 <= high_predictions_19:
            return None
        if not low_predictions_20 <= state_predictions_20 <= high_predictions_20:
            return None
        if not low_predictions_21 <= state_predictions_21 <= high_predictions_21:
            return None
        if not low_predictions_22 <= state_predictions_22 <= high_predictions_22:
            return None
        if not low_predictions_23 <= state_predictions_23 <= high_predictions_23:
            return None
        if not low_predictions_24 <= state_predictions_24 <= high_predictions_24:
            return None
        if not low_predictions_25 <= state_predictions_25 <= high_predictions_25:
            return None
        if not low_predictions_26 <= state_predictions_26 <= high_predictions_26:
            return None
        if not low_predictions_27 <= state_predictions_27 <= high_predictions_27:
            return None
        if not low_predictions_28 <= state_predictions_28 <= high_predictions_28:
            return None
        if not low_predictions_29 <= state_predictions_29 <= high_predictions_29:
            return None
        if not low_predictions_30 <= state_predictions_30 <= high_predictions_30:
            return None
        if not low_predictions_31 <= state_predictions_31 <= high_predictions_31:
            return None
        if not low_predictions_32 <= state_predictions_32 <= high_predictions_32:
            return None
        if not low_predictions_33 <= state_predictions_33 <= high_predictions_33:
            return None
        if not low_predictions_34 <= state_predictions_34 <= high_predictions_34:
            return None
        if not low_predictions_35 <= state_predictions_35 <= high_predictions_35:
            return None
        if not low_predictions_36 <= state_predictions_36 <= high_predictions_36:
            return None
        if not low_predictions_37 <= state_predictions_37 <= high_predictions_37:
            return None
        if not low_predictions_38 <= state_predictions_38 <= high_predictions_38:
            return None
        if not low_predictions_39 <= state_predictions_39 <= high_predictions_39:
            return None
        if not low_predictions_40 <= state_predictions_40 <= high_predictions_40:
            return None
        if not low_predictions_41 <= state_predictions_41 <= high_predictions_41:
            return None
        if not low_predictions_42 <= state_predictions_42 <= high_predictions_42:
            return None
        if not low_predictions_43 <= state_predictions_43 <= high_predictions_43:
            return None
        if not low_predictions_44 <= state_predictions_44 <= high_predictions_44:
            return None
        if not low_predictions_45 <= state_predictions_45 <= high_predictions_45:
            return None
        if not low_predictions_46 <= state_predictions_46 <= high_predictions_46:
            return None
        if not low_predictions_47 <= state_predictions_47 <= high_predictions_47:
            return None
        if not low_predictions_48 <= state_predictions_48 <= high_predictions_48:
            return None
        if not low_predictions_49 <= state_predictions_49 <= high_predictions_49:
            return None
        if not low_predictions_50 <= state_predictions_50 <= high_predictions_50:
            return None
        if not low_predictions_51 <= state_predictions_51 <= high_predictions_51:
            return None
        if not low_predictions_52 <= state_predictions_52 <= high_predictions_52:
            return None
        if not low_predictions_53 <= state_predictions_53 <= high_predictions_53:
            return None
        if not low_predictions_54 <= state_predictions_54 <= high_predictions_54:
            return None
        if not low_predictions_55 <= state_predictions_55 <= high_predictions_55:
            return None
        if not low_predictions_56 <= state_predictions_56 <= high_predictions_56:
            return None
        if not low_predictions_57 <= state_predictions_57 <= high_predictions_57:
            return None
        if not low_predictions_58 <= state_predictions_58 <= high_predictions_58:
            return None
        if not low_predictions_59 <= state_predictions_59 <= high_predictions_59:
            return None
        if not low_predictions_60 <= state_predictions_60 <= high_predictions_60:
            return None
        if not low_predictions_61 <= state_predictions_61 <= high_predictions_61:
            return None
        if not low_predictions_62 <= state_predictions_62 <= high_predictions_62:
            return None
        if not low_predictions_63 <= state_predictions_63 <= high_predictions_63:
            return None
        if not low_predictions_64 <= state_predictions_64 <= high_predictions_64:
            return None
        if not low_predictions_65 <= state_predictions_65 <= high_predictions_65:
            return None
        if not low_predictions_66 <= state_predictions_66 <= high_predictions_66:
            return None
        if not low_predictions_67 <= state_predictions_67 <= high_predictions_67:
            return None
        if not low_predictions_68 <= state_predictions_68 <= high_predictions_68:
            return None
        if not low_predictions_69 <= state_predictions_69 <= high_predictions_69:
            return None
        if not low_predictions_70 <= state_predictions_70 <= high_predictions_70:
            return None
        if not low_predictions_71 <= state_predictions_71 <= high_predictions_71:
            return None
        if not low_predictions_72 <= state_predictions_72 <= high_predictions_72:
            return None
        if not low_predictions_73 <= state_predictions_73 <= high_predictions_73:
            return None
        if not low_predictions_74 <= state_predictions_74 <= high_predictions_74:
            return None
        if not low_predictions_75 <= state_predictions_75 <= high_predictions_75:
            return None
        if not low_predictions_76 <= state_predictions_76 <= high_predictions_76:
            return None
        if not low_predictions_77 <= state_predictions_77 <= high_predictions_77:
            return None
        if not low_predictions_78 <= state_predictions_78 <= high_predictions_78:
            return None
        if not low_predictions_79 <= state_predictions_79 <= high_predictions_79:
            return None
        if not low_predictions_80 <= state_predictions_80 <= high_predictions_80:
            return None
        if not low_predictions_81 <= state_predictions_81 <= high_predictions_81:
            return None
        if not low_predictions_82 <= state_predictions_82 <= high_predictions_82:
            return None
        if not low_predictions_83 <= state_predictions_83 <= high_predictions_83:
            return None
        if not low_predictions_84 <= state_predictions_84 <= high_predictions_84:
            return None
        if not low_predictions_85 <= state_predictions_85 <= high_predictions_85:
            return None
        if not low_predictions_86 <= state_predictions_86 <= high_predictions_86:
            return None
        if not low_predictions_87 <= state_predictions_87 <= high_predictions_87:
            return None
        if not low_predictions_88 <= state_predictions_88 <= high_predictions_88:
            return None
        if not low_predictions_89 <= state_predictions_89 <= high_predictions_89:
            return None
        if not low_predictions_90 <= state_predictions_90 <= high_predictions_90:
            return None
        if not low_predictions_91 <= state_predictions_91 <= high_predictions_91:
            return None
        if not low_predictions_92 <= state_predictions_92 <= high_predictions_92:
            return None
        if not low_predictions_93 <= state_predictions_93 <= high_predictions_93:
            return None
        if not low_predictions_94 <= state_predictions_94 <= high_predictions_94:
            return None
        if not low_predictions_95 <= state_predictions_95 <= high_predictions_95:
            return None
        if not low_predictions_96 <= state_predictions_96 <= high_predictions_96:
            return None
        if not low_predictions_97 <= state_predictions_97 <= high_predictions_97:
            return None
        if not low_predictions_98 <= state_predictions_98 <= high_predictions_98:
            return None
        if not low_predictions_99 <= state_predictions_99 <= high_predictions_99:
            return None
        if not low_predictions_100 <= state_predictions_100 <= high_predictions_100:
            return None
        if not low_predictions_101 <= state_predictions_101 <= high_predictions_101:
            return None
        if not low_predictions_102 <= state_predictions_102 <= high_predictions_102:
            return None
        if not low_predictions_103 <= state_predictions_103 <= high_predictions_103:
            return None
        if not low_predictions_104 <= state_predictions_104 <= high_predictions_104:
            return None
        if not low_predictions_105 <= state_predictions_105 <= high_predictions_105:
            return None
        if not low_predictions_106 <= state_predictions_106 <= high_predictions_106:
            return None
        if not low_predictions_107 <= state_predictions_107 <= high_predictions_107:
            return None
        if not low_predictions_108 <= state_predictions_108 <= high_predictions_108:
            return None
        if not low_predictions_109 <= state_predictions_109 <= high_predictions_109:
            return None
        if not low_predictions_110 <= state_predictions_110 <= high_predictions_110:
            return None
        if not low_predictions_111 <= state_predictions_111 <= high_predictions_111:
            return None
        if not low_predictions_112 <= state_predictions_112 <= high_predictions_112:
            return None
        if not low_predictions_113 <= state_predictions_113 <= high_predictions_113:
            return None
        if not low_predictions_114 <= state_predictions_114 <= high_predictions_114:
            return None
        if not low_predictions_115 <= state_predictions_115 <= high_predictions_115:
            return None
        if not low_predictions_116 <= state_predictions_116 <= high_predictions_116:
            return None
        if not low_predictions_117 <= state_predictions_117 <= high_predictions_117:
            return None
        if not low_predictions_118 <= state_predictions_118 <= high_predictions_118:
            return None
        if not low_predictions_119 <= state_predictions_119 <= high_predictions_119:
            return None
        if not low_level <= state_level <= high_level:
            return None
        if not low_slope <= state_slope <= high_slope:
            return None
        if not low_notch <= state_notch <= high_notch:
            return None
        if not low_notch_before <= state_notch_before <= high_notch_before:
            return None
        move = state_notch - state_notch_before
        rmpy_142 = c_step_response_0 * move + 128 >> 8
        add_143 = state_predictions_0 + rmpy_142
        rmpy_144 = c_step_response_1 * move + 128 >> 8
        add_145 = state_predictions_1 + rmpy_144
        rmpy_146 = c_step_response_2 * move + 128 >> 8
        add_147 = state_predictions_2 + rmpy_146
        rmpy_148 = c_step_response_3 * move + 128 >> 8
        add_149 = state_predictions_3 + rmpy_148
        rmpy_150 = c_step_response_4 * move + 128 >> 8
        add_151 = state_predictions_4 + rmpy_150
        rmpy_152 = c_step_response_5 * move + 128 >> 8
        add_153 = state_predictions_5 + rmpy_152
        rmpy_154 = c_step_response_6 * move + 128 >> 8
        add_155 = state_predictions_6 + rmpy_154
        rmpy_156 = c_step_response_7 * move + 128 >> 8
        add_157 = state_predictions_7 + rmpy_156
        rmpy_158 = c_step_response_8 * move + 128 >> 8
        add_159 = state_predictions_8 + rmpy_158
        rmpy_160 = c_step_response_9 * move + 128 >> 8
        add_161 = state_predictions_9 + rmpy_160
        rmpy_162 = c_step_response_10 * move + 128 >> 8
        add_163 = state_predictions_10 + rmpy_162
        rmpy_164 = c_step_response_11 * move + 128 >> 8
        add_165 = state_predictions_11 + rmpy_164
        rmpy_166 = c_step_response_12 * move + 128 >> 8
        add_167 = state_predictions_12 + rmpy_166
        rmpy_168 = c_step_response_13 * move + 128 >> 8
        add_169 = state_predictions_13 + rmpy_168
        rmpy_170 = c_step_response_14 * move + 128 >> 8
        add_171 = state_predictions_14 + rmpy_170
        rmpy_172 = c_step_response_15 * move + 128 >> 8
        add_173 = state_predictions_15 + rmpy_172
        rmpy_174 = c_step_response_16 * move + 128 >> 8
        add_175 = state_predictions_16 + rmpy_174
        rmpy_176 = c_step_response_17 * move + 128 >> 8
        add_177 = state_predictions_17 + rmpy_176
        rmpy_178 = c_step_response_18 * move + 128 >> 8
        add_179 = state_predictions_18 + rmpy_178
        rmpy_180 = c_step_response_19 * move + 128 >> 8
        add_181 = state_predictions_19 + rmpy_180
        rmpy_182 = c_step_response_20 * move + 128 >> 8
        add_183 = state_predictions_20 + rmpy_182
        rmpy_184 = c_step_response_21 * move + 128 >> 8
        add_185 = state_predictions_21 + rmpy_184
        rmpy_186 = c_step_response_22 * move + 128 >> 8
        add_187 = state_predictions_22 + rmpy_186
        rmpy_188 = c_step_response_23 * move + 128 >> 8
        add_189 = state_predictions_23 + rmpy_188
        rmpy_190 = c_step_response_24 * move + 128 >> 8
        add_191 = state_predictions_24 + rmpy_190
        rmpy_192 = c_step_response_25 * move + 128 >> 8
        add_193 = state_predictions_25 + rmpy_192
        rmpy_194 = c_step_response_26 * move + 128 >> 8
        add_195 = state_predictions_26 + rmpy_194
        rmpy_196 = c_step_response_27 * move + 128 >> 8
        add_197 = state_predictions_27 + rmpy_196
        rmpy_198 = c_step_response_28 * move + 128 >> 8
        add_199 = state_predictions_28 + rmpy_198
        rmpy_200 = c_step_response_29 * move + 128 >> 8
        add_201 = state_predictions_29 + rmpy_200
        rmpy_202 = c_step_response_30 * move + 128 >> 8
        add_203 = state_predictions_30 + rmpy_202
        rmpy_204 = c_step_response_31 * move + 128 >> 8
        add_205 = state_predictions_31 + rmpy_204
        rmpy_206 = c_step_response_32 * move + 128 >> 8
        add_207 = state_predictions_32 + rmpy_206
        rmpy_208 = c_step_response_33 * move + 128 >> 8
        add_209 = state_predictions_33 + rmpy_208
        rmpy_210 = c_step_response_34 * move + 128 >> 8
        add_211 = state_predictions_34 + rmpy_210
        rmpy_212 = c_step_response_35 * move + 128 >> 8
        add_213 = state_predictions_35 + rmpy_212
        rmpy_214 = c_step_response_36 * move + 128 >> 8
        add_215 = state_predictions_36 + rmpy_214
        rmpy_216 = c_step_response_37 * move + 128 >> 8
        add_217 = state_predictions_37 + rmpy_216
        rmpy_218 = c_step_response_38 * move + 128 >> 8
        add_219 = state_predictions_38 + rmpy_218
        rmpy_220 = c_step_response_39 * move + 128 >> 8
        add_221 = state_predictions_39 + rmpy_220
        rmpy_222 = c_step_response_40 * move + 128 >> 8
        add_223 = state_predictions_40 + rmpy_222
        rmpy_224 = c_step_response_41 * move + 128 >> 8
        add_225 = state_predictions_41 + rmpy_224
        rmpy_226 = c_step_response_42 * move + 128 >> 8
        add_227 = state_predictions_42 + rmpy_226
        rmpy_228 = c_step_response_43 * move + 128 >> 8
        add_229 = state_predictions_43 + rmpy_228
        rmpy_230 = c_step_response_44 * move + 128 >> 8
        add_231 = state_predictions_44 + rmpy_230
        rmpy_232 = c_step_response_45 * move + 128 >> 8
        add_233 = state_predictions_45 + rmpy_232
        rmpy_234 = c_step_response_46 * move + 128 >> 8
        add_235 = state_predictions_46 + rmpy_234
        rmpy_236 = c_step_response_47 * move + 128 >> 8
        add_237 = state_predictions_47 + rmpy_236
        rmpy_238 = c_step_response_48 * move + 128 >> 8
        add_239 = state_predictions_48 + rmpy_238
        rmpy_240 = c_step_response_49 * move + 128 >> 8
        add_241 = state_predictions_49 + rmpy_240
        rmpy_242 = c_step_response_50 * move + 128 >> 8
        add_243 = state_predictions_50 + rmpy_242
        rmpy_244 = c_step_response_51 * move + 128 >> 8
        add_245 = state_predictions_51 + rmpy_244
        rmpy_246 = c_step_response_52 * move + 128 >> 8
        add_247 = state_predictions_52 + rmpy_246
        rmpy_248 = c_step_response_53 * move + 128 >> 8
        add_249 = state_predictions_53 + rmpy_248
        rmpy_250 = c_step_response_54 * move + 128 >> 8
        add_251 = state_predictions_54 + rmpy_250
        rmpy_252 = c_step_response_55 * move + 128 >> 8
        add_253 = state_predictions_55 + rmpy_252
        rmpy_254 = c_step_response_56 * move + 128 >> 8
        add_255 = state_predictions_56 + rmpy_254
        rmpy_256 = c_step_response_57 * move + 128 >> 8
        add_257 = state_predictions_57 + rmpy_256
        rmpy_258 = c_step_response_58 * move + 128 >> 8
        add_259 = state_predictions_58 + rmpy_258
        rmpy_260 = c_step_response_59 * move + 128 >> 8
        add_261 = state_predictions_59 + rmpy_260
        rmpy_262 = c_step_response_60 * move + 128 >> 8
        add_263 = state_predictions_60 + rmpy_262
        rmpy_264 = c_step_response_61 * move + 128 >> 8
        add_265 = state_predictions_61 + rmpy_264
        rmpy_266 = c_step_response_62 * move + 128 >> 8
        add_267 = state_predictions_62 + rmpy_266
        rmpy_268 = c_step_response_63 * move + 128 >> 8
        add_269 = state_predictions_63 + rmpy_268
        rmpy_270 = c_step_response_64 * move + 128 >> 8
        add_271 = state_predictions_64 + rmpy_270
        rmpy_272 = c_step_response_65 * move + 128 >> 8
        add_273 = state_predictions_65 + rmpy_272
        rmpy_274 = c_step_response_66 * move + 128 >> 8
        add_275 = state_predictions_66 + rmpy_274
        rmpy_276 = c_step_response_67 * move + 128 >> 8
        add_277 = state_predictions_67 + rmpy_276
        rmpy_278 = c_step_response_68 * move + 128 >> 8
        add_279 = state_predictions_68 + rmpy_278
        rmpy_280 = c_step_response_69 * move + 128 >> 8
        add_281 = state_predictions_69 + rmpy_280
        rmpy_282 = c_step_response_70 * move + 128 >> 8
        add_283 = state_predictions_70 + rmpy_282
        rmpy_284 = c_step_response_71 * move + 128 >> 8
        add_285 = state_predictions_71 + rmpy_284
        rmpy_286 = c_step_response_72 * move + 128 >> 8
        add_287 = state_predictions_72 + rmpy_286
        rmpy_288 = c_step_response_73 * move + 128 >> 8
        add_289 = state_predictions_73 + rmpy_288
        rmpy_290 = c_step_response_74 * move + 128 >> 8
        add_291 = state_predictions_74 + rmpy_290
        rmpy_292 = c_step_response_75 * move + 128 >> 8
        add_293 = state_predictions_75 + rmpy_292
        rmpy_294 = c_step_response_76 * move + 128 >> 8
        add_295 = state_predictions_76 + rmpy_294
        rmpy_296 = c_step_response_77 * move + 128 >> 8
        add_297 = state_predictions_77 + rmpy_296
        rmpy_298 = c_step_response_78 * move + 128 >> 8
        add_299 = state_predictions_78 + rmpy_298
        rmpy_300 = c_step_response_79 * move + 128 >> 8
        add_301 = state_predictions_79 + rmpy_300
        rmpy_302 = c_step_response_80 * move + 128 >> 8
        add_303 = state_predictions_80 + rmpy_302
        rmpy_304 = c_step_response_81 * move + 128 >> 8
        add_305 = state_predictions_81 + rmpy_304
        rmpy_306 = c_step_response_82 * move + 128 >> 8
        add_307 = state_predictions_82 + rmpy_306
        rmpy_308 = c_step_response_83 * move + 128 >> 8
        add_309 = state_predictions_83 + rmpy_308
        rmpy_310 = c_step_response_84 * move + 128 >> 8
        add_311 = state_predictions_84 + rmpy_310
        rmpy_312 = c_step_response_85 * move + 128 >> 8
        add_313 = state_predictions_85 + rmpy_312
        rmpy_314 = c_step_response_86 * move + 128 >> 8
        add_315 = state_predictions_86 + rmpy_314
        rmpy_316 = c_step_response_87 * move + 128 >> 8
        add_317 = state_predictions_87 + rmpy_316
        rmpy_318 = c_step_response_88 * move + 128 >> 8
        add_319 = state_predictions_88 + rmpy_318
        rmpy_320 = c_step_response_89 * move + 128 >> 8
        add_321 = state_predictions_89 + rmpy_320
        rmpy_322 = c_step_response_90 * move + 128 >> 8
        add_323 = state_predictions_90 + rmpy_322
        rmpy_324 = c_step_response_91 * move + 128 >> 8
        add_325 = state_predictions_91 + rmpy_324
        rmpy_326 = c_step_response_92 * move + 128 >> 8
        add_327 = state_predictions_92 + rmpy_326
        rmpy_328 = c_step_response_93 * move + 128 >> 8
        add_329 = state_predictions_93 + rmpy_328
        rmpy_330 = c_step_response_94 * move + 128 >> 8
        add_331 = state_predictions_94 + rmpy_330
        rmpy_332 = c_step_response_95 * move + 128 >> 8
        add_333 = state_predictions_95 + rmpy_332
        rmpy_334 = c_step_response_96 * move + 128 >> 8
        add_335 = state_predictions_96 + rmpy_334
        rmpy_336 = c_step_response_97 * move + 128 >> 8
        add_337 = state_predictions_97 + rmpy_336
        rmpy_338 = c_step_response_98 * move + 128 >> 8
        add_339 = state_predictions_98 + rmpy_338
        rmpy_340 = c_step_response_99 * move + 128 >> 8
        add_341 = state_predictions_99 + rmpy_340
        rmpy_342 = c_step_response_100 * move + 128 >> 8
        add_343 = state_predictions_100 + rmpy_342
        rmpy_344 = c_step_response_101 * move + 128 >> 8
        add_345 = state_predictions_101 + rmpy_344
        rmpy_346 = c_step_response_102 * move + 128 >> 8
        add_347 = state_predictions_102 + rmpy_346
        rmpy_348 = c_step_response_103 * move + 128 >> 8
        add_349 = state_predictions_103 + rmpy_348
        rmpy_350 = c_step_response_104 * move + 128 >> 8
        add_351 = state_predictions_104 + rmpy_350
        rmpy_352 = c_step_response_105 * move + 128 >> 8
        add_353 = state_predictions_105 + rmpy_352
        rmpy_354 = c_step_response_106 * move + 128 >> 8
        add_355 = state_predictions_106 + rmpy_354
        rmpy_356 = c_step_response_107 * move + 128 >> 8
        add_357 = state_predictions_107 + rmpy_356
        rmpy_358 = c_step_response_108 * move + 128 >> 8
        add_359 = state_predictions_108 + rmpy_358
        rmpy_360 = c_step_response_109 * move + 128 >> 8
        add_361 = state_predictions_109 + rmpy_360
        rmpy_362 = c_step_response_110 * move + 128 >> 8
        add_363 = state_predictions_110 + rmpy_362
        rmpy_364 = c_step_response_111 * move + 128 >> 8
        add_365 = state_predictions_111 + rmpy_364
        rmpy_366 = c_step_response_112 * move + 128 >> 8
        add_367 = state_predictions_112 + rmpy_366
        rmpy_368 = c_step_response_113 * move + 128 >> 8
        add_369 = state_predictions_113 + rmpy_368
        rmpy_370 = c_step_response_114 * move + 128 >> 8
        add_371 = state_predictions_114 + rmpy_370
        rmpy_372 = c_step_response_115 * move + 128 >> 8
        add_373 = state_predictions_115 + rmpy_372
        rmpy_374 = c_step_response_116 * move + 128 >> 8
        add_375 = state_predictions_116 + rmpy_374
        rmpy_376 = c_step_response_117 * move + 128 >> 8
        add_377 = state_predictions_117 + rmpy_376
        rmpy_378 = c_step_response_118 * move + 128 >> 8
        add_379 = state_predictions_118 + rmpy_378
        rmpy_380 = c_step_response_119 * move + 128 >> 8
        add_381 = state_predictions_119 + rmpy_380
        y_m = add_143 >> 5
        convert_383 = in_speed >> 2
        model_error = convert_383 - y_m
        add_385 = state_level + state_slope
        missed = model_error - add_385
        rmpy_387 = c_correction_level * missed + 8388608 >> 24
        level = add_385 + rmpy_387
        rmpy_389 = c_correction_ramp * missed + 8388608 >> 24
        slope = state_slope + rmpy_389
        if not c_minus_trend_max <= slope <= c_trend_max:
            return None
        sat_391 = slope
        add_392 = level + sat_391
        convert_393 = add_145 >> 5
        add_394 = convert_393 + add_392
        convert_395 = in_preview_0 >> 2
        sub_396 = convert_395 - add_394
        if not c_minus_deviation_max <= sub_396 <= c_deviation_max:
            return None
        deviation_0 = sub_396
        add_398 = add_392 + sat_391
        convert_399 = add_147 >> 5
        add_400 = convert_399 + add_398
        convert_401 = in_preview_1 >> 2
        sub_402 = convert_401 - add_400
        if not c_minus_deviation_max <= sub_402 <= c_deviation_max:
            return None
        deviation_1 = sub_402
        add_404 = add_398 + sat_391
        convert_405 = add_149 >> 5
        add_406 = convert_405 + add_404
        convert_407 = in_preview_2 >> 2
        sub_408 = convert_407 - add_406
        if not c_minus_deviation_max <= sub_408 <= c_deviation_max:
            return None
        deviation_2 = sub_408
        add_410 = add_404 + sat_391
        convert_411 = add_151 >> 5
        add_412 = convert_411 + add_410
        convert_413 = in_preview_3 >> 2
        sub_414 = convert_413 - add_412
        if not c_minus_deviation_max <= sub_414 <= c_deviation_max:
            return None
        deviation_3 = sub_414
        add_416 = add_410 + sat_391
        convert_417 = add_153 >> 5
        add_418 = convert_417 + add_416
        convert_419 = in_preview_4 >> 2
        sub_420 = convert_419 - add_418
        if not c_minus_deviation_max <= sub_420 <= c_deviation_max:
            return None
        deviation_4 = sub_420
        add_422 = add_416 + sat_391
        convert_423 = add_155 >> 5
        add_424 = convert_423 + add_422
        convert_425 = in_preview_5 >> 2
        sub_426 = convert_425 - add_424
        if not c_minus_deviation_max <= sub_426 <= c_deviation_max:
            return None
        deviation_5 = sub_426
        add_428 = add_422 + sat_391
        convert_429 = add_157 >> 5
        add_430 = convert_429 + add_428
        convert_431 = in_preview_6 >> 2
        sub_432 = convert_431 - add_430
        if not c_minus_deviation_max <= sub_432 <= c_deviation_max:
            return None
        deviation_6 = sub_432
        add_434 = add_428 + sat_391
        convert_435 = add_159 >> 5
        add_436 = convert_435 + add_434
        convert_437 = in_preview_7 >> 2
        sub_438 = convert_437 - add_436
        if not c_minus_deviation_max <= sub_438 <= c_deviation_max:
            return None
        deviation_7 = sub_438
        add_440 = add_434 + sat_391
        convert_441 = add_161 >> 5
        add_442 = convert_441 + add_440
        convert_443 = in_preview_8 >> 2
        sub_444 = convert_443 - add_442
        if not c_minus_deviation_max <= sub_444 <= c_deviation_max:
            return None
        deviation_8 = sub_444
        add_446 = add_440 + sat_391
        convert_447 = add_163 >> 5
        add_448 = convert_447 + add_446
        convert_449 = in_preview_9 >> 2
        sub_450 = convert_449 - add_448
        if not c_minus_deviation_max <= sub_450 <= c_deviation_max:
            return None
        deviation_9 = sub_450
        add_452 = add_446 + sat_391
        convert_453 = add_165 >> 5
        add_454 = convert_453 + add_452
        convert_455 = in_preview_10 >> 2
        sub_456 = convert_455 - add_454
        if not c_minus_deviation_max <= sub_456 <= c_deviation_max:
            return None
        deviation_10 = sub_456
        add_458 = add_452 + sat_391
        convert_459 = add_167 >> 5
        add_460 = convert_459 + add_458
        convert_461 = in_preview_11 >> 2
        sub_462 = convert_461 - add_460
        if not c_minus_deviation_max <= sub_462 <= c_deviation_max:
            return None
        deviation_11 = sub_462
        add_464 = add_458 + sat_391
        convert_465 = add_169 >> 5
        add_466 = convert_465 + add_464
        convert_467 = in_preview_12 >> 2
        sub_468 = convert_467 - add_466
        if not c_minus_deviation_max <= sub_468 <= c_deviation_max:
            return None
        deviation_12 = sub_468
        add_470 = add_464 + sat_391
        convert_471 = add_171 >> 5
        add_472 = convert_471 + add_470
        convert_473 = in_preview_13 >> 2
        sub_474 = convert_473 - add_472
        if not c_minus_deviation_max <= sub_474 <= c_deviation_max:
            return None
        deviation_13 = sub_474
        add_476 = add_470 + sat_391
        convert_477 = add_173 >> 5
        add_478 = convert_477 + add_476
        convert_479 = in_preview_14 >> 2
        sub_480 = convert_479 - add_478
        if not c_minus_deviation_max <= sub_480 <= c_deviation_max:
            return None
        deviation_14 = sub_480
        change = c_gains_0 * deviation_0 + 4194304 >> 23
        change += c_gains_1 * deviation_1 + 4194304 >> 23
        change += c_gains_2 * deviation_2 + 4194304 >> 23
        change += c_gains_3 * deviation_3 + 4194304 >> 23
        change += c_gains_4 * deviation_4 + 4194304 >> 23
        change += c_gains_5 * deviation_5 + 4194304 >> 23
        change += c_gains_6 * deviation_6 + 4194304 >> 23
        change += c_gains_7 * deviation_7 + 4194304 >> 23
        change += c_gains_8 * deviation_8 + 4194304 >> 23
        change += c_gains_9 * deviation_9 + 4194304 >> 23
        change += c_gains_10 * deviation_10 + 4194304 >> 23
        change += c_gains_11 * deviation_11 + 4194304 >> 23
        change += c_gains_12 * deviation_12 + 4194304 >> 23
        change += c_gains_13 * deviation_13 + 4194304 >> 23
        change += c_gains_14 * deviation_14 + 4194304 >> 23
        convert_483 = state_notch << 11
        notch_raw = convert_483 + change
        clip_485 = notch_raw if notch_raw < c_notch_max else c_notch_max
        if clip_485 < c_minus_notch_max:
            clip_485 = c_minus_notch_max
        notch = clip_485 + 1024 >> 11
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
        sub_24 = at_23 - at_22
        maximum_25 = c_one_01mm if c_one_01mm > sub_24 else sub_24
        sub_26 = position_01mm - at_22
        if c_zero > maximum_25:
            return None
        clip_27 = sub_26 if sub_26 < maximum_25 else maximum_25
        if clip_27 < c_zero:
            clip_27 = c_zero
        div_28 = div(clip_27, maximum_25, 20)
        minimum_29 = c_one if c_one < div_28 else div_28
        at_30 = t_v_of_x[locate_21]
        at_31 = t_v_of_x[locate_21 + 1]
        sub_32 = at_31 - at_30
        rmpy_33 = sub_32 * minimum_29 + 524288 >> 20
        add_34 = at_30 + rmpy_33
        at_35 = t_v_of_x[locate_21 + 16]
        at_36 = t_v_of_x[locate_21 + 17]
        sub_37 = at_36 - at_35
        rmpy_38 = sub_37 * minimum_29 + 524288 >> 20
        add_39 = at_35 + rmpy_38
        at_40 = t_v_of_x[locate_21 + 32]
        at_41 = t_v_of_x[locate_21 + 33]
        sub_42 = at_41 - at_40
        rmpy_43 = sub_42 * minimum_29 + 524288 >> 20
        add_44 = at_40 + rmpy_43
        at_45 = t_v_of_x[locate_21 + 48]
        at_46 = t_v_of_x[locate_21 + 49]
        sub_47 = at_46 - at_45
        rmpy_48 = sub_47 * minimum_29 + 524288 >> 20
        add_49 = at_45 + rmpy_48
        at_50 = t_v_of_x[locate_21 + 64]
        at_51 = t_v_of_x[locate_21 + 65]
        sub_52 = at_51 - at_50
        rmpy_53 = sub_52 * minimum_29 + 524288 >> 20
        add_54 = at_50 + rmpy_53
        at_55 = t_v_of_x[locate_21 + 80]
        at_56 = t_v_of_x[locate_21 + 81]
        sub_57 = at_56 - at_55
        rmpy_58 = sub_57 * minimum_29 + 524288 >> 20
        add_59 = at_55 + rmpy_58
        at_60 = t_v_of_x[locate_21 + 96]
        at_61 = t_v_of_x[locate_21 + 97]
        sub_62 = at_61 - at_60
        rmpy_63 = sub_62 * minimum_29 + 524288 >> 20
        add_64 = at_60 + rmpy_63
        at_65 = t_v_of_x[locate_21 + 112]
        at_66 = t_v_of_x[locate_21 + 113]
        sub_67 = at_66 - at_65
        rmpy_68 = sub_67 * minimum_29 + 524288 >> 20
        add_69 = at_65 + rmpy_68
        at_70 = t_v_of_x[locate_21 + 128]
        at_71 = t_v_of_x[locate_21 + 129]
        sub_72 = at_71 - at_70
        rmpy_73 = sub_72 * minimum_29 + 524288 >> 20
        add_74 = at_70 + rmpy_73
        at_75 = t_v_of_x[locate_21 + 144]
        at_76 = t_v_of_x[locate_21 + 145]
        sub_77 = at_76 - at_75
        rmpy_78 = sub_77 * minimum_29 + 524288 >> 20
        add_79 = at_75 + rmpy_78
        at_80 = t_v_of_x[locate_21 + 160]
        at_81 = t_v_of_x[locate_21 + 161]
        sub_82 = at_81 - at_80
        rmpy_83 = sub_82 * minimum_29 + 524288 >> 20
        add_84 = at_80 + rmpy_83
        at_85 = t_v_of_x[locate_21 + 176]
        at_86 = t_v_of_x[locate_21 + 177]
        sub_87 = at_86 - at_85
        rmpy_88 = sub_87 * minimum_29 + 524288 >> 20
        add_89 = at_85 + rmpy_88
        at_90 = t_v_of_x[locate_21 + 192]
        at_91 = t_v_of_x[locate_21 + 193]
        sub_92 = at_91 - at_90
        rmpy_93 = sub_92 * minimum_29 + 524288 >> 20
        add_94 = at_90 + rmpy_93
        at_95 = t_v_of_x[locate_21 + 208]
        at_96 = t_v_of_x[locate_21 + 209]
        sub_97 = at_96 - at_95
        rmpy_98 = sub_97 * minimum_29 + 524288 >> 20
        add_99 = at_95 + rmpy_98
        at_100 = t_v_of_x[locate_21 + 224]
        at_101 = t_v_of_x[locate_21 + 225]
        sub_102 = at_101 - at_100
        rmpy_103 = sub_102 * minimum_29 + 524288 >> 20
        add_104 = at_100 + rmpy_103
        at_105 = t_v_of_x[locate_21 + 240]
        at_106 = t_v_of_x[locate_21 + 241]
        sub_107 = at_106 - at_105
        rmpy_108 = sub_107 * minimum_29 + 524288 >> 20
        add_109 = at_105 + rmpy_108
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
