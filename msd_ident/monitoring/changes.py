"""Change points of a series with their probabilities, exactly, by the forward–backward recursion of Fearnhead 2006
("Exact and efficient Bayesian inference for multiple changepoint problems", Statistics and Computing 16).

Between changes the series has a level, beside what moves it without any wear (regressors, whose coefficients stay) and
normal scatter. A change may come at every record with the same probability; levels are drawn from one broad normal
distribution.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray
from msd_ident.quantity import MAD

IntArray = npt.NDArray[np.intp]

#: Changes that are expected in a series before any data, whatever its length.
EXPECTED = 0.5
#: A change is reported where it is likelier than this.
TOLD = 0.5
#: Records that are looked at, the newest: the recursion takes time with their square.
MOST = 4000
#: A change's place is uncertain by this many records either way, at most, to count as one.
_NEAR = 10
#: Scatters that are tried, in what the steps between neighbours say, for series of up to so many records; in longer
#: ones these are sure enough.
_FACTORS, _SHORT = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0), 250
#: Part of the steps between neighbours that no change has made.
_TRUSTED = 0.9
#: Records that a level must be seen over.
_FEWEST = 6


@dataclass(frozen=True)
class Change:
    """A change of a level.

    Attributes:
        index: first record of the new level.
        probability: that the level changed there, or within a few records.
        before, after: levels.
        std: standard deviation of their difference.
    """

    index: int
    probability: float
    before: float
    after: float
    std: float

    @property
    def percent(self) -> float:
        """The change as a part of the level before."""
        return 100.0 * (self.after - self.before) / abs(self.before) if self.before else math.nan


def changes(values: FloatArray, regressors: FloatArray, stds: FloatArray | None = None) -> tuple[Change, ...]:
    """Change points of a series.

    Args:
        values: (n,) in the order of time.
        regressors: (n, q) of what moves it without wear; q may be 0.
        stds: (n,) of the values themselves; NaN or 0 where nobody knows. The scatter about a level is no smaller than
            their median, however alike the records are.
    """
    least = _least(stds)
    offset = max(values.size - MOST, 0)
    values, regressors = values[offset:], regressors[offset:]
    if values.size < 2 * _FEWEST or not np.ptp(values) > 0.0:
        return ()
    runs = [_averaged(values - moved, least) for moved in _moved_somehow(values, regressors)]
    probability, evidence = max(runs, key=lambda run: run[1])
    places = _peaks(probability)
    for _ in range(3):  # the coefficients beside the levels that were found
        moved = _moved(values, regressors, places)
        again, better = _averaged(values - moved, least)
        if better <= evidence or not places:
            break
        probability, evidence, places = again, better, _peaks(again)
    level = values - _moved(values, regressors, places)
    sigma = max(_scatter(level, places), least)
    found = (_change(level, place, places, probability, sigma) for place in places)
    return tuple(replace(one, index=one.index + offset) for one in found)


def _moved_somehow(values: FloatArray, regressors: FloatArray) -> list[FloatArray]:
    """What regressors may explain: nothing, what the whole series tells, what the steps but the wildest tell."""
    nothing, whole = np.zeros(values.size), _moved(values, regressors, [])
    steps, by = np.diff(values), np.diff(regressors, axis=0)
    if not regressors.shape[1] or steps.size < 4 * regressors.shape[1]:
        return [nothing, whole]
    keep = np.ones(steps.size, dtype=bool)
    slope: FloatArray = np.zeros(regressors.shape[1])
    for _ in range(3):
        slope = np.asarray(np.linalg.lstsq(by[keep], steps[keep], rcond=1e-10)[0])
        left = np.abs(steps - by @ slope)
        keep = left <= 3.0 * MAD * max(float(np.median(left)), 1e-300)
    return [nothing, whole, np.asarray((regressors - regressors.mean(axis=0)) @ slope)]


def _least(stds: FloatArray | None) -> float:
    """Smallest scatter of a series: what its values are known to."""
    known = np.empty(0) if stds is None else stds[np.isfinite(stds) & (stds > 0.0)]
    return float(np.median(known)) if known.size else 0.0


def _averaged(level: FloatArray, least: float) -> tuple[FloatArray, float]:
    """Posterior (n,) of changes and its log evidence, over all scatters that may be."""
    middle = _scatter(level, [])
    factors = _FACTORS if level.size <= _SHORT else (1.0,)
    runs = [_posterior(level, sigma) for sigma in sorted({max(factor * middle, least) for factor in factors})]
    evidence = np.array([one for _, one in runs])
    top = float(evidence.max())
    weights = np.exp(evidence - top)
    mean = np.average(np.array([one for one, _ in runs]), axis=0, weights=weights)
    return np.asarray(mean), top + math.log(float(weights.mean()))


def _moved(values: FloatArray, regressors: FloatArray, places: list[int]) -> FloatArray:
    """Part of the values (n,) that regressors explain, beside a level for each part between the places."""
    if not regressors.shape[1]:
        return np.zeros(values.size)
    part = np.searchsorted(places, np.arange(values.size), side="right")
    levels = (part[:, None] == np.arange(len(places) + 1)).astype(float)
    centred = regressors - regressors.mean(axis=0)
    solved = np.linalg.lstsq(np.hstack([levels, centred]), values, rcond=1e-10)[0]
    return np.asarray(centred @ solved[levels.shape[1] :])


def _scatter(level: FloatArray, places: list[int]) -> float:
    """Standard deviation about the levels, from differences of neighbours, which a change hardly touches."""
    steps = np.diff(level)
    off = np.sort(np.abs(steps - np.median(steps)))
    most = 1.25 * float(off[: max(int(_TRUSTED * off.size), 1)].mean())  # where more than half of the steps are equal
    robust = max(MAD * float(np.median(off)), 0.7 * most) / math.sqrt(2.0)
    parts = np.split(level, places)
    freedom = level.size - len(parts)
    within = math.sqrt(sum(float(np.sum((part - part.mean()) ** 2)) for part in parts) / max(freedom, 1))
    return max(robust, within if places else 0.0, 1e-9 * float(np.max(np.abs(level))), 1e-300)


def _segment(level: FloatArray, sigma: float) -> tuple[FloatArray, FloatArray, float]:
    """Sums from which the log likelihood of any part follows, and the prior width of a level over the scatter."""
    scaled = (level - np.median(level)) / sigma
    ratio = max(float(np.ptp(scaled)), 3.0) ** 2
    return np.concatenate(([0.0], np.cumsum(scaled))), np.concatenate(([0.0], np.cumsum(scaled**2))), ratio


def _log_parts(sums: tuple[FloatArray, FloatArray, float], start: IntArray, end: IntArray) -> FloatArray:
    """Log marginal likelihood of the parts [start, end), the level integrated out."""
    first, second, ratio = sums
    count = (end - start).astype(float)
    total, squares = first[end] - first[start], second[end] - second[start]
    return np.asarray(-0.5 * squares + 0.5 * total**2 * ratio / (1.0 + count * ratio) - 0.5 * np.log1p(count * ratio))


def _posterior(level: FloatArray, sigma: float) -> tuple[FloatArray, float]:
    """(n,) probability that a new level begins at each record, and the log evidence of the scatter."""
    size = level.size
    sums = _segment(level, sigma)
    hazard = min(EXPECTED / size, 0.1)
    stay, go = math.log1p(-hazard), math.log(hazard)
    forward, backward = np.zeros(size + 1), np.zeros(size + 1)
    for here in range(1, size + 1):  # all data before, the last part of it beginning anywhere
        starts = np.arange(here)
        terms = forward[:here] + np.where(starts > 0, go, 0.0) + (here - starts - 1) * stay
        forward[here] = _log_sum(terms + _log_parts(sums, starts, np.full(here, here, dtype=np.intp)))
    for here in range(size - 1, -1, -1):  # all data from here on, the first part of it ending anywhere
        ends = np.arange(here + 1, size + 1)
        terms = backward[here + 1 :] + np.where(ends < size, go, 0.0) + (ends - here - 1) * stay
        backward[here] = _log_sum(terms + _log_parts(sums, np.full(ends.size, here, dtype=np.intp), ends))
    probability: FloatArray = np.exp(np.minimum(forward[:size] + go + backward[:size] - forward[size], 0.0))
    probability[0] = 0.0
    return probability, float(forward[size]) - size * math.log(sigma)


def _log_sum(terms: FloatArray) -> float:
    top = float(terms.max())
    return top + math.log(float(np.exp(terms - top).sum()))


def _peaks(probability: FloatArray) -> list[int]:
    """Places around which a change is more likely than not, each the likeliest of its neighbourhood."""
    left = probability.copy()
    found: list[int] = []
    while True:
        place = int(np.argmax(left))
        if left[place] <= 0.0 or _near(probability, place) < TOLD:
            return sorted(found)
        found.append(place)
        left[max(place - 2 * _NEAR, 0) : place + 2 * _NEAR + 1] = 0.0


def _near(probability: FloatArray, place: int) -> float:
    """Probability of a change at a place or within a few records of it."""
    return min(float(probability[max(place - _NEAR, 0) : place + _NEAR + 1].sum()), 1.0)


def _change(level: FloatArray, place: int, places: list[int], probability: FloatArray, sigma: float) -> Change:
    edges = [0, *places, level.size]
    here = edges.index(place)
    before, after = level[edges[here - 1] : place], level[place : edges[here + 1]]
    std = sigma * math.sqrt(1.0 / before.size + 1.0 / after.size)
    return Change(place, _near(probability, place), float(before.mean()), float(after.mean()), std)
