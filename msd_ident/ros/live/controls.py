"""What the buttons of the live view do in the graph."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from rclpy.action import ActionClient
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from std_srvs.srv import Trigger

from msd_ident.live import Board, Job, Scope
from msd_ident.ros.common import names
from msd_interfaces.action import Diagnose
from msd_interfaces.srv import Identify, StartRecording

#: How far ahead a force is stamped.
LEAD = Duration(nanoseconds=50_000_000)
#: Name of the rig's service, as in the table of the graph.
RESET = "rig/reset"
#: How the recorder's status ends, and how its sentence begins while it records.
RECORDING = "recording:"


class LiveControls:
    """Does what is asked for and tells the board what came of it. Methods may be called from any thread.

    Args:
        node: to do it with.
        scope: whose model restarts with the rig.
        board: shows it.
        step_limit: greatest force that is commanded, in its unit; 0: none may be.
        take: takes the samples that have arrived.
    """

    def __init__(self, node: Node, scope: Scope, board: Board, step_limit: float, take: Callable[[], None]) -> None:
        self._node, self._scope, self._board, self._limit = node, scope, board, step_limit
        self._take = take
        self._commanded = 0.0
        self._goal: Any = None
        self._force = node.create_publisher(WrenchStamped, names.FORCE, names.command_qos()) if step_limit > 0 else None
        self._clients = {
            "reset": node.create_client(Trigger, RESET),
            "record": node.create_client(StartRecording, names.RECORDER_START),
            "stop": node.create_client(Trigger, names.RECORDER_STOP),
            "identify": node.create_client(Identify, names.IDENTIFY),
        }
        if self._force is not None:
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            node.create_timer(names.LEASE / 5.0, self._stand_behind, clock=steady)
        self._diagnose = ActionClient(node, Diagnose, names.DIAGNOSE)
        node.create_subscription(DiagnosticArray, names.DIAGNOSTICS, self._on_diagnostics, 10)

    def present(self, own_subscriptions: int) -> frozenset[str]:
        """Names of the controls that somebody would answer."""
        found = {name for name, client in self._clients.items() if client.service_is_ready()}
        if self._diagnose.server_is_ready():
            found.add("diagnose")
        if self._force is not None and self._force.get_subscription_count() > own_subscriptions:
            found.add("step")
        return frozenset(found)

    def close(self) -> None:
        """Take the force away that was commanded here; nobody else would."""
        if self._force is not None and self._commanded:
            self._publish(0.0)
            self._force.wait_for_all_acked(Duration(seconds=1))
        self._diagnose.destroy()

    # -- what buttons ask for

    def step(self, force: float) -> None:
        """Command a force from now on."""
        if not abs(force) <= self._limit:
            self._board.say(False, f"a force of {force:g} is refused; expected at most ± {self._limit:g} (step_limit)")
            return
        self._later(lambda: self._push(force))
        self._board.say(True, f"force {force:g} {self._board.known.force_unit}")

    def record(self, on: bool) -> None:
        """Start or stop a recording."""
        if on:
            self._ask("record", StartRecording.Request(), "starting", self._on_recording)
        else:
            self._ask("stop", Trigger.Request(), "closing the bag", lambda _: self._board.tell(recording=None, bag=""))

    def identify(self) -> None:
        """Fit the identifier's live buffer; the estimate comes on its topic."""
        self._ask("identify", Identify.Request(), "fitting")

    def reset(self) -> None:
        """Put the rig back."""
        self._ask("reset", Trigger.Request(), "resetting", self._on_reset)

    def diagnose(self) -> None:
        """Diagnose the identifier's live buffer; the verdict comes on its topic."""
        self._board.begin("diagnose", Job("asking", 0.0))
        self._later(self._send_goal)

    def cancel(self) -> None:
        """Give the diagnosis up."""
        self._later(lambda: self._goal.cancel_goal_async() if self._goal else None)

    # -- in the executor's thread

    def _stand_behind(self) -> None:
        """Sign of life while a force acts that was commanded here."""
        if self._force is not None and self._commanded:
            self._force.assert_liveliness()

    def _later(self, work: Callable[[], object]) -> None:
        if (executor := self._node.executor) is not None:
            executor.create_task(work)

    def _push(self, force: float) -> None:
        """The force, a little ahead, so that it is there when it begins to act; a rest before the very first one."""
        if not self._scope.knows_force:
            self._publish(0.0)  # a subscriber that waits for steps sees none in the first force
        self._publish(force, LEAD)

    def _publish(self, force: float, lead: Duration | None = None) -> None:
        now = self._node.get_clock().now()
        message = WrenchStamped()
        message.header.stamp = (now + lead if lead else now).to_msg()
        message.wrench.force.x = self._commanded = force
        if self._force is not None:
            self._force.publish(message)

    def _ask(self, name: str, request: Any, stage: str, then: Callable[[Any], object] = lambda _: None) -> None:
        """Call a service; tell what it answered, and do something with the answer of a success."""
        self._board.begin(name, Job(stage))

        def done(future: Any) -> None:
            answer, error = (None, future.exception()) if future.exception() else (future.result(), None)
            if answer is not None and answer.success:
                then(answer)
            good = answer is not None and answer.success
            self._board.end(name, good, f"{name}: {answer.message if answer is not None else error}")

        self._later(lambda: self._clients[name].call_async(request).add_done_callback(done))

    def _on_reset(self, answer: Trigger.Response) -> None:
        self._take()  # what was sampled before is no start for the model
        self._scope.restart()

    def _on_recording(self, answer: StartRecording.Response) -> None:
        self._board.tell(recording=time.time(), bag=answer.path)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        """Recordings that others start and stop."""
        own = names.status_name(self._node.get_namespace(), "recorder", "bag")
        for status in message.status:
            if status.name != own:
                continue
            on = status.message.startswith(RECORDING)
            if on and self._board.known.recording is None:
                self._board.tell(recording=time.time(), bag=status.message.partition(", in ")[2])
            elif not on and self._board.known.recording is not None:
                self._board.tell(recording=None, bag="")

    def _send_goal(self) -> None:
        sent = self._diagnose.send_goal_async(Diagnose.Goal(), feedback_callback=self._on_feedback)
        sent.add_done_callback(self._on_accepted)

    def _on_feedback(self, message: Any) -> None:
        feedback = message.feedback
        cause = f" {feedback.cause.replace('_', ' ')}" if feedback.cause else ""
        if self._goal is not None:
            self._board.begin("diagnose", Job(f"{feedback.stage}{cause}", feedback.fraction))

    def _on_accepted(self, future: Any) -> None:
        handle = future.result()
        if not handle.accepted:
            self._board.end("diagnose", False, "diagnose: the identifier refused")
            return
        self._goal = handle
        handle.get_result_async().add_done_callback(self._on_result)

    def _on_result(self, future: Any) -> None:
        result = future.result().result
        self._goal = None
        self._board.end("diagnose", result.success, f"diagnose: {result.message}")
