"""The ``identifier/diagnose`` action: diagnoses in the worker's thread, with progress, cancelled within a second."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.action import CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from msd_ident.cancellation import Cancelled, raise_if_cancelled
from msd_ident.errors import MsdError, UsageError
from msd_ident.ros.common import action_server, codes, diagnostics_status, names
from msd_ident.ros.common.codes import code_of
from msd_ident.ros.common.parameters import Settings
from msd_ident.ros.common.worker import Worker, deliver
from msd_ident.ros.identifier.request_records import Part, Sources
from msd_interfaces.action import Diagnose
from msd_interfaces.msg import Diagnosis as DiagnosisMessage

if TYPE_CHECKING:
    from msd_ident.diagnosis import Diagnosis
    from msd_ident.io import Joint

#: Paths that a goal may name.
MOST_PATHS = 100
#: Least time between two feedbacks of one stage and cause [s].
FEEDBACK_PERIOD = 0.05
#: A cancelled goal is answered after this time [s], even when compiled code is still at it.
PATIENCE = 0.5

_CANCELLED = "cancelled"


@dataclass
class _Goal:
    """A goal in progress: ``answer`` comes from the worker, or from a cancellation that it does not notice in time."""

    handle: ServerGoalHandle
    answer: Future
    stop: threading.Event = field(default_factory=threading.Event)
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _reported: tuple[float, str, str] = (0.0, "", "")

    def settle(self, result: Diagnose.Result) -> None:
        """Answer, once; from any thread."""
        with self._lock:
            if not self.answer.done():
                deliver(self.answer.set_result, result)

    def tell(self, stage: str, fraction: float, cause: str) -> None:
        """Feedback to the client, not too often.

        Raises:
            Cancelled: the goal was cancelled.
        """
        raise_if_cancelled()
        last, *words = self._reported
        now = time.monotonic()
        if words == [stage, cause] or (words[0] == stage and now - last < FEEDBACK_PERIOD):
            return
        self._reported = (now, stage, cause)
        with self._lock:
            if not self.answer.done():
                self.handle.publish_feedback(Diagnose.Feedback(stage=stage, fraction=fraction, cause=cause))


@dataclass(frozen=True)
class _Finding:
    """What the last diagnosis says about the model."""

    good: bool
    message: DiagnosisMessage


@dataclass(frozen=True)
class _Part:
    """One experiment of a goal: its paths, its joint, the part of the goal done before it, and its own part."""

    paths: Sequence[str]
    joint: Joint | None
    offset: float
    share: float


class Diagnosing:
    """Owns the action server and the topic of diagnoses.

    Args:
        node: it belongs to.
        worker: whose thread does the work.
        sources: of the records.
        settings: the node's parameters.
    """

    def __init__(self, node: Node, worker: Worker, sources: Sources, settings: Settings) -> None:
        self._node, self._worker, self._sources, self._settings = node, worker, sources, settings
        self._goals: dict[bytes, _Goal] = {}
        self._last: _Finding | None = None
        self._publisher = node.create_publisher(DiagnosisMessage, names.private(names.DIAGNOSIS), names.latest_qos())
        self._server = action_server.serve(
            node, Diagnose, names.DIAGNOSE, self._execute, cancel_callback=self._on_cancel
        )

    def release(self) -> None:
        """Answer all goals that no worker will."""
        for goal in list(self._goals.values()):
            goal.settle(_ended())
        if (executor := self._node.executor) is not None:
            executor.wake()

    def close(self) -> None:
        """Take the server down, when nothing spins any more."""
        self._server.destroy()

    def status(self, name: str) -> DiagnosticStatus:
        """What is known about the model: OK when it is adequate or extended to be, else a warning with the sentence."""
        if self._last is None:
            return diagnostics_status.status(name, diagnostics_status.OK, "not diagnosed yet", {})
        found = self._last.message
        values = {
            "verdict": found.verdict,
            "causes": ", ".join(cause.name for cause in found.causes),
            "data": found.path,
            "SEE of the base model": found.base_see,
            "SEE of the extended model": found.extended_see,
            "noise floor": found.noise_floor,
            "unexplained part of the motion [%]": found.left_percent,
            f"missing force [{found.force_unit} rms]": found.missing_force,
            "reduction on left-out data [%]": found.heldout_reduction_percent,
            "missing samples": found.missing_samples,
        }
        return diagnostics_status.status(
            name, diagnostics_status.OK if self._last.good else diagnostics_status.WARN, found.summary, values
        )

    async def _execute(self, handle: ServerGoalHandle) -> Diagnose.Result:
        """In the executor: wait for the worker, or for a cancellation."""
        executor = self._node.executor
        goal = _Goal(handle, Future(executor=executor))
        self._goals[bytes(handle.goal_id.uuid)] = goal
        if handle.is_cancel_requested:
            goal.stop.set()
        try:
            work = self._worker.submit(lambda: goal.settle(self._work(goal)), executor, stop=goal.stop)
            work.add_done_callback(lambda done: goal.settle(_ended()))
        except MsdError as error:
            goal.settle(_refused(str(error), codes.BUSY))
        result: Diagnose.Result = await goal.answer
        del self._goals[bytes(handle.goal_id.uuid)]
        action_server.finish(handle, result.success, goal.stop.is_set())
        return result

    def _on_cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        goal = self._goals.get(bytes(handle.goal_id.uuid))
        if goal is not None:
            goal.stop.set()
            late = threading.Timer(PATIENCE, self._give_up, [goal])
            late.daemon = True
            late.start()
        return CancelResponse.ACCEPT

    def _give_up(self, goal: _Goal) -> None:
        goal.settle(_refused(_CANCELLED, codes.CANCELLED))
        if (executor := self._node.executor) is not None:
            executor.wake()

    def _work(self, goal: _Goal) -> Diagnose.Result:
        """In the worker's thread: everything that a goal asks for; an error becomes a sentence of the result."""
        log = self._node.get_logger()
        try:
            result = self._diagnosed(goal)
        except Cancelled:
            result = _refused(_CANCELLED, codes.CANCELLED) if goal.stop.is_set() else _ended()
        except MsdError as error:
            result = _refused(str(error), code_of(error))
        except Exception as error:
            result = _refused(*codes.internal(error, log))
        diagnostics_status.log(log, result.success, result.message)
        return result

    def _diagnosed(self, goal: _Goal) -> Diagnose.Result:
        request: Diagnose.Goal = goal.handle.request
        if len(request.bag_paths) > MOST_PATHS:
            raise UsageError(f"{len(request.bag_paths)} paths; expected at most {MOST_PATHS}: ask in several goals")
        target = self._sources.place.new(request.report_path, ".html") if request.report_path else None
        groups: list[tuple[tuple[str, ...], Joint | None]]
        if self._settings["all_joints"]:
            groups = [((path,), joint) for path in request.bag_paths or [""] for joint in self._sources.joints(path)]
        else:
            apart: list[tuple[str, ...]] = [(path,) for path in request.bag_paths] or [()]
            groups = [(tuple(request.bag_paths), None)] if request.together else [(paths, None) for paths in apart]
        result = Diagnose.Result(success=True)
        found: list[Diagnosis] = []
        for index, (paths, joint) in enumerate(groups):
            part = _Part(paths, joint, index / len(groups), 1.0 / len(groups))
            self._one(goal, part, result, found)
        if target is not None and found:
            from msd_ident.report import page

            page.save(found, target)
        summaries = [one.summary for one in result.diagnoses]
        result.message = (
            summaries[0] if len(summaries) == 1 else "; ".join(f"{d.path}: {d.summary}" for d in result.diagnoses)
        )
        return result

    def _one(self, goal: _Goal, group: _Part, result: Diagnose.Result, found: list[Diagnosis]) -> None:
        """Diagnose one experiment; ``result`` and ``found`` grow. One that cannot be read leaves the others alone."""
        from msd_ident.data.joint_effort import judge
        from msd_ident.ros.common.diagnosis_messages import failed, healthy, to_diagnosis
        from msd_ident.workflow import pipeline

        def tell(stage: str, fraction: float, cause: str) -> None:
            goal.tell(stage, group.offset + group.share * fraction, cause)

        def read(messages: int) -> None:
            tell("reading", 0.0, f"{messages} messages" if messages else "")

        paths, joint = group.paths, group.joint
        name = " + ".join(paths) or "live"
        name = f"{name} {joint.name}" if joint else name
        try:
            tell("reading", 0.0, "")
            part = Part(goal.handle.request.start, goal.handle.request.end)
            records = [self._sources.record(path, part, read, joint) for path in paths or [""]]
            if joint is not None and not (judged := judge(records[0])).usable:
                result.diagnoses = [*result.diagnoses, failed(name, judged.sentence)]
                return
            chosen = {name: self._settings[name] for name in ("model", "tolerance", "calibrate")}
            options = pipeline.Options(**chosen)
            one = pipeline.diagnose(records, options, tell)
        except MsdError as error:
            if joint is None:  # of all joints, one that rests or is not measured leaves the others a success
                result.success, result.code = False, code_of(error)
            result.diagnoses = [*result.diagnoses, failed(name, str(error))]
            return
        message = to_diagnosis(one, name, self._node.get_clock().now().nanoseconds, self._sources.frame)
        found.append(one)
        result.diagnoses = [*result.diagnoses, message]
        self._last = _Finding(healthy(one), message)
        self._publisher.publish(message)


def _ended() -> Diagnose.Result:
    """The answer to goals of an identifier that ends."""
    return _refused("stopped: the identifier ends", codes.CANCELLED)


def _refused(reason: str, code: int) -> Diagnose.Result:
    return Diagnose.Result(success=False, message=reason, code=code)
