"""``python -m railhil.learning`` (the same as ``railhil train-model``)."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from railhil.common.command_line import parse
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import PASS, run_guarded
from railhil.common.output import Output
from railhil.common.streams import accept_any_text, flush_output, print_json
from railhil.common.user_files import check_writable, whole_file
from railhil.controller_node.high_speed.training import Recipe
from railhil.judge.record import checked_record
from railhil.learning.command import LAWS, arguments
from railhil.learning.models import describe_training, render_file, train_models


@contextmanager
def _refuse_unwritable(path: Path) -> Iterator[None]:
    """Report a file that cannot be written as bad input."""
    try:
        yield
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError("command line", "--out", str(path), f"a file that can be written ({why})") from None


def main(words: Sequence[str] | None = None) -> int:
    """Train and write the file."""
    accept_any_text()
    namespace = parse(arguments(), words)
    console = Output(stderr=namespace.json)
    try:
        record = checked_record(namespace.record, None)
        if record.invalid:
            raise InputError(record.log, "verdict", Words(f"INVALID: {record.invalid}"), "a run that can be trusted")
        if not record.certificate:
            raise InputError(record.log, "certificate.json", Words("no such file"), "a run that came to its end")
        law = LAWS[namespace.kind]
        file = Path(namespace.out or f"{law}_{record.scenario.name}.toml")
        # Check before the work, not after it.
        with _refuse_unwritable(file):
            check_writable(file)
        ridge = None if namespace.pinv else namespace.ridge
        recipe = Recipe("bp" if namespace.kind == "bp" else "elm", namespace.hidden, ridge, namespace.seed)
        models = train_models(record, recipe, namespace.period)
        notes = describe_training(record, recipe, namespace.period, models)
        with _refuse_unwritable(file), whole_file(file) as draft:
            draft.write_text(render_file(law, record, models, notes), encoding="utf-8")
        for period_s, error in models.errors.items():
            console.say(
                f"one step of {period_s:g} s: {error.linear_kmh:.4f} km/h by the linear model, "
                f"{error.integrated_kmh:.4f} km/h with the network"
            )
        console.say(f"written: {file}")
        if namespace.json:
            print_json({"law": law, "file": str(file), "networks": len(models.networks), **notes})
        return PASS
    finally:
        flush_output()


if __name__ == "__main__":
    sys.exit(run_guarded("railhil train-model", main))
