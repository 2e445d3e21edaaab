"""The rig as a ROS 2 node: answers ``force``, publishes ``encoder`` (``encoder_batch`` above 2000 samples a second).

A force acts from the stamp of its header on, exactly: the rig computes its samples ``latency`` behind the clock, so
that a force is there before the instant at which it acts. Samples fall on exact ticks, start + i * period, however late
the timer wakes up. In the time mode ``fast`` the rig makes the time: it publishes ``/clock``, ``real_time_factor``
times as fast as the wall, and everybody else runs with ``use_sim_time``.
"""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import WrenchStamped
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock as ClockMessage
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from msd_interfaces.msg import EncoderBatch
from msd_sim import config, effects, names
from msd_sim.effects import RigParameter
from msd_sim.encoder import PARAMETERS as ENCODER_PARAMETERS
from msd_sim.encoder import EncoderReader
from msd_sim.errors import RigError
from msd_sim.rig import Rig

NANO = 1_000_000_000

#: Defaults of the paper's rig, where they differ from "none".
_DEFAULTS = {"friction_coefficient": 0.0133, "encoder.counts_per_metre": 226600.0}
_TIMING = (
    RigParameter("latency", "s", 0.005, 0.0, 1.0, "how far the rig stays behind the clock, so that no force is late"),
    RigParameter("real_time_factor", "", 10.0, 1e-3, 1e3, "speed of the clock in the time mode fast"),
)
_READ_ONLY = ("rate", "seed", "time_mode", "real_time_factor", "batch_size", "joint_name")

#: Wall time between two wakes of the rig [s], and the longest pause that it makes up for sample by sample.
WAKE_SINGLE, WAKE_BATCH, LONGEST_PAUSE = 0.002, 0.005, 2.0


def _numbers() -> Iterator[tuple[str, RigParameter]]:
    """All parameters that are numbers, by their ROS names."""
    for parameter in (*effects.PLANT, *config.FRICTION, config.RATE, *_TIMING):
        yield parameter.name, parameter
    for parameter in ENCODER_PARAMETERS:
        yield f"encoder.{parameter.name}", parameter
    for effect in effects.ALL.values():
        for parameter in effect.parameters:
            yield f"{effect.name}.{parameter.name}", parameter


def _samples_per_second(values: dict[str, Any]) -> float:
    """Samples per second of the wall's time."""
    return float(values["rate"]) * (float(values["real_time_factor"]) if values["time_mode"] == "fast" else 1.0)


