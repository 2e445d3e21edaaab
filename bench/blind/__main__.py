"""``python -m bench.blind``: draw, diagnose, score.

python -m bench.blind [--rounds 8] [--seed 1000] [--jobs 2] [--json FILE] [--only WORD,…] [--every N] [--docs DIR]
python -m bench.blind --variants [--rounds 2] …: foreign laws that the library does not have
python -m bench.blind --forms [--rounds 2] …: laws of our own rig that are other forms of known causes
python -m bench.blind --mujoco [--rounds 20] …: rigs of a second author, ten a round
python -m bench.blind --score FILE... [--docs DIR]
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from pathlib import Path

from msd_ident import parallel

parallel.one_blas_thread()  # as the `msd` command does, before numpy is imported

from bench.blind import plan, told  # noqa: E402
from bench.blind.cases import Case, Outcome, run  # noqa: E402
from bench.blind.picture import draw  # noqa: E402

#: Plans besides the whole study.
_KINDS = {
    "variants": "laws that the library does not have, and nothing else",
    "forms": "laws of our own rig that are other forms of known causes, and nothing else",
    "mujoco": "rigs that MuJoCo simulates, ten a round, and nothing else",
}

_PAGE = """# Hidden causes, found or not

Made by `make blind` (`python -m bench.blind --docs docs`; the seeds are named below). The rig draws a plant, an
encoder and hidden effects from a seed and writes a file; the diagnosis gets only the path; then its
result is compared with the truth. Strengths range from invisible to dominating the motion.

- *Visible*: the base model, or the truth without any one of its effects, leaves at least 3 noise floors. Only what is
  visible must be found.
- *Exact*: nothing missing and nothing extra. A cause that is declared tied with the truth counts as the truth, unless
  more than three are tied; so does what is the same thing in every experiment ([identities](identities.md)).
- *False*: a cause is named that is neither in the rig nor the same as what is. It counts with every verdict, visible or
  not, tied or not, from a stated probability of 0.9 on.
- *Coloured* noise is first-order autoregressive with a memory of 1 to 20 samples, *speed* noise 2 to 10 times as large
  at top speed as at rest; all other cases have white noise. *Pairs* are two effects without Coulomb friction.

The exact sets are those of steps of two amplitudes in both directions, 6 s at 1 kHz.

![Confusion matrix and reliability](images/blind_study.png)

{tables}
"""


#: Pages of the other studies: file name and text.
_PAGES = {
    "variants": (
        "blind-variants.md",
        """# Laws that the library does not have

Made by `make blind ARGS="--variants"` (`python -m bench.blind --variants --docs docs`; the seeds are named below). Rigs
of `msd_sim/foreign`: known causes whose law has another form than any law of the library, one per rig, and noise or
forces that no cause explains. The diagnosis gets only the path of a file.

- *Family named*: a cause of the law's family is named, or tied with one that is, where the base model leaves at least 3
  noise floors. Laws without a relative in the library count as named.
- *A cause of no related law*: neither of the law's family nor what stands for a part of it (`bench/blind/truth.py`).

{tables}
""",
    ),
    "mujoco": (
        "blind-mujoco.md",
        """# Rigs of a second author

Made by `make blind ARGS="--mujoco"` (`python -m bench.blind --mujoco --docs docs`; the seeds are named below). MuJoCo
simulates a slide joint with frictionloss, limits, armature, and a drive with gain, lag, saturation or dead zone
(`bench/mujoco_rigs`, which imports neither the library nor our rig), drawn at random; solver steps are halved until the
record no longer changes by a tenth of its noise. Limits are MuJoCo's own constraint: half of them with its default
impedance, in which the stop replaces 90 % of all other forces instead of adding to them, half as a mere spring and
damper.

- *Visible*, *exact*, *false*: as in the [blind study](blind-study.md).
- *Interval*: the 95 % interval of the model with the named causes, against the truth per unit of command.

