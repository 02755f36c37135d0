"""The constants of the exported controller: ports, times, thresholds of the watch, and its part of the handshake."""

from __future__ import annotations

from railhil.bus.ident import Role, make_ident
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import master_word
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import TrnPos, TrnSpeed
from railhil.controller_node import odometer
from railhil.controller_node.arithmetic import make
from railhil.controller_node.cost import cost_of
from railhil.controller_node.export.names import comment
from railhil.controller_node.node import ANSWERS, MAILBOXES
from railhil.controller_node.program.model import LawProgram
from railhil.controller_node.speed_watch import Ladder
from railhil.dbc import Port, wire_contract
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec

_ARITHMETIC = "iq"
_CYCLES_MAX = 0xFFFF
_NS_PER_S = 1_000_000_000


def node_header(name: str, programs: LawProgram, scenario: Scenario, law: LawSpec) -> str:
    """``<law>_node.h``.

    :param name: of the law in C.
    :raises ValueError: the port table has another clock port than the C counts by.
    """
    contract = wire_contract()
    if contract.clock_port.name != TrnSpeed.PORT:
        raise ValueError(f"clock port {contract.clock_port.name}: the C counts time by {TrnSpeed.PORT}")
    received, sent = ([contract.port(telegram.PORT) for telegram in side] for side in (MAILBOXES, ANSWERS))
    ports = [*received, *sent]
    ident = make_ident(Role.CONTROLLER, scenario.sha256, **law.identity).encode()
    guard = f"{name.upper()}_NODE_H"
    return "\n".join(
        [
            f"/* {name}_node.h: what the controller knows of its bus, its scenario and its watch.",
            f" * {comment(f'Law {law.label}, scenario {scenario.name}, {law.set_points}')}.",
            f" * Scenario SHA-256 {scenario.sha256},",
            f" * DBC SHA-256 {contract.sha256}.",
            " * Generated: export again, do not change. Times in simulation time, codes in 1/256 notch.",
            " */",
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            '#include "railhil_mvb.h"',
            "",
            *(f"#define RAILHIL_{key} {value}{f' /* {words} */' if words else ''}" for key, value, words in
              _constants(programs, scenario, law, sent)),
            "",
            "/* Ports: first those with receive mailboxes, then the answers. */",
            "enum {",
            *(f"    RAILHIL_{port.name}," for port in ports),
            "};",
            f"enum {{ RAILHIL_SINK_COUNT = {len(received)} }};",
            "",
            f"static const railhil_port_t railhil_ports[{len(ports)}] = {{",
            *(_port_row(port) for port in ports),
            "};",
            "",
            "/* CTL_IDENT: hashes of scenario and DBC (32 bits each), seed (unknown), law and arithmetic, role and",
            " * indexing, version of the wire. */",
            f"static const unsigned char railhil_ident[{len(ident)}] = {{",
            *(f"    {', '.join(f'0x{octet:02x}' for octet in ident[i : i + 8])}," for i in range(0, len(ident), 8)),
            "};",
            "",
            "#endif",
            "",
        ]
    )  # fmt: skip


def _port_row(port: Port) -> str:
    word = int.from_bytes(master_word(port.f_code, port.address))
    return f"    {{UINT32_C({port.address:#x}), UINT32_C({word:#x}), {port.data_bytes}}}, /* {port.name} */"


def _constants(programs: LawProgram, scenario: Scenario, law: LawSpec, sent: list[Port]) -> list[tuple[str, str, str]]:
    """Name, literal and comment of each number."""
    contract, timing, sensors = wire_contract(), scenario.timing, scenario.sensors
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns)
    ladder = Ladder.of(scenario)
    cycles = min(cost_of(programs, make(_ARITHMETIC), timing.control_period_ns).cycles, _CYCLES_MAX)
    # As the responder of the bench: the polls of the fastest own port count time where the clock port fails.
    paced = [port for port in sent if port.period_ns and schedule.ticks(port.name) <= MAX_STEP]
    words = [(schedule.ticks(port.name), int.from_bytes(master_word(port.f_code, port.address))) for port in paced]
    pace_ticks, pace_word = min(words, default=(0, 0))
    needs_position = programs.track or law.over_distance
    exact = round((odometer.TOLERANCE_M + sensors.odometer_lsb_m) * 1e4) * _NS_PER_S
    speed_error = round((sensors.speed_lsb_mps / 2 + sensors.speed_noise_sigma_mps) * 1e4)
    in_time_ns = schedule.ticks(TrnPos.PORT) * timing.base_tick_ns

    def wide(value: int) -> str:
        return f"INT64_C({value})"

    return [
        ("POLL_ID", f"UINT32_C({contract.poll_id:#x})", "master frames of the bus administrator"),
        ("DEVICE_STATUS_ID", f"UINT32_C({contract.device_status_id:#x})", ""),
        ("DEVICE", f"UINT32_C({int(Role.CONTROLLER)})", "MVB device address"),
        ("BASE_TICK_NS", wide(timing.base_tick_ns), ""),
        ("CLOCK_TICKS", wide(schedule.ticks(TrnSpeed.PORT)), "ticks from one TRN_SPEED to the next"),
        ("PACE_TICKS", wide(pace_ticks), "ticks from one poll of RAILHIL_PACE_WORD to the next, 0: none"),
        ("PACE_WORD", f"UINT32_C({pace_word:#x})", ""),
        ("HOLD_MS", wide(ladder.hold_ms), "ages of the last accepted TRN_SPEED above which a level is entered"),
        ("TRACTION_CUT_MS", wide(ladder.traction_cut_ms), ""),
        ("SERVICE_BRAKE_MS", wide(ladder.service_brake_ms), ""),
        ("EMERGENCY_MS", wide(ladder.emergency_ms), ""),
        ("SERVICE_CODE", wide(ladder.service_code), "full service brake"),
        ("FULL_CODE", wide(ladder.full_code), "greatest notch"),
        ("RAMP_CODE_PER_S", wide(ladder.ramp_code_per_s), "jerk limit of the service brake"),
        ("OVERSPEED_MARGIN_01MMPS", wide(ladder.overspeed_margin_01mmps), "above the limit of TRK_INFO"),
        ("NEEDS_POSITION", str(int(needs_position)), "1: the law brakes without a position"),
        ("POSITION_IN_TIME_NS", wide(in_time_ns), "period of TRN_POS"),
        ("RECKONING_MAX_NS", wide(odometer.RECKONING_MAX_NS), "longest time on a reckoned position"),
        ("FOLLOWING_NS", wide(odometer.FOLLOWING_NS), "time constant to the odometer"),
        ("ODOMETER_EXACT", wide(exact), "tolerance at standstill, 1e-13 m"),
        ("SPEED_ERROR_01MMPS", wide(speed_error), "resolution and noise of the speed"),
        ("ACCEL_MAX_01MMPS2", wide(round(odometer.ACCEL_MAX_MPS2 * 1e4)), ""),
        ("STEP_CYCLES", f"UINT32_C({cycles})", "estimated C28x cycles of a control period, 65535: or more"),
    ]
