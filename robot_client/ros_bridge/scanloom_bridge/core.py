"""The part of scanloom_bridge that knows no ROS: frames, conversions, what is sent and published when, and reports.

A front (rospy_node.py, rclpy_node.py) passes scans and transforms to a Bridge, calls tick() some 30 times a second, and
publishes what the Bridge passes to its Output. Frames, mounts and readings are interpreted as `scanloom-robot replay`
interprets them in a recording (robot_client/ros).

Units are metres, radians counter-clockwise, and nanoseconds for stamps; durations are in seconds. T_a_b takes points of
frame b to frame a. A pose in the plane is (x, y, yaw).
"""
from __future__ import annotations

import array
import bisect
import collections
import dataclasses
import http.client
import logging
import math
import re
import socket
import ssl
import threading
import time
import urllib.parse
import zlib
from typing import Any, Callable, Deque, Dict, List, Mapping, Optional, Protocol, Sequence, Set, Tuple, Union

from . import scanloom_client

Pose = Tuple[float, float, float]
Vector = Tuple[float, float, float]
Quaternion = Tuple[float, float, float, float]  # x, y, z, w

_SECOND = 1_000_000_000  # nanoseconds
_CLOCK_STEP = 2 * _SECOND  # stamps that go back by more mean that the clock was set back
_BELIEVED_RANGE_MAX = 50.0  # metres; drivers often state more than their laser sees
_BEAMS_MAX = 4096
_FULL_TURN = 2.0 * math.pi + 1e-3  # a full turn of float32 increments exceeds 2 pi
_DURATION_MAX = 10.0  # seconds, of a scan
_ONE_BEAM_INCREMENT = 0.01  # radians, of a laser with one beam: any but 0
_TILT_MAX = math.radians(15.0)
_COORDINATE_MAX = 1e6  # metres
_WAITING_MAX = 512  # scans


# Parameters -----------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Options:
    """The parameters of the node. README.md describes them."""

    session: str = ""
    server: str = "127.0.0.1:7447"
    robot: str = ""
    poses: str = "auto"
    scan_topics: Tuple[str, ...] = ("scan",)
    odom_topic: str = ""
    base_frame: str = ""
    odom_frame: str = ""
    map_frame: str = "map"
    tf_wait: float = 1.0
    start_wait: float = 5.0
    publish_tf: bool = False
    tf_rate: float = 30.0
    tf_tolerance: float = 0.1
    publish_map: bool = False
    map_period: float = 2.0
    http: str = ""
    token_file: str = ""
    map_token_file: str = ""
    tls: bool = False
    tls_ca: str = ""
    tls_cert: str = ""
    tls_key: str = ""
    cell_size: float = 0.0
    range_max: float = 0.0
    zero: str = "broken"
    beyond_max: str = "auto"
    buffer_mb: int = 32
    close_wait: float = 5.0

    @staticmethod
    def of(parameters: Mapping[str, Any]) -> Options:
        """Returns the options of a node's parameters. Raises ValueError with a sentence about an invalid one."""
        fields = {field.name: field for field in dataclasses.fields(Options)}
        given = {name: _parameter(name, value, fields[name].default)
                 for name, value in parameters.items() if name in fields}
        options = Options(**given)
        options = dataclasses.replace(options, robot=options.robot or _host_name(),
                                      http=(options.http or _http_address(options)).rstrip("/"))
        if not options.session:
            raise ValueError("parameter session is missing; give the map's name on the server")
        for name, (pattern, needed) in _PATTERNS.items():
            if not re.fullmatch(pattern, getattr(options, name)):
                raise ValueError(f"parameter {name} is {getattr(options, name)!r}; {needed}")
        for name, choices in _CHOICES.items():
            if getattr(options, name) not in choices:
                raise ValueError(f"parameter {name} is {getattr(options, name)!r}; {', '.join(choices)} are possible")
        for name, (low, high) in _BOUNDS.items():
            if not low <= getattr(options, name) <= high:
                raise ValueError(f"parameter {name} is {getattr(options, name):g}; {low:g} to {high:g} are possible")
        if options.publish_tf and options.poses == "map":
            raise ValueError("parameter publish_tf needs poses odometry or none: with poses map the transforms of the "
                             "robot already lead to the map's frame")
        return options

    @staticmethod
    def unknown(parameters: Mapping[str, Any]) -> List[str]:
        """Returns the names that are no parameters of the node."""
        known = {field.name for field in dataclasses.fields(Options)}
        return sorted(name for name in parameters if name not in known)

    def tls_context(self) -> Optional[ssl.SSLContext]:
        """Raises OSError if a file cannot be read."""
        if not (self.tls or self.tls_ca or self.tls_cert):
            return None
        context = ssl.create_default_context(cafile=self.tls_ca or None)
        if self.tls_cert:
            context.load_cert_chain(self.tls_cert, self.tls_key or None)
        return context


_NAME = ("[A-Za-z0-9_-]{1,64}", "1 to 64 letters, digits, '_' and '-' are possible")
_PATTERNS = {"session": _NAME, "robot": _NAME, "server": (r"\S+:\d{1,5}", "HOST:PORT is needed"),
             "http": (r"https?://[^\s/?#]+", "http://HOST:PORT or https://HOST:PORT is needed")}
_CHOICES = {"poses": ("auto", "map", "odometry", "none"), "zero": ("broken", "no-return"),
            "beyond_max": ("auto", "broken", "no-return")}
_BOUNDS = {"tf_wait": (0.0, 10.0), "start_wait": (0.0, 60.0), "tf_rate": (1.0, 100.0), "tf_tolerance": (0.0, 10.0),
           "map_period": (0.1, 3600.0), "cell_size": (0.0, 1.0), "range_max": (0.0, 1000.0), "buffer_mb": (1, 4096),
           "close_wait": (0.0, 600.0)}


