"""From records to an identification.

``identify`` goes the paper's way (features, standard form, physical parameters, friction raised from 0 to the
least error) and, beside it, refits all parameters jointly by simulation error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data import quality
from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import UsageError
from msd_ident.estimate import FitResult, explained, fit, opposite_signs, see
from msd_ident.estimate.base_fits import joint_fit, linear_fit, structure
from msd_ident.estimate.formulation import Zero
from msd_ident.features import StandardForm, pool
from msd_ident.model import Simulator
from msd_ident.model.base_model import FRICTION_FORCE
from msd_ident.model.joint_words import said_of
from msd_ident.paper.refinement import GRAVITY, paper_refine, record_start
from msd_ident.quantity import Quantity
from msd_ident.residuals import impulses, noise_model
from msd_ident.residuals.noise_spectrum import heard_floor
from msd_ident.workflow import known_parameters
from msd_ident.workflow.identification import Identification, ModelFit
from msd_ident.workflow.law_error import widened
from msd_ident.workflow.options import Options
from msd_ident.workflow.preparation import Prepared, prepare, pushes
from msd_ident.workflow.spring_decision import has_spring
from msd_ident.workflow.starting_plant import plant_of

#: Where the residual is this many noise floors, the model lacks something that deserves a diagnosis.
SUSPICIOUS = 2.0
#: Where it stays off by this part of the motion, though no further than noise, the numbers may be off by a per cent.
STRUCTURE = 1e-3
#: Parts of an oscillation that a residual is averaged over, and what is more than noise leaves of such means.
_PARTS, _BEYOND = 20, 1.5
#: How a doubt about the laws of the model ends.
_LACKS = "the model lacks something; run msd diagnose to name it."
#: More than any cart that a rig's motor pushes [kg].
HEAVIEST = 500.0

#: Relative step of a known parameter that shows what its uncertainty does: a larger one may end in another valley.
KNOWN_STEP = 1e-3

#: Called with what is being done and how much of all is done (0 to 1).
Progress = Callable[[str, float], None]


def _silent(stage: str, fraction: float) -> None:
    """Report to nobody."""


@dataclass(frozen=True)
class _Shifted:
    """A fit with a known parameter a little higher, and its standard deviation in such steps."""

    fit: FitResult
    factor: float


def identify(
    records: Sequence[Record],
    options: Options = Options(),  # noqa: B008 - frozen
    progress: Progress = _silent,
) -> Identification:
    """Standard form, physical parameters and friction of one experiment, which may have several records.

    Args:
        records: records of one rig in one pair of units.
        options: model, loss and known parameters.
        progress: called with the current stage and the fraction done (0 to 1); an exception from it ends the
            work.

    Raises:
        DataError: the data cannot carry any estimate (a constant signal, a cart moved by hand).
        UsageError: no records, or records in different units.
    """
    progress("looking at the data", 0.05)
    prepared = prepare(records)
    records, features, form = prepared.records, prepared.features, prepared.form
    decision = has_spring(prepared, options)
    progress("fitting all parameters", 0.3)
    joint, shifted = _joint(prepared, decision.sprung, options)
    explained.check(joint.residuals, records, "mass, damping, stiffness and dry friction", prepared.doubtful_data)
    heard = _heard(joint, records, options)
    joint = heard or joint
    progress("the linear model", 0.6)
    two_peaks = pool(found.two_peak_form for found in features)
    original = _original(records, two_peaks or form, joint, options)
    progress("raising the friction", 0.8)
    usable = form is not None and len(records) == 1 and math.isfinite(original.see)
    raised = _raised(records, original) if usable else None
    floor = joint.noise_floor
    doubts = _doubts(joint, records, only_noise=heard is not None)
    blamed = _blamed(prepared, joint, decision.sprung, options) if any(_LACKS in one for one in doubts) else ""
    doubts = tuple(blamed if blamed and _LACKS in one else one for one in doubts)
    warnings = prepared.warnings + decision.said + _runaway(original) + doubts
    progress("done", 1.0)
    return Identification(
        records=records,
        findings=prepared.findings,
        features=features,
        standard_form=form,
        two_peak_form=two_peaks,
        original=original,
        paper_refined=raised,
        refined=_with_friction(_wide(joint, options), records, "all parameters together, by simulation error", shifted),
        noise_floor=floor,
        missing_samples=sum(quality.missing_samples(record) for record in prepared.given),
        warnings=warnings,
        open=joint.open_directions + _scale_sentence(records, options),
        known=options.known,
        turned=prepared.turned,
    )


def _heard(joint: FitResult, records: tuple[Record, ...], options: Options) -> FitResult | None:
    """The fit with the noise that its residual shows, as a diagnosis has it; None where it leaves more, and where the
    noise is that of the readings.
    """
    floor = heard_floor(joint.residuals, noise_model.prepare(records)) if options.loss == "linear" else math.nan
    return replace(joint, noise_floor=floor) if math.isfinite(floor) else None


def _forceless(records: tuple[Record, ...]) -> bool:
    """Whether no force sets anything in motion, so that only ratios of m, b, k and Fc are known."""
    return not any(pushes(record) for record in records)


def _scale_sentence(records: tuple[Record, ...], options: Options) -> tuple[str, ...]:
    if not _forceless(records) or any(one.sets_scale for one in options.known):
        return ()
    said = (
        "No force moves the cart in this data, so m, b, k and Fc are known only as ratios; the numbers are for a "
        "moving mass of 1 kg. To determine all of them, push with a known force, or weigh the moving mass and give "
        "--mass."
    )
    return (said_of(said, records[0].position_unit),)


def _joint(prepared: Prepared, sprung: bool, options: Options) -> tuple[FitResult, tuple[_Shifted, ...]]:
    """All parameters by simulation error; a plain axis has an offset in place of a spring's zero.

    Known parameters keep their values. The further fits have one of them a little higher, each.
    """
    records, plant = prepared.records, prepared.plant
    known_parameters.check(options.known, structure(plant, sprung), records[0])
    if not sprung and known_parameters.values(options.known).get("stiffness"):
        raise UsageError(
            "the stiffness is known, and the model has no spring; expected one of the two: leave --known stiffness "
            "or --model no_spring away"
        )
    fixed = {} if sprung else {"stiffness": 0.0}
    if sprung and _forceless(records) and not any(one.sets_scale for one in options.known):
        fixed["mass"] = 1.0
    fixed |= known_parameters.values(options.known)
    zero: Zero = "free" if sprung else "known"
    joint = joint_fit(records, plant, sprung, fixed, options.loss)
    shifted = []
    for one in options.known:
        if one.std > 0.0:
            step = min(one.std, KNOWN_STEP * abs(one.value) or one.std)
            moved = {**fixed, one.name: one.value + step}
            near = fit(
                joint.model, records, fixed=moved, zero=zero, loss=options.loss, search="near", initial=joint.initial
            )
            shifted.append(_Shifted(near, one.std / step))
    return joint, tuple(shifted)


def _original(records: tuple[Record, ...], form: StandardForm | None, joint: FitResult, options: Options) -> ModelFit:
    """The linear model: from the features where there are any, else fitted."""
    if form is None or form.physical is None:
        return _linear_fit(records, joint, options)
    physical = form.physical.quantities
    model = plant_of(form)
    initial = tuple(record_start(record) for record in records)
    predicted = tuple(
        Simulator(model, record).positions(model.values, start.position, start.velocity) + start.zero
        for record, start in zip(records, initial, strict=True)
    )
    error = see([curve - record.position for curve, record in zip(predicted, records, strict=True)])
    return ModelFit(model, physical, error, initial, predicted, "from the response's features, eqs. 11 to 13")


def _linear_fit(records: tuple[Record, ...], joint: FitResult, options: Options) -> ModelFit:
    """Linear model by simulation error, started from the joint refit's values too."""
    what = "mass, damping and stiffness" if "stiffness" in joint.free else "mass and damping"
    method = f"{what} fitted by simulation error, as no response gives features"
    linear = replace(linear_fit(records, joint, options.loss), noise_floor=joint.noise_floor)
    return _with_friction(_wide(linear, options), records, method)


