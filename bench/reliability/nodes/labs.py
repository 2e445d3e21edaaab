"""Faults of operation: long names, invalid launch arguments, a killed experimenter, two recorders."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys

from geometry_msgs.msg import WrenchStamped
from rclpy.action import ActionClient
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from bench.reliability.nodes.world import World
from msd_ident.design import Profile, Segment
from msd_ident.design.profile_file import to_yaml
from msd_ident.errors import UsageError
from msd_ident.ros.common import names
from msd_ident.ros.common.launch_arguments import LOG_LEVELS, Arguments
from msd_ident.ros.common.node_runner import Spinner
from msd_ident.ros.recorder.node import Recorder
from msd_interfaces.action import RunExperiment
from msd_interfaces.srv import Identify, StartRecording
from msd_sim.node.rig_node import RigNode

#: Namespace of a rig that an experimenter moves, and time within which it must let go [s].
PLACE, LET_GO_WITHIN = "/soak_rig", 3.0
#: Arguments of the launch files that make no sense, by the way in which they are read.
NONSENSE = (
    ("switch", "use_sim_time", "maybe"),
    ("port", "live_port", "abc"),
    ("namespace", "namespace", "1 2"),
    ("parameters", "rig_params", "/nope.yaml"),
    ("bag", "bag", "/nope"),
)


def long_names(world: World, rng: random.Random) -> None:
    """Names that no file system takes are refused in words, and the next request is done."""
    name = "".join(rng.choice("aü☃") for _ in range(rng.randint(256, 1000)))
    for kind, service, request in (
        (Identify, names.IDENTIFY, Identify.Request(bag_path=name)),
        (StartRecording, names.RECORDER_START, StartRecording.Request(folder=name)),
    ):
        (answer,) = world.call(kind, service, request)
        world.expect(not answer.success and "is a name of" in answer.message, answer.message)
    (started,) = world.call(StartRecording, names.RECORDER_START, StartRecording.Request())
    world.expect(started.success, started.message)
    world.call(Trigger, names.RECORDER_STOP, Trigger.Request())


def launch_arguments(world: World, rng: random.Random) -> None:
    """Each is refused in words before anything starts."""
    for way, name, text in NONSENSE:
        try:
            getattr(Arguments({name: text}), way)(name, *(["/msd/rig"] if way == "parameters" else []))
        except UsageError as error:
            world.expect(f"{name}:={text}" in str(error) and "expected" in str(error), str(error))
        else:
            world.expect(False, f"{name}:={text} was taken")
    world.expect(Arguments({"log_level": "Info"}).word("log_level", LOG_LEVELS) == "info", "Info is no log level")


def dead_experimenter(world: World, rng: random.Random) -> None:
    """An experimenter is killed while it pushes; the rig lets go."""
    given = [Parameter("rate", value=100.0)]
    rig = RigNode(context=world.contexts[0], namespace=PLACE, parameter_overrides=given)
    forces: list[float] = []
    heard = world.tester.create_subscription(
        WrenchStamped, f"{PLACE}/{names.FORCE}", lambda message: forces.append(message.wrench.force.x), 100
    )
    spinner = Spinner(rig)
    # A name of its own: one that was killed before stays in the graph for a while, and a goal may be sent to it.
    name = f"experimenter_{rng.randrange(10**9)}"
    arguments = ["--ros-args", "-r", f"__ns:={PLACE}", "-r", f"__node:={name}", "-p", f"bag_folder:={world.bags}"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(world.domain)}
    command = [sys.executable, "-m", "msd_ident.ros.experimenter", *arguments]
    client = ActionClient(world.tester, RunExperiment, f"{PLACE}/{name}/{names.RUN.rpartition('/')[2]}")
    with subprocess.Popen(command, env=environment) as process:
        try:
            world.until(client.server_is_ready, "the experimenter", 60.0)
            profile = to_yaml(Profile((Segment("step", 60.0, force=5.0),), "long"))
            goal = RunExperiment.Goal(profile=profile, limits="{force: 10, travel: 0.05, duration: 90}")
            sent = world.within(lambda: client.send_goal_async(goal))
            # The answer may be lost: to a server that has not found the client yet. The push says that it was accepted.
            world.until(lambda: 5.0 in forces or (sent.done() and not sent.result().accepted), "the push", 30.0)
            world.expect(5.0 in forces, "the experimenter refused the goal")
            process.send_signal(signal.SIGKILL)
            process.wait()
            world.until(lambda: forces[-1] == 0.0, "the rig to let go", LET_GO_WITHIN)
        finally:
            process.kill()
            world.release(client)
            spinner.stop()
            rig.destroy_node()
            world.tester.destroy_subscription(heard)


def two_recorders(world: World, rng: random.Random) -> None:
    """Two recorders begin within a second in one folder; each has a bag of its own."""
    given = [Parameter("bag_folder", value=str(world.bags))]
    other = Recorder(given, context=world.contexts[1], namespace="/soak_other")
    spinner = Spinner(other.node)
    try:
        paths = []
        for place in ("", "/soak_other/"):
            (answer,) = world.call(StartRecording, f"{place}{names.RECORDER_START}", StartRecording.Request())
            world.expect(answer.success, answer.message)
            paths.append(answer.path)
        world.expect(paths[0] != paths[1], f"both record to {paths[0]}")
    finally:
        world.call(Trigger, names.RECORDER_STOP, Trigger.Request())
        spinner.stop()
        other.close()
        other.node.destroy_node()
