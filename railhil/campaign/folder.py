"""The folder of a campaign: the manifest, which also serves as the lock, and parts that are complete or missing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyarrow as pa

from railhil.campaign.manifest import MANIFEST, manifest, read_manifest
from railhil.campaign.parts import PARTS, RESULTS, SUMMARY, PartsFolder, check_same, locked
from railhil.campaign.plan import Chunk, Plan
from railhil.campaign.results_table import file_bytes, read_part
from railhil.campaign.work import origin_of

__all__ = ["PARTS", "RESULTS", "SUMMARY", "CampaignFolder", "opened"]


class CampaignFolder(PartsFolder[Chunk]):
    """An open campaign folder, locked for this process: see :func:`opened`."""

    def __init__(self, path: Path, plan: Plan) -> None:
        def read(file: Path, chunk: Chunk) -> pa.Table:
            return read_part(file, origin_of(plan, chunk), chunk.entry.label, chunk.seeds, plan.judging)

        super().__init__(path, list(plan.chunks()), read)
        self._plan = plan

    def write_results(self) -> pa.Table:
        """Join all parts into ``results.parquet``, sorted by law and seed.

        :raises NotThePart: a part was damaged after it was written.
        :raises RecordFailed: the file cannot be written.
        """
        chunks = sorted(self._plan.chunks(), key=lambda chunk: (chunk.entry.label, chunk.index))
        table = pa.concat_tables([self.read(chunk).replace_schema_metadata() for chunk in chunks])
        self.write(Path(RESULTS), file_bytes(table, self._plan.subject_sha256))
        return table


@contextmanager
def opened(out: str | None, plan: Plan) -> Iterator[CampaignFolder]:
    """Begin a campaign in a new or empty folder, or resume the one in it, see :func:`railhil.campaign.parts.locked`.

    :param out: the folder; None: ``runs/<utc>-<scenario>-campaign/``.
    """

    def check(path: Path) -> None:
        check_same(path / MANIFEST, "campaign", read_manifest(path).campaign, plan.identity)

    with locked(out, (plan.scenario.name, "campaign"), "campaign", MANIFEST, manifest(plan), check) as path:
        yield CampaignFolder(path, plan)
