"""The packages of railhil, some of which lie beside ``railhil/``, and the compiled build, which nobody needs.

``[tool.setuptools.package-dir]`` in pyproject.toml says in which folder a package lies. ``python setup.py tree`` makes
links to them in one folder, ``build/tree``, for mypy, pyright and import-linter, which do not read that table. Each
call also writes the declarations of telegram classes for type checkers (:mod:`railhil.dbc.stubs`); git ignores them.

``RAILHIL_COMPILED=1 pip install .`` compiles the modules below by mypyc. Sources are installed in any case:
``RAILHIL_PURE=1`` runs them. Not compiled, although each frame passes them: classes made from the port table
(telegrams, identities), enumerations with a constructor, subclasses of built-in exceptions, and what python-can
subclasses. Functions that the batch has numba compile (:mod:`railhil.common.compilable`) it reads from their source. A
class that interpreted code subclasses says so (:mod:`railhil.common.mypyc`).

The version is that of pyproject.toml with the label of the commit (:mod:`railhil.common.version`). ``RAILHIL_LABEL``
gives the label where the build has no git, as in an image: ``+g1234567``, or nothing for a release.
"""

import os
import shutil
import sys
import tomllib
from importlib import import_module
from pathlib import Path

from setuptools import find_namespace_packages, setup

PYPROJECT = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))
#: Package -> its folder.
FOLDERS = PYPROJECT["tool"]["setuptools"]["package-dir"]
TREE = "build/tree"
MODULES = [
    "railhil/bus/acceptance.py",
    "railhil/bus/administrator.py",
    "railhil/bus/clock.py",
    "railhil/bus/codes.py",
    "railhil/bus/frame.py",
    "railhil/bus/hub/address.py",
    "railhil/bus/hub/cancontroller.py",
    "railhil/bus/hub/cli.py",
    "railhil/bus/hub/disturbed_bus.py",
    "railhil/bus/hub/gateway_queues.py",
    "railhil/bus/hub/link.py",
    "railhil/bus/hub/membership.py",
    "railhil/bus/hub/ports.py",
    "railhil/bus/hub/portspec.py",
    "railhil/bus/hub/server.py",
    "railhil/bus/hub/switch.py",
    "railhil/bus/hub/wire_model.py",
    "railhil/bus/injector/activities.py",
    "railhil/bus/injector/follower.py",
    "railhil/bus/injector/holding.py",
    "railhil/bus/injector/node_faults.py",
    "railhil/bus/injector/plant_side.py",
    "railhil/bus/lifesign.py",
    "railhil/bus/link/base.py",
    "railhil/bus/link/errorframe.py",
    "railhil/bus/link/kernel.py",
    "railhil/bus/link/opening.py",
    "railhil/bus/link/pipes.py",
    "railhil/bus/link/single.py",
    "railhil/bus/link/spin_wait.py",
    "railhil/bus/local.py",
    "railhil/bus/mvb.py",
    "railhil/bus/order.py",
    "railhil/bus/packing.py",
    "railhil/bus/reception.py",
    "railhil/bus/responder.py",
    "railhil/bus/schedule.py",
    "railhil/bus/sent.py",
    "railhil/bus/store.py",
    "railhil/common/floats.py",
    "railhil/controller_node/ato/balises.py",
    "railhil/controller_node/ato/control_loop.py",
    "railhil/controller_node/ato/controller.py",
    "railhil/controller_node/ato/guard.py",
    "railhil/controller_node/ato/node.py",
    "railhil/controller_node/ato/odometer.py",
    "railhil/controller_node/ato/plausibility.py",
    "railhil/controller_node/ato/speed_monitors.py",
    "railhil/controller_node/ato/speed_watch.py",
    "railhil/controller_node/ecan/mailboxes.py",
    "railhil/controller_node/ecan/module.py",
    "railhil/controller_node/ecan/receiver.py",
    "railhil/controller_node/ecan/timestamp.py",
    "railhil/controller_node/law_controller.py",
    "railhil/controller_node/law_loop.py",
    "railhil/controller_node/line/heed.py",
    "railhil/controller_node/line/jog.py",
    "railhil/controller_node/line/node.py",
    "railhil/controller_node/line/place.py",
    "railhil/controller_node/line/rules.py",
    "railhil/controller_node/line/sections.py",
    "railhil/controller_node/line/station_telegrams.py",
    "railhil/controller_node/line/stations.py",
    "railhil/controller_node/node.py",
    "railhil/controller_node/process_loop.py",
    "railhil/controller_node/telemetry.py",
    "railhil/faults/activity.py",
    "railhil/plant_sim/ato/command_watch.py",
    "railhil/plant_sim/ato/dynamics.py",
    "railhil/plant_sim/ato/forces.py",
    "railhil/plant_sim/ato/gate.py",
    "railhil/plant_sim/ato/plant.py",
    "railhil/plant_sim/ato/plant_readings.py",
    "railhil/plant_sim/ato/telegrams.py",
    "railhil/plant_sim/ato/train.py",
    "railhil/plant_sim/ato/train_checks.py",
    "railhil/plant_sim/ato/train_watch.py",
    "railhil/plant_sim/atp/own_checks.py",
    "railhil/plant_sim/atp/position.py",
    "railhil/plant_sim/atp/protection.py",
    "railhil/plant_sim/atp/readings.py",
    "railhil/plant_sim/atp/supervision.py",
    "railhil/plant_sim/cycle.py",
    "railhil/plant_sim/line/braked.py",
    "railhil/plant_sim/line/brakes.py",
    "railhil/plant_sim/line/docking.py",
    "railhil/plant_sim/line/doors.py",
    "railhil/plant_sim/line/journey.py",
    "railhil/plant_sim/line/onboard.py",
    "railhil/plant_sim/line/run_end.py",
    "railhil/plant_sim/line/telegrams.py",
    "railhil/plant_sim/line/train.py",
    "railhil/plant_sim/node.py",
    "railhil/plant_sim/supervision.py",
    "railhil/record/blf_writer.py",
    "railhil/record/framelog.py",
    "railhil/record/packets.py",
    "railhil/record/session.py",
    "railhil/record/trace.py",
    "railhil/systems/line/braking/limits.py",
    "railhil/systems/line/braking/track.py",
]
#: A build environment has no libraries, and no configuration is read: the build depends on the sources only.
OPTIONS = ["--config-file=", "--follow-imports=silent", "--ignore-missing-imports"]


