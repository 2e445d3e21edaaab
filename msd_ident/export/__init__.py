"""An identified model as a file for other simulations, with a proof by replay.

In: a saved model, a ``Target`` and records. Out: files, and an ``Export`` that says how well they replay the records.
Begin with ``exporting``, then ``target`` and one of the targets, e.g. ``mujoco_target``.
"""

from pathlib import Path

from msd_ident.errors import UsageError
from msd_ident.export.draws_target import DrawsTarget
from msd_ident.export.exporting import Options, export
from msd_ident.export.fmu import FmuTarget
from msd_ident.export.gains import GainsTarget
from msd_ident.export.gazebo import SdfTarget, UrdfTarget
from msd_ident.export.mujoco_plain import MujocoXmlTarget
from msd_ident.export.mujoco_robot import FragmentTarget, RobotTarget
from msd_ident.export.mujoco_target import MujocoTarget
from msd_ident.export.python_target import PythonMsdTarget, PythonTarget
from msd_ident.export.result import Export
from msd_ident.export.target import Target

__all__ = ["TARGETS", "Export", "Options", "Target", "chosen", "export", "into", "target"]

#: All targets.
TARGETS: tuple[Target, ...] = (
    MujocoTarget(),
    MujocoXmlTarget(),
    FragmentTarget(),
    SdfTarget(),
    UrdfTarget(),
    PythonTarget(),
    PythonMsdTarget(),
    FmuTarget(),
    GainsTarget(),
    DrawsTarget(),
)


def target(name: str) -> Target:
    """The target of this name.

    Raises:
        UsageError: there is none; the message lists those there are.
    """
    for one in TARGETS:
        if one.name == name:
            return one
    raise UsageError(f"no target is called {name!r}; expected one of {', '.join(one.name for one in TARGETS)}")


def chosen(name: str, robot: Path | None, fragment: bool) -> Target:
    """The target that the options of the command line ask for together.

    Args:
        name: target that the user asked for.
        robot: MuJoCo model to put the joint into; ``None`` for none.
        fragment: whether only the joint's elements are wanted.

    Raises:
        UsageError: there is no such target, or it is no MuJoCo model that one of the others changes.
    """
    if not fragment:
        return target(name) if robot is None else into(robot, name)
    if robot is not None:
        raise UsageError("--fragment with --into, which writes a whole robot; expected one of them: leave one away")
    elements = FragmentTarget()
    if name not in (MujocoTarget.name, elements.name):
        raise UsageError(
            f"--fragment with --to {name}; expected --to mujoco, whose elements it writes: leave --fragment away"
        )
    return elements


def into(path: Path, name: str) -> Target:
    """A target that puts the joint into a robot's MuJoCo model.

    Args:
        path: of the robot's model.
        name: target that the user asked for.

    Raises:
        UsageError: the target asked for is not MuJoCo.
    """
    if name != "mujoco":
        raise UsageError(f"--into with --to {name}; expected --to mujoco, whose models it changes")
    return RobotTarget(path)
