"""The live view's node: the graph on one side, the page on the other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter

from msd_ident.live import Board, Scope
from msd_ident.live.board import Known
from msd_ident.live.page import Shown
from msd_ident.live.server import HERE, LiveServer, new_token
from msd_ident.ros.common import names
from msd_ident.ros.common.node_runner import NodeOwner
from msd_ident.ros.common.parameters import Settings, declared
from msd_ident.ros.live import results
from msd_ident.ros.live.controls import LiveControls
from msd_ident.ros.live.data import LiveData
from msd_interfaces.msg import Diagnosis, Estimate

SETTINGS = declared("live")

#: How often the graph is looked at for what has come and gone [s].
LOOK_PERIOD = 0.5


class LiveView(NodeOwner):
    """Owns the node and the page's server.

    Args:
        overrides: parameters that go before those of the command line.
        say: called once with the address of the page.
        node_options: further arguments of ``rclpy.node.Node`` (a context, arguments of a test).

    Raises:
        MsdError: parameters make no sense, or the port cannot be had.
    """

    def __init__(
        self,
        overrides: list[Parameter] | None = None,
        say: Callable[[str], None] | None = None,
        **node_options: Any,
    ) -> None:
        self.node = Node("live", parameter_overrides=overrides, **node_options)
        s = self.settings = Settings(self.node, SETTINGS)
        # The button commands the topic `force`; a rig whose force comes from another topic does not receive it.
        limit = 0.0 if s["force"] else s["step_limit"]
        self.scope = Scope(hold=s["hold"])
        self.board = Board(
            Known(
                force_unit=s["force_unit"],
                position_unit=s["position_unit"],
                place=self.node.get_namespace().rstrip("/"),
                step_force=max(min(s["step_force"], limit), -limit),
                step_limit=limit or s["step_limit"] or 1.0,
            )
        )
        self._data = LiveData(self.node, s, self.scope)
        self._controls = LiveControls(self.node, self.scope, self.board, limit, self._data.take)
        self._estimate: Estimate | None = None
        self._diagnosis: Diagnosis | None = None
        self._listen()
        self.server = self._serve()
        self.server.start()
        (say or self._log)(self.server.url)

    def close(self) -> bool:
        """Take the page down; take the force away."""
        ended = self.server.stop()
        self._controls.close()
        return ended

    def _serve(self) -> LiveServer:
        s = self.settings
        token = s["token"] or ("" if s["host"] == HERE else new_token())
        shown = Shown(self.scope, self.board, self._controls, s["frame_rate"])
        return LiveServer(shown, s["host"], s["port"], token)

    def _log(self, url: str) -> None:
        self.node.get_logger().info(f"live view at {url}")

    def _listen(self) -> None:
        node, steady = self.node, Clock(clock_type=ClockType.STEADY_TIME)
        node.create_subscription(Estimate, names.ESTIMATE, self._on_estimate, names.latest_qos())
        node.create_subscription(Diagnosis, names.DIAGNOSIS, self._on_diagnosis, names.latest_qos())
        node.create_timer(1.0 / self.settings["frame_rate"], self._tick, clock=steady)
        node.create_timer(LOOK_PERIOD, self._look, clock=steady)

    def _tick(self) -> None:
        self._data.take()
        self.scope.advance()

    def _look(self) -> None:
        self._data.look()
        self.board.tell(data=self._data.status(), present=self._controls.present(self._data.subscriptions))

    def _on_estimate(self, message: Estimate) -> None:
        self._estimate = message
        self.board.tell(estimated=results.to_estimated(message))
        self._choose()

    def _on_diagnosis(self, message: Diagnosis) -> None:
        self._diagnosis = message
        self.board.tell(diagnosed=results.to_diagnosed(message))
        self._choose()

    def _choose(self) -> None:
        """Run the newer model of the two."""
        beside, problem = results.chosen(self._estimate, self._diagnosis)
        if problem:
            self.board.say(False, problem)
        self.scope.run_beside(beside)
        self.board.tell(beside=beside.label if beside else "")