def _parameter(name: str, value: Any, default: Any) -> Any:
    """Returns a value of the default's type. The launch files pass text, which is empty for what is not stated."""
    if value == "":
        return default
    if isinstance(default, tuple):
        topics = value.replace(",", " ").split() if isinstance(value, str) else value
        if isinstance(topics, (list, tuple)) and topics and all(isinstance(topic, str) and topic for topic in topics):
            return tuple(topics)
        raise ValueError(f"parameter {name} is {value!r}; names of topics are needed")
    if isinstance(value, str) and not isinstance(default, str):
        value = _read_text(value, type(default))
    if isinstance(default, str) and isinstance(value, int) and not isinstance(value, bool):
        return str(value)  # ROS reads robot:=1 as a number
    if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if type(value) is not type(default) or (isinstance(value, float) and not math.isfinite(value)):
        needed = {bool: "true or false is", int: "a whole number is", float: "a finite number is", str: "text is"}
        raise ValueError(f"parameter {name} is {value!r}; {needed[type(default)]} needed")
    return value


def _read_text(text: str, needed: type) -> Any:
    """Returns the truth value or number that the text is, or the text."""
    if needed is bool:
        return {"true": True, "false": False}.get(text.lower(), text)
    try:
        return needed(text)
    except ValueError:
        return text


def _token(file_name: str) -> str:
    """Returns the token of a file; empty without a file. Raises OSError if it cannot be read, ValueError if it is not
    text."""
    if not file_name:
        return ""
    with open(file_name, encoding="utf-8") as file:
        return file.read().strip()


def _host_name() -> str:
    return re.sub("[^A-Za-z0-9_-]", "-", socket.gethostname().split(".")[0])[:64] or "robot"


def _http_address(options: Options) -> str:
    host = options.server.rpartition(":")[0]
    return f"{'https' if options.tls or options.tls_ca or options.tls_cert else 'http'}://{host}:8080"


# Transforms -----------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Rigid:
    """A rigid transform T_a_b."""

    translation: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = (0.0, 0.0, 0.0, 1.0)

    def __mul__(self, other: Rigid) -> Rigid:
        x, y, z = self.rotate(other.translation)
        dx, dy, dz = self.translation
        return Rigid((x + dx, y + dy, z + dz), _product(self.rotation, other.rotation))

    def inverse(self) -> Rigid:
        x, y, z, w = self.rotation
        back = Rigid(rotation=(-x, -y, -z, w))
        x, y, z = back.rotate(self.translation)
        return Rigid((-x, -y, -z), back.rotation)

    def rotate(self, vector: Vector) -> Vector:
        x, y, z, _ = _product(_product(self.rotation, (*vector, 0.0)), Rigid._conjugate(self.rotation))
        return x, y, z

    @staticmethod
    def _conjugate(rotation: Quaternion) -> Quaternion:
        x, y, z, w = rotation
        return -x, -y, -z, w

    def planar(self) -> Pose:
        """Returns the pose in the plane: the direction of the x axis is the yaw."""
        x, y, _ = self.rotate((1.0, 0.0, 0.0))
        return self.translation[0], self.translation[1], math.atan2(y, x)

    def upright(self) -> float:
        """Returns the cosine of the angle between the z axes."""
        return self.rotate((0.0, 0.0, 1.0))[2]


def _product(p: Quaternion, q: Quaternion) -> Quaternion:
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (pw * qx + px * qw + py * qz - pz * qy, pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw, pw * qw - px * qx - py * qy - pz * qz)


def _between(a: Rigid, b: Rigid, share: float) -> Rigid:
    """Interpolates: translations linearly, rotations on the shorter arc (Shoemake, 1985)."""
    dot = sum(p * q for p, q in zip(a.rotation, b.rotation))
    arc = math.acos(min(abs(dot), 1.0))
    if arc < 1e-6:
        from_a, from_b = 1.0 - share, share
    else:
        from_a, from_b = math.sin((1.0 - share) * arc) / math.sin(arc), math.sin(share * arc) / math.sin(arc)
    mixed = [from_a * p + math.copysign(from_b, dot) * q for p, q in zip(a.rotation, b.rotation)]
    norm = math.sqrt(sum(part * part for part in mixed))
    x, y, z, w = (part / norm for part in mixed)
    tx, ty, tz = (p + share * (q - p) for p, q in zip(a.translation, b.translation))
    return Rigid((tx, ty, tz), (x, y, z, w))


@dataclasses.dataclass(frozen=True)
class Transform:
    """A transform of /tf or /tf_static."""

    parent: str
    child: str
    stamp: int
    T_parent_child: Rigid


def transform_of(message: Any, stamp: int) -> Optional[Transform]:
    """Returns a geometry_msgs/TransformStamped of either ROS, or None if it is none: numbers that are not finite, a
    rotation of zero, no child, or a frame in itself."""
    transform = message.transform
    return _transform(message, stamp, transform.translation, transform.rotation)


def odometry_of(message: Any, stamp: int) -> Optional[Transform]:
    """Returns the pose of a nav_msgs/Odometry of either ROS like transform_of()."""
    pose = message.pose.pose
    return _transform(message, stamp, pose.position, pose.orientation)


def _transform(message: Any, stamp: int, at: Any, turn: Any) -> Optional[Transform]:
    norm = math.hypot(turn.x, turn.y, turn.z, turn.w)
    parent, child = _frame_name(message.header.frame_id), _frame_name(message.child_frame_id)
    if not all(map(math.isfinite, (at.x, at.y, at.z, norm))) or norm < 1e-3 or not child or child == parent:
        return None
    rotation = (turn.x / norm, turn.y / norm, turn.z / norm, turn.w / norm)
    return Transform(parent, child, stamp, Rigid((at.x, at.y, at.z), rotation))


def _frame_name(name: str) -> str:
    """Returns the name without the leading "/" of early ROS 1."""
    return name[1:] if name.startswith("/") else name


