"""``railhil new c-controller NAME``: a folder with a controller in C, which ``make`` builds without railhil, or in
Python."""

from __future__ import annotations

from pathlib import Path
from string import Template
from tempfile import TemporaryDirectory

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.c_controller.around import PREFIX, given_files
from railhil.controller_node.c_controller.fmu import fmu_files
from railhil.controller_node.c_controller.folder import AROUND, TABLE, ControllerFolder
from railhil.controller_node.given.computing import Quantity, Terms
from railhil.controller_node.given.python import PythonFile
from railhil.controller_node.laws import law_class
from railhil.scenarios.given import GivenController
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

_TEMPLATES = Path(__file__).with_name("templates") / "c-controller"
_FILES = {"Makefile": "Makefile", TABLE: TABLE, "README.md": "README.md"}
#: Systems with an example of their own; others get commands of 0.
_EXAMPLES = ("ato",)
#: The class in a file in Python.
PYTHON_CLASS = "Controller"
#: Headers of C99: a file of such a name would hide them.
_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg stdbool stddef stdint
    stdio stdlib string tgmath time wchar wctype
"""


def controller_files(name: str, scenario_text: str, *, fmu: bool = False) -> dict[str, str]:
    """Files of the folder by their paths in it.

    :param name: of the controller, checked to be a name.
    :param scenario_text: shipped name or TOML file; the C around the controller is made for it.
    :param fmu: with the target ``fmu``.
    :raises InputError: the name has another meaning in C, or the scenario cannot be loaded or its system takes no
        controller of a user, or FMPy is missing.
    """
    if name in (PREFIX, *_HEADERS.split()) or name.startswith("railhil"):
        raise InputError("command line", "NAME", name, f"no header of C, not {PREFIX}, not railhil...")
    scenario = load_any(scenario_text)
    system = scenario.installed_system
    if system.export is None and system.interface is None:
        allowed = f"one of a system whose laws are exported as C, not of {system.name}; or with --python"
        raise InputError("command line", "--scenario", scenario_text, allowed)
    with TemporaryDirectory() as draft:
        table = {"name": name, "system": scenario.system}
        Path(draft, TABLE).write_text(_text(TABLE).substitute(table), encoding="utf-8")
        given = ControllerFolder(draft)
        terms = _terms(given, scenario)
        around = given_files(scenario, LawSpec.of_given(given), terms)
    if fmu:
        around |= fmu_files(name, terms, scenario.timing.control_period_ns, "railhil new c-controller --fmu")
    units = {one.name: f" /* {one.unit} */" if one.unit else "" for one in terms.commands}
    commands = "\n".join(f"    out->{command} = 0.0f;{unit}" for command, unit in units.items())
    words = {**table, "macro": name.upper(), "scenario": scenario_text, "commands": commands}
    kind = scenario.system if scenario.system in _EXAMPLES else "plain"
    templates = _FILES | {f"{name}.c": f"{kind}.c", f"test_{name}.c": f"{kind}_checks.c"}
    files = {path: _text(file).substitute(words) for path, file in templates.items()}
    return files | {f"{AROUND}/{file}": text for file, text in around.items()}


def python_files(name: str, scenario_text: str) -> dict[str, str]:
    """Files of a folder with a controller in Python, by their paths in it.

    :raises InputError: the scenario cannot be loaded, or its system takes no controller of a user.
    """
    scenario = load_any(scenario_text)
    terms = _terms(PythonFile(f"{name}.py:{PYTHON_CLASS}"), scenario)
    table = ["Readings:", *map(_line, terms.readings), "Commands:", *map(_line, terms.commands)]
    is_example = scenario.system in _EXAMPLES
    words = {
        "name": name,
        # A scenario file is named as on the command line, also where the tests run.
        "scenario": repr(str(Path(scenario_text).resolve()) if scenario_text.endswith(".toml") else scenario_text),
        "table": "\n".join(table),
        "period_s": repr(terms.period_s),
        **{f"{one.name}_max": one.largest for one in terms.commands},
        **{f"{one.name}_step": one.step for one in terms.commands},
        "commands": "\n".join(f'            "{one.name}": 0.0,' for one in terms.commands),
        "verdicts": '("PASS",)' if is_example else '("PASS", "FAIL")',
    }
    templates = {f"{name}.py": f"{scenario.system if is_example else 'plain'}.py", f"test_{name}.py": "checks.py"}
    return {path: _text(file).substitute(words) for path, file in templates.items()}


def _line(one: Quantity) -> str:
    return f"    {one.name:20} {one.unit or '-'}".rstrip()


def _terms(given: GivenController, scenario: AnyScenario) -> Terms:
    law = LawSpec.of_given(given)
    found: Terms = law_class(law, scenario)(make(law.arithmetic), scenario).terms
    return found


def _text(file: str) -> Template:
    return Template((_TEMPLATES / f"{file}.in").read_text("utf-8"))
