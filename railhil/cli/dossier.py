"""``railhil dossier``: what folders of evidence show of each requirement, for an assessor."""

from __future__ import annotations

import argparse
from pathlib import Path

from railhil.bus.select import choose_bus
from railhil.cli.doctor import facts
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL, PASS
from railhil.common.extras import missing_library
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.common.user_files import refuse_unwritable
from railhil.record.hash_list import REPORT
from railhil.record.signature import add_key_argument, add_sign_argument, check_key
from railhil.scenarios.options import add_option

_STYLES = {"shown": "green", "violated": "red"}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "dossier",
        examples=[
            "railhil dossier runs --requirements ato",
            "railhil dossier runs hunt --validation build/validation --key ~/.ssh/id_ed25519.pub --out dossier",
        ],
        description="Exit code 0 when every requirement is shown and all evidence is as it was written, and with --key "
        "signed with it; 1 when there is a gap in these. No conformity with a standard is claimed.",
    )
    parser.add_argument(
        "folder", nargs="+", type=Path, metavar="DIR",
        help="folder of runs, tests, hunts or other evidence; also a folder of such folders",
    )  # fmt: skip
    add_option(parser, "--requirements")
    parser.add_argument(
        "--validation", type=Path, metavar="DIR", help="results of railhil's own tests: JUnit reports, doctor.json"
    )
    add_key_argument(parser)
    add_sign_argument(parser)
    add_option(parser, "--out DIR", default="dossier", usual="dossier")
    add_json_argument(parser)


def work(namespace: argparse.Namespace) -> int:
    """Check, write and print."""
    try:
        from railhil.dossier.page import page
    except ImportError as error:
        raise missing_library("railhil dossier", error, "report") from None
    from railhil.dossier.dossier import check_out, make_dossier, write_dossier
    from railhil.judge.requirements.lists import is_list
    from railhil.judge.requirements.requirement import named_requirements

    out = Path(namespace.out)
    check_out(out)
    lists = [Path(name) for name in namespace.requirements if is_list(name)]
    if len({path.name for path in lists}) < len(lists):
        raise InputError("command line", "--requirements", Words("two lists of one name"), "names of their own")
    check_key(namespace.sign)
    found = make_dossier(
        namespace.folder, named_requirements(namespace.requirements, prose=True), namespace.key, namespace.validation,
        facts({}, choose_bus({})),
    )  # fmt: skip
    with refuse_unwritable("--out", out, "folder"):
        write_dossier(found, page(found, out), out, namespace.sign, lists)
    code = PASS if found.is_complete else FAIL
    if namespace.json:
        print_json(found.as_json())
        return code
    console = Output()
    width = max((len(one.id) for one in found.claims), default=0)
    for one in found.claims:
        console.say(
            f"{one.id:{width}}  {one.verdict:11}  {one.title}".rstrip(), style=_STYLES.get(one.verdict, "bold yellow")
        )
    for gap in found.gaps:
        console.say(f"gap: {gap}")
    console.say(found.headline)
    console.say(str(out / REPORT))
    return code
