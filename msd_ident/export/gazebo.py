"""Gazebo's formats: SDF with spring, damper, friction and stops of a joint; URDF with damper and friction."""

from __future__ import annotations

from pathlib import Path

from msd_ident.export import header, quoting, roles
from msd_ident.export.laws import number
from msd_ident.export.plan import MOTIONS, Plan
from msd_ident.export.support import Support
from msd_ident.export.target import Target
from msd_ident.export.templates import filled
from msd_ident.model import Model
from msd_ident.model.base_model import FRICTION_FORCE, OFFSET, OFFSET_FORCE
from msd_ident.model.effects import Effect, saturation
from msd_ident.model.effects.law import DELAY, LAG, SECOND_MASS

#: Range of a joint without stops, in the position unit: far beyond any motion.
FREE = 1e6
_SHAKEN = "the nearest m, b, k and friction are fitted in its place"


_SUPPORT = {
    roles.FRICTION: Support("exact", "friction of the joint"),
    roles.CONSTANT: Support("exact", "spring_reference"),
    roles.STOPS: Support("approximated", "limit; a physics engine may treat it as rigid, whatever its stiffness"),
    roles.READING_DRIFT: Support("cannot", "the drift of a sensor is not part of a joint"),
    roles.FORCED_READING: Support("cannot", "the error of a sensor is not part of a joint"),
    LAG: Support("cannot", "no actuator: put the lag into the controller"),
    DELAY: Support("cannot", "no actuator: put the delay into the controller"),
    roles.DISTURBANCE: Support("cannot", "no force that depends on time"),
    roles.SPRING_DRIFT: Support("approximated", "the mean stiffness over the record"),
    **dict.fromkeys((SECOND_MASS, roles.LOADED_SECOND), Support("approximated", "one moving mass: " + _SHAKEN)),
    roles.GAIN: Support("approximated", "effort limit; of a bent gain, " + _SHAKEN),
}


class SdfTarget(Target):
    """SDF 1.11 for Gazebo."""

    name = "sdf"
    suffixes = (".sdf",)
    what = "SDF model for Gazebo"
    library = None
    why_not = "Gazebo has no Python package that steps a world; open it with gz sim"
    needs_newtons = True
    turned = "a positive force on this joint moves it upwards, and nothing here inverts it: apply minus the force"
    kept = (roles.FRICTION, roles.CONSTANT, roles.STOPS)
    template = "joint.sdf.txt"

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        return _SUPPORT.get(roles.role(effect), Support("approximated", _SHAKEN))

    def support(self, effect: Effect, model: Model) -> Support:
        """How this target carries this effect of this model."""
        if effect.name == OFFSET and model.stiffness == 0.0:
            return Support("cannot", "there is no spring whose reference could carry it")
        return super().support(effect, model)

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        text = filled(
            self.template,
            header=header.xml_text(plan, self.what, self.turned),
            joint=quoting.in_xml(plan.joint), kind=MOTIONS[plan.saved.position_unit],
            inertial=self.inertial(plan), free=number(FREE),
            **_limits(plan), **_dynamics(plan),
        )  # fmt: skip
        return {out: text.encode()}

    @staticmethod
    def inertial(plan: Plan) -> str:
        """Mass, or moment about the axis, as elements."""
        size = number(plan.model.mass)
        if plan.revolute:
            diagonal = f"<ixx>{size}</ixx><iyy>{size}</iyy><izz>{size}</izz>"
            return f"<mass>1</mass><inertia>{diagonal}</inertia>"
        return f"<mass>{size}</mass><inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>1e-3</izz></inertia>"


class UrdfTarget(SdfTarget):
    """URDF with notes for ros2_control."""

    name = "urdf"
    suffixes = (".urdf",)
    what = "URDF with ros2_control"
    why_not = "URDF is a description; its spring needs Gazebo: open it with gz sim"
    template = "joint.urdf.txt"

    @staticmethod
    def inertial(plan: Plan) -> str:
        """Mass and inertia of the moving link as XML attributes; a revolute joint has the inertia."""
        size = number(plan.model.mass)
        mass, moment = ("1", size) if plan.revolute else (size, "1e-3")
        rest = 'ixy="0" ixz="0" iyz="0"'
        return f'<mass value="{mass}"/><inertia ixx="{moment}" iyy="{moment}" izz="{moment}" {rest}/>'


def _limits(plan: Plan) -> dict[str, str]:
    stop, limit = roles.of_role(plan.model.effects, roles.STOPS), saturation()
    place, spring, _ = stop.knee if stop is not None and stop.knee is not None else ("", "", "")
    reach, stiffness = plan.value(place), plan.value(spring)
    effort = plan.value(limit.limits_force, FREE) if limit is not None else FREE
    return {
        "lower": number(plan.zero - reach if stiffness else -FREE),
        "upper": number(plan.zero + reach if stiffness else FREE),
        "effort": number(min(effort, FREE)),
        "stop": f"<stiffness>{number(stiffness)}</stiffness><dissipation>0</dissipation>" if stiffness else "",
    }


def _dynamics(plan: Plan) -> dict[str, str]:
    stiffness = plan.model.stiffness
    shift = plan.value(OFFSET_FORCE) / stiffness if stiffness else 0.0
    return {
        "damping": number(plan.model.damping),
        "friction": number(plan.value(FRICTION_FORCE)),
        "stiffness": number(stiffness),
        "reference": number(plan.zero - shift),
    }
