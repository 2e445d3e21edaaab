"""The nearest model that a format can express: the format's own laws, refitted on the user's records.

It is not enough to leave out the effects that the format lacks, because all parameters were fitted together with them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from msd_ident.data.record import Record
from msd_ident.estimate import FitResult, fit
from msd_ident.estimate.formulation import Zero
from msd_ident.export.known import kept
from msd_ident.export.roles import role
from msd_ident.export.target import Target
from msd_ident.model import Model, Plant
from msd_ident.model.base_model import DRY_FRICTION, FRICTION_FORCE
from msd_ident.model.effects import by_name, spoken
from msd_ident.workflow.saved_model import SavedModel

#: Stands in where a format has friction of one kind only.
_STAND_IN = DRY_FRICTION
#: A stand-in stays where it makes the error this much smaller.
_WORTH = 0.99


@dataclass(frozen=True)
class Nearest:
    """The model that is written in place of one that the format cannot express.

    Attributes:
        model: with the laws of the format.
        zero: reading at which its spring is relaxed.
        dropped: effects that the format does not carry.
        see: SEE of that model on the record, simulated here, which is what the replay should show. ``None`` without a
            record to fit it on.
        whole: SEE of the whole model.
        unit: of both.
    """

    model: Model
    zero: float
    dropped: tuple[str, ...]
    see: float | None
    whole: float
    unit: str

    @property
    def sentence(self) -> str:
        """What was put in place of what."""
        names = ", ".join(spoken(name) for name in self.dropped)
        if self.see is None:
            return f"without {names}; nothing was fitted in their place, as there was no record: give --replay PATH"
        return (
            f"without {names}; all other parameters are the nearest, fitted on the record. Predicted cost: it leaves "
            f"{self.see:.3g} {self.unit}, where the whole model leaves {self.whole:.3g}"
        )


def nearest(target: Target, saved: SavedModel, zero: float, records: Sequence[Record]) -> Nearest | None:
    """The nearest model that the target can express; ``None`` if it can express the whole model.

    Args:
        target: the format.
        saved: the model.
        zero: reading at which its spring is relaxed.
        records: as the model is simulated on them; if there are none, nothing is refitted.
    """
    model = saved.model
    dropped = tuple(
        effect.name
        for effect in model.effects
        if target.support(effect, model).kind != "exact" and role(type(effect)) not in target.kept
    )
    if not dropped:
        return None
    kept = model.without(*dropped)
    if not records:
        return Nearest(kept, zero, dropped, None, saved.see, saved.position_unit)
    found = min((_fitted(saved, one, records) for one in _structures(target, kept)), key=_cost)
    own = float(sum(initial.zero for initial in found.initial) / len(found.initial))
    return Nearest(found.model, own, dropped, found.see, saved.see, saved.position_unit)


def plain(saved: SavedModel, records: Sequence[Record]) -> FitResult:
    """Fit of mass, damping and stiffness alone.

    Args:
        saved: its linear model gives the starting values, or else the plant of its model.
        records: as the model is simulated on them.
    """
    model = saved.base or Plant(saved.model.mass, saved.model.damping, saved.model.stiffness)
    return _fitted(saved, model, records)


def _structures(target: Target, kept: Model) -> list[Model]:
    """The kept effects, and with dry friction beside them where the format has it."""
    friction = by_name(_STAND_IN)
    found = [kept]
    if target.supports(friction).kind == "exact" and not any(
        effect.family == friction.family for effect in kept.effects
    ):
        found.append(kept + friction.from_values({FRICTION_FORCE: 0.0}))
    return found


def _cost(found: FitResult) -> float:
    """SEE, a little more for a stand-in, which must be worth its place."""
    return found.see if not found.model.has(_STAND_IN) else found.see / _WORTH


def _fitted(saved: SavedModel, model: Model, records: Sequence[Record]) -> FitResult:
    zero: Zero = "free" if model.stiffness > 0.0 else "known"
    starts = [model.with_values({FRICTION_FORCE: 0.02 * _force(records, model)})] if model.has(_STAND_IN) else []
    return fit(model, records, fixed=kept(saved, model), zero=zero, search="near", starts=starts)


def _force(records: Sequence[Record], model: Model) -> float:
    """The largest force at work [N]."""
    from msd_ident.model.effects import typical

    return max(typical.force(record, model) for record in records)
