"""The campaign that says how far the scores of a recorded run may lie apart."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from railhil.campaign.rows import column_of, rows_of, schema
from railhil.campaign.study import CAMPAIGN
from railhil.judge.record import Record
from railhil.record.documents import SUMMARY
from railhil.record.hash_list import check_hash_list
from railhil.report.noise import Noise
from railhil.report.templates import address_of
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.study.finished import finished_summary
from railhil.study.table import RESULTS, numbers, read_table


def find_noise(runs: Sequence[Record], folders: Sequence[Path], out: Path) -> list[Noise]:
    """For each run the runs of its law in the first campaign that has its scenario, law and set-points, if one has.

    :param folders: of campaigns; one that is not finished says nothing yet.
    :param out: the page that links the campaign.
    :raises InputError: a campaign is damaged.
    """
    finished = [folder for folder in folders if (folder / SUMMARY).is_file()]
    found = [
        next((noise for folder in finished if (noise := _noise(run, number, folder, out))), None)
        for number, run in enumerate(runs)
    ]
    return [one for one in found if one is not None]


def _noise(run: Record, number: int, folder: Path, out: Path) -> Noise | None:
    """The runs of the law; None: the campaign has another scenario, or not this law with these set-points."""
    summary = finished_summary(CAMPAIGN, folder)
    parameters = run.certificate.get("parameters") or {}
    own = (run.controller, parameters.get("sha256"))
    label = next(
        (name for name, law in summary["laws"].items() if (law["controller"], law["parameters_sha256"]) == own), None
    )
    same = (any_judged_sha256(run.scenario), run.certificate.get("indexing"))
    if label is None or (summary.get("scenario_sha256"), summary["indexing"]) != same:
        return None
    check_hash_list(folder, CAMPAIGN.manifest, None)
    rows = rows_of(read_table(folder / RESULTS, schema(run.judging)), label)
    seeds = f"seeds {summary['first_seed']} to {summary['last_seed']}"
    said = f"{summary['runs']} perturbed runs of {label} in {summary['arithmetic']}, {seeds}"
    values = {criterion.key: numbers(rows, column_of(criterion)) for criterion in run.judging.criteria}
    return Noise(number, said, address_of(folder, out), values)
