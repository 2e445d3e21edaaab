"""Whether the laws of a set hold on data that the fit did not use.

With the rig's own laws, samples that were left out of the fit are missed by little more than those in it. Flexible laws
follow one record to its noise, and miss the next part of it by many times that.
"""

from __future__ import annotations

from msd_ident.estimate.levels import MOST_OF
from msd_ident.estimate.see import see
from msd_ident.selection.cross_validation import HeldOut
from msd_ident.selection.evidence import scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.law_errors import clearness
from msd_ident.selection.ranking import Ranking


def with_left_out(ranking: Ranking, experiment: Experiment, best: Hypothesis, heldout: HeldOut) -> Ranking:
    """The ranking in which the leading set leaves what it leaves on left-out data, where that is most of the error.

    A poor experiment has parts that no other part predicts, whatever the laws: there copies of it decide.

    Args:
        ranking: led by the set.
        experiment: readings with their weights.
        best: the chosen set; the ranking stays as it is if that has no causes.
        heldout: its prediction of left-out data.
    """
    fitted = see(best.residuals())
    if not best.causes or not ranking.rich or not fitted < MOST_OF * heldout.see_extended:
        return ranking
    times = heldout.see_extended / fitted
    sets, scale = {one.causes: one for one in ranking.sets}, scale_from(list(ranking.sets), experiment.readings)
    clear = clearness(best.causes, sets, scale, times)
    return ranking.with_caveats(best.causes, exact=False, clear=clear, missed=times)
