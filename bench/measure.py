"""How the benchmark measures: medians of repeated runs on one core, rows with a required value and a goal."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

#: Samples of the records on which cost against length is measured.
LENGTHS = (1_000, 10_000, 100_000, 1_000_000)


@dataclass(frozen=True)
class Row:
    """One figure.

    Attributes:
        figure: what was measured.
        value: the median, in ``unit``.
        must, aim: bounds, NaN where there is none; ``at_least``: whether they are lower ones.
        detail: the numbers behind it, for the table's last column.
    """

    figure: str
    value: float
    unit: str
    must: float = math.nan
    aim: float = math.nan
    at_least: bool = False
    detail: str = ""

    def _holds(self, bound: float) -> bool:
        return self.value >= bound if self.at_least else self.value <= bound

    @property
    def grade(self) -> str:
        """``aim``, ``must`` or ``missed``; empty for a figure without bounds."""
        if math.isnan(self.must) and math.isnan(self.aim):
            return ""
        if not math.isnan(self.aim) and self._holds(self.aim):
            return "aim"
        return "must" if math.isnan(self.must) or self._holds(self.must) else "missed"

    def to_dict(self) -> dict[str, Any]:
        """For JSON: bounds that are not there are null."""
        plain = {key: None if isinstance(v, float) and math.isnan(v) else v for key, v in asdict(self).items()}
        return {**plain, "grade": self.grade}


def median_seconds(call: Callable[[], object], *, budget: float = 0.5, fewest: int = 5) -> float:
    """Median duration [s] of calls repeated for about ``budget`` seconds, the first one not counted."""
    call()
    runs: list[float] = []
    end = time.perf_counter() + budget
    while len(runs) < fewest or (time.perf_counter() < end and len(runs) < 5000):
        begun = time.perf_counter()
        call()
        runs.append(time.perf_counter() - begun)
    return statistics.median(runs)


def linearity(what: str, prepare: Callable[[int, int], Callable[[], object]], rounds: int) -> Row:
    """Cost of the same work on records of all ``LENGTHS``: how far the added cost a sample departs from its median.

    All lengths are measured in turn, round after round, and compared within each round: a machine that changes its pace
    does so for all of them. The first round is not counted; in the others all work is repeated, short work the more
    often. ``prepare(samples, round)`` makes what is to be timed, anew for each time.
    """
    seconds = [[_one_round(prepare, size, turn) for size in LENGTHS] for turn in range(rounds + 1)][1:]
    steps = list(enumerate(pairwise(LENGTHS)))
    slopes = [[(one[i + 1] - one[i]) / (longer - shorter) for i, (shorter, longer) in steps] for one in seconds]
    at_one_pace = [[slope / statistics.mean(own) for slope in own] for own in slopes]
    added = [statistics.median(slope) for slope in zip(*at_one_pace, strict=True)]
    usual = statistics.median(added)
    departure = 100.0 * max(abs(slope / usual - 1.0) for slope in added)
    medians = [statistics.median(one) for one in zip(*seconds, strict=True)]
    detail = ", ".join(f"{1e3 * s:.4g} ms" for s in medians)
    return Row(f"{what} against length 1e3..1e6, departure from linear", departure, "%", must=20.0, detail=detail)


def _one_round(prepare: Callable[[int, int], Callable[[], object]], size: int, turn: int) -> float:
    """Median duration [s] of work on a record of this size."""
    runs = []
    for _ in range(max(3, min(50, LENGTHS[-1] // (10 * size))) if turn > 0 else 1):
        call = prepare(size, turn)
        begun = time.perf_counter()
        call()
        runs.append(time.perf_counter() - begun)
    return statistics.median(runs)
