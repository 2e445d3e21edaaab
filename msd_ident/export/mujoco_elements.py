"""A model as MuJoCo's elements: what stands at the joint, its actuator, tendons and bodies, and what is left over.

MuJoCo solves m·a = F - damping·v - stiffness·(q - springref) with constraints beside it. Two of its constraints are
made physical here by ``solref`` in its direct form (-k, -b) and a constant impedance d (``solimp``):

- dry friction (``frictionloss``) with d = 0.9999 and b = ``SLIP``/step: at rest it holds and creeps by less than 1e-4
  of what it lets through, and it turns round 1/b before the motion does (the callback file has no such error);
- a limit with d = 0.0001, whose reference acceleration ``-b v - k r`` is then a spring and damper of k = stop
  stiffness over mass beside all other forces, instead of in their place (MuJoCo documentation, Computation: Solver
  parameters).
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass, field

from msd_ident.export.laws import number
from msd_ident.export.plan import Plan
from msd_ident.export.support import Support
from msd_ident.model.effects import Effect
from msd_ident.model.effects.base import AT_ZERO

#: Rate at which friction turns round, in 1/step: the fourth-order Runge-Kutta method is stable up to 2.78.
SLIP = 2.5
#: Impedances of a constraint that replaces the other forces, and of one that adds to them.
STIFF, ADDED = 0.9999, 0.0001
#: A position that no joint reaches.
FAR = 1e6
#: Name of the actuator that pushes, of the callback's sensor, and of the second mass.
ACTUATOR, SENSOR, SECOND = "force", "reading", "second_mass"


@dataclass
class Elements:
    """Attributes and elements, filled effect by effect.

    Attributes:
        joint, actuator: attributes.
        spring: linear, quadratic and cubic stiffness of the joint.
        damper: linear and quadratic damping.
        tendons, bodies, sensors: whole elements.
        offset: constant force [N] against +x that no spring's reference carries.
        called: effects that the callback file adds.
    """

    joint: dict[str, str] = field(default_factory=dict)
    actuator: dict[str, str] = field(default_factory=dict)
    spring: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    damper: list[float] = field(default_factory=lambda: [0.0, 0.0])
    tendons: list[str] = field(default_factory=list)
    bodies: list[str] = field(default_factory=list)
    sensors: list[str] = field(default_factory=list)
    offset: float = 0.0
    called: list[Effect] = field(default_factory=list)


def _coulomb(made: Elements, plan: Plan) -> None:
    _dry(made, plan, plan.value("coulomb_force"))
    made.called.append(plan.model.effect("coulomb_friction"))


def _dry(made: Elements, plan: Plan, force: float) -> None:
    made.joint["frictionloss"] = number(force)
    made.joint["solreffriction"] = f"-1 {number(-SLIP / plan.step)}"
    made.joint["solimpfriction"] = _impedance(STIFF)


def _impedance(size: float) -> str:
    return f"{size} {size} 0.001 0.5 2"


def _cubic(made: Elements, plan: Plan) -> None:
    made.spring[2] = plan.value("cubic_stiffness")


def _asymmetric(made: Elements, plan: Plan) -> None:
    made.spring[1] = plan.value("quadratic_stiffness")


def _drag(made: Elements, plan: Plan) -> None:
    made.damper[1] = plan.value("drag_coefficient")


def _backlash(made: Elements, plan: Plan) -> None:
    gap, stiffness = plan.value("backlash_half_width"), made.spring[0]
    made.spring[0] = 0.0
    made.tendons.append(
        f'<fixed name="spring_with_play" stiffness="{number(stiffness)}" '
        f'springlength="{number(plan.zero - gap)} {number(plan.zero + gap)}">'
        f'<joint joint="{plan.joint}" coef="1"/></fixed>'
    )


def _stop(made: Elements, plan: Plan) -> None:
    reach = plan.value("stop_position")
    _limit(made, plan, (-reach, reach), plan.value("stop_stiffness"))


def _one_stop(made: Elements, plan: Plan) -> None:
    place = plan.value("one_stop_position")
    ends = (-FAR, place) if place > 0.0 else (place, FAR)
    _limit(made, plan, ends, plan.value("one_stop_stiffness"))


def _buffer(made: Elements, plan: Plan) -> None:
    # A limit pushes and never pulls, as a buffer does.
    centre, reach = plan.value("buffer_centre"), plan.value("buffer_reach")
    stiffness, damping = plan.value("buffer_stiffness"), plan.value("buffer_damping")
    _limit(made, plan, (centre - reach, centre + reach), stiffness, damping)


def _limit(made: Elements, plan: Plan, ends: tuple[float, float], stiffness: float, damping: float = 0.0) -> None:
    """Springs and dampers of the joint's range, from the relaxed spring."""
    mass = plan.model.mass
    made.joint["limited"] = "true"
    made.joint["range"] = " ".join(number(plan.zero + end) for end in ends)
    made.joint["solreflimit"] = f"{number(-stiffness / mass)} {number(-damping / mass)}"
    made.joint["solimplimit"] = _impedance(ADDED)


def _offset(made: Elements, plan: Plan) -> None:
    made.offset = plan.value("offset_force")


