"""A :class:`RunSpec` from arguments, checked like a file."""

from __future__ import annotations

import inspect
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.common.command_line import BUSES
from railhil.common.errors import InputError, Words
from railhil.controller_node.laws import find
from railhil.controller_node.laws.parameters import law_parameters
from railhil.record.run_folder import PARAMETERS
from railhil.scenarios.given import GivenController, NamedCode, given_controller, given_controllers, refuse_beside
from railhil.scenarios.load import load_any, sentences, stable_name
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.settings import REQUIREMENTS, SET, normalise_setting
from railhil.scenarios.system import names as system_names

#: One text or several.
Texts = str | Sequence[str]
#: A file or the name of what ships as one; one or several.
Files = str | Path | Sequence[str | Path]
#: Scenario keys to set: a mapping, or ``KEY=VALUE`` as on the command line.
Settings = Mapping[str, Any] | Texts
#: A file, parameters read from one, or values of the law's parameters by name.
Parameters = str | Path | ParameterSet | Mapping[str, Any]
#: Names of laws, texts of controllers, or functions and classes; one or several.
Laws = str | Path | Callable[..., Any] | Sequence[str | Path | Callable[..., Any]]
#: Source of an argument named in errors.
_LIBRARY = Path("railhil.run")


def spec_of(
    scenario: str | Path,
    *,
    controller: Any,
    arithmetic: str | None,
    indexing: str,
    parameters: Parameters | None,
    settings: Settings,
    faults: Texts,
    memory: str | Path | None,
    **beside: Any,
) -> RunSpec:
    """The description of a run from the arguments of :func:`railhil.run`.

    :param beside: further fields of the ``RunSpec``.
    :raises InputError: the scenario cannot be loaded, or the parameters cannot be read.
    """
    name, given, faults = stable_name(str(scenario)), settings_of(settings), texts_of(faults)
    if (brought := brought_controller(controller)) is not None:
        refuse_beside(brought, {"arithmetic": arithmetic, "parameters": parameters, "memory": memory}, "railhil.run")
        return RunSpec(name, given, LawSpec.of_given(brought, indexing), faults=faults, **beside)
    if controller is None or arithmetic is None:
        loaded = load_any(name, given, faults)
        controller = loaded.usual_law if controller is None else controller
        arithmetic = loaded.installed_system.arithmetic if arithmetic is None else arithmetic
    law = LawSpec(controller, arithmetic, indexing, parameters_of(parameters, controller))
    memory_store = None if memory is None else str(Path(memory).resolve())
    return RunSpec(name, given, law, memory_store=memory_store, faults=faults, **beside)


def brought_controller(controller: Any) -> GivenController | None:
    """The controller that is no law's name: code as a text, or a function or object; None: a law.

    :raises InputError: it is neither.
    """
    if controller is None:
        return None
    if isinstance(controller, str | Path):
        return given_controller(str(controller))
    if isinstance(controller, GivenController):
        return controller
    from railhil.controller_node.given.python import PythonObject

    return PythonObject(controller)


def named_laws(
    laws: Laws, call: str = "railhil.campaign", argument: str = "laws"
) -> tuple[tuple[str, ...], dict[str, GivenController]]:
    """The laws of a call for many runs as texts, and the controllers among them.

    A function or class becomes the text by which other processes find it.

    :param call: named in errors, with its ``argument``.
    :raises InputError: there is none, or one of them is neither a text nor found in a file.
    """
    several = laws if isinstance(laws, Sequence) and not isinstance(laws, str | Path) else (laws,)
    if not several:
        raise InputError(call, argument, Words("empty"), "one law or several")
    texts = tuple(str(law) if isinstance(law, str | Path) else _text_of(law, call, argument) for law in several)
    return texts, given_controllers(texts)


def _text_of(code: Any, call: str, argument: str) -> str:
    name, file = getattr(code, "__qualname__", ""), ""
    if inspect.isfunction(code) or inspect.isclass(code):
        module = sys.modules.get(code.__module__)
        file = (getattr(module, "__file__", None) or "") if getattr(module, name, None) is code else ""
    if not file.endswith(".py"):
        allowed = (
            "a name, FILE.py:NAME, or a function or class at the top of a file: other processes load it from there"
        )
        raise InputError(call, argument, Words(name or f"a {type(code).__name__}"), allowed)
    return f"{file}:{name}"


