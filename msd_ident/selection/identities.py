"""Sentences on causes that no data of this kind can tell apart."""

from __future__ import annotations

from msd_ident.model import Model

#: Effects on the spring through which a position's zero is seen, beside those whose force depends on the place.
_ON_SPRING = ("backlash", "load_dependent_friction")


def sentences(model: Model, forced: bool, gain_known: bool) -> tuple[str, ...]:
    """The identities that concern a model's causes."""
    said = []
    dry = [effect.name for effect in model.effects if effect.family == "dry friction"]
    bent = any(effect.placed() or effect.name in _ON_SPRING for effect in model.effects)
    if model.has("force_offset") and dry:
        said.append(
            f"force_offset beside {dry[0]} is equivalent to asymmetric friction (more one way than the other): "
            "no record of force and position tells them apart; turn the rig round and repeat."
        )
    if model.has("direction_dependent_damping"):
        said.append(
            "At speeds of one size, damping that differs between directions is equivalent to a force offset or as "
            "asymmetric friction: move at several speeds to tell them apart."
        )
    if model.has("force_offset") and model.stiffness > 0.0 and not bent:
        said.append(
            "With a linear spring a force offset is the same as a position zero shifted by F0/k: read the encoder with "
            "the spring relaxed to tell them apart."
        )
    if model.has("hysteresis"):
        said.append(
            "Hysteresis with a short length turns into Coulomb friction: the two differ only in small reversals."
        )
    if model.has("time_offset"):
        said.append(
            "A delay of the force, of the encoder's stamps or between two clocks is one and the same time_offset."
        )
    if not forced:
        said.append("No force acts in this data, so mass, damping, stiffness and friction are known only as ratios.")
    elif not gain_known:
        said.append("The force's gain is unknown, so mass, damping, stiffness and friction share one unknown factor.")
    return tuple(said)
