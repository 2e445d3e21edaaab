"""From a saved result to files that another simulation reads, with proof: written, run there, and compared."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from msd_ident.data.record import Record
from msd_ident.errors import SetupError, UsageError
from msd_ident.export import nearest as nearby
from msd_ident.export import posterior
from msd_ident.export.laws import fastest
from msd_ident.export.nearest import Nearest
from msd_ident.export.plan import Plan, check_joint, check_scale, check_units, in_newtons, scaled
from msd_ident.export.proof import Proof, replayed
from msd_ident.export.result import Export
from msd_ident.export.support import Row
from msd_ident.export.target import Target
from msd_ident.model import Model
from msd_ident.workflow.saved_model import SavedModel
from msd_ident.workflow.validation import as_saved

#: Solver steps a step of the record, where dry friction is a constraint and where not, and at most.
DRY_STEPS, STEPS, MOST_STEPS = 4, 1, 64
#: Part of the fastest law's time that a step may take at most.
QUICK = 0.5
#: Distance of the replay from this simulation that is good enough, in noise floors; and what a finer step aims at.
CLOSE, AIM = 0.2, 0.12
#: Whole models, whose motion is right also where forces have no newtons.
WHOLE = "mujoco, mujoco-xml, python, python-msd, fmu or draws"


#: Parameter sets that are drawn where the user says nothing.
DRAWS = 1000


@dataclass(frozen=True)
class Options:
    """What the user decides about an export.

    Attributes:
        joint: name of the joint.
        mass: the moving mass [kg or kg·m²], which gives a result without newtons its force scale.
        draws: parameter sets to draw; ``None`` for ``DRAWS``.
        steps: solver steps for each sample period of the record; ``None`` for as many as the replay needs.
    """

    joint: str = "x"
    mass: float | None = None
    draws: int | None = None
    steps: int | None = None

    def check(self, target: Target) -> None:
        """Refuse what a target does not use.

        Raises:
            UsageError: draws of a target without any, or steps of one that takes none.
        """
        if self.draws is not None and target.name != "draws":
            raise UsageError(f"--draws with --to {target.name}; expected --to draws: leave --draws away")
        if self.steps is not None and not target.stepped:
            raise UsageError(
                f"--steps with --to {target.name}, which has none; expected a MuJoCo target: leave --steps away"
            )


def export(
    saved: SavedModel,
    target: Target,
    out: Path,
    options: Options = Options(),
    records: Sequence[Record] = (),  # noqa: B008
) -> Export:
    """Write a result for a target, and run it there on the records.

    Args:
        saved: the result.
        target: the format.
        out: its main file; what it needs beside it goes into the same folder.
        options: the user's.
        records: for the nearest parameters, the draws and the proof; none for a file without proof.

    Raises:
        UsageError: units or a name that no joint has, options of other targets, a result without newtons for a target
            that needs them, or records in other units.
        DataError: the records cannot carry any estimate.
        SetupError: a library is missing, or the disk does not take the file.
    """
    target.check_name(out)
    options.check(target)
    check_joint(options.joint)
    check_units(saved)
    used = as_saved(saved, records).records if records else ()
    plan, near = _planned(saved, target, options, used)
    return _written_and_proven(Export(target, out, plan, _rows(saved, target), near), options, used)


def _planned(
    saved: SavedModel, target: Target, options: Options, records: Sequence[Record]
) -> tuple[Plan, Nearest | None]:
    zero = sum(saved.zeros) / len(saved.zeros) if saved.zeros else 0.0
    near = nearby.nearest(target, saved, zero, records)
    model, scale = saved.model if near is None else near.model, 1.0
    source = saved
    if options.mass is not None:
        if saved.force_unit in ("N", "N·m") and not saved.scale_assumed:
            raise UsageError(
                "--mass with a result that has newtons already; expected none: identify again with --mass if the mass "
                "is known better"
            )
        model, scale = scaled(replace(saved, model=model), options.mass)
        source = in_newtons(saved)
    elif target.needs_newtons:
        check_scale(saved, target.name, WHOLE)
    rows = tuple(row.sentence for row in _rows(saved, target)) + ((near.sentence,) if near else ())
    period = records[0].period if records else 1.0 / saved.rate if saved.rate > 0.0 else 1e-3
    number = DRAWS if options.draws is None else options.draws
    made = posterior.draw(saved, records, number).scaled(scale) if target.name == "draws" else None
    plan = Plan(
        saved=source, model=model, joint=options.joint, zero=zero if near is None else near.zero,
        period=period, steps=options.steps or _steps(model, period, target), force_scale=scale,
        rows=rows, draws=made,
    )  # fmt: skip
    return plan, near


def _rows(saved: SavedModel, target: Target) -> tuple[Row, ...]:
    return tuple(Row(effect.name, target.support(effect, saved.model)) for effect in saved.model.effects)


def _steps(model: Model, period: float, target: Target) -> int:
    """Steps to begin with: enough for the fastest law, and more where dry friction is solved once a stage."""
    dry = not target.located and any("friction" in effect.laws() for effect in model.effects)
    needed = math.ceil(period * fastest(model) / QUICK)
    return min(max(DRY_STEPS if dry else STEPS, needed), MOST_STEPS)


def _written_and_proven(made: Export, options: Options, records: Sequence[Record]) -> Export:
    """Write, replay, and again with finer steps while the target's steps are seen in the noise."""
    made = made.written()
    why = _not_replayed(made.target, records)
    if why:
        return replace(made, not_replayed=why)
    try:
        proof = replayed(made, records)
        while (finer := _finer(made, proof, options)) > made.plan.steps:
            made = replace(made, plan=replace(made.plan, steps=finer)).written()
            proof = replayed(made, records, proof)
    except SetupError as missing:
        return replace(made, not_replayed=str(missing))
    return replace(made, proof=proof)


def _finer(made: Export, proof: Proof, options: Options) -> int:
    """Solver steps that bring the replay close: what they miss falls at least as they do."""
    if options.steps is not None or not made.target.stepped:
        return made.plan.steps
    floor = made.plan.saved.noise_floor
    worst = max(part.distance for part in proof.parts)
    if not math.isfinite(worst):
        return min(4 * made.plan.steps, MOST_STEPS)
    if not floor > 0.0 or worst <= CLOSE * floor:
        return made.plan.steps
    return min(math.ceil(made.plan.steps * worst / (AIM * floor)), MOST_STEPS)


def _not_replayed(target: Target, records: Sequence[Record]) -> str:
    if target.library is None:
        return target.why_not
    return "" if records else "no record to replay: give --replay PATH"
