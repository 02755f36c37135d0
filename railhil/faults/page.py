"""``docs/reference/faults.md``: the fault language, all words and the places where each can be injected.

The page is made from the tables of this package.

``python -m railhil.faults.page`` writes it; a test compares the file with the generated text.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from railhil.faults.capability import PACES, REFUSALS, TRANSPORTS, Refusal
from railhil.faults.model import Parameter, Word
from railhil.faults.notation import allowed_text, number_text
from railhil.faults.words import CLEAR, PLACES, WORDS, levels_of

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "faults.md"
_HEAD = """\
# Faults

Written by `python -m railhil.faults.page` from the tables that check the faults.

```sh long
railhil run --fault "TRN_SPEED loss 30% @20s for 5s"               # may be given several times
railhil run --bus local --fault "controller kill @1200m"
railhil faults --list                                              # this page's words on the console
railhil faults yizhuang_05 --only T2,N1                            # entries of the catalogue; without --only all
railhil faults yizhuang_05 --pairs 100                             # random pairs of faults
```

A fault is one line: `WHERE WHAT [values] @WHEN [for HOWLONG | xCOUNT | until EVENT] [seed N]`, the same on the
command line, in a run file (`faults = ["..."]`) and in a scenario file (`fault = ["..."]`). A scenario file may
also hold tables:

```toml
[[fault]]
where = "NOTCH_CMD.counter"         # a port, PORT.counter, PORT.checksum, PORT.Signal, or one of the places below
what = "freeze"                     # a word of that place
# or "60 s", "1200 m", { event = "braking" }, { telegram = 4711 }, "manual"
when = { speed = "60 km/h", edge = "rising", delay = "2 s" }
count = 5                           # or for = "2 s", or until = "standstill"; without any it lasts to the end
after = "last_valid"                # what comes after it, see the words
expect = { level = "SERVICE BRAKE", within = "500 ms", detected_by = "command_age", verdict = "PASS" }
id = "T9"                           # name in a catalogue
```

Further keys: `with = { share = "30%" }` (values by name), `units = [1, 3]` (of a train with several), `seed`,
`combine`. The text has the same words: `after last_valid units 1,3 seed 7 combine id T9 expect SERVICE_BRAKE within
500ms by command_age verdict PASS`.

**When.** `@60s` time, `@1200m` position of the train's front, `@v>60km/h` and `@v<5km/h` crossing of a speed,
`@#4711` the n-th telegram of the port, `@manual` by hand; `@braking`, `@traction`, `@standstill`, `@departed`,
`@stopped` and the levels of the watches (`@traction_cut`, `@service_brake`, `@emergency`) are events. `+2s` behind
any of them: later. The simulated truth decides all of these at the instants at which it is sent, so a run gives the
same bytes again. `braking`: the train decelerates by 0.3 m/s² or more; `traction`: there is traction force.

**Values.** A value may be a distribution, `uniform(0.9,1.1)` or `normal(0,0.1)`: it is drawn once per run with the
run's seed. The certificate (`injected`) holds the drawn value, and that text makes the run again. Random losses and
bit errors are drawn with the run's seed too, or with `seed N`.

**One at a time.** Two faults on one target are refused unless their times exclude each other or both say `combine`.
Signals change first, then the telegram, then the bus. `ok` ends the active faults at a place.

**Where it acts.** A fault of a telegram acts where the telegram leaves its source: record and receivers get the changed
telegram. `faults.csv` in the run folder lists each change with the values before and after it. The telegrams by which
the bench itself observes the run (`SUP_CMD`, `RUN_EVENT`, the truth, the handshake) are never disturbed, and the level
of the train's own watch (`TRN_WATCH`) not by faults of the whole bus. A polled telegram can be sent late only in place
of a later answer. In lockstep the bus administrator waits for the answer to each poll: if there is none, the source
sends an empty frame on the telegram's last identifier instead, counted as `no_answer`. In real time nothing is sent.

**Error counters and lines** come from the hub's model ([hub](../howto/hub.md)): `railhil run` starts its hub with
`--faults` when a fault needs it. The plant gives the orders between its own frames, so a run gives the same bytes
again. Plant and controller are disturbed, not the supervisor, and the plant itself never becomes bus-off. The hits are
reports of the plant's CAN controller: error frames, error-passive, another trusted line, answers that no line carries.
A line that no node trusts (`bus.b` at the start) can be open without any effect, and such a run is INVALID.

**A fault that never began, or changed nothing, makes the run INVALID**; the reason names it. A fault `@manual` that was
not ordered does not. **What a fault expects** (`expect`) is judged: if the run does not show it, the verdict is FAIL
with the expected and the actual reaction.

