"""Open directions: combinations of parameters that the data does not determine, as vectors and as sentences.

Directions come from the scaled Jacobian (its Gram matrix and the covariance), not from a table of known cases; each
parameter only supplies the advice on what to measure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.covariance import unit_diagonal
from msd_ident.estimate.levels import MOST_OF, NEGLIGIBLE, NULL, TENTH
from msd_ident.model import Parameter
from msd_ident.model.parameters import FORCES, PARAMETERS

_UNKNOWN = Parameter("", "", "1", -math.inf, math.inf, "")
_DEFAULT_ADVICE = "add an experiment in which this effect is stronger"


@dataclass(frozen=True)
class OpenDirection:
    """A combination of parameters that the data does not determine.

    Attributes:
        shares: names of the parameters, and by how much each changes along the direction, in its unit.
        sentence: what is open, and what to measure instead.
    """

    shares: tuple[tuple[str, float], ...]
    sentence: str

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that take part."""
        return tuple(name for name, _ in self.shares)


def null_directions(matrix: FloatArray, reference: FloatArray, pinned: FloatArray) -> list[FloatArray]:
    """Null directions of a Gauss–Newton matrix: combinations of parameters that change no residual.

    Args:
        matrix: (p, p) Gauss–Newton matrix.
        reference: (p,) natural sizes of the parameters, positive.
        pinned: (p, p) information from elsewhere than the samples, such as rest at the start. A direction along which
            it fixes the parameters to better than their natural size does not count.

    Returns:
        Directions (p,) in units of ``reference``, each with as few entries as possible and a largest entry of size 1.
    """
    scaled, size = unit_diagonal(matrix)
    values, vectors = np.linalg.eigh(scaled)
    null = vectors[:, values <= NULL * max(float(values[-1]), 1e-300)] / (size * reference)[:, None]
    if not null.shape[1]:
        return []
    null = null / np.abs(null).max(axis=0)
    known = null.T @ (pinned * np.outer(reference, reference)) @ null
    strength, mixture = np.linalg.eigh(known)
    return _sparse((null @ mixture[:, strength < 1.0]).T)


def _sparse(basis: FloatArray) -> list[FloatArray]:
    """Reduced row-echelon form with full pivoting: the same space, each direction with as few entries as possible."""
    rows = np.array(basis, dtype=np.float64)
    for i in range(len(rows)):
        rows[i:] /= np.maximum(np.abs(rows[i:]).max(axis=1, keepdims=True), 1e-300)
        pivot = int(np.argmax(np.abs(rows[i])))
        rows[i] /= rows[i, pivot]
        others = np.arange(len(rows)) != i
        rows[others] -= np.outer(rows[others, pivot], rows[i])
    return [row / np.abs(row).max() for row in rows]


def describe(
    direction: FloatArray, names: tuple[str, ...], values: FloatArray, reference: FloatArray, forced: bool
) -> OpenDirection | None:
    """An open direction in words.

    Args:
        direction: (p,) in units of ``reference``.
        names: (p,) parameter names; a record's own entries contain `` of ``.
        values: (p,) fitted values.
        reference: (p,) natural sizes of the parameters.
        forced: whether any force acts in the data.

    Returns:
        None if only initial states and zeros take part, which are of no interest to the user.
    """
    change = direction * reference
    own = np.where(values != 0.0, np.abs(values), reference)
    shares = [(name, float(change[i])) for i, name in enumerate(names) if abs(change[i]) >= NEGLIGIBLE * own[i]]
    physical = [name for name, _ in shares if " of " not in name]
    if not physical:
        return None
    zeros = [name for name, _ in shares if name.startswith("zero of")]
    common = _common_factor(change, values, names)
    return OpenDirection(tuple(shares), _sentence(physical, zeros, common, forced))


