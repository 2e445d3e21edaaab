"""MuJoCo models that exist: the identified joint put into one of them, or as a fragment to paste."""

from __future__ import annotations

import io
import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from msd_ident.errors import UsageError
from msd_ident.export import header, mujoco_elements, mujoco_replay, mujoco_target, quoting, robot
from msd_ident.export.laws import number
from msd_ident.export.mujoco_elements import ACTUATOR, Elements
from msd_ident.export.mujoco_target import MujocoTarget, callbacks
from msd_ident.export.plan import Plan
from msd_ident.export.templates import filled


class FragmentTarget(MujocoTarget):
    """Elements of one joint."""

    name = "mujoco-fragment"
    what = "MuJoCo elements of one joint, to paste"
    library = None
    why_not = "a fragment is not a complete model: insert it into one with --into robot.xml"
    needs_newtons = True

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        made = mujoco_elements.elements(plan)
        text = filled(
            "mujoco_fragment.xml.txt",
            header=header.xml_text(plan, self.what), joint=quoting.in_xml(plan.joint),
            told=quoting.in_xml_comment(quoting.plain(plan.joint)),
            step=number(plan.step), mass=number(plan.model.mass), attributes=mujoco_target.attributes(made.joint),
            rest=mujoco_target.rest(plan, made),
        )  # fmt: skip
        return {out: text.encode(), **callbacks(plan, made, out)}


class RobotTarget(MujocoTarget):
    """A model with the identified joint in it.

    Args:
        path: the model to put it into.
    """

    name = "mujoco-into"
    what = "MuJoCo model with the identified joint"
    needs_newtons = True

    def __init__(self, path: Path) -> None:
        self.path = path

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        tree = robot.parsed(self.path)
        one = robot.joint(tree, self.path, plan.joint, plan.saved.position_unit)
        made = mujoco_elements.elements(plan)
        if made.bodies:
            raise UsageError(
                f"a second mass cannot be put into {self.path}; expected its body in the robot: export the whole model "
                "(--to mujoco) and take the body from there"
            )
        own = self._own_inertia(plan)
        if own > plan.model.mass * (1.0 + 1e-6):
            raise UsageError(
                f"the bodies behind joint {plan.joint} of {self.path} have {own:.4g} {_inertia(plan)}, more than the "
                f"{plan.model.mass:.4g} {_inertia(plan)} that was identified; expected less: correct their masses"
            )
        for name, value in {**made.joint, "armature": number(max(plan.model.mass - own, 0.0))}.items():
            one.set(name, self._in_its_unit(tree, plan, name, value))
        self._options(tree, plan)
        self._sections(tree, plan, made)
        comment = header.xml_text(plan, self.what)
        tree.getroot().insert(0, ElementTree.Comment(f"\n{comment}\n"))
        buffer = io.BytesIO()
        ElementTree.indent(tree)
        tree.write(buffer, encoding="utf-8")
        return {out: buffer.getvalue() + b"\n", **callbacks(plan, made, out)}

    def _own_inertia(self, plan: Plan) -> float:
        """Inertia that the model's bodies have about the joint already [kg or kg·m²], without its armature."""
        mujoco, model = mujoco_replay.library(), mujoco_replay.load(self.path)
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        degree = model.joint(plan.joint).dofadr[0]
        # Not dof_invweight0: whether that holds the armature depends on MuJoCo's version.
        unit, column = np.eye(model.nv)[[degree]], np.empty((1, model.nv))
        mujoco.mj_solveM(model, data, column, unit)
        return float(1.0 / column[0, degree] - model.dof_armature[degree])

    @staticmethod
    def _in_its_unit(tree: ElementTree.ElementTree[ElementTree.Element], plan: Plan, name: str, value: str) -> str:
        """Angles in degrees where the model has them so."""
        if not plan.revolute or name not in ("range", "springref") or not robot.in_degrees(tree):
            return value
        return " ".join(number(math.degrees(float(part))) for part in value.split())

    @staticmethod
    def _options(tree: ElementTree.ElementTree[ElementTree.Element], plan: Plan) -> None:
        option = robot.section(tree, "option")
        option.set("timestep", number(plan.step))
        option.set("integrator", "RK4")
        flag = option.find("flag")
        (flag if flag is not None else ElementTree.SubElement(option, "flag")).set("refsafe", "disable")

    @staticmethod
    def _sections(tree: ElementTree.ElementTree[ElementTree.Element], plan: Plan, made: Elements) -> None:
        """Tendons, actuator and sensors; an actuator of ours with its name taken is refused."""
        if any(one.get("name") == ACTUATOR for part in tree.getroot().iter("actuator") for one in part):
            raise UsageError(f"the model has an actuator {ACTUATOR!r} already; expected that name free: rename yours")
        for part in ElementTree.fromstring(f"<all>{mujoco_target.rest(plan, made)}</all>"):
            robot.section(tree, part.tag).extend(list(part))


def _inertia(plan: Plan) -> str:
    return "kg·m²" if plan.revolute else "kg"
