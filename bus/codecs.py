"""Packing of each telegram, bit by bit. Written by ``make dbc`` from the port table; do not edit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")


def encode_time_sync(telegram: Any) -> bytes:
    seconds_s: int = telegram.seconds_s
    fraction_65536th_s: int = telegram.fraction_65536th_s
    rate_10th: int = telegram.rate_10th
    check: int = telegram.check
    state: int = telegram.state
    life: int = telegram.life
    misfit = seconds_s >> 32
    misfit |= fraction_65536th_s >> 16
    misfit |= rate_10th >> 8
    misfit |= check >> 2
    misfit |= state >> 2
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = seconds_s << 32
    word |= fraction_65536th_s << 16
    word |= rate_10th << 8
    word |= check << 6
    word |= state << 4
    word |= life
    return word.to_bytes(8, "big")


def decode_time_sync(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 32 & 0xFFFFFFFF,  # seconds_s
        word >> 16 & 0xFFFF,  # fraction_65536th_s
        word >> 8 & 0xFF,  # rate_10th
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # state
        word & 0xF,  # life
    )


def encode_sup_cmd(telegram: Any) -> bytes:
    command: int = telegram.command
    fault_number: int = telegram.fault_number
    fault_order: int = telegram.fault_order
    check: int = telegram.check
    life: int = telegram.life
    misfit = command >> 8
    misfit |= fault_number >> 8
    misfit |= fault_order >> 2
    misfit |= check >> 2
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = command << 24
    word |= fault_number << 16
    word |= fault_order << 14
    word |= check << 6
    word |= life
    return word.to_bytes(4, "big")


def decode_sup_cmd(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 24 & 0xFF,  # command
        word >> 16 & 0xFF,  # fault_number
        word >> 14 & 0x3,  # fault_order
        word >> 6 & 0x3,  # check
        word & 0xF,  # life
    )


def encode_notch_cmd(telegram: Any) -> bytes:
    notch_256th: int = telegram.notch_256th
    mode: int = telegram.mode
    cause: int = telegram.cause
    check: int = telegram.check
    emergency: int = telegram.emergency
    life: int = telegram.life
    misfit = notch_256th + 0x8000 >> 16
    misfit |= mode >> 3
    misfit |= cause >> 5
    misfit |= check >> 2
    misfit |= emergency >> 2
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = (notch_256th & 0xFFFF) << 16
    word |= mode << 13
    word |= cause << 8
    word |= check << 6
    word |= emergency << 4
    word |= life
    return word.to_bytes(4, "big")


def decode_notch_cmd(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        (word >> 16 & 0xFFFF ^ 0x8000) - 0x8000,  # notch_256th
        word >> 13 & 0x7,  # mode
        word >> 8 & 0x1F,  # cause
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # emergency
        word & 0xF,  # life
    )


def encode_trn_speed(telegram: Any) -> bytes:
    speed_01mmps: int = telegram.speed_01mmps
    check: int = telegram.check
    spare: int = telegram.spare
    life: int = telegram.life
    misfit = speed_01mmps + 0x800000 >> 24
    misfit |= check >> 2
    misfit |= spare >> 2
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = (speed_01mmps & 0xFFFFFF) << 8
    word |= check << 6
    word |= spare << 4
    word |= life
    return word.to_bytes(4, "big")


def decode_trn_speed(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        (word >> 8 & 0xFFFFFF ^ 0x800000) - 0x800000,  # speed_01mmps
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # spare
        word & 0xF,  # life
    )


def encode_trn_pos(telegram: Any) -> bytes:
    odometer_mm: int = telegram.odometer_mm
    effort_bipolar2: int = telegram.effort_bipolar2
    notch_16th: int = telegram.notch_16th
    check: int = telegram.check
    effort_check: int = telegram.effort_check
    life: int = telegram.life
    misfit = odometer_mm + 0x80000000 >> 32
    misfit |= effort_bipolar2 + 0x8000 >> 16
    misfit |= notch_16th + 0x80 >> 8
    misfit |= check >> 2
    misfit |= effort_check >> 2
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = (odometer_mm & 0xFFFFFFFF) << 32
    word |= (effort_bipolar2 & 0xFFFF) << 16
    word |= (notch_16th & 0xFF) << 8
    word |= check << 6
    word |= effort_check << 4
    word |= life
    return word.to_bytes(8, "big")


def decode_trn_pos(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        (word >> 32 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000,  # odometer_mm
        (word >> 16 & 0xFFFF ^ 0x8000) - 0x8000,  # effort_bipolar2
        (word >> 8 & 0xFF ^ 0x80) - 0x80,  # notch_16th
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # effort_check
        word & 0xF,  # life
    )


def encode_plt_stat(telegram: Any) -> bytes:
    power_on: int = telegram.power_on
    pantograph_up: int = telegram.pantograph_up
    main_breaker_closed: int = telegram.main_breaker_closed
    doors_closed_locked: int = telegram.doors_closed_locked
    parking_brake_released: int = telegram.parking_brake_released
    safety_loop_closed: int = telegram.safety_loop_closed
    traction_enabled: int = telegram.traction_enabled
    brake_available: int = telegram.brake_available
    line_voltage_half_percent: int = telegram.line_voltage_half_percent
    fault: int = telegram.fault
    life: int = telegram.life
    misfit = power_on >> 2
    misfit |= pantograph_up >> 2
    misfit |= main_breaker_closed >> 2
    misfit |= doors_closed_locked >> 2
    misfit |= parking_brake_released >> 2
    misfit |= safety_loop_closed >> 2
    misfit |= traction_enabled >> 2
    misfit |= brake_available >> 2
    misfit |= line_voltage_half_percent >> 8
    misfit |= fault >> 4
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = power_on << 30
    word |= pantograph_up << 28
    word |= main_breaker_closed << 26
    word |= doors_closed_locked << 24
    word |= parking_brake_released << 22
    word |= safety_loop_closed << 20
    word |= traction_enabled << 18
    word |= brake_available << 16
    word |= line_voltage_half_percent << 8
    word |= fault << 4
    word |= life
    return word.to_bytes(4, "big")


def decode_plt_stat(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 30 & 0x3,  # power_on
        word >> 28 & 0x3,  # pantograph_up
        word >> 26 & 0x3,  # main_breaker_closed
        word >> 24 & 0x3,  # doors_closed_locked
        word >> 22 & 0x3,  # parking_brake_released
        word >> 20 & 0x3,  # safety_loop_closed
        word >> 18 & 0x3,  # traction_enabled
        word >> 16 & 0x3,  # brake_available
        word >> 8 & 0xFF,  # line_voltage_half_percent
        word >> 4 & 0xF,  # fault
        word & 0xF,  # life
    )


def encode_trk_info(telegram: Any) -> bytes:
    target_mm: int = telegram.target_mm
    target_time_ds: int = telegram.target_time_ds
    speed_limit_4mmps: int = telegram.speed_limit_4mmps
    next_limit_4mmps: int = telegram.next_limit_4mmps
    next_limit_distance_m: int = telegram.next_limit_distance_m
    grade_001permil: int = telegram.grade_001permil
    target_speed_half_mps: int = telegram.target_speed_half_mps
    target_check: int = telegram.target_check
    limit_check: int = telegram.limit_check
    grade_check: int = telegram.grade_check
    life: int = telegram.life
    misfit = target_mm >> 29
    misfit |= target_time_ds >> 19
    misfit |= speed_limit_4mmps >> 16
    misfit |= next_limit_4mmps >> 16
    misfit |= next_limit_distance_m >> 16
    misfit |= grade_001permil + 0x8000 >> 16
    misfit |= target_speed_half_mps >> 8
    misfit |= target_check >> 2
    misfit |= limit_check >> 2
    misfit |= grade_check >> 2
    misfit |= life >> 2
    if misfit:
        raise telegram.misfit()
    word: int = target_mm << 99
    word |= target_time_ds << 80
    word |= speed_limit_4mmps << 64
    word |= next_limit_4mmps << 48
    word |= next_limit_distance_m << 32
    word |= (grade_001permil & 0xFFFF) << 16
    word |= target_speed_half_mps << 8
    word |= target_check << 6
    word |= limit_check << 4
    word |= grade_check << 2
    word |= life
    return word.to_bytes(16, "big")


def decode_trk_info(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 99 & 0x1FFFFFFF,  # target_mm
        word >> 80 & 0x7FFFF,  # target_time_ds
        word >> 64 & 0xFFFF,  # speed_limit_4mmps
        word >> 48 & 0xFFFF,  # next_limit_4mmps
        word >> 32 & 0xFFFF,  # next_limit_distance_m
        (word >> 16 & 0xFFFF ^ 0x8000) - 0x8000,  # grade_001permil
        word >> 8 & 0xFF,  # target_speed_half_mps
        word >> 6 & 0x3,  # target_check
        word >> 4 & 0x3,  # limit_check
        word >> 2 & 0x3,  # grade_check
        word & 0x3,  # life
    )


def encode_ctl_stat(telegram: Any) -> bytes:
    note1: int = telegram.note1
    ladder_level: int = telegram.ladder_level
    overflow_flags: int = telegram.overflow_flags
    note2: int = telegram.note2
    note3: int = telegram.note3
    step_count: int = telegram.step_count
    step_cycles: int = telegram.step_cycles
    telemetry_extreme: int = telegram.telemetry_extreme
    telemetry_index: int = telegram.telemetry_index
    telemetry_maximum: int = telegram.telemetry_maximum
    telemetry_headroom_bits: int = telegram.telemetry_headroom_bits
    telemetry_wrapped: int = telegram.telemetry_wrapped
    telemetry_saturated: int = telegram.telemetry_saturated
    telemetry_zero_division: int = telegram.telemetry_zero_division
    overruns: int = telegram.overruns
    check: int = telegram.check
    ready: int = telegram.ready
    life: int = telegram.life
    misfit = note1 >> 4
    misfit |= ladder_level >> 4
    misfit |= overflow_flags >> 8
    misfit |= note2 >> 16
    misfit |= note3 >> 16
    misfit |= step_count >> 16
    misfit |= step_cycles >> 16
    misfit |= telemetry_extreme + 0x8000 >> 16
    misfit |= telemetry_index >> 7
    misfit |= telemetry_maximum >> 1
    misfit |= telemetry_headroom_bits >> 5
    misfit |= telemetry_wrapped >> 1
    misfit |= telemetry_saturated >> 1
    misfit |= telemetry_zero_division >> 1
    misfit |= overruns >> 8
    misfit |= check >> 2
    misfit |= ready >> 2
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = note1 << 124
    word |= ladder_level << 120
    word |= overflow_flags << 112
    word |= note2 << 96
    word |= note3 << 80
    word |= step_count << 64
    word |= step_cycles << 48
    word |= (telemetry_extreme & 0xFFFF) << 32
    word |= telemetry_index << 25
    word |= telemetry_maximum << 24
    word |= telemetry_headroom_bits << 19
    word |= telemetry_wrapped << 18
    word |= telemetry_saturated << 17
    word |= telemetry_zero_division << 16
    word |= overruns << 8
    word |= check << 6
    word |= ready << 4
    word |= life
    return word.to_bytes(16, "big")


def decode_ctl_stat(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 124 & 0xF,  # note1
        word >> 120 & 0xF,  # ladder_level
        word >> 112 & 0xFF,  # overflow_flags
        word >> 96 & 0xFFFF,  # note2
        word >> 80 & 0xFFFF,  # note3
        word >> 64 & 0xFFFF,  # step_count
        word >> 48 & 0xFFFF,  # step_cycles
        (word >> 32 & 0xFFFF ^ 0x8000) - 0x8000,  # telemetry_extreme
        word >> 25 & 0x7F,  # telemetry_index
        word >> 24 & 0x1,  # telemetry_maximum
        word >> 19 & 0x1F,  # telemetry_headroom_bits
        word >> 18 & 0x1,  # telemetry_wrapped
        word >> 17 & 0x1,  # telemetry_saturated
        word >> 16 & 0x1,  # telemetry_zero_division
        word >> 8 & 0xFF,  # overruns
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # ready
        word & 0xF,  # life
    )


def encode_balise(telegram: Any) -> bytes:
    balise_id: int = telegram.balise_id
    surveyed_mm: int = telegram.surveyed_mm
    odometer_low_mm: int = telegram.odometer_low_mm
    check: int = telegram.check
    spare: int = telegram.spare
    life: int = telegram.life
    misfit = balise_id >> 8
    misfit |= surveyed_mm + 0x80000000 >> 32
    misfit |= odometer_low_mm >> 16
    misfit |= check >> 2
    misfit |= spare >> 2
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = balise_id << 56
    word |= (surveyed_mm & 0xFFFFFFFF) << 24
    word |= odometer_low_mm << 8
    word |= check << 6
    word |= spare << 4
    word |= life
    return word.to_bytes(8, "big")


def decode_balise(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 56 & 0xFF,  # balise_id
        (word >> 24 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000,  # surveyed_mm
        word >> 8 & 0xFFFF,  # odometer_low_mm
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # spare
        word & 0xF,  # life
    )


def encode_trn_watch(telegram: Any) -> bytes:
    level: int = telegram.level
    cause: int = telegram.cause
    age_ms: int = telegram.age_ms
    check: int = telegram.check
    spare: int = telegram.spare
    life: int = telegram.life
    misfit = level >> 3
    misfit |= cause >> 5
    misfit |= age_ms >> 16
    misfit |= check >> 2
    misfit |= spare >> 2
    misfit |= life >> 4
    if misfit:
        raise telegram.misfit()
    word: int = level << 29
    word |= cause << 24
    word |= age_ms << 8
    word |= check << 6
    word |= spare << 4
    word |= life
    return word.to_bytes(4, "big")


def decode_trn_watch(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 29 & 0x7,  # level
        word >> 24 & 0x1F,  # cause
        word >> 8 & 0xFFFF,  # age_ms
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # spare
        word & 0xF,  # life
    )


def encode_sim_truth(telegram: Any) -> bytes:
    position_01mm: int = telegram.position_01mm
    speed_01mmps: int = telegram.speed_01mmps
    check: int = telegram.check
    life: int = telegram.life
    accel_01mmps2: int = telegram.accel_01mmps2
    traction_20n: int = telegram.traction_20n
    brake_20n: int = telegram.brake_20n
    grade_001permil: int = telegram.grade_001permil
    misfit = position_01mm + 0x200000000 >> 34
    misfit |= speed_01mmps + 0x800000 >> 24
    misfit |= check >> 2
    misfit |= life >> 4
    misfit |= accel_01mmps2 + 0x8000 >> 16
    misfit |= traction_20n >> 16
    misfit |= brake_20n >> 16
    misfit |= grade_001permil + 0x8000 >> 16
    if misfit:
        raise telegram.misfit()
    word: int = (position_01mm & 0x3FFFFFFFF) << 94
    word |= (speed_01mmps & 0xFFFFFF) << 70
    word |= check << 68
    word |= life << 64
    word |= (accel_01mmps2 & 0xFFFF) << 48
    word |= traction_20n << 32
    word |= brake_20n << 16
    word |= grade_001permil & 0xFFFF
    return word.to_bytes(16, "big")


def decode_sim_truth(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        (word >> 94 & 0x3FFFFFFFF ^ 0x200000000) - 0x200000000,  # position_01mm
        (word >> 70 & 0xFFFFFF ^ 0x800000) - 0x800000,  # speed_01mmps
        word >> 68 & 0x3,  # check
        word >> 64 & 0xF,  # life
        (word >> 48 & 0xFFFF ^ 0x8000) - 0x8000,  # accel_01mmps2
        word >> 32 & 0xFFFF,  # traction_20n
        word >> 16 & 0xFFFF,  # brake_20n
        (word & 0xFFFF ^ 0x8000) - 0x8000,  # grade_001permil
    )


def encode_run_event(telegram: Any) -> bytes:
    event: int = telegram.event
    instant_01ms: int = telegram.instant_01ms
    position_01mm: int = telegram.position_01mm
    number: int = telegram.number
    misfit = event >> 8
    misfit |= instant_01ms >> 32
    misfit |= position_01mm + 0x800000000000 >> 48
    misfit |= number >> 16
    if misfit:
        raise telegram.misfit()
    word: int = event << 120
    word |= instant_01ms << 64
    word |= (position_01mm & 0xFFFFFFFFFFFF) << 16
    word |= number << 96
    return word.to_bytes(16, "big")


def decode_run_event(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 120 & 0xFF,  # event
        word >> 64 & 0xFFFFFFFF,  # instant_01ms
        (word >> 16 & 0xFFFFFFFFFFFF ^ 0x800000000000) - 0x800000000000,  # position_01mm
        word >> 96 & 0xFFFF,  # number
    )


def encode_speed_sdt(telegram: Any) -> bytes:
    speed_01mmps: int = telegram.speed_01mmps
    tick_high: int = telegram.tick_high
    odometer_mm: int = telegram.odometer_mm
    tick_low: int = telegram.tick_low
    version: int = telegram.version
    ssc: int = telegram.ssc
    code: int = telegram.code
    misfit = speed_01mmps + 0x800000 >> 24
    misfit |= tick_high >> 8
    misfit |= odometer_mm + 0x80000000 >> 32
    misfit |= tick_low >> 16
    misfit |= version >> 8
    misfit |= ssc >> 8
    misfit |= code >> 32
    if misfit:
        raise telegram.misfit()
    word: int = (speed_01mmps & 0xFFFFFF) << 104
    word |= tick_high << 96
    word |= (odometer_mm & 0xFFFFFFFF) << 64
    word |= tick_low << 48
    word |= version << 40
    word |= ssc << 32
    word |= code
    return word.to_bytes(16, "big")


def decode_speed_sdt(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        (word >> 104 & 0xFFFFFF ^ 0x800000) - 0x800000,  # speed_01mmps
        word >> 96 & 0xFF,  # tick_high
        (word >> 64 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000,  # odometer_mm
        word >> 48 & 0xFFFF,  # tick_low
        word >> 40 & 0xFF,  # version
        word >> 32 & 0xFF,  # ssc
        word & 0xFFFFFFFF,  # code
    )


def encode_notch_sdt(telegram: Any) -> bytes:
    notch_256th: int = telegram.notch_256th
    spare: int = telegram.spare
    tick_high: int = telegram.tick_high
    emergency: int = telegram.emergency
    rest: int = telegram.rest
    tick_low: int = telegram.tick_low
    version: int = telegram.version
    ssc: int = telegram.ssc
    code: int = telegram.code
    misfit = notch_256th + 0x8000 >> 16
    misfit |= spare >> 8
    misfit |= tick_high >> 8
    misfit |= emergency >> 2
    misfit |= rest >> 30
    misfit |= tick_low >> 16
    misfit |= version >> 8
    misfit |= ssc >> 8
    misfit |= code >> 32
    if misfit:
        raise telegram.misfit()
    word: int = (notch_256th & 0xFFFF) << 112
    word |= spare << 104
    word |= tick_high << 96
    word |= emergency << 94
    word |= rest << 64
    word |= tick_low << 48
    word |= version << 40
    word |= ssc << 32
    word |= code
    return word.to_bytes(16, "big")


def decode_notch_sdt(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        (word >> 112 & 0xFFFF ^ 0x8000) - 0x8000,  # notch_256th
        word >> 104 & 0xFF,  # spare
        word >> 96 & 0xFF,  # tick_high
        word >> 94 & 0x3,  # emergency
        word >> 64 & 0x3FFFFFFF,  # rest
        word >> 48 & 0xFFFF,  # tick_low
        word >> 40 & 0xFF,  # version
        word >> 32 & 0xFF,  # ssc
        word & 0xFFFFFFFF,  # code
    )


def encode_plt_ident(telegram: Any) -> bytes:
    scenario_hash: int = telegram.scenario_hash
    wire_hash: int = telegram.wire_hash
    seed: int = telegram.seed
    law: int = telegram.law
    role: int = telegram.role
    arithmetic: int = telegram.arithmetic
    indexing: int = telegram.indexing
    perturbed: int = telegram.perturbed
    check: int = telegram.check
    pace: int = telegram.pace
    version: int = telegram.version
    misfit = scenario_hash >> 32
    misfit |= wire_hash >> 32
    misfit |= seed >> 32
    misfit |= law >> 12
    misfit |= role >> 4
    misfit |= arithmetic >> 4
    misfit |= indexing >> 2
    misfit |= perturbed >> 2
    misfit |= check >> 2
    misfit |= pace >> 2
    misfit |= version >> 4
    if misfit:
        raise telegram.misfit()
    word: int = scenario_hash << 96
    word |= wire_hash << 64
    word |= seed << 32
    word |= law << 20
    word |= role << 12
    word |= arithmetic << 16
    word |= indexing << 10
    word |= perturbed << 8
    word |= check << 6
    word |= pace << 4
    word |= version
    return word.to_bytes(16, "big")


def decode_plt_ident(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 96 & 0xFFFFFFFF,  # scenario_hash
        word >> 64 & 0xFFFFFFFF,  # wire_hash
        word >> 32 & 0xFFFFFFFF,  # seed
        word >> 20 & 0xFFF,  # law
        word >> 12 & 0xF,  # role
        word >> 16 & 0xF,  # arithmetic
        word >> 10 & 0x3,  # indexing
        word >> 8 & 0x3,  # perturbed
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # pace
        word & 0xF,  # version
    )


def encode_ctl_ident(telegram: Any) -> bytes:
    scenario_hash: int = telegram.scenario_hash
    wire_hash: int = telegram.wire_hash
    seed: int = telegram.seed
    law: int = telegram.law
    role: int = telegram.role
    arithmetic: int = telegram.arithmetic
    indexing: int = telegram.indexing
    perturbed: int = telegram.perturbed
    check: int = telegram.check
    pace: int = telegram.pace
    version: int = telegram.version
    misfit = scenario_hash >> 32
    misfit |= wire_hash >> 32
    misfit |= seed >> 32
    misfit |= law >> 12
    misfit |= role >> 4
    misfit |= arithmetic >> 4
    misfit |= indexing >> 2
    misfit |= perturbed >> 2
    misfit |= check >> 2
    misfit |= pace >> 2
    misfit |= version >> 4
    if misfit:
        raise telegram.misfit()
    word: int = scenario_hash << 96
    word |= wire_hash << 64
    word |= seed << 32
    word |= law << 20
    word |= role << 12
    word |= arithmetic << 16
    word |= indexing << 10
    word |= perturbed << 8
    word |= check << 6
    word |= pace << 4
    word |= version
    return word.to_bytes(16, "big")


def decode_ctl_ident(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 96 & 0xFFFFFFFF,  # scenario_hash
        word >> 64 & 0xFFFFFFFF,  # wire_hash
        word >> 32 & 0xFFFFFFFF,  # seed
        word >> 20 & 0xFFF,  # law
        word >> 12 & 0xF,  # role
        word >> 16 & 0xF,  # arithmetic
        word >> 10 & 0x3,  # indexing
        word >> 8 & 0x3,  # perturbed
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # pace
        word & 0xF,  # version
    )


def encode_sup_ident(telegram: Any) -> bytes:
    scenario_hash: int = telegram.scenario_hash
    wire_hash: int = telegram.wire_hash
    seed: int = telegram.seed
    law: int = telegram.law
    role: int = telegram.role
    arithmetic: int = telegram.arithmetic
    indexing: int = telegram.indexing
    perturbed: int = telegram.perturbed
    check: int = telegram.check
    pace: int = telegram.pace
    version: int = telegram.version
    misfit = scenario_hash >> 32
    misfit |= wire_hash >> 32
    misfit |= seed >> 32
    misfit |= law >> 12
    misfit |= role >> 4
    misfit |= arithmetic >> 4
    misfit |= indexing >> 2
    misfit |= perturbed >> 2
    misfit |= check >> 2
    misfit |= pace >> 2
    misfit |= version >> 4
    if misfit:
        raise telegram.misfit()
    word: int = scenario_hash << 96
    word |= wire_hash << 64
    word |= seed << 32
    word |= law << 20
    word |= role << 12
    word |= arithmetic << 16
    word |= indexing << 10
    word |= perturbed << 8
    word |= check << 6
    word |= pace << 4
    word |= version
    return word.to_bytes(16, "big")


def decode_sup_ident(made: Callable[..., T], data: bytes) -> T:
    word = int.from_bytes(data)
    return made(
        word >> 96 & 0xFFFFFFFF,  # scenario_hash
        word >> 64 & 0xFFFFFFFF,  # wire_hash
        word >> 32 & 0xFFFFFFFF,  # seed
        word >> 20 & 0xFFF,  # law
        word >> 12 & 0xF,  # role
        word >> 16 & 0xF,  # arithmetic
        word >> 10 & 0x3,  # indexing
        word >> 8 & 0x3,  # perturbed
        word >> 6 & 0x3,  # check
        word >> 4 & 0x3,  # pace
        word & 0xF,  # version
    )


#: Encode and decode of each telegram class.
CODECS: dict[str, tuple[Callable[[Any], bytes], Callable[[Any, bytes], Any]]] = {
    "railhil.bus.telegrams.TimeSync": (encode_time_sync, decode_time_sync),
    "railhil.bus.telegrams.SupCmd": (encode_sup_cmd, decode_sup_cmd),
    "railhil.bus.telegrams.NotchCmd": (encode_notch_cmd, decode_notch_cmd),
    "railhil.bus.telegrams.TrnSpeed": (encode_trn_speed, decode_trn_speed),
    "railhil.bus.telegrams.TrnPos": (encode_trn_pos, decode_trn_pos),
    "railhil.bus.telegrams.PltStat": (encode_plt_stat, decode_plt_stat),
    "railhil.bus.telegrams.TrkInfo": (encode_trk_info, decode_trk_info),
    "railhil.bus.telegrams.CtlStat": (encode_ctl_stat, decode_ctl_stat),
    "railhil.bus.telegrams.BalisePassed": (encode_balise, decode_balise),
    "railhil.bus.telegrams.TrnWatch": (encode_trn_watch, decode_trn_watch),
    "railhil.bus.telegrams.SimTruth": (encode_sim_truth, decode_sim_truth),
    "railhil.bus.telegrams.RunEvent": (encode_run_event, decode_run_event),
    "railhil.bus.safe_telegrams.SpeedSdt": (encode_speed_sdt, decode_speed_sdt),
    "railhil.bus.safe_telegrams.NotchSdt": (encode_notch_sdt, decode_notch_sdt),
    "railhil.bus.ident.PltIdent": (encode_plt_ident, decode_plt_ident),
    "railhil.bus.ident.CtlIdent": (encode_ctl_ident, decode_ctl_ident),
    "railhil.bus.ident.SupIdent": (encode_sup_ident, decode_sup_ident),
}