**The catalogue** (`railhil/judge/reactions/catalogue.toml`) has the faults with the reaction that each must lead
to and its time. `railhil faults` runs them, one run each, and prints time and cause of each detection, and the reaction
with its bound. Exit code 1: a reaction is not as it must be, 3: nothing was run. Each entry has a level that must be
reached (`reaction`, and `steps` on the way), a cause (`detected`), a time (`within_ms`) and forbidden reactions
(`at_most`, `ends`, and in all of them a broken rule of every run); an entry without one of them is refused. Entries
that need the hub's controllers, its lines or a process of its own (B1, B2, B7, N5) run on a hub; K2 runs on it in real
time and takes as long as the run. Entries whose trigger does not occur on the scenario, or that are tested elsewhere,
are counted as entries without a run. With `--pairs N` it makes N runs with two random faults each and checks the rules
that hold in every run. The faults of a pair begin about a second apart, and faults of telegrams while the run sends
them, so that most runs have a verdict. The rules are checked in the other runs, too. For many pairs a short journey is
enough (`hil_tests/data/pairs.toml`). A signal (Ctrl-C, `timeout`) ends all processes of the command at once; it prints
the results so far.

Nodes that are started by hand (`railhil node`, `railhil run --attach`) are given the same faults and the same
`--seed`, also the controller, and write their logs with `--fault-log FOLDER`, the run folder, or any folder that
`railhil run --attach --fault-logs FOLDER` is given.
"""
_TITLES = {
    "train": "Train",
    "sensor": "Sensors",
    "actuator": "Actuators",
    "command": "Commands",
    "clock": "Clock",
    "telegram": "Telegrams",
    "node": "Nodes",
    "bus": "Bus",
}
_PARTS = {"counter": "`PORT.counter`", "checksum": "`PORT.checksum`", "signal": "`PORT.Signal`", "line": "`bus.a`"}


def page() -> str:
    """The whole page."""
    text = _HEAD
    for level, words in levels_of().items():
        text += f"\n## {_TITLES[level]}\n\n"
        places = [f"`{name}` ({what})" for name, what in PLACES.get(level, {}).items() if name]
        text += f"Places: {'; '.join(places)}.\n\n" if places else ""
        text += "| word | values | what | after | from |\n|---|---|---|---|---|\n"
        for word in words:
            if word.name != CLEAR:
                text += f"| {' | '.join(row(word))} |\n"
    text += "\n## What can be injected where\n\n"
    text += "Everything above can be injected on each of these, except for the faults of the second table. These are\n"
    text += "refused in one line before the run begins.\n\n| transport | what it is |\n|---|---|\n"
    text += "".join(f"| {name} | {what} |\n" for name, what in TRANSPORTS.items())
    text += "\n| not injected | on | pace | why |\n|---|---|---|---|\n"
    text += "".join(f"| {' | '.join(_refusal(entry))} |\n" for entry in REFUSALS)
    return text


def row(word: Word) -> list[str]:
    """A word as cells: name with its place, values, meaning, words after it, origin."""
    at = _PARTS.get(word.part) or (", ".join(f"`{name}`" for name in word.names))
    values = "; ".join(_parameter(one) for one in word.parameters) or "-"
    after = ", ".join(f"`{one}`" for one in word.after) or "-"
    return [f"`{word.name}`{f' of {at}' if at else ''}", values, word.meaning, after, word.origin]


def _parameter(one: Parameter) -> str:
    usual = (
        "required"
        if one.usual is None
        else one.usual
        if isinstance(one.usual, str)
        else number_text(one.usual, one.unit)
    )
    keyword = f"`{one.keyword}` " if one.keyword else ""
    return f"{keyword}`{one.name}` {one.meaning} ({usual}; as in {allowed_text(one.unit)})"


def _refusal(entry: Refusal) -> list[str]:
    words = [word for word in WORDS if entry.fits(word, "") or any(entry.fits(word, name) for name in entry.names)]
    levels = entry.levels or tuple(levels_of())
    what = ", ".join(entry.words) or ("lines" if entry.parts else "everything")
    assert words, entry.why
    of = "" if len(levels) == len(levels_of()) else f" of {', '.join(entry.names or levels)}"
    at = f" at the {', '.join(entry.sources)}" if entry.sources else ""
    return [f"{what}{of}{at}", ", ".join(entry.transports) or "all", ", ".join(entry.paces or PACES), entry.why]


def lines() -> Iterator[str]:
    """All words for the console, level by level."""
    for level, words in levels_of().items():
        names = ", ".join(name for name in PLACES.get(level, {}) if name) or level
        yield f"{level} ({names if level != 'telegram' else 'PORT, PORT.counter, PORT.checksum, PORT.Signal'})"
        for word in words:
            if word.name != CLEAR:
                name, values, meaning, *_ = (cell.replace("`", "") for cell in row(word))
                yield f"  {name}: {meaning}" + ("" if values == "-" else f" [{values}]")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    sys.stdout.write(f"{PAGE}\n")
