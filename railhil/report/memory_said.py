"""What a record says of the memory of its law."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from railhil.common.digits import count_of


def memory_sentence(certificate: Mapping[str, Any]) -> str:
    """The memory of its law with which a run began and ended; empty for a run without one."""
    before, after = certificate.get("memory"), certificate.get("memory_after_sha256")
    if not before and not after:
        return ""
    # Few records have a memory.
    from railhil.scenarios.parameters import DIGEST_DIGITS

    began, stored = "none yet", before["stored"] if before else []
    used = certificate.get("memory_used")
    # Without it the run cannot be trusted: the law would have used the first.
    record = next((one["record"] for one in stored if one["record"] and used in (None, one["slot"])), None)
    if before and record:
        began = (
            f"that of {count_of(record['runs'], 'run')}, key {record['key']}, sha256 {before['sha256'][:DIGEST_DIGITS]}"
        )
    refused = "".join(
        f"; {slot} could not be used: {detail}" for slot, (_, detail) in certificate.get("memory_refused", {}).items()
    )
    return f"began with {began}{refused}; {f'left sha256 {after[:DIGEST_DIGITS]}' if after else 'left none'}"