def packages_of(name: str, folder: str) -> list[str]:
    """The package in a folder and those below it, with the folders that hold only data."""
    return [name, *(f"{name}.{below}" for below in find_namespace_packages(folder))]


def lay_out(tree: str = TREE) -> None:
    """Make links to the packages in the folder ``tree``, where they lie as in a wheel; those in ``build/tree`` anew."""
    if tree == TREE:
        shutil.rmtree(tree, ignore_errors=True)
    for name, folder in sorted(FOLDERS.items()):
        place = Path(tree, *name.split("."))
        if "." in name:
            place.symlink_to(Path(folder).resolve())
        else:
            place.mkdir(parents=True)
            for path in Path(folder).iterdir():
                (place / path.name).symlink_to(path.resolve())


if lost := [folder for folder in FOLDERS.values() if not Path(folder, "__init__.py").is_file()]:
    raise SystemExit(
        f"railhil cannot be built: found no package in {', '.join(lost)}, which must be folders with an __init__.py; "
        "clone the repository again, or take the source archive of a release"
    )
sys.path.insert(0, str(Path(__file__).parent))
import_module("railhil.dbc.stubs").write_stubs(Path())
if sys.argv[1:2] == ["tree"]:
    lay_out(*sys.argv[2:])
    raise SystemExit
label = os.environ.get("RAILHIL_LABEL")
if label is None:
    label = import_module("railhil.common.version").label(Path.cwd(), PYPROJECT["project"]["version"])
extensions = []
compiled = os.environ.get("RAILHIL_COMPILED", "0") not in ("", "0")
if compiled:
    try:
        from mypyc.build import mypycify
    except ImportError:
        # pip first asks what the build needs (egg_info), in an environment that does not have it yet.
        if "egg_info" not in sys.argv:
            raise
    else:
        # mypyc takes the name of a module from the folders in which it lies.
        lay_out()
        extensions = mypycify([*OPTIONS, *(f"{TREE}/{path}" for path in MODULES)], opt_level="3", multi_file=True)
        for extension in extensions:
            # On processors with fused products gcc would use them, and their last bit differs from Python's.
            extension.extra_compile_args = [*extension.extra_compile_args, "-ffp-contract=off"]

setup(
    packages=[package for name, folder in FOLDERS.items() for package in packages_of(name, folder)],
    ext_modules=extensions,
    setup_requires=["mypy>=1.11"] if compiled else [],
    options={"egg_info": {"tag_build": label}},
)
