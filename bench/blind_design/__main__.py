"""``python -m bench.blind_design``: how often designed experiments find what one force step leaves open.

python -m bench.blind_design [--runs 200] [--seed 1] [--jobs 2] [--minutes M] [--json FILE] [--effects NAME,…]
    [--compare 2] [--docs DIR]
python -m bench.blind_design --score FILE… [--docs DIR]
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.blind_design.cases import Case, Outcome, run
from msd_sim import lottery

#: Effects of which a linear spring and a free zero leave no trace: an identity, not a matter of experiments.
_IDENTITY = "force_offset"
_BINS = (0.0, 0.5, 0.8, 0.95, 1.0001)


_PAGE = """# Blind study of designed experiments

Made by `make blind-design` (`python -m bench.blind_design --docs docs`; the seeds are named below). Random rigs have a
hidden effect, alone or with Coulomb friction. The first experiment is one force step. In the rigs that it does not
decide, `investigate` continues with at most two designed experiments of at most 20 s each within the rig's limits. It
gets only the records. Its result is then compared with the truth.

- *Decided*: the verdict is `adequate` or `explained`.
- *True set*: the named causes are exactly the hidden ones, and none is tied.
- *Not decided by one step*: the diagnosis of the step is not decided, or does not name the true set.
- *Random steps*: they replace the first designed experiment, in a part of the cases, and last 3 times as long.

Rigs with a hidden force offset are counted separately: with a linear spring it is a shifted zero.

{table}
"""


def cases(seed: int, names: Sequence[str]) -> Iterator[Case]:
    """These effects in turn, alone and beside friction, without end."""
    turn = 0
    while True:
        for index, name in enumerate(names):
            yield Case(seed + turn * len(names) + index, name, turn % 2 == 0)
        turn += 1


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the study; exit code 0 whatever it finds."""
    parser = argparse.ArgumentParser(prog="python -m bench.blind_design", description="Designed experiments, blind.")
    parser.add_argument("--runs", type=int, default=200, help="rigs to investigate, which one step does not decide")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--minutes", type=float, default=math.inf, help="begin no case after this time")
    parser.add_argument("--json", type=Path, help="file that gets every case as it is done, one JSON object a line")
    parser.add_argument("--score", type=Path, nargs="+", help="score what --json wrote, instead of a run")
    parser.add_argument("--effects", default=",".join(lottery.NAMES), help="hidden effects to draw from")
    parser.add_argument("--compare", type=int, default=2, help="every Nth case also with random steps; 0: none")
    parser.add_argument("--docs", type=Path, help="directory that gets blind-design.md")
    given = parser.parse_args(arguments)
    done = [Done.from_json_dict(line) for path in given.score for line in _lines(path)] if given.score else _all(given)
    table = "\n".join(told(done))
    print(table)
    if given.docs:
        (given.docs / "blind-design.md").write_text(_PAGE.format(table=table), encoding="utf-8")
    return 0


@dataclass(frozen=True)
class Done:
    """A case that is done: its outcome where one step leaves the truth open, or how it failed."""

    case: Case
    outcome: Outcome | None
    failure: str = ""

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)

    @classmethod
    def from_json_dict(cls, values: Mapping[str, Any]) -> Done:
        """What ``to_json_dict`` gave."""
        outcome = values["outcome"]
        return cls(Case(**values["case"]), Outcome.from_json_dict(outcome) if outcome else None, values["failure"])


def _lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def _all(given: argparse.Namespace) -> list[Done]:
    """Cases in turn until enough of them were open; each is on the disk as soon as it is done."""
    all_done: list[Done] = []
    found, began = 0, time.monotonic()
    source = cases(given.seed, given.effects.split(","))
    with ProcessPoolExecutor(given.jobs) as pool:
        jobs: set[Future[Done]] = set()
        while jobs or not all_done:
            while len(jobs) < 2 * given.jobs and found < given.runs and time.monotonic() - began < 60.0 * given.minutes:
                case = next(source)
                jobs.add(pool.submit(_safe, case, bool(given.compare) and case.seed % given.compare == 0))
            ready, jobs = wait(jobs, return_when=FIRST_COMPLETED)
            for done in (job.result() for job in ready):
                all_done.append(done)
                if given.json:
                    with given.json.open("a", encoding="utf-8") as file:
                        file.write(json.dumps(done.to_json_dict()) + "\n")
                if done.outcome is not None:
                    found += 1
                    _show(found, done.outcome)
                elif done.failure:
                    print(f"{done.case}: failed\n{done.failure}", file=sys.stderr, flush=True)
    return all_done


def _safe(case: Case, compare: bool) -> Done:
    try:
        return Done(case, run(case, compare))
    except Exception:  # a study goes on, and counts what failed
        return Done(case, None, traceback.format_exc(limit=-3))


