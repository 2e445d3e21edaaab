"""The rig as a ROS 2 node: answers ``force``, publishes ``encoder`` (``encoder_batch`` above 2000 samples a second).

A force acts from the stamp of its header on, exactly: the rig computes its samples ``latency`` behind the clock, so
that a force is there before the instant at which it acts. Samples fall on exact ticks, start + i * period, however late
the timer wakes up. In the time mode ``fast`` the rig makes the time: it publishes ``/clock``, ``real_time_factor``
times as fast as real time, and everybody else runs with ``use_sim_time``.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import WrenchStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock as ClockMessage
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from msd_interfaces.msg import EncoderBatch
from msd_sim import names
from msd_sim.encoder import EncoderReader
from msd_sim.errors import RigError
from msd_sim.node import Stop, parameters
from msd_sim.node.commands import Commands
from msd_sim.node.lateness import Lateness
from msd_sim.rig import Rig

NANO = 1_000_000_000
#: Least time between two log lines of one kind [s].
QUIET = 5.0

#: Wall time between two wakes of the rig [s], and the longest pause that it makes up for sample by sample.
WAKE_SINGLE, WAKE_BATCH, LONGEST_PAUSE = 0.002, 0.005, 2.0


class RigNode(Node):
    """The plant simulator.

    Raises:
        RigError: parameters that make no sense.
    """

    def __init__(self, stop: Stop | None = None, **options: Any) -> None:
        super().__init__(names.NODE, **options)
        self._stop = stop or Stop()
        self._values = parameters.declare(self)
        self._config = parameters.checked(self._values)
        self._period_ns = round(NANO / self._config.rate)
        self._fast = self._values["time_mode"] == "fast"
        self._factor = float(self._values["real_time_factor"]) if self._fast else 1.0
        self._rig = Rig(self._config.truth)
        self._rig.sample([0.0])
        self._reader = EncoderReader(self._config.encoder, self._config.seed)
        self._late = Lateness(self)
        self._connect()
        self._start()

    @property
    def late(self) -> int:
        """Forces that came late so far."""
        return self._late.count

    # -- parameters

    def _refuse_nonsense(self, changes: list[Parameter]) -> SetParametersResult:
        try:
            parameters.checked(self._values | {p.name: p.value for p in changes if p.name in self._values})
        except RigError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply(self, changes: list[Parameter]) -> None:
        changed = {p.name: p.value for p in changes if p.name in self._values}
        if not changed:
            return
        self._values |= changed
        self._config = parameters.checked(self._values)
        self._rig.change(self._config.truth)
        self._reader.encoder = self._config.encoder

    # -- the graph

    def _connect(self) -> None:
        self.add_on_set_parameters_callback(self._refuse_nonsense)
        self.add_post_set_parameters_callback(self._apply)
        self._commands = Commands(self, self._rig, lambda: self._values, self._on_force, self._release)
        self.create_service(Trigger, "~/reset", self._on_reset)
        self._batched = parameters.samples_per_second(self._values) > names.MOST_SINGLE
        if self._batched:
            self._batch = EncoderBatch(name=self._values["joint_name"], period_ns=self._period_ns)
            self._batch.header.frame_id = self._values["frame_id"]
            self._batches = self.create_publisher(EncoderBatch, names.ENCODER_BATCH, names.DEPTH)
        else:
            self._sample = JointState(name=[self._values["joint_name"]], position=[0.0])
            self._sample.header.frame_id = self._values["frame_id"]
            self._samples = self.create_publisher(JointState, names.ENCODER, names.DEPTH)
        if self._fast:
            self._clocks = self.create_publisher(ClockMessage, names.CLOCK, names.CLOCK_DEPTH)

    def _start(self) -> None:
        """Set time zero and begin to tick on the wall's clock."""
        self._fast_ns, self._woke_ns = time.time_ns(), time.monotonic_ns()
        self._first_ns = self._zero_ns = self._now_ns()
        self._next = 0
        wake = WAKE_BATCH if self._batched else WAKE_SINGLE
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(wake, self._wake, clock=self._steady)
        mode = f"{self._factor:g} times as fast as real time" if self._fast else "real time"
        found = ", ".join(self._config.truth.effects) or "none"
        self.get_logger().info(f"rig at {NANO / self._period_ns:g} Hz, {mode}; effects: {found}")

    def _now_ns(self) -> int:
        if self._fast:
            return self._fast_ns
        return int(self.get_clock().now().nanoseconds)

    def _on_force(self, message: WrenchStamped) -> None:
        stamp = message.header.stamp.sec * NANO + message.header.stamp.nanosec
        acts = (stamp or self._now_ns()) - self._zero_ns
        try:
            in_time = self._rig.push(acts / NANO, message.wrench.force.x)
        except RigError as error:
            self.get_logger().warning(f"force refused: {error}", throttle_duration_sec=QUIET)
            return
        if not in_time and stamp >= self._first_ns:
            self._late.add(self._rig.time - acts / NANO)

    def _release(self) -> int:
        """Force 0 from now on; since when [ns]."""
        return self._zero_ns + round(self._rig.release() * NANO)

    def _on_reset(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._reset()
        response.success, response.message = True, "encoder at zero, cart at rest"
        return response

    def _reset(self) -> None:
        self._zero_ns += round(self._rig.time * NANO)
        self._rig.restart()
        self._reader = EncoderReader(self._config.encoder, self._config.seed)

    # -- time

    def _wake(self) -> None:
        """Compute and publish every sample that has become due."""
        if self._stop.asked:
            rclpy.try_shutdown(context=self.context)
            return
        self._make_time()
        self._commands.look()
        self._late.tell()
        if self._first_ns == 0:  # with use_sim_time, until the first message on /clock
            self._first_ns = self._zero_ns = self._now_ns()
        horizon = self._now_ns() - int(self._values["latency"] * self._factor * NANO)
        due = (horizon - self._first_ns) // self._period_ns + 1
        self._skip_a_long_pause(due)
        if self._batched:
            size = self._values["batch_size"]
            while due - self._next >= size:
                self._publish_batch(*self._read(size))
        elif due > self._next:
            self._publish_samples(*self._read(due - self._next))

    def _make_time(self) -> None:
        """In the time mode fast: move the clock on by the wall's time, by at most 50 ms of it, and tell everybody."""
        if not self._fast:
            return
        now = time.monotonic_ns()
        self._fast_ns += int(min(now - self._woke_ns, 50_000_000) * self._factor)
        self._woke_ns = now
        message = ClockMessage()
        message.clock.sec, message.clock.nanosec = divmod(self._fast_ns, NANO)
        self._clocks.publish(message)

    def _skip_a_long_pause(self, due: int) -> None:
        missed = due - self._next
        if missed * self._period_ns > LONGEST_PAUSE * self._factor * NANO:
            words = f"the clock jumped by {missed * self._period_ns / NANO:.3f} s; no samples there"
            self.get_logger().warning(words, throttle_duration_sec=QUIET)
            self._next = due - 1

    def _read(self, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Index, stamp [ns] and reading of the next samples, those that the encoder loses left out."""
        index = self._next + np.arange(count)
        ticks = self._first_ns + index * self._period_ns
        instants = (ticks - self._zero_ns) / NANO
        try:
            motion = self._rig.sample(np.maximum(instants - self._config.encoder.delay, self._rig.time))
        except RigError as error:
            self.get_logger().error(f"{error}; the cart is put back to zero", throttle_duration_sec=QUIET)
            self._zero_ns += round((instants[0] - self._rig.time) * NANO)
            self._reset()
            self._next += count
            return index[:0], ticks[:0], instants[:0]
        self._next += count
        readings = self._reader.read(self._config.truth.sensed(motion.time, motion.position), motion.velocity)
        jitter = self._reader.stamps(instants, self._period_ns / NANO) - instants
        stamps = ticks + np.round(jitter * NANO).astype(np.int64)
        kept = self._reader.arrives(count)
        return index[kept], stamps[kept], readings[kept]

    def _publish_samples(self, _index: np.ndarray, stamps: np.ndarray, readings: np.ndarray) -> None:
        message, stamp = self._sample, self._sample.header.stamp
        for at, reading in zip(stamps.tolist(), readings.tolist(), strict=True):
            stamp.sec, stamp.nanosec = divmod(at, NANO)
            message.position[0] = reading
            self._samples.publish(message)

    def _publish_batch(self, index: np.ndarray, stamps: np.ndarray, readings: np.ndarray) -> None:
        message, stamp = self._batch, self._batch.header.stamp
        for run in np.split(np.arange(index.size), np.flatnonzero(np.diff(index) > 1) + 1):
            if run.size:  # a batch ends where samples got lost
                stamp.sec, stamp.nanosec = divmod(int(stamps[run[0]]), NANO)
                message.sequence = int(index[run[0]])
                message.positions = readings[run]
                self._batches.publish(message)


def run(stop: Stop, arguments: Sequence[str] | None = None) -> None:
    """Make the node and let it run until it is asked to stop.

    Raises:
        RigError: arguments or parameters that make no sense.
    """
    try:
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:  # rclpy has several kinds for bad arguments, all with many lines
        raise RigError(f"ROS cannot start: {_one_line(error)}; expected valid --ros-args") from None
    try:
        node = RigNode(stop)
        parameters.check_given(node, sys.argv if arguments is None else arguments)
        rclpy.spin(node)
        node.destroy_node()
    except ParameterException as error:
        raise RigError(f"{_one_line(error)}; expected what the parameter's description says") from None
    finally:
        rclpy.try_shutdown()


def _one_line(error: Exception) -> str:
    return " ".join((str(error) or type(error).__name__).split()).rstrip(".")
