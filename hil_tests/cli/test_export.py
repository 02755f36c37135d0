"""``railhil export``: files that asammdf, python-can, mcap and pyarrow read back, with the values of signals.csv."""

from __future__ import annotations

import json
import struct
from datetime import datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import can
import numpy as np
import numpy.typing as npt
import pytest

import railhil
from hil_tests.support.cli import Done, Railhil
from railhil.bus.frame import from_message
from railhil.bus.ros2 import ros_name
from railhil.dbc import wire_contract
from railhil.record.framelog import log_sha256, read_log
from railhil.record.trace import trace_of
from railhil.report.files.content import Content

START = "2026-11-22T18:42:55+01:00"
START_S = 1_795_369_375
LAYOUTS = ("lichtblick.json", "plotjuggler.xml", "run.dspf")
FILES = (*LAYOUTS, "run.mf4", "run.mcap", "run.parquet", "telegrams.parquet", "run.csv", "run.blf", "run.asc")
#: Short runs of every shipped system.
RUNS = {
    "ato": (
        "lvshun_tieshan", "tpfc1",
        ("target.nodes_s_mps2=[[0, 0.5], [1.9, 0.5], [2.1, -0.5], [4, -0.5]]", "plan.distance_m=1.9983",
         "plan.running_time_s=4", "plan.overtime_max_s=1"),
        ("TRN_SPEED loss 50% @1s for 1s",),
    ),
    "hst1": ("hst_short", "pid", ("task.duration_s=3",), ()),
    "emu3": ("emu3_short", "pid", ("task.duration_s=3",), ()),
    "stop": ("yizhuang_stop", "one_shot", ("task.duration_s=4",), ()),
}  # fmt: skip


@pytest.fixture(scope="module", params=RUNS)
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> railhil.Outcome:
    scenario, law, settings, faults = RUNS[request.param]
    return railhil.run(
        scenario, controller=law, arithmetic="float64", settings=settings, faults=faults,
        out=tmp_path_factory.mktemp(request.param) / "run",
    )  # fmt: skip


def _export(here: Railhil, run: railhil.Outcome, *words: str) -> Path:
    done = here("export", run.folder, *words, "--start", START, "--out", "files")
    assert done.exit_code == 0, done.err
    return Path("files")


def _columns(run: railhil.Outcome) -> dict[str, npt.NDArray[np.float64]]:
    path = run.folder / "signals.csv"
    names = path.read_text().partition("\n")[0].split(",")
    return dict(zip(names, np.loadtxt(path, delimiter=",", skiprows=1).T, strict=True))


def _same_as_printed(found: npt.NDArray[np.float64], printed: npt.NDArray[np.float64]) -> None:
    np.testing.assert_array_equal([float(f"{value:.10g}") for value in found], printed)


@pytest.mark.long_after(1)
@pytest.mark.slow
def test_two_exports_are_equal(here: Railhil, run: railhil.Outcome, monkeypatch: pytest.MonkeyPatch) -> None:
    import asammdf.blocks.v4_blocks as blocks
    import can.io.asc

    words = (
        "--mf4",
        "--mcap",
        "--parquet",
        "--telegrams",
        "--csv",
        "--blf",
        "--asc",
        "--lichtblick",
        "--plotjuggler",
        "--asammdf",
    )
    place = _export(here, run, *words)
    first = {name: (place / name).read_bytes() for name in FILES}
    # A minute later.
    now = blocks.time.time()
    monkeypatch.setattr(blocks.time, "time", lambda: now + 60)
    later = SimpleNamespace(now=lambda: datetime.fromtimestamp(now + 60), fromtimestamp=datetime.fromtimestamp)
    monkeypatch.setattr(can.io.asc, "datetime", later)
    _export(here, run, *words)
    assert {name: (place / name).read_bytes() == content for name, content in first.items()} == dict.fromkeys(
        FILES, True
    )


