"""Small parts of the bus: handshake, exit codes, computed load, the in-process bus."""

from __future__ import annotations

import os
import signal
import zlib
from collections.abc import Callable
from dataclasses import replace

import pytest

from railhil.bus.errors import BusError, BusLost, BusUnavailable, PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.ident import (
    ARITHMETICS,
    INDEXINGS,
    CtlIdent,
    Ident,
    PltIdent,
    Role,
    SupIdent,
    is_perturbed,
    law_code,
    make_ident,
)
from railhil.bus.local import LocalBus
from railhil.bus.schedule import bus_load, longest_frame_bits, telegram_bits
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR, USAGE, ending_signals, exit_code_of, run_guarded
from railhil.dbc import ContractError, wire_contract

SHA_A, SHA_B = "0123456789abcdef" * 4, "fedcba9876543210" * 4

# -- handshake --------------------------------------------------------------------------------------------------------


def idents(sha256: str = SHA_A, **told: str) -> tuple[Ident, Ident, Ident]:
    known = {"controller": "ipfc", "arithmetic": "iq", "indexing": "time", **told}
    return (
        make_ident(Role.PLANT, sha256, seed=7, contract=wire_contract()),
        make_ident(Role.CONTROLLER, sha256, **known, contract=wire_contract()),  # type: ignore[arg-type]
        make_ident(Role.SUPERVISOR, sha256, seed=7, **known, contract=wire_contract()),  # type: ignore[arg-type]
    )


def test_equal_nodes_do_not_differ_and_survive_the_wire() -> None:
    for one in idents():
        again = type(one).decode(one.encode())
        assert again == one
        for other in idents():
            assert one.differences(other) == []
    assert [type(item) for item in idents()] == [PltIdent, CtlIdent, SupIdent]


@pytest.mark.parametrize("other", [1, 2])
def test_another_scenario_is_named_with_both_hashes(other: int) -> None:
    (sentence,) = idents(SHA_A)[0].differences(idents(SHA_B)[other])
    name = ("controller", "supervisor")[other - 1]
    assert sentence == f"scenario differs: plant 01234567, {name} fedcba98"


def test_another_dbc_and_version_are_named_with_both_values() -> None:
    plant, controller, _ = idents()
    other = replace(controller, wire_hash=0xDEADBEEF, version=9)
    ours = wire_contract().sha256[:8]
    assert plant.differences(other) == [
        f"DBC differs: plant {ours}, controller deadbeef",
        f"wire version differs: plant {PltIdent().version:08x}, controller 00000009",
    ]


@pytest.mark.parametrize(
    ("told", "title"),
    [
        ({"controller": "pid"}, "controller"),
        ({"arithmetic": "float64"}, "arithmetic"),
        ({"indexing": "distance"}, "indexing"),
    ],
)
def test_what_the_plant_does_not_know_differs_only_between_the_others(told: dict[str, str], title: str) -> None:
    plant, controller, _ = idents(**told)
    supervisor = idents()[2]
    assert plant.differences(controller) == []
    (sentence,) = supervisor.differences(controller)
    assert sentence.startswith(f"{title} differs: supervisor ")


def test_seed_and_drawing_matter_between_plant_and_supervisor_only() -> None:
    plant, controller, supervisor = idents()
    other_seed = make_ident(Role.SUPERVISOR, SHA_A, seed=8, contract=wire_contract())
    assert plant.differences(other_seed) == ["seed differs: plant 7, supervisor 8"]
    assert controller.differences(other_seed) == []
    drawn = make_ident(Role.SUPERVISOR, SHA_A, seed=7, perturbed=True, contract=wire_contract())
    assert len(plant.differences(drawn)) == 1
    assert (is_perturbed(drawn), is_perturbed(supervisor)) == (True, False)


def test_pace_differs_between_plant_and_supervisor_only() -> None:
    plant = make_ident(Role.PLANT, SHA_A, seed=7, pace="realtime", contract=wire_contract())
    supervisor = make_ident(Role.SUPERVISOR, SHA_A, seed=7, pace="lockstep", contract=wire_contract())
    assert plant.differences(supervisor) == ["pace differs: plant realtime, supervisor lockstep"]
    assert plant.differences(idents()[1]) == []
    assert PltIdent.decode(plant.encode()).pace == 2


def test_a_role_that_is_not_the_ports_own_is_a_difference_and_no_crash() -> None:
    for role in range(16):
        for one in idents():
            strange = replace(one, role=role)
            assert strange.is_own == (role == one.ROLE)
            for other in idents():
                expected = [] if role == one.ROLE else [f"{one.PORT} has role {role}, allowed {one.ROLE.value}"]
                assert other.differences(strange) == strange.differences(other) == expected


def test_codes_fit_their_signals() -> None:
    assert law_code("") == 0
    assert len({law_code(name) for name in ("ipfc", "pid", "ngpc", "ilc")}) == 4
    assert law_code("ipfc") == zlib.crc32(b"ipfc") % 4096
    # A name whose code would say "does not know" is compared like any other.
    assert zlib.crc32(b"law5109") % 4096 == 0
    other, ipfc = (
        make_ident(Role.CONTROLLER, "f" * 64, controller=name, contract=wire_contract()) for name in ("law5109", "ipfc")
    )
    assert CtlIdent.decode(other.encode()) == other
    assert (
        len(make_ident(Role.SUPERVISOR, "f" * 64, controller="law5109", contract=wire_contract()).differences(ipfc))
        == 1
    )
    for arithmetic in ARITHMETICS:
        for indexing in INDEXINGS:
            ident = make_ident(
                Role.CONTROLLER, "f" * 64, arithmetic=arithmetic, indexing=indexing, contract=wire_contract()
            )
            assert CtlIdent.decode(ident.encode()) == ident


