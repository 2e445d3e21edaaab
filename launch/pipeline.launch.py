"""The whole pipeline: simulated rig, recorder and identifier.

    ros2 launch msd_ident pipeline.launch.py
    ros2 launch msd_ident pipeline.launch.py rig_params:=/path/to/rig.yaml use_sim_time:=true
    ros2 launch msd_ident pipeline.launch.py live:=true     # and a page at http://127.0.0.1:8210
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, Shutdown
from launch.conditions import IfCondition
from launch.substitutions import EqualsSubstitution, IfElseSubstitution, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def config(name):
    """A parameter file that ships with the package."""
    return PathJoinSubstitution([FindPackageShare("msd_ident"), "config", name])


def generate_launch_description():
    """Arguments, then the three nodes, and the live view when asked for."""
    namespace = LaunchConfiguration("namespace")
    simulated = LaunchConfiguration("use_sim_time")
    on_clock = {"use_sim_time": ParameterValue(simulated, value_type=bool)}
    # With simulated time the rig makes the time, so it alone stays on the wall's clock.
    time_mode = IfElseSubstitution(EqualsSubstitution(simulated, "true"), "fast", "real_time")
    return LaunchDescription(
        [
            DeclareLaunchArgument("namespace", default_value="msd", description="namespace of all nodes and topics"),
            DeclareLaunchArgument("rig_params", default_value=config("ecp.yaml"), description="which rig: YAML file"),
            DeclareLaunchArgument(
                "identifier_params", default_value=config("identifier.yaml"), description="identifier's YAML file"
            ),
            DeclareLaunchArgument(
                "recorder_params", default_value=config("recorder.yaml"), description="recorder's YAML file"
            ),
            DeclareLaunchArgument(
                "use_sim_time",
                default_value="false",
                choices=["true", "false"],
                description="true: the rig publishes /clock, faster than the wall, and the others follow it",
            ),
            DeclareLaunchArgument(
                "live", default_value="false", choices=["true", "false"], description="serve the live view too"
            ),
            DeclareLaunchArgument("live_port", default_value="8210", description="port of the live view"),
            Node(
                package="msd_ident",
                executable="rig",
                name="rig",
                namespace=namespace,
                parameters=[LaunchConfiguration("rig_params"), {"time_mode": time_mode}],
                output="screen",
                on_exit=Shutdown(reason="the rig has ended"),
            ),
            Node(
                package="msd_ident",
                executable="recorder",
                name="recorder",
                namespace=namespace,
                parameters=[LaunchConfiguration("recorder_params"), on_clock],
                output="screen",
                sigkill_timeout="30",  # its bag must reach the disk
            ),
            Node(
                package="msd_ident",
                executable="identifier",
                name="identifier",
                namespace=namespace,
                parameters=[LaunchConfiguration("identifier_params"), on_clock],
                output="screen",
            ),
            Node(
                package="msd_ident",
                executable="live",
                name="live",
                namespace=namespace,
                parameters=[{"port": ParameterValue(LaunchConfiguration("live_port"), value_type=int)}, on_clock],
                output="screen",
                condition=IfCondition(LaunchConfiguration("live")),
            ),
        ]
    )