def _raised(records: tuple[Record, ...], original: ModelFit) -> ModelFit:
    """The paper's refinement of the original model, eqs. 2, 14 and 15."""
    record = records[0]
    found = paper_refine(original.model, record, original.initial[0])
    friction = Quantity(found.refined[FRICTION_FORCE], math.nan, record.force_unit)
    parameters = {**original.parameters, FRICTION_FORCE: friction}
    if record.position_unit == "m":
        parameters["friction_coefficient"] = Quantity(found.friction_coefficient, math.nan, "1")
    predicted = (found.residual_refined + record.position,)
    method = "m, b and k kept, friction raised from 0 to the smallest SEE, eqs. 2 and 14"
    return ModelFit(found.refined, parameters, found.see_refined, original.initial, predicted, method)


def _wide(result: FitResult, options: Options) -> FitResult:
    """With intervals that hold the error of the laws; wild samples, which another loss is for, are no such error."""
    return widened(result) if options.loss == "linear" else result


def _with_friction(
    result: FitResult, records: tuple[Record, ...], method: str, shifted: tuple[_Shifted, ...] = ()
) -> ModelFit:
    """A fit as a ``ModelFit``, dry friction stated as µ = Fc/(m g) too.

    ``shifted`` say how the uncertainty of known parameters makes the others uncertain, to first order.
    """
    parameters = _stated(result, records[0])
    moved = [(_stated(one.fit, records[0]), one.factor) for one in shifted]
    for name, own in parameters.items():
        std = math.hypot(own.std, *(factor * (other[name].value - own.value) for other, factor in moved))
        parameters[name] = replace(own, std=std)
    predicted: tuple[FloatArray, ...] = tuple(
        residual + record.position for residual, record in zip(result.residuals, records, strict=True)
    )
    return ModelFit(result.model, parameters, result.see, result.initial, predicted, method)


