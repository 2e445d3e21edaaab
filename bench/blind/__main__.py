"""``python -m bench.blind``: draw random rigs, diagnose their records, count how often the result is the truth.

python -m bench.blind [--rounds 8] [--seed 1000] [--jobs 2] [--json FILE] [--only WORD,…] [--every N] [--docs DIR]
python -m bench.blind --variants [--rounds 2] …: foreign laws that the library does not have
python -m bench.blind --variant-pairs [--rounds 4] …: two such laws at once, ten rigs a round
python -m bench.blind --forms [--rounds 2] …: other forms of known causes, on the simulated rig of this project
python -m bench.blind --mujoco [--rounds 20] …: rigs that MuJoCo simulates, ten a round
python -m bench.blind --several [--rounds 4] …: rigs with three to five faults at once, ten a round
python -m bench.blind --score FILE... [--docs DIR]: of one study, or the calibration over several
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from pathlib import Path

from msd_ident import parallel

parallel.one_blas_thread()  # as the `msd` command does, before numpy is imported

from bench.blind import plan, told  # noqa: E402
from bench.blind.cases import CRASHED, Case, Outcome, run  # noqa: E402
from bench.blind.picture import draw  # noqa: E402

#: Plans besides the whole study.
_KINDS = {
    "variants": "only laws that the library does not have",
    "variant_pairs": "only rigs with two such laws at once, ten a round",
    "forms": "only other forms of known causes, on the simulated rig of this project",
    "mujoco": "only rigs that MuJoCo simulates, ten a round",
    "several": "only rigs with three to five faults at once, ten a round",
}

_PAGE = """# Blind study

Made by `make blind` (`python -m bench.blind --docs docs`; the seeds are named below). In each case a seed determines a
plant, an encoder and hidden effects. The simulated rig writes a record, and the diagnosis gets only the path of the
file. The result is then compared with the truth. Strengths range from invisible to dominating the motion.

- *Visible*: the base model leaves at least 3 noise floors. With two hidden effects, the true model without the less
  visible one, refitted, must leave as much. Only visible effects must be found.
- *Exact*: the named set of causes equals the true set. A named cause that is tied with a true one counts as the true
  one if at most three are tied. A set that is equivalent to the true set in every experiment counts as the true set
  ([identities](identities.md)).
- *False*: a named cause that is in no set equivalent to the true one. It counts with every verdict, whether or not the
  hidden effect is visible, and whether or not the cause is tied.
- *Unknown law*: the hidden law is not in the library. A named cause of the same family is then not false
  (`bench/blind/truth.py` has the families).
- *Coloured* noise is first-order autoregressive with a memory of 1 to 20 samples. *Speed* noise is 2 to 10 times as
  large at top speed as at rest. All other cases have white noise.
- *Calibration*: every cause with a stated probability of at least 0.01, named or in a rival set. It is right only if it
  acts itself, not if another one tied with it does. Causes that no experiment can decide are left out.

Unless a row says otherwise, the experiment is steps of two amplitudes in both directions, 6 s at 1 kHz.

![Confusion matrix and reliability](images/blind_study.png)

{tables}
"""


#: Pages of the other studies: file name and text.
_PAGES = {
    "variants": (
        "blind-variants.md",
        """# Laws that the library does not have

Made by `make blind ARGS="--variants"` (`python -m bench.blind --variants --docs docs`; the seeds are named below). Each
rig has one law of `msd_sim/foreign`: a known cause whose law has a form that the library lacks, or noise or a force
that no cause of the library explains. Two of them are no longer foreign: `elliptic_wheel` and `modulated_tone` are
special cases of `eccentricity_harmonic` and `modulated_disturbance`. The diagnosis gets only the path of a file.

- *Visible*: the base model leaves at least 3 noise floors.
- *Family*: the causes of the library that describe the law or a part of it (`bench/blind/truth.py`). It is named if one
  of its causes is named or tied with a named one. Where no cause has to be named, every visible case counts.
- *False*: a named cause outside the family. A force offset is not false: with a linear spring it is a shifted zero.
- *m and k within 2 %*: both relative errors are at most 2 %; in a free decay, the error of k/m. k is the slope at
  rest: where the diagnosis states `stiffness_at_rest`, and no constant force is hidden, that is compared.
- *Covered*: m and k are within 2 % of their stated range: the 95 % interval, and the `spread` if there is one.

