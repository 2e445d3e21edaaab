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
    common = {
        "package": "msd_ident",
        "output": "screen",
        "respawn": respawn,
        "respawn_delay": 2.0,
        "ros_arguments": ["--log-level", given.word("log_level", LOG_LEVELS)],
    }
    on_clock = {"use_sim_time": simulated}
    started = [
        Node(
            executable="rig",
            name="rig",
            namespace=namespace,
            # With simulated time the rig makes the time, so it alone stays on the wall's clock.
            parameters=[
                given.parameters("rig_params", f"{namespace}/rig"),
                {"time_mode": "fast" if simulated else "real_time"},
            ],
            # Without the rig nothing goes on.
            on_exit=None if respawn else Shutdown(reason="the rig has ended"),
            **common,
        ),
        Node(
            executable="recorder",
            name="recorder",
            namespace=namespace,
            parameters=[given.parameters("recorder_params", f"{namespace}/recorder"), on_clock, {"resume": respawn}],
            sigkill_timeout="30",  # its bag must reach the disk
            **common,
        ),
        Node(
            executable="identifier",
            name="identifier",
            namespace=namespace,
            parameters=[given.parameters("identifier_params", f"{namespace}/identifier"), on_clock],
            **common,
        ),
    ]
    if given.switch("experimenter"):
        started.append(
            Node(
                executable="experimenter",
                name="experimenter",
                namespace=namespace,
                parameters=[on_clock],
                sigkill_timeout="30",  # the force goes to 0 and its bag to the disk
                **common,
            )
        )
    if given.switch("live"):
        started.append(
            Node(
                executable="live",
                name="live",
                namespace=namespace,
                parameters=[{"port": live_port}, on_clock],
                **common,
            )
        )
    return started


def generate_launch_description():
    """Arguments, then the three nodes, and the others when asked for."""
    declared = [DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS]
    return LaunchDescription([*declared, OpaqueFunction(function=nodes)])
