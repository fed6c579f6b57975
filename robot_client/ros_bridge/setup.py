"""Builds the package: with colcon for ROS 2, and for ROS 1 as catkin_python_setup() in CMakeLists.txt asks."""
import os

from setuptools import setup

name = "scanloom_bridge"
ros2 = {
    "data_files": [
        ("share/ament_index/resource_index/packages", ["resource/" + name]),
        ("share/" + name, ["package.xml"]),
        ("share/" + name + "/launch", ["launch/scanloom_bridge.launch.py"]),
    ],
    "install_requires": ["setuptools"],
    "zip_safe": False,
    "entry_points": {"console_scripts": ["scanloom_bridge = scanloom_bridge.rclpy_node:main"]},
}
setup(
    name=name,
    version="0.2.0",
    description="Streams laser scans to a Scanloom server, and publishes map -> odom and the map.",
    maintainer="The Scanloom authors",
    maintainer_email="scanloom@scanloom.invalid",
    license="Apache-2.0",
    packages=[name],
    package_dir={"": "."},
    **({} if os.environ.get("ROS_VERSION") == "1" else ros2),
)