{tables}
""",
    ),
    "variant_pairs": (
        "blind-variant-pairs.md",
        """# Two laws that the library does not have

Made by `make blind ARGS="--variant-pairs"` (`python -m bench.blind --variant-pairs --docs docs`; the seeds are named
below). Each rig has two laws of `msd_sim/foreign` at once, of different kinds: a friction and a spring, a drive and a
sensor. What the law of one leaves unexplained can look like a further cause, and the other is one. Half of the rigs are
released, half are pushed in steps. The diagnosis gets only the path of a file.

- *Visible*, *family*, *false*, *m and k*: as in the study of [one such law](blind-variants.md). What is said of
  families counts visible rigs.

{tables}
""",
    ),
    "several": (
        "blind-several.md",
        """# Rigs with several faults

Made by `make blind ARGS="--several"` (`python -m bench.blind --several --docs docs`; the seeds are named below). Each
rig has three to five faults at once, of 20 kinds, from faint to plain. `bench/several_faults` simulates it with
Runge-Kutta steps of its own and imports neither `msd_ident` nor `msd_sim`: its friction creeps, its force is held
between the samples, its noise is white and rounded. The diagnosis gets only the path of a file.

- *Plain*: without the fault, the readings change by at least 30 noise floors. Nothing is refitted, so other parameters
  may take over a part of that.
- *Named*: it, or another law of the same cause, or a cause tied with it where at most three are tied. Dry friction
  whose form (peak, change along the travel) changes the readings by less than a noise level counts as Coulomb friction.
- *False*: a named cause that is in no set equivalent to the true one ([identities](identities.md)), with every verdict.
- *m and k*, and the intervals: compared with those of small motions about the place where the springs balance a
  constant force, for each metre that the sensor reads there ([identities](identities.md)).

{tables}
""",
    ),
    "together": (
        "calibration.md",
        """# Calibration

Made by `python -m bench.blind --score FILE... --docs docs` from the outcomes (`--json`) of several studies: the
[blind study](blind-study.md), [laws that the library does not have](blind-variants.md), [MuJoCo's
rigs](blind-mujoco.md), [rigs with several faults](blind-several.md), [two unknown laws](blind-variant-pairs.md). The
tables below name those that were given.

A stated probability is right if the causes that are named with it are right as often. A lab's rig does not follow the
laws of a library exactly, so the probabilities allow for other forms of the laws. Where the rig follows the library,
they may be lower than the share that is right.

- *Named causes*: each with the probability that stands on the page, whatever the verdict. Where others are tied with
  it, the page also states the probability that one of them acts.
- *Right*: the cause acts, or it is of the family of a law that acts (`bench/blind/truth.py`). Where two causes of
  such a family are tied, both are right, but each has a part of the probability: there the second tables tell more.

{tables}
""",
    ),
    "mujoco": (
        "blind-mujoco.md",
        """# Rigs of a second author

Made by `make blind ARGS="--mujoco"` (`python -m bench.blind --mujoco --docs docs`; the seeds are named below). MuJoCo
simulates a slide joint with frictionloss, limits, armature, and a drive with gain, lag, saturation or dead zone. All
values are drawn at random. `bench/mujoco_rigs` imports neither `msd_ident` nor `msd_sim`. Solver steps are halved until
the record changes by less than a tenth of its noise. Limits are MuJoCo's own constraint. Half of them have its default
impedance: the stop then replaces 90 % of all other forces instead of adding to them. The other half are a spring and a
damper.

- *Visible*, *exact*, *false*: as in the [blind study](blind-study.md).
- *Interval*: whether the 95 % interval of the extended model contains the true value per unit of command.
- *Covered*: m and k are within 2 % of their stated range: the 95 % interval, and the `spread` if there is one.

