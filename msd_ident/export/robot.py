"""MuJoCo models of robots: finding the joint to export to, and checking that it is suitable."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from msd_ident.errors import DataError, UsageError
from msd_ident.export import mujoco_replay

#: MJCF's joint type → unit of its position.
UNITS = {"slide": "m", "hinge": "rad"}
_Element = ElementTree.Element


def parsed(path: Path) -> ElementTree.ElementTree[_Element]:
    """A model as XML with its comments.

    Raises:
        DataError: it cannot be read, or is no MJCF.
    """
    try:
        builder = ElementTree.TreeBuilder(insert_comments=True)
        tree = ElementTree.parse(path, parser=ElementTree.XMLParser(target=builder))
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror}; expected a MuJoCo model (MJCF)") from None
    except ElementTree.ParseError as error:
        raise DataError(f"{path} is no XML ({error}); expected a MuJoCo model (MJCF)") from None
    if tree.getroot().tag != "mujoco":
        raise DataError(f"{path} holds <{tree.getroot().tag}>; expected a MuJoCo model (MJCF), which begins <mujoco>")
    return tree


def _walk(body: _Element, above: tuple[_Element, ...] = ()) -> Iterator[tuple[_Element, tuple[_Element, ...]]]:
    """Every joint with those that lie between it and the world, other joints of its own body too."""
    joints = [child for child in body if child.tag in ("joint", "freejoint")]
    for i, joint in enumerate(joints):
        yield joint, above + tuple(joints[:i])
    for child in body:
        if child.tag in ("body", "frame"):
            yield from _walk(child, above + tuple(joints))


def joint(tree: ElementTree.ElementTree[_Element], path: Path, name: str, unit: str) -> _Element:
    """The joint of this name, if it alone moves its body and is in this unit.

    Args:
        tree: the model.
        path: its file.
        name: of the joint.
        unit: ``m`` or ``rad``, of the record's positions.

    Raises:
        UsageError: there is no such joint, it has several degrees of freedom or further ones between it and the world,
            or it moves in another unit.
        DataError: MuJoCo refuses the model.
        SetupError: MuJoCo is not installed.
    """
    found = [(one, above) for world in tree.getroot().iter("worldbody") for one, above in _walk(world)]
    names = [str(one.get("name")) for one, _ in found if one.get("name")]
    for one, above in found:
        if one.get("name") == name:
            _check(one, above, path, unit)
            return one
    included = "; what it includes is not looked into" if next(tree.getroot().iter("include"), None) is not None else ""
    listed = ", ".join(names) or "no joint with a name"
    raise UsageError(f"{path} has no joint {name!r}{included}; expected one of its joints: {listed}")


def _check(one: _Element, above: tuple[_Element, ...], path: Path, unit: str) -> None:
    name = str(one.get("name"))
    kind = kind_of(path, name)
    if kind not in UNITS:
        freedoms = 3 if kind == "ball" else 6
        raise UsageError(
            f"joint {name} of {path} has {freedoms} degrees of freedom ({'free' if freedoms == 6 else 'ball'}); "
            "expected a slide or a hinge"
        )
    if above:
        between = ", ".join(str(other.get("name", "one without a name")) for other in above)
        raise UsageError(
            f"between the world and joint {name} of {path} there are further degrees of freedom ({between}); expected "
            "none, since the record has one motion: weld those bodies or take their joints out"
        )
    if UNITS[kind] != unit:
        raise UsageError(
            f"joint {name} of {path} is a {kind}, which moves in {UNITS[kind]}, and positions are in {unit}; expected "
            f"the same: choose another joint, or give --position-scale and --position-unit {UNITS[kind]}"
        )


def kind_of(path: Path, name: str) -> str:
    """Type of a joint as MuJoCo compiles it: ``slide``, ``hinge``, ``ball`` or ``free``.

    Default classes, their parents and the ``childclass`` of bodies may set it, so the joint's element alone does not
    tell.

    Args:
        path: the model.
        name: of the joint.

    Raises:
        DataError: MuJoCo refuses the model.
        SetupError: MuJoCo is not installed.
    """
    mujoco, model = mujoco_replay.library(), mujoco_replay.load(path)
    kinds = mujoco.mjtJoint
    names = {kinds.mjJNT_SLIDE: "slide", kinds.mjJNT_HINGE: "hinge", kinds.mjJNT_BALL: "ball", kinds.mjJNT_FREE: "free"}
    return names[kinds(int(model.jnt_type[model.joint(name).id]))]


def in_degrees(tree: ElementTree.ElementTree[_Element]) -> bool:
    """Whether angles in the XML are degrees, as they are unless the compiler says radian."""
    angles = [compiler.get("angle") for compiler in tree.getroot().iter("compiler") if compiler.get("angle")]
    return (angles[-1] if angles else "degree") == "degree"


def section(tree: ElementTree.ElementTree[_Element], tag: str) -> _Element:
    """A top-level section of the model; it is added if the model does not have it.

    Args:
        tree: the model.
        tag: name of the section, such as ``actuator``.
    """
    found = tree.getroot().find(tag)
    return found if found is not None else ElementTree.SubElement(tree.getroot(), tag)
