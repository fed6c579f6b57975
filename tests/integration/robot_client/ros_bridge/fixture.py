"""A Bridge without ROS and without a server, and the messages that it is given."""
import math
import pathlib
import sys
import types
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python"))
from programs import SOURCE  # noqa: E402

PACKAGE = SOURCE / "robot_client/ros_bridge"
sys.path.insert(0, str(PACKAGE))
from scanloom_bridge import core  # noqa: E402

SECOND = 1_000_000_000


def yaw_of(yaw):
    return 0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)


ROLLED = (1.0, 0.0, 0.0, 0.0)  # upside down


def transform(parent, child, at=0.0, translation=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0, 1.0)):
    """at is in seconds."""
    return core.Transform(parent, child, round(at * SECOND), core.Rigid(translation, rotation))


def scan(at, topic="/scan", frame="laser", ranges=(1.0, 2.0, 3.0), **more):
    """at is in seconds."""
    fields = {"angle_min": -0.1, "angle_increment": 0.1, "time_increment": 0.0, "range_min": 0.1, "range_max": 10.0}
    return core.Scan(topic, frame, round(at * SECOND), ranges=ranges, **{**fields, **more})


class FakeOutput:
    def __init__(self):
        self.time = 100.0  # of ROS, in seconds
        self.logged, self.transforms, self.diagnostics = [], [], []

    def now(self):
        return round(self.time * SECOND)

    def log(self, level, text):
        self.logged.append((level, text))

    def publish_transform(self, parent, child, stamp, pose):
        self.transforms.append((parent, child, stamp / SECOND, pose))

    def publish_map(self, grid):
        raise AssertionError("no test with this output requests maps")

    def publish_diagnostics(self, level, text, values):
        self.diagnostics.append((level, text, values))


class FakeClient:
    """Keeps what is sent. error is raised by the next send()."""

    def __init__(self, server, **options):
        self.server, self.options = server, options
        self.sensors, self.sent = [], []
        self.error = None
        self.location = None
        self.is_linked = True
        self.closed = None

    def laser(self, **description):
        self.sensors.append(description)
        return len(self.sensors) - 1

    def send(self, sensor, ranges, **scan):
        if self.error:
            raise self.error
        self.sent.append({"sensor": sensor, "ranges": ranges, **scan})

    def transform(self):
        return self.location

    def status(self):
        return types.SimpleNamespace(stored_before=0, acknowledged=len(self.sent), reconnects=0,
                                     is_linked=self.is_linked)

    def close(self, timeout):
        self.closed = timeout
        if self.error:
            raise self.error


class BridgeTest(unittest.TestCase):
    """A bridge whose clocks the test sets. start() makes it."""

    def start(self, **parameters):
        self.output = FakeOutput()
        self.real_time = 1000.0
        self.clients = []
        self.bridge = core.Bridge(core.Options.of({"session": "s", "robot": "r", **parameters}), self.output,
                                  connect=self._connect, clock=lambda: self.real_time)
        self.addCleanup(self.bridge.close)

    def _connect(self, server, **options):
        self.clients.append(FakeClient(server, **options))
        return self.clients[-1]

    @property
    def client(self):
        return self.clients[-1]

    def pass_time(self, seconds):
        self.real_time += seconds
        self.output.time += seconds
        self.bridge.tick()

    def give(self, *transforms, is_static=False):
        self.bridge.on_transforms(transforms, is_static)

    def give_mount(self):
        self.give(transform("base", "laser", translation=(0.2, 0.0, 0.3)), is_static=True)

    def give_odometry(self, *stamps, speed=1.0):
        """The robot drives along x."""
        self.give(*(transform("odom", "base", at, (speed * (at - 100.0), 0.0, 0.0)) for at in stamps))

    def start_with_odometry(self, **parameters):
        """Sends one scan, of 100.05 s."""
        self.start(**{"poses": "odometry", **parameters})
        self.give_mount()
        self.give_odometry(100.0, 100.1)
        self.bridge.on_scan(scan(100.05))
        self.bridge.tick()
        self.assertEqual(len(self.client.sent), 1)

    def logged(self, level):
        return [text for at, text in self.output.logged if at == level]

    def assert_skipped(self, reason, count=1):
        found = {text: n for text, n in self.bridge.reports.counts().items() if reason in text}
        self.assertEqual(sum(found.values()), count, self.bridge.reports.counts())
