"""What blows that nobody recorded leave in the readings, and how they move the entries of a fit.

Each blow has a known place and size and an unknown sign, and moves the cart as the plant alone lets it move.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray
from msd_ident.model import Model, Plant, Simulator
from msd_ident.residuals.noise_model import Readings


@dataclass(frozen=True)
class Blows:
    """Impulses in a record.

    Attributes:
        first: (m,) the sample from which each acts.
        impulse: (m,) its size [N·s].
    """

    first: npt.NDArray[np.intp]
    impulse: FloatArray

    def chi(self, part: Readings, model: Model) -> float:
        """Chi² that they leave in a record's readings, as expected with random signs.

        Args:
            part: the record.
            model: gives mass, damping and stiffness.
        """
        after = np.concatenate(([0.0], np.cumsum(_motion(part, model) ** 2))) / part.noise**2
        share = part.evidence / part.record.samples  # of a piece of evidence, in a sample
        return share * float(self.impulse**2 @ after[part.record.samples - self.first])

    def slopes(self, part: Readings, model: Model, rows: FloatArray) -> FloatArray:
        """Covariance (q, q) of the slopes of chi²/2 over the entries of a fit that they make: the middle of a sandwich.

        Args:
            part, model: as of ``chi``.
            rows: (q, n) Jacobian of the record's residuals, in units of the noise.
        """
        from scipy.signal import correlate  # imported here: it takes a quarter of a second

        struck = _motion(part, model)
        seen = correlate(rows * part.root, struck[None, :])[:, struck.size - 1 :]  # of a blow at each sample
        moved = self.impulse * seen[:, self.first]
        return np.asarray(moved @ moved.T)


def each(readings: Sequence[Readings], jacobian: FloatArray) -> Iterable[tuple[Readings, FloatArray]]:
    """Every record with its part of the Jacobian (q, n) of all residuals."""
    ends = np.cumsum([part.record.samples for part in readings])[:-1]
    return zip(readings, np.split(jacobian, ends, axis=1), strict=True)


def _motion(part: Readings, model: Model) -> FloatArray:
    """Positions (n,) of the plant after a blow of 1 N·s at the first sample."""
    plant = Plant(model.mass, model.damping, model.stiffness)
    quiet = replace(part.record, force=np.zeros(part.record.force.size))
    return Simulator(plant, quiet).positions(plant.values, 0.0, 1.0 / plant.mass)
