"""A bag played back to the identifier, on the bag's own time. The identifier stays after the bag's end, to be asked.

From a shell:

    ros2 launch msd_ident replay.launch.py bag:=/path/to/bag rate:=2.0 respawn:=true

Every argument is checked before anything starts.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from msd_ident.ros.common.launch_arguments import LOG_LEVELS, Arguments

#: Name, default and meaning of what can be said on the command line; no default: it must be.
ARGUMENTS = (
    ("bag", None, "rosbag2 folder or .mcap file"),
    ("rate", "1.0", "playback speed"),
    ("loop", "false", "true: restart at the end"),
    ("namespace", "msd", "namespace of the nodes; topics keep the bag's names"),
    (
        "params",
        PathJoinSubstitution([FindPackageShare("msd_ident"), "config", "identifier.yaml"]),
        "identifier's YAML file",
    ),
    ("respawn", "false", "true: restart an identifier that died; the replayer ends with its bag"),
    ("log_level", "info", f"log level of both nodes: {', '.join(LOG_LEVELS)}"),
)


def nodes(context):
    """Check all arguments, then the nodes."""
    given = Arguments({name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS})
    namespace = given.namespace()
    params = given.parameters("params", f"{namespace}/identifier")
    playing = {
        "bag": given.bag("bag"),
        "rate": given.number("rate", 0.01, 100.0),
        "loop": given.switch("loop"),
        "clock": True,
    }
    common = {
        "package": "msd_ident",
        "output": "screen",
        "ros_arguments": ["--log-level", given.word("log_level", LOG_LEVELS)],
    }
    return [
        Node(
            executable="identifier",
            name="identifier",
            namespace=namespace,
            parameters=[params, {"use_sim_time": True}],
            respawn=given.switch("respawn"),
            respawn_delay=2.0,
            **common,
        ),
        Node(
            executable="replayer",
            name="replayer",
            namespace=namespace,
            parameters=[playing],
            **common,
        ),
    ]


def generate_launch_description():
    """Arguments, then the two nodes."""
    declared = [DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS]
    return LaunchDescription([*declared, OpaqueFunction(function=nodes)])
