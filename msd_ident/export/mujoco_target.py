"""MuJoCo: a whole MJCF model that runs, with a callback file beside it where MuJoCo has no element for a law."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from msd_ident.data.record import FloatArray
from msd_ident.export import header, mujoco_callback, mujoco_elements, mujoco_replay, quoting, roles
from msd_ident.export.laws import number
from msd_ident.export.mujoco_elements import ACTUATOR, Elements
from msd_ident.export.plan import Plan
from msd_ident.export.support import Support
from msd_ident.export.target import InitialState, Target
from msd_ident.export.templates import filled
from msd_ident.model import Model
from msd_ident.model.effects import Effect


def attributes(given: dict[str, str]) -> str:
    """XML attributes."""
    return " ".join(f'{name}="{value}"' for name, value in given.items())


class MujocoTarget(Target):
    """MJCF with a callback file."""

    name = "mujoco"
    suffixes = (".xml",)
    what = "MuJoCo model (MJCF), with a Python callback file where it needs one"
    library: ClassVar[str | None] = "mujoco"
    stepped = True
    located = True
    commanded = True

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        return mujoco_elements.supports(effect)

    def support(self, effect: Effect, model: Model) -> Support:
        """How this target carries this effect of this model."""
        if roles.role(type(effect)) == roles.CONSTRAINT and any("friction" in one.laws() for one in model.effects):
            return Support("approximated", "in contact, the callback file's dry friction acts whole; mujoco-xml has it")
        return super().support(effect, model)

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        made = mujoco_elements.elements(plan)
        return {out: model(plan, made, self.what).encode(), **callbacks(plan, made, out)}

    def beside(self, out: Path) -> tuple[Path, ...]:
        """Files that may be written next to the main one."""
        return (callback_path(out),)

    def replay(self, out: Path, plan: Plan, start: InitialState) -> FloatArray:
        """Readings (n,) of the written file, run in its target."""
        called = mujoco_elements.elements(plan).called
        return mujoco_replay.run(out, callback_path(out) if called else None, plan, start)


def callbacks(plan: Plan, made: Elements, out: Path) -> dict[Path, bytes]:
    """The callback file beside a model, where it needs one."""
    if not made.called:
        return {}
    beside = callback_path(out)
    return {beside: mujoco_callback.text(plan, made.called, beside.stem, out.name).encode()}


def callback_path(out: Path) -> Path:
    """Where the callback file stands: a name that Python can import."""
    stem = "".join(letter if letter.isalnum() else "_" for letter in out.stem)
    return out.with_name(f"{stem if not stem[:1].isdigit() else f'model_{stem}'}_callback.py")


def model(plan: Plan, made: Elements, what: str) -> str:
    """The whole model as MJCF.

    Args:
        plan: what is exported.
        made: elements of the model.
        what: the format, in a few words for the header.
    """
    joint = quoting.in_xml(plan.joint)
    return filled(
        "mujoco.xml.txt",
        header=header.xml_text(plan, what),
        name=joint,
        step=number(plan.step),
        body=f"{joint}_body",
        joint=joint,
        kind="hinge" if plan.revolute else "slide",
        attributes=attributes(made.joint),
        inertial=mujoco_elements.inertial(plan.model.mass, plan.revolute),
        bodies="".join(f"\n      {body}" for body in made.bodies),
        rest=rest(plan, made),
    )


def rest(plan: Plan, made: Elements) -> str:
    """The sections outside the bodies: tendons, actuators and sensors.

    Args:
        plan: what is exported.
        made: elements of the model.
    """
    joint = quoting.in_xml(plan.joint)
    turned = {"gear": "-1"} if plan.saved.force_sign < 0 else {}
    pushers = [f'<general name="{ACTUATOR}" joint="{joint}" {attributes(made.actuator | turned)}/>']
    if made.offset:
        bias = {"gainprm": "0", "biastype": "affine", "biasprm": f"{number(-made.offset)} 0 0"}
        pushers.append(f'<general name="offset" joint="{joint}" {attributes(bias)}/>')
    sections = (("tendon", made.tendons), ("actuator", pushers), ("sensor", made.sensors))
    return "".join(
        f"  <{name}>\n" + "".join(f"    {item}\n" for item in items) + f"  </{name}>\n"
        for name, items in sections
        if items
    )
