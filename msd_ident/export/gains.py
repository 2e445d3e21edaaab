"""Feedforward gains for a controller: force = kS·sign(v) + kV·v + kA·a + kP·(x - zero) + kG."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from msd_ident.export import header, roles
from msd_ident.export.plan import Plan
from msd_ident.export.support import Support
from msd_ident.export.target import Target
from msd_ident.model.base_model import FRICTION_FORCE, OFFSET_FORCE
from msd_ident.model.effects import Effect, structural
from msd_ident.model.effects.law import DELAY, LAG, PLAY, SECOND_MASS

_STOP = Support("cannot", "keep the reference away from the stop")
_SUPPORT = {
    roles.FRICTION: Support("exact", "kS"),
    roles.CONSTANT: Support("exact", "kG"),
    LAG: Support("exact", "lag_time: lead the command by it"),
    DELAY: Support("exact", "delay: lead the command by it"),
    **dict.fromkeys((roles.READING_DRIFT, roles.FORCED_READING), Support("cannot", "a feedforward reads no sensor")),
    roles.DISTURBANCE: Support("cannot", "gains know no time"),
    **dict.fromkeys((SECOND_MASS, roles.LOADED_SECOND), Support("cannot", "gains know one mass")),
    PLAY: Support("cannot", "gains know no play"),
    **dict.fromkeys((roles.STOPS, roles.ONE_STOP, roles.BUFFERS, roles.CONSTRAINT), _STOP),
}


class GainsTarget(Target):
    """YAML of the parameters of a feedforward, as ros2_control reads parameters."""

    name = "gains"
    suffixes = (".yaml", ".yml")
    what = "feedforward gains (kS, kV, kA, kG) as ROS 2 parameters"
    library = None
    why_not = "gains are not a simulation"
    needs_newtons = True

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        nearest = Support("approximated", "the nearest m, b, k and friction are fitted in its place")
        return _SUPPORT.get(roles.role(effect), nearest)

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        comment = "".join(f"# {line}".rstrip() + "\n" for line in header.lines(plan, self.what))
        use = (
            "# force = kS*sign(v) + kV*v + kA*a + kP*(x - zero) + kG, of the reference's motion x, v, a.\n"
            "# kS, kV, kA and kG are what feedforward controllers call so; pid_controller of ros2_controllers takes\n"
            "# one feedforward_gain on its reference: kV for a velocity reference, kP for a position reference.\n"
        )
        text = comment + use + yaml.safe_dump(gains(plan), sort_keys=False)
        return {out: text.encode()}


def gains(plan: Plan) -> dict[str, Any]:
    """The gains in the tree of a ROS 2 parameter file."""
    sign = float(plan.saved.force_sign)
    found = {
        "kS": sign * plan.value(FRICTION_FORCE),
        "kV": sign * plan.model.damping,
        "kA": sign * plan.model.mass,
        "kG": sign * plan.value(OFFSET_FORCE),
        "kP": sign * plan.model.stiffness,
        "zero": plan.zero,
    }
    for part in (LAG, DELAY):
        effect = structural(part)
        if effect is not None and plan.model.has(effect.name):
            found[effect.parameters[0].name] = plan.value(effect.parameters[0].name)
    return {"/**": {"ros__parameters": {"feedforward": {plan.joint: found}}}}
