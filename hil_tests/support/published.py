"""The published run, used to check that every transport gives the same bytes."""

from __future__ import annotations

#: SHA-256 of ``frames.log``: lvshun_tieshan, seed 0, ipfc, iq. It changes only with the wire contract or the scenario,
#: and the changelog then says so.
PUBLISHED_SHA256 = "f91bdd61118c0be70f288904ff7309553d3ea4a43cb4e794091d9f93e623a835"