class NoTransform(Exception):
    """Why the pose of a frame in another one is not known at a time.

    may_come  whether a later message may contain it
    """

    def __init__(self, reason: str, may_come: bool) -> None:
        super().__init__(reason)
        self.reason = reason
        self.may_come = may_come


class _Edge:
    """The transforms of a child to its parents."""

    def __init__(self) -> None:
        self.fixed: Optional[Transform] = None
        self.stamps: List[int] = []
        self.moving: List[Transform] = []  # by stamp


class FrameTree:
    """The transforms of the last seconds. A frame has one parent at a time."""

    KEPT = 10 * _SECOND
    HOLE_MAX = 2 * _SECOND  # transforms farther apart are not interpolated unless they are equal

    def __init__(self) -> None:
        self._edges: Dict[str, _Edge] = {}  # by child

    def add(self, transform: Transform, is_static: bool) -> None:
        """Adds a transform. Of several with the same child and stamp the first counts. A static one holds at all times,
        and replaces all others of its child."""
        edge = self._edges.setdefault(transform.child, _Edge())
        if is_static:
            edge.fixed = transform
            return
        place = bisect.bisect_left(edge.stamps, transform.stamp)
        if place < len(edge.stamps) and edge.stamps[place] == transform.stamp:
            return
        edge.stamps.insert(place, transform.stamp)
        edge.moving.insert(place, transform)
        old = bisect.bisect_left(edge.stamps, edge.stamps[-1] - self.KEPT)
        del edge.stamps[:old], edge.moving[:old]

    def forget_moving(self) -> None:
        """Removes all transforms that are not static."""
        self._edges = {child: edge for child, edge in self._edges.items() if edge.fixed}
        for edge in self._edges.values():
            edge.stamps, edge.moving = [], []

    def parent(self, frame: str) -> Optional[str]:
        """Returns the parent by the newest transform."""
        edge = self._edges.get(frame)
        if not edge:
            return None
        return (edge.fixed or edge.moving[-1]).parent

    def ancestors(self, frame: str) -> List[str]:
        """Returns the frame and those above it by the newest transforms. The list ends before a frame that it has."""
        chain = [frame]
        parent = self.parent(frame)
        while parent is not None and parent not in chain:
            chain.append(parent)
            parent = self.parent(parent)
        return chain

    def find(self, target: str, source: str, stamp: int) -> Rigid:
        """Returns T_target_source, interpolated between two stamps and never extrapolated. Raises NoTransform."""
        T_target_frame, _ = self._climb(target, stamp)
        T_source_frame, failure = self._climb(source, stamp)
        for frame, T_frame_source in T_source_frame.items():
            if frame in T_target_frame:
                return T_target_frame[frame].inverse() * T_frame_source
        raise failure or NoTransform(f"no transforms lead from {target} to {source}", may_come=True)

    def _climb(self, frame: str, stamp: int) -> Tuple[Dict[str, Rigid], Optional[NoTransform]]:
        """Returns the transforms of a frame to itself and to those above it, in this order, and why the last one has no
        frame above it; None: it has no parent at any time."""
        steps = {frame: Rigid()}
        while frame in self._edges:
            try:
                up = self._at(self._edges[frame], stamp)
            except NoTransform as failure:
                return steps, failure
            if up.parent in steps:
                return steps, NoTransform(f"the transforms above {frame} are a loop", may_come=True)
            steps[up.parent] = up.T_parent_child * steps[frame]
            frame = up.parent
        return steps, None

    def _at(self, edge: _Edge, stamp: int) -> Transform:
        if edge.fixed:
            return edge.fixed
        after = bisect.bisect_left(edge.stamps, stamp)
        names = f"{edge.moving[-1].parent} -> {edge.moving[-1].child}"
        if after == len(edge.stamps):
            raise NoTransform(f"the transforms {names} end before the scan", may_come=True)
        later = edge.moving[after]
        if later.stamp == stamp:
            return later
        if after == 0:
            raise NoTransform(f"the transforms {names} begin after the scan", may_come=False)
        earlier = edge.moving[after - 1]
        if (earlier.parent, earlier.T_parent_child) == (later.parent, later.T_parent_child):
            return earlier
        if earlier.parent != later.parent or later.stamp - earlier.stamp > self.HOLE_MAX:
            raise NoTransform(f"the transforms {names} have a hole of more than 2 s at the scan", may_come=False)
        share = (stamp - earlier.stamp) / (later.stamp - earlier.stamp)
        return dataclasses.replace(earlier, stamp=stamp,
                                   T_parent_child=_between(earlier.T_parent_child, later.T_parent_child, share))


# Choice of frames -----------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Frames:
    """poses is "map", "odometry" or "none"; base is the robot's frame; fixed is the frame of its poses, empty with
    poses "none"."""

    poses: str
    base: str
    fixed: str


def _is_map_name(frame: str) -> bool:
    return frame.rpartition("/")[2] in ("map", "world", "earth")


def _is_odometry_name(frame: str) -> bool:
    return "odom" in frame.rpartition("/")[2]


