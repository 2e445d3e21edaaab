"""The first two hypotheses of a diagnosis, base model and Coulomb friction, from the fits of ``identify``."""

from __future__ import annotations

from msd_ident.estimate import fit
from msd_ident.estimate.base_fits import Shared, joint_fit, linear_fit
from msd_ident.estimate.effort import SAMPLES
from msd_ident.model import Model
from msd_ident.model.base_model import OFFSET
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import COULOMB, NOTHING, Hypothesis
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.starting_values import plain_axes


def shared_fits(experiment: Experiment, plant: Model) -> Shared:
    """The fits that an identification of the same records makes: dry friction beside the plant, and the plant alone.

    Args:
        experiment: the data, with what its base model has fixed.
        plant: mass [kg], damping [N·s/m] and stiffness [N/m] to start from.
    """
    fixed = {name: experiment.base[name] for name in experiment.fixed}
    joint = joint_fit(experiment.records, plant, _sprung(experiment), fixed)
    return Shared(joint, linear_fit(experiment.records, joint))


def base_fit(experiment: Experiment, shared: Shared) -> tuple[Hypothesis, Hypothesis]:
    """The base model and the one with Coulomb friction, each fitted from several starts.

    Both start where an identification of the same records ends. The base model also starts from the fit with friction
    without its friction.

    Args:
        experiment: readings with their weights, and what is fixed in the base model.
        shared: the fits of an identification of the same records.

    Returns:
        The base model with the least chi², and the model with Coulomb friction.
    """
    fixed = tuple(experiment.fixed)
    rubbing, sprung = shared.joint, _sprung(experiment)
    if not sprung:
        rubbing = fit(rubbing.model.without(OFFSET), experiment.records, fixed=fixed, search="near")
    bare = rubbing.model.without(COULOMB)
    starts = [(shared.linear.model, shared.linear.initial), (bare, rubbing.initial)]
    if not sprung:
        starts += plain_axes(experiment.thinned(SAMPLES).records)
    bases = [refine(experiment, NOTHING, model, initial) for model, initial in starts]
    friction = refine(experiment, frozenset({COULOMB}), rubbing.model, rubbing.initial)
    return min(bases, key=lambda one: one.chi), friction


def _sprung(experiment: Experiment) -> bool:
    return "stiffness" not in experiment.fixed
