"""The telegrams in which a law over several units reports: notes, events of the arithmetic, number of steps."""

from __future__ import annotations

from railhil.bus.layout import Telegram
from railhil.controller_node.vector.controller import VectorOutput
from railhil.controller_node.vector.law import Interface


def status_telegram(
    interface: Interface, kind: type[Telegram], output: VectorOutput | None, steps: int, life: int
) -> Telegram:
    """One of an interface's statuses; a note is limited to the range of its signal, so that a large one ends no run.

    :param output: the law's last result; None before its first step.
    :param steps: of the law since the start of the run.
    :param life: life sign of the telegram.
    """
    ranges = {name: signal.raw_range for name, signal in kind.signals()}
    fields = {"step_count": steps & 0xFFFF, "life": life}
    if output is not None:
        fields["overflow_flags"] = output.overflow_flags
        for note, raw in zip(interface.notes, output.notes, strict=True):
            if interface.status_of(note) is kind:
                low, high = ranges[note.field]
                fields[note.field] = min(max(raw, low), high)
    return kind(**{name: value for name, value in fields.items() if name in ranges})