{tables}
""",
    ),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the study; exit code 0 whatever it finds, 1 where there are no cases."""
    parser = argparse.ArgumentParser(prog="python -m bench.blind", description="How often hidden effects are named.")
    parser.add_argument("--rounds", type=int, default=8, help="rounds of all effects (about 110 cases each)")
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--json", type=Path, help="file for all outcomes, one JSON object a line")
    parser.add_argument(
        "--only",
        default="",
        metavar="WORD,…",
        help="cases with all of these: an experiment (steps, step, release, sweep, ramp), a rate in Hz, a noise "
        "(white, coloured, speed), a kind (clean, single, beside, pair, several, odd, variant, variant_pair), a hidden "
        "effect",
    )
    kinds = parser.add_mutually_exclusive_group()
    for name, what in _KINDS.items():
        kinds.add_argument(
            f"--{name.replace('_', '-')}", action="store_const", dest="plan", const=name, default="study", help=what
        )
    parser.add_argument("--every", type=int, default=1, help="run only every Nth case", metavar="N")
    parser.add_argument("--docs", type=Path, help="directory that gets the whole study's page and picture")
    parser.add_argument("--score", type=Path, nargs="+", help="only score outcomes written with --json before")
    given = parser.parse_args(arguments)
    if given.score:
        lines = [line for path in given.score for line in path.read_text(encoding="utf-8").splitlines()]
        outcomes = [Outcome.from_json_dict(json.loads(line)) for line in lines]
    else:
        cases = chosen(getattr(plan, given.plan)(given.rounds, given.seed), given.only)[:: given.every]
        outcomes = _all(cases, given.jobs, given.json)
    if not outcomes:
        return 1
    seeds = [outcome.case.seed for outcome in outcomes]
    head = f"{len(outcomes)} cases, seeds {min(seeds)} to {max(seeds)}"
    crashed = sum(outcome.verdict == CRASHED for outcome in outcomes)
    head += f"; {crashed} ended in an error" * (crashed > 0)
    kind = _kind(outcomes)
    text = "\n".join([head, "", *(_TOLD[kind](outcomes))])
    print(text)
    part = bool(kind == "forms" or given.only or given.every > 1)
    if given.docs and part:
        print("\nonly a part of the study was run: the documentation is left as it is")
    elif given.docs and kind in _PAGES:
        name, page = _PAGES[kind]
        (given.docs / name).write_text(page.format(tables=text), encoding="utf-8")
    elif given.docs:
        draw(outcomes, given.docs / "images" / "blind_study.png")
        (given.docs / "blind-study.md").write_text(_PAGE.format(tables=text), encoding="utf-8")
    return 0


#: Tables of each study.
_TOLD = {
    "study": told.report,
    "variants": told.variants,
    "variant_pairs": told.variant_pairs,
    "forms": told.variants,
    "mujoco": told.second_author,
    "several": told.several_faults,
    "together": told.calibration,
}


def _kind(outcomes: Sequence[Outcome]) -> str:
    """Which study these are of."""
    kinds = {_of_one(outcome) for outcome in outcomes}
    return kinds.pop() if len(kinds) == 1 else "together"


def _of_one(outcome: Outcome) -> str:
    if outcome.case.author == "own":
        return "forms" if outcome.case.kind == "variant" else "study"
    if outcome.case.kind == "variant_pair":
        return "variant_pairs"
    return outcome.case.author if outcome.case.author in ("mujoco", "several") else "variants"


def chosen(cases: Sequence[Case], words: str) -> list[Case]:
    """The cases that have all of these words, separated by commas."""
    asked = {word.strip() for word in words.split(",") if word.strip()}
    return [case for case in cases if asked <= case.words]


def _all(cases: Sequence[Case], jobs: int, path: Path | None) -> list[Outcome]:
    """All outcomes, written one by one: a study that is interrupted keeps what it has."""
    outcomes: list[Outcome] = []
    with ProcessPoolExecutor(jobs) as pool, nullcontext() if path is None else path.open("w") as file:
        for number, outcome in enumerate(pool.map(run, cases), start=1):
            outcomes.append(outcome)
            if file is not None:
                file.write(json.dumps(outcome.to_json_dict()) + "\n")
                file.flush()
            print(f"{number}/{len(cases)} {_line(outcome)}", file=sys.stderr, flush=True)
    return outcomes


def _line(outcome: Outcome) -> str:
    named = ", ".join(f"{name} {p:.2f}" + (f" ~ {'/'.join(t)}" if t else "") for name, p, t, _ in outcome.named)
    mark, truth = "ok" if outcome.exact else "--", "+".join(outcome.truth) or "none"
    return (
        f"{mark} seed {outcome.case.seed} {outcome.case.experiment} {truth} "
        f"[{outcome.without_floors:.1f} of {outcome.base_floors:.1f}] -> {outcome.verdict}: {named or 'none'} "
        f"[{outcome.extended_floors:.2f}] {outcome.seconds:.1f} s"
    )


if __name__ == "__main__":
    sys.exit(main())
