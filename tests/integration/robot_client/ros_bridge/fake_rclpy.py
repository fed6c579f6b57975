"""A small rclpy with the documented interface of what scanloom_bridge uses, and the messages with their types.

install() puts the modules where `import` finds them. A test runs a node by steps: each spin_once() runs the timers and
then the next step, again and again until it returns true; after the last one the context is shut down.
"""
import array
import enum
import sys
import types

SECOND = 1_000_000_000


class ReliabilityPolicy(enum.Enum):
    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(enum.Enum):
    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class HistoryPolicy(enum.Enum):
    KEEP_LAST = 1
    KEEP_ALL = 2


class ClockType(enum.Enum):
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3


class QoSProfile:
    def __init__(self, *, history, depth, reliability, durability):
        self.history, self.depth, self.reliability, self.durability = history, depth, reliability, durability


class ExternalShutdownException(Exception):
    pass


def message(**fields):
    """Returns a class of messages with keyword arguments and setters that check types, as rosidl makes them."""

    class Message:
        __slots__ = ["_" + name for name in fields]

        def __init__(self, **given):
            for name, kind in fields.items():
                setattr(self, name, given.pop(name) if name in given else _default(kind))
            assert not given, f"unknown fields {given}"

    for name, kind in fields.items():
        def check(self, value, name=name, kind=kind):
            assert _fits(value, kind), f"{name} is {value!r}"
            setattr(self, "_" + name, value)

        setattr(Message, name, property(lambda self, name=name: getattr(self, "_" + name), check))
    return Message


def _default(kind):
    if isinstance(kind, list):
        return array.array(kind[0]) if isinstance(kind[0], str) else []
    return b"\0" if kind is bytes else kind()


def _fits(value, kind):
    if not isinstance(kind, list):
        return isinstance(value, kind) and (kind is not bytes or len(value) == 1)
    if isinstance(kind[0], str):
        return isinstance(value, array.array) and value.typecode == kind[0]
    return isinstance(value, list) and all(isinstance(one, kind[0]) for one in value)


class Quaternion(message(x=float, y=float, z=float, w=float)):
    def __init__(self, **given):
        super().__init__(**{"w": 1.0, **given})


Stamp = message(sec=int, nanosec=int)
Header = message(stamp=Stamp, frame_id=str)
Point = message(x=float, y=float, z=float)
Pose = message(position=Point, orientation=Quaternion)
Rigid = message(translation=Point, rotation=Quaternion)
TransformStamped = message(header=Header, child_frame_id=str, transform=Rigid)
TFMessage = message(transforms=[TransformStamped])
LaserScan = message(header=Header, angle_min=float, angle_max=float, angle_increment=float, time_increment=float,
                    scan_time=float, range_min=float, range_max=float, ranges=["f"], intensities=["f"])
MapMetaData = message(map_load_time=Stamp, resolution=float, width=int, height=int, origin=Pose)
OccupancyGrid = message(header=Header, info=MapMetaData, data=["b"])
PoseWithCovariance = message(pose=Pose)
Odometry = message(header=Header, child_frame_id=str, pose=PoseWithCovariance)
KeyValue = message(key=str, value=str)
DiagnosticStatus = message(level=bytes, name=str, message=str, hardware_id=str, values=[KeyValue])
DiagnosticArray = message(header=Header, status=[DiagnosticStatus])


class Time:
    def __init__(self, *, nanoseconds):
        self.nanoseconds = nanoseconds

    def to_msg(self):
        return Stamp(sec=self.nanoseconds // SECOND, nanosec=self.nanoseconds % SECOND)


class Clock:
    def __init__(self, *, clock_type):
        self.clock_type = clock_type


class World:
    """What a test sees and sets: the time, parameters, steps; published messages and log lines."""

    def __init__(self):
        self.now = 100 * SECOND
        self.parameters = {}
        self.steps = []
        self.published = {}  # lists by topic
        self.profiles = {}  # of publishers, by topic
        self.subscriptions = {}  # (callback, profile) by topic
        self.timers = []  # (period, callback, clock)
        self.log = []
        self.is_ok = False
        self.has_node = False

    def send(self, topic, one):
        self.subscriptions[topic][0](one)


world = World()


class Logger:
    def __init__(self):
        for level in ("info", "warning", "error", "fatal"):
            setattr(self, level, lambda text, level=level: world.log.append((level, text)))


class Publisher:
    def __init__(self, kind, topic):
        self._kind, self._topic = kind, topic

    def publish(self, one):
        assert isinstance(one, self._kind)
        assert world.is_ok, "published after the shutdown"
        world.published.setdefault(self._topic, []).append(one)


class RosClock:
    def now(self):
        return Time(nanoseconds=world.now)


class Node:
    def __init__(self, name, *, automatically_declare_parameters_from_overrides=False):
        assert automatically_declare_parameters_from_overrides
        self._name = name
        world.has_node = True

    def get_name(self):
        return self._name

    def get_logger(self):
        return Logger()

    def get_clock(self):
        return RosClock()

    def get_parameters_by_prefix(self, prefix):
        assert prefix == ""
        return {name: types.SimpleNamespace(value=value) for name, value in world.parameters.items()}

    def resolve_topic_name(self, topic):
        return topic if topic.startswith("/") else "/" + topic

    def create_publisher(self, kind, topic, qos_profile):
        topic = self.resolve_topic_name(topic)
        world.profiles[topic] = qos_profile
        return Publisher(kind, topic)

    def create_subscription(self, kind, topic, callback, qos_profile):
        def checked(one):
            assert isinstance(one, kind)
            callback(one)

        world.subscriptions[self.resolve_topic_name(topic)] = (checked, qos_profile)

    def create_timer(self, timer_period_sec, callback, callback_group=None, clock=None):
        world.timers.append((timer_period_sec, callback, clock))

    def destroy_node(self):
        world.has_node = False


def spin_once(node, *, timeout_sec):
    for _, callback, _ in world.timers:
        callback()
    if world.steps and world.steps[0]() is not False:
        del world.steps[0]
    world.is_ok = bool(world.steps)


def install():
    modules = {
        "rclpy": {"init": lambda: setattr(world, "is_ok", True), "ok": lambda: world.is_ok, "spin_once": spin_once,
                  "try_shutdown": lambda: setattr(world, "is_ok", False)},
        "rclpy.clock": {"Clock": Clock, "ClockType": ClockType},
        "rclpy.executors": {"ExternalShutdownException": ExternalShutdownException},
        "rclpy.node": {"Node": Node},
        "rclpy.qos": {"DurabilityPolicy": DurabilityPolicy, "HistoryPolicy": HistoryPolicy, "QoSProfile": QoSProfile,
                      "ReliabilityPolicy": ReliabilityPolicy},
        "rclpy.time": {"Time": Time},
        "diagnostic_msgs.msg": {"DiagnosticArray": DiagnosticArray, "DiagnosticStatus": DiagnosticStatus,
                                "KeyValue": KeyValue},
        "geometry_msgs.msg": {"TransformStamped": TransformStamped},
        "nav_msgs.msg": {"OccupancyGrid": OccupancyGrid, "Odometry": Odometry},
        "sensor_msgs.msg": {"LaserScan": LaserScan},
        "tf2_msgs.msg": {"TFMessage": TFMessage},
    }
    for name, members in modules.items():
        module = sys.modules[name] = types.ModuleType(name)
        vars(module).update(members)
        sys.modules.setdefault(name.partition(".")[0], types.ModuleType(name.partition(".")[0]))