{tables}
""",
    ),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the study; exit code 0 whatever it finds, 1 when no case could be run."""
    parser = argparse.ArgumentParser(prog="python -m bench.blind", description="Hidden causes, found or not.")
    parser.add_argument("--rounds", type=int, default=8, help="rounds of all effects (about 110 cases each)")
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--json", type=Path, help="file for all outcomes, one JSON object a line")
    parser.add_argument(
        "--only",
        default="",
        metavar="WORD,…",
        help="cases with all of these: an experiment (steps, step, release, sweep, ramp), a rate in Hz, a noise "
        "(white, coloured, speed), a kind (clean, single, beside, pair, odd, variant), a hidden effect",
    )
    kinds = parser.add_mutually_exclusive_group()
    for name, what in _KINDS.items():
        kinds.add_argument(f"--{name}", action="store_const", dest="plan", const=name, default="study", help=what)
    parser.add_argument("--every", type=int, default=1, help="take every so many cases")
    parser.add_argument("--docs", type=Path, help="directory that gets the whole study's page and picture")
    parser.add_argument("--score", type=Path, nargs="+", help="only score outcomes written with --json before")
    given = parser.parse_args(arguments)
    failed = 0
    if given.score:
        lines = [line for path in given.score for line in path.read_text(encoding="utf-8").splitlines()]
        outcomes = [Outcome.from_json_dict(json.loads(line)) for line in lines]
    else:
        cases = chosen(getattr(plan, given.plan)(given.rounds, given.seed), given.only)[:: given.every]
        outcomes = _all(cases, given.jobs, given.json)
        failed = len(cases) - len(outcomes)
    if not outcomes:
        return 1
    seeds = [outcome.case.seed for outcome in outcomes]
    head = f"{len(outcomes)} blind cases, seeds {min(seeds)} to {max(seeds)}" + f"; {failed} failed" * (failed > 0)
    kind = _kind(outcomes)
    text = "\n".join([head, "", *(_TOLD[kind](outcomes))])
    print(text)
    part = bool(kind == "forms" or given.only or given.every > 1)
    if given.docs and part:
        print("\na part of the study: the documentation is left as it is")
    elif given.docs and kind in _PAGES:
        name, page = _PAGES[kind]
        (given.docs / name).write_text(page.format(tables=text), encoding="utf-8")
    elif given.docs:
        draw(outcomes, given.docs / "images" / "blind_study.png")
        (given.docs / "blind-study.md").write_text(_PAGE.format(tables=text), encoding="utf-8")
    return 0


#: Tables of each study.
_TOLD = {"study": told.report, "variants": told.variants, "forms": told.variants, "mujoco": told.second_author}


def _kind(outcomes: Sequence[Outcome]) -> str:
    """Which study these are of."""
    authors = {outcome.case.author for outcome in outcomes}
    if authors == {"own"}:
        return "forms" if all(outcome.case.kind == "variant" for outcome in outcomes) else "study"
    return "mujoco" if authors == {"mujoco"} else "variants"


def chosen(cases: Sequence[Case], words: str) -> list[Case]:
    """The cases that have all of these words, separated by commas."""
    asked = {word.strip() for word in words.split(",") if word.strip()}
    return [case for case in cases if asked <= case.words]


def _all(cases: Sequence[Case], jobs: int, path: Path | None) -> list[Outcome]:
    """All outcomes, written one by one: a study that is interrupted keeps what it has."""
    outcomes: list[Outcome] = []
    with ProcessPoolExecutor(jobs) as pool, nullcontext() if path is None else path.open("w") as file:
        for number, (case, outcome) in enumerate(zip(cases, pool.map(_safe, cases), strict=True), start=1):
            if isinstance(outcome, str):
                print(f"{number}/{len(cases)} {case}: failed\n{outcome}", file=sys.stderr, flush=True)
                continue
            outcomes.append(outcome)
            if file is not None:
                file.write(json.dumps(outcome.to_json_dict()) + "\n")
                file.flush()
            print(f"{number}/{len(cases)} {_line(outcome)}", file=sys.stderr, flush=True)
    return outcomes


def _line(outcome: Outcome) -> str:
    named = ", ".join(f"{name} {p:.2f}" + (f" ~ {'/'.join(t)}" if t else "") for name, p, t in outcome.named)
    mark, truth = "ok" if outcome.exact else "--", "+".join(outcome.truth) or "nothing"
    return (
        f"{mark} seed {outcome.case.seed} {outcome.case.experiment} {truth} "
        f"[{outcome.without_floors:.1f} of {outcome.base_floors:.1f}] -> {outcome.verdict}: {named or 'nothing'} "
        f"[{outcome.extended_floors:.2f}] {outcome.seconds:.1f} s"
    )


def _safe(case: Case) -> Outcome | str:
    try:
        return run(case)
    except Exception:  # a study goes on, and counts what failed
        return traceback.format_exc(limit=-3)


if __name__ == "__main__":
    sys.exit(main())