@pytest.mark.long_after(2)
def test_mf4_is_read_by_asammdf_and_python_can(here: Railhil, run: railhil.Outcome) -> None:
    from asammdf import MDF

    path = _export(here, run, "--mf4") / "run.mf4"
    with MDF(path, process_bus_logging=False) as file:
        assert json.loads(file.header.description) == run.certificate
        assert file.header.abs_time == START_S * 10**9
        places = {group.channel_group.acq_name: at for at, group in enumerate(file.groups)}
        for port in run.trace.contract.ports:
            if not run.trace.count(port.name):
                assert port.name not in places
                continue
            for entry in port.signals:
                found = file.get(entry.name, group=places[port.name], raw=True)
                np.testing.assert_array_equal(found.samples, run.trace.values(port.name, entry.name))
                np.testing.assert_array_equal(found.timestamps, run.trace.times_s(port.name))
                assert found.unit == entry.unit
        columns = _columns(run)
        for name in columns.keys() - {"time_s"}:
            found = file.get(name, group=places["signals"])
            _same_as_printed(found.samples, columns[name])
            assert found.unit == run.signals.units[name]
            (commented,) = [one for one in file.groups[places["signals"]].channels if one.name == name]
            assert commented.comment == found.comment == Content(run).comments[name] != ""
        (attached,) = {bytes(attachment.extract()) for attachment in file.attachments}
        assert attached == (run.folder / "railhil.dbc").read_bytes()
    with MDF(path, process_bus_logging=False) as file:
        extracted = file.extract_bus_logging({"CAN": [(str(run.folder / "railhil.dbc"), 0)]})
        names = {channel.name: at for at, group in enumerate(extracted.groups) for channel in group.channels}
        decoded = [(port.name, entry.name) for port in run.trace.contract.ports for entry in port.signals]
        compared = [(port, name) for port, name in decoded if run.trace.count(port) and run.trace.raw(port, name).any()]
        assert len(compared) > 20
        for port, name in compared:
            found = extracted.get(name, group=names[name], raw=True)
            scale = next(item.scale for item in run.trace.contract.port(port).signals if item.name == name)
            physical = found.samples if found.conversion is None else found.samples * scale
            np.testing.assert_allclose(physical, run.trace.values(port, name), rtol=1e-12)
    messages = list(can.LogReader(path))
    logged = list(read_log(run.folder / "frames.log"))
    assert [from_message(message) for message in messages] == [frame for _, frame in logged]
    assert [message.timestamp - START_S for message in messages] == pytest.approx(
        [time_ns / 1e9 for time_ns, _ in logged], abs=1e-6
    )


def test_value_tables_are_words_in_mf4(here: Railhil, run: railhil.Outcome) -> None:
    from asammdf import MDF

    with MDF(_export(here, run, "--mf4") / "run.mf4", process_bus_logging=False) as file:
        (at,) = [at for at, group in enumerate(file.groups) if group.channel_group.acq_name == "RUN_EVENT"]
        entry = next(item for item in run.trace.contract.port("RUN_EVENT").signals if item.name == "RunEvent")
        wanted = [entry.values[raw] for raw in run.trace.raw("RUN_EVENT", "RunEvent").tolist() if raw in entry.values]
        found = file.get("RunEvent", group=at).samples.tolist()
        assert [text.decode() for text in found if isinstance(text, bytes) and not text.isdigit()][
            : len(wanted)
        ] == wanted


