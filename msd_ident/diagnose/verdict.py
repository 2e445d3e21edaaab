"""The verdict, and its words: what is missing, how sure, what it costs, what was gained, what is still open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from msd_ident.diagnose.adequacy import Adequacy
from msd_ident.diagnose.diagnosis import Cause, Verdict
from msd_ident.diagnose.heldout import HeldOut


def decide(causes: Sequence[Cause], base: Adequacy, extended: Adequacy) -> Verdict:
    """Adequate, explained, ambiguous or unexplained.

    A model is left ``unexplained`` when what it leaves is at least as large again as the noise: then no name of the
    library repairs it, whatever helped.
    """
    if extended.material:
        return "unexplained"
    if not causes:
        return "adequate"
    return "ambiguous" if any(cause.tied_with for cause in causes) else "explained"


def summary(
    verdict: Verdict, causes: Sequence[Cause], adequacy: tuple[Adequacy, Adequacy], heldout: HeldOut, depends: str
) -> str:
    """The verdict in words; ``adequacy`` of base and extended model."""
    base, extended = adequacy
    if verdict == "adequate":
        return (
            f"Mass, damping and stiffness are enough: what they leave is {base.ratio:.2f} times the noise, "
            "and nothing in the library is called for."
        )
    named = _listed(causes)
    gain = (
        f"left-out data is predicted {heldout.reduction_percent:.3g} % better "
        f"({heldout.interval_percent[0]:.3g} to {heldout.interval_percent[1]:.3g} %)"
    )
    if verdict == "unexplained":
        helped = f"{named} helped ({gain}), but " if causes else ""
        return (
            f"Something is missing that no cause of the library repairs: {helped}{extended.ratio:.3g} noise floors "
            f"remain (base model: {base.ratio:.3g}). {depends}"
        )
    them = "it" if len(causes) == 1 else "them"
    left = f"Without {them} the model is wrong by {base.ratio:.3g} noise floors, with {them} by {extended.ratio:.2f}"
    opened = f"{left}; {gain}."
    if verdict == "ambiguous":
        ties = "; ".join(f"{c.name} from {' or '.join(c.tied_with)}" for c in causes if c.tied_with)
        return f"The model lacks {named}, but this data cannot tell {ties}. {opened}"
    return f"The model lacks {named}. {opened}"


def _listed(causes: Sequence[Cause]) -> str:
    words = [f"{cause.name} (probability {min(cause.probability, 0.999):.3g})" for cause in causes]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1] if words else ""


def spread_sentence(spread: Mapping[str, tuple[float, float]]) -> tuple[str, ...]:
    """How far the numbers move between tied explanations."""
    if not spread:
        return ()
    moved = ", ".join(f"{name} {low:.4g} to {high:.4g}" for name, (low, high) in spread.items())
    return (f"Between the tied explanations the parameters move, beyond their intervals: {moved}.",)
