"""``railhil new line --from``: a scenario on a line of another tool's file, which runs as it is."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from hil_tests.support.cli import complaint
from hil_tests.support.paths import ROOT, TEST_DATA

RAILML = ROOT / "docs" / "examples" / "north_south.xml"
FILES = {
    "ttobench": (TEST_DATA / "ttobench" / "two_tunnels.json", [], "# not used of its file: curvatures, tunnels"),
    "railtoolkit": (TEST_DATA / "railtoolkit" / "paths" / "valley_2024_07.yaml", [], "# stop 1: Mill, 221 m"),
    "railml": (RAILML, ["--track", "t1", "t2", "t3"], "# level where its file has no gradient: 1900 to 2200 m"),
}


@pytest.mark.parametrize("kind", FILES)
def test_a_line_of_a_file_is_a_pass_by_the_commands_that_are_proposed(kind, here, tmp_path):
    source, options, note = FILES[kind]
    proposed = here("new", "line", "mine", "--from", source, *options, "--json").json["next"]
    lines = (tmp_path / "mine.toml").read_text(encoding="utf-8").splitlines()
    assert note in lines
    assert next(line for line in lines if line.startswith(f"{kind} = ")).endswith(f'/{source.name}"')
    for command in proposed:
        words = shlex.split(command)[1:]
        if words[0] == "run":
            words += ["--bus", "local", "--no-report", "--out", "run"]
        assert here(*words).exit_code == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--track", "t1"], "--track: used only with --from"),
        (["--from", "nothing.json"], "nothing.json: does not exist"),
        (["--from", str(RAILML)], "line.track_ids: no choice among several, expected some of t1, t2, t3"),
        (["--from", str(FILES["ttobench"][0]), "--track", "a"], "--track: found 'a', allowed no track"),
        (["--from", str(FILES["railtoolkit"][0]), "--track", "hill"], "paths id: found 'hill', allowed one of valley"),
    ],
)
def test_a_file_without_a_line_is_one_line(words, said, here, tmp_path: Path):
    assert said in complaint(here("new", "line", "mine", *words))
    assert not (tmp_path / "mine.toml").exists()
