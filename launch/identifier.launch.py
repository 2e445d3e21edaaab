"""The identifier alone, beside a real robot: any topic and field can be the force or the position.

From a shell:

    ros2 launch msd_ident identifier.launch.py params:=/path/to/robot.yaml

Every argument is checked before anything starts.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from msd_ident.ros.common.launch_arguments import LOG_LEVELS, Arguments

#: Name, default and meaning of what can be said on the command line.
ARGUMENTS = (
    ("namespace", "msd", "namespace of the node and its topics"),
    (
        "params",
        PathJoinSubstitution([FindPackageShare("msd_ident"), "config", "identifier.yaml"]),
        "YAML file: sources of force and position, and the rest",
    ),
    ("use_sim_time", "false", "true: follow /clock"),
    ("live", "false", "true: also serve the live view"),
    ("live_port", "8210", "port of the live view"),
    ("respawn", "false", "true: restart a node that died"),
    ("log_level", "info", f"log level of all nodes: {', '.join(LOG_LEVELS)}"),
)


def nodes(context):
    """Check all arguments, then the nodes."""
    given = Arguments({name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS})
    namespace = given.namespace()
    params = given.parameters("params", f"{namespace}/identifier")
    live_port = given.port("live_port")
    on_clock = {"use_sim_time": given.switch("use_sim_time")}
    common = {
        "package": "msd_ident",
        "output": "screen",
        "respawn": given.switch("respawn"),
        "respawn_delay": 2.0,
        "ros_arguments": ["--log-level", given.word("log_level", LOG_LEVELS)],
    }
    started = [
        Node(
            executable="identifier",
            name="identifier",
            namespace=namespace,
            parameters=[params, on_clock],
            **common,
        )
    ]
    if given.switch("live"):
        started.append(
            Node(
                executable="live",
                name="live",
                namespace=namespace,
                # Of the same file it takes the sources of force and position, and leaves the rest.
                parameters=[params, {"port": live_port}, on_clock],
                **common,
            )
        )
    return started


def generate_launch_description():
    """Arguments, then the node."""
    declared = [DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS]
    return LaunchDescription([*declared, OpaqueFunction(function=nodes)])
