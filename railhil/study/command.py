"""The command of a study: options that all kinds have, and the way from the command line to results, page and exit
code."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, Generic, get_type_hints

from railhil.common.command_line import SEED_MAX, run_command, whole_number
from railhil.common.errors import OptionError
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.common.extras import need
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.record.signature import add_sign_argument, check_key, sign_list
from railhil.scenarios.given import GivenController, given_controllers
from railhil.scenarios.load import stable_name
from railhil.scenarios.options import add_option
from railhil.study.engines import ENGINES, running
from railhil.study.plan import P, Shard, Study

# Modules that make runs are imported where they are used: help and completion do not need the extra libraries.

#: Field of a request -> attribute of the command line, if it has another name.
_ATTRIBUTE = {"settings": "set", "faults": "fault", "first_seed": "seed"}

#: Names of engines in earlier versions.
_FORMER_ENGINES = {"joblib": "processes"}


def exit_codes(
    lost: str,
    made: str = "every run was made (whatever its verdict)",
    bad: str = "",
    defect: str = "TOOL ERROR: a defect, or the record could not be written (what is done is kept)",
) -> str:
    """The exit codes in the help.

    :param lost: meaning of exit code 3; so are ``made`` of 0, ``bad`` of 1 beside that with ``--verify`` (empty: none)
        and ``defect`` of 4.
    """
    return f"""\
