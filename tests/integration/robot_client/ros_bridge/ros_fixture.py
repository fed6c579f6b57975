"""A master of ROS 1 on a free port, bags of a simulated drive, and their player."""
import math
import os
import shutil
import signal as signals
import subprocess
import sys
import tempfile
import threading
import unittest

os.environ.update(ROS_IP="127.0.0.1", ROS_HOSTNAME="127.0.0.1", ROS_LOG_DIR=tempfile.mkdtemp(prefix="scanloom-ros-"),
                  PYTHONDONTWRITEBYTECODE="1")

import rosbag  # noqa: E402
import rospy  # noqa: E402
from fixture import PACKAGE  # noqa: E402
from geometry_msgs.msg import TransformStamped  # noqa: E402
from programs import RunningServer  # noqa: E402
from rosgraph_msgs.msg import Clock  # noqa: E402
from sensor_msgs.msg import LaserScan  # noqa: E402
from tf2_msgs.msg import TFMessage  # noqa: E402

# Ends with its standard input, that is, with the test.
MASTER = """
import rosmaster.master
import sys
master = rosmaster.master.Master(0)
master.start()
print(master.uri, flush=True)
sys.stdin.read()
master.stop()
"""
START = 1_500_000_000.0  # of the bag, in seconds
WAIT = 60.0  # seconds, for what comes within a moment unless the computer is very busy
ROLLED = (1.0, 0.0, 0.0, 0.0)  # upside down


