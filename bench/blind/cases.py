"""One blind case: a rig by lot writes a file, the diagnosis gets its path and nothing else, then the envelope is
opened.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from msd_ident import pipeline
from msd_ident.bag import SourceOptions, read
from msd_ident.diagnose import Diagnosis
from msd_ident.fit import fit
from msd_ident.model import Plant
from msd_ident.model.effects import by_name
from msd_ident.record import Record
from msd_sim import api, lottery


@dataclass(frozen=True)
class Case:
    """What is drawn: seed, hidden effect or none, Coulomb friction beside it, experiment, rate [Hz]."""

    seed: int
    hidden: str | None
    beside: bool
    experiment: str = "steps"
    rate: float = 1000.0


@dataclass(frozen=True)
class Outcome:
    """What the diagnosis said, and what it cost.

    ``base_floors`` and ``extended_floors`` are residuals in noise floors, ``without_floors`` what the truth without the
    hidden effect leaves when refitted: how visible the effect is. ``removed`` is the share of the removable error that
    the extension removed on left-out data. ``beside`` are causes of rival sets that are not named, each with its own
    probability.
    """

    case: Case
    truth: tuple[str, ...]
    odd: bool
    strength: Mapping[str, float]
    verdict: str
    named: tuple[tuple[str, float, tuple[str, ...]], ...]
    base_floors: float
    extended_floors: float
    without_floors: float
    heldout_floors: float
    removed: float
    seconds: float
    processor_seconds: float = math.nan
    beside: tuple[tuple[str, float], ...] = ()

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)

    @classmethod
    def from_json_dict(cls, values: Mapping[str, Any]) -> Outcome:
        """The inverse of ``to_json_dict``."""
        named = tuple((name, probability, tuple(tied)) for name, probability, tied in values["named"])
        beside = tuple((name, probability) for name, probability in values.get("beside", ()))
        case = Case(**values["case"])
        return cls(**{**values, "case": case, "truth": tuple(values["truth"]), "named": named, "beside": beside})

    @property
    def names(self) -> frozenset[str]:
        """Causes named."""
        return frozenset(name for name, _, _ in self.named)

    def counts_as(self, name: str) -> bool:
        """Whether a cause is named, or tied with one that is; ties of more than three do not count."""
        return any(name == one or (name in ties and len(ties) <= 2) for one, _, ties in self.named)

    @property
    def exact(self) -> bool:
        """Nothing missing and nothing extra, where a tie with the truth is the truth."""
        return len(self.named) == len(self.truth) and all(self.counts_as(name) for name in self.truth)


def write(draw: lottery.Draw, path: Path) -> None:
    """Run the rig and write its record as CSV, as a lab would."""
    made = api.simulate(draw.spec)
    # A step on a tick acts from this very sample on, whichever way the last digit of its stamp was rounded.
    place = np.searchsorted(made.force_time, made.time + 1e-9, side="right") - 1
    force = np.where(place < 0, 0.0, made.force[np.maximum(place, 0)])
    table = np.stack([made.time, force, made.position], axis=1)
    np.savetxt(path, table, delimiter=",", header="time_s,force_n,position_m", comments="", fmt="%.12g")


def run(case: Case) -> Outcome:
    """Draw, write, diagnose, open the envelope."""
    draw = lottery.draw(case.seed, case.hidden, case.beside, case.experiment, case.rate)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "record.csv"
        write(draw, path)
        began = time.perf_counter(), time.process_time()
        record = read(path, SourceOptions())
        diagnosis = pipeline.diagnose([record])
        seconds = time.perf_counter() - began[0], time.process_time() - began[1]
    return _opened(case, draw, record, diagnosis, seconds)


def _opened(
    case: Case, draw: lottery.Draw, record: Record, diagnosis: Diagnosis, seconds: tuple[float, float]
) -> Outcome:
    floors = (diagnosis.base_adequacy.ratio, diagnosis.adequacy.ratio)
    removable = diagnosis.heldout.see_base**2 - draw.noise**2
    left = max(diagnosis.heldout.see_extended**2 - draw.noise**2, 0.0)
    return Outcome(
        case=case,
        truth=tuple(sorted(draw.truth)),
        odd=case.hidden in lottery.ODDITIES,
        strength=dict(draw.spec["effects"].get(case.hidden, {})),
        verdict=diagnosis.verdict,
        named=tuple((cause.name, cause.probability, cause.tied_with) for cause in diagnosis.causes),
        base_floors=floors[0],
        extended_floors=floors[1],
        without_floors=_without(draw, record) if draw.beside else floors[0],
        heldout_floors=diagnosis.heldout.see_extended / draw.noise,
        removed=1.0 - math.sqrt(left / removable) if removable > 0.0 else math.nan,
        seconds=seconds[0],
        processor_seconds=seconds[1],
        beside=_beside(diagnosis),
    )


def _beside(diagnosis: Diagnosis) -> tuple[tuple[str, float], ...]:
    """Causes of the rival sets that are not named, and the probability that each acts."""
    named = {cause.name for cause in diagnosis.causes}
    others = sorted({name for rival in diagnosis.rivals for name in rival.causes} - named)
    return tuple((name, sum(r.probability for r in diagnosis.rivals if name in r.causes)) for name in others)


def _without(draw: lottery.Draw, record: Record) -> float:
    """What the truth without the hidden effect leaves when refitted, in noise floors."""
    model = Plant(draw.spec["mass"], draw.spec["damping"], draw.spec["stiffness"])
    for name in sorted(draw.truth - {draw.hidden}):
        model = model + by_name(name).from_values(dict(draw.spec["effects"][name]))
    return fit(model, record).see / draw.noise
