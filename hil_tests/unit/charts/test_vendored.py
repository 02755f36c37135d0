"""The libraries of the pages are byte for byte as published."""

from __future__ import annotations

import hashlib
from importlib.resources import files


def test_every_file_of_others_has_its_published_digest_and_its_licence() -> None:
    static = files("railhil.charts").joinpath("static")
    listed = dict(line.split()[::-1] for line in static.joinpath("SHA256SUMS").read_text().splitlines())
    ours = {"view.js", "charts.js", "charts.css", "figures.js", "figures.css", "SHA256SUMS"}
    assert set(listed) == {one.name for one in static.iterdir()} - ours
    for name, digest in listed.items():
        assert hashlib.sha256(static.joinpath(name).read_bytes()).hexdigest() == digest, name
    assert {name for name in listed if name.endswith(".LICENSE")} == {"uPlot.LICENSE", "gridstack.LICENSE"}
