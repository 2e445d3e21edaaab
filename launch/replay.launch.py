"""A bag played back to the identifier, on the bag's own time. The identifier stays after the bag's end, to be asked.

From a shell:

    ros2 launch msd_ident replay.launch.py bag:=/path/to/bag rate:=2.0
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    """Arguments, then the two nodes."""
    default = PathJoinSubstitution([FindPackageShare("msd_ident"), "config", "identifier.yaml"])
    playing = {
        "bag": ParameterValue(LaunchConfiguration("bag"), value_type=str),
        "rate": ParameterValue(LaunchConfiguration("rate"), value_type=float),
        "loop": ParameterValue(LaunchConfiguration("loop"), value_type=bool),
        "clock": True,
    }
    return LaunchDescription(
        [
            DeclareLaunchArgument("bag", description="rosbag2 folder or .mcap file"),
            DeclareLaunchArgument("rate", default_value="1.0", description="seconds of the bag in a second"),
            DeclareLaunchArgument(
                "loop", default_value="false", choices=["true", "false"], description="begin anew at the end"
            ),
            DeclareLaunchArgument(
                "namespace", default_value="msd", description="namespace of the nodes; topics keep the bag's names"
            ),
            DeclareLaunchArgument("params", default_value=default, description="identifier's YAML file"),
            Node(
                package="msd_ident",
                executable="identifier",
                name="identifier",
                namespace=LaunchConfiguration("namespace"),
                parameters=[LaunchConfiguration("params"), {"use_sim_time": True}],
                output="screen",
            ),
            Node(
                package="msd_ident",
                executable="replayer",
                name="replayer",
                namespace=LaunchConfiguration("namespace"),
                parameters=[playing],
                output="screen",
            ),
        ]
    )