def _gain(made: Elements, plan: Plan) -> None:
    limit = plan.value("force_limit")
    if plan.value("gain_slope") != 0.0:
        made.called.append(plan.model.effect("force_gain_nonlinearity"))
    elif math.isfinite(limit):
        made.actuator |= {"ctrllimited": "true", "ctrlrange": f"{number(-limit)} {number(limit)}"}


def _lag(made: Elements, plan: Plan) -> None:
    made.actuator |= {"dyntype": "filter", "dynprm": number(plan.value("lag_time"))}


def _delay(made: Elements, plan: Plan) -> None:
    # A line between two commands comes half a step before the step that a held command is.
    delay = plan.value("time_offset") + 0.5 * plan.step
    if delay >= plan.step:
        made.actuator |= {"delay": number(delay), "nsample": str(math.ceil(delay / plan.step) + 2), "interp": "linear"}


def _second(made: Elements, plan: Plan) -> None:
    kind = "hinge" if plan.revolute else "slide"
    mass, stiffness, damping = (plan.value(f"second_{name}") for name in ("mass", "stiffness", "damping"))
    made.bodies.append(
        f'<body name="{SECOND}"><joint name="{SECOND}" type="{kind}" axis="1 0 0" stiffness="{number(stiffness)}" '
        f'damping="{number(damping)}"/>{inertial(mass, plan.revolute)}</body>'
    )


#: Effect → what it becomes, and how that is said.
NATIVE: dict[str, tuple[Callable[[Elements, Plan], None], str]] = {
    "coulomb_friction": (_coulomb, "frictionloss, whose reversals the callback file locates inside the step"),
    "cubic_spring": (_cubic, "third coefficient of stiffness"),
    "asymmetric_spring": (_asymmetric, "second coefficient of stiffness"),
    "quadratic_drag": (_drag, "second coefficient of damping"),
    "backlash": (_backlash, "a tendon whose spring has a dead band (springlength)"),
    "end_stop": (_stop, "range, with solreflimit from the stop's stiffness"),
    "one_sided_stop": (_one_stop, "one end of range, with solreflimit from the stop's stiffness"),
    "buffered_stop": (_buffer, "range, with solreflimit from the buffers' stiffness and damping"),
    "force_offset": (_offset, "springref, or the bias of an actuator"),
    "actuator_lag": (_lag, "dyntype filter of the actuator"),
    "time_offset": (_delay, "delay of the actuator"),
    "second_mode": (_second, "a body that hangs on the first"),
    "force_gain_nonlinearity": (_gain, "ctrlrange where there is only a limit, else the callback file"),
}
#: Kinds of law that the callback file adds.
CALLED = ("constant", "disturbance", "force", "friction", "input_map", "reading")


def supports(effect: type[Effect]) -> Support:
    """How MuJoCo carries an effect: by its own elements, by the callback file, or not at all."""
    if effect.name in NATIVE:
        return Support("exact", NATIVE[effect.name][1])
    driven = any("driven" in inspect.signature(law).parameters for law in effect.laws().values())
    if driven or effect.knee not in (None, AT_ZERO):
        return Support("cannot", "no element for its spring or damper, and the callback file has no events")
    if any(kind in effect.laws() for kind in CALLED):
        return Support("exact", "the callback file beside it")
    return Support("cannot", "neither an element nor a law that a callback could call")


def inertial(mass: float, revolute: bool) -> str:
    """XML element of a body's inertia.

    Args:
        mass: [kg], or for a revolute joint the moment of inertia about its axis [kg·m²].
        revolute: whether the joint turns.
    """
    if revolute:
        return f'<inertial pos="0 0 0" mass="1" diaginertia="{number(mass)} {number(mass)} {number(mass)}"/>'
    return f'<inertial pos="0 0 0" mass="{number(mass)}" diaginertia="1e-3 1e-3 1e-3"/>'


def elements(plan: Plan) -> Elements:
    """The MuJoCo elements of the whole model."""
    made = Elements(spring=[plan.model.stiffness, 0.0, 0.0], damper=[plan.model.damping, 0.0])
    made.actuator["gainprm"] = "1"
    for effect in plan.model.effects:
        if effect.name in NATIVE:
            NATIVE[effect.name][0](made, plan)
        else:
            made.called.append(effect)
    for effect in made.called:
        _make_room(made, plan, effect)
    reference = plan.zero
    if made.offset and made.spring[0] > 0.0 and not any(made.spring[1:]):
        reference -= made.offset / made.spring[0]
        made.offset = 0.0
    made.joint["stiffness"] = " ".join(map(number, made.spring if any(made.spring[1:]) else made.spring[:1]))
    made.joint["damping"] = " ".join(map(number, made.damper if made.damper[1] else made.damper[:1]))
    made.joint["springref"] = number(reference)
    return made


def _make_room(made: Elements, plan: Plan, effect: Effect) -> None:
    """What the callback file needs in the model to act upon."""
    laws = type(effect).laws()
    if "breakaway" in laws:
        _dry(made, plan, plan.value("coulomb_force"))
    if "input_map" in laws and "dynprm" in made.actuator:
        made.actuator |= {"dyntype": "user", "actdim": "1"}
    elif "input_map" in laws:
        made.actuator["gaintype"] = "user"
    if "reading" in laws:
        made.sensors.append(f'<user name="{SENSOR}" objtype="joint" objname="{plan.joint}" dim="1" needstage="pos"/>')
