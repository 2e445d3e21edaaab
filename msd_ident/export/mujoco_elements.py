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

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from msd_ident.export import quoting, roles
from msd_ident.export.laws import number
from msd_ident.export.plan import Plan
from msd_ident.export.support import Support
from msd_ident.model.base_model import FRICTION_FORCE
from msd_ident.model.effects import Effect
from msd_ident.model.effects.law import AT_ZERO, DELAY, LAG, PLAY, SECOND_MASS, VELOCITY_LAG

#: Rate at which friction turns round, in 1/step: the fourth-order Runge-Kutta method is stable up to 2.78.
SLIP = 2.5
#: Impedances of a constraint that replaces the other forces, and of one that adds to them.
STIFF, ADDED = 0.9999, 0.0001
#: A position that no joint reaches.
FAR = 1e6
#: Name of the actuator that pushes, of the callback's sensor, and of the second mass.
ACTUATOR, SENSOR, SECOND = "force", "reading", SECOND_MASS.replace(" ", "_")


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


def _friction(made: Elements, plan: Plan, effect: Effect) -> None:
    _dry(made, plan)
    made.called.append(effect)


def _dry(made: Elements, plan: Plan) -> None:
    made.joint["frictionloss"] = number(plan.value(FRICTION_FORCE))
    made.joint["solreffriction"] = f"-1 {number(-SLIP / plan.step)}"
    made.joint["solimpfriction"] = _impedance(STIFF)


def _impedance(size: float) -> str:
    return f"{size} {size} 0.001 0.5 2"


def _cube(made: Elements, plan: Plan, effect: Effect) -> None:
    made.spring[2] = effect.values[0]


def _square(made: Elements, plan: Plan, effect: Effect) -> None:
    made.spring[1] = effect.values[0]


def _drag(made: Elements, plan: Plan, effect: Effect) -> None:
    made.damper[1] = effect.values[0]


def _play(made: Elements, plan: Plan, effect: Effect) -> None:
    gap, stiffness = effect.values[0], made.spring[0]
    made.spring[0] = 0.0
    made.tendons.append(
        f'<fixed name="spring_with_play" stiffness="{number(stiffness)}" '
        f'springlength="{number(plan.zero - gap)} {number(plan.zero + gap)}">'
        f'<joint joint="{quoting.in_xml(plan.joint)}" coef="1"/></fixed>'
    )


def _stops(made: Elements, plan: Plan, effect: Effect) -> None:
    reach, stiffness, _ = _knee(effect)
    _limit(made, plan, (-reach, reach), stiffness)


def _one_stop(made: Elements, plan: Plan, effect: Effect) -> None:
    place, stiffness, _ = _knee(effect)
    _limit(made, plan, (-FAR, place) if place > 0.0 else (place, FAR), stiffness)


def _buffers(made: Elements, plan: Plan, effect: Effect) -> None:
    # A limit pushes and never pulls, as a buffer does; its impedance is the part of all other forces that it takes.
    centre, stiffness, reach = _knee(effect)
    damping, *share = (getattr(effect, one.name) for one in effect.parameters if one.name not in (effect.knee or ()))
    _limit(made, plan, (centre - reach, centre + reach), stiffness, damping)
    made.joint["solimplimit"] = _impedance(max([ADDED, *share]))


def _knee(effect: Effect) -> tuple[float, float, float]:
    """Place [m] and stiffness [N/m] of a stop, and its reach [m] where it has one."""
    place, stiffness, side = effect.knee or AT_ZERO
    return getattr(effect, place), getattr(effect, stiffness), getattr(effect, side, 0.0)


def _limit(made: Elements, plan: Plan, ends: tuple[float, float], stiffness: float, damping: float = 0.0) -> None:
    """Springs and dampers of the joint's range, from the relaxed spring."""
    mass = plan.model.mass
    made.joint["limited"] = "true"
    made.joint["range"] = " ".join(number(plan.zero + end) for end in ends)
    made.joint["solreflimit"] = f"{number(-stiffness / mass)} {number(-damping / mass)}"
    made.joint["solimplimit"] = _impedance(ADDED)


def _constant(made: Elements, plan: Plan, effect: Effect) -> None:
    made.offset = effect.values[0]


