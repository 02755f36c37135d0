"""The exported law as a co-simulation FMU (FMI 2.0 or 3.0): its C with a frame around it, compiled for this machine."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

from railhil.common.errors import InputError, Words
from railhil.common.extras import missing
from railhil.controller_node.export.bundle import Bundle
from railhil.controller_node.export.fmu_description import build_description, description, terminals
from railhil.controller_node.export.fmu_law import law_in_fixed_point, law_in_single_precision
from railhil.controller_node.export.single_bundle import SingleBundle
from railhil.controller_node.export.templates import template
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Versions of FMI, the first is the default; each with the standard's headers.
_HEADERS = {
    "2.0": ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    "3.0": ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
#: What the sources need of a compiler.
_OPTIONS = "-std=c99 -O2 -fwrapv -ffp-contract=off"
#: The parameters of the frame's functions are the standard's, used or not.
_FLAGS = (*_OPTIONS.split(), "-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror", "-fPIC", "-fvisibility=hidden")
#: Time of all entries of the archive, so that two exports have the same bytes.
_NO_TIME = (1980, 1, 1, 0, 0, 0)


def write_fmu(bundle: Bundle | SingleBundle, scenario: AnyScenario, law: LawSpec, path: Path, fmi: str = "2.0") -> None:
    """Write the FMU of an export, with its sources and a binary for this platform.

    Inputs and outputs are the integers of the C functions; the number of the control period comes from the time.

    :param fmi: version, "2.0" or "3.0".
    :raises InputError: FMPy, whose copy of the standard's headers is used, or a C compiler is missing, or the file
        cannot be written.
    """
    try:
        import fmpy
    except ImportError as error:
        raise missing("railhil export-c --fmu", error, "fmi") from None
    digest = hashlib.sha256("".join((fmi, *bundle.files.values())).encode())
    token = "{" + digest.hexdigest()[:32] + "}"
    if isinstance(bundle, SingleBundle):
        inside = law_in_single_precision(bundle, scenario, token)
    else:
        inside = law_in_fixed_point(bundle, scenario, law, token)
    name = inside.name
    frame = f"railhil_fmi{fmi[0]}.c"
    headers = Path(fmpy.__file__).parent / "c-code"
    sources = {
        **inside.files,
        frame: template(frame, name),
        **{header: (headers / header).read_text(encoding="utf-8") for header in _HEADERS[fmi]},
    }
    compiled = (f"{name}.c", "railhil_fmu.c", frame)
    library = _compiled(name, sources, compiled)
    platform = fmpy.platform if fmi == "2.0" else fmpy.platform_tuple
    entries = {
        "modelDescription.xml": description(inside, fmi, compiled),
        **{f"sources/{file}": text.encode() for file, text in sources.items()},
        f"binaries/{platform}/{name}{fmpy.sharedLibraryExtension}": library,
    }
    if fmi == "3.0":
        entries["sources/buildDescription.xml"] = build_description(inside, compiled, _OPTIONS)
        entries["terminalsAndIcons/terminalsAndIcons.xml"] = terminals(inside)
    try:
        with zipfile.ZipFile(path, "w") as archive:
            for entry, content in entries.items():
                archive.writestr(zipfile.ZipInfo(entry, _NO_TIME), content, zipfile.ZIP_DEFLATED)
    except OSError as error:
        raise InputError(path, "", Words(error.strerror or str(error)), "a file that can be written") from error


def _compiled(name: str, sources: Mapping[str, str], compiled: tuple[str, ...]) -> bytes:
    """The shared library of the sources, by the compiler in ``CC``, else gcc, else cc."""
    compiler = os.environ.get("CC") or shutil.which("gcc") or shutil.which("cc")
    if not compiler:
        raise InputError("railhil export-c", "--fmu", Words("no C compiler"), "gcc, cc, or one in CC")
    with tempfile.TemporaryDirectory(prefix="railhil-fmu-") as folder:
        for file, text in sources.items():
            Path(folder, file).write_text(text, encoding="utf-8")
        # Names without a folder, so that none gets into the library.
        command = [compiler, *_FLAGS, "-shared", "-o", f"{name}.lib", *compiled, "-lm"]
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        except OSError as error:
            raise InputError("environment", "CC", compiler, f"a C compiler ({error.strerror})") from None
        if done.returncode:
            said = Words(done.stderr.strip().partition("\n")[0] or f"exit code {done.returncode}")
            raise InputError("railhil export-c --fmu", compiler, said, "a C99 compiler that accepts the export")
        return Path(folder, f"{name}.lib").read_bytes()
