"""The node of ROS 2 with a small fake of rclpy and the real server."""
import array
import ast
import dataclasses
import math
import os
import pathlib
import runpy
import shutil
import sys
import tempfile
import types
import unittest
import unittest.mock
import xml.etree.ElementTree

import fake_rclpy

fake_rclpy.install()
from fake_rclpy import DurabilityPolicy, LaserScan, ReliabilityPolicy, TFMessage, TransformStamped, world  # noqa: E402
from fixture import PACKAGE, SECOND, core  # noqa: E402
from programs import RunningServer, run  # noqa: E402
from scanloom_bridge import rclpy_node  # noqa: E402


def stamp(seconds):
    return fake_rclpy.Time(nanoseconds=round(seconds * SECOND)).to_msg()


def transforms(parent, child, at, x):
    one = TransformStamped(child_frame_id=child)
    one.header.frame_id, one.header.stamp = parent, stamp(at)
    one.transform.translation.x = x
    return TFMessage(transforms=[one])


def scan(at):
    """A turn in a room of 4 m by 4 m, of a laser 1 m behind its middle plus the robot's way."""
    x = at - 101.0
    ranges = array.array("f")
    for n in range(360):
        cos, sin = math.cos(math.radians(n)), math.sin(math.radians(n))
        ranges.append(min((2.0 - x) / cos if cos > 1e-9 else (-2.0 - x) / cos if cos < -1e-9 else 9.0,
                          2.0 / abs(sin) if abs(sin) > 1e-9 else 9.0))
    one = LaserScan(angle_min=0.0, angle_increment=math.radians(1.0), range_min=0.1, range_max=10.0, ranges=ranges)
    one.header.frame_id, one.header.stamp = "laser", stamp(at)
    return one


