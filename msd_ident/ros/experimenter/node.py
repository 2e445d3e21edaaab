"""The experimenter node: plays profiles on the rig by the action ``experimenter/run``."""

from __future__ import annotations

import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.parameter import Parameter

from msd_ident import strict_yaml
from msd_ident.design.limits import Limits, from_tree
from msd_ident.design.profile import Profile
from msd_ident.design.profile_file import from_yaml
from msd_ident.errors import MsdError, UsageError
from msd_ident.ros.common import action_server, codes, names
from msd_ident.ros.common.codes import code_of
from msd_ident.ros.common.node_runner import NodeOwner
from msd_ident.ros.common.parameters import Settings, declared
from msd_ident.ros.common.path_sandbox import Place
from msd_ident.ros.common.worker import Worker
from msd_ident.ros.experimenter.profile_player import CANCELLED, Experiment, Played, ProfilePlayer
from msd_interfaces.action import RunExperiment
from msd_interfaces.msg import ResultCode

SETTINGS = declared("experimenter")


class Experimenter(NodeOwner):
    """Owns the node and the action; one experiment at a time.

    Args:
        overrides: parameters that go before those of the command line.
        node_options: further arguments of ``rclpy.node.Node``.
    """

    def __init__(self, overrides: list[Parameter] | None = None, **node_options: Any) -> None:
        self.node = Node("experimenter", parameter_overrides=overrides, **node_options)
        self.settings = Settings(self.node, SETTINGS)
        self.conductor = ProfilePlayer(self.node, self.settings["silence"], self.settings["lead"])
        self._worker = Worker("experimenter")
        self._busy = threading.Event()
        self._stop = threading.Event()
        callbacks = {"goal_callback": self._on_goal, "cancel_callback": self._on_cancel}
        self._server = action_server.serve(self.node, RunExperiment, names.RUN, self._execute, **callbacks)

    def release(self) -> bool:
        """Stop what is played, force 0, and answer who asked for it."""
        busy = self._worker.busy
        self._stop.set()
        self._worker.close(5.0)
        return busy

    def close(self) -> bool:
        """The same where nothing spins any more."""
        self._stop.set()
        self.conductor.leave()
        ended = self._worker.close(5.0)
        self._server.destroy()
        return ended

    def _on_goal(self, goal: RunExperiment.Goal) -> GoalResponse:
        """One at a time: a second goal is refused while the cart moves."""
        if self._busy.is_set():
            words = "an experiment is being played; expected its end before the next one"
            self.node.get_logger().warning(words, throttle_duration_sec=5.0)
            return GoalResponse.REJECT
        self._busy.set()
        return GoalResponse.ACCEPT

    def _on_cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        self._stop.set()
        return CancelResponse.ACCEPT

    async def _execute(self, handle: ServerGoalHandle) -> RunExperiment.Result:
        self._stop.clear()
        try:
            result: RunExperiment.Result = await self._worker.submit(lambda: self._work(handle), self.node.executor)
        finally:
            self._busy.clear()
        action_server.finish(handle, result.success)
        return result

    def _work(self, handle: ServerGoalHandle) -> RunExperiment.Result:
        """In the worker's thread; an error becomes a sentence of the result."""
        goal: RunExperiment.Goal = handle.request

        def tell(fraction: float, force: float, position: float) -> None:
            handle.publish_feedback(RunExperiment.Feedback(fraction=fraction, force=force, position=position))

        bag: Path | None = None
        try:
            profile, limits = parsed(goal.profile, goal.limits)
            place = Place(self.settings["bag_folder"])
            bag = place.new(goal.folder) if goal.folder else place.automatic("experiment")
            return answer(self.conductor.play(Experiment(profile, limits, bag, goal.reset), self._stop, tell))
        except MsdError as error:
            return RunExperiment.Result(success=False, message=str(error), code=code_of(error))
        except Exception as error:
            message, code = codes.internal(error, self.node.get_logger())
            return RunExperiment.Result(success=False, message=message, code=code)
        finally:
            if bag is not None and not goal.folder:
                with suppress(OSError):
                    bag.rmdir()  # one that nothing was recorded into


def parsed(profile: str, limits: str) -> tuple[Profile, Limits]:
    """Profile and limits from the goal's texts.

    Raises:
        UsageError: either makes no sense.
    """
    try:
        return from_yaml(profile), from_tree(strict_yaml.load(limits))
    except strict_yaml.YAMLError as error:
        raise UsageError(
            f"limits are no YAML ({' '.join(str(error).split())}); expected force, travel, duration"
        ) from None


#: Codes of experiments that were played or cancelled; any other end is the rig's.
_ENDS = {"": codes.DONE, CANCELLED: codes.CANCELLED}


def answer(played: Played) -> RunExperiment.Result:
    """The action's result."""
    return RunExperiment.Result(
        success=not played.stopped,
        code=_ENDS.get(played.stopped, ResultCode.UNAVAILABLE),
        message=played.sentence,
        bag_path=str(played.bag),
        stopped=played.stopped,
        commands=played.commands,
        worst_delay=played.worst,
        mean_delay=played.mean,
    )
