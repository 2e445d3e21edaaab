"""Whether the laws of a set hold on data that the fit did not use.

With the rig's own laws, samples that were left out of the fit are missed by little more than those in it. Flexible laws
follow one record to its noise, and miss the next part of it by many times that.
"""

from __future__ import annotations

from msd_ident.estimate.levels import MOST_OF
from msd_ident.estimate.see import see
from msd_ident.selection.cross_validation import HeldOut
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.law_errors import clearness
from msd_ident.selection.ranking import Ranking


def with_left_out(ranking: Ranking, best: Hypothesis, heldout: HeldOut, scale: NoiseScale) -> Ranking:
    """The ranking in which the leading set leaves what it leaves on left-out data, where that is most of the error.

    A poor experiment has parts that no other part predicts, whatever the laws: there copies of it decide.

    Args:
        ranking: led by the set.
        best: the chosen set; the ranking stays as it is if that has no causes.
        heldout: its prediction of left-out data.
        scale: gives the noise.
    """
    fitted = see(best.residuals())
    if not best.causes or not ranking.rich or not fitted < MOST_OF * heldout.see_extended:
        return ranking
    times = heldout.see_extended / fitted
    clear = clearness(best.causes, {one.causes: one for one in ranking.sets}, scale, times)
    return ranking.with_caveats(best.causes, exact=False, clear=clear, rubs={}, missed=times)
