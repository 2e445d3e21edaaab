"""Forces that reached the rig after the instants at which they should act, as it reports on ``/diagnostics``."""

from __future__ import annotations

import math
from dataclasses import dataclass

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node

from msd_ident.quantity import counted
from msd_ident.ros.common import names

#: Values of a rig's status: forces that came late since the status before, and by how much [s].
LATE, LATE_WORST = "late forces since the last status", "greatest delay of these [s]"


@dataclass(frozen=True)
class Late:
    """Forces that came late at the rig.

    Attributes:
        count: of them.
        worst: greatest delay [s].
    """

    count: int = 0
    worst: float = 0.0

    @property
    def sentence(self) -> str:
        """What it means for the bag; empty where none came late."""
        if not self.count:
            return ""
        return (
            f"{counted(self.count, 'force')} came late at the rig, by up to {self.worst:.3g} s, and acted later than "
            "their stamps in the bag say: repeat the run on a machine that is less busy, or with a longer lead (--lead)"
        )


class LateForces:
    """Listens to what rigs of the node's namespace report.

    Args:
        node: to listen with.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._place = f"{node.get_namespace().strip('/')}/".lstrip("/")
        self._count, self._worst = 0, 0.0
        self._subscription = node.create_subscription(DiagnosticArray, names.DIAGNOSTICS, self._take, 10)

    def begin(self) -> None:
        """Count from now on."""
        self._count, self._worst = 0, 0.0

    @property
    def found(self) -> Late:
        """What was reported since ``begin``."""
        return Late(self._count, self._worst)

    def close(self) -> None:
        """Listen no longer."""
        self._node.destroy_subscription(self._subscription)

    def _take(self, message: DiagnosticArray) -> None:
        for status in message.status:
            values = {pair.key: pair.value for pair in status.values}
            if status.name.startswith(self._place) and LATE in values:
                self._count += int(_number(values[LATE]))
                self._worst = max(self._worst, _number(values.get(LATE_WORST, "")))


def _number(text: str) -> float:
    """A number of 0 or more; 0 for anything else that somebody may publish."""
    try:
        value = float(text)
    except ValueError:
        return 0.0
    return value if 0.0 < value < math.inf else 0.0