def available_frames(tree: FrameTree, laser_frame: str, options: Options) -> Union[Frames, str]:
    """Chooses the frames that the transforms offer now, or returns a sentence about what is missing.

    Without stated poses the best are chosen: in the map's frame, of odometry, none. A node that publishes map -> odom
    takes no poses from the map's frame.
    """
    stated = {frame for frame in (options.odom_frame, options.map_frame) if frame}

    def is_fixed(frame: str) -> bool:
        return frame in stated or _is_map_name(frame) or _is_odometry_name(frame)

    chain = tree.ancestors(laser_frame)
    first_fixed = next((n for n, frame in enumerate(chain) if n > 0 and is_fixed(frame)), len(chain))
    base = options.base_frame or chain[first_fixed - 1]
    up = f"frames from the laser up are: {', '.join(chain)}"
    above = tree.ancestors(base)
    if not set(above) & set(chain):
        return f"no transforms lead from {base} to {laser_frame}: publish the mount of the laser; {up}"
    del above[0]
    while above and not is_fixed(above[0]):
        del above[0]
    maps = [frame for frame in above if frame == options.map_frame] or [frame for frame in above if _is_map_name(frame)]
    odometry = [frame for frame in above if frame == options.odom_frame] if options.odom_frame else (
        [frame for frame in above if _is_odometry_name(frame)] or
        [frame for frame in above if not options.publish_tf])
    poses = options.poses
    if poses == "auto":
        poses = "map" if maps and not options.publish_tf else "odometry" if odometry else "none"
    if poses == "none":
        return Frames(poses, base, "")
    found = maps if poses == "map" else odometry
    if found:
        return Frames(poses, base, found[0])
    wanted = options.map_frame if poses == "map" else options.odom_frame or "an odometry frame"
    return f"no transforms lead from {wanted} to {base}; {up}"


# Scans ----------------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Scan:
    """A sensor_msgs/LaserScan. stamp is that of the first beam."""

    topic: str
    frame: str
    stamp: int
    angle_min: float
    angle_increment: float
    time_increment: float
    range_min: float
    range_max: float
    ranges: Sequence[float]

    def duration(self) -> float:
        """Returns the seconds from the first beam to the last; 0 if the message states none that can be."""
        duration = self.time_increment * max(len(self.ranges) - 1, 0)
        return duration if abs(duration) <= _DURATION_MAX else 0.0  # NaN, too, states nothing

    def middle(self) -> int:
        return self.stamp + round(self.duration() / 2.0 * _SECOND)

    def problem(self) -> str:
        """Returns why the scan cannot be used; empty: it can."""
        count = len(self.ranges)
        if count == 0:
            return "it has no beams"
        if count > _BEAMS_MAX:
            return f"it has more than {_BEAMS_MAX} beams"
        if not math.isfinite(self.angle_min) or not math.isfinite(self.angle_increment):
            return "its angles are not finite"
        if count > 1 and self.angle_increment == 0.0:
            return "its angle_increment is 0"
        if abs(self.angle_min) > 4.0 * math.pi or abs(self.angle_increment) * (count - 1) > _FULL_TURN:
            return "its beams span more than a full turn"
        return ""


def scan_of(topic: str, message: Any, stamp: int) -> Scan:
    """Returns a sensor_msgs/LaserScan of either ROS."""
    return Scan(topic, _frame_name(message.header.frame_id), stamp, message.angle_min, message.angle_increment,
                message.time_increment, message.range_min, message.range_max, message.ranges)


class RangeHabits:
    """Finds what the driver of a topic means by readings that are no lengths.

    REP 117 says: +inf is no return, everything else that is not between range_min and range_max is broken. Drivers that
    never send +inf may have an older habit: one number above range_max (such as 81.91) stands for no return. A reading
    of 0 is broken unless the options say otherwise: drivers also send it for what is too near.
    """

    def __init__(self, options: Options) -> None:
        self._options = options
        self._has_infinite = False
        self._beyond: Set[float] = set()  # readings above range_max, while they may be one number

    def readings(self, scan: Scan) -> List[float]:
        """Adds a scan, and returns its readings: infinity for no return, NaN for broken ones."""
        highest = scan.range_max if scan.range_max > 0.0 else math.inf  # NaN, too, states nothing
        self._has_infinite = self._has_infinite or math.inf in scan.ranges
        if len(self._beyond) < 2:
            self._beyond.update(reading for reading in scan.ranges if highest < reading < math.inf)
        has_marker = not self._has_infinite and len(self._beyond) == 1
        choice = self._options.beyond_max
        beyond = math.inf if choice == "no-return" or (choice == "auto" and has_marker) else math.nan
        zero = math.inf if self._options.zero == "no-return" else math.nan
        return [zero if reading == 0.0 else beyond if highest < reading < math.inf else reading
                for reading in scan.ranges]


@dataclasses.dataclass(frozen=True)
class Mount:
    """How a laser is mounted; with is_upside_down the angles of its beams are negated."""

    T_base_laser: Pose
    is_upside_down: bool

    def is_near(self, other: Mount) -> bool:
        (x, y, yaw), (ox, oy, other_yaw) = self.T_base_laser, other.T_base_laser
        turned = abs(math.remainder(yaw - other_yaw, 2.0 * math.pi))
        return self.is_upside_down == other.is_upside_down and max(abs(x - ox), abs(y - oy), turned) < 1e-3


def mount_of(T_base_laser: Rigid) -> Mount:
    """Returns the mount in the plane. Raises NoTransform if the laser is tilted by more than 15 degrees, or too far
    away."""
    upright = T_base_laser.upright()
    if abs(upright) < math.cos(_TILT_MAX):
        raise NoTransform("the laser is tilted by more than 15 degrees", may_come=False)
    x, y, yaw = T_base_laser.planar()
    if max(abs(x), abs(y)) > _COORDINATE_MAX:
        raise NoTransform("the laser is too far from its robot", may_come=False)
    return Mount((x, y, yaw), upright < 0.0)


@dataclasses.dataclass(frozen=True)
class _Described:
    """A sensor that the client knows."""

    topic: str
    mount: Mount
    limits: Tuple[float, float]  # range_min, range_max
    angles: Tuple[float, float]  # of the first beam, and between beams
    sensor: Any


