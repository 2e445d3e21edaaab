"""What no data of this kind can tell apart."""

from __future__ import annotations

import pytest

from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.selection.identities import sentences

SPRUNG, PLAIN = Plant(1.0, 2.0, 400.0), Plant(1.0, 2.0, 0.0)
RUBS, LEANS, BENDS = CoulombFriction(0.2), ForceOffset(0.5), CubicSpring(1e5)
ASYMMETRIC, SHIFTED = "force_offset beside coulomb_friction is equivalent to asymmetric", "With a linear spring"


@pytest.mark.parametrize(
    ("model", "begins"),
    [
        (SPRUNG + RUBS, []),
        (SPRUNG + LEANS, [SHIFTED]),
        (SPRUNG + LEANS + BENDS, []),
        (PLAIN + LEANS, []),
        (PLAIN + LEANS + RUBS, [ASYMMETRIC]),
        (SPRUNG + LEANS + RUBS, [ASYMMETRIC, SHIFTED]),
        (SPRUNG + LEANS + RUBS + BENDS, [ASYMMETRIC]),
    ],
    ids=lambda part: "+".join(("sprung" if part.stiffness else "plain", *part.effect_names))
    if isinstance(part, Model) else "",
)  # fmt: skip
def test_an_offset_is_a_zero_or_asymmetric_friction(model: Model, begins: list[str]) -> None:
    said = sentences(model, forced=True, gain_known=True)
    assert len(said) == len(begins)
    assert all(sentence.startswith(begin) for sentence, begin in zip(said, begins, strict=True))


def test_without_a_known_force_only_ratios_are_known() -> None:
    (free,) = sentences(SPRUNG, forced=False, gain_known=False)
    assert free.startswith("No force acts in this data") and "only as ratios" in free
    (gain,) = sentences(SPRUNG, forced=True, gain_known=False)
    assert gain.startswith("The force's gain is unknown") and "share one unknown factor" in gain
    assert sentences(SPRUNG, forced=True, gain_known=True) == ()
