"""The diagnosis of records as a user asks for it: preparation, decision about the spring, search, warnings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from msd_ident.data.record import Record
from msd_ident.design import proposing, signs_doubt
from msd_ident.diagnosis import Diagnosis, Task, concluded, diagnose_records, same_plant, search
from msd_ident.errors import UsageError
from msd_ident.estimate import FitResult, explained
from msd_ident.estimate.levels import MOST_OF, TENTH
from msd_ident.estimate.result import scale_known
from msd_ident.residuals import impulses
from msd_ident.selection.certainty import certain
from msd_ident.selection.fitted_sets import Progress
from msd_ident.workflow import unstable_motion
from msd_ident.workflow.options import Options
from msd_ident.workflow.preparation import Prepared, held_otherwise, prepare
from msd_ident.workflow.spring_decision import Decision, has_spring, hidden_spring, needless_spring

#: What the model by which a record is judged may hold, in words.
_WHOLE = "mass, damping, stiffness and all causes of the library"
_PROBABLE = "mass, damping, stiffness and the causes that are likelier than not"
_CERTAIN = "mass, damping, stiffness and the causes that are certain"


def _silent(stage: str, fraction: float, cause: str) -> None:
    """Report to nobody."""


def diagnose(
    records: Sequence[Record],
    options: Options = Options(),  # noqa: B008 - frozen
    progress: Progress = _silent,
    earlier: Diagnosis | None = None,
) -> Diagnosis:
    """What mass, damping and stiffness get wrong about one experiment, and what repairs it.

    Args:
        records: of one plant.
        options: how.
        progress: called with the stage, the fraction done (0 to 1) and the cause being tried.
        earlier: of some of these records: its explanations are tried too, from where they stood.

    Raises:
        DataError, UsageError: as ``identify``.
    """
    if options.known:
        raise UsageError(
            "known parameters in a diagnosis; expected none, because it fits all parameters: use them in msd identify"
        )
    progress("looking at the data", 0.01, "")
    prepared = prepare(records)
    cut = unstable_motion.by_regression(prepared.records)
    if cut is not None:
        diagnosis = _in_stretches(prepared, cut, options, progress)
    if cut is None or unstable_motion.followed(diagnosis.extended, cut):
        diagnosis = _searched(prepared, options, progress, earlier)
        cut = unstable_motion.by_model(diagnosis.extended, diagnosis.records) if diagnosis.adequacy.material else None
        if cut is not None:
            diagnosis = _in_stretches(prepared, cut, options, progress)
    judged, holds = _judged(diagnosis)
    moved, doubts = diagnosis.records, prepared.doubtful_data
    if cut is not None:
        moved, doubts = unstable_motion.beside_their_starts(moved), (*doubts, cut.said)
    explained.check(judged.residuals, moved, holds, doubts, diagnosed=True)
    diagnosis = replace(diagnosis, turned=prepared.turned)
    progress("next experiment", 0.98, "")
    diagnosis = proposing(diagnosis)
    if diagnosis.adequacy.material:
        said = [
            *impulses.sentences(diagnosis.records, diagnosis.extended, diagnosis.noise_floor),
            same_plant.warning(diagnosis.records),
            signs_doubt(diagnosis),
        ]
        diagnosis = replace(diagnosis, warnings=(*diagnosis.warnings, *filter(None, said)))
    progress("done", 1.0, "")
    return diagnosis


def _searched(
    prepared: Prepared,
    options: Options,
    progress: Progress,
    earlier: Diagnosis | None = None,
) -> Diagnosis:
    """The diagnosis of prepared records, with the spring, the hold and the lead of the force that it speaks for.

    Arguments are those of ``diagnose``.
    """
    decision = has_spring(prepared, options)
    found = search(_task(prepared, options, decision), progress, earlier)
    for _ in range(2):  # the hold, and then the lead
        if not prepared.asks_hold or (otherwise := held_otherwise(prepared, found.fitted)) is None:
            break
        prepared = otherwise
        found = search(_task(prepared, options, decision), progress, earlier)
    diagnosis = concluded(_task(prepared, options, decision), found, progress)
    changed = set(diagnosis.extended.model.effect_names) != found.ranking.best.causes  # by copies, or left-out data
    if changed and (otherwise := held_otherwise(prepared, diagnosis.extended)) is not None:
        prepared = otherwise
        diagnosis = diagnose_records(_task(prepared, options, decision), progress, earlier)
    if other := _decided_again(decision, diagnosis):
        now = diagnose_records(_task(prepared, options, other), progress, earlier)
        if other.sprung or _does_without(now, diagnosis):
            diagnosis = now
    elif _hangs(diagnosis.extended):
        told = tuple(said for said in diagnosis.warnings if said not in decision.said)  # what was taken for a spring
        diagnosis = replace(diagnosis, warnings=told)
    return diagnosis


def _in_stretches(prepared: Prepared, cut: unstable_motion.Cut, options: Options, progress: Progress) -> Diagnosis:
    """The diagnosis of the stretches of records along which the motion is unstable.

    Over a short stretch under a controller many models follow the motion: the search begins with the one that showed
    that it is unstable, and a spring is assumed where that one needs it.
    """
    known = cut.weighed
    said = needless_spring(known)
    decision = Decision(not said, (said,) if said else ())
    if options.model != "auto":
        decision = Decision(options.model == "spring")
    task = _task(unstable_motion.cut_into(prepared, cut), options, decision)
    plant = known.model.without(*known.model.effect_names)
    return diagnose_records(replace(task, plant=plant, balanced=True, known=known), progress)


def _judged(diagnosis: Diagnosis) -> tuple[FitResult, str]:
    """The model that must explain most of the motion, and what it may hold: the extended one; the base model where no
    force moves the rig, more than noise is left, and no cause is probable.

    A few tones, drifts and bends together follow any slow motion for a while, also that of a hand. Without a force a
    cause is probable where it is likelier than not; where a force acts and moves nothing, what does is not recorded,
    and no cause is probable but a certain one.
    """
    forced = explained.forced(diagnosis.records)
    most = max((cause.tied_probability for cause in diagnosis.causes), default=1.0)
    probable = certain(most) if forced else most > MOST_OF
    if probable or not diagnosis.adequacy.material or (forced and scale_known(diagnosis.extended.quantities)):
        return diagnosis.extended, _WHOLE
    return diagnosis.base, _CERTAIN if forced else _PROBABLE


def _decided_again(decision: Decision, found: Diagnosis) -> Decision | None:
    """The other decision on the spring, where the diagnosed model speaks against the one that two fits made."""
    if not decision.doubtful:
        return None
    left = found.left if found.adequacy.material else None
    said = needless_spring(found.extended, left) if decision.sprung else hidden_spring(found.extended, found.records)
    return Decision(not decision.sprung, (said,)) if said else None


def _hangs(found: FitResult) -> bool:
    """Whether a law of an angle, such as gravity, does all that a spring could do."""
    stiffness = found.quantities["stiffness"]
    return any(effect.angular for effect in found.model.effects) and not (stiffness.known and stiffness.low > 0.0)


def _does_without(free: Diagnosis, sprung: Diagnosis) -> bool:
    """Whether a model without a spring does what one with a spring does, and has no other law that moves the mass: one
    that stores energy over the place, or a disturbance where the other model explains the motion about as well without.
    With a spring such a law is one explanation among others; without, it would be certain.
    """
    see, sprung_see = free.extended.see, sprung.extended.see
    as_well = sprung_see < see / MOST_OF and sprung.left.extended.motion_percent < 100.0 * TENTH
    others = [one for one in free.extended.model.effects if not sprung.extended.model.has(one.name)]
    stores = any(effect.stores_only() for effect in free.extended.model.effects)
    moved = stores or (as_well and any(effect.tones() for effect in others))
    return not moved and see < sprung_see / MOST_OF


def _task(prepared: Prepared, options: Options, decision: Decision) -> Task:
    """What to diagnose, with or without a spring, and the sentences on why."""
    return Task(
        records=prepared.records,
        sprung=decision.sprung,
        plant=prepared.plant,
        findings=prepared.findings,
        warnings=prepared.warnings + decision.said,
        ring_down=prepared.ring_down,
        tolerance=options.tolerance,
        rest_before=prepared.rest_before,
        calibrate=options.calibrate,
    )
