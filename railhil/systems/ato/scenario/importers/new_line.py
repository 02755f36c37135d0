"""The section ``[line]`` of a new scenario on a line that is in a file of another tool."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError
from railhil.systems.ato.scenario.importers import railml, railtoolkit, ttobench
from railhil.systems.ato.scenario.importers.section import list_begins

#: The run ends at the first stop that is at least this far away.
_RUN_MIN_M = 500.0
_BALISES_BEFORE_STOP_M = (700, 200, 50, 10)
#: Formats by the ending of a file's name; any other is railML.
_FORMATS = {".json": "ttobench", ".yaml": "railtoolkit", ".yml": "railtoolkit"}


@dataclass(frozen=True, slots=True)
class NewLine:
    """Keys of the section, remarks about the stops and the file, and the distance of the run."""

    keys: Mapping[str, object]
    remarks: tuple[str, ...]
    distance_m: float


def read_new_line(source: Path, track_ids: Sequence[str], folder: Path, train: Mapping[str, Any]) -> NewLine:
    """The line of a file; the run on it goes to the first stop that is far enough away.

    :param source: a track of TTOBench (.json), a running path of railtoolkit (.yaml) or railML 3 (any other name).
    :param track_ids: its tracks in the order of running, or its path; none for its only one.
    :param folder: folder of the new scenario; the path to the source is relative to it.
    :param train: the section ``[train]`` of the new scenario.
    :raises InputError: the file is wrong, or has no such tracks.
    """
    chosen: tuple[str, ...] = ()
    kind = _FORMATS.get(source.suffix.lower(), "railml")
    keys: dict[str, object] = {kind: Path(os.path.relpath(source.resolve(), folder.resolve())).as_posix()}
    if kind == "ttobench":
        if track_ids:
            raise InputError("command line", "--track", track_ids[0], "no track: a file of TTOBench has one")
        whole = ttobench.load_line(source)
    elif kind == "railtoolkit":
        if len(track_ids) > 1:
            raise InputError("command line", "--track", " ".join(track_ids), "one path of this file")
        path_id = track_ids[0] if track_ids else None
        keys |= {"path_id": path_id} if path_id else {}
        whole = railtoolkit.load_line(source, train_length_m=train["length_m"], path_id=path_id)
    else:
        limit_kmh = train["speed_limit_kmh"]
        keys |= {"track_ids": list(track_ids)} if track_ids else {}
        keys["default_limit_kmh"] = limit_kmh
        chosen = ("default_limit_kmh is the speed limit of the train",)
        whole = railml.load_line(source, track_ids=track_ids, default_limit_mps=limit_kmh / 3.6)
    stops = whole.stops
    far = [index for index, stop in enumerate(stops) if stop.position_m >= stops[0].position_m + _RUN_MIN_M]
    there = far[0] if far else len(stops) - 1
    distance_m = stops[there].position_m - stops[0].position_m
    keys["from_stop"], keys["to_stop"] = 0, there
    keys["balises_before_stop_m"] = [before_m for before_m in _BALISES_BEFORE_STOP_M if before_m < distance_m]
    listed = tuple(f"stop {index}: {stop.name}, {stop.position_m:g} m" for index, stop in enumerate(stops))
    begins = list_begins(whole.line, stops[0].position_m)
    return NewLine(keys, (*chosen, *listed, *whole.remarks, *begins), distance_m)
