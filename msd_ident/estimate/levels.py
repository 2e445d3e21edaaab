"""Levels that several stages share: what counts as nothing, as most, as alike, and as beyond doubt."""

from __future__ import annotations

import math
import sys

from scipy.special import ndtri

from msd_ident.tuning import fixed, tuned

CONFIDENCE = fixed(0.95, "interface", "all intervals are 95 % intervals, as the documents and the JSON contract say")
#: Half width of an interval of that level, in standard deviations of a normal distribution.
TWO_SIDED = float(ndtri(0.5 * (1.0 + CONFIDENCE)))

NEGLIGIBLE = tuned(
    0.01,
    unit="1",
    why="part of a whole that counts as nothing: of a speed, of a parameter, of a probability, of a piece of evidence",
    chosen="by hand",
)
TENTH = tuned(
    0.1, unit="1", why="part of a whole from which on something counts as a change or as an effect", chosen="by hand"
)
MOST_OF = tuned(0.5, unit="1", why="part of a whole from which on something is most of it", chosen="by hand")
ALIKE = tuned(
    1.25,
    unit="1",
    why="factor within which two sizes are the same: ranges of motion, natural frequencies, neighbouring minima",
    chosen="by hand",
)
NATURAL_RANGE = tuned(
    1e3,
    unit="1",
    why="factor around its natural size, either way, within which a quantity is looked for",
    chosen="by hand",
)
FEWEST = tuned(
    10, unit="samples", why="fewest members from which a statistic is taken, or a rest is told", chosen="by hand"
)
LAGS = tuned(
    20,
    unit="samples",
    why="lags at which a residual is compared with itself, and largest order of its autoregression (chosen by BIC)",
    chosen="by hand",
)
BLOCKS = tuned(
    (16, 64), unit="samples", why="lengths of the blocks whose sums tell a slow pattern from noise", chosen="by hand"
)
KNOTS = tuned(
    5,
    unit="knots",
    why="of a curve of any shape on each side of rest: of a spring or of a damper; with more it would follow ripples",
    chosen="by hand",
)
BEYOND_DOUBT = tuned(
    10.0,
    unit="standard deviations",
    why="distance at which something is no noise whatever its distribution",
    chosen="by hand",
)

SHAPES = tuned(
    8.0,
    unit="1",
    why="independent features of a model's error that a record shows, over all frequencies",
    chosen="with 6 the friction of measured carts is not named; with 12 a disc in air gets hysteresis",
)

DAMPING = tuned(
    1e-3, unit="1", why="damping at which every Levenberg-Marquardt search begins, on a unit diagonal", chosen="by hand"
)
#: Damping at which a search gives up: a step is then below the rounding of what it moves.
STUCK = 1.0 / math.sqrt(sys.float_info.epsilon)

#: Eigenvalue of a matrix with unit diagonal below which a direction is null.
NULL = fixed(
    1e-10, "accuracy", "finite differences leave 1e-13 of the largest eigenvalue along an exactly null direction"
)

RELATIVE_STEP = fixed(
    1e-5, "accuracy", "effect of a finite-difference step, as a part of the motion: far above rounding, far below bends"
)
