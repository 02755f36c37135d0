"""``railhil new c-controller NAME``: a folder with a controller in C, which ``make`` builds without railhil."""

from __future__ import annotations

from pathlib import Path
from string import Template
from tempfile import TemporaryDirectory

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.c_controller.around import PREFIX, given_files
from railhil.controller_node.c_controller.folder import AROUND, TABLE, ControllerFolder
from railhil.controller_node.laws import law_class
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec

_TEMPLATES = Path(__file__).with_name("templates") / "c-controller"
_FILES = {"Makefile": "Makefile", TABLE: TABLE, "README.md": "README.md"}
#: Systems with an example of their own; others get commands of 0.
_EXAMPLES = ("ato",)
#: Headers of C99: a file of such a name would hide them.
_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg stdbool stddef stdint
    stdio stdlib string tgmath time wchar wctype
"""


def controller_files(name: str, scenario_text: str) -> dict[str, str]:
    """Files of the folder by their paths in it.

    :param name: of the controller, checked to be a name.
    :param scenario_text: shipped name or TOML file; the C around the controller is made for it.
    :raises InputError: the name has another meaning in C, or the scenario cannot be loaded or its system takes no
        controller of a user.
    """
    if name in (PREFIX, *_HEADERS.split()) or name.startswith("railhil"):
        raise InputError("command line", "NAME", name, f"no header of C, not {PREFIX}, not railhil...")
    scenario = load_any(scenario_text)
    with TemporaryDirectory() as draft:
        table = {"name": name, "system": scenario.system}
        Path(draft, TABLE).write_text(_text(TABLE).substitute(table), encoding="utf-8")
        law = LawSpec.of_given(ControllerFolder(draft))
        terms = law_class(law, scenario)(make(law.arithmetic), scenario).terms
        around = given_files(scenario, law, terms)
    units = {one.name: f" /* {one.unit} */" if one.unit else "" for one in terms.commands}
    commands = "\n".join(f"    out->{command} = 0.0f;{unit}" for command, unit in units.items())
    words = {**table, "macro": name.upper(), "scenario": scenario_text, "commands": commands}
    kind = scenario.system if scenario.system in _EXAMPLES else "plain"
    templates = _FILES | {f"{name}.c": f"{kind}.c", f"test_{name}.c": f"{kind}_checks.c"}
    files = {path: _text(file).substitute(words) for path, file in templates.items()}
    return files | {f"{AROUND}/{file}": text for file, text in around.items()}


def _text(file: str) -> Template:
    return Template((_TEMPLATES / f"{file}.in").read_text("utf-8"))
