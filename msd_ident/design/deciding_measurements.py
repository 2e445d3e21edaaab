"""The measurement that distinguishes explanations which no force profile can distinguish."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.model.base_model import Offset
from msd_ident.model.effects import by_name
from msd_ident.model.joint_words import said_of
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.tuning import fixed

#: Below this probability the best profile is not worth playing, and only a measurement or other limits help.
IN_VAIN = fixed(0.005, "interface", "the least probability of a decision that is not shown as 0.00")


def measurement(one: CandidateModel, other: CandidateModel, position_unit: str = "m") -> str:
    """What to measure to distinguish two explanations that no profile distinguishes, in words.

    Args:
        one, other: the explanations; the causes in which they differ say how they are measured
            (``Effect.measured_by``).
        position_unit: of the rig; that of a joint (``rad``) is measured with torques.
    """
    apart = sorted({*one.causes} ^ {*other.causes})
    told = [by_name(name).measured_by for name in apart if by_name(name).measured_by]
    what = told[0] if told else "weigh the cart, and read the force at rest"
    return said_of(Offset.measured_by if Offset.name in apart else what, position_unit)


def between(pairs: Sequence[tuple[str, str, str]]) -> tuple[str, ...]:
    """A sentence for each (name, other, measurement)."""
    return tuple(
        f"No profile within these limits decides between {one} and {other}: {what}." for one, other, what in pairs
    )
