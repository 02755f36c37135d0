"""The published run, used to check that every transport gives the same bytes."""

from __future__ import annotations

#: SHA-256 of ``frames.log``: lvshun_tieshan, seed 0, ipfc, iq. It changes only with the wire contract or the scenario,
#: and the changelog then says so.
PUBLISHED_SHA256 = "b72985ee2b4b8892684069c715ec5531f3063a31a91d26ba63c40d8ed0c4d1d0"
