"""What a model leaves unexplained: the missing force, and the motion that it makes.

The missing force is smoothed from the residual (``disturbance``). Its mean square is that of the smoothed force plus
the smoother's variance, because what is too fast or too faint for the readings is a part of the missing force too. The
interval is a bootstrap over swings: how far the mean square moves when other swings of this experiment are drawn. It
begins with the smoothed force alone, without what nobody sees of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from msd_ident import seeds
from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import FitResult
from msd_ident.estimate.levels import CONFIDENCE, FEWEST
from msd_ident.estimate.result import scale_known
from msd_ident.residuals.adequacy import Adequacy
from msd_ident.residuals.disturbance import DisturbanceEstimate
from msd_ident.tuning import fixed

TOLERANCE = fixed(1.0, "interface", "default tolerance: unexplained part of the motion [%] that is acceptable")
#: Part of a distribution beyond either end of an interval.
_BEYOND = 0.5 * (1.0 - CONFIDENCE)
#: Draws of the bootstrap, so that ``FEWEST`` of them lie beyond either end of the interval.
_DRAWS = round(FEWEST / _BEYOND)


@dataclass(frozen=True)
class Remainder:
    """What one model leaves.

    Attributes:
        force: root mean square of the missing force, in the record's unit of force; NaN where the data leaves the scale
            of all forces open.
        force_interval: 95 % interval of it; from 0 on where the residual is no more than noise.
        force_percent: the same as a part of the yardstick's rms [%]; NaN where there is none.
        motion_percent: what it makes of the motion: residual beyond the noise, as a part of the motion's rms [%].
        seen: whether the data can tell the residual from noise.
    """

    force: float
    force_interval: tuple[float, float]
    force_percent: float
    motion_percent: float
    seen: bool

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "force_rms": self.force,
            "force_interval": list(self.force_interval),
            "force_percent": self.force_percent,
            "motion_percent": self.motion_percent,
            "seen": self.seen,
        }


@dataclass(frozen=True)
class Remainders:
    """What base and extended model leave, and the force that it is compared with.

    Attributes:
        base, extended: of either model; the same where nothing is named.
        yardstick: ``applied force``, or ``spring force`` where no force varies (a free decay).
        yardstick_rms: its root mean square, in ``force_unit``.
        force_unit: of all forces here; of a free decay, which does not tell the mass, for each unit of mass.
        motion_rms: of the motion about its mean, in the position unit.
        noise_percent: the noise floor as a part of the motion's rms [%].
        tolerance_percent: part of the motion [%] that the lab does not care about.
    """

    base: Remainder
    extended: Remainder
    yardstick: str
    yardstick_rms: float
    force_unit: str
    motion_rms: float
    noise_percent: float
    tolerance_percent: float = TOLERANCE

    @property
    def exceeds(self) -> bool:
        """Whether the extended model leaves something that the data can see and that is more than the tolerance."""
        return self.extended.seen and self.extended.motion_percent > self.tolerance_percent

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values, without the tolerance."""
        return {
            "base": self.base.to_json_dict(),
            "extended": self.extended.to_json_dict(),
            "force_percent_of": self.yardstick,
            "force_unit": self.force_unit,
            "motion_rms_m": self.motion_rms,
            "noise_percent": self.noise_percent,
        }


@dataclass(frozen=True)
class JudgedModel:
    """A fitted model, its missing force and the tests of its residual.

    Attributes:
        fit: the model on the records.
        missing: the force that it lacks, one for each record.
        adequacy: whether its residual is noise.
    """

    fit: FitResult
    missing: Sequence[DisturbanceEstimate]
    adequacy: Adequacy


def remainders(
    records: Sequence[Record], noise: float, base: JudgedModel, extended: JudgedModel, tolerance: float = TOLERANCE
) -> Remainders:
    """What either model leaves.

    Args:
        records: of the experiment.
        noise: floor of all readings together [m].
        base, extended: the two models.
        tolerance: part of the motion's rms that the lab does not care about [%].
    """
    motion = _rms([record.position - np.mean(record.position) for record in records])
    yardstick, size = _yardstick(records, motion, extended.missing)

    def left_by(model: JudgedModel) -> Remainder:
        """What a model leaves, as a force and as a part of the motion."""
        force, interval = math.nan, (math.nan, math.nan)
        if scale_known(model.fit.quantities):
            force, interval = _force(model.missing, model.adequacy.consistent)
        return Remainder(
            force=force,
            force_interval=interval,
            force_percent=100.0 * force / size if size > 0.0 else math.nan,
            motion_percent=100.0 * math.sqrt(max(model.fit.see**2 - noise**2, 0.0)) / motion,
            seen=not model.adequacy.consistent,
        )

    unit = _unit(records, base.fit.quantities["mass"].unit)
    return Remainders(
        left_by(base), left_by(extended), yardstick, size, unit, motion, 100.0 * noise / motion, float(tolerance)
    )


def _unit(records: Sequence[Record], mass: str) -> str:
    """Unit of the missing force; without any force the model has one unit of mass, and only ratios are known."""
    forced = any(bool(np.any(record.force)) for record in records)
    return records[0].force_unit if forced else f"{records[0].force_unit} per {mass}"


def _yardstick(records: Sequence[Record], motion: float, missing: Sequence[DisturbanceEstimate]) -> tuple[str, float]:
    """The force that the missing one is compared with, and its rms; that of a spring is of all that pull like one."""
    applied = [record.force_at(record.time) for record in records]
    if any(np.ptp(force) > 0.0 for force in applied):
        return "applied force", _rms(applied)
    stiffness = float(np.mean([part.plant[2] for part in missing]))
    return "spring force", max(stiffness, 0.0) * motion


def _rms(parts: Sequence[FloatArray]) -> float:
    """Root mean square over all records."""
    return math.sqrt(sum(float(part @ part) for part in parts) / sum(part.size for part in parts))


def _force(missing: Sequence[DisturbanceEstimate], is_noise: bool) -> tuple[float, tuple[float, float]]:
    """Root mean square of the missing force and its 95 % interval: from what is seen of it, to all that may be."""
    sums = np.concatenate([_by_swing(part) for part in missing], axis=1)
    draws = np.random.default_rng(seeds.REMAINDER).integers(sums.shape[1], size=(_DRAWS, sums.shape[1]))
    seen, whole = np.sqrt(sums[:2, draws].sum(axis=2) / sums[2, draws].sum(axis=1))
    low, high = float(np.quantile(seen, _BEYOND)), float(np.quantile(whole, 1.0 - _BEYOND))
    force = math.sqrt(float(sums[1].sum() / sums[2].sum()))
    return force, (0.0 if is_noise else min(low, force), max(high, force))


def _by_swing(part: DisturbanceEstimate) -> FloatArray:
    """(3, blocks): sums of squares of the smoothed force and of all that it may be, and numbers of samples, over blocks
    of about a swing.
    """
    duration = float(part.time[-1] - part.time[0])
    mass, _, stiffness = part.plant
    swing = 2.0 * math.pi * math.sqrt(mass / stiffness) if stiffness > 0.0 else duration
    blocks = max(FEWEST, min(round(duration / swing), part.time.size // FEWEST))
    signals = np.array([part.force**2, part.force**2 + part.std**2, np.ones(part.time.size)])
    cuts = np.array_split(signals, min(blocks, part.time.size), axis=1)
    return np.stack([cut.sum(axis=1) for cut in cuts], axis=1)
