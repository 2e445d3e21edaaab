"""The identifier keeps its estimates in a file, and says on /diagnostics whether they changed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from sensor_msgs.msg import Temperature  # noqa: E402

import msd_sim.api  # noqa: E402
from msd_ident.errors import SetupError  # noqa: E402
from msd_ident.monitoring.history import History  # noqa: E402
from msd_ident.monitoring.watching import Sample  # noqa: E402
from msd_ident.ros.identifier.node import Identifier, Request  # noqa: E402


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def identifier(ros: Graph, folder: Path, **parameters: object) -> Identifier:
    given = {"bag_folder": str(folder), "history_file": "arm.json", "diagnostics_period": 0.1, "auto_fit": False}
    overrides = [Parameter(name, value=value) for name, value in {**given, **parameters}.items()]
    made: Identifier = ros.add(Identifier(overrides, context=ros.context))
    return made


def filled(node: Identifier) -> None:
    """Put an experiment into the live buffer, as messages would."""
    made = msd_sim.api.simulate({"rig": "ecp", "experiment": "paper", "rate": 200.0})
    start = 1_700_000_000_000_000_000
    for at, value in zip(made.force_time.tolist(), made.force.tolist(), strict=True):
        node.buffer.add_force(start + round(at * 1e9), value)
    for at, value in zip(made.time.tolist(), made.position.tolist(), strict=True):
        node.buffer.add_position(start + round(at * 1e9), value)


def test_estimates_are_kept_and_watched(ros: Graph, tmp_path: Path) -> None:
    heard: list[DiagnosticStatus] = []
    ros.node.create_subscription(
        DiagnosticArray, "/diagnostics", lambda m: heard.extend(s for s in m.status if s.name.endswith("watch")), 10
    )
    node = identifier(ros, tmp_path, temperature="motor/temperature")
    warm = ros.node.create_publisher(Temperature, "motor/temperature", 10)
    until(warm.get_subscription_count, "somebody who listens to the temperature")
    filled(node)
    warm.publish(Temperature(temperature=31.5))
    until(lambda: node._monitoring._temperature == 31.5, "the temperature")
    for _ in range(2):
        outcome = node.identify(Request())
        assert outcome.success, outcome.message
    until(lambda: heard and "no change in 2 estimates" in heard[-1].message, "a status of the watch")
    assert heard[-1].level == DiagnosticStatus.OK
    assert {value.key for value in heard[-1].values} >= {"alarm statistic M", "alarm threshold", "estimates kept"}
    kept = json.loads((tmp_path / "arm.json").read_text())["estimates"]
    assert [one["covariates"] for one in kept] == [{"temperature": 31.5}] * 2
    assert kept[0]["values"]["stiffness"] == pytest.approx(694.0, rel=0.01)


def test_an_alarm_is_a_warning_until_somebody_takes_note(ros: Graph, tmp_path: Path) -> None:
    history = History(tmp_path / "arm.json", 1000, 1000.0)
    for number in range(40):
        stiffness = 694.0 + (number % 7) - 25.0 * (number >= 30)
        history.add(Sample(float(number), f"estimate {number}", {"stiffness": stiffness}, {}))
    heard: list[DiagnosticStatus] = []
    ros.node.create_subscription(
        DiagnosticArray, "/diagnostics", lambda m: heard.extend(s for s in m.status if s.name.endswith("watch")), 10
    )
    node = identifier(ros, tmp_path)
    until(lambda: heard, "a status of the watch")
    assert heard[-1].level == DiagnosticStatus.WARN and "stiffness changed by -" in heard[-1].message
    node._monitoring.note()
    until(lambda: heard[-1].level == DiagnosticStatus.OK, "an alarm that was taken note of")


def test_a_file_of_something_else_is_refused(ros: Graph, tmp_path: Path) -> None:
    (tmp_path / "arm.json").write_text("no")
    with pytest.raises(SetupError, match="expected a history of estimates"):
        identifier(ros, tmp_path)
