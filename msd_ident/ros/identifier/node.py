"""The identifier node: a live buffer, a fit when a step has settled or when asked, the estimate for everybody."""

from __future__ import annotations

import traceback
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from msd_ident.cancellation import Cancelled
from msd_ident.errors import MsdError
from msd_ident.ros.common import codes, diagnostics_status, names
from msd_ident.ros.common.codes import code_of
from msd_ident.ros.common.fault_log import FaultLog
from msd_ident.ros.common.inputs import Input, Sink, wanted
from msd_ident.ros.common.live_buffer import LiveBuffer, Units
from msd_ident.ros.common.message_batching import Poller
from msd_ident.ros.common.node_runner import NodeOwner
from msd_ident.ros.common.parameters import Settings, declared
from msd_ident.ros.common.worker import Worker
from msd_ident.ros.identifier import monitoring
from msd_ident.ros.identifier.diagnose_action import Diagnosing
from msd_ident.ros.identifier.request_records import Part, Sources, options
from msd_ident.ros.identifier.step_detection import Settling, StepWatcher
from msd_interfaces.msg import Estimate
from msd_interfaces.srv import Identify

SETTINGS = declared("identifier")

#: How often the graph and the steps are looked at [s].
LOOK_PERIOD = 0.1


@dataclass(frozen=True)
class Request:
    """What is to be identified: the live buffer or a bag, all of it or a part [s], with which plant."""

    bag_path: str = ""
    start: float = 0.0
    end: float = 0.0
    model: str = ""


@dataclass(frozen=True)
class Reply:
    """What came of a request, in a sentence; the estimate when it is a success, and what makes it doubtful."""

    success: bool
    message: str
    estimate: Estimate | None = None
    doubt: str = ""
    code: int = codes.DONE


_ENDS = Reply(False, "stopped: the identifier ends", code=codes.CANCELLED)


