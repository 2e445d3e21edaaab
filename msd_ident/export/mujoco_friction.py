"""Dry friction of the callback file: its reversals and stops are located inside the steps of MuJoCo.

MuJoCo's own constraint decides once a stage, from velocity and acceleration there. It can neither reverse in the middle
of a step nor, if it is to hold at rest without creeping, at the right instant: an explicit step of h is stable only if
the friction reverses 0.36 h or more before the velocity does. The callback finds the instant instead.
"""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.export import laws
from msd_ident.export.mujoco_elements import ACTUATOR
from msd_ident.export.plan import Plan
from msd_ident.export.templates import filled
from msd_ident.model.effects import Effect
from msd_ident.model.effects.law import LAG

_CHANGE = '{tau} * data.act_dot[model.actuator("{name}").actadr[0]] * model.actuator("{name}").gear[0] / inertia'


def text(plan: Plan, called: Sequence[Effect]) -> str:
    """The part of the callback file that computes dry friction.

    Args:
        plan: what is exported.
        called: effects whose laws the callbacks add.
    """
    uses_spring = any(
        "spring_force" in laws.arguments(effect.laws()[kind])
        for effect in called
        for kind in ("friction", "breakaway")
        if kind in effect.laws()
    )
    lag = "".join(laws.number(tau) for tau in plan.model.structure(LAG))
    return filled(
        "callback_friction.py.txt",
        spring="    spring_force = spring(x)\n" if uses_spring else "",
        friction=laws.one(called, "friction", "0.0"),
        breakaway=laws.one(called, "breakaway", "0.0"),
        lagged=", the actuator's lag apart" if lag else "",
        course=f" + change * (1.0 - math.exp(-since / {lag}))" if lag else "",
        change=_CHANGE.format(tau=lag, name=ACTUATOR) if lag else "0.0",
    )
