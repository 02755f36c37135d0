"""Figures of docs/reference/stopping.md."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from hil_tests.documents.figures import document, row


def _learned(text: str) -> list[str]:
    with tempfile.TemporaryDirectory(prefix="railhil-documents-") as folder:
        file = Path(folder) / "parameters.toml"
        file.write_text(f'law = "ilc_stop"\n[parameters]\nfilter = "kalman"\n{text}\n')
        words = ("learn", "yizhuang_stop_load", "--parameters", str(file), "--runs", "20", "--sequences", "20")
        found = document(*words)["measures"]["stop_error_m"]
    assert found["last"]["of"] == 7
    return [f"{one['rms']:.2f} m" for one in (*(found["by_run"][run] for run in (0, 4, 19)), found["last"])]


def load_classes() -> Sequence[str]:
    """Errors with another load and speed in each run."""
    return [
        row('`learning = "offset"`, `gamma = 0`', *_learned('learning = "offset"\ngamma = 0.0')),
        row('`learning = "rls_load"`', *_learned('learning = "rls_load"')),
    ]


def adhesion() -> Sequence[str]:
    """Low adhesion in all of 200 runs."""
    rows = []
    for name, share in (("announced", "1"), ("not announced", "0")):
        laws = document(
            "campaign", "yizhuang_stop_low_adhesion", "--laws", "reaim,ilc_stop", "--runs", "200",
            "--set", "task.rail.slide_share=1", "--set", f"task.rail.announced_share={share}",
        )["laws"]  # fmt: skip
        cells = []
        for law in ("reaim", "ilc_stop"):
            found = laws[law]["scores"]["stop_error_m"]
            values = found["median"]["value"], found["p95"]["value"]
            cells.append("{:.{n}f}, {:.{n}f} m".format(*values, n=3 if values[1] < 1 else 1))
        rows.append(row(name, *cells))
    return rows


def fixed_point() -> Sequence[str]:
    """``railhil audit``: commands and stops in fixed point and in float64."""
    rows = []
    for scenario, law in (
        ("yizhuang_stop", "ilc_stop"), ("yizhuang_stop_closed", "ilc_stop"), ("yizhuang_stop_closed", "reaim"),
    ):  # fmt: skip
        found = document("audit", scenario, "--controller", law)
        assert found["met"]
        codes = next(bar["found"] for bar in found["bars"] if bar["name"] == "u codes equal to float64's")
        effect = next(one for one in found["effect"] if one["score"] == "stop_error_m")
        share, steps = codes.split("% of ")
        rows.append(
            row(
                f"`{scenario}`, `{law}`", f"{share} % of {steps}",
                f"{effect['audited']:.4f}, {effect['reference']:.4f} m", f"{1000 * effect['largest_single']:.1f} mm",
            )
        )  # fmt: skip
    return rows