class Identifier(NodeOwner):
    """Owns the node, its buffer and its worker thread.

    Args:
        overrides: parameters that go before those of the command line.
        node_options: further arguments of ``rclpy.node.Node`` (a context, arguments of a test).
    """

    def __init__(self, overrides: list[Parameter] | None = None, **node_options: Any) -> None:
        self.node = Node("identifier", parameter_overrides=overrides, **node_options)
        self.settings = Settings(self.node, SETTINGS)
        s = self.settings
        self.watch = FaultLog(s["remember"])
        self._read = options(s)
        self.buffer = LiveBuffer(
            s["buffer_samples"],
            hold=s["hold"],
            units=Units(self._read.as_force[0], self._read.as_position[0]),
            free=self._read.no_force,
            watch=self.watch,
        )
        self.watcher = StepWatcher(s["step_threshold"])
        self.worker = Worker("fit")
        self._diagnoses = Worker("diagnose", behind=self.worker)
        self._fitting_step = False
        self._last = Reply(True, "no estimate yet")
        self._log = self.node.get_logger()
        self.inputs = self._make_inputs()
        self._sources = Sources(s, self.buffer, self.inputs)
        self._make_outputs()
        self._diagnosing = Diagnosing(self.node, self._diagnoses, self._sources, s)
        self._monitoring = monitoring.Monitoring(self.node, s)
        self.worker.submit(self._prepare)

    def release(self) -> bool:
        """Drop fits that wait, stop the one in progress, and answer all who asked for them."""
        busy = self.worker.busy or self._diagnoses.busy
        for worker in (self.worker, self._diagnoses):
            worker.close()
        self._diagnosing.release()
        return busy

    def close(self) -> bool:
        """Drop fits that wait, stop the one in progress; whether it ended in time."""
        ended = all([self.worker.close(), self._diagnoses.close()])
        self._diagnosing.close()
        return ended

    def identify(self, request: Request) -> Reply:
        """Fit what is asked for, in the calling thread; nothing that the data does can raise from here."""
        try:
            return self._identify(request)
        except MsdError as error:
            return Reply(False, str(error), code=code_of(error))
        except Cancelled:
            return _ENDS
        except Exception as error:
            message, code = codes.internal(error, self._log)
            return Reply(False, message, code=code)

    def _make_inputs(self) -> dict[str, list[Input]]:
        poller = Poller(self.node)
        sink = Sink(self.buffer, self.watcher, self.watch)
        depth = self.settings["queue_depth"]

        def made(what: Literal["force", "position"]) -> list[Input]:
            _, factor = self._read.as_force if what == "force" else self._read.as_position
            signals = wanted(what, self.settings[what], factor)
            return [Input(self.node, signal, sink, depth, poller) for signal in signals]

        return {"force": made("force"), "position": made("position")}

    def _make_outputs(self) -> None:
        # Services wait for the worker as coroutines; the reentrant group lets others go on meanwhile.
        group = ReentrantCallbackGroup()
        node, steady = self.node, Clock(clock_type=ClockType.STEADY_TIME)
        self._estimate = node.create_publisher(Estimate, names.private(names.ESTIMATE), names.latest_qos())
        self._diagnostics = diagnostics_status.DiagnosticsPublisher(node, self.settings["hardware_id"])
        many = {"qos_profile": names.service_qos(), "callback_group": group}
        node.create_service(Identify, names.private(names.IDENTIFY), self._on_identify, **many)
        node.create_service(Trigger, names.private(names.TRIGGER), self._on_trigger, **many)
        node.create_service(Trigger, names.private(names.CLEAR), self._on_clear, **many)
        # Steady timers go on when simulated time stands still.
        node.create_timer(LOOK_PERIOD, self._look, clock=steady)
        node.create_timer(self.settings["diagnostics_period"], self._tell_health, clock=steady)

    def _prepare(self) -> None:
        """Load and compile the solver while nobody waits for it."""
        try:
            from msd_ident.model import warm_up
            from msd_ident.workflow import pipeline  # noqa: F401

            warm_up()
        except Cancelled:
            pass
        except Exception:
            self._log.error(traceback.format_exc())

    async def _on_identify(self, request: Identify.Request, response: Identify.Response) -> Identify.Response:
        asked = Request(request.bag_path, request.start, request.end, request.model)
        outcome = await self._answer(asked)
        response.success, response.message, response.code = outcome.success, outcome.message, outcome.code
        if outcome.estimate is not None:
            response.estimate = outcome.estimate
        else:
            codes.with_nan(response.estimate)
        return response

    async def _on_trigger(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        outcome = await self._answer(Request())
        response.success, response.message = outcome.success, outcome.message
        return response

    def _on_clear(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        forgotten = self.buffer.position.size
        self.buffer.clear()
        self.watcher.forget()
        self._monitoring.note()
        response.success = True
        response.message = f"{forgotten} position samples deleted; the live buffer is empty"
        return response

    async def _answer(self, asked: Request) -> Reply:
        """Reply of a request; those that ask for the same while it waits share it."""
        try:
            work = self.worker.submit(partial(self._fit, asked), self.node.executor, key=asked)
        except MsdError as error:
            return Reply(False, str(error), code=codes.BUSY)
        return await work or _ENDS

    def _look(self) -> None:
        for entry in (*self.inputs["force"], *self.inputs["position"]):
            entry.look()
        if self.settings["auto_fit"] and not self._fitting_step and self._step_settled():
            self._fitting_step = True
            self.worker.submit(self._fit_step)

    def _step_settled(self) -> bool:
        pending = self.watcher.pending
        if not pending or not self.buffer.position.size:
            return False
        rule = Settling(self.settings["settle_time"], self.settings["settle_band"])
        since = (self.buffer.position.newest_ns - pending[0]) / 1e9
        return since >= rule.seconds and self.watcher.take_settled(*self.buffer.recent(since + rule.seconds), rule)

    def _fit_step(self) -> None:
        try:
            self._fit(Request())
        finally:
            self._fitting_step = False

    def _fit(self, request: Request) -> Reply:
        """Fit and tell everybody, in the worker's thread."""
        outcome = self.identify(request)
        if not request.bag_path:
            self._last = outcome
            if outcome.estimate is not None:
                self._estimate.publish(outcome.estimate)
        diagnostics_status.log(self._log, outcome.success, outcome.message)
        return outcome

    def _identify(self, request: Request) -> Reply:
        from msd_ident.ros.common.result_messages import sentence, to_estimate
        from msd_ident.workflow import pipeline

        chosen = pipeline.Options(model=request.model or self.settings["model"])
        sources = self._sources
        record = sources.record(request.bag_path, Part(request.start, request.end))
        found = pipeline.identify([record], chosen)
        made_ns = self.node.get_clock().now().nanoseconds
        estimate = to_estimate(found, request.bag_path or "live", made_ns, sources.frame)
        if not request.bag_path:
            self._monitoring.add(found, made_ns)
        notes = {note for used in found.records for note in used.notes}
        doubt = "; ".join(
            [warning for warning in found.warnings if warning not in notes][: diagnostics_status.MOST_SENTENCES]
        )
        return Reply(True, sentence(estimate), estimate, doubt)

    def _tell_health(self) -> None:
        inputs, name = self.inputs, self._diagnostics.name
        data = diagnostics_status.data_status(
            name("data"), self.buffer, inputs["force"], inputs["position"], self.watch
        )
        level = diagnostics_status.OK if self._last.success and not self._last.doubt else diagnostics_status.WARN
        estimate = diagnostics_status.status(name("estimate"), level, self._last.doubt or self._last.message, {})
        model = self._diagnosing.status(name("model"))
        monitored = self._monitoring.status(name("watch"))
        self._diagnostics.publish(data, estimate, model, *([] if monitored is None else [monitored]))
