"""Runs beside each other on a page: their labels."""

from __future__ import annotations

from collections.abc import Sequence

from railhil.common.errors import InputError
from railhil.judge.record import Record, law_label
from railhil.scenarios.scenario_documents import any_judged_sha256

#: The name of a record in version 0.1.0.
RecordedRun = Record


def check_one_scenario(runs: Sequence[Record]) -> None:
    """
    :raises InputError: two of the runs are of different scenarios; their scores cannot stand beside each other.
    """
    first = runs[0].scenario
    for run in runs:
        if any_judged_sha256(run.scenario) != any_judged_sha256(first):
            raise InputError(run.folder, "scenario", run.scenario.name, f"{first.name}, as in {runs[0].folder}")


def law_labels(runs: Sequence[Record]) -> list[str]:
    """Label of each run: the law with its parameters, and arithmetic, set-points and train if runs of the law differ in
    them. Runs that differ in the seed alone have the same label."""
    bare = [law_label(run.certificate, run.controller) for run in runs]
    return _extended(bare, runs, ("arithmetic", "indexing", "perturbed"))


def distinct_labels(runs: Sequence[Record]) -> list[str]:
    """A label for each run, all different: equal labels are extended by the differences of the runs."""
    labels = _extended([run.label for run in runs], runs, ("arithmetic", "indexing", "perturbed", "seed", "pace"))
    for label in {text for text in labels if labels.count(text) > 1}:
        same = [index for index, text in enumerate(labels) if text == label]
        for serial, index in enumerate(same, start=1):
            labels[index] = f"{label} #{serial}"
    return labels


def _extended(labels: Sequence[str], runs: Sequence[Record], keys: Sequence[str]) -> list[str]:
    """Equal labels extended by those of these keys in which the certificates of the runs differ."""
    found = list(labels)
    for key in keys:
        before = list(found)
        for label in {text for text in before if before.count(text) > 1}:
            same = [index for index, text in enumerate(before) if text == label]
            values = [runs[index].certificate.get(key) for index in same]
            if len(set(map(str, values))) > 1:
                for index, value in zip(same, values, strict=True):
                    word = f"seed {value}" if key == "seed" else value
                    word = ("perturbed" if value else "nominal") if key == "perturbed" else word
                    found[index] = f"{label} {word}"
    return found
