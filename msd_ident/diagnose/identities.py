"""What no data of this kind can tell apart, said in words wherever a named cause is concerned."""

from __future__ import annotations

from msd_ident.model import Model

_DRY = ("coulomb_friction", "stribeck_friction", "position_dependent_friction")
#: Effects that make the spring's force anything but linear: with them a position's zero is seen.
_BENT = ("cubic_spring", "asymmetric_spring", "backlash", "end_stop", "cogging", "position_dependent_friction")


def sentences(model: Model, forced: bool, gain_known: bool) -> tuple[str, ...]:
    """The identities that concern a model's causes."""
    said = []
    dry = [name for name in _DRY if model.has(name)]
    if model.has("force_offset") and dry:
        said.append(
            f"force_offset beside {dry[0]} is the same thing as asymmetric friction (more one way than the other): "
            "no record of force and position tells them apart; turn the rig round and repeat."
        )
    if model.has("direction_dependent_damping"):
        said.append(
            "At speeds of one size, damping that differs between directions is the same thing as a force offset or as "
            "asymmetric friction: move at several speeds to tell them apart."
        )
    if model.has("force_offset") and model.stiffness > 0.0 and not any(model.has(name) for name in _BENT):
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
