"""The encoder: what becomes of a true position on its way to a stamp and a number."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from msd_sim.errors import RigError
from msd_sim.parameter import RigParameter

FloatArray = npt.NDArray[np.float64]

PARAMETERS = (
    RigParameter("counts_per_metre", "1/m", 0.0, 0.0, 1e12, "resolution; 0: none, exact readings"),
    RigParameter("noise", "m", 0.0, 0.0, 1.0, "standard deviation of Gaussian noise, added before the counts"),
    RigParameter("delay", "s", 0.0, 0.0, 1.0, "age of a reading at its stamp"),
    RigParameter("jitter", "s", 0.0, 0.0, 1.0, "standard deviation of the stamps' error"),
    RigParameter("dropout", "", 0.0, 0.0, 0.99, "probability that a sample begins a gap"),
    RigParameter("dropout_length", "", 1.0, 1.0, 1e6, "mean number of samples in a gap"),
    RigParameter("noise_correlation", "", 0.0, 0.0, 1e6, "samples in which the noise forgets itself (AR(1)); 0: white"),
    RigParameter("speed_noise", "s", 0.0, 0.0, 1.0, "noise that grows with speed: standard deviation per m/s"),
)


@dataclass(frozen=True)
class Encoder:
    """Resolution [1/m], noise [m], its memory and growth, delay [s], jitter [s], drop-outs; meanings in ``PARAMETERS``.

    Raises:
        RigError: a value out of range.
    """

    counts_per_metre: float = 0.0
    noise: float = 0.0
    delay: float = 0.0
    jitter: float = 0.0
    dropout: float = 0.0
    dropout_length: float = 1.0
    noise_correlation: float = 0.0
    speed_noise: float = 0.0

    def __post_init__(self) -> None:
        known = {parameter.name: parameter for parameter in PARAMETERS}
        for item in fields(self):
            object.__setattr__(self, item.name, known[item.name].checked(getattr(self, item.name), "encoder"))


class EncoderReader:
    """Reads positions through an encoder; the same seed gives the same readings however they are cut in chunks."""

    def __init__(self, encoder: Encoder, seed: int = 0) -> None:
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise RigError(f"seed is {seed!r}; expected a whole number of 0 or more")
        self.encoder = encoder
        self._noise, self._jitter, self._gaps = (
            np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(3)
        )
        self._in_gap = False
        self._last_noise: float | None = None

    def read(self, position: FloatArray, velocity: FloatArray | None = None) -> FloatArray:
        """Readings [m] of (n,) positions [m]: noise, then whole counts.

        Args:
            position: where the cart is.
            velocity: (n,) its speed there [m/s], for noise that grows with it; without it the cart counts as at rest.
        """
        seen = position
        size = np.full(position.size, self.encoder.noise)
        if self.encoder.speed_noise > 0.0 and velocity is not None:
            size = np.hypot(size, self.encoder.speed_noise * velocity)
        if self.encoder.noise > 0.0 or self.encoder.speed_noise > 0.0:
            seen = seen + size * self._correlated(self._noise.standard_normal(position.size))
        if self.encoder.counts_per_metre > 0.0:
            seen = np.round(seen * self.encoder.counts_per_metre) / self.encoder.counts_per_metre
        return np.asarray(seen, dtype=np.float64)

    def _correlated(self, white: FloatArray) -> FloatArray:
        """First-order autoregressive noise of unit variance from (n,) independent draws, going on where it stood."""
        if self.encoder.noise_correlation == 0.0 or not white.size:
            return white
        keep = math.exp(-1.0 / self.encoder.noise_correlation)
        fresh = math.sqrt(1.0 - keep**2)
        value = float(white[0]) if self._last_noise is None else keep * self._last_noise + fresh * float(white[0])
        found = [value]
        for draw in white[1:].tolist():
            value = keep * value + fresh * draw
            found.append(value)
        self._last_noise = value
        return np.array(found)

    def stamps(self, instants: FloatArray, period: float) -> FloatArray:
        """Stamps [s] of (n,) sampling instants: jitter, kept below half a period so that stamps still rise."""
        if self.encoder.jitter == 0.0:
            return instants
        error = self.encoder.jitter * self._jitter.standard_normal(instants.size)
        return np.asarray(instants + np.clip(error, -0.45 * period, 0.45 * period), dtype=np.float64)

    def arrives(self, samples: int) -> npt.NDArray[np.bool_]:
        """Which of the next samples do not get lost."""
        kept = np.ones(samples, dtype=np.bool_)
        if self.encoder.dropout == 0.0:
            return kept
        ends = 1.0 / self.encoder.dropout_length
        for i, chance in enumerate(self._gaps.random(samples)):
            self._in_gap = bool(chance >= ends) if self._in_gap else bool(chance < self.encoder.dropout)
            kept[i] = not self._in_gap
        return kept
