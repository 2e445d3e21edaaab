"""The rig as a node: forces act from their stamps on, samples fall on exact ticks, nonsense is refused in words."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="the ROS wheels are not installed")

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from geometry_msgs.msg import WrenchStamped  # noqa: E402
from rcl_interfaces.srv import SetParameters  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile  # noqa: E402
from rosgraph_msgs.msg import Clock  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from msd_interfaces.msg import EncoderBatch  # noqa: E402
from msd_sim import names  # noqa: E402
from msd_sim.api import simulate  # noqa: E402
from msd_sim.errors import RigError  # noqa: E402
from msd_sim.node.lateness import LATE  # noqa: E402
from msd_sim.node.rig_node import RigNode  # noqa: E402
from msd_sim.rig import Rig  # noqa: E402

NANO = 1_000_000_000
#: Of rigs whose every sample is wanted by an observer in the same process [Hz].
RATE = 200.0
EXACT = {"encoder.counts_per_metre": 0.0}
ECP = {"mass": 0.9407, "damping": 3.927, "stiffness": 694.1, "friction_coefficient": 0.0133}
KEPT = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Lab:
    """A rig and an observer in one process: what the observer heard, and a way to wait for it."""

    def __init__(self, context) -> None:
        self.context = context
        self.executor = SingleThreadedExecutor(context=context)
        self.observer = rclpy.create_node("observer", context=context)
        self.forces = self.observer.create_publisher(WrenchStamped, names.FORCE, KEPT)
        self.observer.create_subscription(JointState, names.ENCODER, self._on_encoder, 20_000)
        self.observer.create_subscription(EncoderBatch, names.ENCODER_BATCH, self._on_batch, 1000)
        self.observer.create_subscription(Clock, names.CLOCK, self._on_clock, 1000)
        self.stamps: list[int] = []
        self.positions: list[float] = []
        self.joints: set[str] = set()
        self.batches: list[EncoderBatch] = []
        self.clock: list[int] = []
        self.executor.add_node(self.observer)

    def _on_encoder(self, message: JointState) -> None:
        self.stamps.append(message.header.stamp.sec * NANO + message.header.stamp.nanosec)
        self.positions.append(message.position[0])
        self.joints.update(message.name)

    def _on_batch(self, message: EncoderBatch) -> None:
        self.batches.append(message)

    def _on_clock(self, message: Clock) -> None:
        self.clock.append(message.clock.sec * NANO + message.clock.nanosec)

    def rig(self, **parameters) -> RigNode:
        held = {"hold_last_command": True, **parameters}  # tests of the switch itself say otherwise
        given = [Parameter(name, value=value) for name, value in held.items()]
        node = RigNode(context=self.context, parameter_overrides=given)
        self.executor.add_node(node)
        return node

    def until(self, done: Callable[[], bool], what: str, limit: float = 60.0) -> None:
        deadline = time.monotonic() + limit
        while not done():
            assert time.monotonic() < deadline, f"{what}: not within {limit} s"
            self.executor.spin_once(timeout_sec=0.05)

    def matched(self) -> None:
        self.until(
            lambda: self.forces.get_subscription_count() > 0 and len(self.stamps) > 0, "the two have found each other"
        )

    def force(self, newtons: float, stamp_ns: int = 0) -> None:
        message = WrenchStamped()
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, NANO)
        message.wrench.force.x = newtons
        self.forces.publish(message)

    def call(self, kind, name: str, request):
        client = self.observer.create_client(kind, name)
        self.until(client.service_is_ready, f"service {name}")
        future = client.call_async(request)
        self.until(future.done, f"answer of {name}")
        return future.result()


@pytest.fixture
def lab(ros_domain):
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain)
    room = Lab(context)
    yield room
    for node in list(room.executor.get_nodes()):
        room.executor.remove_node(node)
        node.destroy_node()
    room.executor.shutdown()
    rclpy.try_shutdown(context=context)


def test_forces_act_from_their_stamps_on_and_samples_fall_on_exact_ticks(lab):
    rig = lab.rig(**ECP | EXACT | {"latency": 1.0, "rate": RATE})
    lab.matched()
    begin = rig.get_clock().now().nanoseconds + 7_654_321  # no tick
    for at, newtons in ((begin, 10.425), (begin + 200_300_700, -4.0), (begin + 350_000_001, 0.0)):
        lab.force(newtons, at)
    lab.until(lambda: lab.stamps[-1] > begin + 600_000_000, "0.6 s of samples")
    stamps = np.array(lab.stamps)
    assert rig.late == 0 and lab.joints == {"cart"}
    assert (np.diff(stamps) == NANO // RATE).all()
    time_s = (stamps - stamps[0]) / NANO
    force_time = (begin + np.array([0, 200_300_700, 350_000_001]) - stamps[0]) / NANO
    alone = simulate(ECP | {"time": time_s, "force_time": force_time, "force": [10.425, -4.0, 0.0]})
    assert np.abs(alone.position - lab.positions).max() < 1e-12
    assert np.ptp(lab.positions) > 0.01


def test_a_rig_whose_rounds_are_long_takes_all_forces_that_wait(lab, monkeypatch):
    """One force for each round would fall behind a sender of more forces than rounds."""
    wake, push, taken = RigNode._wake, Rig.push, []

    def slowly(self) -> None:
        wake(self)
        time.sleep(0.02)

    monkeypatch.setattr(RigNode, "_wake", slowly)
    monkeypatch.setattr(Rig, "push", lambda self, *given: taken.append(given) or push(self, *given))
    rig = lab.rig(**ECP | EXACT | {"rate": RATE})
    lab.matched()
    begin = rig.get_clock().now().nanoseconds + 1_500_000_000
    for i in range(400):
        lab.force(1.0, begin + i * NANO // 1000)
    lab.until(lambda: len(taken) == 400, "all forces")
    assert rig.late == 0


def test_late_forces_are_told_on_diagnostics(lab):
    rig = lab.rig(**ECP | EXACT | {"rate": RATE})
    told = []
    lab.observer.create_subscription(DiagnosticArray, names.DIAGNOSTICS, lambda array: told.extend(array.status), 10)
    lab.matched()
    lab.until(lambda: told, "the first status")
    assert told[-1].name.endswith("rig: forces") and told[-1].message == "in time"
    now = rig.get_clock().now().nanoseconds
    lab.force(1.0, now - 300_000_000)
    lab.force(2.0, now - 200_000_000)

    def count() -> int:
        return sum(int(pair.value) for one in told for pair in one.values if pair.key == LATE)

    lab.until(lambda: count() == 2, "two late forces")
    status = next(one for one in told if one.level == DiagnosticStatus.WARN)
    assert re.match(r"(1 force|2 forces) came late, by up to 0\.[2-9]", status.message)


def test_a_rig_that_comes_late_learns_the_present_force(lab):
    lab.force(1.0, 1)
    lab.force(6.941, 2)
    rig = lab.rig(**ECP | EXACT | {"friction_coefficient": 0.0, "damping": 40.0})
    lab.until(lambda: len(lab.positions) > 600, "samples")
    assert lab.positions[-1] == pytest.approx(0.01, abs=1e-4)
    assert rig.late == 0


def test_a_force_without_a_stamp_acts_from_its_receipt_and_a_late_one_at_once(lab):
    rig = lab.rig(**ECP | EXACT | {"friction_coefficient": 0.0, "damping": 60.0})
    said: list[str] = []
    rig.get_logger = lambda: SimpleNamespace(warning=lambda words, **_: said.append(words))
    lab.matched()
    lab.force(6.941)
    lab.until(lambda: lab.positions[-1] > 0.0099, "the cart moves")
    assert rig.late == 0
    lab.force(-6.941, lab.stamps[0] + NANO // 1000)
    lab.until(lambda: lab.positions[-1] < -0.0099, "the cart moves back")
    assert rig.late == 1
    assert said[0].startswith("1 force came late and acts from now on (the last one ")
    assert said[0].endswith(
        " s); expected stamps of the rig's clock, at most the parameter latency old: does the "
        "sender use the same clock?"
    )
    lab.force(float("nan"))
    lab.force(0.0)
    lab.until(lambda: abs(lab.positions[-1]) < 1e-4, "the rig has refused a force that is no number")


def test_reset_puts_the_cart_to_zero_and_the_noise_to_its_seed(lab):
    lab.rig(**ECP | {"encoder.noise": 1e-3, "encoder.counts_per_metre": 0.0, "seed": 5, "rate": RATE})
    lab.matched()
    lab.until(lambda: len(lab.positions) > 20, "samples")
    answer = lab.call(Trigger, names.RESET, Trigger.Request())
    assert answer.success and answer.message == "encoder at zero, cart at rest"
    lab.until(lambda: len(lab.positions) > 120, "samples after the reset")
    alike = {"encoder": {"noise": 1e-3}, "seed": 5, "rate": RATE}
    again = simulate(ECP | alike | {"duration": 0.25, "force_time": [0], "force": [0]})
    heard, expected = np.array(lab.positions), again.position[:20]
    at = [i for i in range(1, heard.size - 20) if np.array_equal(heard[i : i + 20], expected)]
    assert len(at) == 1
    assert (np.diff(lab.stamps) == NANO // RATE).all()


def test_parameters_are_refused_in_words_and_taken_while_it_runs(lab):
    rig = lab.rig(**ECP | EXACT)
    lab.matched()

    def put(**values):
        request = SetParameters.Request()
        request.parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
        return lab.call(SetParameters, "rig/set_parameters", request).results[0]

    for values, words in (
        ({"mass": -1.0}, "out of range"),
        ({"mass": "heavy"}, "rig mass is 'heavy'; expected a number [kg]: moving mass"),
        ({"effects": ["rubber"]}, "no effect 'rubber'; expected one of coulomb_friction"),
        ({"effects": "backlash"}, "effects is 'backlash', a text; expected a list of names: write ['backlash']"),
        ({"static_friction_coefficient": 0.001}, "static_friction_coefficient is 0.001, below friction_coefficient"),
        ({"rate": 500.0}, "read-only"),
    ):
        answer = put(**values)
        assert not answer.successful and words in answer.reason
    lab.force(6.941)
    assert put(stiffness=347).successful  # whole numbers are numbers
    assert put(effects=["backlash"]).successful
    assert put(damping=40.0).successful
    lab.until(lambda: lab.positions[-1] > 0.0215, "a softer spring with a gap gives way further")
    assert set(rig._config.truth.effects) == {"backlash", "coulomb_friction"}


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"time_mode": "slow"}, "time_mode is 'slow'; expected 'real_time' or 'fast'"),
        ({"effects": ["rubber"]}, "no effect 'rubber'"),
        ({"latency": "short"}, "rig latency is 'short'; expected a number"),
        ({"rate": 5000.0, "encoder.jitter": 1e-4}, "encoder jitter at 5000 samples a second; expected none above 2000"),
    ],
)
def test_a_rig_of_nonsense_does_not_start(lab, values, words):
    with pytest.raises(RigError, match=words):
        lab.rig(**values)


def first_stamps(lab) -> np.ndarray:
    """Stamps of the first samples of all batches [ns]."""
    return np.array([batch.header.stamp.sec * NANO + batch.header.stamp.nanosec for batch in lab.batches])


def test_above_two_kilohertz_samples_come_in_batches_without_a_gap(lab):
    lab.rig(**ECP | EXACT | {"rate": 10_000.0, "effects": ["periodic_disturbance"]})
    lab.until(lambda: len(lab.batches) >= 60, "60 batches")
    sizes = [len(batch.positions) for batch in lab.batches]
    first = first_stamps(lab)
    assert set(sizes) == {100} and {batch.period_ns for batch in lab.batches} == {100_000}
    assert {batch.name for batch in lab.batches} == {"cart"}
    assert (np.diff([batch.sequence for batch in lab.batches]) == 100).all() and (np.diff(first) == 10_000_000).all()
    assert not lab.stamps


def test_lost_samples_end_a_batch_and_show_in_the_sequence(lab):
    lab.rig(**ECP | {"rate": 5000.0, "encoder.dropout": 0.02, "encoder.dropout_length": 3.0})
    lab.until(lambda: len(lab.batches) >= 60, "60 batches")
    sequence = np.array([batch.sequence for batch in lab.batches])
    sizes = np.array([len(batch.positions) for batch in lab.batches])
    first = first_stamps(lab)
    missing = sequence[1:] - sequence[:-1] - sizes[:-1]
    assert (missing >= 0).all() and missing.sum() > 0
    assert ((first - first[0]) == (sequence - sequence[0]) * 200_000).all()


def test_fast_time_runs_ahead_of_the_wall_and_everybody_is_told(lab):
    rig = lab.rig(**ECP | EXACT | {"time_mode": "fast", "real_time_factor": 10.0})
    lab.until(lambda: lab.forces.get_subscription_count() > 0 and len(lab.clock) > 5, "the clock ticks")
    wall, begin = time.monotonic(), lab.clock[-1]
    lab.force(10.425, begin + 4 * NANO)
    lab.until(lambda: bool(lab.batches) and first_stamps(lab)[-1] > begin + 8 * NANO, "8 s of samples")
    assert time.monotonic() - wall < 8.0
    assert rig.late == 0 and (np.diff(lab.clock) >= 0).all() and first_stamps(lab)[-1] <= lab.clock[-1] + NANO
    assert (np.diff(first_stamps(lab)) == 100_000_000).all()
    positions = np.concatenate([batch.positions for batch in lab.batches])
    time_s = np.arange(positions.size) * 1e-3
    force_time = [(begin + 4 * NANO - int(first_stamps(lab)[0])) / NANO]
    alone = simulate(ECP | {"time": time_s, "force": [10.425], "force_time": force_time})
    assert np.ptp(positions) > 0.01 and np.abs(alone.position - positions).max() < 1e-12


def _process(*arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "msd_sim.node", "--ros-args", *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.mark.parametrize("signals", [(signal.SIGINT, signal.SIGINT), (signal.SIGTERM,)])
def test_it_ends_with_code_0_and_without_a_traceback(ros_domain, lab, signals):
    process = _process("-p", "encoder.noise:=1.0e-5")
    try:
        lab.until(lambda: len(lab.stamps) > 0, "the rig runs", 60.0)
        for number in signals:
            process.send_signal(number)
        _, said = process.communicate(timeout=20)
    finally:
        process.kill()
    assert process.returncode == 0, said
    assert "Traceback" not in said and "rror" not in said


@pytest.mark.parametrize(
    ("in_file", "said"),
    [
        ("0.9", "mass is abc on the command line, and stays 0.9 of the parameter file, where it has another type"),
        ("2", "mass is 2.5 on the command line, and stays 2 of the parameter file, where it has another type"),
    ],
)
def test_a_number_that_ros_passes_over_is_refused(ros_domain, tmp_path, in_file, said):
    file = tmp_path / "rig.yaml"
    file.write_text(f"/**:\n  ros__parameters:\n    mass: {in_file}\n")
    process = _process("--params-file", str(file), "-p", f"mass:={said.split()[2]}")
    try:
        _, found = process.communicate(timeout=60)
    finally:
        process.kill()
    lines = [line for line in found.splitlines() if line.startswith("rig: ") and "compiling" not in line]
    assert process.returncode == 2 and len(lines) == 1
    assert said + "; expected a number [kg] written as there: change the file or the option" in lines[0]


def test_a_process_with_nonsense_says_so_in_one_line_and_ends_with_code_2(ros_domain):
    process = _process("-p", "mass:=-1.0")
    _, said = process.communicate(timeout=60)
    lines = [line for line in said.splitlines() if line.startswith("rig: ") and "compiling" not in line]
    assert process.returncode == 2 and len(lines) == 1 and "Traceback" not in said
    assert "mass out of range" in lines[0] and "expected what the parameter's description says" in lines[0]
