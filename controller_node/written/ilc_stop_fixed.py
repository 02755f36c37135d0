"""Law ilc_stop in fixed point. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

from railhil.controller_node.written.parts import Parts, Step, Values


def inputs(parts: Parts) -> Step:
    (
        low_speed1,
        high_speed1,
        low_speed2,
        high_speed2,
        low_speed3,
        high_speed3,
        low_speed4,
        high_speed4,
        low_speed5,
        high_speed5,
        low_speed_count,
        high_speed_count,
        low_speed_valid,
        high_speed_valid,
        low_slide,
        high_slide,
        low_odometer,
        high_odometer,
        low_balise,
        high_balise,
        low_balise_odometer,
        high_balise_odometer,
        low_load,
        high_load,
        low_wet,
        high_wet,
        low_standstill,
        high_standstill,
        low_doors,
        high_doors,
        low_run,
        high_run,
        low_report_run,
        high_report_run,
        low_report_error,
        high_report_error,
        low_level,
        high_level,
    ) = parts.bounds

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
        if not low_speed1 <= speed1 <= high_speed1:
            return None
        if not low_speed2 <= speed2 <= high_speed2:
            return None
        if not low_speed3 <= speed3 <= high_speed3:
            return None
        if not low_speed4 <= speed4 <= high_speed4:
            return None
        if not low_speed5 <= speed5 <= high_speed5:
            return None
        if not low_speed_count <= speed_count <= high_speed_count:
            return None
        if not low_speed_valid <= speed_valid <= high_speed_valid:
            return None
        if not low_slide <= slide <= high_slide:
            return None
        if not low_odometer <= odometer <= high_odometer:
            return None
        if not low_balise <= balise <= high_balise:
            return None
        if not low_balise_odometer <= balise_odometer <= high_balise_odometer:
            return None
        if not low_load <= load <= high_load:
            return None
        if not low_wet <= wet <= high_wet:
            return None
        if not low_standstill <= standstill <= high_standstill:
            return None
        if not low_doors <= doors <= high_doors:
            return None
        if not low_run <= run <= high_run:
            return None
        if not low_report_run <= report_run <= high_report_run:
            return None
        if not low_report_error <= report_error <= high_report_error:
            return None
        if not low_level <= level <= high_level:
            return None
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
    (
        low_gap_number,
        high_gap_number,
        low_gap_missed,
        high_gap_missed,
        low_gap_samples,
        high_gap_samples,
        low_gap_last,
        high_gap_last,
        low_stage,
        high_stage,
        low_cruise,
        high_cruise,
        low_cruising,
        high_cruising,
        low_accel,
        high_accel,
        low_braking,
        high_braking,
        low_learned_slot,
        high_learned_slot,
        low_learned_before_offset,
        high_learned_before_offset,
        low_learned_before_variance,
        high_learned_before_variance,
        low_learned_before_runs,
        high_learned_before_runs,
        low_learned_before_last_run,
        high_learned_before_last_run,
        low_learned_after_offset,
        high_learned_after_offset,
        low_learned_after_variance,
        high_learned_after_variance,
        low_learned_after_runs,
        high_learned_after_runs,
        low_learned_after_last_run,
        high_learned_after_last_run,
        low_learned_learned,
        high_learned_learned,
        low_learned_spoiled,
        high_learned_spoiled,
        low_learned_error,
        high_learned_error,
        low_learned_gamma,
        high_learned_gamma,
        low_own_filter_0,
        high_own_filter_0,
        low_own_filter_1,
        high_own_filter_1,
        low_own_filter_2,
        high_own_filter_2,
        low_own_filter_3,
        high_own_filter_3,
        low_own_filter_4,
        high_own_filter_4,
        low_own_filter_5,
        high_own_filter_5,
        low_own_filter_6,
        high_own_filter_6,
        low_own_filter_7,
        high_own_filter_7,
        low_own_filter_8,
        high_own_filter_8,
        low_own_filter_9,
        high_own_filter_9,
        low_own_filter_10,
        high_own_filter_10,
        low_own_filter_11,
        high_own_filter_11,
        low_own_filter_12,
        high_own_filter_12,
        low_own_filter_13,
        high_own_filter_13,
        low_own_filter_14,
        high_own_filter_14,
        low_own_filter_15,
        high_own_filter_15,
        low_own_filter_16,
        high_own_filter_16,
        low_own_filter_17,
        high_own_filter_17,
        low_own_filter_18,
        high_own_filter_18,
        low_own_filter_19,
        high_own_filter_19,
        low_own_filter_20,
        high_own_filter_20,
        low_own_filter_21,
        high_own_filter_21,
        low_own_filter_22,
        high_own_filter_22,
        low_own_filter_23,
        high_own_filter_23,
        low_own_filter_24,
        high_own_filter_24,
        low_own_filter_25,
        high_own_filter_25,
        low_own_filter_26,
        high_own_filter_26,
        low_own_filter_27,
        high_own_filter_27,
        low_own_filter_28,
        high_own_filter_28,
        low_own_filter_29,
        high_own_filter_29,
        low_own_filter_30,
        high_own_filter_30,
        low_own_filter_31,
        high_own_filter_31,
        low_own_filter_32,
        high_own_filter_32,
        low_own_filter_33,
        high_own_filter_33,
        low_own_filter_34,
        high_own_filter_34,
        low_own_filter_35,
        high_own_filter_35,
        low_own_filter_36,
        high_own_filter_36,
        low_own_filter_37,
        high_own_filter_37,
        low_own_filter_38,
        high_own_filter_38,
        low_own_filter_39,
        high_own_filter_39,
        low_own_filter_40,
        high_own_filter_40,
        low_own_filter_41,
        high_own_filter_41,
        low_own_filter_42,
        high_own_filter_42,
        low_own_filter_43,
        high_own_filter_43,
        low_own_filter_44,
        high_own_filter_44,
        low_own_filter_45,
        high_own_filter_45,
        low_own_filter_46,
        high_own_filter_46,
        low_own_filter_47,
        high_own_filter_47,
        low_own_filter_48,
        high_own_filter_48,
        low_own_filter_49,
        high_own_filter_49,
        low_own_filter_50,
        high_own_filter_50,
        low_own_filter_51,
        high_own_filter_51,
        low_own_filter_52,
        high_own_filter_52,
        low_own_filter_53,
        high_own_filter_53,
        low_own_filter_54,
        high_own_filter_54,
        low_own_filter_55,
        high_own_filter_55,
        low_own_filter_56,
        high_own_filter_56,
        low_own_filter_57,
        high_own_filter_57,
        low_own_filter_58,
        high_own_filter_58,
        low_own_filter_59,
        high_own_filter_59,
        low_own_filter_60,
        high_own_filter_60,
        low_own_filter_61,
        high_own_filter_61,
        low_own_filter_62,
        high_own_filter_62,
        low_own_filter_63,
        high_own_filter_63,
        low_own_filter_64,
        high_own_filter_64,
        low_own_filter_65,
        high_own_filter_65,
        low_own_filter_66,
        high_own_filter_66,
        low_own_filter_67,
        high_own_filter_67,
        low_own_filter_68,
        high_own_filter_68,
        low_own_filter_69,
        high_own_filter_69,
        low_own_filter_70,
        high_own_filter_70,
        low_own_filter_71,
        high_own_filter_71,
        low_own_filter_72,
        high_own_filter_72,
        low_own_filter_73,
        high_own_filter_73,
        low_own_filter_74,
        high_own_filter_74,
        low_own_filter_75,
        high_own_filter_75,
        low_own_filter_76,
        high_own_filter_76,
        low_own_filter_77,
        high_own_filter_77,
        low_own_filter_78,
        high_own_filter_78,
        low_own_filter_79,
        high_own_filter_79,
        low_own_filter_80,
        high_own_filter_80,
        low_own_filter_81,
        high_own_filter_81,
        low_own_filter_82,
        high_own_filter_82,
        low_own_filter_83,
        high_own_filter_83,
        low_own_filter_84,
        high_own_filter_84,
        low_own_filter_85,
        high_own_filter_85,
        low_own_filter_86,
        high_own_filter_86,
        low_own_filter_87,
        high_own_filter_87,
        low_own_filter_88,
        high_own_filter_88,
        low_own_filter_89,
        high_own_filter_89,
        low_own_filter_90,
        high_own_filter_90,
        low_own_filter_91,
        high_own_filter_91,
        low_own_filter_92,
        high_own_filter_92,
        low_own_filter_93,
        high_own_filter_93,
        low_own_filter_94,
        high_own_filter_94,
        low_own_filter_95,
        high_own_filter_95,
        low_own_filter_96,
        high_own_filter_96,
        low_own_filter_97,
        high_own_filter_97,
        low_own_filter_98,
        high_own_filter_98,
        low_own_filter_99,
        high_own_filter_99,
        low_own_filter_100,
        high_own_filter_100,
        low_own_filter_101,
        high_own_filter_101,
        low_own_filter_102,
        high_own_filter_102,
        low_own_filter_103,
        high_own_filter_103,
        low_own_filter_104,
        high_own_filter_104,
        low_own_filter_105,
        high_own_filter_105,
        low_own_filter_106,
        high_own_filter_106,
        low_own_filter_107,
        high_own_filter_107,
        low_own_filter_108,
        high_own_filter_108,
        low_own_filter_109,
        high_own_filter_109,
        low_own_filter_110,
        high_own_filter_110,
        low_own_filter_111,
        high_own_filter_111,
        low_own_filter_112,
        high_own_filter_112,
        low_own_filter_113,
        high_own_filter_113,
        low_own_filter_114,
        high_own_filter_114,
        low_own_filter_115,
        high_own_filter_115,
        low_own_filter_116,
        high_own_filter_116,
        low_own_filter_117,
        high_own_filter_117,
        low_own_filter_118,
        high_own_filter_118,
        low_own_filter_119,
        high_own_filter_119,
        low_own_filter_120,
        high_own_filter_120,
        low_own_filter_121,
        high_own_filter_121,
        low_own_filter_122,
        high_own_filter_122,
        low_own_filter_123,
        high_own_filter_123,
        low_own_filter_124,
        high_own_filter_124,
        low_own_filter_125,
        high_own_filter_125,
        low_own_filter_126,
        high_own_filter_126,
        low_own_filter_127,
        high_own_filter_127,
        low_own_accel,
        high_own_accel,
    ) = parts.bounds

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
            state_own_filter_0,
            state_own_filter_1,
            state_own_filter_2,
            state_own_filter_3,
            state_own_filter_4,
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
        if not low_gap_number <= state_gap_number <= high_gap_number:
            return None
        if not low_gap_missed <= state_gap_missed <= high_gap_missed:
            return None
        if not low_gap_samples <= state_gap_samples <= high_gap_samples:
            return None
        if not low_gap_last <= state_gap_last <= high_gap_last:
            return None
        if not low_stage <= state_stage <= high_stage:
            return None
        if not low_cruise <= state_cruise <= high_cruise:
            return None
        if not low_cruising <= state_cruising <= high_cruising:
            return None
        if not low_accel <= state_accel <= high_accel:
            return None
        if not low_braking <= state_braking <= high_braking:
            return None
        if not low_learned_slot <= state_learned_slot <= high_learned_slot:
            return None
        if not low_learned_before_offset <= state_learned_before_offset <= high_learned_before_offset:
            return None
        if not low_learned_before_variance <= state_learned_before_variance <= high_learned_before_variance:
            return None
        if not low_learned_before_runs <= state_learned_before_runs <= high_learned_before_runs:
            return None
        if not low_learned_before_last_run <= state_learned_before_last_run <= high_learned_before_last_run:
            return None
        if not low_learned_after_offset <= state_learned_after_offset <= high_learned_after_offset:
            return None
        if not low_learned_after_variance <= state_learned_after_variance <= high_learned_after_variance:
            return None
        if not low_learned_after_runs <= state_learned_after_runs <= high_learned_after_runs:
            return None
        if not low_learned_after_last_run <= state_learned_after_last_run <= high_learned_after_last_run:
            return None
        if not low_learned_learned <= state_learned_learned <= high_learned_learned:
            return None
        if not low_learned_spoiled <= state_learned_spoiled <= high_learned_spoiled:
            return None
        if not low_learned_error <= state_learned_error <= high_learned_error:
            return None
        if not low_learned_gamma <= state_learned_gamma <= high_learned_gamma:
            return None
        if not low_own_filter_0 <= state_own_filter_0 <= high_own_filter_0:
            return None
        if not low_own_filter_1 <= state_own_filter_1 <= high_own_filter_1:
            return None
        if not low_own_filter_2 <= state_own_filter_2 <= high_own_filter_2:
            return None
        if not low_own_filter_3 <= state_own_filter_3 <= high_own_filter_3:
            return None
        if not low_own_filter_4 <= state_own_filter_4 <= high_own_filter_4:
            return None
        if not low_own_filter_5 <= state_own_filter_5 <= high_own_filter_5:
            return None
        if not low_own_filter_6 <= state_own_filter_6 <= high_own_filter_6:
            return None
        if not low_own_filter_7 <= state_own_filter_7 <= high_own_filter_7:
            return None
        if not low_own_filter_8 <= state_own_filter_8 <= high_own_filter_8:
            return None
        if not low_own_filter_9 <= state_own_filter_9 <= high_own_filter_9:
            return None
        if not low_own_filter_10 <= state_own_filter_10 <= high_own_filter_10:
            return None
        if not low_own_filter_11 <= state_own_filter_11 <= high_own_filter_11:
            return None
        if not low_own_filter_12 <= state_own_filter_12 <= high_own_filter_12:
            return None
        if not low_own_filter_13 <= state_own_filter_13 <= high_own_filter_13:
            return None
        if not low_own_filter_14 <= state_own_filter_14 <= high_own_filter_14:
            return None
        if not low_own_filter_15 <= state_own_filter_15 <= high_own_filter_15:
            return None
        if not low_own_filter_16 <= state_own_filter_16 <= high_own_filter_16:
            return None
        if not low_own_filter_17 <= state_own_filter_17 <= high_own_filter_17:
            return None
        if not low_own_filter_18 <= state_own_filter_18 <= high_own_filter_18:
            return None
        if not low_own_filter_19 <= state_own_filter_19 <= high_own_filter_19:
            return None
        if not low_own_filter_20 <= state_own_filter_20 <= high_own_filter_20:
            return None
        if not low_own_filter_21 <= state_own_filter_21 <= high_own_filter_21:
            return None
        if not low_own_filter_22 <= state_own_filter_22 <= high_own_filter_22:
            return None
        if not low_own_filter_23 <= state_own_filter_23 <= high_own_filter_23:
            return None
        if not low_own_filter_24 <= state_own_filter_24 <= high_own_filter_24:
            return None
        if not low_own_filter_25 <= state_own_filter_25 <= high_own_filter_25:
            return None
        if not low_own_filter_26 <= state_own_filter_26 <= high_own_filter_26:
            return None
        if not low_own_filter_27 <= state_own_filter_27 <= high_own_filter_27:
            return None
        if not low_own_filter_28 <= state_own_filter_28 <= high_own_filter_28:
            return None
        if not low_own_filter_29 <= state_own_filter_29 <= high_own_filter_29:
            return None
        if not low_own_filter_30 <= state_own_filter_30 <= high_own_filter_30:
            return None
        if not low_own_filter_31 <= state_own_filter_31 <= high_own_filter_31:
            return None
        if not low_own_filter_32 <= state_own_filter_32 <= high_own_filter_32:
            return None
        if not low_own_filter_33 <= state_own_filter_33 <= high_own_filter_33:
            return None
        if not low_own_filter_34 <= state_own_filter_34 <= high_own_filter_34:
            return None
        if not low_own_filter_35 <= state_own_filter_35 <= high_own_filter_35:
            return None
        if not low_own_filter_36 <= state_own_filter_36 <= high_own_filter_36:
            return None
        if not low_own_filter_37 <= state_own_filter_37 <= high_own_filter_37:
            return None
        if not low_own_filter_38 <= state_own_filter_38 <= high_own_filter_38:
            return None
        if not low_own_filter_39 <= state_own_filter_39 <= high_own_filter_39:
            return None
        if not low_own_filter_40 <= state_own_filter_40 <= high_own_filter_40:
            return None
        if not low_own_filter_41 <= state_own_filter_41 <= high_own_filter_41:
            return None
        if not low_own_filter_42 <= state_own_filter_42 <= high_own_filter_42:
            return None
        if not low_own_filter_43 <= state_own_filter_43 <= high_own_filter_43:
            return None
        if not low_own_filter_44 <= state_own_filter_44 <= high_own_filter_44:
            return None
        if not low_own_filter_45 <= state_own_filter_45 <= high_own_filter_45:
            return None
        if not low_own_filter_46 <= state_own_filter_46 <= high_own_filter_46:
            return None
        if not low_own_filter_47 <= state_own_filter_47 <= high_own_filter_47:
            return None
        if not low_own_filter_48 <= state_own_filter_48 <= high_own_filter_48:
            return None
        if not low_own_filter_49 <= state_own_filter_49 <= high_own_filter_49:
            return None
        if not low_own_filter_50 <= state_own_filter_50 <= high_own_filter_50:
            return None
        if not low_own_filter_51 <= state_own_filter_51 <= high_own_filter_51:
            return None
        if not low_own_filter_52 <= state_own_filter_52 <= high_own_filter_52:
            return None
        if not low_own_filter_53 <= state_own_filter_53 <= high_own_filter_53:
            return None
        if not low_own_filter_54 <= state_own_filter_54 <= high_own_filter_54:
            return None
        if not low_own_filter_55 <= state_own_filter_55 <= high_own_filter_55:
            return None
        if not low_own_filter_56 <= state_own_filter_56 <= high_own_filter_56:
            return None
        if not low_own_filter_57 <= state_own_filter_57 <= high_own_filter_57:
            return None
        if not low_own_filter_58 <= state_own_filter_58 <= high_own_filter_58:
            return None
        if not low_own_filter_59 <= state_own_filter_59 <= high_own_filter_59:
            return None
        if not low_own_filter_60 <= state_own_filter_60 <= high_own_filter_60:
            return None
        if not low_own_filter_61 <= state_own_filter_61 <= high_own_filter_61:
            return None
        if not low_own_filter_62 <= state_own_filter_62 <= high_own_filter_62:
            return None
        if not low_own_filter_63 <= state_own_filter_63 <= high_own_filter_63:
            return None
        if not low_own_filter_64 <= state_own_filter_64 <= high_own_filter_64:
            return None
        if not low_own_filter_65 <= state_own_filter_65 <= high_own_filter_65:
            return None
        if not low_own_filter_66 <= state_own_filter_66 <= high_own_filter_66:
            return None
        if not low_own_filter_67 <= state_own_filter_67 <= high_own_filter_67:
            return None
        if not low_own_filter_68 <= state_own_filter_68 <= high_own_filter_68:
            return None
        if not low_own_filter_69 <= state_own_filter_69 <= high_own_filter_69:
            return None
        if not low_own_filter_70 <= state_own_filter_70 <= high_own_filter_70:
            return None
        if not low_own_filter_71 <= state_own_filter_71 <= high_own_filter_71:
            return None
        if not low_own_filter_72 <= state_own_filter_72 <= high_own_filter_72:
            return None
        if not low_own_filter_73 <= state_own_filter_73 <= high_own_filter_73:
            return None
        if not low_own_filter_74 <= state_own_filter_74 <= high_own_filter_74:
            return None
        if not low_own_filter_75 <= state_own_filter_75 <= high_own_filter_75:
            return None
        if not low_own_filter_76 <= state_own_filter_76 <= high_own_filter_76:
            return None
        if not low_own_filter_77 <= state_own_filter_77 <= high_own_filter_77:
            return None
        if not low_own_filter_78 <= state_own_filter_78 <= high_own_filter_78:
            return None
        if not low_own_filter_79 <= state_own_filter_79 <= high_own_filter_79:
            return None
        if not low_own_filter_80 <= state_own_filter_80 <= high_own_filter_80:
            return None
        if not low_own_filter_81 <= state_own_filter_81 <= high_own_filter_81:
            return None
        if not low_own_filter_82 <= state_own_filter_82 <= high_own_filter_82:
            return None
        if not low_own_filter_83 <= state_own_filter_83 <= high_own_filter_83:
            return None
        if not low_own_filter_84 <= state_own_filter_84 <= high_own_filter_84:
            return None
        if not low_own_filter_85 <= state_own_filter_85 <= high_own_filter_85:
            return None
        if not low_own_filter_86 <= state_own_filter_86 <= high_own_filter_86:
            return None
        if not low_own_filter_87 <= state_own_filter_87 <= high_own_filter_87:
            return None
        if not low_own_filter_88 <= state_own_filter_88 <= high_own_filter_88:
            return None
        if not low_own_filter_89 <= state_own_filter_89 <= high_own_filter_89:
            return None
        if not low_own_filter_90 <= state_own_filter_90 <= high_own_filter_90:
            return None
        if not low_own_filter_91 <= state_own_filter_91 <= high_own_filter_91:
            return None
        if not low_own_filter_92 <= state_own_filter_92 <= high_own_filter_92:
            return None
        if not low_own_filter_93 <= state_own_filter_93 <= high_own_filter_93:
            return None
        if not low_own_filter_94 <= state_own_filter_94 <= high_own_filter_94:
            return None
        if not low_own_filter_95 <= state_own_filter_95 <= high_own_filter_95:
            return None
        if not low_own_filter_96 <= state_own_filter_96 <= high_own_filter_96:
            return None
        if not low_own_filter_97 <= state_own_filter_97 <= high_own_filter_97:
            return None
        if not low_own_filter_98 <= state_own_filter_98 <= high_own_filter_98:
            return None
        if not low_own_filter_99 <= state_own_filter_99 <= high_own_filter_99:
            return None
        if not low_own_filter_100 <= state_own_filter_100 <= high_own_filter_100:
            return None
        if not low_own_filter_101 <= state_own_filter_101 <= high_own_filter_101:
            return None
        if not low_own_filter_102 <= state_own_filter_102 <= high_own_filter_102:
            return None
        if not low_own_filter_103 <= state_own_filter_103 <= high_own_filter_103:
            return None
        if not low_own_filter_104 <= state_own_filter_104 <= high_own_filter_104:
            return None
        if not low_own_filter_105 <= state_own_filter_105 <= high_own_filter_105:
            return None
        if not low_own_filter_106 <= state_own_filter_106 <= high_own_filter_106:
            return None
        if not low_own_filter_107 <= state_own_filter_107 <= high_own_filter_107:
            return None
        if not low_own_filter_108 <= state_own_filter_108 <= high_own_filter_108:
            return None
        if not low_own_filter_109 <= state_own_filter_109 <= high_own_filter_109:
            return None
        if not low_own_filter_110 <= state_own_filter_110 <= high_own_filter_110:
            return None
        if not low_own_filter_111 <= state_own_filter_111 <= high_own_filter_111:
            return None
        if not low_own_filter_112 <= state_own_filter_112 <= high_own_filter_112:
            return None
        if not low_own_filter_113 <= state_own_filter_113 <= high_own_filter_113:
            return None
        if not low_own_filter_114 <= state_own_filter_114 <= high_own_filter_114:
            return None
        if not low_own_filter_115 <= state_own_filter_115 <= high_own_filter_115:
            return None
        if not low_own_filter_116 <= state_own_filter_116 <= high_own_filter_116:
            return None
        if not low_own_filter_117 <= state_own_filter_117 <= high_own_filter_117:
            return None
        if not low_own_filter_118 <= state_own_filter_118 <= high_own_filter_118:
            return None
        if not low_own_filter_119 <= state_own_filter_119 <= high_own_filter_119:
            return None
        if not low_own_filter_120 <= state_own_filter_120 <= high_own_filter_120:
            return None
        if not low_own_filter_121 <= state_own_filter_121 <= high_own_filter_121:
            return None
        if not low_own_filter_122 <= state_own_filter_122 <= high_own_filter_122:
            return None
        if not low_own_filter_123 <= state_own_filter_123 <= high_own_filter_123:
            return None
        if not low_own_filter_124 <= state_own_filter_124 <= high_own_filter_124:
            return None
        if not low_own_filter_125 <= state_own_filter_125 <= high_own_filter_125:
            return None
        if not low_own_filter_126 <= state_own_filter_126 <= high_own_filter_126:
            return None
        if not low_own_filter_127 <= state_own_filter_127 <= high_own_filter_127:
            return None
        if not low_own_accel <= state_own_accel <= high_own_accel:
            return None
        mpy_iqx_170 = in_0 * c_unit >> 10
        mpy_iqx_171 = in_1 * c_unit >> 10
        mpy_iqx_172 = in_2 * c_unit >> 10
        mpy_iqx_173 = in_3 * c_unit >> 10
        mpy_iqx_174 = in_4 * c_unit >> 10
        mpy_iqx_175 = in_8 * c_unit >> 14
        mpy_iqx_176 = in_10 * c_unit >> 14
        clip_177 = in_17 if in_17 < c_report_1 else c_report_1
        if clip_177 < c_report__1:
            clip_177 = c_report__1
        mpy_iqx_178 = clip_177 * c_unit >> 14
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
        v_hat = c_packet_0 * state_own_filter_5 + 536870912 >> 30
        v_hat += c_packet_1 * state_own_filter_6 + 536870912 >> 30
        v_hat += c_packet_2 * state_own_filter_7 + 536870912 >> 30
        v_hat += c_packet_3 * state_own_filter_8 + 536870912 >> 30
        v_hat += c_packet_4 * state_own_filter_9 + 536870912 >> 30
        v_hat += c_packet_5 * state_own_filter_10 + 536870912 >> 30
        v_hat += c_packet_6 * state_own_filter_11 + 536870912 >> 30
        v_hat += c_packet_7 * state_own_filter_12 + 536870912 >> 30
        v_hat += c_packet_8 * state_own_filter_13 + 536870912 >> 30
        v_hat += c_packet_9 * state_own_filter_14 + 536870912 >> 30
        v_hat += c_packet_10 * state_own_filter_15 + 536870912 >> 30
        v_hat += c_packet_11 * state_own_filter_16 + 536870912 >> 30
        v_hat += c_packet_12 * state_own_filter_17 + 536870912 >> 30
        v_hat += c_packet_13 * state_own_filter_18 + 536870912 >> 30
        v_hat += c_packet_14 * state_own_filter_19 + 536870912 >> 30
        v_hat += c_packet_15 * state_own_filter_20 + 536870912 >> 30
        v_hat += c_packet_16 * state_own_filter_21 + 536870912 >> 30
        v_hat += c_packet_17 * state_own_filter_22 + 536870912 >> 30
        v_hat += c_packet_18 * state_own_filter_23 + 536870912 >> 30
        v_hat += c_packet_19 * state_own_filter_24 + 536870912 >> 30
        v_hat += c_packet_20 * state_own_filter_25 + 536870912 >> 30
        v_hat += c_packet_21 * state_own_filter_26 + 536870912 >> 30
        v_hat += c_packet_22 * state_own_filter_27 + 536870912 >> 30
        v_hat += c_packet_23 * state_own_filter_28 + 536870912 >> 30
        v_hat += c_packet_24 * state_own_filter_29 + 536870912 >> 30
        v_hat += c_packet_25 * state_own_filter_30 + 536870912 >> 30
        v_hat += c_packet_26 * state_own_filter_31 + 536870912 >> 30
        v_hat += c_packet_27 * state_own_filter_32 + 536870912 >> 30
        v_hat += c_packet_28 * state_own_filter_33 + 536870912 >> 30
        v_hat += c_packet_29 * state_own_filter_34 + 536870912 >> 30
        v_hat += c_packet_30 * state_own_filter_35 + 536870912 >> 30
        v_hat += c_packet_31 * state_own_filter_36 + 536870912 >> 30
        v_hat += c_packet_32 * state_own_filter_37 + 536870912 >> 30
        v_hat += c_packet_33 * state_own_filter_38 + 536870912 >> 30
        v_hat += c_packet_34 * state_own_filter_39 + 536870912 >> 30
        v_hat += c_packet_35 * state_own_filter_40 + 536870912 >> 30
        v_hat += c_packet_36 * state_own_filter_41 + 536870912 >> 30
        v_hat += c_packet_37 * state_own_filter_42 + 536870912 >> 30
        v_hat += c_packet_38 * state_own_filter_43 + 536870912 >> 30
        v_hat += c_packet_39 * state_own_filter_44 + 536870912 >> 30
        v_hat += c_packet_40 * state_own_filter_45 + 536870912 >> 30
        v_hat += c_packet_41 * state_own_filter_46 + 536870912 >> 30
        v_hat += c_packet_42 * state_own_filter_47 + 536870912 >> 30
        v_hat += c_packet_43 * state_own_filter_48 + 536870912 >> 30
        v_hat += c_packet_44 * state_own_filter_49 + 536870912 >> 30
        v_hat += c_packet_45 * state_own_filter_50 + 536870912 >> 30
        v_hat += c_packet_46 * state_own_filter_51 + 536870912 >> 30
        v_hat += c_packet_47 * state_own_filter_52 + 536870912 >> 30
        v_hat += c_packet_48 * state_own_filter_53 + 536870912 >> 30
        v_hat += c_packet_49 * state_own_filter_54 + 536870912 >> 30
        v_hat += c_packet_50 * state_own_filter_55 + 536870912 >> 30
        v_hat += c_packet_51 * state_own_filter_56 + 536870912 >> 30
        v_hat += c_packet_52 * state_own_filter_57 + 536870912 >> 30
        v_hat += c_packet_53 * state_own_filter_58 + 536870912 >> 30
        v_hat += c_packet_54 * state_own_filter_59 + 536870912 >> 30
        v_hat += c_packet_55 * state_own_filter_60 + 536870912 >> 30
        v_hat += c_packet_56 * state_own_filter_61 + 536870912 >> 30
        v_hat += c_packet_57 * state_own_filter_62 + 536870912 >> 30
        v_hat += c_packet_58 * state_own_filter_63 + 536870912 >> 30
        v_hat += c_packet_59 * state_own_filter_64 + 536870912 >> 30
        v_hat += c_packet_60 * state_own_filter_65 + 536870912 >> 30
        v_hat += c_packet_61 * state_own_filter_66 + 536870912 >> 30
        v_hat += c_packet_62 * state_own_filter_67 + 536870912 >> 30
        v_hat += c_packet_63 * state_own_filter_68 + 536870912 >> 30
        v_hat += c_packet_64 * state_own_filter_69 + 536870912 >> 30
        v_hat += c_packet_65 * state_own_filter_70 + 536870912 >> 30
        v_hat += c_packet_66 * state_own_filter_71 + 536870912 >> 30
        v_hat += c_packet_67 * state_own_filter_72 + 536870912 >> 30
        v_hat += c_packet_68 * state_own_filter_73 + 536870912 >> 30
        v_hat += c_packet_69 * state_own_filter_74 + 536870912 >> 30
        v_hat += c_packet_70 * state_own_filter_75 + 536870912 >> 30
        v_hat += c_packet_71 * state_own_filter_76 + 536870912 >> 30
        v_hat += c_packet_72 * state_own_filter_77 + 536870912 >> 30
        v_hat += c_packet_73 * state_own_filter_78 + 536870912 >> 30
        v_hat += c_packet_74 * state_own_filter_79 + 536870912 >> 30
        v_hat += c_packet_75 * state_own_filter_80 + 536870912 >> 30
        v_hat += c_packet_76 * state_own_filter_81 + 536870912 >> 30
        v_hat += c_packet_77 * state_own_filter_82 + 536870912 >> 30
        v_hat += c_packet_78 * state_own_filter_83 + 536870912 >> 30
        v_hat += c_packet_79 * state_own_filter_84 + 536870912 >> 30
        v_hat += c_packet_80 * state_own_filter_85 + 536870912 >> 30
        v_hat += c_packet_81 * state_own_filter_86 + 536870912 >> 30
        v_hat += c_packet_82 * state_own_filter_87 + 536870912 >> 30
        v_hat += c_packet_83 * state_own_filter_88 + 536870912 >> 30
        v_hat += c_packet_84 * state_own_filter_89 + 536870912 >> 30
        v_hat += c_packet_85 * state_own_filter_90 + 536870912 >> 30
        v_hat += c_packet_86 * state_own_filter_91 + 536870912 >> 30
        v_hat += c_packet_87 * state_own_filter_92 + 536870912 >> 30
        v_hat += c_packet_88 * state_own_filter_93 + 536870912 >> 30
        v_hat += c_packet_89 * state_own_filter_94 + 536870912 >> 30
        v_hat += c_packet_90 * state_own_filter_95 + 536870912 >> 30
        v_hat += c_packet_91 * state_own_filter_96 + 536870912 >> 30
        v_hat += c_packet_92 * state_own_filter_97 + 536870912 >> 30
        v_hat += c_packet_93 * state_own_filter_98 + 536870912 >> 30
        v_hat += c_packet_94 * state_own_filter_99 + 536870912 >> 30
        v_hat += c_packet_95 * state_own_filter_100 + 536870912 >> 30
        v_hat += c_packet_96 * state_own_filter_101 + 536870912 >> 30
        v_hat += c_packet_97 * state_own_filter_102 + 536870912 >> 30
        v_hat += c_packet_98 * state_own_filter_103 + 536870912 >> 30
        v_hat += c_packet_99 * state_own_filter_104 + 536870912 >> 30
        v_hat += c_packet_100 * state_own_filter_105 + 536870912 >> 30
        v_hat += c_packet_101 * state_own_filter_106 + 536870912 >> 30
        v_hat += c_packet_102 * state_own_filter_107 + 536870912 >> 30
        v_hat += c_packet_103 * state_own_filter_108 + 536870912 >> 30
        v_hat += c_packet_104 * state_own_filter_109 + 536870912 >> 30
        v_hat += c_packet_105 * state_own_filter_110 + 536870912 >> 30
        v_hat += c_packet_106 * state_own_filter_111 + 536870912 >> 30
        v_hat += c_packet_107 * state_own_filter_112 + 536870912 >> 30
        v_hat += c_packet_108 * state_own_filter_113 + 536870912 >> 30
        v_hat += c_packet_109 * state_own_filter_114 + 536870912 >> 30
        v_hat += c_packet_110 * state_own_filter_115 + 536870912 >> 30
        v_hat += c_packet_111 * state_own_filter_116 + 536870912 >> 30
        v_hat += c_packet_112 * state_own_filter_117 + 536870912 >> 30
        v_hat += c_packet_113 * state_own_filter_118 + 536870912 >> 30
        v_hat += c_packet_114 * state_own_filter_119 + 536870912 >> 30
        v_hat += c_packet_115 * state_own_filter_120 + 536870912 >> 30
        v_hat += c_packet_116 * state_own_filter_121 + 536870912 >> 30
        v_hat += c_packet_117 * state_own_filter_122 + 536870912 >> 30
        v_hat += c_packet_118 * state_own_filter_123 + 536870912 >> 30
        v_hat += c_packet_119 * state_own_filter_124 + 536870912 >> 30
        v_hat += c_packet_120 * state_own_filter_125 + 536870912 >> 30
        v_hat += c_packet_121 * state_own_filter_126 + 536870912 >> 30
        v_hat += c_packet_122 * state_own_filter_127 + 536870912 >> 30
        v_hat += c_packet_123 * where_184 + 536870912 >> 30
        v_hat += c_packet_124 * where_185 + 536870912 >> 30
        v_hat += c_packet_125 * where_186 + 536870912 >> 30
        v_hat += c_packet_126 * where_187 + 536870912 >> 30
        v_hat += c_packet_127 * where_188 + 536870912 >> 30
        left = c_way - mpy_iqx_175
        gt_203 = in_12 > c_zero
        where_204 = c_planned_wet if gt_203 else c_planned_dry
        clip_205 = v_hat if v_hat < c_fastest else c_fastest
        if clip_205 < c_still:
            clip_205 = c_still
        convert_206 = where_204 >> 4
        div_207 = div(clip_205, convert_206, 20)
        clip_208 = div_207 if div_207 < c_time_max else c_time_max
        if clip_208 < c_time_0:
            clip_208 = c_time_0
        mpy_209 = c_model_lag_twice * clip_208 >> 20
        sqrt_210 = sqrt(mpy_209, 20)
        clip_211 = sqrt_210 if sqrt_210 < c_time_max else c_time_max
        if clip_211 < c_time_0:
            clip_211 = c_time_0
        add_212 = clip_208 + c_model_lag
        add_213 = clip_208 + clip_211
        minimum_214 = add_213 if add_213 < add_212 else add_212
        clip_215 = minimum_214 if minimum_214 < c_time_max else c_time_max
        if clip_215 < c_time_0:
            clip_215 = c_time_0
        clip_216 = clip_215 if clip_215 < c_exp_far else c_exp_far
        if clip_216 < c_exp_zero:
            clip_216 = c_exp_zero
        mpy_iqx_217 = clip_216 * c_exp_scale >> 20
        rmpy_218 = mpy_iqx_217 * c_exp_part_0 + 536870912 >> 30
        rmpy_219 = rmpy_218 * c_exp_one + 536870912 >> 30
        sub_220 = c_exp_one - rmpy_219
        rmpy_221 = mpy_iqx_217 * c_exp_part_1 + 536870912 >> 30
        rmpy_222 = rmpy_221 * sub_220 + 536870912 >> 30
        sub_223 = c_exp_one - rmpy_222
        rmpy_224 = mpy_iqx_217 * c_exp_part_2 + 536870912 >> 30
        rmpy_225 = rmpy_224 * sub_223 + 536870912 >> 30
        sub_226 = c_exp_one - rmpy_225
        rmpy_227 = mpy_iqx_217 * c_exp_part_3 + 536870912 >> 30
        rmpy_228 = rmpy_227 * sub_226 + 536870912 >> 30
        sub_229 = c_exp_one - rmpy_228
        rmpy_230 = mpy_iqx_217 * c_exp_part_4 + 536870912 >> 30
        rmpy_231 = rmpy_230 * sub_229 + 536870912 >> 30
        sub_232 = c_exp_one - rmpy_231
        rmpy_233 = mpy_iqx_217 * c_exp_part_5 + 536870912 >> 30
        rmpy_234 = rmpy_233 * sub_232 + 536870912 >> 30
        sub_235 = c_exp_one - rmpy_234
        rmpy_236 = mpy_iqx_217 * sub_235 + 536870912 >> 30
        sub_237 = c_exp_one - rmpy_236
        rmpy_238 = sub_237 * sub_237 + 536870912 >> 30
        rmpy_239 = rmpy_238 * rmpy_238 + 536870912 >> 30
        rmpy_240 = rmpy_239 * rmpy_239 + 536870912 >> 30
        rmpy_241 = rmpy_240 * rmpy_240 + 536870912 >> 30
        rmpy_242 = rmpy_241 * rmpy_241 + 536870912 >> 30
        rmpy_243 = rmpy_242 * rmpy_242 + 536870912 >> 30
        rmpy_244 = rmpy_243 * rmpy_243 + 536870912 >> 30
        rmpy_245 = rmpy_244 * rmpy_244 + 536870912 >> 30
        sub_246 = c_slope_one - rmpy_245
        mpy_247 = c_model_lag * sub_246 >> 30
        sub_248 = clip_215 - mpy_247
        sub_249 = sub_248 - clip_208
        maximum_250 = c_least_slope if c_least_slope > sub_246 else sub_246
        convert_251 = maximum_250 >> 10
        div_252 = div(sub_249, convert_251, 20)
        clip_253 = div_252 if div_252 < c_time_max else c_time_max
        if clip_253 < c_time_min:
            clip_253 = c_time_min
        sub_254 = clip_215 - clip_253
        clip_255 = sub_254 if sub_254 < c_time_max else c_time_max
        if clip_255 < c_time_0:
            clip_255 = c_time_0
        clip_256 = clip_255 if clip_255 < c_exp_far else c_exp_far
        if clip_256 < c_exp_zero:
            clip_256 = c_exp_zero
        mpy_iqx_257 = clip_256 * c_exp_scale >> 20
        rmpy_258 = mpy_iqx_257 * c_exp_part_0 + 536870912 >> 30
        rmpy_259 = rmpy_258 * c_exp_one + 536870912 >> 30
        sub_260 = c_exp_one - rmpy_259
        rmpy_261 = mpy_iqx_257 * c_exp_part_1 + 536870912 >> 30
        rmpy_262 = rmpy_261 * sub_260 + 536870912 >> 30
        sub_263 = c_exp_one - rmpy_262
        rmpy_264 = mpy_iqx_257 * c_exp_part_2 + 536870912 >> 30
        rmpy_265 = rmpy_264 * sub_263 + 536870912 >> 30
        sub_266 = c_exp_one - rmpy_265
        rmpy_267 = mpy_iqx_257 * c_exp_part_3 + 536870912 >> 30
        rmpy_268 = rmpy_267 * sub_266 + 536870912 >> 30
        sub_269 = c_exp_one - rmpy_268
        rmpy_270 = mpy_iqx_257 * c_exp_part_4 + 536870912 >> 30
        rmpy_271 = rmpy_270 * sub_269 + 536870912 >> 30
        sub_272 = c_exp_one - rmpy_271
        rmpy_273 = mpy_iqx_257 * c_exp_part_5 + 536870912 >> 30
        rmpy_274 = rmpy_273 * sub_272 + 536870912 >> 30
        sub_275 = c_exp_one - rmpy_274
        rmpy_276 = mpy_iqx_257 * sub_275 + 536870912 >> 30
        sub_277 = c_exp_one - rmpy_276
        rmpy_278 = sub_277 * sub_277 + 536870912 >> 30
        rmpy_279 = rmpy_278 * rmpy_278 + 536870912 >> 30
        rmpy_280 = rmpy_279 * rmpy_279 + 536870912 >> 30
        rmpy_281 = rmpy_280 * rmpy_280 + 536870912 >> 30
        rmpy_282 = rmpy_281 * rmpy_281 + 536870912 >> 30
        rmpy_283 = rmpy_282 * rmpy_282 + 536870912 >> 30
        rmpy_284 = rmpy_283 * rmpy_283 + 536870912 >> 30
        rmpy_285 = rmpy_284 * rmpy_284 + 536870912 >> 30
        sub_286 = c_slope_one - rmpy_285
        mpy_287 = c_model_lag * sub_286 >> 30
        sub_288 = clip_255 - mpy_287
        sub_289 = sub_288 - clip_208
        maximum_290 = c_least_slope if c_least_slope > sub_286 else sub_286
        convert_291 = maximum_290 >> 10
        div_292 = div(sub_289, convert_291, 20)
        clip_293 = div_292 if div_292 < c_time_max else c_time_max
        if clip_293 < c_time_min:
            clip_293 = c_time_min
        sub_294 = clip_255 - clip_293
        clip_295 = sub_294 if sub_294 < c_time_max else c_time_max
        if clip_295 < c_time_0:
            clip_295 = c_time_0
        clip_296 = clip_295 if clip_295 < c_exp_far else c_exp_far
        if clip_296 < c_exp_zero:
            clip_296 = c_exp_zero
        mpy_iqx_297 = clip_296 * c_exp_scale >> 20
        rmpy_298 = mpy_iqx_297 * c_exp_part_0 + 536870912 >> 30
        rmpy_299 = rmpy_298 * c_exp_one + 536870912 >> 30
        sub_300 = c_exp_one - rmpy_299
        rmpy_301 = mpy_iqx_297 * c_exp_part_1 + 536870912 >> 30
        rmpy_302 = rmpy_301 * sub_300 + 536870912 >> 30
        sub_303 = c_exp_one - rmpy_302
        rmpy_304 = mpy_iqx_297 * c_exp_part_2 + 536870912 >> 30
        rmpy_305 = rmpy_304 * sub_303 + 536870912 >> 30
        sub_306 = c_exp_one - rmpy_305
        rmpy_307 = mpy_iqx_297 * c_exp_part_3 + 536870912 >> 30
        rmpy_308 = rmpy_307 * sub_306 + 536870912 >> 30
        sub_309 = c_exp_one - rmpy_308
        rmpy_310 = mpy_iqx_297 * c_exp_part_4 + 536870912 >> 30
        rmpy_311 = rmpy_310 * sub_309 + 536870912 >> 30
        sub_312 = c_exp_one - rmpy_311
        rmpy_313 = mpy_iqx_297 * c_exp_part_5 + 536870912 >> 30
        rmpy_314 = rmpy_313 * sub_312 + 536870912 >> 30
        sub_315 = c_exp_one - rmpy_314
        rmpy_316 = mpy_iqx_297 * sub_315 + 536870912 >> 30
        sub_317 = c_exp_one - rmpy_316
        rmpy_318 = sub_317 * sub_317 + 536870912 >> 30
        rmpy_319 = rmpy_318 * rmpy_318 + 536870912 >> 30
        rmpy_320 = rmpy_319 * rmpy_319 + 536870912 >> 30
        rmpy_321 = rmpy_320 * rmpy_320 + 536870912 >> 30
        rmpy_322 = rmpy_321 * rmpy_321 + 536870912 >> 30
        rmpy_323 = rmpy_322 * rmpy_322 + 536870912 >> 30
        rmpy_324 = rmpy_323 * rmpy_323 + 536870912 >> 30
        rmpy_325 = rmpy_324 * rmpy_324 + 536870912 >> 30
        sub_326 = c_slope_one - rmpy_325
        mpy_327 = c_model_lag * sub_326 >> 30
        sub_328 = clip_295 - mpy_327
        sub_329 = sub_328 - clip_208
        maximum_330 = c_least_slope if c_least_slope > sub_326 else sub_326
        convert_331 = maximum_330 >> 10
        div_332 = div(sub_329, convert_331, 20)
        clip_333 = div_332 if div_332 < c_time_max else c_time_max
        if clip_333 < c_time_min:
            clip_333 = c_time_min
        sub_334 = clip_295 - clip_333
        clip_335 = sub_334 if sub_334 < c_time_max else c_time_max
        if clip_335 < c_time_0:
            clip_335 = c_time_0
        clip_336 = clip_335 if clip_335 < c_exp_far else c_exp_far
        if clip_336 < c_exp_zero:
            clip_336 = c_exp_zero
        mpy_iqx_337 = clip_336 * c_exp_scale >> 20
        rmpy_338 = mpy_iqx_337 * c_exp_part_0 + 536870912 >> 30
        rmpy_339 = rmpy_338 * c_exp_one + 536870912 >> 30
        sub_340 = c_exp_one - rmpy_339
        rmpy_341 = mpy_iqx_337 * c_exp_part_1 + 536870912 >> 30
        rmpy_342 = rmpy_341 * sub_340 + 536870912 >> 30
        sub_343 = c_exp_one - rmpy_342
        rmpy_344 = mpy_iqx_337 * c_exp_part_2 + 536870912 >> 30
        rmpy_345 = rmpy_344 * sub_343 + 536870912 >> 30
        sub_346 = c_exp_one - rmpy_345
        rmpy_347 = mpy_iqx_337 * c_exp_part_3 + 536870912 >> 30
        rmpy_348 = rmpy_347 * sub_346 + 536870912 >> 30
        sub_349 = c_exp_one - rmpy_348
        rmpy_350 = mpy_iqx_337 * c_exp_part_4 + 536870912 >> 30
        rmpy_351 = rmpy_350 * sub_349 + 536870912 >> 30
        sub_352 = c_exp_one - rmpy_351
        rmpy_353 = mpy_iqx_337 * c_exp_part_5 + 536870912 >> 30
        rmpy_354 = rmpy_353 * sub_352 + 536870912 >> 30
        sub_355 = c_exp_one - rmpy_354
        rmpy_356 = mpy_iqx_337 * sub_355 + 536870912 >> 30
        sub_357 = c_exp_one - rmpy_356
        rmpy_358 = sub_357 * sub_357 + 536870912 >> 30
        rmpy_359 = rmpy_358 * rmpy_358 + 536870912 >> 30
        rmpy_360 = rmpy_359 * rmpy_359 + 536870912 >> 30
        rmpy_361 = rmpy_360 * rmpy_360 + 536870912 >> 30
        rmpy_362 = rmpy_361 * rmpy_361 + 536870912 >> 30
        rmpy_363 = rmpy_362 * rmpy_362 + 536870912 >> 30
        rmpy_364 = rmpy_363 * rmpy_363 + 536870912 >> 30
        rmpy_365 = rmpy_364 * rmpy_364 + 536870912 >> 30
        sub_366 = c_slope_one - rmpy_365
        mpy_367 = c_model_lag * sub_366 >> 30
        sub_368 = clip_335 - mpy_367
        sub_369 = sub_368 - clip_208
        maximum_370 = c_least_slope if c_least_slope > sub_366 else sub_366
        convert_371 = maximum_370 >> 10
        div_372 = div(sub_369, convert_371, 20)
        clip_373 = div_372 if div_372 < c_time_max else c_time_max
        if clip_373 < c_time_min:
            clip_373 = c_time_min
        sub_374 = clip_335 - clip_373
        clip_375 = sub_374 if sub_374 < c_time_max else c_time_max
        if clip_375 < c_time_0:
            clip_375 = c_time_0
        mpy_376 = where_204 * c_half >> 30
        mpy_iqx_377 = mpy_376 * clip_375 >> 24
        sub_378 = clip_205 - mpy_iqx_377
        clip_379 = sub_378 if sub_378 < c_fastest else c_fastest
        if clip_379 < c_mean_min:
            clip_379 = c_mean_min
        mpy_iqx_380 = clip_205 * c_model_delay_and_lag >> 24
        mpy_iqx_381 = clip_379 * clip_375 >> 24
        add_382 = mpy_iqx_380 + mpy_iqx_381
        add_383 = clip_375 + c_model_delay
        clip_384 = add_382 if add_382 < c_way_max else c_way_max
        if clip_384 < c_way_min:
            clip_384 = c_way_min
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
        clip_431 = sub_430 if sub_430 < c_far else c_far
        if clip_431 < c_minus_far:
            clip_431 = c_minus_far
        mpy_iqx_432 = clip_431 * c_hold >> 22
        gt_433 = maximum_427 > c_zero
        where_434 = mpy_iqx_432 if gt_433 else c_zero
        clip_435 = where_434 if where_434 < c_pull else c_pull
        if clip_435 < c_minus_pull:
            clip_435 = c_minus_pull
        gt_436 = c_grade_left_0 > left
        add_437 = c_grade_base + c_grade_change_0
        where_438 = add_437 if gt_436 else c_grade_base
        sub_439 = clip_435 - where_438
        sub_440 = sub_439 - state_accel
        clip_441 = sub_440 if sub_440 < c_jerk else c_jerk
        if clip_441 < c_minus_jerk:
            clip_441 = c_minus_jerk
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
        accel = where_454 if where_454 < c_accel_max else c_accel_max
        if accel < c_accel_min:
            accel = c_accel_min
        mpy_iqx_456 = accel * c_mm >> 24
        quantise_457 = mpy_iqx_456 + 32768 >> 16
        mpy_iqx_458 = quantise_457 * c_unit >> 6
        clip_459 = mpy_iqx_458 if mpy_iqx_458 < c_accel_max else c_accel_max
        if clip_459 < c_accel_min:
            clip_459 = c_accel_min
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
        clip_489 = mpy_iqx_178 if mpy_iqx_178 < c_five_1 else c_five_1
        if clip_489 < c_five__1:
            clip_489 = c_five__1
        mpy_iqx_490 = clip_489 * clip_489 >> 8
        sub_491 = mpy_iqx_490 - state_learned_before_variance
        mpy_492 = sub_491 * maximum_488 >> 28
        add_493 = state_learned_before_variance + mpy_492
        clip_494 = add_493 if add_493 < c_variance_max else c_variance_max
        if clip_494 < c_variance_min:
            clip_494 = c_variance_min
        clip_495 = mpy_iqx_178 if mpy_iqx_178 < c_error_max else c_error_max
        if clip_495 < c_minus_error_max:
            clip_495 = c_minus_error_max
        mpy_496 = clip_495 * c_gamma >> 28
        clip_497 = mpy_496 if mpy_496 < c_step_1 else c_step_1
        if clip_497 < c_step__1:
            clip_497 = c_step__1
        add_498 = state_learned_before_offset + clip_497
        clip_499 = add_498 if add_498 < c_offset_1 else c_offset_1
        if clip_499 < c_offset__1:
            clip_499 = c_offset__1
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
        clip_512 = state_learned_before_offset if state_learned_before_offset < c_told_max else c_told_max
        if clip_512 < c_told_min:
            clip_512 = c_told_min
        memory_offset = clip_512 * c_mm >> 24
        convert_514 = quantise_457 << 16
        mpy_iqx_515 = where_461 * c_start_units >> 28
        clip_516 = margin_m if margin_m < c_told_max else c_told_max
        if clip_516 < c_told_min:
            clip_516 = c_told_min
        margin = clip_516 * c_mm >> 24
        clip_518 = f if f < c_told_max else c_told_max
        if clip_518 < c_told_min:
            clip_518 = c_told_min
        stop_distance = clip_518 * c_mm >> 24
        speed_estimate = v_hat * c_mm >> 28
        memory_variance = state_learned_before_variance * c_variance_units >> 32
        quantise_522 = convert_514 + 32768 >> 16
        u = quantise_522 if quantise_522 < c_u_highest else c_u_highest
        if u < c_u_lowest:
            u = c_u_lowest
        quantise_524 = mpy_iqx_515 + 128 >> 8
        start = quantise_524 if quantise_524 < c_start_highest else c_start_highest
        if start < c_start_lowest:
            start = c_start_lowest
        convert_526 = c_one
        valid = convert_526 if convert_526 < c_valid_highest else c_valid_highest
        if valid < c_valid_lowest:
            valid = c_valid_lowest
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
