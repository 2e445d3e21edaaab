"""Intervals of a diagnosed model: what its laws leave and what its rivals say belong to them.

The covariance of a fit is that of noise. A law that is nearly right makes an error that repeats with the motion, so a
record holds few pieces of evidence about it (``selection.evidence``). With the information H of the readings about the
parameters, R of rest at the start, and the variance v of the error along its ν features, in units of the noise's, the
variances are at least those of

    (H / v + R)⁻¹,    v = 1 + (χ² − N) / ν.

Where rivals are left, a parameter also varies between the explanations i with their probabilities p (the law of total
variance; Hoeting et al. 1999, Stat. Sci. 14):

    var θ = var(θ | leading set) + Σ p_i (θ_i − θ)².

What a force may do between the samples moves the parameters too: a measured one (``residuals.force_between``), or that
of a stop, which may begin late (``residuals.late_contact``).

Friction too weak to be seen is no explanation, but possible on every rig, and what there is of it counts as damping.
The set with friction beside is such an i, with its own variance too: p (var(θ | i) − var(θ | leading set)) more.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate import FitResult
from msd_ident.estimate.covariance import unit_diagonal
from msd_ident.estimate.result import scale_known
from msd_ident.model.effects import by_name
from msd_ident.model.parameters import FORCES
from msd_ident.model.rest import AT_REST, slope_at_rest
from msd_ident.quantity import Quantity
from msd_ident.residuals import force_between, late_contact
from msd_ident.selection import rest_constraint
from msd_ident.selection.evidence import NoiseScale, log_evidence
from msd_ident.selection.hypothesis import COULOMB, Hypothesis
from msd_ident.selection.ranking import DECISIVE

NO_SCALE = (
    "Neither mass nor damping nor stiffness is known to within its value, so no parameter with a unit of force is, "
    "but for those of the force signal itself: push harder or longer, or cut the record to a stretch that the force "
    "moves (--start, --end)."
)


def stated(
    result: FitResult,
    fitted: Hypothesis,
    rivals: Sequence[tuple[float, Hypothesis]],
    scale: NoiseScale,
    rubbing: Hypothesis | None = None,
) -> FitResult:
    """The result of a set with the standard deviations that are stated.

    Args:
        result: of ``fitted``, with the covariance of noise alone.
        fitted: the set.
        rivals: other explanations, each with its probability.
        scale: what the noise leaves.
        rubbing: the set with Coulomb friction too weak to be seen; None where friction acts, or was not tried.

    Returns:
        The same values. Open and fixed parameters keep their standard deviation. A parameter whose standard deviation
        is more than its whole range is open. If neither mass nor damping nor stiffness is known to within its value,
        all parameters with a unit of force are.
    """
    noise = np.sqrt(np.maximum(np.diag(result.covariance), 0.0))
    law = _std(_of_laws(fitted, scale.spread(fitted.chi)))[: noise.size]
    known = np.maximum(noise, law)
    known = np.hypot(known, _std(_sampled(fitted))[: noise.size])
    whole = np.hypot(known, _between(result.free, fitted, rivals))
    if rubbing is not None:
        whole = np.hypot(whole, _unseen(result.free, known, (fitted, rubbing), scale))
    widened = result.with_std(whole)
    quantities = dict(widened.quantities)
    for name in _beyond_range(quantities, fitted):
        quantities[name] = replace(quantities[name], std=math.nan)
    if not scale_known(quantities):
        quantities |= {name: replace(quantities[name], std=math.nan) for name in result.free if name in FORCES}
    return replace(widened, quantities=quantities)


def _beyond_range(quantities: Mapping[str, Quantity], fitted: Hypothesis) -> list[str]:
    """Parameters whose standard deviation is more than the range in which a set is fitted: the data says nothing."""
    problem = fitted.problem
    ranges = dict(zip(problem.names, (problem.upper - problem.lower).tolist(), strict=True))
    return [name for name, one in quantities.items() if one.std > ranges.get(name, math.inf)]


def at_rest(
    result: FitResult, fitted: Hypothesis, rivals: Sequence[tuple[float, Hypothesis]], scale: NoiseScale
) -> dict[str, Quantity]:
    """The stiffness at rest by its name (``model.rest``), if it is printed otherwise than the parameter ``stiffness``.

    That parameter is the slope at the spring's zero, a place that the constant force decides. At rest the slope has an
    interval of its own, because the parameters in it vary together.

    Args:
        result: of ``fitted``, with the covariance of noise alone.
        fitted, rivals, scale: as in ``stated``.
    """
    model = result.model
    if f"{slope_at_rest(model):.4g}" == f"{model.stiffness:.4g}":
        return {}

    def slope(values: Mapping[str, float]) -> float:
        return slope_at_rest(model.with_values(values))

    unit, count = result.quantities["stiffness"].unit, len(result.free)
    law = _of_laws(fitted, scale.spread(fitted.chi))[:count, :count]
    known = [replace(result, covariance=one).derived(slope, unit) for one in (result.covariance, law)]
    lead = slope_at_rest(fitted.model)
    between = sum(p * (slope_at_rest(rival.model) - lead) ** 2 for p, rival in rivals)
    sampled = replace(result, covariance=_sampled(fitted)[:count, :count]).derived(slope, unit).std
    std = math.hypot(max((one.std for one in known), key=_open_first), math.sqrt(between), sampled)
    return {AT_REST: replace(known[0], std=std)}


def _open_first(std: float) -> float:
    return math.inf if math.isnan(std) else std


def _of_laws(fitted: Hypothesis, variance: float, before: FloatArray | float = 0.0) -> FloatArray:
    """Covariance (q, q) of the entries of a set's vector, parameters first, where the error of its laws has this
    variance.

    Args:
        fitted: the set.
        variance: in units of the noise's.
        before: (q,) information about the entries by themselves, before any data.
    """
    rest = rest_constraint.information(fitted.problem, fitted.point, fitted.problem.balances)
    scaled, size = unit_diagonal(fitted.information / variance + rest + np.diag(np.zeros(rest.shape[0]) + before))
    return np.asarray(np.linalg.pinv(scaled, rcond=1e-15, hermitian=True) / np.outer(size, size))


def _sampled(fitted: Hypothesis) -> FloatArray:
    """Covariance (q, q) of the entries by what the force, measured or of a stop, may do between the samples."""
    jacobian = fitted.state.jacobian
    slopes = force_between.slopes(fitted.readings, fitted.model, jacobian)
    slopes += late_contact.slopes(fitted.readings, fitted.model, fitted.initial, jacobian)
    if not slopes.any():
        return slopes
    inverse = _of_laws(fitted, 1.0)
    return np.asarray(inverse @ slopes @ inverse)


def _std(covariance: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance), 0.0)))


def _between(names: tuple[str, ...], fitted: Hypothesis, rivals: Sequence[tuple[float, Hypothesis]]) -> FloatArray:
    """Standard deviation (p,) of parameters between the explanations that have them."""
    variance = np.zeros(len(names))
    for probability, rival in rivals:
        for place, name in enumerate(names):
            if name in rival.model.names:
                variance[place] += probability * (rival.model[name] - fitted.model[name]) ** 2
    return np.asarray(np.sqrt(variance))


def _unseen(
    names: tuple[str, ...], known: FloatArray, sets: tuple[Hypothesis, Hypothesis], scale: NoiseScale
) -> FloatArray:
    """Standard deviation (p,) that parameters have because of friction too weak to be seen.

    Args:
        names: of the parameters.
        known: (p,) their standard deviations without friction.
        sets: without and with it.
        scale: what the noise leaves.
    """
    plain, rubbing = sets
    odds = math.exp(min(log_evidence(rubbing, scale) - log_evidence(plain, scale), DECISIVE))
    entries = rubbing.problem.names
    natural = np.zeros(len(entries))
    for place in [entries.index(parameter.name) for parameter in by_name(COULOMB).parameters]:
        most = min(float(rubbing.problem.scale[place]), _replacing(rubbing, place, plain.model.damping))
        natural[place] = 1.0 / max(most, 1e-150) ** 2
    own = dict(zip(entries, _std(_of_laws(rubbing, scale.spread(rubbing.chi), natural)), strict=True))
    moved = [rubbing.model[name] - plain.model[name] for name in names]
    more = np.maximum([own[name] ** 2 for name in names] - known**2, 0.0)
    return np.asarray(np.sqrt(odds / (1.0 + odds) * (np.square(moved) + more)))


def _replacing(rubbing: Hypothesis, place: int, damping: float) -> float:
    """The friction [N] that takes as much of the motion as all damping does, by the information of a set with both.

    There is no more of it: neither of the two is below 0. Over a few swings the data tells only their sum, and a
    covariance alone lets one grow and the other fall far beyond that.

    Args:
        rubbing: the set.
        place: of the friction in its vector.
        damping: of the set without friction [N·s/m].
    """
    if "damping" not in rubbing.problem.names:
        return math.inf
    known, damper = _of_laws(rubbing, 1.0), rubbing.problem.names.index("damping")
    spread = float(known[place, place])
    lost = -float(known[damper, place]) / spread if spread > 0.0 else 0.0  # damping for one newton of friction
    return damping / lost if lost > 0.0 and damping > 0.0 else math.inf
