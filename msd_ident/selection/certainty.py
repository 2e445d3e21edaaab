"""Limits of certainty: when a cause is named with certainty, and the greatest odds of one that cannot be certain."""

from __future__ import annotations

import math

from msd_ident.estimate.levels import BEYOND_DOUBT
from msd_ident.model.effects import Effect
from msd_ident.tuning import fixed, tuned

FAINT = tuned(3.0, unit="noise floors", why="below it the form of what a set leaves is not seen", chosen="by hand")
#: Noise floors below which the form of what a set leaves is seen roughly: only beyond them no part of it is noise.
ROUGH = BEYOND_DOUBT
FORM_PART = tuned(
    0.2,
    unit="1",
    why="part of what the other causes explain (rms of the position) below which a further cause may be another "
    "form of their laws",
    chosen="on 152 rigs of foreign laws (`python -m bench.blind --variants`, seeds 81000 and 91000) 10 of 12 false "
    "further causes lie below it, and below `ROUGH` or `LEAST_SPREAD`",
)
LEFT_PART = tuned(
    0.15,
    unit="1",
    why="part of what a set explains that it leaves above the noise, beyond which its laws are not the rig's",
    chosen="on 470 rigs of foreign laws and of MuJoCo (`python -m bench.blind --variants`, seeds 463000, 473000 and "
    "493000, `--mujoco`, 475000 and 495000) 5 right causes and a false one are certain between it and 0.2, and 11 "
    "right ones between 0.1 and it",
)
FORM_ODDS = tuned(
    60.0,
    unit="prior odds",
    why="greatest odds of a cause below `FORM_PART` in a set that leaves more than noise, and of one that a poor "
    "experiment without copies shows: 3 to 1 for most",
    chosen="by hand",
)
CERTAIN = tuned(0.9, unit="1", why="probability above which a cause is named with certainty", chosen="by hand")
#: The same as odds.
CERTAIN_ODDS = CERTAIN / (1.0 - CERTAIN)
ROUNDING = fixed(1e-9, "accuracy", "sums of the same probabilities in another order differ by no more")


def certain(probability: float) -> bool:
    """Whether a cause is named with certainty. Limits of 9 to 1 that add up to 9 to 1 are not, in no digit."""
    return probability > CERTAIN + ROUNDING


def uncertain(effect: type[Effect]) -> float:
    """Greatest odds of a cause whose law is not this rig's, or that needs copies and has none."""
    return FORM_ODDS * Effect.prior_odds * usual(effect)


def usual(effect: type[Effect]) -> float:
    """Prior odds over those of most causes; lower ones do not count once more."""
    return max(effect.prior_odds / Effect.prior_odds, 1.0)


def probability_at(odds: float) -> float:
    """Probability at these odds."""
    return odds / (1.0 + odds) if math.isfinite(odds) else 1.0
