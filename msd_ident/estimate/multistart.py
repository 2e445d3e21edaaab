"""Search over several starts for the deepest minimum of the error.

Starts come from the linear regression (which has no local minima), from the values that the model was given, and from
what else the caller offers (the guesses of an effect, a grid over a delay). All are simulated once. The best is
refined, first with rests weighted down, then with all samples alike. If that does not reach the noise floor, the other
starts are explored.

The error has a local minimum for every number of half-swings over some parameters (``Parameter.kinked``). These are
then changed by fixed factors; at the noise floor, only those that the data determines poorly. After that, minima next
to the best one are tried (``Effect.neighbours``). Where even the best fits badly, the fit begins with the first swings
of each record, in which a wrong frequency cannot slip by a whole cycle, and goes on with longer and longer parts. These
searches are rough: long records are thinned, and a start is not followed to its minimum if others fit better already.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import KEPT, LONG, LOOK, SAMPLES, SHORT, THOROUGH
from msd_ident.estimate.least_squares import Solution, SolverOptions, minimise
from msd_ident.estimate.levels import ALIKE, BLOCKS, NEGLIGIBLE
from msd_ident.estimate.objective import SquaredError, motion_weights
from msd_ident.estimate.problem import Problem
from msd_ident.tuning import tuned

#: Fall of the error, as a part of it, that is worth a step there: of a negligible part of one sample at the noise.
_WORTH = NEGLIGIBLE / SAMPLES
_COARSE = tuned(
    100.0,
    unit="1",
    why="factor on finite-difference steps that see past the kinks of sticking: 0.1 % of the motion",
    chosen="by hand",
)
_SLIPPED = tuned(
    0.2, unit="1", why="part of the motion's spread that is left where phase has slipped somewhere", chosen="by hand"
)


#: Parts of the records over which a fit grows, each twice the one before: the first holds a swing or so.
_HORIZONS = tuple(0.5**n for n in range(LOOK, 0, -1))
#: Factors by which a jump tries the other minima of a kinked parameter: the next one either way, and one farther.
_JUMPS = (ALIKE**-3, 1.0 / ALIKE, ALIKE, ALIKE**3)


def limits(problem: Problem, iterations: int = LONG) -> SolverOptions:
    """Solver options with the bounds and sizes of a problem.

    Args:
        problem: gives bounds and sizes (p,).
        iterations: largest number of iterations.
    """
    return SolverOptions(problem.lower, problem.upper, problem.scale, iterations)


@dataclass(frozen=True)
class Valleys:
    """Search over the local minima of one problem's error.

    Attributes:
        problem: what to fit.
        plain: error with all samples alike.
        weighted: error with rests weighted down.
        rough: the same on thinned records.
        floor: noise floor of the records [m]; NaN if unknown.
    """

    problem: Problem
    plain: SquaredError
    weighted: SquaredError
    rough: SquaredError
    floor: float

    def deepest(
        self,
        starts: Sequence[FloatArray],
        given: Sequence[Sequence[FloatArray]],
        guesses: Callable[[FloatArray], Sequence[FloatArray]],
        neighbours: Callable[[FloatArray], Sequence[FloatArray]],
    ) -> Solution:
        """The deepest minimum found.

        Args:
            starts: vectors (p,) to start from, of which only those with the smallest errors are followed.
            given: for each model that the caller gave, vectors with its values and several initial states. The best of
                each model is always followed.
            guesses: makes further starts from the best vector so far.
            neighbours: makes starts in minima next to that of the best vector.
        """
        own = [min(variants, key=self.weighted.cost) for variants in given]
        likely = sorted([*starts, *own], key=self.weighted.cost)[:KEPT]
        first = best = self._explore(likely[0], limits(self.problem, THOROUGH))
        if not self.at_floor(best):
            others = [*likely[1:], *(vector for vector in own if all(vector is not one for one in likely))]
            best = self._deepest_of(best, [*others, *guesses(best.point)])
        best = self._hop(self._jump(best, all_entries=not self.at_floor(best)), neighbours)
        if self._relative(best) > _SLIPPED:
            best = _deeper(best, self._grow(likely))
        return best if best is first and best.converged else minimise(self.plain, best.point, limits(self.problem))

    def _deepest_of(self, best: Solution, others: Sequence[FloatArray]) -> Solution:
        """The best of the present solution and of the solutions that other starts lead to."""
        if any(parameter.multistable for parameter in self.problem.parameters):
            best = _deeper(best, self._grow(others))
            if self.at_floor(best):
                return best
        for outcome in self._race(others):
            best = _deeper(best, self._explore(outcome.point, self._roughly()))
            if self.at_floor(best):
                break
        return best

    def _roughly(self) -> SolverOptions:
        return replace(limits(self.problem, THOROUGH), cost_tolerance=_WORTH)

    def _race(self, starts: Sequence[FloatArray]) -> list[Solution]:
        """A few iterations from every start; the ``KEPT`` best are returned."""
        outcomes = [minimise(self.rough, start, limits(self.problem, LOOK)) for start in starts]
        return sorted(outcomes, key=_cost)[:KEPT]

    def _explore(self, start: FloatArray, until: SolverOptions) -> Solution:
        """Refine a start: first with rests weighted down, then with all samples alike."""
        down = minimise(self.rough, start, replace(limits(self.problem, THOROUGH), cost_tolerance=1e-3))
        return minimise(self.plain, down.point, until)

    def at_floor(self, outcome: Solution) -> bool:
        """Whether the residual is measurement noise: as small as the noise floor, and without a slow pattern."""
        if not (math.isfinite(self.floor) and self._spread(outcome) <= ALIKE * self.floor):
            return False
        weights = self.weighted.weights or tuple(np.ones(record.samples) for record in self.problem.records)
        moving = (self.problem.residual(outcome.point, r)[weight == 1.0] for r, weight in enumerate(weights))
        return all(
            _rounding(part, step) or _patternless(part)
            for part, step in zip(moving, self.problem.encoder_steps, strict=True)
        )

    def _jump(self, best: Solution, all_entries: bool) -> Solution:
        """Change each kinked parameter (or only the poorly determined ones) by fixed factors, and refine again."""
        kinked = [entry for entry, parameter in enumerate(self.problem.parameters) if parameter.kinked]
        if not kinked:
            return best
        if not all_entries:
            matrix = self.plain.linearise(best.point).matrix
            inverse = np.linalg.pinv(matrix, rcond=1e-14, hermitian=True)
            spread = self._spread(best) * np.sqrt(np.maximum(np.diag(inverse), 0.0))
            kinked = [entry for entry in kinked if spread[entry] > NEGLIGIBLE * abs(best.point[entry])]
        for entry in kinked:
            best = self._jump_one(best, entry)
        return best

    def _hop(self, best: Solution, neighbours: Callable[[FloatArray], Sequence[FloatArray]]) -> Solution:
        """Try neighbouring minima as long as the error decreases and is above the noise floor."""
        for _ in range(KEPT):
            before, near = best.cost, neighbours(best.point)
            if not near or self.at_floor(best):
                break
            for vector in near:
                best = _deeper(best, minimise(self.plain, vector, self._roughly()))
            if best.cost > 0.9 * before:
                break
        return best

    def _jump_one(self, best: Solution, entry: int) -> Solution:
        problem = self.problem
        matrix = self.weighted.linearise(best.point).matrix
        others = np.arange(problem.size) != entry
        follow = np.linalg.lstsq(matrix[np.ix_(others, others)], -matrix[others, entry], rcond=1e-12)[0]
        near = []
        for factor in _JUMPS:
            change = np.zeros(problem.size)
            change[entry] = (factor - 1.0) * best.point[entry]
            change[others] = follow * change[entry]
            near.append(minimise(self.rough, best.point + change, limits(problem, SHORT)))
        for outcome in sorted(near, key=_cost)[:2]:
            best = _deeper(best, minimise(self.plain, outcome.point, self._roughly()))
        return best

    def _grow(self, starts: Sequence[FloatArray]) -> Solution:
        """Fit the first swings from every start, then go on with the best over more and more of the records."""
        points = list(starts)
        for horizon in _HORIZONS:
            part = SquaredError(self.rough.problem.shortened(horizon), coarse=_COARSE)
            outcomes = [minimise(part, point, limits(self.problem, LOOK)) for point in points]
            points = [outcome.point for outcome in sorted(outcomes, key=_cost)[:KEPT]]
        best = self._explore(points[0], self._roughly())
        for point in [] if self.at_floor(best) else points[1:]:
            best = _deeper(best, self._explore(point, self._roughly()))
        return best

    def _spread(self, outcome: Solution) -> float:
        samples = sum(record.samples for record in self.problem.records)
        return math.sqrt(2.0 * outcome.cost / samples)

    def _relative(self, outcome: Solution) -> float:
        return self._spread(outcome) / self.problem.typical.length


def _rounding(residual: FloatArray, step: float) -> bool:
    """Whether a residual is no larger than the encoder's rounding error, which has a pattern in slow motion."""
    return residual.size > 0 and float(np.quantile(np.abs(residual), 0.98)) <= 0.75 * step


