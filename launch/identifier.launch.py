"""The identifier alone, beside a real robot: any topic and field can be the force or the position.

From a shell:

    ros2 launch msd_ident identifier.launch.py params:=/path/to/robot.yaml
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    """Arguments, then the node."""
    default = PathJoinSubstitution([FindPackageShare("msd_ident"), "config", "identifier.yaml"])
    on_clock = {"use_sim_time": ParameterValue(LaunchConfiguration("use_sim_time"), value_type=bool)}
    return LaunchDescription(
        [
            DeclareLaunchArgument("namespace", default_value="msd", description="namespace of the node and its topics"),
            DeclareLaunchArgument(
                "params", default_value=default, description="YAML file: sources of force and position, and the rest"
            ),
            DeclareLaunchArgument(
                "use_sim_time", default_value="false", choices=["true", "false"], description="follow /clock"
            ),
            DeclareLaunchArgument(
                "live", default_value="false", choices=["true", "false"], description="serve the live view too"
            ),
            DeclareLaunchArgument("live_port", default_value="8210", description="port of the live view"),
            Node(
                package="msd_ident",
                executable="identifier",
                name="identifier",
                namespace=LaunchConfiguration("namespace"),
                parameters=[LaunchConfiguration("params"), on_clock],
                output="screen",
            ),
            Node(
                package="msd_ident",
                executable="live",
                name="live",
                namespace=LaunchConfiguration("namespace"),
                # Of the same file it takes the sources of force and position, and leaves the rest.
                parameters=[
                    LaunchConfiguration("params"),
                    {"port": ParameterValue(LaunchConfiguration("live_port"), value_type=int)},
                    on_clock,
                ],
                output="screen",
                condition=IfCondition(LaunchConfiguration("live")),
            ),
        ]
    )
