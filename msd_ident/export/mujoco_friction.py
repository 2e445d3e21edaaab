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
from msd_ident.model.effects import Effect
from msd_ident.model.effects.base import LAG

_TEXT = '''

PARTS = 8  # of a step near rest


def friction(x, speed):
    """Dry friction [N] while sliding."""
{spring}    return {friction}


def breakaway(x):
    """Largest force [N] that dry friction holds at rest."""
{spring}    return {breakaway}


class DryFriction:
    """Dry friction whose reversals and stops are located inside a step.

    The motion of a step that begins near rest is followed in parts, under all other forces as they are at its
    begin{lagged}. The stages of the Runge-Kutta step get forces that have the impulse of what was found, and move the
    joint as far.
    """

    def __init__(self):
        self.time, self.inside, self.last, self.planned = None, False, False, None

    def at(self, model, data, dof, x):
        """Force [N] of this stage of this step."""
        stages = model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
        if self.begins(data.time, model.opt.timestep, stages):
            self.time, self.inside, self.last = data.time, False, False
            self.plan(model, data, dof, x, stages)
        if self.planned is None:
            return -self.direction * friction(x, abs(data.qvel[dof]))
        return self.planned[self.last]

    def begins(self, t, h, stages):
        """Whether a step begins with this call; otherwise it is a later stage of the step begun before."""
        if not stages or self.time is None or not self.time < t < self.time + 1.5 * h:
            return True
        if t < self.time + 0.75 * h:
            self.inside = True
            return False
        if self.inside and not self.last:
            self.last = True
            return False
        return True

    def plan(self, model, data, dof, x, stages):
        """Forces [N] of the first three stages and of the last one, where the step begins near rest."""
        v, h = data.qvel[dof], model.opt.timestep
        a, change, inertia = others(model, data, dof)
        self.direction, self.planned = sign(v), None
        if abs(v) > 1.1 * h * (abs(a) + abs(change) + max(friction(x, abs(v)), breakaway(x)) / inertia):
            return
        part, impulse, way = h / PARTS, 0.0, 0.0
        for k in range(PARTS):
            since = (k + 0.5) * part
            now = a{course}
            f = within(x, v, now, part, inertia)
            v += part * (now + f)
            impulse += part * f
            way += part * f * (h - since)
        first = 2.0 * way / h**2 if stages else impulse / h
        self.planned = inertia * first, inertia * (6.0 * impulse / h - 5.0 * first)


def within(x, v, a, h, inertia):
    """Friction over the inertia [m/s²] in a time h that begins at v, with a [m/s²] of all other forces."""
    size, hold = friction(x, abs(v)) / inertia, breakaway(x) / inertia
    if abs(a) <= hold and abs(v) <= 0.01 * h * hold:
        return -(v / h + a)  # it stays at rest
    side = sign(v) or sign(a)
    net = a - side * size
    if side * (v + h * net) >= 0.0:
        return -side * size
    if abs(a) <= hold:
        return -(v / h + a)  # it stops
    return side * size * (1.0 + 2.0 * v / (h * net))  # it turns back


def others(model, data, dof):
    """Acceleration [m/s²] by all other forces, how much it still changes by the actuator's lag, and the inertia."""
    mujoco.mj_fwdActuation(model, data)
    force = data.qfrc_actuator + data.qfrc_applied + data.qfrc_passive + data.qfrc_constraint - data.qfrc_bias
    unit = numpy.zeros(model.nv)
    unit[dof] = 1.0
    found = numpy.empty((2, model.nv))
    mujoco.mj_solveM(model, data, found, numpy.stack([force, unit]))
    inertia = 1.0 / found[1, dof]
    return found[0, dof], {change}, inertia


dry = DryFriction()
constraints = []  # of the XML, which this file stands in for
'''

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
    return _TEXT.format(
        spring="    spring_force = spring(x)\n" if uses_spring else "",
        friction=laws.one(called, "friction", "0.0"),
        breakaway=laws.one(called, "breakaway", "0.0"),
        lagged=", the actuator's lag apart" if lag else "",
        course=f" + change * (1.0 - math.exp(-since / {lag}))" if lag else "",
        change=_CHANGE.format(tau=lag, name=ACTUATOR) if lag else "0.0",
    )
