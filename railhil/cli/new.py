"""``railhil new line|scenario|law|system|c-controller NAME``: writes starting files that run at once."""

from __future__ import annotations

import argparse
import keyword
import re
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from shlex import quote
from string import Template

from railhil.cli.new_scenario import check_scenario_name, imported_line_file, line_file, scenario_file, stops_file
from railhil.common.command_line import LAW_WITH_POSITION, USUAL_SCENARIO, whole_number
from railhil.common.errors import InputError, OptionError, Words, describe_os_error
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.scenarios.load import load_any
from railhil.scenarios.options import add_option
from railhil.scenarios.system import DEFAULT, system_named
from railhil.scenarios.system import names as system_names

_TEMPLATES = Path(__file__).with_name("templates")
#: Files of each distribution: path and template. The code is in ``src``; otherwise a command run next to the
#: distribution's folder, which has the same name, would import the folder instead of the module.
_FILES = {
    "law": {
        "pyproject.toml": "pyproject.toml",
        "README.md": "README.md",
        "src/$name.py": "law.py",
        "test_$name.py": "checks.py",
    },
    "system": {
        "pyproject.toml": "pyproject.toml",
        "README.md": "README.md",
        "$name.toml": "scenario.toml",
        "src/$name/__init__.py": "init.py",
        "src/$name/ports.toml": "ports.toml",
        "src/$name/wire.py": "wire.py",
        "src/$name/task.py": "task.py",
        "src/$name/plant.py": "plant.py",
        "src/$name/laws.py": "laws.py",
        "src/$name/judge.py": "judge.py",
        "src/$name/panels.py": "panels.py",
        "test_$name.py": "checks.py",
    },
}
#: More stops make a file that nobody wants to edit.
_STOPS_MAX = 60
_NAME = re.compile(r"[a-z](?:[a-z0-9_]{0,38}[a-z0-9])?", re.ASCII)
#: Modules that setuptools and pytest run if they are next to pyproject.toml.
_RUN_BY_OTHERS = ("setup", "conftest")
_COMMANDS = re.compile(r"^```\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("new")
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="KIND")
    law = kinds.add_parser(
        "law",
        help="a control law, as a small distribution",
        examples=["railhil new law mylaw", "railhil new law mylaw --out laws/mylaw"],
    )
    _add(law, "the new law", "DIR", "NAME", _new_law)
    line = kinds.add_parser(
        "line",
        help="a line and a train of your own, as a complete scenario file",
        examples=[
            "railhil new line myline",
            "railhil new line mymetro --stops 6",
            "railhil new line mytrack --from docs/examples/north_south.xml --track t1 t2 t3",
        ],
    )
    _add(line, "the new scenario", "FILE", "NAME.toml", _new_line)
    line.add_argument(
        "--stops",
        type=whole_number(2, _STOPS_MAX),
        metavar="N",
        help="a line with N stops and a timetable: one run over all of them",
    )
    line.add_argument(
        "--from",
        dest="source",
        metavar="FILE",
        type=Path,
        help="take the line from a track of TTOBench (.json), a path of railtoolkit (.yaml) or railML 3 (.xml)",
    )
    line.add_argument(
        "--track",
        dest="track_ids",
        metavar="ID",
        nargs="+",
        default=[],
        help="path, or tracks in the order of running, of that file (default: its only one)",
    )
    scenario = kinds.add_parser(
        "scenario",
        help="a scenario file based on another one, with the usual keys",
        examples=["railhil new scenario myrun --extends yizhuang_05"],
    )
    _add(scenario, "the new scenario", "FILE", "NAME.toml", _new_scenario)
    scenario.add_argument(
        "--extends", metavar="SCENARIO", default="lvshun_tieshan", help="shipped name or TOML file that it changes"
    )
    system = kinds.add_parser(
        "system",
        help="another kind of train and task, as a small distribution",
        examples=["railhil new system mysystem --law hold"],
    )
    _add(system, "the new system", "DIR", "NAME", _new_system)
    system.add_argument("--law", dest="its_law", metavar="NAME", default="hold", help="its law (default: hold)")
    controller = kinds.add_parser(
        "c-controller",
        help="a controller in C, C++ or Python, as a folder",
        examples=["railhil new c-controller mine", "railhil new c-controller mine --python --scenario hst_short"],
    )
    _add(controller, "the new controller", "DIR", "NAME", _new_controller)
    form = controller.add_mutually_exclusive_group()
    form.add_argument("--python", action="store_true", help="in Python, with a test for pytest")
    add_option(form, "--fmu", " (FMI 2.0), built by make fmu")
    add_option(
        controller, "--scenario", ": its system and times are those of the controller", default=USUAL_SCENARIO,
        usual=USUAL_SCENARIO,
    )  # fmt: skip


