"""The whole pipeline: simulated rig, recorder and identifier; experimenter and live view when asked for.

From a shell:

    ros2 launch msd_ident pipeline.launch.py
    ros2 launch msd_ident pipeline.launch.py rig_params:=/path/to/rig.yaml use_sim_time:=true
    ros2 launch msd_ident pipeline.launch.py experimenter:=true     # and the action experiment/run
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


def arguments():
    """What can be said on the command line."""
    switch = {"default_value": "false", "choices": ["true", "false"]}
    return [
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
            description="true: the rig publishes /clock, faster than the wall, and the others follow it",
            **switch,
        ),
        DeclareLaunchArgument("experimenter", description="play force profiles by experiment/run too", **switch),
        DeclareLaunchArgument("live", description="serve the live view too", **switch),
        DeclareLaunchArgument("live_port", default_value="8210", description="port of the live view"),
    ]


def rig():
    """The simulated rig, without which nothing goes on."""
    # With simulated time the rig makes the time, so it alone stays on the wall's clock.
    time_mode = IfElseSubstitution(EqualsSubstitution(LaunchConfiguration("use_sim_time"), "true"), "fast", "real_time")
    return Node(
        package="msd_ident",
        executable="rig",
        name="rig",
        namespace=LaunchConfiguration("namespace"),
        parameters=[LaunchConfiguration("rig_params"), {"time_mode": time_mode}],
        on_exit=Shutdown(reason="the rig has ended"),
        output="screen",
    )


def watchers(on_clock):
    """Recorder and identifier."""
    return [
        Node(
            package="msd_ident",
            executable="recorder",
            name="recorder",
            namespace=LaunchConfiguration("namespace"),
            parameters=[LaunchConfiguration("recorder_params"), on_clock],
            sigkill_timeout="30",  # its bag must reach the disk
            output="screen",
        ),
        Node(
            package="msd_ident",
            executable="identifier",
            name="identifier",
            namespace=LaunchConfiguration("namespace"),
            parameters=[LaunchConfiguration("identifier_params"), on_clock],
            output="screen",
        ),
    ]


def extras(on_clock):
    """Experimenter and live view, each when asked for."""
    return [
        Node(
            package="msd_ident",
            executable="experimenter",
            name="experimenter",
            namespace=LaunchConfiguration("namespace"),
            parameters=[on_clock],
            condition=IfCondition(LaunchConfiguration("experimenter")),
            sigkill_timeout="30",  # the force goes to 0 and its bag to the disk
            output="screen",
        ),
        Node(
            package="msd_ident",
            executable="live",
            name="live",
            namespace=LaunchConfiguration("namespace"),
            parameters=[{"port": ParameterValue(LaunchConfiguration("live_port"), value_type=int)}, on_clock],
            condition=IfCondition(LaunchConfiguration("live")),
            output="screen",
        ),
    ]


def generate_launch_description():
    """Arguments, then the three nodes, and the others when asked for."""
    on_clock = {"use_sim_time": ParameterValue(LaunchConfiguration("use_sim_time"), value_type=bool)}
    return LaunchDescription([*arguments(), rig(), *watchers(on_clock), *extras(on_clock)])
