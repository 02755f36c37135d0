"""Signatures of lists of hashes, made and checked by OpenSSH (``ssh-keygen -Y``) in the namespace ``railhil``."""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

from railhil.common.errors import InputError, Words
from railhil.common.streams import say
from railhil.common.user_files import refuse_unreadable

#: Names in a folder: the list, and its signature, named by OpenSSH.
HASH_LIST, SIGNATURE = "SHA256SUMS", "SHA256SUMS.sig"
NAMESPACE: Final = "railhil"
OPTION, KEY = "--sign", "--key"
_PROGRAM: Final = "ssh-keygen"
_A_KEY: Final = "an SSH key that can sign (ssh-keygen -t ed25519)"
_SIGNER: Final = "signer"
_KEY = re.compile(r"with (\S+ key \S+)")


def add_sign_argument(parser: argparse.ArgumentParser) -> None:
    """Register ``--sign``."""
    parser.add_argument(
        OPTION, type=Path, metavar="KEY", help="SSH key with which the folder's list of hashes is signed"
    )


def add_key_argument(parser: argparse.ArgumentParser) -> None:
    """Register ``--key``."""
    parser.add_argument(
        KEY, type=Path, metavar="FILE", help="public SSH key that must have signed, or a file of allowed signers"
    )


def check_key(key: Path | None) -> None:
    """Try the key on an empty text before the work whose result it is to sign.

    :raises InputError: there is no such key, or it, or OpenSSH, cannot sign.
    """
    if key is not None:
        if not key.exists():
            raise InputError(key, "", Words("does not exist"), _A_KEY)
        with tempfile.TemporaryDirectory(prefix="railhil-sign-") as private:
            trial = Path(private) / HASH_LIST
            trial.touch()
            sign_list(trial.parent, key)


def sign_list(folder: Path, key: Path | None) -> None:
    """Sign the list of a folder, which must exist; None: no key, no signature.

    :param key: private key, or a public one whose private key the SSH agent has.
    :raises InputError: it cannot sign.
    """
    if key is None:
        return
    (folder / SIGNATURE).unlink(missing_ok=True)
    done = _ssh_keygen("sign", "-f", str(key), str(folder / HASH_LIST))
    if done.returncode:
        found = Words(_said(done))
        raise InputError("command line", f"{OPTION} {key}", found, _A_KEY)


class Signed(NamedTuple):
    """The result of checking a signature.

    ``by``: fingerprint of the key that has made it, empty if the signature belongs to another list. ``is_good``:
    whether it was made with the key that was given; None: none was given. ``said``: OpenSSH's message on a bad
    signature, or the reason why it was not checked. ``is_checked``: False without OpenSSH.
    """

    by: str
    is_good: bool | None
    said: str = ""
    is_checked: bool = True


def signed(folder: Path, key: Path | None) -> Signed | None:
    """Check the signature of a folder's list; None: there is none.

    :param key: public key, or a file of allowed signers.
    :raises InputError: the file is not a key, or OpenSSH, which a key needs, is missing.
    """
    signature = folder / SIGNATURE
    if not signature.is_file():
        return None
    if key is None and shutil.which(_PROGRAM) is None:
        return Signed("", None, f"no {_PROGRAM}", False)
    content = (folder / HASH_LIST).read_bytes()
    alone = _ssh_keygen("check-novalidate", "-s", str(signature), given=content)
    if alone.returncode:
        return Signed("", None if key is None else False, _said(alone))
    match = _KEY.search(alone.stdout.decode(errors="replace"))
    by = "an unknown key" if match is None else match[1]
    if key is None:
        return Signed(by, None)
    with tempfile.TemporaryDirectory(prefix="railhil-sign-") as private:
        allowed = Path(private) / "allowed_signers"
        allowed.write_text(_allowed_signers(key), encoding="utf-8")
        found = _ssh_keygen("find-principals", "-s", str(signature), "-f", str(allowed))
        for name in found.stdout.decode(errors="replace").splitlines():
            whose = ("-I", name, "-f", str(allowed))
            if not _ssh_keygen("verify", *whose, "-s", str(signature), given=content).returncode:
                return Signed(by, True)
    return Signed(by, False, f"it is of {by}")


def check_signature(folder: Path) -> None:
    """Refuse a signature that does not belong to the folder's list, with any key. Without OpenSSH this cannot be
    checked, and a line says so.

    :raises InputError: it belongs to another list, or to none.
    """
    found = signed(folder, None)
    if found is None or found.by:
        return
    if found.is_checked:
        raise InputError(folder / SIGNATURE, "", Words(found.said), f"a signature of {HASH_LIST} beside it")
    _say_once(f"{folder / SIGNATURE} is not checked: {found.said}")


@cache
def _say_once(line: str) -> None:
    say(line, stderr=True)


def _allowed_signers(key: Path) -> str:
    """A file of allowed signers, unchanged; a public key becomes one line of such a file.

    :raises InputError: it is neither.
    """
    allowed = "a public key (id_ed25519.pub) or a file of allowed signers"
    with refuse_unreadable(key, allowed):
        text = key.read_text(encoding="utf-8")
    if "PRIVATE KEY" in text:
        raise InputError("command line", f"{KEY} {key}", Words("is a private key"), allowed)
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise InputError("command line", f"{KEY} {key}", Words("has no key"), allowed)
    is_key = re.match(r"(ssh-|ecdsa-|sk-)\S+ \S+", lines[0]) is not None
    return f'{_SIGNER} namespaces="{NAMESPACE}" {lines[0]}\n' if is_key and len(lines) == 1 else text


def _ssh_keygen(verb: str, *words: str, given: bytes | None = None) -> subprocess.CompletedProcess[bytes]:
    namespace = () if verb == "find-principals" else ("-n", NAMESPACE)
    command = [_PROGRAM, "-Y", verb, *namespace, *words]
    try:
        # OpenSSH asks for a passphrase on the terminal, not here.
        return subprocess.run(command, input=given or b"", capture_output=True, check=False)
    except FileNotFoundError:
        raise InputError("command line", OPTION, Words(f"no {_PROGRAM}"), "OpenSSH 8.1 or later installed") from None


def _said(done: subprocess.CompletedProcess[bytes]) -> str:
    lines = done.stderr.decode(errors="replace").split("\n")
    return "; ".join(line.strip() for line in lines if line.strip()) or f"exit code {done.returncode}"
