"""How long an identification of a 3 s window takes while a diagnosis runs beside it, in one identifier.

    .venv/bin/python -m bench.beside --calls 30

The identifier is a process of its own, as in a lab; run it on a machine that is quiet.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from pathlib import Path

import rclpy
from geometry_msgs.msg import WrenchStamped
from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import JointState

import msd_sim.api
from msd_ident.data.record import Record
from msd_ident.io import write_csv
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import time_message
from msd_ident.ros.common.domain import private_domain, private_environment
from msd_ident.ros.common.node_runner import Spinner
from msd_ident.ros.common.processes import Processes
from msd_ident.ros.demo.demo import NAMESPACE, arguments
from msd_interfaces.action import Diagnose
from msd_interfaces.srv import Identify

START_NS = 1_700_000_000_000_000_000


def main() -> None:
    """Measure, alone and beside a diagnosis."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=30)
    calls = parser.parse_args().calls
    with tempfile.TemporaryDirectory() as name, private_domain() as domain:
        folder = Path(name)
        _odd(folder)
        with Processes(folder, private_environment(domain)) as processes:
            given: dict[str, object] = {"bag_folder": str(folder), "auto_fit": False}
            processes.start("identifier", "msd_ident.ros.identifier", arguments(given))
            context = rclpy.Context()
            rclpy.init(context=context, domain_id=domain)
            node = Node("bench", namespace=NAMESPACE, context=context)
            spinner = Spinner(node)
            try:
                _measure(node, calls)
            finally:
                spinner.stop()
                node.destroy_node()
                rclpy.shutdown(context=context)


def _odd(folder: Path) -> None:
    for seed in range(20):
        made = msd_sim.api.simulate({"rig": "odd", "experiment": "steps", "seed": seed})
        write_csv(Record(made.time, made.position, made.force_time, made.force), folder / f"odd_{seed}.csv")


def _measure(node: Node, calls: int) -> None:
    client = node.create_client(Identify, names.IDENTIFY)
    action = ActionClient(node, Diagnose, names.DIAGNOSE)
    assert client.wait_for_service(60.0) and action.wait_for_server(60.0)
    _fill(node)
    _call(client)
    _tell("alone", [_call(client) for _ in range(calls)])
    goal = Diagnose.Goal(bag_paths=[f"odd_{seed}.csv" for seed in range(20)])
    stages: list[str] = []
    sent = action.send_goal_async(goal, feedback_callback=lambda told: stages.append(told.feedback.stage))
    while "looking at the data" not in stages:
        time.sleep(0.01)
    result = sent.result().get_result_async()
    _tell("beside a diagnosis", [_call(client) for _ in range(calls)])
    assert not result.done(), "the diagnosis ended before the measurement did"
    begin = time.monotonic()
    sent.result().cancel_goal_async()
    while not result.done():
        time.sleep(0.001)
    print(f"cancelled after {1e3 * (time.monotonic() - begin):.0f} ms")
    action.destroy()


def _fill(node: Node) -> None:
    made = msd_sim.api.simulate({"rig": "ecp", "experiment": "paper", "rate": 1000.0})
    force = node.create_publisher(WrenchStamped, names.FORCE, names.force_qos(10_000))
    encoder = node.create_publisher(JointState, names.ENCODER, names.encoder_qos(10_000))
    while not (force.get_subscription_count() and encoder.get_subscription_count()):
        time.sleep(0.01)
    for at, value in zip(made.force_time.tolist(), made.force.tolist(), strict=True):
        message = WrenchStamped()
        message.header.stamp = time_message(START_NS + round(at * 1e9))
        message.wrench.force.x = value
        force.publish(message)
    for at, value in zip(made.time.tolist(), made.position.tolist(), strict=True):
        if at < 3.0:
            sample = JointState(name=["cart"], position=[value])
            sample.header.stamp = time_message(START_NS + round(at * 1e9))
            encoder.publish(sample)
    time.sleep(2.0)


def _call(client: object) -> float:
    begin = time.monotonic()
    future = client.call_async(Identify.Request())  # type: ignore[attr-defined]
    while not future.done():
        time.sleep(0.0005)
    assert future.result().success, future.result().message
    return time.monotonic() - begin


def _tell(what: str, seconds: list[float]) -> None:
    ms = sorted(1e3 * value for value in seconds)
    print(f"{what}: median {statistics.median(ms):.0f} ms, least {ms[0]:.0f}, greatest {ms[-1]:.0f}, of {len(ms)}")


if __name__ == "__main__":
    main()
