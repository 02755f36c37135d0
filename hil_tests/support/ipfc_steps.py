"""Ten single steps of the IPFC law with every intermediate."""

from __future__ import annotations

import json

from hil_tests.support.paths import TEST_DATA

VECTORS = json.loads((TEST_DATA / "ipfc" / "ipfc_step_vectors.json").read_text())

STEPS = {vector["name"]: vector for vector in VECTORS["ipfc_single_step"]}

BASIS = {"step": 1, "wavelet": 2}
