"""The explanations that a design must distinguish, their probabilities and their names."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.diagnosis import Diagnosis
from msd_ident.estimate.levels import NEGLIGIBLE
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.selection.ranking import DECISIVE


def rivals(diagnosis: Diagnosis) -> tuple[CandidateModel, ...]:
    """The leading explanation and those that the data cannot tell from it; fewer than two when nothing is tied.

    A set that holds all causes of a likelier one, and more, is no rival: simplicity has decided against it.
    """
    standing = diagnosis.contenders
    if not standing:
        return ()
    top = max(one.evidence for one in standing)
    near = [one for one in standing if one is standing[0] or one.evidence >= top - DECISIVE]
    near += [one for one in standing if one not in near and one.probability >= NEGLIGIBLE]
    kept: list[CandidateModel] = []
    for one in near:
        if not any(_holds(one, other) and other.evidence >= one.evidence - DECISIVE for other in kept):
            kept.append(one)
    return tuple(kept)


def _holds(richer: CandidateModel, poorer: CandidateModel) -> bool:
    return set(poorer.causes) < set(richer.causes)


def shares(chosen: Sequence[CandidateModel]) -> list[float]:
    """Probability of each rival among the rivals."""
    total = sum(one.probability for one in chosen)
    return [one.probability / total if total > 0.0 else 1.0 / len(chosen) for one in chosen]


def names(chosen: Sequence[CandidateModel]) -> list[str]:
    """Name of each rival: its causes without those that all rivals have."""
    common = set(chosen[0].causes).intersection(*(one.causes for one in chosen[1:])) if chosen else set()
    return [" + ".join(c for c in one.causes if c not in common) or _rest(one) for one in chosen]


def _rest(one: CandidateModel) -> str:
    return "none of them" if one.causes else "no cause"