def exchanged(
    direction: FloatArray, names: tuple[str, ...], values: FloatArray, reference: FloatArray
) -> frozenset[str]:
    """Parameters that others can stand in for along an open direction: those that take a large part in it.

    Where it changes most forces by one factor, another factor counts, not this one: none of those forces can vanish
    beside the others.

    Arguments are those of ``describe``.
    """
    forces = np.array([name in FORCES for name in names]) & (values != 0.0)
    part, own = direction.copy(), np.where(values != 0.0, values, reference)
    factor = (direction * reference / own)[forces]
    common = float(np.median(factor)) if factor.size else 0.0
    if np.count_nonzero(np.abs(factor - common) < TENTH * abs(common)) > MOST_OF * factor.size:
        part[forces] -= common * (values / reference)[forces]
    most = TENTH * float(np.max(np.abs(part), initial=0.0))
    return frozenset(name for name, one in zip(names, part, strict=True) if abs(one) > max(most, NEGLIGIBLE))


def motionless(names: tuple[str, ...]) -> OpenDirection:
    """The open direction of data without motion, in which all parameters are open."""
    sentence = f"Nothing moves in this data, so {', '.join(names)} are open: push hard enough to move the cart."
    return OpenDirection(tuple((name, 1.0) for name in names), sentence)


def of_a_tone(omega: float, known: str) -> OpenDirection:
    """Mass and stiffness where a single tone shows only k - m·omega².

    Args:
        omega: of the tone [rad/s].
        known: that value with its unit.
    """
    sentence = (
        f"mass and stiffness are known only together, as k - m·omega² = {known}: force and motion are a single tone of "
        f"{omega / (2.0 * math.pi):.3g} Hz, and the model leaves more than noise: add a record at another frequency, a "
        "sweep or steps."
    )
    return OpenDirection((("mass", 1.0), ("stiffness", omega**2)), sentence)


def _sentence(physical: list[str], zeros: list[str], common: bool, forced: bool) -> str:
    listed = ", ".join(physical)
    if len(physical) == 1 and zeros and (why := _of(listed).open_with_zero):
        return f"{listed} and the position's zero {why}: {_of(listed).advice}."
    if common and not forced:
        return (
            f"{listed} are known only up to a common factor, because no force acts in this data; their ratios are "
            "known: "
            "push with a known force, or weigh the moving mass."
        )
    if common:
        return f"{listed} are known only up to a common factor: push with a known force, or weigh the moving mass."
    scale = next((name for name in physical if _of(name).open_with_scale), None)
    if scale is not None and len(physical) > 1:
        others = ", ".join(name for name in physical if name != scale)
        return f"{scale} {_of(scale).open_with_scale.format(others=others)}: {_of(scale).advice}."
    advice = next((_of(name).advice for name in reversed(physical) if _of(name).advice), _DEFAULT_ADVICE)
    if len(physical) == 1:
        tail = " and the position's zero" if zeros else ""
        return f"{listed}{tail} is left open by this data: {advice}."
    return f"{listed} cannot be told apart by this data; only a combination of them is known: {advice}."


def _of(name: str) -> Parameter:
    """What the library says of a parameter; of one that it does not have, nothing."""
    return PARAMETERS.get(name, _UNKNOWN)


def _common_factor(change: FloatArray, values: FloatArray, names: tuple[str, ...]) -> bool:
    """Whether the direction scales all forces by one factor."""
    forces = np.array([name in FORCES for name in names])
    known = forces & (values != 0.0)
    if np.count_nonzero(known) < 2:
        return False
    factor = change[known] / values[known]
    middle = float(np.median(factor))
    others = [i for i, name in enumerate(names) if not forces[i] and " of " not in name]
    still = all(abs(change[i]) <= 0.05 * abs(middle * values[i]) or values[i] == 0.0 for i in others)
    return still and middle != 0.0 and bool(np.all(np.abs(factor / middle - 1.0) < 0.1))


def loose(names: tuple[str, ...], values: FloatArray, std: FloatArray, reference: FloatArray) -> list[OpenDirection]:
    """Single parameters whose standard deviation is larger than both their value and their natural size.

    Args:
        names: (p,) parameter names; a record's own entries contain `` of `` and are left out.
        values: (p,) fitted values.
        std: (p,) standard deviations.
        reference: (p,) natural sizes.
    """
    found = []
    for name, value, deviation, size in zip(names, values, std, reference, strict=True):
        if " of " not in name and deviation > max(abs(value), size):
            advice = _of(name).advice or _DEFAULT_ADVICE
            found.append(OpenDirection(((name, 1.0),), f"{name} is left open by this data: {advice}."))
    return found
