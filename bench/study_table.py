"""Writes ``docs/accuracy.md``: recovery of parameters and coverage of intervals, from the trials of both studies.

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

#: A fit that leaves more noise floors than this ended in a wrong local minimum.
WRONG_MINIMUM = 1.15
#: Chance that a normal deviation exceeds three of its standard deviations.
BEYOND_THREE = math.erfc(3.0 / math.sqrt(2.0))
_PAGE = """\
# How accurate the fit is

Written by `make study`, from records that `msd_sim` makes: it shares no code with the identifier. A deviation z is
(estimate − truth) / reported standard deviation. If the standard deviations are right, z has a root mean square of 1,
and 95 % of all |z| lie below {z95:.2f}.

## Recovery of parameters

Each trial is a random rig with one effect: steps in both directions at two amplitudes, a sweep, a release, at 250 Hz.
The noise is 0.1 % of the amplitude, the encoder step half of that. The fit starts with every parameter 30 % off.

- *Recovered*: every free parameter of plant and effect is within three standard deviations of the truth. The goal is 98
  of 100.
- *Expected*: trials of 100 that are recovered if all standard deviations are right and the errors of the parameters are
  independent. In brackets: the range that contains 95 % of such sets of 100 trials.
- *Wrong minimum*: the fit ended in a local minimum, with a SEE above {wrong} noise floors.

{recovery}

{failed}

All parameters of all effects together: {together}.

## Coverage of the intervals

Each rig has random mass, frequency, damping, dry friction, force, position at rest, zero, sampling, encoder step and
noise (0.1 to 10 encoder steps). The experiment is one step up and down. The model is the true one, and the fit starts
with every parameter 30 % off. The columns m to Fc give the share of 95 % intervals that contain the truth; 92 to 98 %
is required. If the true coverage is 95 %, 95 % of all sets of 200 rigs give {usual}.

{coverage}
"""


def read(names: Sequence[str]) -> list[dict[str, Any]]:
    """Trials of several files."""
    return [trial for name in names for trial in json.loads(Path(name).read_text(encoding="utf-8"))]


def usual(trials: int, chance: float) -> tuple[int, int]:
    """The range that contains 95 % of the counts of successes of this chance."""
    low, high = scipy.stats.binom.ppf([0.025, 0.975], trials, chance)
    return int(low), int(high)


def by_chance(parameters: int) -> str:
    """Trials of a hundred that right standard deviations recover: the mean, and the range of 95 % of such hundreds."""
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
        str(sum(trial["see_over_floor"] > WRONG_MINIMUM for trial in trials)),
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
        f"| effect | recovered, seeds {first} to {first + 99} | recovered, all seeds | expected | free parameters | "
        "wrong minimum | rms z | largest abs(z) | processor time of a fit [s], median |",
        "|" + "---|" * 9,
    ]
    for effect in sorted({trial["effect"] for trial in trials}):
        own = sorted((trial for trial in trials if trial["effect"] == effect), key=lambda trial: int(trial["seed"]))
        lines.append(recovery_row(effect, own))
    return "\n".join(lines)


def failed_trials(trials: Trials) -> str:
    """The trials that were not recovered, by effect, with what lies beyond three standard deviations."""
    lines = ["Trials that are not recovered (seed: parameters beyond three standard deviations, and their z):", ""]
    for effect in sorted({trial["effect"] for trial in trials if not trial["recovered"]}):
        shown = []
        for trial in trials:
            if trial["effect"] == effect and not trial["recovered"]:
                far = {name: z for name, z in trial["deviations"].items() if not abs(z) <= 3.0}
                mark = f", SEE {trial['see_over_floor']:.1f} floors" * (trial["see_over_floor"] > WRONG_MINIMUM)
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
    """No fit in a wrong minimum, 98 of 100 recovered, and the truth in 92 to 98 % of the intervals."""
    covered = np.mean(np.abs([trial["deviations"] for trial in coverage]) < Z95, axis=0)
    right = all(trial["see_over_floor"] <= WRONG_MINIMUM for trial in recovery)
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
        wrong=WRONG_MINIMUM,
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
