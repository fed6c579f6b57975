"""scanloom_bridge as a node of ROS 2."""
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.clock import Clock, ClockType
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from . import core

_OF_RCLPY = ("use_sim_time", "start_type_description_service")  # parameters of every node


def _qos(depth, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE):
    return QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=depth, reliability=reliability, durability=durability)


def _nanoseconds(stamp):
    return stamp.sec * 1_000_000_000 + stamp.nanosec


class RclpyOutput:
    """Publishes with rclpy; see core.Output."""

    def __init__(self, node, options):
        self._node = node
        self._map_frame = options.map_frame
        self._tf = node.create_publisher(TFMessage, "/tf", _qos(100)) if options.publish_tf else None
        self._map = node.create_publisher(
            OccupancyGrid, "map", _qos(1, durability=DurabilityPolicy.TRANSIENT_LOCAL)) if options.publish_map else None
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", _qos(10))

    def now(self):
        return self._node.get_clock().now().nanoseconds

    def log(self, level, text):
        logger = self._node.get_logger()
        {"info": logger.info, "warn": logger.warning, "error": logger.error}[level](text)

    def publish_transform(self, parent, child, stamp, pose):
        message = TransformStamped()
        message.header.stamp = Time(nanoseconds=stamp).to_msg()
        message.header.frame_id, message.child_frame_id = parent, child
        core.fill_pose(message.transform.translation, message.transform.rotation, pose)
        self._tf.publish(TFMessage(transforms=[message]))

    def publish_map(self, grid):
        message = OccupancyGrid()
        core.fill_grid(message, grid, self._map_frame)
        message.header.stamp = message.info.map_load_time = self._node.get_clock().now().to_msg()
        self._map.publish(message)

    def publish_diagnostics(self, level, text, values):
        message = DiagnosticArray()
        message.header.stamp = self._node.get_clock().now().to_msg()
        message.status = [DiagnosticStatus(level=bytes([level]), name=self._node.get_name(), message=text,
                                           hardware_id=values["session"],
                                           values=[KeyValue(key=key, value=value) for key, value in values.items()])]
        self._diagnostics.publish(message)


def _subscribe(node, bridge, options):
    for name in options.scan_topics:
        topic = node.resolve_topic_name(name)
        node.create_subscription(LaserScan, topic, lambda message, topic=topic: bridge.on_scan(
            core.scan_of(topic, message, _nanoseconds(message.header.stamp))),
            _qos(50, reliability=ReliabilityPolicy.BEST_EFFORT))
    for topic, is_static in (("/tf", False), ("/tf_static", True)):
        durability = DurabilityPolicy.TRANSIENT_LOCAL if is_static else DurabilityPolicy.VOLATILE
        node.create_subscription(TFMessage, topic, lambda message, is_static=is_static: bridge.on_transforms(
            [core.transform_of(one, _nanoseconds(one.header.stamp)) for one in message.transforms], is_static),
            _qos(100, durability=durability))
    if options.odom_topic:
        node.create_subscription(Odometry, options.odom_topic, lambda message: bridge.on_transforms(
            [core.odometry_of(message, _nanoseconds(message.header.stamp))], False), _qos(100))


def _run(node):
    parameters = {name: parameter.value for name, parameter in node.get_parameters_by_prefix("").items()
                  if name not in _OF_RCLPY and not name.startswith("qos_overrides.")}
    try:
        options = core.Options.of(parameters)
        bridge = core.Bridge(options, RclpyOutput(node, options))
    except (ValueError, OSError) as error:
        node.get_logger().fatal(str(error))
        return 2
    for name in core.Options.unknown(parameters):
        node.get_logger().warning(f"there is no parameter {name}; README.md lists them")
    _subscribe(node, bridge, options)
    # A steady clock: the timer also runs while the clock of a simulation stands still.
    node.create_timer(1.0 / options.tf_rate, bridge.tick, clock=Clock(clock_type=ClockType.STEADY_TIME))
    try:
        while rclpy.ok() and not bridge.failure:
            rclpy.spin_once(node, timeout_sec=0.1)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    return bridge.close()


def main():
    """Returns the exit code: 0, 1 after a failure or if scans are lost, 2 for invalid parameters."""
    rclpy.init()
    node = Node("scanloom_bridge", automatically_declare_parameters_from_overrides=True)
    try:
        return _run(node)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