exit codes:
  0    {made}; --verify: the bench gives the same results
  1    {bad and f"{bad}; "}--verify: the bench gives other results
  2    usage or bad input; one line says what was found and what is allowed
  3    {lost}; what is done is kept
  4    {defect}
  130  stopped by Ctrl-C; 143 by SIGTERM, 129 by SIGHUP (what is done is kept, --resume continues)"""


def add_engine_arguments(parser: argparse.ArgumentParser, usual: str = "processes") -> None:
    """Options about the place where the runs are made."""
    parser.add_argument("--engine", type=_engine, choices=ENGINES, default=usual, help="this process, cores, machines")
    add_option(parser, "--jobs", "" if usual == "processes" else ", with --engine processes")


def _engine(text: str) -> str:
    return _FORMER_ENGINES.get(text, text)


def add_folder_arguments(parser: argparse.ArgumentParser, default: str, with_report: bool) -> None:
    """Options about the folder of a study.

    :param default: ending of the default folder.
    :param with_report: whether the command itself writes a report.
    """
    parser.add_argument("--scheduler", metavar="ADDRESS", help="dask: tcp://HOST:PORT of the scheduler")
    add_option(parser, "--out DIR", "; goes on there", usual=f"runs/<utc>-<scenario>-{default}")
    parser.add_argument("--resume", metavar="DIR", help="go on in this folder")
    said = "make every N-th part from the K-th on; any number of processes and machines make the others"
    parser.add_argument("--shard", type=Shard.parse, metavar="K/N", help=said)
    if with_report:
        add_option(parser, "--no-report")
    else:
        parser.set_defaults(no_report=True)
    add_sign_argument(parser)
    add_json_argument(parser)
    add_option(parser, "--verify")
    parser.add_argument(
        "--draw", type=whole_number(0, SEED_MAX), default=0, metavar="N", help="--verify: which ones (default: 0)"
    )


def add_number(parser: argparse.ArgumentParser, request: type[Any], name: str, note: str = "", **changes: Any) -> None:
    """An option for a number of the requests: its bounds and its default are those of the field.

    :param note: as in :func:`railhil.scenarios.options.add_option`; so are ``changes``.
    """
    option = f"--{_ATTRIBUTE.get(name, name)}"
    (declared,) = get_type_hints(request, include_extras=True)[name].__metadata__
    low, high = (bound for one in declared.metadata for bound in asdict(one).values())
    as_given = {"type": whole_number(low, high), "default": None, "usual": str(getattr(request(), name))}
    add_option(parser, option, note, **{**as_given, **changes})


def _given(request: Any, namespace: argparse.Namespace) -> dict[str, Any]:
    """Fields of the request that the command line sets."""
    values = {one.name: getattr(namespace, _ATTRIBUTE.get(one.name, one.name)) for one in fields(request)}
    return {name: value for name, value in values.items() if value is not None and value is not False and value != []}


def _check_options(
    request: Any, namespace: argparse.Namespace, beside: Sequence[str], without: Sequence[str] = ()
) -> None:
    """Refuse options that do not go together.

    :param request: class of the requests.
    :param beside: options that go with ``--verify``, besides ``--draw``; the first is named in the error.
    :param without: further options that do not go with it. :raises InputError: there are such options.
    """
    if namespace.verify is not None:
        names = [_ATTRIBUTE.get(name, name) for name in _given(request, namespace)]
        names += [name for name in ("out", "resume", "shard", *without) if getattr(namespace, name)]
        if extra := [name for name in names if name not in beside]:
            option = extra[0] if extra[0] == "scenario" else f"--{extra[0].replace('_', '-')}"
            raise OptionError("--verify", f"cannot be given with {option}, only with --{beside[0]} and --draw")
    for option, engine in (("jobs", "processes"), ("scheduler", "dask")):
        given = getattr(namespace, option)
        if given is not None and getattr(namespace, "engine", engine) != engine:
            raise OptionError(f"--{option}", f"used only with --engine {engine}")
    if namespace.resume is not None and namespace.out is not None:
        raise OptionError("--out", "cannot be given with --resume")
    if namespace.shard is not None:
        if namespace.resume is None and namespace.out is None:
            raise OptionError("--shard", "used only with --out or --resume, the folder of the shards")
        if namespace.sign is not None:
            raise OptionError("--sign", "used only with all parts: --resume DIR, not --shard")


def request_from(begun: Any, namespace: argparse.Namespace) -> Any:
    """The request: options from the command line, all others from ``begun`` (an existing study, or the defaults)."""
    said = _given(begun, namespace)
    for name, value in said.items():
        if name == "scenario":
            said[name] = stable_name(value)
        elif isinstance(value, Path):
            said[name] = str(value.resolve())
        elif isinstance(value, list):
            said[name] = tuple(str(one.resolve()) if isinstance(one, Path) else one for one in value)
    return replace(begun, **said)


@dataclass(frozen=True)
class Command(Generic[P]):
    """The command of one kind of study.

    ``study``: ``module:object`` of its record, which needs the libraries of the extra. ``verified``: the option that
    says how many items ``--verify`` makes again, and their usual number. ``how``: (plan) -> remark on the making of the
    runs (empty: none), and the module with compiled loops (None: nothing is compiled). ``check``: (command line)
    refuses options of its own that do not go together. ``engine``: (command line) -> name and number of processes
    (None: one per core). ``only_run``: further options that do not go with ``--verify``. ``code``: the field of the
    request that may name controllers of the user (empty: none may); if it does, the study's ``make_plan`` takes them as
    ``code``, by their texts. ``time_s``: (command line) -> wall time after which the study ends with what is there, in
    s; None: it ends with its last run.
    """

    name: str
    study: str
    request: type[Any]
    arguments: Callable[[], argparse.ArgumentParser]
    verified: tuple[str, int]
    how: Callable[[P], tuple[str, str | None]]
    check: Callable[[argparse.Namespace], None] = lambda namespace: None
    engine: Callable[[argparse.Namespace], tuple[str, int | None]] = lambda namespace: (
        namespace.engine,
        namespace.jobs,
    )
    only_run: Sequence[str] = ("json",)
    code: str = ""
    time_s: Callable[[argparse.Namespace], float | None] = lambda namespace: None

    def main(self, words: Sequence[str] | None = None) -> int:
        """Run, resume or verify; returns the exit code."""
        return run_command(self.arguments(), words, self._work)

    def _work(self, namespace: argparse.Namespace) -> int:
        code = self._code(namespace)
        # A controller of the user is named again.
        beside = (self.verified[0], self.code) if code else (self.verified[0],)
        _check_options(self.request, namespace, beside, self.only_run)
        self.check(namespace)
        need("pyarrow", *self._extras(namespace), command=self.name)
        study = self._study(code)
        return self._verify(namespace, study, code) if namespace.verify is not None else self._run(namespace, study)

    def _code(self, namespace: argparse.Namespace) -> Mapping[str, GivenController]:
        texts: str | Sequence[str] = (getattr(namespace, self.code) if self.code else None) or ()
        return given_controllers((texts,) if isinstance(texts, str) else texts)

    def _extras(self, namespace: argparse.Namespace) -> tuple[str, ...]:
        """Extras that the command line needs."""
        return ("campaign", "dask") if self.engine(namespace)[0] == "dask" else ("campaign",)

    def _study(self, code: Mapping[str, GivenController]) -> Study[P, Any]:
        module, _, name = self.study.partition(":")
        found: Study[P, Any] = getattr(import_module(module), name)
        return replace(found, make_plan=partial(found.make_plan, code=code)) if code else found

    def _verify(self, namespace: argparse.Namespace, study: Study[P, Any], code: Mapping[str, GivenController]) -> int:
        import numpy as np

        from railhil.study.finished import finished_rows, repeated_plan

        folder = Path(namespace.verify)
        console, kind, made, bad = Output(stderr=namespace.json), study.kind, [], 0
        again = {self.code: getattr(namespace, self.code)} if code else {}
        plan, is_other_code = repeated_plan(study, folder, **again)
        if is_other_code:
            said = f"the code has changed since the {kind}: a difference may come from that"
            console.say(said, style="bold yellow")
        rows, (option, usual) = finished_rows(study, plan, folder), self.verified
        drawn = np.random.default_rng(namespace.draw).permutation(study.items(plan))
        places = drawn[: getattr(namespace, option) or usual]
        for one in (run for place in places for run in study.repeat(plan, rows, int(place))):
            made.append({**one.document, "differences": dict(one.differences)})
            bad += bool(one.differences)
            if not one.differences:
                console.say(f"{one.run}: the bench gives the same results")
            for name, (ours, theirs) in one.differences.items():
                console.say(f"{one.run}: {name} {ours} in the {kind}, {theirs} on the bench", style="red")
        if namespace.json:
            print_json(made)
        if not made:
            console.say(
                f"nothing was compared: the {kind} has no run in these rows that can be made again", style="yellow"
            )
            return INVALID
        console.say(f"{len(made) - bad} of {len(made)} runs are the same on the bench")
        return FAIL if bad else PASS

    def _run(self, namespace: argparse.Namespace, study: Study[P, Any]) -> int:
        from rich.console import Console

        from railhil.batch import say_compiling
        from railhil.study.execute import execute
        from railhil.study.manifest import read_manifest
        from railhil.study.pages import page_line

        check_key(namespace.sign)
        resumed = namespace.resume
        begun = study.request() if resumed is None else read_manifest(Path(resumed), study).request
        plan = study.make_plan(request_from(begun, namespace))
        console = Console(stderr=True)

        def say(sentence: str) -> None:
            console.print(sentence, markup=False, highlight=False, soft_wrap=True)

        remark, kernel = self.how(plan)
        if remark:
            say(remark)
        name, jobs = self.engine(namespace)
        if name != "dask" and kernel is not None:
            # If the work is done on this machine, report missing libraries before the folder is made.
            need("numba", *self._extras(namespace), command=self.name)
            say_compiling(say, kernel)
        with running(name, say, jobs, namespace.scheduler) as engine:
            made = execute(
                study, plan, resumed or namespace.out, console, engine, say, namespace.shard, self.time_s(namespace)
            )
            if made.is_whole:
                made = study.finish(plan, made, engine, say)
        if not made.is_whole:
            joins = f"the last shard, or {study.command} --resume {made.folder}, joins all"
            say(f"shard {namespace.shard} is complete; {joins}")
            if namespace.json:
                print_json({"folder": str(made.folder), "shard": str(namespace.shard)})
            return PASS
        line = "" if namespace.no_report else page_line(study, plan, made)
        sign_list(made.folder, namespace.sign)
        if namespace.json:
            print_json(made.summary)
        else:
            folder = f"{study.name} folder {made.folder}"
            Output().show([*study.lines(plan, made.summary, made.folder), *filter(None, (line, folder))])
        return study.exit_code(plan, made)
