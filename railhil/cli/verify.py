"""``railhil verify``: a folder of evidence against its list of hashes, and that list against its signature."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from railhil.common.digits import count_of
from railhil.common.exit_codes import FAIL, PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.judge.evidence import Checked, check_evidence, refuse_no_evidence, signature_sentence
from railhil.record.hash_list import HASH_LIST
from railhil.record.run_folder import TELEMETRY
from railhil.record.signature import Signed, add_key_argument, signed


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "verify",
        examples=["railhil verify runs/mine", "railhil verify runs/mine --key ~/.ssh/id_ed25519.pub"],
        description="Exit code 0 when every file is as it was written, and signed with --key if that is given; else 1.",
    )
    parser.add_argument(
        "folder", type=Path, metavar="DIR", help="folder of a run, a comparison, a campaign, a sequence or faults"
    )
    add_key_argument(parser)
    add_json_argument(parser)


def work(namespace: argparse.Namespace) -> int:
    """Check and print."""
    folder: Path = namespace.folder
    refuse_no_evidence(folder)
    seen = check_evidence(folder)
    signature = signed(folder, namespace.key) if (folder / HASH_LIST).is_file() else None
    said, is_good = signature_sentence(signature, namespace.key)
    if not is_good:
        seen.problems.append(said)
    if namespace.json:
        print_json(_document(seen, said, signature))
        return FAIL if seen.problems else PASS
    console = Output()
    for line in (*seen.unchecked, *seen.remarks):
        console.say(line, style="bold yellow")
    for line in seen.problems:
        console.say(line, style="red")
    ending = count_of(len(seen.problems), "problem") if seen.problems else f"{count_of(seen.files, 'file')} as listed"
    if seen.has_telemetry:
        # The controller's own report does not follow from the log.
        ending += f", {TELEMETRY} compared with its hash alone"
    console.say(f"{folder}: {ending}; {said}")
    return FAIL if seen.problems else PASS


def _document(seen: Checked, said: str, signature: Signed | None) -> dict[str, Any]:
    return {
        "files": seen.files,
        "problems": seen.problems,
        "not_checked": seen.unchecked,
        "remarks": seen.remarks,
        "signature": said,
        "signed_by": None if signature is None or not signature.by else signature.by,
    }