def _show(number: int, o: Outcome) -> None:
    print(
        f"{number} {'ok' if o.right else '--'} seed {o.case.seed} {'+'.join(o.truth) or 'nothing'}: {o.first[0]} "
        f"{'+'.join(o.first[1])} -> {o.verdict} {'+'.join(o.found)} in {o.runs} runs, stated {o.expected:.2f} "
        f"decided {o.decided} true {o.true_after_one} random {o.random_decided}/{o.random_true} "
        f"limit {o.worst:.2f} design {o.design_seconds:.1f} s",
        file=sys.stderr,
        flush=True,
    )


def told(done: Sequence[Done]) -> list[str]:
    """The study's table."""
    outcomes = [one.outcome for one in done if one.outcome is not None]
    fair = [o for o in outcomes if _IDENTITY not in o.truth]
    compared = [o for o in fair if o.random_decided is not None]
    failed = [False] * sum(bool(one.failure) for one in done)
    lines = [
        f"{len(done)} rigs, seeds {min(one.case.seed for one in done)} to {max(one.case.seed for one in done)}; "
        f"{len(outcomes)} not decided by one step; {len(failed)} ended in an error and count as wrong",
        "",
        "| quantity | result | cases | required | goal |",
        "|---|---|---|---|---|",
        _row("decided with the true set at the end", [o.right for o in fair] + failed, ">= 95 %", "99 %"),
        _row("the same, with the rigs that have a force offset", [o.right for o in outcomes] + failed, "", ""),
        _row("a limit of the rig exceeded", [o.worst > 1.0 + 1e-9 for o in outcomes], "0", "0"),
        _row("decided after one designed experiment", [o.decided for o in compared], "", ""),
        _row("decided after random steps", [bool(o.random_decided) for o in compared], "<= designed", ""),
        _row("true set after one designed experiment", [o.true_after_one for o in compared], "", ""),
        _row("true set after random steps", [bool(o.random_true) for o in compared], "<= designed", ""),
    ]
    if outcomes:
        slow = [o.design_seconds for o in outcomes]
        timed = "processor time of the slowest design of a case [s]"
        lines.append(f"| {timed}, median | {np.median(slow):.2f} | {len(slow)} | <= 5 | 1 |")
        lines.append(f"| {timed}, longest | {max(slow):.2f} | {len(slow)} | | |")
        lines.append(f"| largest used part of a limit | {max(o.worst for o in outcomes):.3f} | | <= 1 | |")
    return lines + _calibration(fair) + _by_effect(done) + _missed(done)


def _missed(done: Sequence[Done]) -> list[str]:
    """Every case that is not decided with the true set at the end, with its seed."""
    lines = [
        f"- seed {o.case.seed}: true {' + '.join(o.truth)}; result {o.verdict}, {' + '.join(o.found) or 'no cause'}"
        for o in (one.outcome for one in done if one.outcome is not None and not one.outcome.right)
    ]
    lines += [
        f"- seed {one.case.seed}, {one.case.hidden}: {one.failure.strip().splitlines()[-1]}"
        for one in done
        if one.failure
    ]
    return ["", "Cases that are not decided with the true set at the end:", "", *lines] if lines else []


def _by_effect(done: Sequence[Done]) -> list[str]:
    """Of each effect: rigs, those that one step does not decide, and those decided with the true set at the end."""
    lines = [
        "",
        "| hidden effect | rigs | not decided by one step | of these decided with the true set |",
        "|---|---|---|---|",
    ]
    for name in sorted({str(one.case.hidden) for one in done}):
        of_it = [one for one in done if str(one.case.hidden) == name]
        opened = [one.outcome for one in of_it if one.outcome is not None]
        lines.append(f"| {name} | {len(of_it)} | {len(opened)} | {sum(o.right for o in opened)} |")
    return lines


def _row(what: str, hits: Sequence[bool], must: str, aim: str) -> str:
    share = 100.0 * sum(hits) / len(hits) if hits else math.nan
    return f"| {what} | {share:.1f} % | {len(hits)} | {must} | {aim} |"


def _calibration(outcomes: Sequence[Outcome]) -> list[str]:
    """Stated probabilities and observed shares: that a tie is decided, and that a check names the true set."""
    known = [o for o in outcomes if math.isfinite(o.expected)]
    ties = [(o.expected, o.decided) for o in known if o.purpose.startswith("to tell")]
    checks = [(o.expected, o.true_after_one) for o in known if not o.purpose.startswith("to tell")]
    lines = ["", "| event and its stated probability | designs | mean stated | observed share |", "|---|---|---|---|"]
    for what, pairs in (("tie decided", ties), ("hidden cause shown: true set named", checks)):
        for low, high in zip(_BINS[:-1], _BINS[1:], strict=True):
            lines += _reliability(
                f"{what}, {low:.2f} to {min(high, 1.0):.2f}", [p for p in pairs if low <= p[0] < high]
            )
        lines += _reliability(f"{what}, all", pairs)
    return lines


def _reliability(what: str, pairs: Sequence[tuple[float, bool]]) -> list[str]:
    if not pairs:
        return []
    stated, came = (float(np.mean(column)) for column in zip(*pairs, strict=True))
    return [f"| {what} | {len(pairs)} | {stated:.3f} | {came:.3f} |"]


if __name__ == "__main__":
    sys.exit(main())
