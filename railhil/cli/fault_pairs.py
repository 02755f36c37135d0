"""``railhil faults --pairs N``: runs with two random faults each; the rules of every run hold in each of them."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.common.output import Output, show_progress
from railhil.common.streams import print_json
from railhil.faults.random_faults import Sent, random_pair
from railhil.judge.reactions.evaluate import RULE, VERDICTS
from railhil.judge.result import Result
from railhil.run.make import NeverBegan, run_into
from railhil.scenarios.fault_list import list_disturbed_signals
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import System
from railhil.study.engines import in_order, processes, until_stopped
from railhil.study.faultless import can_inject_in, faultless_run

#: Verdicts with which a run may end.
_ENDS = ("PASS", "FAIL", "INVALID", "TOOL ERROR")


@dataclass(frozen=True, slots=True)
class PairVerdict:
    """One run. ``failures``: rules that it breaks, empty if it keeps all."""

    number: int
    faults: Sequence[str]
    verdict: str
    failures: list[str] = field(default_factory=list)

    @property
    def words(self) -> str:
        """The faults as words of a command line."""
        return " ".join(f"--fault {shlex.quote(fault)}" for fault in self.faults)

    def as_json(self) -> dict[str, Any]:
        """All fields."""
        return asdict(self)


def judged_pair(number: int, faults: Sequence[str], result: Result) -> PairVerdict:
    """The rules of every run, checked on one run."""
    verdict = VERDICTS.get(result.exit_code, f"exit code {result.exit_code}")
    failures = [text for text in result.score.failures if text.startswith(RULE)]
    if verdict not in _ENDS:
        failures.append(f"the run ended with {verdict}")
    if verdict == "TOOL ERROR":
        failures.append(f"tool error: {result.line}")
    return PairVerdict(number, faults, verdict, failures)


def pair_run(
    base: RunSpec,
    system: System,
    calm: tuple[float, Mapping[str, Sent]],
    out: Path,
    number: int,
) -> PairVerdict:
    """One random pair as a run; its folder is not kept: it can be made again from its faults.

    :param calm: of :func:`faultless_run`.
    """

    can_inject = partial(can_inject_in, system, base)
    pair = random_pair(number, calm[0], list_disturbed_signals(system), calm[1], can_inject)
    spec = replace(base, faults=pair, seed=number)
    with TemporaryDirectory(dir=out) as folder:
        try:
            result = run_into(Path(folder), spec, keep=False)
        except InputError as error:
            return PairVerdict(number, pair, "refused", [error.allowed])
        except NeverBegan as error:
            return PairVerdict(number, pair, "none", [str(error)])
    return judged_pair(number, pair, result)


def pairs(
    base: RunSpec,
    system: System,
    count: int,
    jobs: int,
    console: Output,
    keep: Callable[..., str],
    *,
    controller: str | None,
    as_json: bool,
) -> int:
    """Random pairs: number n is always the same pair. After a signal it prints the number of pairs made.

    :param keep: writes the table of all ``pairs``, and returns a line on its page.
    :param controller: the law that the user has named.
    :param as_json: print the verdicts as JSON.
    """
    numbers = range(base.seed, base.seed + count)
    counts: Counter[str] = Counter()
    all_made: list[PairVerdict] = []
    with until_stopped() as stop, TemporaryDirectory(prefix="railhil-faults-") as out:
        calm = faultless_run(base, Path(out))
        run_pair = partial(pair_run, base, system, calm, Path(out))
        with (
            processes(jobs, Output(stderr=True).say)(run_pair, numbers) as results,
            show_progress(console, "pairs", len(numbers)) as shown,
        ):
            for run in in_order(results):
                counts[run.verdict] += 1
                all_made.append(run)
                if run.failures:
                    console.say(f"pair {run.number}: {'; '.join(run.failures)}")
                    law = f" --controller {controller}" if controller else ""
                    console.say(f"  railhil run {base.scenario} --seed {run.number}{law} {run.words}")
                    console.file.flush()
                shown(counts.total(), "pairs")
    broken = [run for run in all_made if run.failures]
    line = keep(pairs=[run.as_json() for run in all_made]) if all_made else ""
    if as_json:
        print_json({"verdicts": counts, "broken": [run.as_json() for run in broken]})
    found = ", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items())) or "none made"
    pairs_made = count_of(len(numbers), "pair")
    made = f"{stop.after(counts.total(), len(numbers))} pairs" if stop.code else pairs_made
    console.say(f"{made}: {found}; {len(broken)} break a rule")
    if line:
        console.say(line)
    return stop.code or (FAIL if broken else INVALID if counts["none"] else PASS)