class RigNode(Node):
    """The plant simulator.

    Raises:
        RigError: parameters that make no sense.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(names.NODE, **options)
        self._declare()
        self._values = {name: self.get_parameter(name).value for name in self._names}
        self._config = self._checked(self._values)
        self._period_ns = round(NANO / self._config.rate)
        self._fast = self._values["time_mode"] == "fast"
        self._factor = float(self._values["real_time_factor"]) if self._fast else 1.0
        self.get_logger().info("preparing the rig (compiled once, at the first start: about 10 s)")
        self._rig = Rig(self._config.truth)
        self._rig.sample([0.0])
        self._reader = EncoderReader(self._config.encoder, self._config.seed)
        self.late = 0
        self.stopping = False
        self._connect()
        self._start()

    # -- parameters

    def _declare(self) -> None:
        self._names = [name for name, _ in _numbers()]
        for name, parameter in _numbers():
            span = FloatingPointRange(from_value=parameter.lower, to_value=parameter.upper, step=0.0)
            self._declare_one(name, _DEFAULTS.get(name, parameter.default), parameter.meaning, parameter.unit, [span])
        known = ", ".join(effects.ALL)
        self._declare_one("effects", [], f"effects that the rig has: any of {known}; each has its parameters beside")
        self._declare_one("time_mode", "real_time", "real_time, or fast: the rig publishes /clock")
        self._declare_one("joint_name", names.JOINT, "name of the joint in encoder messages")
        whole = ParameterDescriptor(description="seed of the encoder's noise", read_only=True)
        whole.integer_range = [IntegerRange(from_value=0, to_value=2**62, step=1)]
        self.declare_parameter("seed", 0, whole)
        whole = ParameterDescriptor(
            description=f"samples in a batch, above {names.MOST_SINGLE:g} a second", read_only=True
        )
        whole.integer_range = [IntegerRange(from_value=1, to_value=100_000, step=1)]
        self.declare_parameter("batch_size", 100, whole)
        self._names += ["effects", "time_mode", "joint_name", "seed", "batch_size"]
        given = set(getattr(self, "_parameter_overrides", ())) - {*self._names, "use_sim_time"}
        if given:  # a file for all nodes may hold those of others, so this is no error
            self.get_logger().warning(f"parameters that a rig has not: {', '.join(sorted(given))}; check the spelling")

    def _declare_one(
        self, name: str, value: Any, meaning: str, unit: str = "", span: list[FloatingPointRange] | None = None
    ) -> None:
        # Dynamic typing: 1 is as good a mass as 1.0, and an empty list has no type in ROS.
        descriptor = ParameterDescriptor(
            description=meaning + (f" [{unit}]" if unit else ""),
            read_only=name in _READ_ONLY,
            dynamic_typing=True,
            floating_point_range=span or [],
        )
        self.declare_parameter(name, value, descriptor)

    @staticmethod
    def _checked(values: dict[str, Any]) -> config.RigConfig:
        """The rig that these parameter values describe."""
        for parameter in _TIMING:
            parameter.checked(values[parameter.name], names.NODE)
        if values["time_mode"] not in ("real_time", "fast"):
            raise RigError(f"time_mode is {values['time_mode']!r}; expected 'real_time' or 'fast'")
        chosen = [str(name) for name in values["effects"] or () if name]
        leave_out = [*(p.name for p in _TIMING), "time_mode", "joint_name", "batch_size"]
        unused = set(effects.ALL) - set(chosen)
        kept = {n: v for n, v in values.items() if n not in leave_out and n.split(".")[0] not in unused}
        rig = config.parse(kept | {"effects": chosen})
        often = _samples_per_second(values)
        if often > names.MOST_SINGLE and rig.encoder.jitter > 0.0:
            raise RigError(
                f"encoder jitter at {often:g} samples a second; expected none above {names.MOST_SINGLE:g}, where one "
                "stamp stands for a batch"
            )
        return rig

    def _refuse_nonsense(self, parameters: list[Parameter]) -> SetParametersResult:
        try:
            self._checked(self._values | {p.name: p.value for p in parameters if p.name in self._names})
        except RigError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply(self, parameters: list[Parameter]) -> None:
        changed = {p.name: p.value for p in parameters if p.name in self._names}
        if not changed:
            return
        self._values |= changed
        self._config = self._checked(self._values)
        self._rig.change(self._config.truth)
        self._reader.encoder = self._config.encoder

    # -- the graph

    def _connect(self) -> None:
        self.add_on_set_parameters_callback(self._refuse_nonsense)
        self.add_post_set_parameters_callback(self._apply)
        kept = QoSProfile(depth=names.DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(WrenchStamped, names.FORCE, self._on_force, kept)
        self.create_service(Trigger, names.RESET, self._on_reset)
        self._batched = _samples_per_second(self._values) > names.MOST_SINGLE
        if self._batched:
            self._batch = EncoderBatch(name=self._values["joint_name"], period_ns=self._period_ns)
            self._batches = self.create_publisher(EncoderBatch, names.ENCODER_BATCH, names.DEPTH)
        else:
            self._sample = JointState(name=[self._values["joint_name"]], position=[0.0])
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
        mode = f"{self._factor:g} times as fast as the wall" if self._fast else "real time"
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
            self.get_logger().warning(f"force refused: {error}")
            return
        if not in_time and stamp >= self._first_ns:
            self.late += 1
            behind = self._rig.time - acts / NANO
            self.get_logger().warning(
                f"{self.late} forces came late and act from now on (the last one {behind:.3f} s); expected stamps of "
                "the rig's clock, at most the parameter latency old: does the sender use the same clock?",
                throttle_duration_sec=5.0,
            )

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
        if self.stopping:
            rclpy.try_shutdown(context=self.context)
            return
        self._make_time()
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
            self.get_logger().warning(f"the clock jumped by {missed * self._period_ns / NANO:.3f} s; no samples there")
            self._next = due - 1

    def _read(self, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Index, stamp [ns] and reading of the next samples, those that the encoder loses left out."""
        index = self._next + np.arange(count)
        ticks = self._first_ns + index * self._period_ns
        instants = (ticks - self._zero_ns) / NANO
        try:
            motion = self._rig.sample(np.maximum(instants - self._config.encoder.delay, self._rig.time))
        except RigError as error:
            self.get_logger().error(f"{error}; the cart is put back to zero")
            self._zero_ns += round((instants[0] - self._rig.time) * NANO)
            self._reset()
            self._next += count
            return index[:0], ticks[:0], instants[:0]
        self._next += count
        readings = self._reader.read(self._config.truth.sensed(motion.time, motion.position))
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


def main(arguments: list[str] | None = None) -> int:
    """Run the rig until Ctrl-C or SIGTERM; exit code 0 then, 2 for parameters that make no sense."""
    node: list[RigNode] = []

    def stop(*_: Any) -> None:
        if not node:
            sys.exit(0)
        node[0].stopping = True

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node.append(RigNode())
    except (RigError, rclpy.exceptions.ParameterException) as error:
        print(f"rig: {' '.join(str(error).split())}", file=sys.stderr)
        rclpy.try_shutdown()
        return 2
    rclpy.spin(node[0])
    node[0].destroy_node()
    rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
