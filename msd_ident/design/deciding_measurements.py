"""What no profile can part, and the measurement that would."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.selection.candidate_models import CandidateModel

#: What tells of an effect without any force profile.
_MEASURE = {
    "force_offset": "tilt the rig by a known angle or turn it round, and read the encoder with the spring relaxed",
    "time_offset": "bring one edge to both channels at once, or let one clock stamp force and position",
    "actuator_lag": "read the force with a load cell while the cart is held",
    "force_gain_nonlinearity": "read the force at rest with a load cell or a spring balance, at several commands",
    "backlash": "move the cart by hand within the play and read the encoder",
    "end_stop": "read the encoder with the cart pushed against the stop",
    "coulomb_friction": "pull the cart slowly with a spring balance and read the force at which it moves, and moves on",
    "stribeck_friction": "pull the cart slowly with a spring balance and read the force at which it breaks away",
    "position_dependent_friction": "pull the cart slowly through its travel with a spring balance",
    "hysteresis": "load and unload the spring in small steps and read the force at rest",
    "cubic_spring": "hang known masses on the spring and read the encoder at rest",
    "asymmetric_spring": "hang known masses on the spring, on either side, and read the encoder at rest",
    "cogging": "move the cart through its travel by hand and read the force at rest in steps far below its pitch",
    "second_mode": "add a known mass to the cart and record again",
    "quadratic_drag": "let the cart swing in a shroud, or with another area, and record again",
    "periodic_disturbance": "record at rest, with everything around switched off and on",
    "stiffness_drift": "repeat the first record after an hour of running",
    "sensor_drift": "read the encoder with the cart clamped for as long as an experiment takes",
}
WEIGH = "weigh the cart, or add a known mass and repeat: mass, damping, stiffness and friction share the unknown gain"


def measurement(one: CandidateModel, other: CandidateModel) -> str:
    """What to measure to tell two explanations apart that no profile parts."""
    apart = sorted({*one.causes} ^ {*other.causes})
    told = [_MEASURE[name] for name in apart if name in _MEASURE]
    if "force_offset" in apart or not told:
        return _MEASURE["force_offset"] if "force_offset" in apart else "weigh the cart, and read the force at rest"
    return told[0]


def between(pairs: Sequence[tuple[str, str, str]]) -> tuple[str, ...]:
    """A sentence for each (name, other, measurement)."""
    return tuple(
        f"No profile within these limits decides between {one} and {other}: {what}." for one, other, what in pairs
    )