class Node(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.server = RunningServer(directory.name)
        self.addCleanup(lambda: self.server.stop())
        world.__init__()

    def run_node(self, *steps, **parameters):
        world.steps = list(steps)
        world.parameters = {"server": self.server.address, "session": "s", "robot": "r", "poses": "odometry",
                            "http": f"http://127.0.0.1:{self.server.http_port}", **parameters}
        return rclpy_node.main()

    def texts(self, *levels):
        return [text for level, text in world.log if level in levels]

    def drive(self):
        world.send("/tf_static", transforms("base", "laser", 0.0, 0.0))
        world.send("/tf", transforms("odom", "base", 100.0, -1.0))
        for n in range(1, 21):
            world.send("/tf", transforms("odom", "base", 100.0 + 0.1 * n, -1.0 + 0.1 * n))
            world.send("/scan", scan(99.95 + 0.1 * n))
        world.now = 102 * SECOND

    def is_published(self, topic):
        return bool(world.published.get(topic))

    def test_scans_reach_the_server_and_corrections_and_the_map_come_back(self):
        code = self.run_node(self.drive, lambda: self.is_published("/tf"),
                             lambda: self.server.get_json("s")["scans"] == 20, self.is_newest_map,
                             publish_tf=True, publish_map=True, map_period=0.1)
        self.assertEqual((code, self.texts("warning", "error", "fatal")), (0, []))
        self.assertIn("ends: all 20 scans are stored", self.texts("info"))
        (correction,) = world.published["/tf"][0].transforms
        self.assertEqual((correction.header.frame_id, correction.child_frame_id), ("map", "odom"))
        self.assertEqual((correction.header.stamp.sec, correction.header.stamp.nanosec), (102, SECOND // 10))
        status = world.published["/diagnostics"][0].status[0]
        self.assertEqual((status.level, status.name), (b"\x01", "scanloom_bridge"))

    def is_newest_map(self):
        """Returns whether the map that was published last is that of the server."""
        if not self.is_published("/map"):
            return False
        newest = world.published["/map"][-1]
        rows = [row.split(",") for row in self.server.get("s/map.csv").split()]
        expected = [-1 if cell == "-1" else int(cell) for row in reversed(rows) for cell in row]
        sure = [n for n, cell in enumerate(expected) if cell < 20 or cell > 65]
        return (newest.info.width, newest.info.height) == (len(rows[0]), len(rows)) and all(
            newest.data[n] == (-1 if expected[n] < 0 else 100 if expected[n] > 65 else 0) for n in sure)

    def test_the_qualities_of_service_are_those_of_the_others(self):
        self.run_node(lambda: True, publish_tf=True, publish_map=True)
        self.assertEqual(world.subscriptions["/scan"][1].reliability, ReliabilityPolicy.BEST_EFFORT)
        for topic, durability in (("/tf", DurabilityPolicy.VOLATILE), ("/tf_static", DurabilityPolicy.TRANSIENT_LOCAL)):
            self.assertEqual(world.subscriptions[topic][1].durability, durability)
            self.assertEqual(world.subscriptions[topic][1].reliability, ReliabilityPolicy.RELIABLE)
        latched = world.profiles["/map"]
        self.assertEqual((latched.depth, latched.reliability, latched.durability),
                         (1, ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL))

    def test_its_timer_does_not_depend_on_the_clock_of_a_simulation(self):
        self.run_node(lambda: True, tf_rate=20.0)
        ((period, _, clock),) = world.timers
        self.assertEqual((period, clock.clock_type), (0.05, fake_rclpy.ClockType.STEADY_TIME))

    def test_without_parameters_it_publishes_diagnostics_only(self):
        self.run_node(lambda: True)
        self.assertEqual(set(world.profiles), {"/diagnostics"})

    def test_odometry_messages_replace_transforms(self):
        def odometry():
            for n in range(3):
                one = fake_rclpy.Odometry(child_frame_id="laser")
                one.header.frame_id, one.header.stamp = "odom", stamp(100.0 + n)
                one.pose.pose.position.x = float(n)
                world.send("/wheels", one)
            world.send("/scan", scan(101.5))

        self.assertEqual(self.run_node(odometry, lambda: True, odom_topic="wheels"), 0)
        self.assertEqual(self.server.get_json("s")["scans"], 1)

    def test_invalid_parameters_are_exit_code_2(self):
        self.assertEqual(self.run_node(lambda: True, session=""), 2)
        self.assertIn("session is missing", self.texts("fatal")[0])
        self.assertFalse(world.has_node)

    def test_unknown_parameters_are_reported(self):
        self.run_node(lambda: True, sever="x", use_sim_time=True, **{"qos_overrides./tf.publisher.depth": 5})
        self.assertEqual(self.texts("warning"), ["there is no parameter sever; README.md lists them"])

    def test_an_interrupt_waits_for_the_scans(self):
        def interrupt():
            self.drive()
            for _, callback, _ in world.timers:
                callback()
            raise KeyboardInterrupt

        self.assertEqual(self.run_node(interrupt), 0)
        self.assertEqual(self.server.get_json("s")["scans"], 20)

    def test_a_server_that_is_away_is_exit_code_1(self):
        code = self.run_node(self.drive, lambda: True, close_wait=0.0, server="127.0.0.1:1")
        self.assertEqual(code, 1)
        self.assertIn("20 scans are not acknowledged", self.texts("error")[0])


class Package(unittest.TestCase):
    def test_setuptools_installs_what_ros_2_looks_for(self):
        with tempfile.TemporaryDirectory() as directory:
            source, target = pathlib.Path(directory, "source"), pathlib.Path(directory, "target")
            shutil.copytree(PACKAGE, source)  # copies files instead of links
            code, out, errors = run(sys.executable, "setup.py", "install", "--root", target, "--prefix", "/w",
                                    cwd=source, env={**os.environ, "ROS_VERSION": "2"})
            self.assertEqual(code, 0, out + errors)
            installed = {path.name: path for path in target.rglob("*") if path.is_file()}
            for end in ("lib/scanloom_bridge/scanloom_bridge", "share/scanloom_bridge/package.xml",
                        "share/ament_index/resource_index/packages/scanloom_bridge",
                        "share/scanloom_bridge/launch/scanloom_bridge.launch.py", "scanloom_bridge/scanloom_client.py"):
                found = [path for path in target.rglob(end.rpartition("/")[2]) if str(path).endswith(end)]
                self.assertEqual(len(found), 1, end)
            self.assertIn("scanloom_bridge.rclpy_node:main", installed["entry_points.txt"].read_text())


class PythonVersion(unittest.TestCase):
    def test_the_package_and_the_client_need_no_syntax_beyond_3_8(self):
        sources = [*PACKAGE.rglob("*.py"), PACKAGE / "scripts/scanloom_bridge"]
        self.assertIn("scanloom_client.py", [source.name for source in sources])
        for source in sources:
            ast.parse(source.read_text(), str(source), feature_version=(3, 8))


class EachParameter(unittest.TestCase):
    """Parameters of the node are arguments of both launch files, without defaults of their own, and in README.md."""

    NAMES = [field.name for field in dataclasses.fields(core.Options)]
    DEFAULTS = {name: None if name == "session" else "" for name in NAMES}  # of arguments; session must be stated

    def test_is_an_argument_in_ros_1(self):
        tree = xml.etree.ElementTree.parse(PACKAGE / "launch/scanloom_bridge.launch")
        self.assertEqual({arg.get("name"): arg.get("default") for arg in tree.iter("arg")}, self.DEFAULTS)
        self.assertEqual({param.get("name"): (param.get("value"), param.get("type")) for param in tree.iter("param")},
                         {name: (f"$(arg {name})", "str") for name in self.NAMES})

    def test_is_an_argument_in_ros_2(self):
        fakes = {"launch": {"LaunchDescription": list},
                 "launch.actions": {"DeclareLaunchArgument": lambda name, default_value: (name, default_value)},
                 "launch.substitutions": {"LaunchConfiguration": lambda name: f"$(arg {name})"},
                 "launch_ros.actions": {"Node": lambda **fields: fields},
                 "launch_ros.parameter_descriptions": {"ParameterValue": lambda value, value_type: (value, value_type)}}
        with unittest.mock.patch.dict(sys.modules, {name: types.SimpleNamespace(**of) for name, of in fakes.items()}):
            file = runpy.run_path(str(PACKAGE / "launch/scanloom_bridge.launch.py"))
        *arguments, node = file["generate_launch_description"]()
        self.assertEqual(dict(arguments), {**self.DEFAULTS, "use_sim_time": "false"})
        self.assertEqual(node["parameters"], [{**{name: (f"$(arg {name})", str) for name in self.NAMES},
                                               "use_sim_time": ("$(arg use_sim_time)", bool)}])

    def test_is_in_the_readme_with_its_default(self):
        table = (PACKAGE / "README.md").read_text().split("\n## Parameters\n")[1].split("\n## ")[0]
        defaults = {}
        for row in table.splitlines():
            if row.startswith("| `"):
                names, stated = (cell.replace("`", "").strip().split(", ") for cell in row.split("|")[1:3])
                defaults.update(zip(names, stated + [""] * len(names)))
        self.assertEqual(sorted(defaults), sorted(self.NAMES))
        for field in dataclasses.fields(core.Options):
            if field.default:
                value = field.default[0] if isinstance(field.default, tuple) else field.default
                self.assertEqual(defaults[field.name], str(value), field.name)


if __name__ == "__main__":
    unittest.main()
