"""Starts scanloom_bridge in ROS 2. Each parameter of the node is an argument; README.md describes them. An empty one
has the node's default."""
import dataclasses

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from scanloom_bridge.core import Options

DEFAULTS = {**{field.name: "" for field in dataclasses.fields(Options)},
            "session": None,  # must be stated
            "use_sim_time": "false"}


def generate_launch_description():
    parameters = {name: ParameterValue(LaunchConfiguration(name), value_type=bool if name == "use_sim_time" else str)
                  for name in DEFAULTS}
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=default) for name, default in DEFAULTS.items()),
        Node(package="scanloom_bridge", executable="scanloom_bridge", name="scanloom_bridge", output="screen",
             parameters=[parameters]),
    ])