def _add(
    parser: argparse.ArgumentParser, what: str, kind: str, usual: str, work: Callable[[argparse.Namespace], int]
) -> None:
    parser.add_argument("name", metavar="NAME", help=f"name of {what}")
    add_option(parser, f"--out {kind}", type=Path, usual=usual)
    add_json_argument(parser)
    parser.set_defaults(work=work)


def _new_law(namespace: argparse.Namespace) -> int:
    name = namespace.name
    _check_name("NAME", name)
    _check_not_taken("NAME", name, "law", system_named(DEFAULT).law_names())
    return _distribution(namespace, "law", name)


def _new_system(namespace: argparse.Namespace) -> int:
    _check_name("NAME", namespace.name)
    _check_not_taken("NAME", namespace.name, "system", system_names())
    _check_name("--law", namespace.its_law)
    return _distribution(namespace, "system", namespace.its_law)


def _new_controller(namespace: argparse.Namespace) -> int:
    # Only this command needs the controller's side of the bench.
    from railhil.cli.new_controller import PYTHON_CLASS, controller_files, python_files

    name, folder = namespace.name, namespace.out or Path(namespace.name)
    _check_name("NAME", name)
    if namespace.python:
        made = python_files(name, namespace.scenario)
    else:
        made = controller_files(name, namespace.scenario, fmu=namespace.fmu)
    files = {folder / path: text for path, text in made.items()}
    _write(files)
    shown, check = quote(f"{folder}/"), f"make -C {quote(f'{folder}/')} check"
    if namespace.python:
        shown, check = quote(f"{folder}/{name}.py:{PYTHON_CLASS}"), f"pytest {quote(f'{folder}/')}"
    commands = [f"railhil run {quote(namespace.scenario)} --controller {shown}", check]
    if namespace.fmu:
        built = quote(f"{folder}/build/{name}.fmu")
        commands = [f"make -C {shown} fmu", f"railhil run {quote(namespace.scenario)} --controller {built}", check]
    return _say(namespace, folder, list(files), commands)


def _new_line(namespace: argparse.Namespace) -> int:
    if namespace.track_ids and namespace.source is None:
        raise OptionError("--track", "used only with --from")

    if namespace.stops is not None and namespace.source is not None:
        raise OptionError("--stops", "cannot be given with --from")

    def text_in(folder: Path) -> str:
        if namespace.stops is not None:
            return stops_file(namespace.name, namespace.stops)
        if namespace.source is None:
            return line_file(namespace.name)
        return imported_line_file(namespace.name, namespace.source, namespace.track_ids, folder)

    # The usual law of a line with stops is the one with position.
    options = "" if namespace.stops is not None else f" --controller {LAW_WITH_POSITION}"
    return _scenario(namespace, text_in, options)


def _new_scenario(namespace: argparse.Namespace) -> int:
    base = namespace.extends
    # A line of a user's own is not the one for which the usual law was designed.
    is_own = base.endswith(".toml") and load_any(base).system == DEFAULT
    options = f" --controller {LAW_WITH_POSITION}" if is_own else ""
    return _scenario(namespace, lambda folder: scenario_file(namespace.name, base, folder), options)