class Lasers:
    """Sends scans, each as one of a sensor that is described by its topic, its mount and its range."""

    def __init__(self, client: Any, options: Options) -> None:
        self._client = client
        self._options = options
        self._habits: Dict[str, RangeHabits] = {}
        self._described: List[_Described] = []

    def send(self, scan: Scan, mount: Mount, **poses: Pose) -> None:
        """Raises ScanloomError like Client.send(), and ValueError if the mount has changed too often."""
        direction = -1.0 if mount.is_upside_down else 1.0
        increment = _ONE_BEAM_INCREMENT if len(scan.ranges) == 1 else scan.angle_increment
        angles = (direction * scan.angle_min, direction * increment)
        described = self._describe(scan, mount, angles)
        own = None
        if angles != described.angles:
            own = [angles[0] + n * angles[1] for n in range(len(scan.ranges))]
        readings = self._habits.setdefault(scan.topic, RangeHabits(self._options)).readings(scan)
        self._client.send(described.sensor, readings, stamp=scan.middle() / _SECOND, duration=scan.duration(),
                          angles=own, block=False, **poses)

    def _describe(self, scan: Scan, mount: Mount, angles: Tuple[float, float]) -> _Described:
        limits = self._limits(scan)
        for one in self._described:
            if one.topic == scan.topic and one.limits == limits and one.mount.is_near(mount):
                return one
        sensor = self._client.laser(angle_min=angles[0], angle_increment=angles[1], count=len(scan.ranges),
                                    range_min=limits[0], range_max=limits[1], mount=mount.T_base_laser,
                                    name=scan.topic.encode()[:64].decode(errors="ignore"))
        self._described.append(_Described(scan.topic, mount, limits, angles, sensor))
        return self._described[-1]

    def _limits(self, scan: Scan) -> Tuple[float, float]:
        stated = scan.range_max if scan.range_max > 0.0 else math.inf  # NaN, too, states nothing
        highest = self._options.range_max or min(stated, _BELIEVED_RANGE_MAX)
        return (scan.range_min if 0.0 < scan.range_min < highest else 0.0), highest


# The map --------------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Grid:
    """A nav_msgs/OccupancyGrid: rows from the lowest y, 0 free, 100 occupied, -1 unknown; origin is the corner of the
    first cell."""

    width: int
    height: int
    resolution: float
    origin: Pose
    cells: array.array[int]

    @staticmethod
    def of(pgm: bytes, yaml: str) -> Grid:
        """Reads map.pgm and map.yaml of the server. Raises ValueError if they are none."""
        head = re.match(rb"P5\s+(?:#[^\n]*\n\s*)*(\d+)\s+(?:#[^\n]*\n\s*)*(\d+)\s+255\s", pgm)
        number = r"([-+.\deE]+)"
        resolution = re.search(rf"^resolution: *{number}", yaml, re.MULTILINE)
        origin = re.search(rf"^origin: *\[{number}, *{number}, *{number}\]", yaml, re.MULTILINE)
        if not head or not resolution or not origin:
            raise ValueError("the server's map.pgm or map.yaml is not as expected; is its version that of the bridge?")
        width, height = int(head[1]), int(head[2])
        pixels = pgm[head.end():]
        if len(pixels) != width * height:
            raise ValueError(f"the server's map.pgm has {len(pixels)} pixels instead of {width} x {height}")
        rows = (pixels[row * width:(row + 1) * width] for row in reversed(range(height)))
        cells = array.array("b", b"".join(rows).translate(_CELL_OF_PIXEL))
        x, y, yaw = (float(part) for part in origin.groups())
        return Grid(width, height, float(resolution[1]), (x, y, yaw), cells)


_CELL_OF_PIXEL = bytes({254: 0, 0: 100}.get(pixel, 255) for pixel in range(256))  # 255 is -1


def fill_grid(message: Any, grid: Grid, frame: str) -> None:
    """Fills a nav_msgs/OccupancyGrid of either ROS, but for its stamps."""
    message.header.frame_id = frame
    message.info.resolution = grid.resolution
    message.info.width, message.info.height = grid.width, grid.height
    fill_pose(message.info.origin.position, message.info.origin.orientation, grid.origin)
    message.data = grid.cells


def fill_pose(position: Any, orientation: Any, pose: Pose) -> None:
    """Fills a position or translation, and an orientation or rotation, of either ROS."""
    position.x, position.y = pose[0], pose[1]
    orientation.z, orientation.w = math.sin(pose[2] / 2.0), math.cos(pose[2] / 2.0)


class MapRequests:
    """Requests the map of a session by HTTP. Raises ValueError if the port of the address is none."""

    TIMEOUT = 10.0
    BYTES_MAX = 65 << 20  # a server sends at most 64 million cells
    ATTEMPTS = 5

    def __init__(self, options: Options, token: str, tls: Optional[ssl.SSLContext]) -> None:
        address = urllib.parse.urlsplit(options.http)
        self._where = options.http
        self._host, self._port = address.hostname or "", address.port
        self._is_tls, self._tls = address.scheme == "https", tls
        self._path = f"/api/v1/sessions/{options.session}/map."
        self._headers = {"Accept-Encoding": "gzip", **({"Authorization": f"Bearer {token}"} if token else {})}
        self._tag = ""  # of the newest map

    def newest(self) -> Optional[Grid]:
        """Returns the map if it has changed since the previous call; None if it has not, or is empty. Raises OSError
        and ValueError with a sentence."""
        for _ in range(self.ATTEMPTS):
            yaml_tag, yaml = self._get("yaml", self._tag)
            if not yaml:
                return None
            pgm_tag, pgm = self._get("pgm", "")
            if pgm_tag == yaml_tag:  # else the map has grown in between, and they may differ in their extents
                grid = Grid.of(pgm, yaml.decode(errors="replace"))
                self._tag = pgm_tag
                return grid
        return None

    def _get(self, ending: str, known: str) -> Tuple[str, bytes]:
        """Returns a file and its tag; an empty file if it is known, or if there is no map yet."""
        status, answer_headers, body = self._answer(self._path + ending,
                                                    {**self._headers, **({"If-None-Match": known} if known else {})})
        if status in (304, 404):
            return known, b""
        if status in (401, 403):
            raise ValueError(f"{self._where} refused the map ({status}); give the token of a viewer in map_token_file")
        if status != 200:
            raise ValueError(f"{self._where} answered the request for the map with {status}; is it the server's HTTP "
                             "address? Set the parameter http otherwise")
        if answer_headers.get("Content-Encoding") == "gzip":
            body = self._unzipped(body)
        return re.sub("^W/", "", answer_headers.get("ETag", "")), body

    def _unzipped(self, body: bytes) -> bytes:
        unzip = zlib.decompressobj(16 + zlib.MAX_WBITS)  # with the header of gzip
        try:
            whole = unzip.decompress(body, self.BYTES_MAX)
        except zlib.error:
            whole = b""
        if not unzip.eof:
            raise ValueError(f"{self._where} sent a map that is damaged or has more than 64 million cells")
        return whole

    def _answer(self, path: str, headers: Mapping[str, str]) -> Tuple[int, Mapping[str, str], bytes]:
        if self._is_tls:
            connection: http.client.HTTPConnection = http.client.HTTPSConnection(
                self._host, self._port, timeout=self.TIMEOUT, context=self._tls)
        else:
            connection = http.client.HTTPConnection(self._host, self._port, timeout=self.TIMEOUT)
        try:
            connection.request("GET", path, headers=dict(headers))
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read(self.BYTES_MAX)
        except (OSError, http.client.HTTPException) as error:
            raise ValueError(f"no map from {self._where}: {getattr(error, 'strerror', None) or error or 'no answer'}; "
                             "is this the server's HTTP address? Set the parameter http otherwise") from None
        finally:
            connection.close()


