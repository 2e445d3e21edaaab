"""From records to a result: the functions that command line, nodes and Python share.

``identify`` follows the paper (features, standard form, physical parameters, friction raised from 0 to the least
error) and also refits all parameters together by simulation error. ``diagnose`` finds the causes that the model lacks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data import quality
from msd_ident.data.record import FloatArray, Record
from msd_ident.design import proposing
from msd_ident.diagnosis import Diagnosis, diagnose_records, same_plant
from msd_ident.errors import UsageError
from msd_ident.estimate import FitResult, explained, fit, noise_floor, see
from msd_ident.estimate.base_fits import joint_fit, linear_fit, structure
from msd_ident.estimate.formulation import Zero
from msd_ident.estimate.objective import Loss
from msd_ident.features import StandardForm
from msd_ident.features.form import pool
from msd_ident.model import Model, Plant, Simulator
from msd_ident.model.base_model import FRICTION_FORCE
from msd_ident.paper.refinement import GRAVITY, paper_refine, record_start
from msd_ident.quantity import Quantity
from msd_ident.residuals import impulses
from msd_ident.residuals.ringdown import ring_down
from msd_ident.residuals.unexplained import TOLERANCE
from msd_ident.selection.structure_search import Progress as DiagnosisProgress
from msd_ident.workflow import known_parameters as knowledge
from msd_ident.workflow import spring_decision
from msd_ident.workflow.identification import Identification, ModelFit
from msd_ident.workflow.known_parameters import Known
from msd_ident.workflow.preparation import prepared, typical_plant

MODELS = ("auto", "spring", "no_spring")
LOSSES = ("linear", "soft_l1")
#: Where the residual is this many noise floors, the model lacks something that deserves a diagnosis.
SUSPICIOUS = 2.0
#: Where it stays off by this part of the motion, though no further than noise, the numbers may be off by a per cent.
STRUCTURE = 1e-3
#: Parts of an oscillation that a residual is averaged over, and what is more than noise leaves of such means.
_PARTS, _BEYOND = 20, 1.5
#: More than any cart that a rig's motor pushes [kg].
HEAVIEST = 500.0

#: Relative step of a known parameter that shows what its uncertainty does: a larger one may end in another valley.
KNOWN_STEP = 1e-3

#: Called with what is being done and how much of all is done (0 to 1).
Progress = Callable[[str, float], None]


def _silent(stage: str, fraction: float) -> None:
    """Report to nobody."""


@dataclass(frozen=True)
class Options:
    """What the user may decide about an identification.

    Attributes:
        model: ``spring`` or ``no_spring`` (a plain axis); ``auto`` lets the data say.
        loss: ``linear``, or ``soft_l1`` where single samples are wild.
        known: parameters known beforehand, which the fit keeps; their uncertainty goes into all intervals.
        tolerance: part of the motion's rms [%] that a diagnosis may leave unexplained and still be called complete.
        calibrate: correct a diagnosis by simulated copies of the records, whatever it costs; else where it is cheap.

    Raises:
        UsageError: another word, or a tolerance that is no part.
    """

    model: str = "auto"
    loss: Loss = "linear"
    known: tuple[Known, ...] = ()
    tolerance: float = TOLERANCE
    calibrate: bool = False

    def __post_init__(self) -> None:
        for what, found, known in (("model", self.model, MODELS), ("loss", self.loss, LOSSES)):
            if found not in known:
                raise UsageError(f"{what} is {found!r}; expected one of {', '.join(known)}")
        if not 0.0 <= self.tolerance < 100.0:
            raise UsageError(f"tolerance is {self.tolerance} % of the motion; expected 0 to less than 100")


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
    data = prepared(records)
    used, features, form = data.used, data.features, data.form
    sprung, decided = _sprung(used, options, form)
    progress("fitting all parameters", 0.3)
    joint, shifted = _joint(used, sprung, form, options)
    explained.check(joint.residuals, used, "mass, damping, stiffness and dry friction")
    progress("the linear model", 0.6)
    two_peaks = pool([found.two_peak_form for found in features if found.two_peak_form is not None])
    original = _original(used, two_peaks or form, joint, options)
    progress("raising the friction", 0.8)
    raised = _raised(used, original) if form is not None and len(used) == 1 else None
    floor = noise_floor(used)
    warnings = data.warnings + decided + _doubts(joint, used, floor)
    progress("done", 1.0)
    return Identification(
        records=used,
        findings=data.findings,
        features=features,
        standard_form=form,
        two_peak_form=two_peaks,
        original=original,
        paper_refined=raised,
        refined=_with_friction(joint, used, "all parameters together, by simulation error", shifted),
        noise_floor=floor,
        missing_samples=sum(quality.missing_samples(record) for record in data.given),
        warnings=warnings,
        open=joint.open_directions + _scale_sentence(used, options),
        known=options.known,
        turned=data.turned,
    )


def _silent_diagnosis(stage: str, fraction: float, cause: str) -> None:
    """Report to nobody."""


def diagnose(
    records: Sequence[Record],
    options: Options = Options(),  # noqa: B008 - frozen
    progress: DiagnosisProgress = _silent_diagnosis,
    earlier: Diagnosis | None = None,
) -> Diagnosis:
    """What mass, damping and stiffness get wrong about one experiment, and what repairs it.

    Args:
        records: of one plant.
        options: how.
        progress: told how far it is.
        earlier: of some of these records: its explanations are tried too, from where they stood.

    Raises:
        DataError, UsageError: as ``identify``.
    """
    if options.known:
        raise UsageError(
            "known parameters in a diagnosis; expected none, because it fits all parameters: use them in msd identify"
        )
    progress("looking at the data", 0.01, "")
    data = prepared(records)
    sprung, decided = _sprung(data.used, options, data.form)
    made = diagnose_records(
        data.used,
        sprung=sprung,
        plant=_plant(data.used, data.form),
        findings=data.findings,
        warnings=data.warnings + decided,
        ring_down=ring_down(data.features, data.used[0].position_unit),
        tolerance=options.tolerance,
        rests=data.rest_before,
        calibrate=options.calibrate,
        progress=progress,
        earlier=earlier,
    )
    explained.check(made.extended.residuals, made.records, "mass, damping, stiffness and all causes of the library")
    progress("next experiment", 0.98, "")
    found = proposing(replace(made, turned=data.turned))
    if found.adequacy.material:
        said = [
            *impulses.sentences(found.records, found.extended, found.noise_floor),
            same_plant.warning(found.records),
        ]
        found = replace(found, warnings=(*found.warnings, *filter(None, said)))
    progress("done", 1.0, "")
    return found


def _forceless(records: tuple[Record, ...]) -> bool:
    """Whether no force sets anything in motion, so that only ratios of m, b, k and Fc are known."""
    return not any(_pushes(record) for record in records)


def _pushes(record: Record) -> bool:
    """Whether the force changes. One that has acted unchanged since before the record is part of the unknown zero."""
    before = record.force_at([np.nextafter(record.time[0], -np.inf)])
    return bool(np.ptp(np.concatenate((before, record.force_at(record.time)))))


def _scale_sentence(records: tuple[Record, ...], options: Options) -> tuple[str, ...]:
    if not _forceless(records) or any(one.sets_scale for one in options.known):
        return ()
    return (
        "No force moves the cart in this data, so m, b, k and Fc are known only as ratios; the numbers are for a "
        "moving "
        "mass of 1 kg. To determine all of them, push with a known force, or weigh the moving mass and give --mass.",
    )


def _sprung(records: tuple[Record, ...], options: Options, form: StandardForm | None) -> tuple[bool, tuple[str, ...]]:
    """Whether the plant has a spring: as told, as the response shows, or as two fits decide; then with a sentence."""
    if options.model != "auto":
        return options.model == "spring", ()
    if (told := knowledge.values(options.known).get("stiffness")) is not None:
        return told > 0.0, ()
    if form is not None:
        return True, ()
    sprung, said = spring_decision.decide(records, options.loss)
    return sprung, (said,)


def _joint(
    records: tuple[Record, ...], sprung: bool, form: StandardForm | None, options: Options
) -> tuple[FitResult, tuple[_Shifted, ...]]:
    """All parameters by simulation error; a plain axis has an offset in place of a spring's zero.

    Known parameters keep their values. The further fits have one of them a little higher, each.
    """
    plant = _plant(records, form)
    knowledge.check(options.known, structure(plant, sprung), records[0])
    fixed = {} if sprung else {"stiffness": 0.0}
    if sprung and _forceless(records) and not any(one.sets_scale for one in options.known):
        fixed["mass"] = 1.0
    fixed |= knowledge.values(options.known)
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


def _plant(records: tuple[Record, ...], form: StandardForm | None) -> Model:
    """The plant that fits start from."""
    return typical_plant(records[0]) if form is None else _seen(form)


def _seen(form: StandardForm) -> Model:
    """The plant that the features show, of 1 kg where there is no static gain."""
    if form.physical is not None:
        return Plant(**{name: quantity.value for name, quantity in form.physical.quantities.items()})
    frequency, ratio = form.natural_frequency.value, form.damping_ratio.value
    return Plant(mass=1.0, damping=2.0 * ratio * frequency, stiffness=frequency**2)


def _original(records: tuple[Record, ...], form: StandardForm | None, joint: FitResult, options: Options) -> ModelFit:
    """The linear model: from the features where there are any, else fitted."""
    if form is None or form.physical is None:
        return _linear_fit(records, joint, options)
    physical = form.physical.quantities
    model = _seen(form)
    initial = tuple(record_start(record) for record in records)
    predicted = tuple(
        Simulator(model, record).positions(model.values, start.position, start.velocity) + start.zero
        for record, start in zip(records, initial, strict=True)
    )
    error = see([curve - record.position for curve, record in zip(predicted, records, strict=True)])
    return ModelFit(model, physical, error, initial, predicted, "from the response's features, eqs. 11 to 13")


def _linear_fit(records: tuple[Record, ...], joint: FitResult, options: Options) -> ModelFit:
    """Linear model by simulation error, from the joint refit's values: a careless start ends in a false valley."""
    what = "mass, damping and stiffness" if "stiffness" in joint.free else "mass and damping"
    method = f"{what} fitted by simulation error, as no response gives features"
    return _with_friction(linear_fit(records, joint, options.loss), records, method)


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


def _doubts(joint: FitResult, records: tuple[Record, ...], floor: float) -> tuple[str, ...]:
    """Warnings about the joint refit."""
    said = [] if joint.converged else [f"The joint refit did not converge: {joint.message}"]
    mass = joint.quantities["mass"]
    in_si = all((record.force_unit, record.position_unit) == ("N", "m") for record in records)
    if in_si and mass.known and mass.value > HEAVIEST:
        said.append(
            f"The mass is {mass.value:.4g} kg: is a unit wrong by a factor of 1000? If the force is in mN, use "
            "--force-scale 0.001; if the time is in milliseconds, --time-scale 0.001."
        )
    if math.isfinite(floor) and floor > 0.0 and joint.see > SUSPICIOUS * floor:
        said.append(
            f"The error of the refined model is {joint.see / floor:.3g} times the noise floor: the model lacks "
            "something; run msd diagnose to name it."
        )
        said += impulses.sentences(records, joint, floor)
    elif (missed := _missed(joint, records)) > STRUCTURE:
        said.append(
            f"The refined model deviates from the readings by {100.0 * missed:.2g} % of the motion, for longer than "
            "noise "
            "does: the model lacks something; run msd diagnose to name it."
        )
    return tuple(said)


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
