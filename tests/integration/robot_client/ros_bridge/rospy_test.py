"""The node of ROS 1 with Debian's rosmaster, rospy, rostopic and tf2, and the real server."""
import hashlib
import math
import os
import pathlib
import signal
import sys
import threading
import unittest
import urllib.error
from time import monotonic

import catkin_pkg.package
import ros_fixture
import rospy
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray
from fixture import PACKAGE
from nav_msgs.msg import OccupancyGrid
from programs import PROGRAMS, run, scanloom_client
from ros_fixture import START, WAIT, RosTest, pose_at, transform, write_bag
from tf2_msgs.msg import TFMessage

setUpModule, tearDownModule = ros_fixture.setUpModule, ros_fixture.tearDownModule


class Heard:
    """The messages of a topic."""

    def __init__(self, test, topic, kind, is_wanted=lambda message: True):
        self.messages = []
        self._changed = threading.Condition()
        self._is_wanted = is_wanted
        subscriber = rospy.Subscriber(topic, kind, self._take)
        test.addCleanup(subscriber.unregister)

    def _take(self, message):
        if self._is_wanted(message):
            with self._changed:
                self.messages.append(message)
                self._changed.notify_all()

    def wait_for(self, condition):
        with self._changed:
            return self._changed.wait_for(lambda: condition(self.messages), WAIT)


def is_of_odometry(message):
    return any(one.child_frame_id == "odom" for one in message.transforms)


