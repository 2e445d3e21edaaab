"""Assessment of every cause of the library: probability, residual, and the reason why the extended model includes it or
not.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

from msd_ident.estimate.levels import TENTH
from msd_ident.model.effects import LIBRARY, by_name, spoken
from msd_ident.selection import ties
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Causes, kinds
from msd_ident.selection.ranking import Ranking

#: A set of causes -> what it leaves, in noise floors.
Left = Mapping[Causes, float]


@dataclass(frozen=True)
class CauseAssessment:
    """One cause of the library.

    Attributes:
        name: of the cause.
        held: whether the extended model holds it.
        probability: that it acts, given the data and the library; of another law of a named cause, that the cause has
            this law.
        alone: what it leaves when it is the only one beside the base model, in noise floors; NaN when not fitted.
        reason: why it is in the extended model or not, a sentence.
    """

    name: str
    held: bool
    probability: float
    alone: float
    reason: str

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "name": self.name,
            "held": self.held,
            "probability": self.probability,
            "noise_floors_alone": self.alone,
            "reason": self.reason,
        }


def noted(ranking: Ranking, experiment: Experiment, *before: tuple[Ranking, Experiment]) -> Ranking:
    """The ranking with the residual that every fitted set leaves, in noise floors (``Ranking.left``).

    Args:
        ranking: sets that were fitted to ``experiment``.
        experiment: the records.
        before: earlier rankings, each with the part of the data that it was made on. A set that occurs again keeps the
            value of the later ranking.
    """
    left: dict[Causes, float] = {}
    for found, data in (*before, (ranking, experiment)):
        left |= {fitted.causes: math.sqrt(fitted.chi / data.evidence) for fitted in found.sets}
    return replace(ranking, left=left)


def assess(
    library: Collection[str], ranking: Ranking, named: Causes, tied: Collection[str]
) -> tuple[CauseAssessment, ...]:
    """All causes, those of the extended model first, then the likeliest.

    Args:
        library: those that can act in this experiment.
        ranking: of the sets that came into question, with what all that were fitted leave.
        named: what the extended model holds.
        tied: causes that could replace one of those.
    """
    found = [_look(effect.name, effect.name in library, ranking, named, effect.name in tied) for effect in LIBRARY]
    least = {name: p for causes, p in ties.in_place(ranking, named).items() for name in causes & set(tied)}
    found = [replace(one, probability=max(one.probability, least.get(one.name, 0.0))) for one in found]
    return tuple(sorted(found, key=lambda one: (not one.held, -one.probability, one.alone)))


def _look(name: str, possible: bool, ranking: Ranking, named: Causes, tied: bool) -> CauseAssessment:
    alone, stated = ranking.left.get(frozenset({name}), math.nan), ranking.of_cause(name)
    if name not in named and by_name(name).cause() in kinds(named):
        stated = min(stated, ranking.of_law(name))
    if name in named:
        without = ranking.left.get(named - {name}, math.nan)
        remain = f"without it {without:.3g} noise floors remain."
        reason = remain if math.isfinite(without) else "the data requires it."
    elif tied:
        reason = "could replace a named cause: this data cannot tell them apart."
    elif not possible:
        reason = _impossible(name)
    else:
        reason = _not_needed(name, alone, ranking.left, named)
    return CauseAssessment(name, name in named, stated, alone, reason)


def _impossible(name: str) -> str:
    effect = by_name(name)
    if effect.angular:
        return "cannot act here: it is a law of a joint, and the position is no angle."
    if effect.needs_spring or effect.acts_on == "input":
        return (
            "cannot act here, or not be seen: it needs a spring, or a force with several levels, and the record has "
            "none."
        )
    return "cannot be seen here: the quantity that it depends on does not change in this record."


def _not_needed(name: str, alone: float, left: Left, named: Causes) -> str:
    """Why a cause that can act is not named: what is left with it [noise floors], alone and beside the named ones."""
    nothing = left[frozenset()]
    with_it = [floors for causes, floors in left.items() if name in causes]
    if not with_it:
        if len(left) == 1:
            return "not fitted: the base model leaves only noise."
        if by_name(name).form_of:
            return (
                f"another law of {spoken(by_name(name).form_of)}, which is fitted only if that one explains something."
            )
        if taken_for := by_name(name).mistaken_for:
            alike = ", ".join(map(spoken, taken_for))
            return f"may be mistaken for {alike}; it is fitted only if one of these explains something."
        best = min(left.values())
        return (
            f"not fitted completely: its first fits are far from the {best:.3g} noise floors that the best of all "
            "fitted sets leaves."
        )
    if math.isfinite(alone) and alone > (1.0 - TENTH) * nothing:
        said = f"alone it explains nothing: {alone:.3g} of {nothing:.3g} noise floors remain."
    else:
        said = f"alone it leaves {alone:.3g} noise floors." if math.isfinite(alone) else "not fitted alone."
    beside = left.get(named | {name}, math.nan)
    if named and math.isfinite(beside):
        said = f"{said[:-1]}; with the named causes {beside:.3g}, too little to justify its parameters."
    elif named and math.isfinite(left.get(named, math.nan)):
        more = ", more, but not by enough to justify its parameters" if alone < left[named] else ""
        said = f"{said[:-1]}; the named causes leave {left[named]:.3g}{more}."
    return said
