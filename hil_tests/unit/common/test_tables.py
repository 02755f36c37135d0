"""No table cuts or breaks a number, however narrow the console is; in a wide one nothing changes."""

from __future__ import annotations

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.common.output import Output, table

_NUMBERS = st.one_of(
    st.floats(-1e9, 1e9).map(lambda value: f"{value:.4f}"),
    st.integers(-(10**12), 10**12).map(str),
    st.floats(1e-9, 1e9).map(lambda value: f"{value:.3e}"),
    st.floats(0, 1e4).map(lambda value: f"+-{value:.3f}"),
)
_CELLS = st.lists(
    st.one_of(_NUMBERS, st.sampled_from(("stopped", "to", "controller_node", "-"))), min_size=1, max_size=4
)


@pytest.mark.slow
@given(st.lists(st.lists(_CELLS, min_size=3, max_size=9), min_size=1, max_size=4), st.integers(10, 130), st.data())
def test_every_number_is_whole_at_every_width(rows: list[list[list[str]]], width: int, data: st.DataObject) -> None:
    console = Output()
    console.file, console.width = io.StringIO(), width
    columns = min(map(len, rows))
    made = table(tight=data.draw(st.booleans()))
    for place in range(columns):
        made.add_column(
            f"h{place}", justify=data.draw(st.sampled_from(("left", "right"))), no_wrap=data.draw(st.booleans())
        )
    for row in rows:
        made.add_row(*(" ".join(cell) for cell in row[:columns]))
    console.print(made)
    found = console.file.getvalue().split()
    for word in (word for row in rows for cell in row[:columns] for word in cell if any(map(str.isdigit, word))):
        assert word in found
    assert "…" not in console.file.getvalue()
