"""Causes between which the data does not decide: what could stand in the place of a named one."""

from __future__ import annotations

from collections.abc import Iterable

from msd_ident.estimate.effort import KEPT
from msd_ident.model.effects import by_name
from msd_ident.selection.certainty import CERTAIN_ODDS, ROUNDING, certain
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, Hypothesis, kinds
from msd_ident.selection.ranking import DECISIVE, Ranking


def tied(ranking: Ranking, name: str) -> tuple[str, ...]:
    """Causes that could replace a cause of the leading set: with its other causes, or in a set of their own.

    Coulomb friction is one where it does nearly what a law does that holds it as a limit: that either acts is surer.
    Where the leading set leaves more than noise, these are also causes of sets beside which ``name`` is not certain
    (``Caveats.instead``). Those in a set of their own count only if ``name`` is not certain. A cause that is left out
    although it is more probable always counts.

    Args:
        ranking: sets by evidence, the leading one first.
        name: a cause of the leading set.
    """
    sure, named = ranking.of_cause(name), ranking.best.causes
    found = list(alternatives(ranking, name))
    found += [other for law, other in ranking.leader_caveats.alike.items() if law == name]
    found += _coulomb_in_place(ranking, name)
    found += [] if certain(sure) else _instead(ranking, name)
    if not found and not certain(sure):
        kind = by_name(name).cause()
        near = [one for one in ranking.within(DECISIVE) if kind not in kinds(one.causes)]
        found += _unnamed(near, named)
    found += [other for other in _unnamed(ranking.sets, named) if ranking.of_cause(other) > sure + ROUNDING]
    return tuple(dict.fromkeys(found))


def in_place(ranking: Ranking, named: Causes) -> dict[Causes, float]:
    """Probability that sets with a rival in the place of a named cause have at least.

    That a cause or one of its rivals acts may be sure although the cause is not (``Ranking.of_any``): what it lacks is
    a rival's. It goes to the likeliest set of the other named causes and one rival, which stays no likelier than the
    cause. All of these sets and the leading one exclude each other.

    Args:
        ranking: sets by evidence, the leading one first.
        named: causes of the leading set.
    """
    found: dict[Causes, float] = {}
    free = 1.0 - ranking.stated(named)
    for name in sorted(named):
        rivals, own, rest = tied(ranking, name), ranking.of_cause(name), named - {name}
        others = [rival for rival in rivals if by_name(rival).cause() != by_name(name).cause()]
        missing = ranking.of_any((name, *rivals)) - own - sum(ranking.of_cause(rival) for rival in others)
        sets = [one.causes for one in ranking.sets if one.causes in [rest | {rival} for rival in rivals]]
        if missing > ROUNDING and sets:
            likeliest = max(sets, key=ranking.of_set)
            before = ranking.stated(likeliest)
            found[likeliest] = max(before, min(before + missing, own, free))
            free -= found[likeliest]
    return found


def _coulomb_in_place(ranking: Ranking, name: str) -> list[str]:
    """Coulomb friction, if it may act in the place of a law of the leading set."""
    either = ranking.of_any((name, COULOMB)) if name in ranking.leader_caveats.rubs else 0.0
    return [COULOMB] if either > ranking.of_cause(name) + ROUNDING and not certain(ranking.of_cause(name)) else []


def _instead(ranking: Ranking, name: str) -> list[str]:
    """Causes of the few nearest sets beside which one of the leading set is not certain (``Caveats.instead``)."""
    others = ranking.leader_caveats.instead.get(name, {})
    near = sorted((odds, sorted(causes)) for causes, odds in others.items() if odds < CERTAIN_ODDS)
    known, rest = kinds(ranking.best.causes), ranking.best.causes - {name}
    known |= {COULOMB} if rest & set(HOLDING_COULOMB) else set()
    found = [by_name(law).cause() for _, causes in near[:KEPT] for law in causes]
    return [cause for cause in dict.fromkeys(found) if cause not in known]


def alternatives(ranking: Ranking, name: str) -> tuple[str, ...]:
    """Causes that could replace one cause of the leading set, by falling evidence of the sets that contain them.

    Args:
        ranking: sets by evidence, the leading one first.
        name: a cause of the leading set.

    Returns:
        Causes of sets within ``DECISIVE`` of the leading one that lack ``name`` in any law but contain all its other
        causes.
    """
    kind, rest = by_name(name).cause(), kinds(ranking.best.causes - {name})
    found: list[str] = []
    for fitted in ranking.within(DECISIVE):
        if kind in kinds(fitted.causes) or not rest <= kinds(fitted.causes):
            continue
        for other in sorted(fitted.causes):
            if by_name(other).cause() not in rest and other not in found:
                found.append(other)
    return tuple(found)


def _unnamed(sets: Iterable[Hypothesis], named: Causes) -> list[str]:
    """Laws of these sets whose cause is not named in another form, sorted."""
    known = kinds(named)
    return sorted({name for one in sets for name in one.causes if by_name(name).cause() not in known})
