"""Forces that came after the instant at which they should act: told in the log and on ``/diagnostics``."""

from __future__ import annotations

import time

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from msd_sim import names

#: Values of the status: forces that came late since the status before, and by how much [s].
LATE, LATE_WORST = "late forces since the last status", "greatest delay of these [s]"
#: Least time between two log lines of one kind [s].
QUIET = 5.0
#: Time between two statuses, and where forces came late since the last one [s].
USUAL, SOON = 1.0, 0.1


class Lateness:
    """Counts late forces and tells of them.

    Attributes:
        count: late forces so far.
    """

    def __init__(self, node: Node) -> None:
        self.count = 0
        self._node = node
        self._since, self._worst, self._told = 0, 0.0, time.monotonic()
        self._publisher = node.create_publisher(DiagnosticArray, names.DIAGNOSTICS, 10)

    def add(self, behind: float) -> None:
        """A force came so much too late [s]."""
        self.count += 1
        self._since += 1
        self._worst = max(self._worst, behind)
        many = f"{self.count} forces came late and act" if self.count > 1 else "1 force came late and acts"
        self._node.get_logger().warning(
            f"{many} from now on (the last one {behind:.3f} s); expected stamps of the rig's clock, at most the "
            "parameter latency old: does the sender use the same clock?",
            throttle_duration_sec=QUIET,
        )

    def tell(self) -> None:
        """Publish a status when it is time; to be called often."""
        now = time.monotonic()
        if now - self._told < (SOON if self._since else USUAL):
            return
        self._told = now
        place = f"{self._node.get_namespace().rstrip('/')}/{self._node.get_name()}".lstrip("/")
        values = {LATE: self._since, LATE_WORST: self._worst, "late forces": self.count}
        many = f"{self._since} force{'s' if self._since > 1 else ''}"
        status = DiagnosticStatus(
            level=DiagnosticStatus.WARN if self._since else DiagnosticStatus.OK,
            name=f"{place}: forces",
            message=f"{many} came late, by up to {self._worst:.3g} s" if self._since else "in time",
            hardware_id=self._node.get_namespace().strip("/") or names.NODE,
            values=[KeyValue(key=key, value=f"{value:.9g}") for key, value in values.items()],
        )
        message = DiagnosticArray(status=[status])
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)
        self._since, self._worst = 0, 0.0
