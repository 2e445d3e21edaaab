"""MuJoCo without Python callbacks, for its C library, MJX and other readers of MJCF: the XML is complete by itself."""

from __future__ import annotations

from pathlib import Path

from msd_ident.data.record import FloatArray
from msd_ident.export import mujoco_elements, mujoco_replay, mujoco_target, roles
from msd_ident.export.mujoco_elements import NATIVE
from msd_ident.export.plan import Plan
from msd_ident.export.support import Support
from msd_ident.export.target import InitialState, Target
from msd_ident.model import Model
from msd_ident.model.effects import Effect

_SUPPORT = {
    roles.FRICTION: Support("exact", "frictionloss, dry within a step by solreffriction"),
    roles.READING_DRIFT: Support("cannot", "no element drifts; readings are the joint's position"),
    roles.FORCED_READING: Support("cannot", "no element adds the force to a reading"),
    roles.GAIN_DRIFT: Support("approximated", "the mean gain over the record, in the nearest m, b, k and friction"),
    roles.DISTURBANCE: Support("cannot", "no force that depends on time"),
}


class MujocoXmlTarget(Target):
    """MJCF alone."""

    name = "mujoco-xml"
    suffixes = (".xml",)
    what = "MuJoCo model (MJCF) without callbacks"
    library = "mujoco"
    stepped = True
    commanded = True

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        role = roles.role(effect)
        if role in _SUPPORT:
            return _SUPPORT[role]
        if role in NATIVE and "input_map" not in effect.laws():
            return mujoco_elements.supports(effect)
        if "input_map" in effect.laws():
            return Support("approximated", "ctrlrange for a limit; of a bent gain, the nearest m, b, k and friction")
        return Support("approximated", "the nearest m, b, k, friction and other elements are fitted in its place")

    def support(self, effect: Effect, model: Model) -> Support:
        """How this target carries this effect of this model."""
        if mujoco_elements.is_limit(effect):
            return Support("exact", "ctrlrange")
        return super().support(effect, model)

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        made = mujoco_elements.elements(plan)
        return {out: mujoco_target.model(plan, made, self.what).encode()}

    def replay(self, out: Path, plan: Plan, start: InitialState) -> FloatArray:
        """Readings (n,) of the written file, run in its target."""
        return mujoco_replay.run(out, None, plan, start)