def _scenario(namespace: argparse.Namespace, text_in: Callable[[Path], str], options: str = "") -> int:
    """Write a scenario file that can be run.

    :param text_in: its text, for the folder in which it will be.
    :param options: options of the command that is proposed for its first run.
    :raises InputError: the name is invalid or taken, the file has another ending, exists already or cannot be written,
        or what is in it cannot be run: it is not kept.
    """
    check_scenario_name(namespace.name)
    path = namespace.out or Path(f"{namespace.name}.toml")
    if path.suffix != ".toml":
        raise InputError("command line", "--out", str(path), "a file that ends in .toml")
    _write({path: text_in(path.parent)})
    try:
        load_any(path)
    except InputError as error:
        path.unlink()
        cause = getattr(namespace, "source", None) or error.file
        raise InputError(cause, error.key, error.found, error.allowed, error.hint or f"{path} is not written") from None
    shown = quote(str(path))
    return _say(namespace, path, [path], [f"railhil scenarios {shown}", f"railhil run {shown}{options}"])


def _check_name(key: str, name: str) -> None:
    """Refuse a name that cannot be the name of a module and of an entry point."""
    if not _NAME.fullmatch(name) or keyword.iskeyword(name) or name in _RUN_BY_OTHERS:
        allowed = (
            "at most 40 small letters, digits and underscores between a letter and a letter or digit, "
            f"no word of Python, none of {', '.join(_RUN_BY_OTHERS)}"
        )
        raise InputError("command line", key, name, allowed)


def _check_not_taken(key: str, name: str, what: str, taken: list[str]) -> None:
    """Refuse a name that is already installed, or that of a module that would hide the new one."""
    if name in taken:
        raise InputError("command line", key, name, f"a name that no installed {what} has ({', '.join(taken)})")
    spec = find_spec(name)
    # A folder of that name is found too, as a namespace package without a file, but it hides nothing.
    if spec is not None and spec.origin is not None:
        raise InputError("command line", key, name, "a name that no installed module has", f"{spec.origin} has it")


def _distribution(namespace: argparse.Namespace, kind: str, law: str) -> int:
    """Write the files of a law or a system.

    :param law: name of the law in it.
    :raises InputError: the name is already used in the text of the law, or a file cannot be written.
    """
    folder = namespace.out or Path(namespace.name)
    class_name = "".join(word.capitalize() for word in law.split("_"))
    templates = {path: (_TEMPLATES / kind / f"{name}.in").read_text("utf-8") for path, name in _FILES[kind].items()}
    texts = [text for path, text in templates.items() if path.endswith(".py")]
    if keyword.iskeyword(class_name) or any(re.search(rf"\b{class_name}\b", text) for text in texts):
        key = "NAME" if law == namespace.name else "--law"
        raise InputError("command line", key, law, f"another name: {class_name} has another meaning in the new files")
    words = {"name": namespace.name, "law": law, "class_name": class_name}
    files = {Template(path).substitute(words): Template(text).substitute(words) for path, text in templates.items()}
    paths = {folder / path: text for path, text in files.items()}
    _write(paths)
    commands = _COMMANDS.search(files["README.md"])
    assert commands is not None
    return _say(namespace, folder, list(paths), [f"cd {quote(str(folder))}", *commands[1].splitlines()])


def _write(files: Mapping[Path, str]) -> None:
    """Write new files, all of them or none.

    :raises InputError: a file exists already, or cannot be written.
    """
    made: list[Path] = []
    try:
        for path in files:
            if path.is_symlink() or path.exists():
                raise InputError(path, "", Words("exists already"), "a new one (--out says where)")
            above = next(folder for folder in path.parents if folder.exists())
            if not above.is_dir():
                raise InputError(above, "", Words("is a file"), "a folder for the new files")
        for path, text in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("x", encoding="utf-8", newline="\n") as file:
                made.append(path)
                file.write(text)
    except OSError as error:
        for written in made:
            written.unlink()
        why = Words(f"cannot be written: {describe_os_error(error)}")
        raise InputError(path, "", why, "a file that can be written") from None


def _say(namespace: argparse.Namespace, made: Path, files: list[Path], commands: list[str]) -> int:
    if namespace.json:
        print_json({"made": str(made), "files": [str(path) for path in files], "next": commands})
        return 0
    console = Output()
    for path in files:
        console.say(f"wrote {path}")
    for number, line in enumerate(commands):
        console.say(f"{'next:' if number == 0 else '     '} {line}")
    return 0