def setUpModule():
    """Starts the master once; a process can be a node only once."""
    global _master, player
    _master = subprocess.Popen([sys.executable, "-c", MASTER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    os.environ["ROS_MASTER_URI"] = _master.stdout.readline().strip()
    rospy.set_param("/use_sim_time", True)
    rospy.init_node("test", disable_signals=True)
    player = Player()


def tearDownModule():
    rospy.signal_shutdown("the tests have ended")
    _master.communicate()
    shutil.rmtree(os.environ["ROS_LOG_DIR"])


def transform(at, parent, child, x=0.0, y=0.0, yaw=0.0, rotation=None):
    one = TransformStamped(child_frame_id=child)
    one.header.frame_id, one.header.stamp = parent, rospy.Time.from_sec(at)
    one.transform.translation.x, one.transform.translation.y = x, y
    turn = one.transform.rotation
    turn.x, turn.y, turn.z, turn.w = rotation or (0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0))
    return one


def pose_at(seconds):
    """Returns where the robot is after this time: on an arc."""
    yaw = 0.2 * seconds - 0.4
    return 2.5 * math.sin(yaw), -2.5 * math.cos(yaw) + 2.4, yaw


def reading(x, y, angle):
    """Returns the distance to the walls of a room of 8 m by 6 m with a pillar of 1 m by 1 m."""
    def box(x_min, x_max, y_min, y_max):
        cos, sin = math.cos(angle), math.sin(angle)
        along_x = sorted(((x_min - x) / cos, (x_max - x) / cos)) if cos else (-math.inf, math.inf)
        along_y = sorted(((y_min - y) / sin, (y_max - y) / sin)) if sin else (-math.inf, math.inf)
        return max(along_x[0], along_y[0]), min(along_x[1], along_y[1])

    into, out = box(1.5, 2.5, -2.0, -1.0)
    return into if 0.0 < into < out else box(-4.0, 4.0, -3.0, 3.0)[1]


def scan(seconds, frame, mount_x, upside_down):
    """Returns a turn of 120 beams whose beams are taken one after another; the laser sees 5 m."""
    message = LaserScan(angle_min=-math.pi / 2, angle_max=math.pi / 2, angle_increment=math.pi / 119,
                        time_increment=0.05 / 119, scan_time=0.1, range_min=0.1, range_max=5.0)
    message.header.frame_id, message.header.stamp = frame, rospy.Time.from_sec(START + seconds)
    for n in range(120):
        x, y, yaw = pose_at(seconds + n * message.time_increment)
        beam = message.angle_min + n * message.angle_increment
        length = reading(x + mount_x * math.cos(yaw), y + mount_x * math.sin(yaw),
                         yaw + (-beam if upside_down else beam))
        message.ranges.append(length if length <= 5.0 else 81.91 if upside_down else math.inf)
    message.ranges[7] = math.nan
    message.ranges[8] = 0.0
    return message


def write_bag(path, scans=40):
    """Writes a drive of 4 seconds: two lasers, one upside down whose driver writes 81.91 for no return; odometry."""
    with rosbag.Bag(str(path), "w") as bag:
        def write(topic, message, seconds):
            bag.write(topic, message, rospy.Time.from_sec(START + seconds))

        write("/tf_static", TFMessage([transform(START, "base_link", "front", x=0.2),
                                       transform(START, "base_link", "rear", x=-0.2, rotation=ROLLED)]), 0.0)
        for n in range(2 * scans + 4):
            seconds = 0.05 * n
            write("/tf", TFMessage([transform(START + seconds, "odom", "base_link", *pose_at(seconds))]), seconds)
            if n >= 2 and n % 2 == 0 and n < 2 * scans + 2:
                write("/scan", scan(seconds - 0.02, "front", 0.2, False), seconds)
            if n >= 2 and n % 8 == 1:
                write("/rear/scan", scan(seconds - 0.01, "rear", -0.2, True), seconds)


def messages_of(path):
    with rosbag.Bag(str(path)) as bag:
        for topic, message, time in bag.read_messages():
            yield time.to_sec(), topic, message


class Player:
    """Publishes messages, those of a bag for example, and the clock, as fast as it can."""

    TOPICS = {"/tf_static": TFMessage, "/tf": TFMessage, "/scan": LaserScan, "/rear/scan": LaserScan}

    def __init__(self):
        self._clock = rospy.Publisher("/clock", Clock, queue_size=100, latch=True)
        self._peers = {}  # counts subscribers of each topic
        self._publishers = {}
        for topic, kind in self.TOPICS.items():
            peers = self._peers[topic] = threading.Semaphore(0)
            listener = rospy.SubscribeListener()
            listener.peer_subscribe = lambda *_, peers=peers: peers.release()
            self._publishers[topic] = rospy.Publisher(topic, kind, listener, latch=topic == "/tf_static",
                                                      queue_size=500)

    def begin(self):
        """Sets the clock to the begin of the bag, and ignores the subscribers that are there."""
        self._clock.publish(Clock(rospy.Time.from_sec(START)))
        for peers in self._peers.values():
            while peers.acquire(blocking=False):
                pass

    def wait_for_subscribers(self, **counts):
        """Waits until topics have so many subscribers more than at the begin: tf=1, scan=1."""
        for topic, count in counts.items():
            for _ in range(count):
                assert self._peers["/" + topic.replace("__", "/")].acquire(timeout=WAIT), f"{topic} has no subscriber"

    def play(self, path, until=math.inf, since=-math.inf):
        """until and since are in seconds after the begin."""
        for time, topic, message in messages_of(path):
            if since <= time - START < until:
                self.at(time, topic, message)

    def at(self, time, topic, message):
        self._clock.publish(Clock(rospy.Time.from_sec(time)))
        self._publishers[topic].publish(message)


class RosTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        self.server = RunningServer(self.directory, options=self.server_options())
        self.addCleanup(lambda: self.server.stop())
        player.begin()
        if rospy.has_param("/scanloom_bridge"):  # the master keeps parameters of earlier nodes
            rospy.delete_param("/scanloom_bridge")

    def server_options(self):
        return ()

    def start_bridge(self, **parameters):
        """Starts the node; finish() ends it."""
        given = {"server": self.server.address, "http": f"http://127.0.0.1:{self.server.http_port}", "session": "s",
                 "robot": "r", "tf_wait": 10.0, **parameters}
        paths = [str(PACKAGE), *sys.path]
        arguments = [f"_{name}:={value}" for name, value in given.items()]
        self.bridge = subprocess.Popen(
            [sys.executable, PACKAGE / "scripts/scanloom_bridge", *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths), "PYTHONUNBUFFERED": "1",
                 "PYTHONFAULTHANDLER": "1"})
        self.printed = []
        self.has_printed = threading.Condition()
        self._reader = threading.Thread(target=self._read)
        self._reader.start()
        self.addCleanup(self.end_bridge)

    def _read(self):
        for line in self.bridge.stdout:
            with self.has_printed:
                self.printed.append(line)
                self.has_printed.notify_all()

    def output(self):
        return "".join(self.printed)

    def wait_for_line(self, text):
        with self.has_printed:
            self.assertTrue(self.has_printed.wait_for(lambda: text in self.output(), WAIT), self.output())

    def play(self, *what, subscribers=1, **how):
        """Plays a bag, or messages (time, topic, message), when the node and so many others have subscribed."""
        player.wait_for_subscribers(tf=subscribers, tf_static=1, scan=1)
        for one in what:
            if isinstance(one, tuple):
                player.at(*one)
            else:
                player.play(one, **how)

    def finish(self, signal=None):
        """Returns the exit code, after a signal or by itself; no traceback was printed."""
        if signal:
            self.bridge.send_signal(signal)
        if not self.ends_within(WAIT):
            self.bridge.send_signal(signals.SIGABRT)  # prints the stacks of all threads
        code = self.bridge.wait()
        self._reader.join()
        self.assertNotIn("Traceback", self.output())
        self.assertGreaterEqual(code, 0, self.output())
        return code

    def send_scans_until_it_ends(self):
        """A scan after the server's answer meets its error."""
        for n in range(1, 1000):
            player.at(START + 1.0 + 0.1 * n, "/scan", scan(1.0 + 0.1 * n, "front", 0.2, False))
            if self.ends_within(0.05):
                return

    def ends_within(self, seconds):
        try:
            self.bridge.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def end_bridge(self):
        if self.bridge.poll() is None:
            self.bridge.kill()
        self.bridge.wait()
        self._reader.join()
        self.bridge.stdout.close()
