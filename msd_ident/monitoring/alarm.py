"""Sequential alarms whose rate of false alarms is stated beforehand, and holds however long they run.

A detector keeps M ← L·(M + 1), where L is an e-value of the newest record: a number that is at least 0 and, as long as
nothing has changed, 1 on average whatever came before. Then the mean number of records to a false alarm, M ≥ A, is at
least A (the Shiryaev–Roberts e-detector of Shin, Ramdas and Rinaldo 2023, "E-detectors: a nonparametric framework for
sequential change detection", New England J. Stat. Data Sci. 2; Roberts 1966, Technometrics 8). The mean of several
detectors is one again, with the same promise, whether they depend on each other or not.

**Of a number**, beside what moves it without any wear (a temperature): the recursive residuals of the linear regression
(Brown, Durbin and Evans 1975, J. R. Stat. Soc. B 37), each over the standard deviation of those before it, are
independent and t-distributed, exactly, as long as level, coefficients and normal scatter stay, whatever they are. As
normal scores z they are bet on by a mixture of shifts, L = Σ w exp(µz − µ²/2).

**Of a probability**, whose distribution nobody knows: its conformal p-value among those before, uniform as long as the
records come in no particular order, ties broken by lot; L = ∫ ε p^(ε−1) dε (Vovk, Gammerman and Shafer 2022,
Algorithmic Learning in a Random World, section 8).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import special

from msd_ident.data.record import FloatArray

#: Shifts that are bet on, in standard deviations of the scatter, each either way and with the same stake.
SHIFTS = (0.5, 1.0, 2.0, 4.0, 8.0)
#: Records beyond the coefficients that the scatter is known from before the first bet.
_FEWEST = 4
#: An e-value is no larger: nothing is as sure as to forgive a wrong law of the scatter.
_MOST = 1e8


@dataclass
class Detector:
    """M of one or several numbers that are watched together."""

    value: float = 0.0

    def update(self, evidence: float) -> float:
        """M after a further record with this e-value."""
        self.value = min(evidence * (self.value + 1.0), 1e300)
        return self.value


class Regression:
    """Recursive residuals of a number on what moves it, record by record.

    Args:
        size: regressors, the constant with them.
    """

    def __init__(self, size: int) -> None:
        self._rows: list[FloatArray] = []
        self._values: list[float] = []
        self._size = size
        self._squares, self._residuals = 0.0, 0
        self._inverse: FloatArray | None = None
        self._coefficients: FloatArray = np.zeros(size)

    def update(self, value: float, regressors: FloatArray, own: float = 0.0) -> float:
        """Normal score of a further value, given all before; NaN while there are too few to tell.

        Args:
            value: of the record.
            regressors: of the record.
            own: standard deviation of the value itself: the scatter is no smaller, however alike the records are.
        """
        score = math.nan
        if self._inverse is not None:
            leverage = float(regressors @ self._inverse @ regressors)
            residual = (value - float(regressors @ self._coefficients)) / math.sqrt(1.0 + leverage)
            scatter = max(self.scatter, own) if self._residuals >= _FEWEST else 0.0
            if scatter > 0.0:
                score = _normal(residual / scatter, self._residuals)
            self._squares, self._residuals = self._squares + residual**2, self._residuals + 1
            gain = self._inverse @ regressors / (1.0 + leverage)
            self._coefficients = self._coefficients + gain * (value - float(regressors @ self._coefficients))
            self._inverse = self._inverse - np.outer(gain, regressors @ self._inverse)
            return score
        self._rows.append(regressors)
        self._values.append(value)
        self._begin()
        return score

    def _begin(self) -> None:
        """Solve once the regressors are all seen and differ enough."""
        matrix = np.array(self._rows)
        if len(self._rows) < self._size:
            return
        gram = matrix.T @ matrix
        if np.linalg.cond(gram) < 1e10:
            self._inverse = np.linalg.inv(gram)
            self._coefficients = self._inverse @ matrix.T @ np.array(self._values)
            left = np.array(self._values) - matrix @ self._coefficients
            freedom = len(self._rows) - self._size
            self._squares, self._residuals = float(left @ left) if freedom else 0.0, freedom
            self._rows, self._values = [], []

    def state(self) -> dict[str, Any]:
        """All of it as plain values."""
        inverse = None if self._inverse is None else self._inverse.tolist()
        return {
            "rows": [row.tolist() for row in self._rows],
            "values": self._values,
            "squares": self._squares,
            "residuals": self._residuals,
            "inverse": inverse,
            "coefficients": self._coefficients.tolist(),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on from where another one was."""
        self._rows = [np.array(row) for row in state["rows"]]
        self._values, self._squares = list(state["values"]), float(state["squares"])
        self._residuals = int(state["residuals"])
        self._inverse = None if state["inverse"] is None else np.array(state["inverse"])
        self._coefficients = np.array(state["coefficients"])

    def level_at(self, regressors: FloatArray) -> float:
        """What is expected of a further value; NaN while nobody knows."""
        return float(regressors @ self._coefficients) if self._inverse is not None else math.nan

    @property
    def scatter(self) -> float:
        """Standard deviation about the regression; NaN while it is not known."""
        return math.sqrt(self._squares / self._residuals) if self._residuals else math.nan


def _normal(t: float, freedom: int) -> float:
    """Normal score of a t-distributed number, both tails with all their digits."""
    tail = max(float(special.stdtr(freedom, -abs(t))), 1e-300)
    return math.copysign(-float(special.ndtri_exp(math.log(tail))), t)


def shift_evidence(score: float) -> float:
    """E-value of a normal score against shifts either way."""
    bets = [math.exp(min(side * shift * score - 0.5 * shift**2, 50.0)) for shift in SHIFTS for side in (-1.0, 1.0)]
    return min(sum(bets) / len(bets), _MOST)


class Ranks:
    """Conformal p-values of a number against those before it: small where it is larger than they."""

    def __init__(self, seed: int) -> None:
        self._before: list[float] = []
        self._lots = np.random.default_rng(seed)

    def update(self, value: float) -> float:
        """The p-value of a further number."""
        self._before.append(value)
        before = np.array(self._before)
        above, same = int(np.sum(before > value)), int(np.sum(before == value))
        return (above + float(self._lots.uniform()) * same) / before.size


def rank_evidence(p: float) -> float:
    """E-value of a p-value: ∫ ε p^(ε−1) dε over ε from 0 to 1."""
    if p >= 1.0 - 1e-9:
        return 0.5
    log = math.log(max(p, 1e-300))
    return min((1.0 - p + p * log) / (p * log**2) if p > 0.0 else _MOST, _MOST)
