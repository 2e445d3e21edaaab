"""``python -m bench.blind``: draw, diagnose, score.

python -m bench.blind [--rounds 8] [--seed 1000] [--jobs 2] [--json FILE] [--only EXPERIMENT]
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from bench.blind import plan, score
from bench.blind.cases import Case, Outcome, run


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the study; exit code 0 whatever it finds."""
    parser = argparse.ArgumentParser(prog="python -m bench.blind", description="Hidden causes, found or not.")
    parser.add_argument("--rounds", type=int, default=8, help="rounds of all effects (about 78 cases each)")
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--json", type=Path, help="file for all outcomes, one JSON object a line")
    parser.add_argument("--only", help="experiment to keep (steps, step, release, sweep, ramp)")
    parser.add_argument("--every", type=int, default=1, help="take every so many cases")
    given = parser.parse_args(arguments)
    cases = plan.study(given.rounds, given.seed)[:: given.every]
    if given.only:
        cases = [case for case in cases if case.experiment == given.only and case.rate == 1000.0]
    outcomes = _all(cases, given.jobs)
    if given.json:
        given.json.write_text("".join(json.dumps(outcome.to_json_dict()) + "\n" for outcome in outcomes))
    print("\n".join(_told(outcomes, given.seed)))
    return 0


def _all(cases: Sequence[Case], jobs: int) -> list[Outcome]:
    outcomes: list[Outcome] = []
    with ProcessPoolExecutor(jobs) as pool:
        for number, (case, outcome) in enumerate(zip(cases, pool.map(_safe, cases), strict=True), start=1):
            if isinstance(outcome, str):
                print(f"{number}/{len(cases)} {case}: failed\n{outcome}", file=sys.stderr, flush=True)
                continue
            outcomes.append(outcome)
            named = ", ".join(f"{name} {p:.2f}" + (f" ~ {'/'.join(t)}" if t else "") for name, p, t in outcome.named)
            mark, truth = "ok" if outcome.exact else "--", "+".join(outcome.truth) or "nothing"
            print(
                f"{number}/{len(cases)} {mark} seed {case.seed} {case.experiment} {truth} "
                f"[{outcome.without_floors:.1f} of {outcome.base_floors:.1f}] "
                f"-> {outcome.verdict}: {named or 'nothing'} "
                f"[{outcome.extended_floors:.2f}] {outcome.seconds:.1f} s",
                file=sys.stderr,
                flush=True,
            )
    return outcomes


def _safe(case: Case) -> Outcome | str:
    try:
        return run(case)
    except Exception:  # a study goes on, and counts what failed
        return traceback.format_exc(limit=-3)


def _told(outcomes: Sequence[Outcome], seed: int) -> list[str]:
    lines = [
        f"Blind study: {len(outcomes)} cases from seed {seed}",
        "",
        "| figure | got | of | must | aim |",
        "|---|---|---|---|---|",
    ]
    for item in score.figures(outcomes):
        lines.append(f"| {item.what} | {item.percent:.1f} % | {item.total} | {item.must} | {item.aim} |")
    seconds = [o.seconds for o in score.main_experiment(outcomes)]
    lines += [
        f"| held-out SEE over noise, median when right | {score.heldout(outcomes):.3f} | | <= 1.2 | 1.05 |",
        f"| removable error removed, median | {100.0 * score.removed(outcomes):.1f} % | | | |",
        f"| seconds a diagnosis, median | {np.median(seconds):.2f} | {len(seconds)} | <= 2 | 0.5 |",
        f"| seconds a diagnosis, longest | {max(seconds):.2f} | {len(seconds)} | | |",
        "", "| stated probability | causes | mean stated | observed |", "|---|---|---|---|",
    ]  # fmt: skip
    for low, high, count, stated, observed in score.reliability(outcomes):
        lines.append(f"| {low:.2f} to {high:.2f} | {count} | {stated:.3f} | {observed:.3f} |")
    lines += ["", "| hidden and visible | named as (number) |", "|---|---|"]
    for name, answers in sorted(score.confusion(outcomes).items()):
        lines.append(f"| {name} | {', '.join(f'{answer} ({n})' for answer, n in answers.most_common())} |")
    lines += ["", "| effect | always found from (noise floors left without it) |", "|---|---|"]
    lines += [f"| {name} | {size:.1f} |" for name, size in score.smallest(outcomes).items()]
    return lines


if __name__ == "__main__":
    sys.exit(main())
