"""Tables of both studies, from their trials, as a page: ``docs/accuracy.md``.

python bench/study_table.py --recovery FILE... --coverage FILE... --out docs/accuracy.md
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.stats

from msd_ident.quantity import Z95

Trials = Sequence[dict[str, Any]]
FloatArray = npt.NDArray[np.float64]

#: A fit that ends this many noise floors away from the data ended in a wrong valley.
WRONG_VALLEY = 1.15
#: Chance that a normal deviation exceeds three of its standard deviations.
BEYOND_THREE = math.erfc(3.0 / math.sqrt(2.0))
_PAGE = """\
# How accurate the fit is

Written by `make study`, from records that `msd_sim` makes: it shares no code with the identifier. A deviation z is
(estimate − truth) / reported standard deviation. If the standard deviations are right, z has a root mean square of 1,
and 95 % of all |z| lie below {z95:.2f}.

## Is every effect found again?

Each trial is a random rig with one effect: steps to both sides at two amplitudes, a sweep and a release, at 250 Hz,
read with noise of 0.1 % of the amplitude and an encoder step of half of that. The fit starts 30 % wrong in every
parameter. *Recovered*: every free parameter of plant and effect within three standard deviations, of the first hundred
seeds and of all; the aim is 98 of 100. *By chance*: how many of a hundred right intervals recover, if the parameters'
errors are independent, and the range that holds nineteen of twenty such hundreds. *Wrong valley*: SEE above {wrong}
noise floors.

{recovery}

{failed}

All parameters of all effects together: {together}.

## Do the intervals cover the truth?

Each rig has random mass, frequency, damping, dry friction, force, stick position, zero, sampling, encoder step and
noise (a tenth of a step to ten); one step up and down. The model is right, the start 30 % wrong. Share of 95 %
intervals that hold the truth, in per cent, to be between 92 and 98. Where each covers in exactly 95 %, nineteen of
twenty sets of 200 rigs show {usual}.

{coverage}
"""


def read(names: Sequence[str]) -> list[dict[str, Any]]:
    """Trials of several files."""
    return [trial for name in names for trial in json.loads(Path(name).read_text(encoding="utf-8"))]


def usual(trials: int, chance: float) -> tuple[int, int]:
    """The range that holds nineteen of twenty counts of successes of this chance."""
    low, high = scipy.stats.binom.ppf([0.025, 0.975], trials, chance)
    return int(low), int(high)


def by_chance(parameters: int) -> str:
    """Trials of a hundred that right intervals recover: the mean, and the range of nineteen of twenty hundreds."""
    chance = (1.0 - BEYOND_THREE) ** parameters
    low, high = usual(100, chance)
    return f"{100.0 * chance:.1f} ({low} to {high})"


def deviations(trials: Trials) -> FloatArray:
    """All deviations (n,) of all parameters; those without an interval left out."""
    every = np.array([z for trial in trials for z in trial["deviations"].values()], dtype=np.float64)
    return every[np.isfinite(every)]


def recovery_row(effect: str, trials: Trials) -> str:
    """One effect's line."""
    z = deviations(trials)
    first = trials[:100]
    parameters = max(len(trial["deviations"]) for trial in trials)
    cells = [
        f"`{effect}`",
        f"{_recovered(first)} of {len(first)}",
        f"{_recovered(trials)} of {len(trials)} ({100.0 * _recovered(trials) / len(trials):.1f} %)",
        by_chance(parameters),
        str(parameters),
        str(sum(trial["see_over_floor"] > WRONG_VALLEY for trial in trials)),
        f"{np.sqrt(np.mean(z**2)):.2f}",
        f"{np.max(np.abs(z)):.1f}",
        f"{np.median([trial['seconds'] for trial in trials]):.2f}",
    ]
    return "| " + " | ".join(cells) + " |"


def _recovered(trials: Trials) -> int:
    return sum(trial["recovered"] for trial in trials)


def recovery_table(trials: Trials) -> str:
    """A line for each effect."""
    first = min(int(trial["seed"]) for trial in trials)
    lines = [
        f"| effect | recovered, seeds {first} to {first + 99} | all seeds | by chance | free parameters | wrong valley "
        "| rms z | largest abs(z) | s a fit |",
        "|" + "---|" * 9,
    ]
    for effect in sorted({trial["effect"] for trial in trials}):
        own = sorted((trial for trial in trials if trial["effect"] == effect), key=lambda trial: int(trial["seed"]))
        lines.append(recovery_row(effect, own))
    return "\n".join(lines)


