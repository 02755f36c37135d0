"""Run folders like those of ``railhil run``, made without sockets and processes; changed ones."""

from __future__ import annotations

import fcntl
import hashlib
import json
import tempfile
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

from railhil.bench import local_run
from railhil.judge.events.event import RecordedEvent
from railhil.judge.events.telegrams import events_of
from railhil.judge.folder import write_folder
from railhil.judge.record import Record, checked_record
from railhil.judge.score import Score
from railhil.record.framelog import log_line, read_log
from railhil.record.hash_list import changed_files, listed_files, read_hash_list, write_hash_list
from railhil.record.run_folder import write_inputs
from railhil.record.trace import Trace
from railhil.run.report import as_recorded
from railhil.scenarios.load import load, names
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario


def recorded_folder(scenario: Scenario, folder: Path, *, seed: int = 0, arithmetic: str = "iq") -> Record:
    """One run in this process; its folder has the same files as that of the command."""
    folder.mkdir()
    write_inputs(folder, scenario, None)
    spec = RunSpec(_named(scenario), law=LawSpec(arithmetic=arithmetic), seed=seed)
    run = local_run(scenario, folder, spec)
    result = replace(
        run,
        frames=1,
        wall_time_s=float(seed) + 1.25,
        sim_time_s=9.0,
        first_frame_s=0.5,
        transport=f"railhil:{folder}/hub.sock",
        events=events_of(scenario, run.trace),
    )
    write_folder(result)
    return as_recorded(result)


class SharedRuns:
    """Recorded runs of a scenario by seed and arithmetic, each made once for all processes; read-only.

    :param folder: of all processes.
    """

    def __init__(self, scenario: Scenario, folder: Path) -> None:
        self._scenario = scenario
        self._folder = folder
        self._runs: dict[Path, Record] = {}

    def __call__(self, seed: int, arithmetic: str) -> Record:
        place = self._folder / f"{self._scenario.name}-{seed}-{arithmetic}"
        if place not in self._runs:
            with (self._folder / "recorded.lock").open("w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                if not place.exists():
                    # A run that is not complete, because its test failed or was ended, never has this name.
                    made = Path(tempfile.mkdtemp(dir=self._folder)) / place.name
                    recorded_folder(self._scenario, made, seed=seed, arithmetic=arithmetic)
                    made.rename(place)
            self._runs[place] = checked_record(str(place), None)
        return self._runs[place]

    def changed(self) -> list[Path]:
        """Files of the runs used here that are new, gone or otherwise than recorded."""
        found: list[Path] = []
        for place in self._runs:
            hashes = read_hash_list(place) or {}
            names = {change.name for change in changed_files(place, hashes)} | {*listed_files(place)} - hashes.keys()
            found += (place / name for name in sorted(names))
        return found


def row_of(
    folder: Path,
    certificate: dict[str, Any],
    scenario: AnyScenario,
    trace: Trace,
    score: Score,
    events: tuple[RecordedEvent, ...] = (),
) -> Record:
    """A run of a folder, in which only what the test needs is there, as the report takes it."""
    return Record(folder / "frames.log", scenario, trace, certificate=certificate).copy_with(score=score, events=events)


def _named(scenario: Scenario) -> str:
    """As a command line would name it: one that is not shipped is a file of the user's."""
    is_shipped = scenario.name in names() and load(scenario.name).sha256 == scenario.sha256
    return scenario.name if is_shipped else f"{scenario.name}.toml"


def tampered(folder: Path, address: int, number: int, byte: int) -> int:
    """Change a byte of the frame with this number among those of an identifier, as if recorded so; returns its line."""
    lines, seen, changed = [], 0, 0
    for line, (time_ns, frame) in enumerate(read_log(folder / "frames.log"), 1):
        if frame.can_id == address:
            seen += 1
            if seen == number:
                data = bytearray(frame.data)
                data[byte] ^= 1
                frame, changed = frame._replace(data=bytes(data)), line
        lines.append(log_line(time_ns, frame))
    rewritten(folder, lines)
    return changed


def rewritten(folder: Path, lines: list[str]) -> None:
    """Make these lines the certified record."""
    text = "".join(lines).encode("ascii")
    (folder / "frames.log").write_bytes(text)
    certified(folder, frames_sha256=hashlib.sha256(text).hexdigest())


def certified(folder: Path, **keys: object) -> None:
    """Set keys of the certificate, and the same in the documents beside it, as if the run had been so."""
    path = folder / "certificate.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | keys))
    path = folder / "score.json"
    if path.is_file():
        score = json.loads(path.read_text())
        score["run"] |= {key: value for key, value in keys.items() if key in score["run"]}
        path.write_text(json.dumps(score | {key: value for key, value in keys.items() if key in score}))
    path = folder / "junit.xml"
    if path.is_file():
        tree = ET.parse(path)
        for entry in tree.iter("property"):
            entry.set("value", str(keys.get(entry.get("name", ""), entry.get("value"))))
        tree.write(path, encoding="unicode", xml_declaration=True)
    write_hash_list(folder)
