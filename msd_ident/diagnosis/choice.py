"""The set of causes that a diagnosis names: the one that leads and that predicts left-out data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from msd_ident.selection import gain_laws, naming, replication
from msd_ident.selection.calibration import Calibration
from msd_ident.selection.cross_validation import HeldOut, predict
from msd_ident.selection.evidence import NoiseScale, scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.fitted_sets import Progress
from msd_ident.selection.generalization import with_left_out
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import Ranking


@dataclass(frozen=True)
class Choice:
    """The chosen set, and what decided for it.

    Attributes:
        ranking: the sets by evidence, led by the chosen one unless that is the base model.
        best: the chosen set.
        heldout: its prediction of left-out data.
        matrix: what copies of the record showed; None without copies.
        scale: the noise scale of the ranking.
        alike: other laws of the force's gain that fit as well as the chosen one.
    """

    ranking: Ranking
    best: Hypothesis
    heldout: HeldOut
    matrix: Calibration | None
    scale: NoiseScale
    alike: Sequence[Hypothesis]


def chosen(experiment: Experiment, base: Hypothesis, ranking: Ranking, calibrate: bool, progress: Progress) -> Choice:
    """The leading set that predicts left-out data, with probabilities that copies of the record correct.

    Args:
        experiment: readings with their weights.
        base: the fitted base model.
        ranking: all fitted sets.
        calibrate: whether copies are diagnosed whatever they cost.
        progress: called for each stage, see ``fitted_sets.Progress``.
    """
    progress("prediction of left-out data", 0.88, "")
    ranking = replace(ranking, rich=not replication.is_poor(experiment, base))
    ranking, best, heldout = naming.predicting(experiment, base, ranking)
    matrix = None
    if best.causes:
        ranking, matrix = replication.checked(experiment, base, ranking, calibrate, progress)
        if (ranking := naming.leading(ranking)).best is not best:
            ranking, best, heldout = naming.predicting(experiment, base, replace(ranking, unchecked=True))
    else:
        ranking = replace(ranking, unchecked=True)  # what left-out data do not confirm is not certain
    scale = scale_from(list(ranking.sets), experiment.readings)
    ranking = with_left_out(ranking, best, heldout, scale)
    alike = gain_laws.alike(experiment, best, scale)
    if (law := gain_laws.leading(best, alike, scale)) is not best:
        told = predict(experiment, base, law)
        if told.better:
            alike = [one for one in (best, *alike) if one is not law]
            ranking, best, heldout = ranking.with_law(law), law, told
    return Choice(ranking, best, heldout, matrix, scale, alike)
