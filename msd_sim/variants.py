"""Known families with other laws: what a real rig has where a library has the textbook's form.

An identifier cannot name these laws, but it can name their family, invent nothing beside it, and find mass and
stiffness.
"""

from __future__ import annotations

from msd_sim.parameter import RigEffect, RigParameter
from msd_sim.parameter import number as _p


def _friction(slot: str, default: float, name: str = "coulomb_force", meaning: str = "kinetic Fc") -> RigParameter:
    return _p(name, "N", default, meaning, lower=0.0, slot=slot)


def _peak(of: str) -> tuple[RigParameter, ...]:
    """Kinetic and breakaway force and the scale of speed of a friction peak."""
    return (
        _friction(f"{of}_coulomb", 0.12),
        _friction(f"{of}_static", 0.3, "static_force", "breakaway force Fs, at least Fc"),
        _p("stribeck_velocity", "m/s", 0.02, "velocity scale vs", lower=1e-9, slot=f"{of}_velocity"),
    )


VARIANTS = (
    RigEffect(
        "rational_stribeck",
        "(Fc + (Fs - Fc) / (1 + (v/vs)^2)) sign(v); at rest it holds up to Fs",
        _peak("rational"),
        dry_friction=True,
    ),
    RigEffect(
        "exponential_stribeck",
        "(Fc + (Fs - Fc) exp(-|v|/vs)) sign(v); at rest it holds up to Fs",
        _peak("exponential"),
        dry_friction=True,
    ),
    RigEffect(
        "load_friction",
        "(Fc + mu |k x|) sign(v): the spring's force presses the slide into its guide",
        (
            _friction("load_coulomb", 0.05),
            _p("load_ratio", "", 0.03, "friction per force of the spring", lower=0.0),
        ),
        dry_friction=True,
    ),
    RigEffect(
        "one_sided_stop",
        "ks (x - xs) beyond xs, on this side only",
        (
            _p("one_stop_position", "m", 0.02, "place xs of the stop", lower=1e-9),
            _p("one_stop_stiffness", "N/m", 5e3, "stiffness ks of the stop", lower=0.0),
        ),
    ),
    RigEffect(
        "damped_stop",
        "ks d (1 + c d') at a depth d beyond xs or -xs (Hunt-Crossley)",
        (
            _p("soft_stop_position", "m", 0.02, "distance xs of either stop from zero", lower=1e-9),
            _p("soft_stop_stiffness", "N/m", 5e3, "stiffness ks of the stop", lower=0.0),
            _p("soft_stop_damping", "s/m", 1.0, "c: loss in contact", lower=0.0),
        ),
    ),
    RigEffect(
        "power_drag", "c |v|^1.5 sign(v)", (_p("power_drag", "N (s/m)^1.5", 2.0, "drag coefficient c", lower=0.0),)
    ),
    RigEffect("one_way_damping", "c v while moving up", (_p("up_damping", "N s/m", 1.0, "c", lower=0.0),)),
    RigEffect(
        "drive_brake",
        "c v while a force is commanded: the amplifier brakes",
        (_p("driven_damping", "N s/m", 2.0, "c", lower=0.0),),
    ),
    RigEffect(
        "slow_brake",
        "f while a force is commanded, with T f' + f = c v: the current of the brake lags",
        (
            _p("slow_brake_damping", "N s/m", 2.0, "c", lower=0.0),
            _p("slow_brake_time", "s", 0.02, "T", lower=1e-6),
        ),
    ),
    RigEffect(
        "two_slope_spring",
        "kb (x - xb) beyond xb, beside the spring",
        (
            _p("bend_stiffness", "N/m", 200.0, "kb, either sign"),
            _p("bend_position", "m", 0.005, "xb"),
        ),
    ),
    RigEffect(
        "settling_stiffness",
        "k (1 + r exp(-t/T)) in place of k: warms up and settles",
        (
            _p("settling_ratio", "", 0.03, "r", lower=-0.9),
            _p("settling_time", "s", 2.0, "T", lower=1e-6),
        ),
    ),
    RigEffect(
        "two_tone_disturbance",
        "A1 sin(w1 t) + A2 sin(w2 t)",
        (
            _p("low_tone_amplitude", "N", 0.2, "A1", lower=0.0),
            _p("low_tone_frequency", "rad/s", 40.0, "w1", lower=0.0),
            _p("high_tone_amplitude", "N", 0.2, "A2", lower=0.0),
            _p("high_tone_frequency", "rad/s", 70.0, "w2", lower=0.0),
        ),
    ),
    RigEffect(
        "soft_saturation",
        "the actuator makes Fmax tanh(F / Fmax) of a commanded F",
        (_p("soft_limit", "N", 30.0, "Fmax; 0: none", lower=0.0, slot="-"),),
        place="input",
    ),
    RigEffect(
        "gain_drift",
        "the actuator makes F (1 + g t) of a commanded F, behind its lag",
        (_p("gain_drift_rate", "1/s", 0.005, "g"),),
        place="input",
    ),
    RigEffect(
        "scale_drift",
        "the reading is x (1 + s t)",
        (_p("scale_drift_rate", "1/s", 0.005, "s", slot="-"),),
        place="sensor",
    ),
    RigEffect(
        "sensor_nonlinearity",
        "the reading is x + q x^2 + c x^3",
        (
            _p("sensor_curvature", "1/m", 1.0, "q", slot="-"),
            _p("sensor_cubic", "1/m^2", -50.0, "c", slot="-"),
        ),
        place="sensor",
    ),
    RigEffect(
        "settling_sensor",
        "the reading is x + A (1 - exp(-t/T))",
        (
            _p("sensor_settling", "m", 1e-4, "A", slot="-"),
            _p("sensor_settling_time", "s", 2.0, "T", lower=1e-6, slot="-"),
        ),
        place="sensor",
    ),
    RigEffect(
        "sensor_eccentricity",
        "the reading is x + e sin(2 pi x / p): a wheel out of centre",
        (
            _p("eccentricity", "m", 1e-4, "e", slot="-"),
            _p("wheel_circumference", "m", 0.05, "p", lower=1e-5, slot="-"),
        ),
        place="sensor",
    ),
)
