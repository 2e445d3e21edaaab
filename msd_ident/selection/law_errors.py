"""What a cause explains beyond the others, beside what an error of their laws could: no law is exact.

What a set leaves may be another form of its laws and not a further cause.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from msd_ident.estimate.levels import MOST_OF
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.residuals.noise_model import NOISE_ERROR
from msd_ident.selection.certainty import CERTAIN_ODDS, FAINT, FORM_PART, ROUGH
from msd_ident.selection.evidence import LEAST_SPREAD, NoiseScale, log_prior
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, Hypothesis, imitated_by, kinds


def further_parts(causes: Causes, sets: Mapping[Causes, Hypothesis]) -> dict[str, float]:
    """What each cause of a set explains beyond the other causes, as a part of what these explain.

    For a set S and a cause c it is √((χ²(S − c) − χ²(S)) / (χ²(base) − χ²(S − c))). A cause is left out if S − c
    (``_fitted``) explains no more than the base model does.

    Args:
        causes: the set.
        sets: all fitted sets by their causes.
    """
    found = {name: _part_beyond(_fitted(causes - {name}, sets), causes, sets) for name in causes}
    return {name: part for name, part in found.items() if math.isfinite(part)}


def _fitted(causes: Causes, sets: Mapping[Causes, Hypothesis]) -> Causes:
    """The fitted set of these causes; if they were not worth a fit, that of some of them which leaves least."""
    if causes in sets:
        return causes
    return min((one for one in sets if one < causes), key=lambda one: sets[one].chi, default=causes)


def _stored(causes: Causes) -> Causes:
    """Those of the causes of which every law only stores energy."""
    takes = {law.cause() for law in LIBRARY if not law.stores_only()}
    return frozenset(name for name in causes if by_name(name).cause() not in takes)


def _part_beyond(
    limit: Causes, causes: Causes, sets: Mapping[Causes, Hypothesis], beyond: Causes = frozenset()
) -> float:
    """What a set explains beyond a simpler one, as a part of what that one explains beyond the set ``beyond``; infinite
    where the simpler one was not fitted or explains nothing.
    """
    base, simple = sets.get(beyond), sets.get(limit)
    if base is None or simple is None or simple.chi >= base.chi:
        return math.inf
    return math.sqrt(max(simple.chi - sets[causes].chi, 0.0) / (base.chi - simple.chi))


def within_law_error(causes: Causes, sets: Mapping[Causes, Hypothesis], noise: float) -> bool:
    """Whether one of the causes explains no more than an error of the other laws could.

    No law is exact, so what a set leaves may come from another form of its laws. A further cause does not count if it
    explains at most ``LEAST_SPREAD`` of what the others do, or ``FORM_PART`` where less than ``FAINT`` noise floors are
    left without it. Where the set leaves only noise, no error of a law is seen: every cause counts, and
    ``other_forms`` limits its probability. A law that takes energy out is not measured by others that only store it:
    what gravity explains grows with the amplitude, and no form of it makes a motion fade.
    """
    exact = leaves_noise(sets[causes], noise)
    for name in further_parts(causes, sets):
        smaller = sets.get(causes - {name})
        if exact or smaller is None:
            continue
        stored = _stored(causes - {name}) if by_name(name).dissipative else frozenset[str]()
        part = _part_beyond(causes - {name}, causes, sets, _fitted(stored, sets))
        if part <= (FORM_PART if smaller.chi < FAINT**2 * noise else LEAST_SPREAD):
            return True
    return False


def leaves_noise(fitted: Hypothesis, noise: float) -> bool:
    """Whether a set leaves only noise."""
    return fitted.chi < (1.0 + NOISE_ERROR) * noise


def other_forms(causes: Causes, sets: Mapping[Causes, Hypothesis], noise: float) -> dict[str, float]:
    """Causes of a set that may be another form of its other laws, with what they explain beyond these, as a part of
    what these explain. A law that holds Coulomb friction as a limit is compared with Coulomb friction in its place too.

    They may be one if they explain at most ``FORM_PART``; where the set leaves only noise and more than ``ROUGH`` noise
    floors are left without the cause, ``LEAST_SPREAD``. Where the set leaves more than noise, each spring beside the
    one that explains most may be an error of its shape, whatever it explains: two curves over the position come near
    any third one. So may each curve of the sensor, and each linear filter of the force.
    """
    found = _beyond_others(causes, sets, noise)
    for name, part in _beyond_coulomb(causes, sets, noise).items():
        found[name] = min(part, found.get(name, part))
    return found


def _beyond_others(causes: Causes, sets: Mapping[Causes, Hypothesis], noise: float) -> dict[str, float]:
    """Causes that may be another form of the other laws of the set, see ``other_forms``."""
    parts, exact = further_parts(causes, sets), leaves_noise(sets[causes], noise)
    rough = {name for name in parts if not exact or sets[_fitted(causes - {name}, sets)].chi < ROUGH**2 * noise}
    found = {name: part for name, part in parts.items() if part <= (FORM_PART if name in rough else LEAST_SPREAD)}
    if not exact:
        found |= {name: parts.get(name, math.inf) for name in _further_curves(causes, parts)}
    return found


def _beyond_coulomb(causes: Causes, sets: Mapping[Causes, Hypothesis], noise: float) -> dict[str, float]:
    """Laws with Coulomb friction as a limit that may be another form of it, with what they explain beyond it."""
    found = {}
    for name in causes & set(HOLDING_COULOMB):
        limit = causes - {name} | {COULOMB}
        part = _part_beyond(limit, causes, sets)
        if part <= LEAST_SPREAD or (part <= FORM_PART and sets[limit].chi < FAINT**2 * noise):
            found[name] = part
    return found


def _further_curves(causes: Causes, parts: Mapping[str, float]) -> list[str]:
    """Curves over the position, or filters of the force, beside one of their kind that explains more."""
    order = sorted(causes, key=lambda name: (-parts.get(name, math.inf), name))  # one not worth a fit explains little
    return [
        name for place, name in enumerate(order) if any(by_name(name).bends_as(by_name(one)) for one in order[:place])
    ]


def clearness(
    causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale, times: float = 1.0
) -> dict[str, float]:
    """How clearly a set needs each of its causes: what the cause explains, in units of what the set leaves.

    It is (χ²(S − c) − χ²(S)) / max(χ²(S) − N, δN). Where the set leaves only noise, it leaves what the noise can hide,
    whose variance is known to δ = ``NOISE_ERROR``. If only the set's own residual tells of this noise, an error of its
    laws may be a part of it: then no cause is certain that may be one. A law that holds Coulomb friction as a limit is
    compared with Coulomb friction in its place too. Causes without a fitted smaller set are left out.

    Args:
        causes: the set.
        sets: all fitted sets by their causes.
        scale: gives the noise.
        times: error on left-out data over that of the fit, if the set leaves as much there (``generalization``).
    """
    found = _clear_of_less(causes, sets, scale, times)
    for name in causes & set(HOLDING_COULOMB):
        limit = causes - {name} | {COULOMB}
        if limit in sets:
            found[name] = min(_clear_of(limit, causes, sets, scale, times), found.get(name, math.inf))
    return found


def clear_as_friction(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> dict[str, float]:
    """Laws of a set with Coulomb friction as a limit, and how clearly it needs one of the two (``clearness``).

    Those that may be another form of the other causes are left out: friction itself is in doubt there.

    Args:
        causes: the set.
        sets: all fitted sets by their causes.
        scale: gives the noise.
    """
    beside = _beyond_others(causes, sets, scale.noise)
    clear = _clear_of_less(causes, sets, scale, 1.0)
    return {name: odds for name, odds in clear.items() if name in HOLDING_COULOMB and name not in beside}


def _clear_of_less(
    causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale, times: float
) -> dict[str, float]:
    """``clearness`` beside the sets that lack a cause each."""
    less = {name: _fitted(causes - {name}, sets) for name in causes}
    return {name: _clear_of(one, causes, sets, scale, times) for name, one in less.items() if one in sets}


def _clear_of(
    simpler: Causes, causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale, times: float
) -> float:
    """``clearness`` beside one simpler set."""
    left, most = times**2 * sets[causes].chi - scale.noise, math.inf
    if times <= 1.0 and leaves_noise(sets[causes], scale.noise):
        left, most = NOISE_ERROR * scale.noise, CERTAIN_ODDS if scale.other_noise else math.inf
    return min(max(sets[simpler].chi - sets[causes].chi, 0.0) / left, most)


def instead(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> dict[str, dict[Causes, float]]:
    """Sets without each cause of a set and with no more causes in all, with the odds of the set beside each.

    For a set S and a set R without the cause they are (χ²(R) − χ²(S)) / (χ²(S) − N), 0 where R leaves less; of as many
    causes, times the odds of S beside R before any data, where these are more than 1. Where a set leaves more than
    noise, none of its laws is the rig's, and what it leaves may move like the difference of the two. A set R counts if
    each of its causes explains at least what S leaves, and if it is not S itself, imitated by another law. A law that
    holds Coulomb friction as a limit counts as Coulomb friction. Empty where a set leaves only noise.
    """
    left = sets[causes].chi - scale.noise
    if leaves_noise(sets[causes], scale.noise):
        return {}
    found: dict[str, dict[Causes, float]] = {name: {} for name in causes}
    others = (one for one in sets if 0 < len(one) <= len(causes) and _explain(one, sets, left))
    for other in (one for one in others if causes not in imitated_by(sets[one])):
        odds = max(sets[other].chi - sets[causes].chi, 0.0) / left
        odds *= math.exp(max(log_prior(causes) - log_prior(other), 0.0)) if len(other) == len(causes) else 1.0
        held = kinds(other) | ({COULOMB} if other & set(HOLDING_COULOMB) else set())
        for name in causes:
            if by_name(name).cause() not in held:
                found[name][other] = odds
    return found


def _explain(causes: Causes, sets: Mapping[Causes, Hypothesis], least: float) -> bool:
    """Whether each cause of a set explains at least so much (χ²) beyond the others, as far as those were fitted."""
    smaller = (causes - {name} for name in causes)
    return all(sets[one].chi - sets[causes].chi >= least for one in smaller if one in sets)


def within_sampling(causes: Causes, sets: Mapping[Causes, Hypothesis]) -> frozenset[str]:
    """Causes of a set that explain no more than twice what the force may do between its samples
    (``residuals.force_between``).
    """
    base = sets.get(frozenset())
    if base is None:
        return frozenset()
    most = base.between / MOST_OF**2
    gains = {name: sets[_fitted(causes - {name}, sets)].chi - sets[causes].chi for name in causes if most > 0.0}
    return frozenset(name for name, gain in gains.items() if gain < most)


def left_over(causes: Causes, sets: Mapping[Causes, Hypothesis], noise: float) -> float:
    """What a set leaves above the noise, as a part of what it explains (rms of the position); 0 if unknown.

    It is √((χ² − N) / (χ²(base) − χ²)), where the noise N may be larger than estimated by ``NOISE_ERROR``.
    """
    base, chi = sets.get(frozenset()), sets[causes].chi
    if base is None or base.chi <= chi:
        return 0.0
    return math.sqrt(max(chi - (1.0 + NOISE_ERROR) * noise, 0.0) / (base.chi - chi))
