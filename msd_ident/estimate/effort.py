"""How much work a search may do: steps, starts and samples, shared by all stages.

Work is counted and never timed, so that a record has the same answer on any machine.
"""

from __future__ import annotations

from msd_ident.estimate.levels import FEWEST
from msd_ident.tuning import fixed, tuned

LOOK = tuned(5, unit="steps", why="first look at a start: enough to sort starts, not to finish any", chosen="by hand")
SHORT = tuned(12, unit="steps", why="descent that begins close to its end", chosen="by hand")
THOROUGH = tuned(40, unit="steps", why="descent to the end, or trials of a scan over frequencies", chosen="by hand")
#: Steps of a last refinement, whose end is reported as converged or not.
LONG = 3 * THOROUGH
KEPT = tuned(3, unit="starts", why="the best few of many starts, sets or lines, which are followed", chosen="by hand")
SAMPLES = tuned(
    1500, unit="samples", why="samples that a search uses; its leaders are refined and judged on all", chosen="by hand"
)
A_SWING = tuned(
    20.0,
    unit="samples",
    why="samples of a swing that a thinned record keeps: with one or two, no law shows",
    chosen="by hand",
)
#: Fewest samples that a thinned record or a prediction keeps: those of the fewest swings that make a statistic.
FEWEST_READINGS = round(FEWEST * A_SWING)
SLACK = fixed(
    100.0,
    "accuracy",
    "factor on the errors of steps far from the noise, or where a plan is looked at: 1e-5 of the motion each; "
    "simulations of measured records take 0.4 to 0.9 of the time, and change chi² by 1e-4 of it at most",
)
LONG_RECORD = fixed(
    200_000,
    "resources",
    "samples beyond which a second Jacobian beside the first is too much, and a record is not smoothed twice",
)