def failed_trials(trials: Trials) -> str:
    """The trials that were not recovered, by effect, with what lies beyond three standard deviations."""
    lines = ["Not recovered (seed: what is beyond three standard deviations):", ""]
    for effect in sorted({trial["effect"] for trial in trials if not trial["recovered"]}):
        shown = []
        for trial in trials:
            if trial["effect"] == effect and not trial["recovered"]:
                far = {name: z for name, z in trial["deviations"].items() if not abs(z) <= 3.0}
                mark = f", SEE {trial['see_over_floor']:.1f} floors" * (trial["see_over_floor"] > WRONG_VALLEY)
                shown.append(f"{trial['seed']}: " + ", ".join(f"{name} {z:.1f}" for name, z in far.items()) + mark)
        lines.append(f"- `{effect}`: " + "; ".join(shown))
    return "\n".join(lines)


def summary(trials: Trials) -> str:
    """All deviations together."""
    z, good = np.abs(deviations(trials)), _recovered(trials)
    return (
        f"{good} of {len(trials)} trials recovered ({100.0 * good / len(trials):.1f} %); {z.size} deviations, rms "
        f"{np.sqrt(np.mean(z**2)):.3f}, {100.0 * np.mean(z < Z95):.1f} % below {Z95:.2f} and "
        f"{100.0 * np.mean(z > 3.0):.2f} % beyond 3 (of a normal distribution: 95 % and {100.0 * BEYOND_THREE:.2f} %)"
    )


def coverage_table(groups: Sequence[Trials]) -> str:
    """A line for each set of rigs, and one for all."""
    names = ("m", "b", "k", "Fc")
    lines = [
        "| seeds | rigs | " + " | ".join(f"{name} %" for name in names) + " | " + " | ".join(
            f"rms z {name}" for name in names) + " |",
        "|" + "---|" * (2 + 2 * len(names)),
    ]  # fmt: skip
    whole: list[dict[str, Any]] = [trial for group in groups for trial in group]
    for group in [*groups, whole] if len(groups) > 1 else groups:
        z = np.array([trial["deviations"] for trial in group], dtype=np.float64)
        seeds = "all" if group is whole else f"{group[0]['seed']}–{group[-1]['seed']}"
        covered = [f"{100.0 * share:.1f}" for share in np.mean(np.abs(z) < Z95, axis=0)]
        spread = [f"{value:.2f}" for value in np.sqrt(np.mean(z**2, axis=0))]
        lines.append("| " + " | ".join([seeds, str(len(group)), *covered, *spread]) + " |")
    return "\n".join(lines)


def holds(recovery: Trials, coverage: Trials) -> bool:
    """No fit in a wrong valley, 98 of 100 recovered, and the truth in 92 to 98 % of the intervals."""
    covered = np.mean(np.abs([trial["deviations"] for trial in coverage]) < Z95, axis=0)
    right = all(trial["see_over_floor"] <= WRONG_VALLEY for trial in recovery)
    enough = _recovered(recovery) >= 0.98 * len(recovery)
    return right and enough and bool(np.all((covered >= 0.92) & (covered <= 0.98)))


def main() -> int:
    """Write the page; exit code 1 when, all trials together, the figures miss what they must reach."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recovery", nargs="+", required=True, metavar="FILE", help="trials of study_recovery.py")
    parser.add_argument("--coverage", nargs="+", required=True, metavar="FILE", help="trials of study_coverage.py")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    trials = read(given.recovery)
    groups = [read([name]) for name in given.coverage]
    low, high = usual(200, 0.95)
    page = _PAGE.format(
        z95=Z95,
        wrong=WRONG_VALLEY,
        recovery=recovery_table(trials),
        failed=failed_trials(trials),
        together=summary(trials),
        usual=f"{low / 2:g} to {high / 2:g} %",
        coverage=coverage_table(groups),
    )
    given.out.write_text(page, encoding="utf-8")
    return 0 if holds(trials, [trial for group in groups for trial in group]) else 1


if __name__ == "__main__":
    sys.exit(main())