# -- exit codes -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (BusUnavailable("x"), USAGE),
        (ContractError("x"), USAGE),
        (InputError("a.toml", "key", 1, "2"), USAGE),
        (BusLost("x"), INVALID),
        (PeerSilent("x"), INVALID),
        (BusError("x"), TOOL_ERROR),
        (ZeroDivisionError("x"), TOOL_ERROR),
    ],
)
def test_exit_code_of_each_error(
    error: Exception, code: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("RAILHIL_TRACEBACK", raising=False)
    assert (PASS, FAIL, USAGE, INVALID, TOOL_ERROR) == (0, 1, 2, 3, 4)
    assert exit_code_of(error) == code
    assert run_guarded("railhil", _raising(error)) == code
    out, err = capsys.readouterr()
    assert out == ""
    kind = f"{type(error).__name__}: " if code == TOOL_ERROR else ""
    assert err == f"railhil: {kind}{error}\n"


def _raising(error: BaseException) -> Callable[[], int]:
    def main() -> int:
        raise error

    return main


@pytest.fixture(autouse=True)
def _signals() -> object:
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def test_one_line_whatever_the_text(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RAILHIL_TRACEBACK", raising=False)
    run_guarded("railhil", _raising(BusLost("two\n  lines")))
    run_guarded("railhil", _raising(ValueError()))
    assert capsys.readouterr().err == "railhil: two lines\nrailhil: ValueError: ValueError\n"


def test_result_and_interrupt() -> None:
    assert run_guarded("railhil", lambda: FAIL) == FAIL
    assert run_guarded("railhil", _raising(KeyboardInterrupt())) == 130


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_signals_that_end_a_command(number: int, code: int) -> None:
    with pytest.raises(SystemExit) as caught:
        run_guarded("railhil", _killing(number))
    assert caught.value.code == code


def test_nohup_is_respected() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    assert run_guarded("railhil", _killing(signal.SIGHUP)) == PASS
    assert signal.SIGHUP not in ending_signals()


def _killing(number: int) -> Callable[[], int]:
    def main() -> int:
        os.kill(os.getpid(), number)
        return PASS

    return main


def test_traceback_for_the_one_who_mends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAILHIL_TRACEBACK", "1")
    with pytest.raises(BusLost):
        run_guarded("railhil", _raising(BusLost("x")))


# -- load -------------------------------------------------------------------------------------------------------------


def test_longest_frames_are_those_of_the_stuffing_rule() -> None:
    assert longest_frame_bits(8) == 135
    assert longest_frame_bits(3) == 85
    for size in range(9):
        # The worst content: after the first five equal bits, one stuff bit per four (ISO 11898-1).
        stuffed = 34 + 8 * size
        assert longest_frame_bits(size) == 47 + 8 * size + 1 + (stuffed - 5) // 4


def test_load_of_the_port_table() -> None:
    contract = wire_contract()
    load = bus_load(contract, 500_000)
    assert load["RUN_EVENT"] == 0
    # TRN_SPEED: one frame of 135 bit per 10 ms; NOTCH_CMD: that and a poll per 20 ms; SIM_TRUTH: three frames.
    assert load["TRN_SPEED"] == pytest.approx(0.027)
    assert load["NOTCH_CMD"] == pytest.approx((135 + 85) * 50 / 500_000)
    assert telegram_bits(contract.port("SIM_TRUTH")) == 3 * 135
    assert sum(load.values()) < 0.40
    assert sum(bus_load(contract, 1_000_000).values()) == pytest.approx(sum(load.values()) / 2)


# -- the in-process bus -----------------------------------------------------------------------------------------------


def test_a_frame_reaches_everybody_before_any_answer_does() -> None:
    heard: list[tuple[str, int]] = []

    def node(name: str, answers: dict[int, int]) -> Callable[[Frame], list[Frame]]:
        def handle(frame: Frame) -> list[Frame]:
            heard.append((name, frame.can_id))
            return [Frame(answers[frame.can_id], b"")] if frame.can_id in answers else []

        return handle

    bus = LocalBus([node("a", {1: 10, 20: 11}), node("b", {1: 20}), node("c", {})])
    bus.send([Frame(1, b""), Frame(2, b"")])
    one = [("a", 1), ("b", 1), ("c", 1)]
    answer_of_a = [("b", 10), ("c", 10)]
    answer_of_b = [("a", 20), ("c", 20)]
    answer_to_that = [("b", 11), ("c", 11)]
    assert heard == [*one, *answer_of_a, *answer_of_b, *answer_to_that, ("a", 2), ("b", 2), ("c", 2)]
    assert [frame.can_id for frame in bus.receive(5.0)] == [10, 20, 11]
    assert bus.receive(None) == []
    bus.close()
