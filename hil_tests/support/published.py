"""The published run, used to check that every transport gives the same bytes."""

from __future__ import annotations

#: SHA-256 of ``frames.log``: lvshun_tieshan, seed 0, ipfc, iq. It changes only with the wire contract or the scenario,
#: and the changelog then says so.
PUBLISHED_SHA256 = "214b90a5f5cd31e30519f74c95de92c6aa55c6c7acdb4a983af36e4463cbf569"
#: The same with wire version 5, and the first 32 bit of the hash of its port table (:mod:`hil_tests.support.wire_5`).
PUBLISHED_WIRE_5_SHA256 = "d0d8f27579d6989544ba1aa44e8e99983d30d70e476a934b8e7bff200fb44df6"
WIRE_5_HASH = 0xB30096AB