# Reports --------------------------------------------------------------------------------------------------------------


class Reports:
    """Counts what goes wrong by reason. A reason is logged when it first occurs and then at most every 30 s, with the
    number of times since then. May be called from any thread."""

    PERIOD = 30.0  # seconds
    REASONS_MAX = 100

    def __init__(self, log: Callable[[str, str], None], clock: Callable[[], float]) -> None:
        self._log = log
        self._clock = clock
        self._lock = threading.Lock()
        self._logged: Dict[str, float] = {}  # when
        self._unlogged: Dict[str, int] = {}
        self._counts: Dict[str, int] = {}

    def counts(self) -> Dict[str, int]:
        with self._lock:
            return dict(self._counts)

    def add(self, reason: str) -> None:
        with self._lock:
            if reason not in self._counts and len(self._counts) >= self.REASONS_MAX:
                reason = "other reasons"
            self._counts[reason] = self._counts.get(reason, 0) + 1
            self._unlogged[reason] = self._unlogged.get(reason, 0) + 1
        self.log_due()

    def log_due(self, period: float = PERIOD) -> None:
        """Logs the reasons that were not logged for the period, in seconds."""
        now = self._clock()
        with self._lock:
            due = [(reason, count) for reason, count in self._unlogged.items()
                   if now >= self._logged.get(reason, -math.inf) + period]
            for reason, _ in due:
                self._logged[reason] = now
                del self._unlogged[reason]
        for reason, count in due:
            self._log("warn", reason if count == 1 else f"{reason} ({count} times)")


class _ClientLog(logging.Handler):
    """Passes warnings of the client about lost links to the reports."""

    def __init__(self, reports: Reports) -> None:
        super().__init__(logging.WARNING)
        self._reports = reports

    def emit(self, record: logging.LogRecord) -> None:
        self._reports.add(record.getMessage())


_STATES = {
    "TRACKING": ("info", "the server tracks the robot in the map"),
    "LOST": ("warn", "the server has lost the robot: its newest scans fit no place in the map"),
    "UNLOCATED": ("warn", "the robot's place in the map, which other robots began, is not known yet: drive on, or say "
                          "where it is with Locate in the viewer"),
}

OK, WARN, ERROR = 0, 1, 2  # levels of diagnostic_msgs/DiagnosticStatus


# The bridge -----------------------------------------------------------------------------------------------------------


class Output(Protocol):
    """What a front does for a Bridge. log() and publish_map() are called from any thread, the others by tick()."""

    def now(self) -> int:
        """Returns the time of ROS, which may be simulated; 0 if it is not known yet."""

    def log(self, level: str, text: str) -> None:
        """level is "info", "warn" or "error"."""

    def publish_transform(self, parent: str, child: str, stamp: int, pose: Pose) -> None: ...

    def publish_map(self, grid: Grid) -> None: ...

    def publish_diagnostics(self, level: int, text: str, values: Mapping[str, str]) -> None: ...


@dataclasses.dataclass
class _Waiting:
    arrived: float
    scan: Scan


