"""Starts scanloom_bridge in ROS 2. README.md describes the parameters."""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ARGUMENTS = {  # with the type and the default; session has none
    "server": (str, "127.0.0.1:7447"),
    "session": (str, None),
    "robot": (str, ""),
    "poses": (str, "auto"),
    "scan_topics": (str, "scan"),
    "publish_tf": (bool, "false"),
    "publish_map": (bool, "false"),
    "token_file": (str, ""),
    "use_sim_time": (bool, "false"),
}


def generate_launch_description():
    parameters = {name: ParameterValue(LaunchConfiguration(name), value_type=type)
                  for name, (type, _) in ARGUMENTS.items()}
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=default) for name, (_, default) in ARGUMENTS.items()),
        Node(package="scanloom_bridge", executable="scanloom_bridge", name="scanloom_bridge", output="screen",
             parameters=[parameters]),
    ])