class Drive(RosTest):
    SCANS = 50  # of both lasers

    def setUp(self):
        super().setUp()
        self.bag = pathlib.Path(self.directory) / "drive.bag"
        write_bag(self.bag)

    def test_a_played_bag_gives_the_map_of_its_replay(self):
        self.start_bridge(scan_topics="scan,rear/scan", poses="odometry")
        ros_fixture.player.wait_for_subscribers(rear__scan=1)
        self.play()
        given = 0
        for time, topic, message in ros_fixture.messages_of(self.bag):  # in order, although they come by several links
            ros_fixture.player.at(time, topic, message)
            if topic != "/tf":
                given += topic.endswith("scan")
                continue
            until = monotonic() + WAIT
            while self.stored() < given:
                self.assertLess(monotonic(), until, self.output())
        self.wait_for_line("sends scans with poses odometry (odom -> base_link)")
        self.assertEqual(self.finish(signal.SIGINT), 0)
        self.assertIn(f"ends: all {self.SCANS} scans are stored", self.output())
        self.assertNotIn("WARN", self.output())
        code, _, errors = run(PROGRAMS / "scanloom-robot", "--server", self.server.address, "--session", "replayed",
                              "--robot", "r", "replay", self.bag)
        self.assertEqual(code, 0, errors)
        bridged, replayed = (self.server.get_json(session + "/digest") for session in ("s", "replayed"))
        self.assertEqual(bridged["layers"], replayed["layers"])

    def stored(self):
        try:
            return self.server.get_json("s")["scans"]
        except urllib.error.HTTPError:  # there is no session yet
            return 0

    def test_tf2_accepts_the_transform_of_odometry(self):
        heard = Heard(self, "/tf", TFMessage, is_of_odometry)
        buffer = tf2_ros.Buffer()
        tf2_ros.TransformListener(buffer)
        self.start_bridge(poses="odometry", publish_tf=True)
        self.play(self.bag, subscribers=2)
        self.assertTrue(heard.wait_for(bool), self.output())
        last = START + 4.1
        for n in range(1, 6):  # the robot goes on, while the node publishes where its odometry is
            at = last + 0.1 * n
            ros_fixture.player.at(at, "/tf", TFMessage([transform(at, "odom", "base_link", *pose_at(at - START))]))
            self.assertTrue(heard.wait_for(lambda all, at=at: all[-1].transforms[0].header.stamp.to_sec() > at + 0.09))
        stamps = [message.transforms[0].header.stamp for message in heard.messages]
        self.assertEqual(stamps, sorted(set(stamps)))
        found = buffer.lookup_transform("map", "base_link", rospy.Time.from_sec(last + 0.35), rospy.Duration(WAIT))
        x, y, _ = pose_at(last + 0.35 - START)
        x_first, y_first, yaw_first = pose_at(0.105)  # of the first scan, where the map begins
        expected = math.hypot(x - x_first, y - y_first)
        moved = found.transform.translation
        begin = self.server.get("s/trajectory.tum").splitlines()[1 if self.has_head() else 0].split()
        self.assertAlmostEqual(math.hypot(moved.x - float(begin[1]), moved.y - float(begin[2])), expected, delta=0.1)
        self.assertEqual(self.finish(signal.SIGINT), 0)

    def has_head(self):
        return self.server.get("s/trajectory.tum").startswith("#")

    def test_the_map_is_that_of_the_server_and_latched(self):
        maps = Heard(self, "/map", OccupancyGrid)
        diagnostics = Heard(self, "/diagnostics", DiagnosticArray)
        self.start_bridge(poses="odometry", publish_map=True, map_period=0.1)
        self.play(self.bag)
        self.assertTrue(maps.wait_for(lambda all: bool(all) and self.is_the_servers(all[-1])), self.output())
        code, out, errors = run("rostopic", "echo", "-n1", "/map/info", timeout=WAIT)
        self.assertEqual(code, 0, errors)
        self.assertIn(f"width: {maps.messages[-1].info.width}\n", out)
        self.assertTrue(diagnostics.wait_for(lambda all: any(one.status[0].message == "scans are sent" for one in all)))
        self.assertEqual(self.finish(signal.SIGINT), 0)

    def is_the_servers(self, grid):
        if self.server.get_json("s")["scans"] < 40:
            return False
        pgm = pathlib.Path(self.directory) / "map.pgm"
        with scanloom_client.socket.create_connection(("127.0.0.1", self.server.http_port)) as link:
            link.sendall(b"GET /api/v1/sessions/s/map.pgm HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            pgm.write_bytes(link.makefile("rb").read())
        head, _, image = pgm.read_bytes().partition(b"\r\n\r\n")
        self.assertIn(b"200 OK", head)
        size = [int(word) for line in image.split(b"\n")[1:3] if not line.startswith(b"#") for word in line.split()]
        pixels = image[-size[0] * size[1]:]
        rows = [pixels[n * size[0]:(n + 1) * size[0]] for n in range(size[1])]
        cells = [{254: 0, 0: 100, 205: -1}[pixel] for row in reversed(rows) for pixel in row]
        origin = self.server.get("s/map.yaml").split("origin: [")[1].split(",")
        at = grid.info.origin.position
        return ((grid.info.width, grid.info.height) == tuple(size) and list(grid.data) == cells and
                (at.x, at.y) == (float(origin[0]), float(origin[1])) and grid.header.frame_id == "map")

    def test_scans_of_an_outage_are_sent_afterwards(self):
        self.start_bridge(poses="odometry", close_wait=60.0)
        self.play(self.bag, until=2.0)
        self.wait_for_line("connected to")
        self.server.kill()
        ros_fixture.player.play(self.bag, since=2.0)
        self.wait_for_line("retrying")
        self.server = ros_fixture.RunningServer(self.directory, self.server.robot_port, self.server.http_port)
        self.assertEqual(self.finish(signal.SIGTERM), 0)
        self.assertEqual(self.server.get_json("s")["scans"], 40)


class Trouble(RosTest):
    def scan(self, seconds):
        return START + seconds, "/scan", ros_fixture.scan(seconds, "front", 0.2, False)

    def test_without_transforms_it_says_what_is_missing(self):
        self.start_bridge(poses="odometry", tf_wait=0.0, start_wait=0.0)
        self.play(self.scan(1.0))
        self.wait_for_line("a scan of /scan is skipped: no transforms lead from an odometry frame to ")
        self.assertEqual(self.finish(signal.SIGINT), 0)

    def test_a_server_that_is_away_does_not_hold_up_the_end(self):
        self.start_bridge(poses="none", base_frame="front", server="127.0.0.1:1", close_wait=0.1)
        self.play(self.scan(1.0))
        self.wait_for_line("cannot connect to 127.0.0.1:1: Connection refused; is scanloom-server running there?")
        self.assertEqual(self.finish(signal.SIGINT), 1)
        self.assertIn("ends with scans that are lost: 1 scans are not acknowledged", self.output())

    def test_a_session_with_other_settings_ends_the_node(self):
        scanloom_client.Client(self.server.address, session="s", robot="other", cell_size=0.1).close()
        self.start_bridge(poses="none", base_frame="front", cell_size=0.05)
        self.play(self.scan(1.0))
        self.send_scans_until_it_ends()
        self.assertEqual(self.finish(), 1)
        self.assertIn("cell_size", self.output())

    def test_invalid_parameters_are_exit_code_2(self):
        for reason, wrong in [("parameter session is 'my lab'", {"session": "my lab"}),
                              ("No such file or directory", {"token_file": "/none/token"})]:
            with self.subTest(reason):
                self.start_bridge(**wrong)
                self.assertEqual(self.finish(), 2)
                self.assertIn(reason, self.output())
                self.end_bridge()


    def test_without_a_master_it_says_so(self):
        uri = os.environ["ROS_MASTER_URI"]
        os.environ["ROS_MASTER_URI"] = "http://127.0.0.1:1"
        try:
            self.start_bridge()
        finally:
            os.environ["ROS_MASTER_URI"] = uri
        self.assertEqual(self.finish(), 1)
        self.assertIn("cannot use the ROS master http://127.0.0.1:1", self.output())


class Tokens(RosTest):
    """With a server that has the tokens of a robot and of a viewer."""

    def server_options(self):
        lines = ""
        for role in ("robot", "viewer"):
            self.file(role).write_text(role + "'s secret\n")
            digest = hashlib.sha256((role + "'s secret").encode()).hexdigest()
            lines += f'[[token]]\nname = "{role}"\nsha256 = "{digest}"\nrole = "{role}"\nsessions = ["*"]\n'
        self.file("wrong").write_text("wrong\n")
        self.file("tokens.toml").write_text(lines)
        self.file("tokens.toml").chmod(0o600)
        return "--tokens", str(self.file("tokens.toml"))

    def file(self, name):
        return pathlib.Path(self.directory) / name

    def start(self, **parameters):
        self.start_bridge(poses="none", base_frame="front", **parameters)
        self.play((START + 1.0, "/scan", ros_fixture.scan(1.0, "front", 0.2, False)))

    def test_a_wrong_token_ends_the_node(self):
        self.start(token_file=self.file("wrong"))
        self.send_scans_until_it_ends()
        self.assertEqual(self.finish(), 1)
        self.assertIn("the token that was sent is not valid here", self.output())

    def test_maps_need_the_token_of_a_viewer(self):
        self.start(token_file=self.file("robot"), publish_map=True, map_period=0.1)
        self.wait_for_line("the map is not published: ")
        self.wait_for_line("give the token of a viewer in map_token_file")
        self.assertEqual(self.finish(signal.SIGINT), 0)

    def test_maps_are_published_with_the_token_of_a_viewer(self):
        maps = Heard(self, "/map", OccupancyGrid)
        self.start(token_file=self.file("robot"), map_token_file=self.file("viewer"), publish_map=True, map_period=0.1)
        self.assertTrue(maps.wait_for(bool), self.output())
        self.assertEqual(self.finish(signal.SIGINT), 0)


class Catkin(RosTest):
    def test_the_manifest_is_valid_for_both(self):
        for version, kind, client in (("1", "catkin", "rospy"), ("2", "ament_python", "rclpy")):
            manifest = catkin_pkg.package.parse_package(str(PACKAGE / "package.xml"))
            manifest.evaluate_conditions({"ROS_VERSION": version})
            manifest.validate()
            self.assertEqual(manifest.get_build_type(), kind)
            self.assertIn(client, [one.name for one in manifest.exec_depends if one.evaluated_condition])

    def test_the_package_is_built_and_launched(self):
        folder = pathlib.Path(self.directory)
        environment = {**os.environ, "ROS_VERSION": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
        for command in (["cmake", "-S", PACKAGE, "-B", folder / "build", f"-DCMAKE_INSTALL_PREFIX={folder}/install",
                         f"-DCATKIN_DEVEL_PREFIX={folder}/devel", f"-DPYTHON_EXECUTABLE={sys.executable}"],
                        ["cmake", "--build", folder / "build", "--target", "install"]):
            code, out, errors = run(*command, env=environment)
            self.assertEqual(code, 0, out + errors)
        for space in ("devel", "install"):
            code, out, errors = run("bash", "-c", f"source {folder}/{space}/setup.bash && roslaunch scanloom_bridge "
                                    "scanloom_bridge.launch session:=lab tf_rate:=500", env=environment, timeout=WAIT)
            self.assertIn("parameter tf_rate is 500; 1 to 100 are possible", out + errors, space)


if __name__ == "__main__":
    unittest.main()
