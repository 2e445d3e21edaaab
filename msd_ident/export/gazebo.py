"""Gazebo's formats: SDF with spring, damper, friction and stops of a joint; URDF with damper and friction."""

from __future__ import annotations

from pathlib import Path

from msd_ident.export import header
from msd_ident.export.laws import number
from msd_ident.export.plan import MOTIONS, Plan
from msd_ident.export.support import Support
from msd_ident.export.target import Target
from msd_ident.export.templates import filled
from msd_ident.model import Model
from msd_ident.model.effects import Effect

#: Range of a joint without stops, in the position unit: far beyond any motion.
FREE = 1e6
_SHAKEN = "the nearest m, b, k and friction are fitted in its place"


_SUPPORT = {
    "coulomb_friction": Support("exact", "friction of the joint"),
    "force_offset": Support("exact", "spring_reference"),
    "end_stop": Support("approximated", "limit; a physics engine may treat it as rigid, whatever its stiffness"),
    "sensor_drift": Support("cannot", "the drift of a sensor is not part of a joint"),
    "actuator_lag": Support("cannot", "no actuator: put the lag into the controller"),
    "time_offset": Support("cannot", "no actuator: put the delay into the controller"),
    "periodic_disturbance": Support("cannot", "no force that depends on time"),
    "stiffness_drift": Support("approximated", "the mean stiffness over the record"),
    "second_mode": Support("approximated", "one moving mass: " + _SHAKEN),
    "force_gain_nonlinearity": Support("approximated", "effort limit; of a bent gain, " + _SHAKEN),
}


class SdfTarget(Target):
    """SDF 1.11 for Gazebo."""

    name = "sdf"
    suffixes = (".sdf",)
    what = "SDF model for Gazebo"
    library = None
    why_not = "Gazebo has no Python package that steps a world; open it with gz sim"
    needs_newtons = True
    kept = ("coulomb_friction", "force_offset", "end_stop")
    template = "joint.sdf.txt"

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        return _SUPPORT.get(effect.name, Support("approximated", _SHAKEN))

    def support(self, effect: Effect, model: Model) -> Support:
        """How this target carries this effect of this model."""
        if effect.name == "force_offset" and model.stiffness == 0.0:
            return Support("cannot", "there is no spring whose reference could carry it")
        return super().support(effect, model)

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        text = filled(
            self.template,
            header=header.xml_text(plan, self.what),
            joint=plan.joint, kind=MOTIONS[plan.saved.position_unit], inertial=self.inertial(plan), free=number(FREE),
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
    stiffness = plan.value("stop_stiffness")
    effort = plan.value("force_limit", FREE)
    reach = plan.value("stop_position")
    return {
        "lower": number(plan.zero - reach if stiffness else -FREE),
        "upper": number(plan.zero + reach if stiffness else FREE),
        "effort": number(min(effort, FREE)),
        "stop": f"<stiffness>{number(stiffness)}</stiffness><dissipation>0</dissipation>" if stiffness else "",
    }


def _dynamics(plan: Plan) -> dict[str, str]:
    stiffness = plan.model.stiffness
    shift = plan.value("offset_force") / stiffness if stiffness else 0.0
    return {
        "damping": number(plan.model.damping),
        "friction": number(plan.value("coulomb_force")),
        "stiffness": number(stiffness),
        "reference": number(plan.zero - shift),
    }
