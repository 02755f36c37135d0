"""A stranger on the bus of a run: what it sends under the identifier of a port makes the record INVALID."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.cli import Started, railhil
from hil_tests.support.hub import running_hub
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.telegrams import RunEvent, SupCmd
from railhil.dbc import wire_contract
from railhil.wire.ato import NotchCmd, SimTruth, TrnWatch

pytestmark = pytest.mark.faults


def forged(telegram: Telegram) -> list[Frame]:
    return TelegramSource(telegram.port()).frames(telegram.encode())


#: What the stranger sends, each time at the first telegrams of TRN_WATCH (0, 0.16, 0.32 s), and what the verdict says.
TIMES = 3
FORGED: list[tuple[list[Frame], str]] = [
    (forged(SimTruth(19_983, 0)), "9 frames on SIM_TRUTH that the plant did not send, first at 0."),
    (forged(RunEvent(Event.STOPPED, 2, 40_000, 19_983)), "9 frames on RUN_EVENT that the plant did not send"),
    (forged(NotchCmd(7 * 256, life=3)), "3 frames on NOTCH_CMD that the controller did not send, first at 0."),
    (forged(SupCmd(2)), "3 frames on SUP_CMD that the supervisor did not send, first at 0."),
]
POLL = [master_frame(NotchCmd.port().f_code, NotchCmd.port().address)]


def attacked(out: Path, scenario: Path, frames: list[Frame], count: int, *options: str) -> tuple[int, str]:
    """A run on a hub on which a stranger sends; its exit code and its last line."""
    with running_hub() as hub, hub.bus() as stranger:
        run = Started("run", scenario, "--no-report", "--out", out, "-i", "railhil", "-c", hub.channel, *options)
        while run.process.poll() is None:
            for frame in stranger.recv_frames(0.1):
                if frame.can_id == TrnWatch.port().address and count > 0:
                    stranger.send_frames(frames)
                    count -= 1
        done, _ = run.finish()
    return done.exit_code, (done.out + done.err).strip()


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(RUN_2M_TOML)
    return path


@pytest.mark.slow
def test_a_record_with_telegrams_of_a_stranger_is_invalid(tmp_path: Path, scenario: Path) -> None:
    frames = [frame for telegram, _ in FORGED for frame in telegram]
    exit_code, said = attacked(tmp_path / "run", scenario, frames, TIMES)
    assert exit_code == 3, said
    again = railhil("score", tmp_path / "run")
    assert again.exit_code == 3
    for _, words in FORGED:
        assert words in said
        assert words in again.out + again.err
    assert sorted(path.name for path in (tmp_path / "run").glob("*.sent")) == ["controller.sent", "plant.sent"]


@pytest.mark.slow
def test_a_poll_that_is_not_the_plants_makes_the_record_invalid(tmp_path: Path, scenario: Path) -> None:
    exit_code, said = attacked(tmp_path / "run", scenario, POLL, TIMES)
    assert exit_code == 3, said
    assert "3 frames on the identifier of the polls that the plant did not send, first at 0." in said


@pytest.mark.long
@pytest.mark.slow
def test_in_real_time_too(tmp_path: Path, scenario: Path) -> None:
    exit_code, said = attacked(tmp_path / "run", scenario, FORGED[0][0], TIMES, "--pace", "realtime", "--no-rt")
    assert exit_code == 3, said
    assert "frames on SIM_TRUTH that the plant did not send" in said


@pytest.mark.slow
def test_frames_that_belong_to_no_port_change_no_verdict(tmp_path: Path, scenario: Path) -> None:
    free = Frame(0x7E0, b"stranger")
    assert free.can_id not in {can_id for port in wire_contract().ports for can_id in port.can_ids}
    exit_code, said = attacked(tmp_path / "run", scenario, [free], 5)
    assert exit_code in (0, 1), said
    assert not list((tmp_path / "run").glob("*.sent")), "what agrees with the record is not kept"
