"""The whole pipeline: simulated rig, recorder and identifier; experimenter and live view when asked for.

From a shell:

    ros2 launch msd_ident pipeline.launch.py
    ros2 launch msd_ident pipeline.launch.py rig_params:=/path/to/rig.yaml use_sim_time:=true
    ros2 launch msd_ident pipeline.launch.py experimenter:=true     # and the action experimenter/run
    ros2 launch msd_ident pipeline.launch.py live:=true     # and a page at http://127.0.0.1:8210
    ros2 launch msd_ident pipeline.launch.py respawn:=true log_level:=debug

Every argument is checked before anything starts.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from msd_ident.ros.common.launch_arguments import LOG_LEVELS, Arguments


def config(name):
    """A parameter file that ships with the package."""
    return PathJoinSubstitution([FindPackageShare("msd_ident"), "config", name])


#: Name, default and meaning of what can be said on the command line.
ARGUMENTS = (
    ("namespace", "msd", "namespace of all nodes and topics"),
    ("rig_params", config("ecp.yaml"), "which rig: YAML file"),
    ("identifier_params", config("identifier.yaml"), "identifier's YAML file"),
    ("recorder_params", config("recorder.yaml"), "recorder's YAML file"),
    ("use_sim_time", "false", "true: the rig publishes /clock, faster than real time, and the other nodes follow it"),
    ("experimenter", "false", "true: also start the experimenter (experimenter/run)"),
    ("live", "false", "true: also serve the live view"),
    ("live_port", "8210", "port of the live view"),
    ("respawn", "false", "true: restart a node that died; a recorder continues its recording in a new bag"),
    ("log_level", "info", f"log level of all nodes: {', '.join(LOG_LEVELS)}"),
)


def nodes(context):
    """Check all arguments, then the nodes."""
    given = Arguments({name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS})
    namespace, simulated = given.namespace(), given.switch("use_sim_time")
    respawn, live_port = given.switch("respawn"), given.port("live_port")
    ros_arguments = ["--log-level", given.word("log_level", LOG_LEVELS)]

    def node(name, *parameters, **more):
        """One node of this package, in the namespace; ``more`` as ``Node`` takes it."""
        return Node(
            package="msd_ident",
            executable=name,
            name=name,
            namespace=namespace,
            parameters=list(parameters),
            output="screen",
            respawn=respawn,
            respawn_delay=2.0,
            ros_arguments=ros_arguments,
            **more,
        )

    def file(name):
        """The parameter file that an argument names for a node."""
        return given.parameters(f"{name}_params", f"{namespace}/{name}")

    # With simulated time the rig makes the time, so it alone stays on the wall's clock.
    on_clock = {"use_sim_time": simulated}
    rig_time = {"time_mode": "fast" if simulated else "real_time"}
    # Without the rig nothing goes on.
    rig_ends = None if respawn else Shutdown(reason="the rig has ended")
    started = [
        node("rig", file("rig"), rig_time, on_exit=rig_ends),
        node("recorder", file("recorder"), on_clock, {"resume": respawn}, sigkill_timeout="30"),  # its bag must be kept
        node("identifier", file("identifier"), on_clock),
    ]
    if given.switch("experimenter"):
        started.append(node("experimenter", on_clock, sigkill_timeout="30"))  # the force goes to 0, its bag to the disk
    if given.switch("live"):
        started.append(node("live", {"port": live_port}, on_clock))
    return started


def generate_launch_description():
    """Arguments, then the three nodes, and the others when asked for."""
    declared = [DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS]
    return LaunchDescription([*declared, OpaqueFunction(function=nodes)])