def _message(schema: str, payload: bytes) -> dict[str, float]:
    """A flat CDR message, by the rules of its own ``ros2msg`` schema."""
    codes = {"8": "b", "16": "h", "32": "i", "64": "q"}
    found, place = {}, 4
    for line in schema.splitlines():
        kind, name = line.partition("#")[0].split()
        bits = kind.strip("abcdefghijklmnopqrstuvwxyz")
        code = {"float64": "d"}.get(kind) or (codes[bits].upper() if kind.startswith("u") else codes[bits])
        size = int(bits) // 8
        place = 4 + -(-(place - 4) // size) * size
        (found[name],) = struct.unpack_from(f"<{code}", payload, place)
        place += size
    assert place == len(payload)
    return found


def test_mcap_is_read_by_mcap(here: Railhil, run: railhil.Outcome) -> None:
    from mcap.reader import make_reader

    rows: dict[str, list[tuple[int, dict[str, float]]]] = {}
    with (_export(here, run, "--mcap") / "run.mcap").open("rb") as stream:
        reader = make_reader(stream)
        (facts,) = reader.iter_metadata()
        (attached,) = reader.iter_attachments()
        for schema, channel, message in reader.iter_messages():
            assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
            values = _message(schema.data.decode(), message.data)
            rows.setdefault(channel.topic, []).append((message.log_time - START_S * 10**9, values))
    assert json.loads(facts.metadata["certificate"]) == run.certificate
    assert attached.data == (run.folder / "railhil.dbc").read_bytes()
    columns = _columns(run)
    signals = rows.pop("/railhil/signals")
    assert [time_ns for time_ns, _ in signals] == [round(time_s * 1e9) for time_s in columns["time_s"]]
    for name, printed in columns.items():
        _same_as_printed(np.array([values[ros_name(name)] for _, values in signals]), printed)
    ports = [port for port in run.trace.contract.ports if run.trace.count(port.name)]
    assert sorted(rows) == sorted(f"/telegrams/{ros_name(port.name)}" for port in ports)
    for port in ports:
        found = rows[f"/telegrams/{ros_name(port.name)}"]
        assert [time_ns for time_ns, _ in found] == list(run.trace.times_ns(port.name))
        for entry in port.signals:
            wanted = run.trace.values(port.name, entry.name).tolist()
            assert [values[ros_name(entry.name)] for _, values in found] == wanted


def test_tables_have_values_units_and_certificate(here: Railhil, run: railhil.Outcome) -> None:
    import pyarrow.parquet as pq

    place, columns = _export(here, run, "--parquet", "--csv"), _columns(run)
    table = pq.read_table(place / "run.parquet")
    lines = (place / "run.csv").read_text(encoding="utf-8").splitlines()
    assert json.loads(table.schema.metadata[b"railhil.certificate"]) == run.certificate
    assert table.schema.metadata[b"railhil.frames_sha256"].decode() == run.frames_sha256
    assert json.loads(lines[0].removeprefix("# certificate ")) == run.certificate
    units = json.loads(lines[1].removeprefix("# units "))
    for name, printed in columns.items():
        _same_as_printed(table[name].to_numpy(), printed)
        assert units[name] == table.schema.field(name).metadata[b"unit"].decode() == run.signals.units[name]
    assert [line.partition(",")[2] for line in lines[2:]] == (run.folder / "signals.csv").read_text().splitlines()
    assert lines[3].startswith("2026-11-22T17:42:55.000000Z,")
    instants = table["time_utc"].to_pylist()
    assert instants[0].isoformat() == "2026-11-22T17:42:55+00:00"


def test_each_telegram_is_a_row_of_parquet(here: Railhil, run: railhil.Outcome) -> None:
    import pyarrow.parquet as pq

    table = pq.read_table(_export(here, run, "--telegrams") / "telegrams.parquet")
    assert table.schema.metadata[b"railhil.frames_sha256"].decode() == run.frames_sha256
    ports, times_s = np.array(table["port"].to_pylist()), table["time_s"].to_numpy()
    trace = run.trace
    assert len(table) == sum(trace.count(port.name) for port in trace.contract.ports)
    for port in trace.contract.ports:
        own = ports == port.name
        np.testing.assert_array_equal(np.flatnonzero(own), trace.order(port.name))
        np.testing.assert_array_equal(times_s[own], trace.times_s(port.name))
        for signal in port.signals if own.any() else ():
            column, field = table[f"{port.name}.{signal.name}"], table.schema.field(f"{port.name}.{signal.name}")
            assert column.null_count == len(table) - own.sum()
            np.testing.assert_array_equal(column.filter(own).to_numpy(), trace.values(port.name, signal.name))
            assert (field.metadata[b"unit"].decode(), field.metadata[b"comment"].decode()) == (
                signal.unit, signal.comment
            )  # fmt: skip
            words = json.loads(field.metadata.get(b"values", b"{}"))
            assert words == {str(value): word for value, word in signal.values.items()}


def test_blf_begins_at_the_start(here: Railhil, run: railhil.Outcome) -> None:
    messages = list(can.LogReader(_export(here, run, "--blf") / "run.blf"))
    logged = list(read_log(run.folder / "frames.log"))
    assert [from_message(message) for message in messages] == [frame for _, frame in logged]
    assert [message.timestamp - START_S for message in messages] == pytest.approx(
        [time_ns / 1e9 for time_ns, _ in logged], abs=2e-6
    )


def test_asc_is_read_by_python_can_and_by_us(here: Railhil, run: railhil.Outcome) -> None:
    path = _export(here, run, "--asc") / "run.asc"
    messages = list(can.LogReader(path))
    logged = list(read_log(run.folder / "frames.log"))
    assert [from_message(message) for message in messages] == [frame for _, frame in logged]
    assert [round(message.timestamp * 1e6) for message in messages] == [time_ns // 1000 for time_ns, _ in logged]
    # Its times are those of the run, whenever that began.
    assert log_sha256(path) == run.frames_sha256
    head = path.read_text().splitlines()[:9]
    assert head[0] == "date Sun Nov 22 17:42:55.000 2026"
    assert f"// railhil frames_sha256: {run.frames_sha256}" in head
    (run.folder / "RUN.ASC").write_bytes(path.read_bytes())
    assert here("score", run.folder / "RUN.ASC", "--json").out == here("score", run.folder, "--json").out
    (run.folder / "RUN.ASC").unlink()


def _leaves(tree: Any) -> list[str]:
    return [tree] if isinstance(tree, str) else _leaves(tree["first"]) + _leaves(tree["second"])


def test_layouts_show_each_column_of_the_files_once(here: Railhil, run: railhil.Outcome) -> None:
    from asammdf import MDF
    from mcap.reader import make_reader

    words = ("--mcap", "--mf4", "--lichtblick", "--plotjuggler", "--asammdf")
    place, columns = _export(here, run, *words), sorted(run.signals)
    columns.remove("time_s")
    with (place / "run.mcap").open("rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        assert summary is not None
        (channel,) = [one for one in summary.channels.values() if one.topic == "/railhil/signals"]
        lines = summary.schemas[channel.schema_id].data.decode().splitlines()
    fields = sorted(f"{channel.topic}.{line.split()[1]}" for line in lines if line.split()[1] != "time_s")
    # Lichtblick: a panel for each leaf of the layout.
    layout = json.loads((place / "lichtblick.json").read_text(encoding="utf-8"))
    assert sorted(_leaves(layout["layout"])) == sorted(layout["configById"])
    shown = [path["value"] for plot in layout["configById"].values() for path in plot["paths"]]
    assert sorted(shown) == fields
    # PlotJuggler: its reader takes as many children of a splitter as "count" says, and as many sizes.
    root = ElementTree.parse(place / "plotjuggler.xml").getroot()
    for splitter in root.iter("DockSplitter"):
        assert int(splitter.attrib["count"]) == len(splitter) == len(splitter.attrib["sizes"].split(";"))
    assert sorted(curve.attrib["name"].replace("signals/", "signals.") for curve in root.iter("curve")) == fields
    (loaded,) = root.iter("fileInfo")
    assert (place / loaded.attrib["filename"]).is_file()
    # asammdf: the channels of its file.
    windows = json.loads((place / "run.dspf").read_text(encoding="utf-8"))["windows"]
    channels = [channel for window in windows for channel in window["configuration"]["channels"]]
    assert sorted(channel["name"] for channel in channels) == columns
    with MDF(place / "run.mf4", process_bus_logging=False) as file:
        found = file.select([channel["name"] for channel in channels])
        assert [signal.unit for signal in found] == [channel["unit"] for channel in channels]


@pytest.fixture(scope="module")
def one(tmp_path_factory: pytest.TempPathFactory) -> railhil.Outcome:
    scenario, law, settings, _ = RUNS["ato"]
    return railhil.run(scenario, controller=law, settings=settings, out=tmp_path_factory.mktemp("one") / "run")


def test_without_a_start_the_times_are_those_of_the_run(here: Railhil, one: railhil.Outcome) -> None:
    import pyarrow.parquet as pq
    from mcap.reader import make_reader

    done = here("export", one.folder, "--parquet", "--csv", "--mcap")
    assert done == Done(0, "".join(f"{one.folder / f'run.{kind}'}\n" for kind in ("mcap", "parquet", "csv")), "")
    assert pq.read_table(one.folder / "run.parquet").schema.names[0] == "time_s"
    assert (one.folder / "run.csv").read_text().splitlines()[2].startswith("time_s,")
    with (one.folder / "run.mcap").open("rb") as stream:
        assert next(make_reader(stream).iter_messages())[2].log_time == 0


def test_one_format_can_be_given_its_file(here: Railhil, one: railhil.Outcome) -> None:
    assert here("export", one.folder, "--csv", "--out", "a.csv") == Done(0, "a.csv\n", "")
    assert here("export", one.folder, "--csv", "--out", "a") == Done(0, "a/run.csv\n", "")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            (),
            "command line: format: missing, expected one or more of --mf4, --mcap, --parquet, --telegrams, --csv",
        ),
        (("--blf",), "--blf: no --start"),
        (
            ("--csv", "--start", "2026-11-22T18:42:55"),
            "--start: found '2026-11-22T18:42:55', allowed date and time with",
        ),
        (("--csv", "--start", "yesterday"), "--start: found 'yesterday', allowed date and time with its zone"),
        (("--csv", "--start", "1970-01-01T00:00:00Z"), "--start: found '1970-01-01T00:00:00Z', allowed date and time"),
        (("--csv", "--out", " "), "--out: found ' ', allowed name of a folder or file"),
        (("--csv", "--out", "/proc/1"), "--out: the file /proc/1/run.csv cannot be written"),
    ],
)
def test_what_is_refused(here: Railhil, one: railhil.Outcome, words: tuple[str, ...], message: str) -> None:
    done = here("export", one.folder, *words)
    assert done.exit_code == 2
    assert message in done.err
    assert done.err.count("\n") == 1


