"""The help: where to begin, commands in groups, an example of each, former names of options."""

from __future__ import annotations

import re
import shlex
from argparse import SUPPRESS, Action
from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil, complaint
from hil_tests.support.command_parsers import COMMANDS
from hil_tests.support.requirement_lists import reqif_text
from railhil.cli import commands
from railhil.cli.programs import PROGRAMS
from railhil.common.command_line import OneLineParser, accept_former_name
from railhil.controller_node.laws import find
from railhil.controller_node.laws.memory import require_memory
from railhil.scenarios.load import load_any
from railhil.scenarios.options import _DECLARED
from railhil.scenarios.system import names, system_named
from railhil.sequences.plan import SCENARIO

#: Shown width of a terminal that nobody has widened.
_WIDTH = 80


def test_without_a_command_the_first_steps_are_shown_and_nothing_has_passed(here: Railhil) -> None:
    done = here()
    assert (done.exit_code, done.out) == (2, "")
    assert "railhil run --controller ipfc_plus" in done.err
    assert "railhil --help" in done.err


def test_help_is_a_command_as_people_type_it(here: Railhil) -> None:
    assert here("help").out == here("--help").out
    assert here("help", "help").out == here("--help").out
    assert here("help", "score").out == here("score", "--help").out
    assert here("help", "new", "line").out == here("new", "line", "--help").out
    assert "found NOPE, allowed nothing after railhil run" in complaint(here("help", "run", "NOPE"))
    assert "found --json, allowed nothing after railhil run" in complaint(here("help", "run", "--json"))


def test_every_command_stands_in_one_group_and_in_one_line(here: Railhil) -> None:
    text = here("--help").out
    shown = [name for group in commands.GROUPS.values() for name in group]
    assert len(set(shown)) == len(shown)
    assert set(shown) >= set(PROGRAMS)
    for title, group in commands.GROUPS.items():
        lines = text.partition(f"\n{title}:\n")[2].splitlines()[: len(group)]
        assert [line.split()[0] for line in lines] == list(group)
        assert max(map(len, lines)) <= _WIDTH


@pytest.mark.parametrize("name", COMMANDS)
def test_a_help_is_short_and_has_an_example_that_the_command_takes(name: str) -> None:
    parser = COMMANDS[name]
    assert isinstance(parser, OneLineParser)
    text = parser.format_help()
    assert parser.format_help() == text
    assert len(text.partition("\n\n")[0].splitlines()) <= 2, "the usage"
    assert "socketcand" not in text, "interfaces are listed by railhil doctor"
    assert parser.examples
    for example in parser.examples:
        assert f"\n  {example}\n" in text
        if "$(" not in example:
            words = shlex.split(example.partition(" > ")[0])
            own = name.split()
            assert words[: len(own)] == own
            parser.parse_args(words[len(own) :])


@pytest.mark.parametrize("name", ["railhil run", "railhil compare"])
def test_each_option_of_a_long_help_stands_in_a_titled_part(name: str) -> None:
    text = COMMANDS[name].format_help()
    assert "\nwhat is run:\n" in text
    assert re.findall(r"^  (-\S+)", text.partition("\noptions:\n")[2].partition("\n\n")[0], re.MULTILINE) == ["-h,"]


def test_the_default_law_of_each_system_is_named() -> None:
    text = " ".join(COMMANDS["railhil run"].format_help().split())
    for name in names():
        assert re.search(rf"\(default: [^)]*\b{system_named(name).law} of {name}\b", text)


@pytest.mark.parametrize("command", ["railhil run", "railhil scenarios"])
def test_the_systems_and_what_their_runs_are_not_are_named(command: str) -> None:
    text = " ".join(COMMANDS[command].format_help().split())
    for name in names():
        system = system_named(name)
        for sentence in (f"{name} {system.title}", *(system.optional_part("statement") or ())):
            assert sentence in text
    assert "no conformity is claimed" in text


def test_the_help_of_a_command_of_several_shows_the_examples_of_all(here: Railhil) -> None:
    text = here("new", "--help").out
    assert "\n  railhil new law " in text
    assert "\n  railhil new system " in text
    assert "law, line, " in complaint(here("new"))


def test_the_interfaces_are_listed_by_doctor(here: Railhil) -> None:
    assert "socketcan" in here("doctor", "--quick", "--json").json["interfaces"]


#: Examples that work in a folder with a recorded run, in this order.
WORK = ("scenarios", "ports", "score", "replay", "rerun", "verify", "plot", "export", "report")


