"""Monitoring of the identifier's estimates for changes: kept in a file, reported on ``/diagnostics``."""

from __future__ import annotations

import math
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.node import Node
from sensor_msgs.msg import Temperature

from msd_ident.errors import MsdError
from msd_ident.ros.common import diagnostics_status
from msd_ident.ros.common.parameters import Settings, topic_name

if TYPE_CHECKING:
    from msd_ident.workflow.identification import Identification


class Monitoring:
    """Keeps estimates and says whether they changed.

    Args:
        node: that the estimates are of.
        settings: the node's parameters.

    Raises:
        SetupError: the file is of something else.
    """

    def __init__(self, node: Node, settings: Settings) -> None:
        from msd_ident.monitoring.history import History

        self._temperature, self._problem = math.nan, ""
        self._history: History | None = None
        if not settings["history_file"]:
            return
        folder = Path(settings["bag_folder"]).expanduser()
        folder.mkdir(parents=True, exist_ok=True)
        topic = settings["temperature"]
        if topic:
            topic = topic_name(node, topic, f"temperature is {topic!r}", "a topic's name such as /motor/temperature")
            node.create_subscription(Temperature, topic, self._on_temperature, 10)
        self._history = History(
            folder / settings["history_file"],
            settings["history_size"],
            settings["false_alarm_estimates"],
            ("temperature",) if topic else (),
        )

    def add(self, found: Identification, made_ns: int) -> None:
        """Take a further estimate; an error of the disk is reported on ``/diagnostics``."""
        from msd_ident.monitoring.watching import Sample

        if self._history is None:
            return
        known = {name: q for name, q in found.refined.parameters.items() if math.isfinite(q.std) and q.std > 0.0}
        when = datetime.fromtimestamp(made_ns / 1e9, timezone.utc)
        sample = Sample(
            made_ns / 1e9,
            when.isoformat(timespec="seconds"),
            {name: q.value for name, q in known.items()},
            {name: q.std for name, q in known.items()},
            covariates={"temperature": self._temperature},
        )
        try:
            self._history.add(sample)
            self._problem = ""
        except MsdError as error:
            self._problem = str(error)

    def note(self) -> None:
        """Somebody took note of an alarm."""
        if self._history is not None:
            self._history.note()

    def status(self, name: str) -> DiagnosticStatus | None:
        """Status for ``/diagnostics``; ``None`` where no file is kept."""
        if self._history is None:
            return None
        stands = self._history.standing
        values: dict[str, object] = {
            "estimates since monitoring started": stands.estimates,
            "estimates kept": stands.kept,
            "alarm statistic M": f"{stands.statistic:.6g}",
            "alarm threshold": f"{stands.threshold:g}",
        }
        level = diagnostics_status.WARN if stands.alarm or self._problem else diagnostics_status.OK
        return diagnostics_status.status(name, level, self._problem or stands.sentence, values)

    def _on_temperature(self, message: Temperature) -> None:
        self._temperature = float(message.temperature)
