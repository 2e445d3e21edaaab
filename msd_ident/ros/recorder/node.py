"""The recorder node: any topics, as raw bytes, into a rosbag2 folder; start and stop by service and by signal."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.clock import Clock, ClockType
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.validate_topic_name import validate_topic_name
from std_srvs.srv import Trigger

from msd_ident.errors import MsdError, UsageError
from msd_ident.io.writer import Compression
from msd_ident.ros.common import diagnostics_status, names
from msd_ident.ros.common.codes import code_of
from msd_ident.ros.common.fault_log import FaultLog
from msd_ident.ros.common.message_batching import Poller
from msd_ident.ros.common.node_runner import NodeOwner
from msd_ident.ros.common.parameters import Settings, declared
from msd_ident.ros.common.path_sandbox import Place
from msd_ident.ros.recorder.recording import QueueLimits, Recording, Summary
from msd_ident.ros.recorder.resuming import Interrupted, Notebook
from msd_ident.ros.recorder.subscriptions import Following, Wanted
from msd_interfaces.srv import StartRecording

COMPRESSIONS: tuple[Compression, ...] = ("zstd", "none")

SETTINGS = declared("recorder")

#: How often the graph is looked at for new topics [s].
LOOK_PERIOD = 0.1


class Recorder(NodeOwner):
    """Owns the node and the recording in progress.

    Args:
        overrides: parameters that go before those of the command line.
        node_options: further arguments of ``rclpy.node.Node`` (a context, arguments of a test).

    Raises:
        MsdError: ``autostart`` and the bag cannot be made.
    """

    def __init__(self, overrides: list[Parameter] | None = None, **node_options: Any) -> None:
        self.node = Node("recorder", parameter_overrides=overrides, **node_options)
        self.settings = Settings(self.node, SETTINGS)
        self.watch = FaultLog(self.settings["remember"])
        self._log = self.node.get_logger()
        self._recording: Recording | None = None
        self._last: Summary | None = None
        self._wanted: frozenset[str] | None = frozenset()
        self._following: Following | None = None
        self._poller = Poller(self.node)
        node, steady = self.node, Clock(clock_type=ClockType.STEADY_TIME)
        self._diagnostics = diagnostics_status.DiagnosticsPublisher(node, self.settings["hardware_id"])
        many = names.service_qos()
        node.create_service(StartRecording, names.private(names.RECORDER_START), self._on_start, qos_profile=many)
        node.create_service(Trigger, names.private(names.RECORDER_STOP), self._on_stop, qos_profile=many)
        node.create_timer(LOOK_PERIOD, self._look, clock=steady)
        node.create_timer(self.settings["diagnostics_period"], self._diagnose, clock=steady)
        self._notebook = Notebook(Place(self.settings["bag_folder"]).root, node.get_fully_qualified_name())
        left = self._notebook.left() if self.settings["resume"] else None
        if left is not None:
            self._log.warning(
                "the recorder died during a recording; it continues in a new bag (msd repair completes the other)"
            )
            self.start("", left.topics, left.every, left.compression)
        elif self.settings["autostart"]:
            self.start(self.settings["folder"])

    @property
    def summary(self) -> Summary | None:
        """Of the recording in progress, or else of the last one."""
        return self._recording.summary if self._recording else self._last

    @property
    def failure(self) -> str:
        """Why the last recording is not complete; empty when it is."""
        return self._last.error if self._last else ""

    def on_signal(self, number: int) -> None:
        """SIGUSR1 starts a recording with the parameters, SIGUSR2 stops it."""
        try:
            if number == signal.SIGUSR1:
                self.start("")
            elif number == signal.SIGUSR2:
                self.stop()
        except MsdError as error:
            self._log.warning(str(error))

    def close(self) -> bool:
        """Finish the bag in progress."""
        if self._recording:
            self.stop()
        return True

    def start(self, folder: str, topics: Sequence[str] = (), every: bool = False, compression: str = "") -> Path:
        """Start a recording; empty arguments are taken from the parameters. The bag's folder.

        Raises:
            UsageError: one is in progress, the folder exists or lies elsewhere, or a word is unknown.
            SetupError: the disk does not take it.
        """
        if self._recording:
            raise UsageError(f"already recording to {self._recording.folder}; expected recorder/stop first")
        chosen = _compression(compression or self.settings["compression"])
        every = every or (self.settings["all_topics"] and not topics)
        listed = list(topics or self.settings["topics"])
        self._wanted = None if every else frozenset(self._resolved(topic) for topic in listed)
        path = self._place(folder)
        self._recording = Recording(path, chosen, self.settings["queue_megabytes"] * 2**20, self._limits())
        self._notebook.begin(Interrupted(() if every else tuple(self._wanted or ()), every, chosen))
        wanted = Wanted(self._wanted, self.settings["queue_depth"])
        self._following = Following(self.node, self._recording, wanted, self.watch, self._poller)
        self._look()
        what = "all topics" if every else ", ".join(sorted(self._wanted or ()))
        self._log.info(f"recording {what} to {path}")
        return path

    def stop(self) -> Summary:
        """Finish the recording; what it holds. In the executor's thread, or when nothing spins: a message taken there
        and not handed over yet would come after those that are drained here.

        Raises:
            UsageError: there is none.
        """
        if self._recording is None:
            raise UsageError("no recording in progress; expected recorder/start first")
        if self._following is not None:
            self._following.close()
            self._following = None
        self._last = self._recording.close()
        self._notebook.end()
        self._recording = None
        diagnostics_status.log(self._log, not self._last.error, f"stopped: {self._last.sentence}")
        return self._last

    def _limits(self) -> QueueLimits:
        of = self.settings
        return QueueLimits(of["sync_period"], of["split_megabytes"] * 2**20, of["split_seconds"])

    def _resolved(self, topic: str) -> str:
        if not topic:
            raise UsageError("a topic without a name; expected one such as force or /joint_states")
        try:
            return str(self.node.resolve_topic_name(topic))
        except Exception as error:
            raise _no_topic(topic, error) from None

    def _place(self, folder: str) -> Path:
        """Where the bag goes: below the recorder's bag folder, also through links and dots."""
        place = Place(self.settings["bag_folder"])
        return place.new(folder) if folder else place.automatic("msd")

    def _look(self) -> None:
        if self._following is not None:
            self._following.look()

    def _on_start(self, request: StartRecording.Request, response: StartRecording.Response) -> StartRecording.Response:
        try:
            path = self.start(request.folder, request.topics, request.all_topics, request.compression)
        except MsdError as error:
            response.success, response.message, response.code = False, str(error), code_of(error)
            return response
        subscribed = self._following.subscriptions if self._following else {}
        waiting = sorted((self._wanted or frozenset()) - set(subscribed))
        later = f"; as soon as they come: {', '.join(waiting)}" if waiting else ""
        response.success, response.path = True, str(path)
        response.message = f"recording {len(subscribed)} topics to {path}{later}"
        return response

    def _on_stop(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        try:
            summary = self.stop()
            response.success, response.message = not summary.error, summary.sentence
        except MsdError as error:
            response.success, response.message = False, str(error)
        return response

    def _diagnose(self) -> None:
        summary = self.summary
        level, sentence = DiagnosticStatus.OK, "not recording"
        values: dict[str, object] = {}
        if summary is not None:
            state = "recording" if self._recording else "recorded"
            sentence = f"{state}: {summary.sentence}"
            for topic, count in summary.topics.items():
                values[topic] = count.received
                values |= diagnostics_status.topic_values(topic, count, count.lost)
            odd = [*self.watch.recent, *(self._silences(summary) if self._recording else ())]
            level = DiagnosticStatus.WARN if summary.lost or odd else level
            level = DiagnosticStatus.ERROR if summary.error else level
            sentence = "; ".join((sentence, *odd[: diagnostics_status.MOST_SENTENCES]))
        values |= diagnostics_status.fault_values(self.watch)
        self._diagnostics.publish(diagnostics_status.status(self._diagnostics.name("bag"), level, sentence, values))

    def _silences(self, summary: Summary) -> Iterator[str]:
        """Topics that came in a stream and do no more."""
        for topic, count in tuple(summary.topics.items()):
            if count.silence:
                yield diagnostics_status.silence(topic, count)


def check_request(bag: Path | None, topics: Sequence[str], compression: str) -> None:
    """Refuse what a recording would refuse, before anybody waits for a graph.

    Raises:
        UsageError: the bag exists, or a word makes no sense.
    """
    _compression(compression)
    if bag is not None:
        Place(str(bag.parent)).new(bag.name)
    for topic in topics:
        try:
            validate_topic_name(topic)
        except InvalidTopicNameException as error:
            raise _no_topic(topic, error) from None


def _no_topic(topic: str, error: Exception) -> UsageError:
    return UsageError(f"topic {topic!r}: {str(error).splitlines()[0]}; expected a ROS topic name")


def _compression(word: str) -> Compression:
    for known in COMPRESSIONS:
        if word == known:
            return known
    raise UsageError(f"compression is {word!r}; expected one of {', '.join(COMPRESSIONS)}")