class Bridge:
    """Streams scans to a server, and publishes where odometry is in the map, and the map.

    Its functions may be called from any thread. Raises ValueError and OSError for invalid options.
    """

    def __init__(self, options: Options, output: Output, *, connect: Callable[..., Any] = scanloom_client.Client,
                 clock: Callable[[], float] = time.monotonic) -> None:
        self._options = options
        self._output = output
        self._connect = connect
        self._clock = clock
        self._token = _token(options.token_file)
        self._tls = options.tls_context()
        self._lock = threading.RLock()
        self._tree = FrameTree()
        self._waiting: Deque[_Waiting] = collections.deque()
        self._stamps: Dict[str, int] = {}  # of each topic's newest scan
        self._first_scan: Optional[float] = None
        self._chosen = -math.inf  # when
        self._frames: Optional[Frames] = None
        self._missing = ""  # while no frames are chosen
        self._client: Any = None
        self._lasers: Optional[Lasers] = None
        self._location: Optional[scanloom_client.Location] = None
        self._state = ""
        self._is_linked = False
        self._now = 0  # ROS time of the previous tick
        self._tf_stamp = 0  # of the transform published last
        self._tf_stamps: Deque[int] = collections.deque(maxlen=256)  # of those published
        self._diagnosed = -math.inf
        self.sent = 0
        self.failure = ""  # final: the front ends
        self.reports = Reports(output.log, clock)
        self._client_log = _ClientLog(self.reports)
        self._stopping = threading.Event()
        self._map_thread: Optional[threading.Thread] = None
        if options.publish_map:
            requests = MapRequests(options, _token(options.map_token_file) or self._token, self._tls)
            self._map_thread = threading.Thread(target=self._publish_maps, args=(requests,), daemon=True)
        logging.getLogger("scanloom").addHandler(self._client_log)
        if self._map_thread:
            self._map_thread.start()
        output.log("info", f"waits for scans of {', '.join(options.scan_topics)}, for session {options.session}, robot "
                           f"{options.robot}, server {options.server}")

    # Input

    def on_transforms(self, transforms: Sequence[Optional[Transform]], is_static: bool) -> None:
        """Takes the transforms of a message; None is an invalid one."""
        with self._lock:
            for transform in transforms:
                if transform is None:
                    self.reports.add("a transform is ignored: its numbers or its frames are invalid")
                    continue
                self._tree.add(transform, is_static)
                if self._is_foreign(transform):
                    self.reports.add(f"another node publishes {transform.parent} -> {transform.child}, too, and both "
                                     "disagree: end that node, or set publish_tf to false")

    def _is_foreign(self, transform: Transform) -> bool:
        """Returns whether another node publishes the transform that this one publishes."""
        return bool(self._tf_stamps) and transform.child == self._tf_child() and transform.stamp not in self._tf_stamps

    def on_scan(self, scan: Scan) -> None:
        with self._lock:
            if self._first_scan is None:
                self._first_scan = self._clock()
            problem = scan.problem()
            if not problem and scan.stamp <= 0:
                scan = dataclasses.replace(scan, stamp=self._output.now())
                problem = "" if scan.stamp > 0 else "it has no stamp, and no clock is published"
            if problem:
                self._skip(scan, problem)
                return
            before = self._stamps.get(scan.topic, 0)
            if scan.stamp < before - _CLOCK_STEP:
                self._set_back(before - scan.stamp)
            elif scan.stamp <= before:
                self._skip(scan, "its stamp is not newer than that of the scan before")
                return
            self._stamps[scan.topic] = scan.stamp
            if len(self._waiting) == _WAITING_MAX:
                self._skip(self._waiting.popleft().scan, f"more than {_WAITING_MAX} scans wait for transforms")
            self._waiting.append(_Waiting(self._clock(), scan))

    def _skip(self, scan: Scan, reason: str) -> None:
        self.reports.add(f"a scan of {scan.topic} is skipped: {reason}")

    def _set_back(self, by: int) -> None:
        """Forgets what belongs to the time before the clock was set back, for example when a bag starts again."""
        self._output.log("warn", f"the clock was set back by {by / _SECOND:.1f} s: transforms from before are ignored")
        for one in self._waiting:
            self._skip(one.scan, "the clock was set back while it waited for transforms")
        self._waiting.clear()
        self._stamps.clear()
        self._tf_stamp = 0
        self._tree.forget_moving()

    # Time

    def tick(self) -> None:
        """Sends and publishes what is due. Call it with the rate of options.tf_rate."""
        with self._lock:
            if self.failure:
                return
            now = self._output.now()
            if now < self._now - _CLOCK_STEP:
                self._set_back(self._now - now)
            self._now = now
            try:
                if not self._frames:
                    self._choose_frames()
                self._send_waiting()
            except scanloom_client.ScanloomError as error:
                self._fail(error.message)
            self._publish_transform(now)
            self._report()

    def _fail(self, text: str) -> None:
        self.failure = text
        self._output.log("error", text)

    def _choose_frames(self) -> None:
        """Chooses frames and connects, once the transforms are there or were waited for."""
        if not self._waiting or self._first_scan is None:
            return
        found = available_frames(self._tree, self._waiting[0].scan.frame, self._options)
        if isinstance(found, str):
            self._missing = found
            return
        wait = {"map": 0.0, "odometry": self._options.tf_wait, "none": self._options.start_wait}[found.poses]
        if self._options.poses == "auto" and self._clock() < self._first_scan + wait:
            self._missing = "it waits for transforms"
            return
        try:
            self._client = self._connect(
                self._options.server, session=self._options.session, robot=self._options.robot, poses=found.poses,
                cell_size=self._options.cell_size or None, token=self._token, tls=self._tls,
                on_correction=self._on_correction, buffer_bytes=self._options.buffer_mb << 20,
                timing=scanloom_client.Timing(give_up_after=math.inf))
        except ValueError as error:
            self._fail(str(error))
            return
        self._frames = found
        self._chosen = self._clock()
        self._lasers = Lasers(self._client, self._options)
        of = {"map": f"{found.fixed} -> {found.base}", "odometry": f"{found.fixed} -> {found.base}",
              "none": f"without odometry; the robot's frame is {found.base}"}[found.poses]
        why = "" if self._options.poses != "auto" else ", chosen from the transforms; the parameter poses states others"
        self._output.log("info", f"sends scans with poses {found.poses} ({of}){why}")

    def _on_correction(self, location: scanloom_client.Location) -> None:
        self._location = location  # tick() reports it

    # Scans

    def _send_waiting(self) -> None:
        """Sends scans in the order of their arrival, until one has to wait for transforms."""
        now = self._clock()
        while self._waiting:
            first = self._waiting[0]
            if not self._frames:
                if now < first.arrived + max(self._options.start_wait, self._options.tf_wait):
                    return
                self._waiting.popleft()
                self._skip(first.scan, self._missing)
                continue
            try:
                pose, mount = self._place(first.scan, self._frames)
            except NoTransform as failure:
                if failure.may_come and now < max(first.arrived, self._chosen) + self._options.tf_wait:
                    return
                self._waiting.popleft()
                self._skip(first.scan, failure.reason)
                continue
            self._waiting.popleft()
            self._send(first.scan, pose, mount)

    def _place(self, scan: Scan, frames: Frames) -> Tuple[Dict[str, Pose], Mount]:
        """Returns the arguments of send() for the robot's pose, and the laser's mount. Raises NoTransform."""
        middle = scan.middle()
        mount = mount_of(self._tree.find(frames.base, scan.frame, middle))
        if frames.poses == "none":
            return {}, mount
        x, y, yaw = self._tree.find(frames.fixed, frames.base, middle).planar()
        if max(abs(x), abs(y)) > _COORDINATE_MAX:
            raise NoTransform(f"{frames.base} is more than 1000 km from {frames.fixed}", may_come=False)
        return {"pose" if frames.poses == "map" else "odometry": (x, y, yaw)}, mount

    def _send(self, scan: Scan, pose: Dict[str, Pose], mount: Mount) -> None:
        assert self._lasers
        try:
            self._lasers.send(scan, mount, **pose)
            self.sent += 1
        except scanloom_client.BufferFull:
            self._skip(scan, "the buffer is full, because the server is away; buffer_mb sets its size")
        except ValueError as error:
            self._skip(scan, str(error))

    # The transform of odometry

    def _tf_child(self) -> str:
        """Returns the frame whose pose in the map the server corrects."""
        assert self._frames
        return self._frames.fixed or self._frames.base

    def _publish_transform(self, now: int) -> None:
        location = self._client.transform() if self._client and self._options.publish_tf else None
        if not location or now <= 0:
            return
        parent, child = self._options.map_frame, self._tf_child()
        above = self._tree.parent(child)
        if above is not None and not self._tf_stamps:
            self.reports.add(f"{parent} -> {child} is not published, because {child} already has the parent {above}: "
                             "end the node that publishes it, state other poses, or set publish_tf to false")
            return
        stamp = now + round(self._options.tf_tolerance * _SECOND)
        if stamp <= self._tf_stamp:
            return  # receivers drop equal stamps
        self._tf_stamp = stamp
        self._tf_stamps.append(stamp)
        self._output.publish_transform(parent, child, stamp, location.T_map_odom)

    # The map

    def _publish_maps(self, requests: MapRequests) -> None:
        """Runs on a thread of its own, so that slow answers delay nothing else."""
        while not self._stopping.wait(self._options.map_period):
            try:
                grid = requests.newest()
                if grid and not self._stopping.is_set():
                    self._output.publish_map(grid)
            except ValueError as error:
                self.reports.add(f"the map is not published: {error}")

    # Reports

    def _report(self) -> None:
        self.reports.log_due()
        status = self._client.status() if self._client else None
        if status and status.is_linked and not self._is_linked:
            self._output.log("info", f"connected to {self._options.server}; it had {status.stored_before} scans of "
                                     f"robot {self._options.robot} before")
        self._is_linked = bool(status and status.is_linked)
        location = self._location
        if location and location.state != self._state:
            self._state = location.state
            level, text = _STATES.get(location.state, ("info", ""))
            if text:
                self._output.log(level, text)
        if location and location.mount_yaw_error is not None:
            degrees = math.degrees(location.mount_yaw_error)
            self.reports.add(f"the yaw of the laser's mount is too large by {degrees:.0f} degrees: correct the "
                             "transform from the robot to the laser")
        if self._clock() >= self._diagnosed + 1.0:
            self._diagnosed = self._clock()
            self._report_late_odometry()
            self._output.publish_diagnostics(*self._diagnosis(status, location))

    def _report_late_odometry(self) -> None:
        if not self._frames or self._frames.poses != "none" or self._options.poses != "auto":
            return
        found = available_frames(self._tree, self._frames.base, self._options)
        if isinstance(found, Frames) and found.poses != "none":
            self.reports.add(f"transforms {found.fixed} -> {found.base} came after the node had begun without poses: "
                             f"restart it, with the parameter poses {found.poses}")

    def _diagnosis(self, status: Any, location: Optional[scanloom_client.Location]) -> Tuple[int, str, Dict[str, str]]:
        values = {"session": self._options.session, "robot": self._options.robot, "scans sent": str(self.sent),
                  "scans waiting for transforms": str(len(self._waiting)), **{
                      reason: str(count) for reason, count in self.reports.counts().items()}}
        if status:
            values["scans acknowledged"] = str(status.acknowledged)
            values["reconnects"] = str(status.reconnects)
        if location:
            values["localization"] = location.state.lower()
            values["inlier ratio"] = f"{location.inlier_ratio:.2f}"
            values["position sigma (m)"] = f"{location.position_sigma:.3f}"
        if self.failure:
            return ERROR, self.failure, values
        if not status:
            return WARN, self._missing if self._waiting else "no scans yet", values
        if not status.is_linked:
            return WARN, "the server is not connected; scans are kept in memory", values
        if location and location.state in ("LOST", "UNLOCATED"):
            return WARN, _STATES[location.state][1], values
        return OK, "scans are sent", values

    # The end

    def close(self) -> int:
        """Waits up to options.close_wait seconds until all scans are stored, and returns the exit code: 0, or 1 after a
        failure or if scans are lost."""
        self._stopping.set()
        with self._lock:
            for one in self._waiting:
                self._skip(one.scan, "the node ended while it waited for transforms")
            self._waiting.clear()
        self.reports.log_due(period=0.0)
        if self._client and not self.failure:
            try:
                self._client.close(timeout=self._options.close_wait)
            except scanloom_client.ScanloomError as error:
                self.failure = error.message
                self._output.log("error", f"ends with scans that are lost: {error.message}")
            else:
                self._output.log("info", f"ends: all {self.sent} scans are stored")
        logging.getLogger("scanloom").removeHandler(self._client_log)
        return 1 if self.failure else 0
