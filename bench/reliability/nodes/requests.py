"""Faults of requests: invalid values, bad paths, too many calls, cancelled goals."""

from __future__ import annotations

import ctypes
import os
import random
import time
from pathlib import Path

from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionClient
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from bench.reliability.nodes.world import PERIOD_NS, World
from msd_ident.ros.common import names
from msd_interfaces.action import Diagnose
from msd_interfaces.srv import Identify, StartRecording

#: A cancelled goal is answered within this time [s].
CANCELLED_WITHIN = 1.0
#: Nonsense for parameters of the identifier: name and value.
NONSENSE = (
    ("settle_time", -1.0),
    ("settle_time", float("nan")),
    ("settle_time", "fast"),
    ("settle_band", 2.0),
    ("model", "magic"),
    ("hold", "linear"),
    ("buffer_samples", 5),
    ("auto_fit", 3),
    ("bag_folder", 7),
)
#: capset(2): version, header and the two rights with which root reads what it may not.
_CAPABILITIES, _OVERRIDE = 0x20080522, (1 << 1) | (1 << 2)


def identify(world: World) -> None:
    """Ask for an estimate, whatever it says."""
    world.call(Identify, names.IDENTIFY, Identify.Request())


def push(world: World, ahead_ns: int, newtons: float) -> None:
    """A force with a stamp so far ahead of the newest position."""
    world.push(world.identifier.buffer.position.newest_ns + ahead_ns, newtons)


def stream_force(world: World, messages: int) -> None:
    """The force that acts, again and again, at the samples' rate."""
    newtons = float(world.identifier.buffer.force.samples(1)[1][0])
    for index in range(messages):
        push(world, (index + 1) * PERIOD_NS // 1000, newtons)
        time.sleep(0.002)


def nonsense(world: World, rng: random.Random) -> None:
    """Every kind of nonsense is refused in words."""
    for name, value in NONSENSE:
        request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
        (answer,) = world.call(SetParameters, "identifier/set_parameters", request)
        (result,) = answer.results
        world.expect(not result.successful and bool(result.reason), f"{name} = {value!r} was taken")


def fifty_at_once(world: World, rng: random.Random) -> None:
    """Each caller gets an answer, and nobody waits for fifty fits."""
    before = time.monotonic()
    answers = world.call(Identify, names.IDENTIFY, Identify.Request(), count=50)
    world.expect(len(answers) == 50 and all(answer.success for answer in answers), answers[0].message)
    answers = world.call(Trigger, names.TRIGGER, Trigger.Request(), count=50)
    world.expect(all(answer.success for answer in answers), answers[0].message)
    world.expect(time.monotonic() - before < 30.0, "it took more than 30 s")


def bad_paths(world: World, rng: random.Random) -> None:
    """Paths to nothing, to everything, out of the bag folder, and too long ones."""
    link = world.bags / "link"
    if not link.is_symlink():
        link.symlink_to("/")
    for path in ("nothing", "/", "/etc/passwd", "../..", "link/etc", "x" * 5000, "~nobody_here/bag", "a\nb"):
        (answer,) = world.call(Identify, names.IDENTIFY, Identify.Request(bag_path=path))
        said = answer.message
        world.expect(not answer.success and "expected" in said and "internal" not in said, f"{path[:20]!r}: {said}")


def folder_without_rights(world: World, rng: random.Random) -> None:
    """A folder that nobody may read, not even root, whose rights to do so the worker's thread gives away."""
    folder = world.bags / "locked"
    folder.mkdir(exist_ok=True)
    folder.chmod(0)
    world.identifier.worker.submit(_without_override)
    try:
        (answer,) = world.call(Identify, names.IDENTIFY, Identify.Request(bag_path="locked"))
        world.expect(not answer.success and "Permission denied" in answer.message, answer.message)
    finally:
        folder.chmod(0o700)


def pipe(world: World, rng: random.Random) -> None:
    """A pipe that nobody writes to would block a reader for ever."""
    path = world.bags / "pipe.csv"
    if not path.exists():
        os.mkfifo(path)
    (answer,) = world.call(Identify, names.IDENTIFY, Identify.Request(bag_path="pipe.csv"))
    world.expect(not answer.success and "neither file nor folder" in answer.message, answer.message)


def cancelled(world: World, rng: random.Random) -> None:
    """A goal is cancelled at a random moment; the answer comes within a second."""
    client = ActionClient(world.tester, Diagnose, names.DIAGNOSE)
    try:
        world.until(client.server_is_ready, "the action")
        sent = world.within(lambda: client.send_goal_async(Diagnose.Goal()))
        world.until(sent.done, "the goal's answer")
        result = world.within(sent.result().get_result_async)
        time.sleep(rng.uniform(0.0, 0.3))
        asked = time.monotonic()
        world.within(sent.result().cancel_goal_async)
        world.until(result.done, "the result")
        took = time.monotonic() - asked
        world.expect(took < CANCELLED_WITHIN, f"the answer took {took:.2f} s")
    finally:
        world.release(client)


def recordings(world: World, rng: random.Random) -> None:
    """Starts and stops in any order; every recording that began holds what was sent meanwhile."""
    folders: list[Path] = []
    for _ in range(3):
        (started,) = world.call(StartRecording, names.RECORDER_START, StartRecording.Request(topics=["encoder"]))
        if started.success:
            folders.append(Path(started.path))
            world.until(lambda: world.encoder.get_subscription_count() == 2, "the recorder's subscription")
        world.feed(50)
        if rng.random() < 0.7:
            world.call(Trigger, names.RECORDER_STOP, Trigger.Request())
    world.call(Trigger, names.RECORDER_STOP, Trigger.Request())
    summary = world.recorder.summary
    world.expect(bool(folders) and summary is not None and not summary.lost and not summary.error, str(summary))


def _without_override() -> None:
    """Give away root's right to read everything, for the calling thread alone."""
    libc = ctypes.CDLL(None, use_errno=True)
    header = (ctypes.c_uint32 * 2)(_CAPABILITIES, 0)
    data = (ctypes.c_uint32 * 6)()
    if libc.capget(header, data) == 0:
        data[0] &= ~_OVERRIDE
        libc.capset(header, data)
