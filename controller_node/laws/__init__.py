"""Control laws, registered by name in the entry point group ``railhil.laws``."""

from __future__ import annotations

from typing import Any

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.common.plug_ins import cause_of, entries, guard_plug_in, sort_laws
from railhil.controller_node.laws.base import Law
from railhil.controller_node.laws.note import slots
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

GROUP = "railhil.laws"


def names() -> list[str]:
    """Names of the installed laws, in the order of every table."""
    return sort_laws(entries(GROUP))


def load(name: str) -> type[Law[Any, Any]]:
    """Class of the law of that name, for railhil's own system. Raises InputError like :func:`find`."""
    law: type[Law[Any, Any]] = find(name, GROUP, Law)
    try:
        slots(law.notes)
    except ValueError as error:
        raise InputError("controller", f"{name}.notes", Words(f"{len(law.notes)} notes"), str(error)) from error
    return law


def find(name: str, group: str, base: type[Any] = object) -> Any:
    """Class of a law of any system.

    :param group: entry point group of the laws of that system.
    :param base: their base class.

    Raises :class:`~railhil.common.errors.InputError` (one line, with the existing names) for an unknown name, or an
    entry point that cannot be imported or is not a law.
    """
    found = entries(group)
    if name not in found:
        allowed = f"one of {', '.join(sort_laws(found))}"
        raise InputError("controller", "name", name, allowed, did_you_mean(name, found))
    try:
        with guard_plug_in():
            law = found[name].load()
    except Exception as error:
        # Plug-in code may raise anything.
        cause = cause_of(error)
        raise InputError("controller", name, found[name].value, "an entry point that can be imported", cause) from error
    if not (isinstance(law, type) and issubclass(law, base)):
        allowed = f"an entry point in {group} naming a subclass of {base.__name__}"
        raise InputError("controller", name, found[name].value, allowed)
    return law


def law_class(law: LawSpec, scenario: AnyScenario, base: type[Any] = object) -> Any:
    """Class of the law of a run; for a controller that the user brings, and that is no export of an installed law, the
    law without a program.

    :raises InputError: like :func:`find`, or no controller can be brought to the system.
    """
    if law.given is None or law.given.law:
        return find(law.controller, scenario.installed_system.laws, base)
    return scenario.installed_system.part("given")


def is_floating(name: str, group: str) -> bool:
    """Whether a law has no fixed-point formats. Raises InputError like :func:`find`."""
    return bool(getattr(find(name, group), "floating", False))