def _patternless(residual: FloatArray) -> bool:
    """Whether block sums of a residual scatter like those of independent samples (within four standard deviations)."""
    variance = float(residual @ residual) / max(residual.size, 1)
    for block in BLOCKS:
        count = residual.size // block
        if count < 4 or variance == 0.0:
            continue
        sums = residual[: count * block].reshape(count, block).sum(axis=1)
        if float(sums @ sums) / (count * block * variance) > 1.0 + 4.0 * math.sqrt(2.0 / count):
            return False
    return True


def _cost(outcome: Solution) -> float:
    return outcome.cost


def _deeper(one: Solution, other: Solution) -> Solution:
    return one if one.cost <= other.cost else other


def valleys(problem: Problem, floor: float) -> Valleys:
    """Search with several starts: the plain error, one with rests weighted down, and the same on thinned records.

    Args:
        problem: what to fit.
        floor: noise floor of the records [m]; NaN if unknown.
    """
    steps = problem.encoder_steps  # those of the thinned records too: they were read by the same encoders
    plain, weighted = SquaredError(problem), _weighted(problem, steps)
    thin = problem.thinned(SAMPLES)
    return Valleys(problem, plain, weighted, weighted if thin is problem else _weighted(thin, steps), floor)


def _weighted(problem: Problem, steps: Sequence[float]) -> SquaredError:
    """Squared error with rests weighted down, differentiated by wide steps; ``steps`` are the encoders' [m]."""
    pairs = zip(problem.records, steps, strict=True)
    weights = tuple(motion_weights(record.position, step, _part_of_a_swing(problem, record)) for record, step in pairs)
    resting = any(bool(np.any(weight < 1.0)) for weight in weights)
    return SquaredError(problem, weights if resting else (), coarse=_COARSE)


def _part_of_a_swing(problem: Problem, record: Record) -> int:
    """Samples of a tenth of a swing, at least 10 and at most a tenth of the record."""
    return max(10, min(round(0.6 * problem.typical.time / record.period), record.samples // 10))


def robust(problem: Problem, start: Solution, softness: float) -> Solution:
    """Refine a solution with the soft-L1 loss, which reduces the influence of outliers.

    Args:
        problem: what to fit.
        start: where the search with plain squares ended.
        softness: residual [m] beyond which the loss grows linearly instead of quadratically.
    """
    return minimise(SquaredError(problem, soft=softness), start.point, limits(problem))
