"""``railhil export`` of runs with odd texts: every file is written and read back whatever a title says."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

import railhil
from hil_tests.support.cli import Railhil
from hil_tests.support.short_runs import RUN_2M_TOML

TITLES = {
    "slashes": "Line 5/6, up \\\\ down ../..",
    "quotes": "5 \\\" 'x' `y` <b> & ]]> {a} %s",
    "letters": "Zug über Straße 亦庄 🚆 \\u200f\\u202e",
    "long": "x" * 300,
}
CODE = "def step(reading):\n    return 10.8 * (reading.set_point_mps - reading.speed_mps)\n"
FOLDERS = ("a \"b\" <c> & 'd' % ü", "x" * 200, "two  blanks")
FORMATS = ("mf4", "mcap", "parquet", "telegrams", "csv", "blf", "asc", "lichtblick", "plotjuggler", "asammdf")


@pytest.mark.slow
@pytest.mark.long_after(1)
@pytest.mark.parametrize(("title", "folder"), [*zip(TITLES, ("line\nfeed\x07  \t", *FOLDERS), strict=True)])
def test_every_format_holds_every_text(here: Railhil, tmp_path: Path, title: str, folder: str) -> None:
    for library in ("asammdf", "mcap", "pyarrow"):
        pytest.importorskip(library, reason=f"MISSING CAPABILITY {library}")
    place = tmp_path / folder
    place.mkdir()
    text = RUN_2M_TOML.replace('name = "short"', f'name = "short"\ntitle = "{TITLES[title][:200]}"')
    (place / "short.toml").write_text(text, encoding="utf-8")
    (place / "mine.py").write_text(CODE)
    run = railhil.run(place / "short.toml", controller=f"{place}/mine.py:step", out=place / "run")
    done = here(
        "export",
        run.folder,
        *(f"--{name}" for name in FORMATS),
        "--start",
        "2026-11-22T18:42:55Z",
        "--out",
        place / "out",
    )
    assert done.exit_code == 0, done.err
    certificate = json.loads((run.folder / "certificate.json").read_text())
    assert _certificates(place / "out") == [certificate] * 5
    for name in ("lichtblick.json", "run.dspf"):
        json.loads((place / "out" / name).read_text(encoding="utf-8"))
    ElementTree.parse(place / "out" / "plotjuggler.xml")
    for name in ("run.asc", "run.blf"):
        again = here("score", place / "out" / name, "--scenario", place / "short.toml", "--json")
        assert again.json["scores"] == json.loads((run.folder / "score.json").read_text())["scores"]


def _certificates(folder: Path) -> list[object]:
    """The certificate in each format that holds it."""
    import asammdf
    import pyarrow.parquet as pq
    from mcap.reader import make_reader

    with asammdf.MDF(folder / "run.mf4") as file:
        found = [ElementTree.fromstring(file.header.comment).findtext("TX") or ""]
    with (folder / "run.mcap").open("rb") as stream:
        found += [one.metadata["certificate"] for one in make_reader(stream).iter_metadata()]
    for name in ("run.parquet", "telegrams.parquet"):
        found.append(pq.read_schema(folder / name).metadata[b"railhil.certificate"].decode())
    found.append((folder / "run.csv").read_text(encoding="utf-8").partition("\n")[0].removeprefix("# certificate "))
    return [json.loads(text) for text in found]