def _stated(result: FitResult, record: Record) -> dict[str, Quantity]:
    """The parameters of a fit, and the friction coefficient where there is a weight."""
    parameters = dict(result.quantities)
    if FRICTION_FORCE in parameters and record.position_unit == "m":
        parameters["friction_coefficient"] = result.derived(lambda p: p[FRICTION_FORCE] / (p["mass"] * GRAVITY), "1")
    return parameters


def _runaway(original: ModelFit) -> tuple[str, ...]:
    """A sentence where the original model's simulation leaves the range of numbers."""
    if math.isfinite(original.see):
        return ()
    return (
        "The original model has no finite error, because its simulation leaves the range of numbers; the reduction of "
        "the error (eq. 15) and the raised friction are left out.",
    )


def _doubts(joint: FitResult, records: tuple[Record, ...], *, only_noise: bool) -> tuple[str, ...]:
    """Warnings about the joint refit; ``only_noise``: its residual shows that it leaves nothing else (``_heard``)."""
    floor = joint.noise_floor
    said = [] if joint.converged else [f"The joint refit did not converge: {joint.message}"]
    mass = joint.quantities["mass"]
    in_si = all((record.force_unit, record.position_unit) == ("N", "m") for record in records)
    if in_si and mass.known and mass.value > HEAVIEST:
        said.append(
            f"The mass is {mass.value:.4g} kg: is a unit wrong by a factor of 1000? If the force is in mN, use "
            "--force-scale 0.001; if the time is in milliseconds, --time-scale 0.001."
        )
    if math.isfinite(floor) and floor > 0.0 and joint.see > SUSPICIOUS * floor:
        said.append(f"The error of the refined model is {joint.see / floor:.3g} times the noise floor: {_LACKS}")
        said += [*impulses.sentences(records, joint, floor), *filter(None, [opposite_signs.warning(records)])]
    elif not only_noise and (missed := _missed(joint, records)) > STRUCTURE:
        said.append(
            f"The refined model deviates from the readings by {100.0 * missed:.2g} % of the motion, for longer than "
            f"noise does: {_LACKS}"
        )
    return tuple(said)


def _blamed(prepared: Prepared, joint: FitResult, sprung: bool, options: Options) -> str:
    """What to say where the model lacks nothing but the freedom to differ from a known value; empty elsewhere."""
    if not options.known or _forceless(prepared.records):
        return ""
    free = joint_fit(prepared.records, prepared.plant, sprung, {} if sprung else {"stiffness": 0.0}, options.loss)
    if not free.see <= SUSPICIOUS * free.noise_floor:
        return ""
    return known_parameters.contradicted(options.known, free.quantities, joint.see / free.see)


def _missed(joint: FitResult, records: tuple[Record, ...]) -> float:
    """Residual that stays over a twentieth of an oscillation, beyond what noise leaves of its mean, over the motion."""
    mass, stiffness = joint.model["mass"], joint.model["stiffness"]
    if not (mass > 0.0 and stiffness > 0.0):
        return 0.0
    worst = 0.0
    for residual, record in zip(joint.residuals, records, strict=True):
        size = max(int(2.0 * math.pi * math.sqrt(mass / stiffness) / (_PARTS * record.period)), 1)
        count = residual.size // size
        if count < _PARTS:
            continue
        mean = residual[: count * size].reshape(count, size).mean(axis=1)
        noise, rounding = quality.noise_floor(record) / math.sqrt(size), quality.encoder_step(record) / math.sqrt(12.0)
        found = math.sqrt(float(np.mean(mean**2)))
        if found > _BEYOND * max(noise, rounding):
            worst = max(worst, math.sqrt(found**2 - noise**2) / float(np.ptp(record.position)))
    return worst