def _gain(made: Elements, plan: Plan, effect: Effect) -> None:
    limit = getattr(effect, effect.limits_force)
    if not is_limit(effect):
        made.called.append(effect)
    elif math.isfinite(limit):
        made.actuator |= {"ctrllimited": "true", "ctrlrange": f"{number(-limit)} {number(limit)}"}


def is_limit(effect: Effect) -> bool:
    """Whether an effect with its values only limits the force."""
    rest = (getattr(effect, name) == value for name, value in effect.neutral if name != effect.limits_force)
    return bool(effect.limits_force) and all(rest)


def _lag(made: Elements, plan: Plan, effect: Effect) -> None:
    made.actuator |= {"dyntype": "filter", "dynprm": number(effect.values[0])}


def _delay(made: Elements, plan: Plan, effect: Effect) -> None:
    # A line between two commands comes half a step before the step that a held command is.
    delay = effect.values[0] + 0.5 * plan.step
    if delay >= plan.step:
        made.actuator |= {"delay": number(delay), "nsample": str(math.ceil(delay / plan.step) + 2), "interp": "linear"}


def _second(made: Elements, plan: Plan, effect: Effect) -> None:
    kind = "hinge" if plan.revolute else "slide"
    mass, stiffness, damping = effect.values
    made.bodies.append(
        f'<body name="{SECOND}"><joint name="{SECOND}" type="{kind}" axis="1 0 0" stiffness="{number(stiffness)}" '
        f'damping="{number(damping)}"/>{inertial(mass, plan.revolute)}</body>'
    )


#: Role of an effect (``roles``) → what it becomes, and how that is said.
NATIVE: dict[str, tuple[Callable[[Elements, Plan, Effect], None], str]] = {
    roles.FRICTION: (_friction, "frictionloss, whose reversals the callback file locates inside the step"),
    roles.CUBE: (_cube, "third coefficient of stiffness"),
    roles.SQUARE: (_square, "second coefficient of stiffness"),
    roles.DRAG: (_drag, "second coefficient of damping"),
    PLAY: (_play, "a tendon whose spring has a dead band (springlength)"),
    roles.STOPS: (_stops, "range, with solreflimit from the stop's stiffness"),
    roles.ONE_STOP: (_one_stop, "one end of range, with solreflimit from the stop's stiffness"),
    roles.CONSTRAINT: (_buffers, "range, with solreflimit and solimplimit"),
    roles.BUFFERS: (_buffers, "range, with solreflimit from the buffers' stiffness and damping"),
    roles.CONSTANT: (_constant, "springref, or the bias of an actuator"),
    LAG: (_lag, "dyntype filter of the actuator"),
    DELAY: (_delay, "delay of the actuator"),
    SECOND_MASS: (_second, "a body that hangs on the first"),
    roles.GAIN: (_gain, "ctrlrange where there is only a limit, else the callback file"),
}
#: Kinds of law that the callback file adds.
CALLED = ("constant", "disturbance", "force", "friction", "input_map", "reading")


def supports(effect: type[Effect]) -> Support:
    """How MuJoCo carries an effect: by its own elements, by the callback file, or not at all."""
    if (role := roles.role(effect)) in NATIVE:
        return Support("exact", NATIVE[role][1])
    if role == VELOCITY_LAG:
        return Support(
            "cannot", "no element for a damper behind a spring, and the callback file has no state of its own"
        )
    if effect.asks_drive():
        return Support("cannot", "the callback file has no part for a force that depends on the command and the motion")
    if effect.knee not in (None, AT_ZERO):
        return Support("cannot", "no element for its spring or damper, and the callback file has no events")
    if role == roles.FORCED_READING:
        return Support("cannot", "MuJoCo asks a sensor of the position before it knows the forces")
    if role == roles.FRICTION_DRIFT:
        return Support("cannot", "the callback file's dry friction knows no time")
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
        if (role := roles.role(type(effect))) in NATIVE:
            NATIVE[role][0](made, plan, effect)
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
        _dry(made, plan)
    if "input_map" in laws and "dynprm" in made.actuator:
        made.actuator |= {"dyntype": "user", "actdim": "1"}
    elif "input_map" in laws:
        made.actuator["gaintype"] = "user"
    if "reading" in laws:
        joint = quoting.in_xml(plan.joint)
        made.sensors.append(f'<user name="{SENSOR}" objtype="joint" objname="{joint}" dim="1" needstage="pos"/>')