def test_a_log_without_its_certificate_is_refused(here: Railhil, one: railhil.Outcome, tmp_path: Path) -> None:
    for name in ("frames.log", "scenario.json"):
        (tmp_path / name).write_bytes((one.folder / name).read_bytes())
    done = here("export", tmp_path, "--csv")
    assert done.exit_code == 2
    assert "certificate.json: does not exist" in done.err


def test_frames_of_every_kind_come_back_from_mf4(one: railhil.Outcome, tmp_path: Path) -> None:
    from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
    from railhil.judge.record import Record
    from railhil.record.framelog import log_line
    from railhil.report.files.mf4_file import write_mf4

    frames = [
        Frame(0x123, b"\1\2"), Frame(0x1234567, b"\3" * 8, EXTENDED), Frame(0x105, bytes(range(48)), FD | BRS),
        Frame(0x110, b"", REMOTE), Frame(0, bytes(8), ERROR), Frame(0x110, b""),
    ]  # fmt: skip
    log = tmp_path / "frames.log"
    log.write_text("".join(log_line(20_000_000 * at, frame) for at, frame in enumerate(frames)))
    record = Record(log, one.scenario, trace_of(read_log(log), wire_contract()), certificate={"notes": None})
    write_mf4(Content(record), tmp_path / "run.mf4")
    found = {round(message.timestamp % 1, 6): from_message(message) for message in can.LogReader(tmp_path / "run.mf4")}
    wanted = dict(enumerate(frames))
    assert {round(time_s / 0.02): frame for time_s, frame in found.items() if not frame.flags & ERROR} == {
        at: frame for at, frame in wanted.items() if not frame.flags & ERROR
    }
    assert found[0.08].flags & ERROR