@pytest.mark.slow
def test_examples_work(here: Railhil, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAILHIL_BUS", "local")
    monkeypatch.setenv("COLUMNS", "120")
    for place in ("runs/mine", "runs/other"):
        assert here("run", "--controller", "ipfc_plus", "--no-report", "--out", place).exit_code == 0
    Path("train.reqif").write_text(
        reqif_text([("ATO-5", "Forwards.", "never true_speed &lt; 0 km/h")]), encoding="utf-8"
    )
    examples = [
        example
        for name in WORK
        for example in COMMANDS[f"railhil {name}"].examples
        if not {"--key", "runs/faults"} & {*shlex.split(example)}
    ]
    assert len(examples) > len(WORK)
    for example in examples:
        done = here(*shlex.split(example)[1:])
        assert done.exit_code == 0, (example, done.err)


def test_an_option_is_known_by_its_former_name(capsys: pytest.CaptureFixture[str]) -> None:
    parser = OneLineParser(prog="railhil some")
    parser.add_argument("--seed", type=int, default=3, metavar="N", help="seed")
    accept_former_name(parser, "--first-seed", "--seed")
    assert parser.parse_args(["--first-seed", "7"]).seed == 7
    line = capsys.readouterr().err
    assert line.startswith("railhil some: --first-seed is called --seed now")
    assert parser.parse_args([]).seed == 3
    assert "first-seed" not in parser.format_help()


@pytest.mark.parametrize("words", [["--seed", "4", "--first-seed", "3"], ["--first-seed", "3", "--seed", "4"]])
def test_an_option_by_both_names_has_one_value(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    parser = OneLineParser(prog="railhil some")
    parser.add_argument("--seed", type=int, default=4, metavar="N", help="seed")
    accept_former_name(parser, "--first-seed", "--seed")
    with pytest.raises(SystemExit):
        parser.parse_args(words)
    assert "--first-seed: found 3, allowed 4" in capsys.readouterr().err
    assert vars(parser.parse_args(["--seed", "5", "--first-seed", "5"])) == {"seed": 5}


def test_choices_of_a_missing_argument_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        COMMANDS["railhil completion"].parse_args([])
    assert "SHELL is missing: one of bash, zsh" in capsys.readouterr().err


#: Words that another command has, or nearly -> what this one has.
MEANT = {
    "campaign --firstseed 3": "--seed?",
    "campaign --controller ipfc": "--laws?",
    "compare --controller ipfc": "--laws?",
    "run --law ipfc": "--controller?",
    "run --laws ipfc": "--controller?",
    "run --scenario hst": "SCENARIO, without --scenario?",
    "tune --laws ipfc": "LAW, without --laws?",
}


@pytest.mark.parametrize("line", MEANT)
def test_an_option_of_another_command_is_told_by_its_name_here(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    name, *words = line.split()
    with pytest.raises(SystemExit):
        COMMANDS[f"railhil {name}"].parse_args(words)
    assert f"did you mean {MEANT[line]}" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["learn", "sequence run"])
def test_the_usual_scenario_of_a_law_that_learns_has_one(name: str) -> None:
    given = COMMANDS[f"railhil {name}"].parse_args([])
    scenario = load_any(given.scenario or SCENARIO, (), ())
    system = scenario.installed_system
    require_memory(system.law, {law: find(law, system.laws) for law in system.law_names()}, scenario)


#: Words of the option that stand for several things, each of which has its term in the field.
SEVERAL = {
    "--port": "a port of the port table, a TCP port, a port of the switch",
    "--out": "a folder or a file, and for exports either",
    "--only": "entries of a catalogue, or a pattern",
}
#: Options whose default depends on the command, which its help says.
OWN_DEFAULT = {
    "--appear-timeout", "--arithmetic", "--bitrate", "--bus", "--channel", "--chunk", "--controller",
    "--data-bitrate", "--fault-logs", "--jobs", "--laws", "--patience", "--realtime-priority", "--runs",
    "--scenario", "--seed", "--seeds",
}  # fmt: skip


def test_an_option_is_the_same_on_every_command() -> None:
    """Name, metavar, default, and the beginning of its text; what a command does with it may follow."""
    found: dict[str, list[Action]] = {}
    for parser in COMMANDS.values():
        for action in parser._actions:
            if action.option_strings and action.help != SUPPRESS:
                found.setdefault(action.option_strings[-1], []).append(action)
    declared = {name: str(given["help"]) for name, given in _DECLARED.items()}
    common = {name: same for name, same in found.items() if len(same) > 1 and name not in SEVERAL}
    assert len(common) > 40
    for name, same in common.items():
        texts = sorted({str(action.help).partition(" (default: ")[0] for action in same}, key=len)
        core = declared.get(name, texts[0])
        assert [text for text in texts if not text.startswith(core)] == [], name
        assert len({(action.metavar, action.nargs, *action.option_strings) for action in same}) == 1, name
        said = {str(action.help).partition(" (default: ")[2] for action in same}
        assert len(said) == 1 or name in OWN_DEFAULT, name


def test_a_default_is_told_in_one_form() -> None:
    texts = [str(action.help) for parser in COMMANDS.values() for action in parser._actions]
    assert [
        text for text in texts if "default" in text and "(default: " not in text and "(default port" not in text
    ] == []
