"""scanloom_bridge as a node of ROS 1."""
import signal
import sys
import time

import rosgraph
import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from . import core


def _time(stamp):
    return rospy.Time(stamp // 1_000_000_000, stamp % 1_000_000_000)


class RospyOutput:
    """Publishes with rospy; see core.Output."""

    def __init__(self, options):
        self._map_frame = options.map_frame
        self._tf = rospy.Publisher("/tf", TFMessage, queue_size=100) if options.publish_tf else None
        self._map = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True) if options.publish_map else None
        self._diagnostics = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=10)

    def now(self):
        return rospy.Time.now().to_nsec()

    def log(self, level, text):
        {"info": rospy.loginfo, "warn": rospy.logwarn, "error": rospy.logerr}[level]("%s", text)

    def publish_transform(self, parent, child, stamp, pose):
        message = TransformStamped()
        message.header.stamp = _time(stamp)
        message.header.frame_id, message.child_frame_id = parent, child
        core.fill_pose(message.transform.translation, message.transform.rotation, pose)
        self._tf.publish(TFMessage([message]))

    def publish_map(self, grid):
        message = OccupancyGrid()
        core.fill_grid(message, grid, self._map_frame)
        message.header.stamp = message.info.map_load_time = rospy.Time.now()
        self._map.publish(message)

    def publish_diagnostics(self, level, text, values):
        message = DiagnosticArray()
        message.header.stamp = rospy.Time.now()
        message.status = [DiagnosticStatus(level, rospy.get_name().lstrip("/"), text, values["session"],
                                           [KeyValue(key, value) for key, value in values.items()])]
        self._diagnostics.publish(message)


def _subscribe(bridge, options):
    for name in options.scan_topics:
        topic = rospy.resolve_name(name)
        rospy.Subscriber(topic, LaserScan, lambda message, topic=topic: bridge.on_scan(
            core.scan_of(topic, message, message.header.stamp.to_nsec())), queue_size=50)
    for topic, is_static in (("/tf", False), ("/tf_static", True)):
        rospy.Subscriber(topic, TFMessage, lambda message, is_static=is_static: bridge.on_transforms(
            [core.transform_of(one, one.header.stamp.to_nsec()) for one in message.transforms], is_static),
            queue_size=100)
    if options.odom_topic:
        rospy.Subscriber(options.odom_topic, Odometry, lambda message: bridge.on_transforms(
            [core.odometry_of(message, message.header.stamp.to_nsec())], False), queue_size=100)


def _run(is_ended):
    try:
        parameters = rospy.get_param("~", {})
        options = core.Options.of(parameters)
        bridge = core.Bridge(options, RospyOutput(options))
    except (ValueError, OSError) as error:
        rospy.logfatal("%s", error)
        return 2
    for name in core.Options.unknown(parameters):
        rospy.logwarn("there is no parameter %s; README.md lists them", name)
    _subscribe(bridge, options)
    while not is_ended() and not bridge.failure:
        bridge.tick()
        time.sleep(1.0 / options.tf_rate)  # in real time, also while the clock of a simulation stands still
    return bridge.close()


def main():
    """Returns the exit code: 0, 1 after a failure or if scans are lost, 2 for invalid parameters."""
    try:
        # rospy's own handlers of signals can block for ever: they may interrupt a call that holds the lock they need.
        rospy.init_node("scanloom_bridge", disable_signals=True)
    except (rospy.exceptions.ROSException, OSError) as error:
        print(f"scanloom_bridge: cannot use the ROS master {rosgraph.get_master_uri()}: {error}; is roscore running "
              "there?", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 1  # rospy has said that it waits for the master
    signals = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: signals.append(number))
    try:
        return _run(lambda: signals or rospy.is_shutdown())
    finally:
        rospy.signal_shutdown("the node has ended")