def checked_spec(spec: RunSpec) -> tuple[RunSpec, AnyScenario]:
    """A run from any source, checked like a file; and its scenario.

    :raises InputError: a value is not allowed; one line.
    """
    spec = replace(spec, settings=texts_of(spec.settings), faults=texts_of(spec.faults))
    checked = RunSpec.from_json(spec.as_json(), _LIBRARY, NamedCode(spec.plant_fmu, spec.law.given))
    kept = replace(checked, can=spec.can, start_up=spec.start_up, out=spec.out)
    spec = replace(kept, law=spec.law, memory_store=spec.memory_store)
    loaded = spec.load()
    system, law = loaded.installed_system, spec.law
    if law.given is None:
        system.check_law(law.controller, _LIBRARY, "controller")
    if law.parameters is not None and law.parameters.source == Path(PARAMETERS):
        # Their file does not exist yet: the error names the call.
        values = replace(law.parameters, source=_LIBRARY)
        law_parameters(law.controller, find(law.controller, system.laws), values)
    return spec, loaded


def bus_of(text: str, source: str) -> tuple[str, dict[str, Any]]:
    """``bus`` and ``can`` of a ``RunSpec`` for a bus in one word (:func:`railhil.run`).

    :param source: named in the error.
    :raises InputError: it is none of these.
    """
    if text in BUSES:
        return text, {}
    if text == "hub":
        return "auto", {"interface": HUB_INTERFACE}
    interface, mark, channel = text.partition(":")
    channel, rate_mark, rate = channel.partition("@")
    if not (interface and mark and channel) or (rate_mark and not rate.isdecimal()):
        raise InputError(source, "bus", text, f"{', '.join(BUSES)}, hub or INTERFACE:CHANNEL[@BITRATE]")
    bitrate = {"bitrate": int(rate)} if rate else {}
    return "auto", {"interface": interface, "channel": channel, **bitrate}


def settings_of(given: Settings) -> tuple[str, ...]:
    """Settings as ``KEY=VALUE``, checked."""
    if isinstance(given, Mapping):
        given = [f"{key}={_toml_value(key, value)}" for key, value in given.items()]
    return tuple(normalise_setting(text) for text in texts_of(given))


def _toml_value(key: str, value: Any) -> str:
    try:
        # JSON values are TOML values, except tables and null, which no key has.
        return json.dumps(value)
    except (TypeError, ValueError):
        raise InputError(SET, key, value, "a number, a text, true or false, or a list of them") from None


def texts_of(given: Files) -> tuple[str, ...]:
    """The texts; a single one counts as one, not as its letters."""
    return (str(given),) if isinstance(given, str | Path) else tuple(map(str, given))


def requirement_names(given: Files) -> tuple[str, ...]:
    """Files of requirements by their whole paths, and names of systems."""
    known = system_names()
    return tuple(
        word if word in known and not Path(word).is_file() else str(Path(word).resolve()) for word in texts_of(given)
    )


def with_requirements(spec: RunSpec, words: Files) -> RunSpec:
    """The run, judged by further requirements: those of its scenario, of files, or of systems by their names.

    The description of a recorded run has those of its scenario already: they are not read again.

    :raises InputError: a file cannot be read, or is wrong.
    """
    has_own = any(one.get("file") == spec.scenario for one in spec.requirements)
    own = {} if has_own else sentences(spec.scenario, spec.settings)
    if not own and not words:
        return spec
    # A run without requirements does not load their language.
    from railhil.judge.requirements.requirement import named_requirements, requirements_from_json, requirements_in

    known = (*requirements_in(own, spec.scenario), *requirements_from_json(spec.requirements, REQUIREMENTS))
    further = named_requirements(texts_of(words), known)
    return replace(spec, requirements=tuple(one.as_json() for one in (*known, *further)))


def parameters_of(given: Parameters | None, law: str) -> ParameterSet | None:
    """Parameters; values given without a file count as read from the run folder, where they will be written."""
    if given is None or isinstance(given, ParameterSet):
        return given
    if isinstance(given, Mapping):
        return ParameterSet(law, dict(given), Path(PARAMETERS))
    return load_parameters(Path(given).resolve())
