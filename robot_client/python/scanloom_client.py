#!/usr/bin/env python3
"""Scanloom's client for robots in Python. Copy this file to the robot; it needs Python 3.8 or newer and
protobuf (Debian: python3-protobuf; elsewhere: pip install protobuf), nothing else.

    import math, scanloom_client

    with scanloom_client.Client("127.0.0.1:7447", session="lab", robot="r1", cell_size=0.05) as robot:
        laser = robot.laser(angle_min=-math.pi / 2, angle_increment=math.pi / 360, count=361, range_max=10.0)
        robot.send(laser, ranges, pose=(x, y, yaw), stamp=t)  # inf: nothing within range; nan: no valid reading

Leaving the block waits until every scan is durable: the server keeps it through kill -9 and power loss. The client
reconnects as often as needed and sends unacknowledged scans again.

Units are metres, radians counter-clockwise and seconds. A pose is (x, y, yaw), a point (x, y). Every function may be
called from any thread. Failures raise ScanloomError; invalid arguments raise ValueError.

A robot that does not know its pose in the map gives poses="odometry" to the client and odometry= instead of pose= to
send(), or poses="none" and neither: the server estimates where its scans were taken, and transform() returns where the
robot is:

    location = robot.transform()  # None before the server's first correction
    if location:
        x, y, yaw = location.at(odometry)  # in the map, by the current odometry

As a program it reads scans from standard input, one JSON object per line, with "t" in seconds, "pose" and "ranges", and
optionally "odometry", "intensities" and "angles"; null in ranges is an invalid reading. See --help.

    {"t": 12.5, "pose": [1.0, 0.5, 0.785], "ranges": [1.25, Infinity, null]}
"""
from __future__ import annotations

import argparse
import base64
import collections
import dataclasses
import hashlib
import json
import logging
import math
import operator
import random
import re
import selectors
import signal
import socket
import ssl
import sys
import threading
import time
import zlib
from typing import Any, Callable, Deque, Dict, Iterator, List, NoReturn, Optional, Sequence, Set, Tuple

try:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
    from google.protobuf.message import DecodeError
except ImportError as missing:
    raise ImportError("scanloom_client needs protobuf; install python3-protobuf, or protobuf with pip") from missing

__version__ = "0.2.0"
__all__ = ["BufferFull", "Client", "Coverage", "Goal", "Location", "Path", "ScanloomError", "Sensor", "Status", "Timing"]

Point = Tuple[float, float]
Pose = Tuple[float, float, float]

_log = logging.getLogger("scanloom")


# Public interface -----------------------------------------------------------------------------------------------------


class ScanloomError(Exception):
    """An error of the server or the link.

    code       the server's ErrorCode without its prefix ("INVALID_FIELD"), or this client's own: UNREACHABLE, TIMEOUT,
               LOST_SCANS, BUFFER_FULL, CLOSED, INTERNAL
    message    one sentence: the error, its place, and a hint
    retryable  whether a retry may succeed
    """

    def __init__(self, code: str, message: str, retryable: bool = False, address: str = "") -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.retryable = retryable
        self.address = address  # of the server that has the session, HOST:PORT; "": not known


class BufferFull(ScanloomError):
    """The buffer was full for the timeout of send(); the scan was not added."""


@dataclasses.dataclass(frozen=True)
class Sensor:
    """A sensor of one Client, created by its laser() or sonar()."""

    id: int
    name: str
    angles: Optional[Tuple[float, ...]]  # of its beams; None if they are evenly spaced
    angle_increment: float  # 0 if they are not
    _description: bytes = dataclasses.field(repr=False)


@dataclasses.dataclass(frozen=True)
class Path:
    """Straight lines between the points. cost is in metres, with those in danger cells weighted."""

    points: List[Point]
    length: float
    cost: float
    revision: int  # of the session's maps that were used


@dataclasses.dataclass(frozen=True)
class Goal:
    """The next exploration goal: drive to the end of the path, turn to the target, scan, request the next goal.

    exploration  "GOAL", "TAKEN_BY_OTHERS" or "COMPLETE"; path and target are set with "GOAL" only
    given_up     frontier cells that are excluded because robots could not observe them
    in_danger    the end of the path is near an obstacle: no better place exists
    """

    exploration: str
    path: Optional[Path]
    target: Optional[Point]
    given_up: int
    in_danger: bool
    revision: int


@dataclasses.dataclass(frozen=True)
class Coverage:
    """A coverage path over all free ground. Areas are in square metres; unreachable holds runs (row, first column,
    count) of cells that no path reaches; cell (i, j) is the square whose lower left corner is (i, j) * cell_size."""

    path: Path
    free_area: float
    covered_area: float
    unreachable: List[Tuple[int, int, int]]
    cell_size: float


@dataclasses.dataclass(frozen=True)
class Location:
    """The pose of a robot's odometry frame in the map: at(odometry) returns the robot's pose in the map."""

    T_map_odom: Pose
    inlier_ratio: float  # part of the scan that matches the map, 0 to 1
    position_sigma: float  # metres, of the sensor's position, in the least certain direction
    yaw_sigma: float  # radians
    revision: int  # of the session's maps that were used
    state: str = ""  # of transform(): "TRACKING", "LOST" or "UNLOCATED"; empty if it is not stated
    mount_yaw_error: Optional[float] = None  # radians, of transform(): the yaw of the laser's mount is too large by this

    @property
    def explained(self) -> float:
        """Earlier name of inlier_ratio, until 0.3."""
        return self.inlier_ratio

    def at(self, odometry: Pose = (0.0, 0.0, 0.0)) -> Pose:
        return _compose(self.T_map_odom, odometry)


@dataclasses.dataclass(frozen=True)
class Status:
    """The progress of a Client."""

    stored_before: int  # scans of this robot on the server at the first connection
    scans: int  # number of the newest scan, including stored_before
    sent: int  # scans sent in this run, each counted once
    acknowledged: int  # durable scans of this robot, including stored_before
    bytes: int  # sent, including repetitions
    reconnects: int
    is_linked: bool


@dataclasses.dataclass(frozen=True)
class Timing:
    """Timeouts in seconds. The defaults suit a robot on Wi-Fi."""

    connect: float = 10.0  # until a connection is established
    welcome: float = 10.0  # from hello to welcome
    ping_after: float = 5.0  # of silence on the link
    silence_max: float = 15.0  # of silence, after which the link counts as dead
    backoff_first: float = 0.2  # before the next attempt; doubles up to backoff_max; randomly shortened by up to half
    backoff_max: float = 10.0
    give_up_after: float = 120.0  # without progress while scans or requests wait; math.inf: never
    goodbye: float = 1.0  # for the server to close the link, when everything is durable


# Messages of the protocol ---------------------------------------------------------------------------------------------

# The compressed output of protoc for proto/scanloom/v1/frame.proto; robot_client/python/embed_protocol.py updates it.
_PROTOCOL = """
eNq1Wc2PI1mRx1X+DJddWVlf7uqeYfCwbG8henZ6BhAgBP7ILpuxndazq4fmsKmsdHZ10q7MnLSru2u4cEHiyoEj4sxhpV2txInTCGkvyz/CX8AFQUS8
l3Zmlru1o4GTMyJ+7yteRLyIMHxWhaOFY/vzILh678X779H3gzAKloFejfkPXrzf/CYUxsHCfajvQO5VI/dO7n5O5F4RddPYktSNrsH2jf2ysc00fTaf
QO3c954G0VXLv5y7C/0ACk+9aLFUU0hCvwcVz3ci98r1l2q6NYPGOME1SmjimpBE8z7UjVfh3HO8pZr7CIo2f+Hk2ziFopo/gNpk6YahO1NAHfLXvhfv
gb/1EyjO3PnSXuD62/f32lsaTiA5zc9yAG3Xjs/wLShdy0PxDNWHJw8SqnqQOnDvSyIG69+Bsqt2zIesPrybGpg+Do5cwWnJhTwCKyG7ZOp4tKQCtys4
LrQdz79s/mYL9iauvwiirrtwIi9ceoFPOlswk49SE4rSvw75554/433WHx6nV2PIRygWDCJ9+vaVy1urCP7W70Phii8tz/vVUzOwKQkJ0N9bXVuBoenF
1nqP7xOvqmyHbrS8jtxGka9wRet3oRIhzLWuPL9RkkJmDD0/IbRfNcpJof2q+X9bkJ/gwmTFC/cT1kde0CcZ4GJpX4XKNCWRUN12SnVfg3yI53vDwVmu
P4ByMAuu3GV0o06+CbvCkIXyZhd46O37JWmhkqN/Faqev8T1vaWHgBICagxIshOaLv//NP0WwIV76fkL1FjYqOCgsqhIztAO6SJm15FNhtQAqc6Ybn4I
FdJm2146z/R/RQUiIR2z+nAvbU74LaT89GOAtXXhfR1PjNHEFNZH/VHXOh9Nxkan/6hvdLUv6YdozgnhoDUxhJbLsifmqCW0rdPvyvi10GtQGZsTY2IN
W2OcRYe6JM2uOTSm4glOUQeQvJE5MnDsr3KwNwgce+59ymebLO2lizGrMTA7rUH/J61p3xxZk2lralhn/cfGCOf9MtzdIJ2KVge3dYaL4Nk2AAbmZKpt
6e/AvQ3C8xExp3j67fb2X3K5iyIH6g/g1xrcSQVxd7HAfW6K4z+vYzCU4k7gP/Uuca2K487n1sL71JURkSIPsSbI+WUupzcBQitwnOvQc2VEyPUwQIem
YhEGjTO0nkauDAK53pYohI+QJNk9KIVWGHnoKXkWbotiOCaapA0ohOytBZbl0TvQV9cSdFV28l6BJPYrkjwEPbhAL3TmrrV85jnPfTySdPdeUezFsmks
ojH3oXaBFm6tQgcHgF5J7BC7pbiE/DaFiRvrKsDwz0Zff3iYslhh3wxJ2CtT/JDfNPBdABt1cnU9RwNhjyj3KiLBU9p85i2tyJ5514tGlTcBooI8wSzC
/BvUZ1EQWn5gRS5uy2/s8GRVsUP8USCYS9BTqD/zrq6s9ftZQ2ihtyNqxO/H7CR25sbYOmNrEtt1E9jvwTFjN+h5l/dcF4cEMDfp+n3QeXBa4RqP2xUa
ydoZpX8fGovAt6NNC+7xQE0cMWLjih/AvhyeXlLnkXtij4XZNT+EAzlobd5sb/s8SlejxrGdK+N7F6rxKDLbAwbvi4oEK9tNgnDGQwYdrEByph/CjjO3
FwtrEVxHjts4YltrpGytQ4AJy3uHouqsSZrhG6DJGRIOesxrHYk6S8ZJL/2XeEHlqw2GHguQ0NhhUZkSJi0gnvgOG0tD7LGwR5efmPvrsJsYxNOf8IA7
orYaEK/wNdiZ0csVWRRoFo27jDwRVcntEFM5rcIpf7nHO74r1PC1y7wNZVS09dNrfKbfYtA9UULOj5CB8vYOgLWKc+0aVBMqozRJqaQNULZUtGqXoSgv
Of6yX7UPYX+DibY1qKdNjxdchRFecB0HmFxHgfYe7Fpph2dW2rHXrJX/tk+gYb3GTXmnt72wfRfuWK/ztPYRHFgb/Kh9DIfWJldp12HHSnhDmkb5LtSs
pI2392HPyppsAqVugfaxwQTbOmhWxsp4cNKY+C5SVtOuQsWKreP0Z1COA7h+Bw5F64k1NLvGIJNfNOHttag/emyIiWGp1IKZ+Igfw/4a0xYGinutIT7g
KQG++jS6NdC2T/8DqgmPpiSig5nLBPOUc9ExMls4gaOU1Ox0zsetUeeJzHNSsl5/iAun84I/n8JxMi94GmFmviErOHlNCXjy+qyi+dcyFB7RfPiqFJ6h
3gNVDKWT2B5JMKGQEP3fofTSnTuY0aoK6CCF/ljKqIJRMN0EXebVaPWrskUVQW9vKEsSxQ1Os7e4VfF8G4BGWReUmaok/ehWQsp5K05QWayS2K/Ctu08
V6m6lhrRcp4jlsSkDTeKMNUpbtCGQRLSBkMwLc6HWJpx4pLNiscoQCQDGBggsLwJGCgg/pJ+L4NgdnHjcuKS1e+ZlJF+FQyLUnCCKHKdVRafrQs6KzGO
S4Dxyd4J56jJyP3k2sWSvsqD08/XGAFCynF0NVyTdBFqeDi/4QQnexFyMErpIsKYoHUvA3u+Wre2Yd0zBCTWvVyTtK4aTuvWN6wrB6t1L2NC7+NjG7xw
IxsryHjtXR5+L6MwCVqvv+ukWXoH6ompaB/ahrJ+PZHcS81JMvTHcIguEkbolxiNE0a9x3O9k5krRibNe9+5zabNzbHcWa5PqW/Y3IAh6zPW5kkGXdJq
Ejrf/oZLiqeQp6vO1yQG0KITOR88dBp/IxWXhCLbRchfBLOb5h+2oMDBBZNljUOSE8wtVA/FKNXM2I35jyWbCvkouAhk+6UiJIF1RknFNtXBiEnCL4Pn
rs9hAvFMYPWBm3EpxS9s6sUkqyuhkNQscOYepdxFnkpR3ESQyV9J8iVFBT0dM057yqouA2Kuk577WCFRVauqlNv9g4WQAH6XExM2f5+Dkoq2VOWrA1ve
jFVXwbgnOf0ZLqLhi7W0qLS/wGyBmiNb3BypE78r2RP3E0wBi3PvylsuVHzeT982i4SC6F/BXDRyZ5gEXdws8Qh5nrIqeW1iUV/p08VyxmouC/5ufgpF
ORGqqM4PGmd0nGXLW99hLhWvmGZTz4dSmQUDthhQZgYJv4FVA/UdLMxzpO8wTPZzNBaN3Yi9glpE34f9DW5E21wVzzXB36ut04o7aus/hW18KPQvQzWp
StlngtlajQiww3BOKdZa16BYBMiqbvuW6pq/yEGBXxt8kPIO5jq8Tj0T6BjRQalgDHnCFR4OI4zykJikDm1EXSjaI69XFmsGjbNnM9KL8pSYbN6DPL1k
5El+4DtyG0UhCZYGr5V+BUrqwSI3QT9aKM9GN5FU83+2ANbvEz5/MKVWlUVNs435iGqqTYd2aCKGWliR+8Jj55eKXtF0ZmrA2p6v2q45sWZgLVVH1/Jo
XbTAyytbNjdELeZOiEn2d2O/VIiCbJIhQwo/5MbiUrYx65l85lbLSUgwVVrcObVoYplslFR8qLHgif2Sb5bqHsqYM+jmu9QM8zD6vKGZ3/wR3o29fEaq
Dwm86qpLivhz179cPlNDFEWW7wSLpVIYfzdNKAn36fXCnv9jzLH58y2oJlILvQ5bKnTlBX5RYERdRXGfPWsDeAAhAdStpRdeRaxNQJZjQV+z8bV5aV37
z/3gpXwSymKHmeeSl43ahc1RG1FxvUKKKqqGGqjaF3l0cZmIzXRiWPM3OaisEqRbCniTXVM2iTerjpzJJlHA2SRdPWaTkbw2lSens0l1pZRNKhgV0sH1
kl6V5u9yUE1kYV/gijJa3d6s1VPYexoF/tJDBckXwZOXhHlALOBHQVWpydfwTznI017170KVPDxQTe3choaMsZaLJBgDglTr1mvUqpR6CkU81aW7fIPJ
KQSWp+VL74XrW9ehOkqJ6fOQ4ornK4NQD2TZ87tMs22sktjPaxsJd9i7lRaTbbA/fCHb+GMOdjNZ8j/dPt5a/RWmutA5ETNIzC/MJamkIMOcpG65IfWH
4r/U/isH5fgYq+vPvfn68d6oa2HZ+IKpyFkmRgtpfthpPnz5WS5jaFXxGPIOVK99/HCe8VOcpz8rRZJFK6wb+urFidv5zf/MQS1VVnwu6/gAynEJoizk
cGPBwv8gxIr5QpbyW9xvqtK4td/1+8R/3K7eJwzs6PZXbwrsJCec79rRa/6uYxzJ2UASYV0oqvnfGOcShczn0me6+N7+PMX3F9Hq6f8WoLJ6bKnNZAhh
CqtjdrMtqLfhJCEbtgaPTDE0utYj0RoaWi4jZ641NU1r0BJnhrZFXbT03OfjsSmmOAO1xPrmSNumJlgC0x89bg36uELfGHS1fGaF89FHI/PjkTUxJjy6
QP+0JeSKj8To0aDfmWpF+qctATDPp5b5yDJF1xBaKTN7Rxjd/tQyftwxjC6ev4y3rifk0/7QwAm0CjX4EnxhjAetDg6AzITxdrrGwKA/7qqZ3UympkC1
tfoDFO5kNDHpnU+n/dGZ1cUTa7XM0PNR63zaM0X/Jzi0Tp3M5ClRuwOzRWfYzey1P5oaYtQaaFp2L2qvj84HA20vc/KRaY1b056mZ/bYbQ1bZyt72MeU
7SAhbQ3b/bNz83yiHdzafRcVIob9EW7xEIPzndRi0x6de9gaj1F8lJkVxRZqBO/v+PRnUE08yLzIj8cDU8j/TdO2fABaUnhmtqiHS/aT4E5bHxkjq/3E
wj2ghaIJ0+IJQMccjukyM3/C/h0XJzKO
"""


def _load_protocol() -> Dict[str, Any]:
    """Returns the classes of the messages by name, and the enums' descriptors. Their own pool avoids conflicts with
    other programs."""
    pool = descriptor_pool.DescriptorPool()
    files = descriptor_pb2.FileDescriptorSet.FromString(zlib.decompress(base64.b64decode(_PROTOCOL)))
    for file in files.file:
        pool.Add(file)
    if hasattr(message_factory, "GetMessageClass"):
        class_of = message_factory.GetMessageClass
    else:
        class_of = message_factory.MessageFactory(pool).GetPrototype
    loaded: Dict[str, Any] = {}
    for file in files.file:
        for message in file.message_type:
            loaded[message.name] = class_of(pool.FindMessageTypeByName(f"{file.package}.{message.name}"))
        for enum in file.enum_type:
            loaded[enum.name] = pool.FindEnumTypeByName(f"{file.package}.{enum.name}")
    return loaded


_messages = _load_protocol()
_Frame = _messages["Frame"]
_Scan = _messages["Scan"]
_SensorDescription = _messages["SensorDescription"]

_PROTOCOL_VERSION = 1
_LENGTH_BYTES = 4
_FRAME_BYTES_MAX = 1 << 20
_BEAMS_MAX = 4096
_SENSORS_MAX = 64
_SCANS_PER_BATCH_MAX = 1024
_BATCH_BYTES_MAX = 64 << 10  # for a batch of several scans
_BATCH_OVERHEAD = _LENGTH_BYTES + 16  # fields around the scans of a batch
_SCAN_OVERHEAD = 16  # a scan's seq, tag and length
_REQUESTS_MAX = 4  # that a server handles at the same time
_PINGS_MAX = 16  # unanswered; a server never has more
_REPLACED_MAX = 3  # replaced links of this robot within this many seconds:
_REPLACED_WITHIN = 60.0
_SCANS_OF_A_ROBOT_MAX = 1_000_000_000  # three years at ten per second
_NO_RETURN = 0xFFFFFFFF  # millimetres: nothing within range
_COORDINATE_MAX = 1e6  # metres
_DURATION_MAX = 10.0  # seconds, of a scan
_REGION_CORNERS_MAX = 4096
_LOCATE_POINTS_MIN = 20
_LOCATE_POINTS_MAX = 32_768
_NEAR_RADIUS_MAX = 1000.0  # metres
_TOKEN_BYTES_MAX = 8192  # smaller than the limit of a hello
_POSES = ("map", "odometry", "none")
_FULL_TURN = 2.0 * math.pi + 1e-3
_SERVER_TEXT_MAX = 500  # characters in messages


def _enum_name(enum: str, number: int, prefix: str) -> str:
    value = _messages[enum].values_by_number.get(number)
    return str(value.name[len(prefix) :] if value else number)


def _location(found: Any) -> Location:
    pose = found.T_map_odom
    state = _enum_name("LocalizationState", found.state, "LOCALIZATION_STATE_") if found.state else ""
    mount_yaw_error = found.mount_yaw_error if found.HasField("mount_yaw_error") else None
    return Location((pose.x, pose.y, pose.yaw), found.explained, found.position_sigma, found.yaw_sigma,
                    found.revision, state, mount_yaw_error)


def _shown(text: str) -> str:
    """Returns a server's text with control characters escaped."""
    plain = "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)
    return plain if len(plain) <= _SERVER_TEXT_MAX else plain[:_SERVER_TEXT_MAX] + "..."


# Conversion of arguments to messages ----------------------------------------------------------------------------------


def _millimetres(range_m: float) -> int:
    """Rounds like common/scan/scan.cpp, halves upwards; 0 is an invalid reading."""
    if not range_m > 0.0:
        return 0
    mm = range_m * 1000.0
    if mm >= _NO_RETURN - 0.5:
        return _NO_RETURN
    return math.floor(mm + 0.5)


def _numbers(field: str, values: Any, convert: Callable[[Any], Any]) -> List[Any]:
    """Converts a list, tuple, array or NumPy array."""
    if values is None or isinstance(values, (str, bytes, bytearray, dict, set, frozenset)):
        raise ValueError(f"{field} is of type {type(values).__name__}; a list or an array of numbers is needed")
    try:
        return [convert(value) for value in (values.tolist() if hasattr(values, "tolist") else values)]
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{field} contains an invalid number: {error}") from None


def _finite(field: str, value: Any, magnitude_max: float = math.inf) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{field} is {value!r}; a number is needed") from None
    if not math.isfinite(number) or abs(number) > magnitude_max:
        limit = f", at most {magnitude_max:g} either way" if magnitude_max < math.inf else ""
        raise ValueError(f"{field} is {number}; a finite number is needed{limit}")
    return number


def _whole(field: str, value: Any, smallest: int, largest: int) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise ValueError(f"{field} is {value!r}; a whole number is needed") from None
    if not smallest <= number <= largest:
        raise ValueError(f"{field} is {number}; {smallest} to {largest} are possible")
    return number


def _text(field: str, value: Any, bytes_max: int) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{field} is {value!r}; a str is needed")
    try:
        size = len(value.encode())
    except UnicodeEncodeError:
        raise ValueError(f"{field} {value!r} cannot be written in UTF-8; give it without surrogates") from None
    if size > bytes_max:
        raise ValueError(f"{field} is longer than {bytes_max} bytes: {_shown(value)!r}")
    return value


def _lock_timeout(timeout: Any) -> Optional[float]:
    """Returns None, or seconds within the range of a lock's timeout."""
    if timeout is None or timeout == math.inf:
        return None
    return min(max(_finite("timeout", timeout), 0.0), threading.TIMEOUT_MAX)


def _set_coordinates(field: str, value: Any, names: Sequence[str], message: Any) -> None:
    """Sets a Point or Pose2, which is present afterwards even if all values are 0."""
    try:
        coordinates = list(value)
    except TypeError:
        raise ValueError(f"{field} is {value!r}; ({', '.join(names)}) are needed") from None
    if len(coordinates) != len(names):
        raise ValueError(f"{field} has {len(coordinates)} numbers; ({', '.join(names)}) are needed")
    message.SetInParent()
    for name, coordinate in zip(names, coordinates):
        setattr(message, name, _finite(f"{field}.{name}", coordinate, _COORDINATE_MAX))


def _set_pose(field: str, value: Any, message: Any) -> None:
    _set_coordinates(field, value, ("x", "y", "yaw"), message)


def _set_point(field: str, value: Any, message: Any) -> None:
    _set_coordinates(field, value, ("x", "y"), message)


def _region(region: Any) -> List[float]:
    """Returns the corners x, y, x, y, ... of a polygon [(x, y), ...] or of a box [x_min, y_min, x_max, y_max]."""
    needed = "a polygon of 3 to 4096 corners [(x, y), ...] or a box [x_min, y_min, x_max, y_max] is needed"
    try:
        given = list(region.tolist() if hasattr(region, "tolist") else region)
        corners = [given] if given and not any(hasattr(corner, "__len__") for corner in given) else \
            [list(corner) for corner in given]
    except TypeError:
        raise ValueError(f"region is {region!r}; {needed}") from None
    if len(corners) == 1 and len(corners[0]) == 4:
        low_x, low_y, high_x, high_y = (_finite("region", edge, _COORDINATE_MAX) for edge in corners[0])
        if not (low_x < high_x and low_y < high_y):
            raise ValueError(f"region is the box {corners[0]}, which is empty; {needed}")
        return [low_x, low_y, high_x, low_y, high_x, high_y, low_x, high_y]
    if not 3 <= len(corners) <= _REGION_CORNERS_MAX or any(len(corner) != 2 for corner in corners):
        raise ValueError(f"region has {len(corners)} invalid corners; {needed}")
    return [_finite("region", coordinate, _COORDINATE_MAX) for corner in corners for coordinate in corner]


def _compose(T_a_b: Pose, T_b_c: Pose) -> Pose:
    (x, y, yaw), (dx, dy, turn) = T_a_b, T_b_c
    cos, sin = math.cos(yaw), math.sin(yaw)
    return x + cos * dx - sin * dy, y + sin * dx + cos * dy, math.remainder(yaw + turn, 2.0 * math.pi)


def _check_count(field: str, count: int) -> None:
    if not 1 <= count <= _BEAMS_MAX:
        raise ValueError(f"{field} has {count} beams; 1 to {_BEAMS_MAX} are needed")


def _check_span(increment: float, count: int) -> None:
    if abs(increment) * (count - 1) > _FULL_TURN:
        raise ValueError(f"{count} beams of angle_increment {increment:g} span more than a full turn")


def _check_angles(angles: Any) -> List[float]:
    checked = _numbers("angles", angles, lambda angle: _finite("an angle", angle, 2.0 * _FULL_TURN))
    _check_count("angles", len(checked))
    return checked


def _uniform_angles(first: Any, increment: Any, count: Any, message: Any) -> None:
    if first is None or increment is None or count is None:
        raise ValueError("give angle_min, angle_increment and count, or the angles one by one")
    message.first = _finite("angle_min", first, 2.0 * _FULL_TURN)
    message.increment = _finite("angle_increment", increment)
    if message.increment == 0.0:
        raise ValueError("angle_increment is 0; all beams would have the same direction")
    count = _whole("count", count, -_NO_RETURN, _NO_RETURN)
    _check_count("count", count)
    _check_span(message.increment, count)
    message.count = count


def _describe(sensor: int, kind: str, name: str, mount: Pose, uniform: Tuple[Any, Any, Any], angles: Any,
              aperture: float, range_min: float, range_max: float) -> Sensor:
    description = _SensorDescription(sensor=sensor, name=_text("the sensor's name", name, 64))
    description.kind = _messages["SensorKind"].values_by_name[f"SENSOR_KIND_{kind}"].number
    _set_pose("mount", mount, description.mount)
    if angles is None:
        _uniform_angles(*uniform, description.angles.uniform)
    elif any(part is not None for part in uniform):
        raise ValueError("give angles or angle_min, angle_increment and count, not both")
    else:
        description.angles.explicit.angles.extend(_check_angles(angles))
    description.aperture = _finite("aperture", aperture)
    if not 0.0 <= description.aperture <= math.pi:
        raise ValueError(f"aperture is {aperture}; 0 to pi radians are possible")
    description.range_min = _finite("range_min", range_min)
    description.range_max = _finite("range_max", range_max)
    if not 0.0 <= description.range_min < description.range_max <= 1000.0:
        raise ValueError(f"range_min is {range_min}, range_max {range_max}; 0 <= range_min < range_max <= 1000 is "
                         "needed")
    return Sensor(sensor, name, tuple(description.angles.explicit.angles) or None,
                  description.angles.uniform.increment if angles is None else 0.0, description.SerializeToString())


def _check_poses(poses: str, pose: Any, odometry: Any) -> None:
    """Checks whether a scan has what a robot with such poses sends."""
    if poses == "map":
        if pose is None:
            raise ValueError("pose is None; (x, y, yaw) are needed")
    elif pose is not None:
        raise ValueError(f"pose is {pose!r}, but the client has poses={poses!r}; leave pose out")
    elif poses == "odometry" and odometry is None:
        raise ValueError("odometry is None, but the client has poses='odometry'; (x, y, yaw) are needed")
    elif poses == "none" and odometry is not None:
        raise ValueError(f"odometry is {odometry!r}, but the client has poses='none'; leave odometry out")


def _encode_scan(sensor: Sensor, ranges: Any, pose: Any, stamp: float, odometry: Any, intensities: Any,
                 angles: Any, begins_map: Any = False, duration: Any = 0.0) -> bytes:
    """Returns an encoded Scan without its seq, which is set when it is sent."""
    if not isinstance(begins_map, bool):
        raise ValueError(f"begins_map is {begins_map!r}; True or False is needed")
    scan = _Scan(sensor=sensor.id, stamp=_finite("stamp", stamp), begins_map=begins_map,
                 duration=_finite("duration", duration, _DURATION_MAX))
    if pose is not None:
        _set_pose("pose", pose, scan.pose)
    if odometry is not None:
        _set_pose("odometry", odometry, scan.odometry)
    scan.ranges.extend(_numbers("ranges", ranges, _millimetres))
    _check_count("ranges", len(scan.ranges))
    if intensities is not None:
        try:
            scan.intensities.extend(_numbers("intensities", intensities, int))
        except ValueError as error:
            raise ValueError(f"intensities are whole numbers from 0 to 4294967295: {error}") from None
        if len(scan.intensities) not in (0, len(scan.ranges)):
            raise ValueError(f"intensities has {len(scan.intensities)} values for {len(scan.ranges)} ranges")
    if angles is not None:
        scan.angles.explicit.angles.extend(_check_angles(angles))
    own = scan.angles.explicit.angles if angles is not None else sensor.angles
    if own is None:
        _check_span(sensor.angle_increment, len(scan.ranges))
    elif len(own) != len(scan.ranges):
        raise ValueError(f"ranges has {len(scan.ranges)} beams for {len(own)} angles")
    return bytes(scan.SerializeToString())


def _described_laser(sensor: Sensor) -> Any:
    description = _SensorDescription.FromString(sensor._description)
    if description.kind != _messages["SensorKind"].values_by_name["SENSOR_KIND_LASER"].number:
        raise ValueError(f"{sensor.name} is not a laser; only scans of lasers can localize a robot")
    return description


def _points_seen(sensor: Any, scan: Any) -> List[Tuple[int, int]]:
    """Returns the points hit by a laser, in whole millimetres in the frame of the scan's pose."""
    pose, mount = ((part.x, part.y, part.yaw) for part in (scan.pose, sensor.mount))
    x, y, yaw = _compose(pose, mount)
    own = scan.angles.explicit.angles or sensor.angles.explicit.angles
    uniform = sensor.angles.uniform
    points = []
    for beam, millimetres in enumerate(scan.ranges):
        metres = millimetres * 0.001
        if millimetres in (0, _NO_RETURN) or not sensor.range_min <= metres < sensor.range_max:
            continue
        direction = yaw + (own[beam] if own else uniform.first + beam * uniform.increment)
        met = x + metres * math.cos(direction), y + metres * math.sin(direction)
        if max(map(abs, met)) <= _COORDINATE_MAX:
            points.append((round(met[0] * 1000.0), round(met[1] * 1000.0)))
    return points


def _set_points(points: List[Tuple[int, int]], message: Any) -> None:
    """Sets all points, or _LOCATE_POINTS_MAX selected evenly."""
    if len(points) < _LOCATE_POINTS_MIN:
        raise ValueError(f"the scans have {len(points)} points; at least {_LOCATE_POINTS_MIN} are needed to localize "
                         "them")
    count = min(len(points), _LOCATE_POINTS_MAX)
    before = (0, 0)
    for point in (points[n * len(points) // count] for n in range(count)):
        message.points.extend((point[0] - before[0], point[1] - before[1]))
        before = point


def _set_near(near: Optional[Point], radius: Optional[float], message: Any) -> None:
    if (near is None) != (radius is None):
        raise ValueError("near and radius need each other; give both, or neither")
    if near is None:
        return
    _set_point("near", near, message.near)
    message.radius = _finite("radius", radius)
    if not 0.0 < message.radius <= _NEAR_RADIUS_MAX:
        raise ValueError(f"radius is {radius}; more than 0 and at most {_NEAR_RADIUS_MAX:g} m are possible")


def _hello(session: str, robot: str, token: str, source: str, cell_size: Optional[float],
           body_radius: Optional[float], poses: str = "map") -> Any:
    frame = _Frame()
    hello = frame.hello
    for field, name in (("session", session), ("robot", robot)):
        if not isinstance(name, str) or not re.fullmatch("[A-Za-z0-9_-]{1,64}", name):
            raise ValueError(f"{field} is {name!r}; 1 to 64 letters, digits, '_' and '-' are possible")
    _text("source", source, 64)
    if not source.isprintable():
        raise ValueError(f"source is {source!r}; printable text is needed")
    _text("token", token, _TOKEN_BYTES_MAX)
    hello.protocol_version = _PROTOCOL_VERSION
    hello.session, hello.robot, hello.token, hello.source = session, robot, token, source
    hello.client = f"scanloom_client.py {__version__}"
    hello.create.SetInParent()
    if cell_size is not None:
        hello.create.cell_size = _finite("cell_size", cell_size)
        if not 0.01 <= hello.create.cell_size <= 1.0:
            raise ValueError(f"cell_size is {cell_size}; 0.01 to 1 metre are possible")
    if body_radius is not None:
        hello.body_radius = _finite("body_radius", body_radius)
        if not 0.0 < hello.body_radius <= 5.0:
            raise ValueError(f"body_radius is {body_radius}; more than 0 and at most 5 metres are possible")
    if poses not in _POSES:
        raise ValueError(f"poses is {poses!r}; 'map', 'odometry' or 'none' is needed")
    hello.poses = _messages["Poses"].values_by_name[f"POSES_{poses.upper()}"].number
    return frame


# Conversation: no socket, no clock, no thread ---------------------------------------------------------------------


def _retry(code: str, message: str) -> ScanloomError:
    return ScanloomError(code, message, retryable=True)


@dataclasses.dataclass
class _Request:
    frame: Any
    reply: Any = None
    is_abandoned: bool = False


@dataclasses.dataclass
class _LinkState:
    """The state of one connection."""

    opened: float
    last_received: float  # time of the newest frame
    pinged: float = -math.inf
    sent_hello: bool = False
    is_welcome: bool = False
    sent_goodbye: Optional[float] = None
    frame_bytes_max: int = _FRAME_BYTES_MAX
    beams_max: int = _BEAMS_MAX
    scans_per_batch_max: int = _SCANS_PER_BATCH_MAX
    credit: int = 0
    in_flight: int = 0  # bytes sent and not durable
    batches: Deque[Tuple[int, int]] = dataclasses.field(default_factory=collections.deque)  # last scan, bytes
    described: Set[int] = dataclasses.field(default_factory=set)  # sensors
    pings: Deque[int] = dataclasses.field(default_factory=collections.deque)  # unanswered
    request: int = 0  # requests up to this id were sent


class _Conversation:
    """The robot's side of the link: decides what to send next, what to send again after a reconnect, and how much may
    be in flight. It outlives its links. A ScanloomError that it raises ends the link, and the client if not retryable.

    Scans are numbered from 1 in this run; the server's seq is greater by stored_before:
        acknowledged <= sent <= sent_ever and last
    """

    def __init__(self, hello: Any, buffer_bytes: int, timing: Timing, now: float) -> None:
        self.hello = hello
        self.timing = timing
        self.link: Optional[_LinkState] = None
        self.stored_before: Optional[int] = None
        self.session_id = ""
        self.scans: Deque[Tuple[Sensor, bytes]] = collections.deque()  # acknowledged + 1 .. last
        self.bytes_free = buffer_bytes
        self.acknowledged = self.sent = self.sent_ever = self.last = 0
        self.applied = 0  # scans up to this one are known to be in the maps
        self.requests: Dict[int, _Request] = {}  # by id, which increases
        self.request_ids = 0
        self.location: Optional[Location] = None  # of the newest correction
        self.nonce = 0
        self.bytes_sent = 0
        self.welcomes = 0
        self.progress = now
        self.replaced: List[float] = []  # times of recent replacements
        self.is_ending = False

    # Input

    def waits(self) -> bool:
        """Returns whether scans wait for the server, or the first connection is still missing."""
        return self.stored_before is None or bool(self.scans)

    def is_done(self) -> bool:
        return self.is_ending and not self.waits() and not self.requests

    def has_room(self) -> bool:
        return self.bytes_free > 0

    def add(self, sensor: Sensor, scan: bytes, now: float) -> None:
        if not self.waits():
            self.progress = now
        self.scans.append((sensor, scan))
        self.bytes_free -= len(scan)
        self.last += 1

    def add_request(self, frame: Any) -> int:
        self.request_ids += 1
        getattr(frame, frame.WhichOneof("body")).id = self.request_ids
        self.requests[self.request_ids] = _Request(frame)
        return self.request_ids

    def abandon(self, id: int) -> None:
        """Marks a request whose caller no longer waits. The server still counts it until its reply is received."""
        if self.link and id <= self.link.request:
            self.requests[id].is_abandoned = True
        else:
            del self.requests[id]

    # Received frames

    def open(self, now: float) -> None:
        self.link = _LinkState(opened=now, last_received=now)

    def close(self) -> None:
        self.link = None
        self.requests = {id: request for id, request in self.requests.items() if not request.is_abandoned}

    def receive(self, frame: Any, now: float) -> None:
        assert self.link
        self.link.last_received = now
        kind = frame.WhichOneof("body")
        if kind == "error":
            self._on_error(frame.error, now)
        elif kind == "goodbye":
            reason = _shown(frame.goodbye.reason) or "no reason given"
            raise _retry("SHUTTING_DOWN", f"the server said goodbye: {reason}")
        elif kind == "ping":
            if len(self.link.pings) == _PINGS_MAX:
                raise _retry("MALFORMED_FRAME", "the server sends pings faster than they can be answered")
            self.link.pings.append(frame.ping.nonce)
        elif kind == "pong":
            pass
        elif kind == "correction" and self.link.is_welcome:
            self.location = _location(frame.correction)
        elif kind == "welcome" and self.link.sent_hello and not self.link.is_welcome:
            self._on_welcome(frame.welcome, now)
        elif kind == "ack" and self.link.is_welcome:
            self._on_ack(frame.ack, now)
        elif not (kind in ("plan_reply", "goal_reply", "coverage_reply", "locate_reply") and
                  self._on_reply(kind, frame)):
            raise _retry("MALFORMED_FRAME", f"the server sent an unexpected {kind or 'frame of an unknown kind'}")

    def _on_error(self, error: Any, now: float) -> None:
        code = _enum_name("ErrorCode", error.code, "ERROR_CODE_")
        message = _shown(error.message) or f"the server ended the link with the error {code} without a message"
        if code == "MALFORMED_FRAME" and self._is_locating():
            message += ("; a server of an earlier version cannot localize robots: update it, or state the robot's "
                        "pose")
        raise ScanloomError(code, message, self._may_pass(now) if code == "REPLACED" else error.retryable,
                            error.address)

    def _is_locating(self) -> bool:
        """Returns whether a locate request on this link is unanswered."""
        return any(self.link and id <= self.link.request and request.frame.WhichOneof("body") == "locate_request"
                   for id, request in self.requests.items())

    def _may_pass(self, now: float) -> bool:
        """Returns whether a reconnect may help: an earlier link may have replaced this one because its hello arrived
        late, but another program with the same name does so repeatedly."""
        self.replaced = [time for time in self.replaced if time + _REPLACED_WITHIN > now] + [now]
        return len(self.replaced) < _REPLACED_MAX

    def _on_welcome(self, welcome: Any, now: float) -> None:
        assert self.link
        if self.stored_before is None:
            if welcome.last_durable_seq > _SCANS_OF_A_ROBOT_MAX:
                raise ScanloomError("SESSION_CONFLICT", f"the server reports {welcome.last_durable_seq} scans "
                                    "of this robot, more than any robot sends; check the server's address")
            self.stored_before = welcome.last_durable_seq
            self.progress = now
        elif welcome.session_id != self.session_id and self.stored_before + self.acknowledged > 0:
            raise ScanloomError("SESSION_DELETED", f"session {self.hello.hello.session} was deleted and recreated "
                                f"while {self.stored_before + self.acknowledged} of this robot's scans were "
                                "acknowledged; restart the client to fill the new one")
        else:
            self._rewind(welcome.last_durable_seq - self.stored_before, now)
        self.session_id = welcome.session_id
        self.link.is_welcome = True
        self.link.frame_bytes_max = welcome.limits.frame_size_max or _FRAME_BYTES_MAX
        self.link.beams_max = welcome.limits.beams_max or _BEAMS_MAX
        self.link.scans_per_batch_max = welcome.limits.scans_per_batch_max or _SCANS_PER_BATCH_MAX
        self.link.credit = welcome.credit_bytes
        self.welcomes += 1

    def _rewind(self, durable: int, now: float) -> None:
        """Continues on a new link: the server has the scans up to `durable`, later ones count as unsent."""
        before = self.stored_before or 0
        if durable < self.acknowledged:
            raise ScanloomError("LOST_SCANS", f"the server has {before + durable} scans of this robot but had "
                                f"acknowledged {before + self.acknowledged}; the others are no longer in memory: "
                                "restore the server's store or use a new session")
        if durable > self.sent_ever:
            raise ScanloomError("SESSION_CONFLICT", f"the server has {before + durable} scans of this robot, but only "
                                f"{before + self.sent_ever} were sent from here: another program uses the same session "
                                "and robot")
        self._acknowledge(durable, now)
        self.sent = durable
        self.applied = max(self.applied, durable)

    def _on_ack(self, ack: Any, now: float) -> None:
        assert self.link and self.stored_before is not None
        durable = ack.durable_seq - self.stored_before
        if durable > self.sent:
            raise _retry("MALFORMED_FRAME", f"the server acknowledged scan {ack.durable_seq}, but only "
                         f"{self.stored_before + self.sent} were sent")
        self._acknowledge(durable, now)
        self.applied = max(self.applied, min(ack.applied_seq - self.stored_before, self.last))
        while self.link.batches and self.link.batches[0][0] <= durable:
            self.link.in_flight -= self.link.batches.popleft()[1]
        self.link.credit = ack.credit_bytes

    def _acknowledge(self, durable: int, now: float) -> None:
        while self.acknowledged < durable:
            self.bytes_free += len(self.scans.popleft()[1])
            self.acknowledged += 1
            self.progress = now

    def _on_reply(self, kind: str, frame: Any) -> bool:
        assert self.link
        reply = getattr(frame, kind)
        request = self.requests.get(reply.id)
        if not request or reply.id > self.link.request:
            return False
        is_of_it = request.frame.WhichOneof("body") == kind.replace("_reply", "_request")
        if not is_of_it or reply.WhichOneof("outcome") is None:
            return False
        request.reply = reply
        del self.requests[reply.id]
        return True

    # Frames to send

    def next_frame(self, now: float) -> Optional[bytes]:
        """Returns the next frame with its length prefix, or None if nothing can be sent now."""
        frame = self._next_message(now)
        if frame is None:
            return None
        body: bytes = frame.SerializeToString()
        size = _LENGTH_BYTES + len(body)
        if frame.WhichOneof("body") == "scan_batch":
            assert self.link
            self.link.batches.append((self.sent, size))
            self.link.in_flight += size
        self.bytes_sent += size
        return len(body).to_bytes(_LENGTH_BYTES, "big") + body

    def _next_message(self, now: float) -> Any:
        link = self.link
        if not link or link.sent_goodbye is not None:
            return None
        if not link.sent_hello:
            link.sent_hello = True
            return self.hello
        if not link.is_welcome:
            return None
        frame = _Frame()
        if link.pings:
            frame.pong.nonce = link.pings.popleft()
            return frame
        if now >= self._ping_due(link):
            link.pinged = now
            self.nonce += 1
            frame.ping.nonce = self.nonce
            return frame
        if self.is_done():
            link.sent_goodbye = now
            frame.goodbye.reason = "every scan is acknowledged"
            return frame
        for id, request in self.requests.items():
            if id > link.request:
                link.request = id
                return request.frame
        return self._next_about_scans(link, frame)

    def _next_about_scans(self, link: _LinkState, frame: Any) -> Any:
        if self.sent == self.last:
            return None
        sensor = self.scans[self.sent - self.acknowledged][0]
        if sensor.id not in link.described:
            link.described.add(sensor.id)
            frame.sensor_description.MergeFromString(sensor._description)
            return frame
        for encoded in self._scans_that_fit(link):
            self.sent += 1
            scan = frame.scan_batch.scans.add()
            scan.MergeFromString(encoded)
            scan.seq = (self.stored_before or 0) + self.sent
            if len(scan.ranges) > link.beams_max:
                raise ScanloomError("FRAME_TOO_LARGE", f"scan {scan.seq} has {len(scan.ranges)} beams, but the server "
                                    f"accepts at most {link.beams_max}")
        self.sent_ever = max(self.sent_ever, self.sent)
        return frame if frame.scan_batch.scans else None

    def _scans_that_fit(self, link: _LinkState) -> List[bytes]:
        """Returns the next scans of described sensors, within the credit, the server's limits and the target size of a
        batch. The first scan may exceed the target size."""
        chosen: List[bytes] = []
        size = _BATCH_OVERHEAD
        frame_bytes_max = link.frame_bytes_max + _LENGTH_BYTES
        first = self.sent - self.acknowledged
        for index in range(first, min(len(self.scans), first + link.scans_per_batch_max)):
            sensor, encoded = self.scans[index]
            size += len(encoded) + _SCAN_OVERHEAD
            if not chosen and size > frame_bytes_max:
                raise ScanloomError("FRAME_TOO_LARGE", f"a scan needs {size} bytes, but the server accepts at most "
                                    f"{link.frame_bytes_max} per frame")
            room = min(link.credit - link.in_flight, frame_bytes_max)
            if chosen:
                room = min(room, _BATCH_BYTES_MAX)
            if sensor.id not in link.described or size > room:
                break
            chosen.append(encoded)
        return chosen

    # Time

    def _ping_due(self, link: _LinkState) -> float:
        return max(link.last_received, link.pinged) + self.timing.ping_after

    def check(self, now: float) -> None:
        """Raises the error of a link that has exceeded a timeout."""
        link = self.link
        if not link:
            return
        if link.sent_goodbye is not None and now >= link.sent_goodbye + self.timing.goodbye:
            raise _retry("TIMEOUT", "the server did not close the link in time")
        if not link.is_welcome and now >= link.opened + self.timing.welcome:
            raise _retry("TIMEOUT", f"the server did not answer the hello within {self.timing.welcome:g} s")
        if link.is_welcome and now >= link.last_received + self.timing.silence_max:
            raise _retry("TIMEOUT", f"no data from the server for {self.timing.silence_max:g} s")

    def deadline(self) -> float:
        """Returns the time until which the results of check() and next_frame() stay the same without new events."""
        link = self.link
        assert link
        if not link.is_welcome:
            return link.opened + self.timing.welcome
        if link.sent_goodbye is not None:
            return link.sent_goodbye + self.timing.goodbye
        return min(self._ping_due(link), link.last_received + self.timing.silence_max)

    def progress_deadline(self) -> float:
        return self.progress + self.timing.give_up_after if self.waits() else math.inf


# Connection -------------------------------------------------------------------------------------------------------


class _Backoff:
    """Waits before reconnects: they double, each multiplied by a random factor from 0.5 to 1, so that many robots do
    not reconnect at the same moment."""

    def __init__(self, timing: Timing, random_part: Callable[[], float] = random.random) -> None:
        self._timing = timing
        self._random_part = random_part
        self._wait = timing.backoff_first

    def next(self) -> float:
        chosen = self._wait * (0.5 + 0.5 * self._random_part())
        self._wait = min(2.0 * self._wait, self._timing.backoff_max)
        return chosen

    def reset(self) -> None:
        """Resets after progress: the next wait is short."""
        self._wait = self._timing.backoff_first


class _Connection:
    """A connected non-blocking socket that is read as frames."""

    _READ_BYTES = 64 << 10  # more than a TLS record, so that select() misses no buffered bytes
    _READS_MAX = 16  # per turn
    _SELECT_MAX = 60.0  # seconds; select() accepts no infinite timeout

    def __init__(self, sock: socket.socket, bell: socket.socket) -> None:
        sock.setblocking(False)
        self._sock = sock
        self._bell = bell
        self._out = b""
        self._is_broken = False  # for writing
        self._in = bytearray()
        self._selector = selectors.DefaultSelector()
        self._selector.register(bell, selectors.EVENT_READ)
        self._selector.register(sock, selectors.EVENT_READ)

    def close(self) -> None:
        self._selector.close()
        self._sock.close()

    def is_writable(self) -> bool:
        return not self._out and not self._is_broken

    def write(self, frame: bytes) -> None:
        self._out += frame
        self._send()

    def turn(self, timeout: float) -> Iterator[bytes]:
        """Waits until the socket is readable or writable, or the bell rings, and yields the complete frames."""
        self._send()
        self._selector.modify(self._sock, selectors.EVENT_READ | (selectors.EVENT_WRITE if self._out else 0))
        self._selector.select(min(max(timeout, 0.0), self._SELECT_MAX))
        try:
            self._bell.recv(4096)
        except BlockingIOError:
            pass
        ended = self._receive()
        yield from self._frames()
        if ended:
            raise _retry("UNREACHABLE", f"the connection was lost: {ended}")

    def _send(self) -> None:
        try:
            while self._out:
                self._out = self._out[self._sock.send(self._out) :]
        except (BlockingIOError, ssl.SSLWantReadError, ssl.SSLWantWriteError):
            pass
        except OSError:
            self._out = b""
            self._is_broken = True  # reading returns the reason, possibly an error of the server

    def _receive(self) -> str:
        """Returns the reason if the link has ended, else an empty string."""
        try:
            for _ in range(self._READS_MAX):
                received = self._sock.recv(self._READ_BYTES)
                if not received:
                    return "the server closed the link"
                self._in += received
        except (BlockingIOError, ssl.SSLWantReadError, ssl.SSLWantWriteError):
            pass
        except ssl.SSLError as error:
            advice = "; " + _SHOW_A_CERTIFICATE if error.reason in _REFUSED_CERTIFICATE else ""
            return (error.strerror or str(error)) + advice
        except OSError as error:
            return error.strerror or str(error)
        return ""

    def _frames(self) -> Iterator[bytes]:
        while len(self._in) >= _LENGTH_BYTES:
            size = int.from_bytes(self._in[:_LENGTH_BYTES], "big")
            if not 0 < size <= _FRAME_BYTES_MAX:
                raise DecodeError(f"a frame of {size} bytes")
            if len(self._in) < _LENGTH_BYTES + size:
                return
            yield bytes(self._in[_LENGTH_BYTES : _LENGTH_BYTES + size])
            del self._in[: _LENGTH_BYTES + size]


_CERTIFICATE_ADVICE = {  # by OpenSSL's X509_V_ERR_...
    9: "it is not valid yet: check the clocks of both computers",
    10: "renew the server's certificate",
    62: "use the name in the certificate as the server's address, or install a certificate for this address",
    64: "use the name in the certificate as the server's address, or install a certificate for this address",
}


# Alerts of a server that requires a client certificate and got none that it trusts; in TLS 1.3 after the handshake.
_REFUSED_CERTIFICATE = ("TLSV13_ALERT_CERTIFICATE_REQUIRED", "TLSV1_ALERT_UNKNOWN_CA", "SSLV3_ALERT_BAD_CERTIFICATE",
                        "SSLV3_ALERT_CERTIFICATE_EXPIRED", "SSLV3_ALERT_CERTIFICATE_UNKNOWN")
_SHOW_A_CERTIFICATE = "the server requires a client certificate that it trusts: tls.load_cert_chain()"


def _split_address(address: str) -> Tuple[str, int]:
    match = isinstance(address, str) and re.fullmatch(r"(?:\[([^\]]+)\]|([^:\s]+)):(\d{1,5})", address)
    if not match or not 1 <= int(match[3]) <= 65535:
        raise ValueError(f"the server's address is {address!r}; HOST:PORT is needed")
    return match[1] or match[2], int(match[3])


class _Servers:
    """The servers of a client, and which one is next. Their order depends on the session alone, so that all robots of a
    session begin with the same server and the sessions are spread over the servers (rendezvous hashing)."""

    _REDIRECTS_MAX = 4  # in a row; then servers disagree
    _CONNECT_MAX = 3.0  # seconds, if there are several
    _UNCONFIRMED_MAX_MS = 5000

    def __init__(self, addresses: str, session: str) -> None:
        if not isinstance(addresses, str):
            raise ValueError(f"the server's address is {addresses!r}; HOST:PORT is needed")
        servers = {address: _split_address(address) for address in map(str.strip, addresses.split(","))}
        self._list = [servers[address] for address in sorted(servers, key=lambda address: hashlib.sha256(
            f"{session}\n{address}".encode(errors="replace")).digest())]
        self._next = 0
        self._tried = 0  # of the list, since the last wait
        self._redirects = 0
        self._wait_max = 3.0 if len(self._list) > 1 else math.inf
        self.wait_max = self._wait_max  # seconds before connecting again: short after a server has named another, because
        self.current = self._list[0]  # the session of a dead one is free in a few seconds

    def __str__(self) -> str:
        return f"{self.current[0]}:{self.current[1]}"

    def has_others(self) -> bool:
        """Returns whether another server than the current one may be tried."""
        return len(self._list) > 1 or self.current != self._list[0]

    def choose_another(self, address: str) -> bool:
        """Chooses another server, after the current one failed or has named the one that has the session. Returns
        whether to connect at once."""
        if address and self._redirects < self._REDIRECTS_MAX:
            try:
                self.current = _split_address(address)
                self._redirects += 1
                self.wait_max = 1.0
                return True
            except ValueError:
                pass  # as if it had named none
        self._redirects = 0
        was_named = self.current != self._list[self._next]
        if not was_named:
            self._next = (self._next + 1) % len(self._list)
            self._tried = (self._tried + 1) % len(self._list)
        self.current = self._list[self._next]
        return not was_named and self._tried != 0

    def connect(self, tls: Optional[ssl.SSLContext], timeout: float) -> socket.socket:
        """Connects to the current server. If there are others, waits for a short time only, also for the server's system
        to confirm what is sent: after a loss of power, others have its sessions soon."""
        if len(self._list) == 1:
            return _connect(*self.current, tls, timeout)
        sock = _connect(*self.current, tls, min(timeout, self._CONNECT_MAX))
        if hasattr(socket, "TCP_USER_TIMEOUT"):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, self._UNCONFIRMED_MAX_MS)
        return sock

    def settle(self) -> None:
        """The current server has welcomed the client."""
        self._redirects = 0
        self._tried = 0
        self.wait_max = self._wait_max


def _connect(host: str, port: int, tls: Optional[ssl.SSLContext], timeout: float) -> socket.socket:
    where = f"{host}:{port}"
    try:
        sock = socket.create_connection((host, port), timeout=timeout)
    except socket.gaierror as error:
        raise _retry("UNREACHABLE", f"cannot find {where}: {error.strerror}; check the server's address") from None
    except socket.timeout:
        raise _retry("UNREACHABLE", f"no connection to {where} within {timeout:g} s; check the network") from None
    except OSError as error:
        raise _retry("UNREACHABLE", f"cannot connect to {where}: {error.strerror or error}; is scanloom-server running "
                     "there?") from None
    try:
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return tls.wrap_socket(sock, server_hostname=host) if tls else sock
    except ssl.SSLCertVerificationError as error:
        sock.close()
        raise ScanloomError("UNAUTHORIZED", f"the certificate of {where} is not trusted: {error.verify_message}; "
                            + _CERTIFICATE_ADVICE.get(error.verify_code, "give tls= a context with its authority")
                            ) from None
    except OSError as error:
        sock.close()
        raise _retry("UNREACHABLE", f"no TLS with {where}: {error.strerror or error}") from None


# The client -----------------------------------------------------------------------------------------------------------


class Client:
    """Sends one robot's scans to a server, on its own thread.

    server       "HOST:PORT" of the server's robot port; of several servers that share a store, with commas between,
                 in any order, and spelled alike by all robots
    session      the map's name; the session is created if it does not exist
    robot        unique within the session
    cell_size    metres, for a new session; must match an existing session. None: the server's default
    token        for a server that requires one
    tls          for a server with TLS: ssl.create_default_context(), or one with cafile=
    source       identifies a repeatable source of scans, for example a recording. Empty for a live robot
    body_radius  metres, radius of a disc around the robot's origin that contains its body
    poses        what the robot knows of its poses, the same for all its scans: "map", poses in the map's frame;
                 "odometry", which drifts; "none". With the last two the server estimates where scans were taken
    on_correction
                 receives the Location of each correction, with poses="odometry" and "none": after scans are in the maps,
                 at most 20 times a second; see transform(). It runs on the client's thread, which waits for it, and
                 must not raise or call other functions of the client than transform()
    buffer_bytes limit for unacknowledged scans; send() waits at this limit

    Unacknowledged scans are in memory only: close() the client, or use it in a with block, before the program
    ends. Warnings about lost links go to the logger "scanloom".
    """

    def __init__(self, server: str, *, session: str, robot: str, cell_size: Optional[float] = None, token: str = "",
                 tls: Optional[ssl.SSLContext] = None, source: str = "", body_radius: Optional[float] = None,
                 poses: str = "map", on_correction: Optional[Callable[[Location], None]] = None,
                 buffer_bytes: int = 32 << 20, timing: Timing = Timing()) -> None:
        self._servers = _Servers(server, session)
        buffer_bytes = _whole("buffer_bytes", buffer_bytes, 1, 1 << 50)
        if tls is not None and not isinstance(tls, ssl.SSLContext):
            raise ValueError(f"tls is {tls!r}; an ssl.SSLContext is needed, see ssl.create_default_context()")
        if not isinstance(timing, Timing):
            raise ValueError(f"timing is {timing!r}; a Timing is needed")
        self._tls = tls
        self._timing = timing
        self._poses = poses
        self._on_correction = on_correction
        self._conversation = _Conversation(_hello(session, robot, token, source, cell_size, body_radius, poses),
                                           buffer_bytes, timing, time.monotonic())
        self._changed = threading.Condition()  # guards the members below and the conversation
        self._sensors: List[Sensor] = []
        self._failure: Optional[ScanloomError] = None  # final
        self._trouble = f"no answer from {server} yet"  # of the previous link
        self._is_aborted = False
        self._has_ended = False  # the thread
        self._bell_ringer, self._bell = socket.socketpair()
        self._bell_ringer.setblocking(False)
        self._bell.setblocking(False)
        self._thread = threading.Thread(target=self._run, name=f"scanloom {session}/{robot}", daemon=True)
        self._thread.start()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        if kind is None:
            self.close()
            return
        try:  # keeps the block's exception, but still sends the scans before it
            self.close(timeout=10.0)
        except ScanloomError as failure:
            if failure.message != str(error):
                _log.warning("%s", failure.message)

    # Sensors

    def laser(self, *, range_max: float, angle_min: Optional[float] = None, angle_increment: Optional[float] = None,
              count: Optional[int] = None, angles: Optional[Sequence[float]] = None, range_min: float = 0.0,
              mount: Pose = (0.0, 0.0, 0.0), aperture: float = 0.0, name: str = "laser") -> Sensor:
        """Describes a laser: evenly spaced beams (angle_min, angle_increment, count), where a scan may have more or
        fewer beams, or a list of angles. Angles are in the sensor's frame; mount is the sensor in the robot's frame."""
        return self._add_sensor("LASER", name, mount, (angle_min, angle_increment, count), angles, aperture, range_min,
                                range_max)

    def sonar(self, *, range_max: float, aperture: float, angle_min: Optional[float] = None,
              angle_increment: Optional[float] = None, count: Optional[int] = None,
              angles: Optional[Sequence[float]] = None, range_min: float = 0.0, mount: Pose = (0.0, 0.0, 0.0),
              name: str = "sonar") -> Sensor:
        """Describes one sonar, or a ring of sonars with a common origin; aperture is the full angle of a cone."""
        return self._add_sensor("SONAR", name, mount, (angle_min, angle_increment, count), angles, aperture, range_min,
                                range_max)

    def _add_sensor(self, kind: str, name: str, *description: Any) -> Sensor:
        with self._changed:
            if len(self._sensors) == _SENSORS_MAX:
                raise ValueError(f"a robot has at most {_SENSORS_MAX} sensors")
            self._sensors.append(_describe(len(self._sensors), kind, name, *description))
            return self._sensors[-1]

    # Scans

    def send(self, sensor: Sensor, ranges: Sequence[float], *, pose: Optional[Pose] = None, stamp: Optional[float] = None,
             odometry: Optional[Pose] = None, intensities: Optional[Sequence[int]] = None,
             angles: Optional[Sequence[float]] = None, begins_map: bool = False, block: bool = True,
             timeout: Optional[float] = None, duration: float = 0.0) -> None:
        """Adds a scan to the buffer and returns; it is sent when there is a link.

        ranges       one per beam; inf, or at least range_max: no return; nan, 0, or below range_min: invalid reading
        pose         of the robot in the map's frame; only and always with poses="map"
        stamp        seconds since the epoch, or since any fixed start; None: now
        odometry     of the robot in its odometry frame; needed with poses="odometry", not allowed with poses="none"
        intensities  in the sensor's own scale, one per beam
        angles       of this scan's beams, if they differ from the sensor's
        begins_map   the pose was given by the user, because locate() raised NOTHING_MAPPED; set it for all scans from
                     there. If the map is no longer empty, the robot's first scan is refused, and the client fails with
                     SESSION_CONFLICT
        duration     seconds from the first beam to the last of a laser that turns evenly; negative if the last beam was
                     taken first; stamp, pose and odometry are then of the middle of this time

        Waits while the buffer is full. Raises BufferFull if block is False then, or when timeout seconds have passed;
        ScanloomError once the client has failed.
        """
        self._take(*self._encoded(sensor, ranges, pose, stamp, odometry, intensities, angles, begins_map, duration),
                   block, timeout)

    def _encoded(self, sensor: Sensor, ranges: Any, pose: Any, stamp: Optional[float], odometry: Any, intensities: Any,
                 angles: Any, begins_map: bool = False, duration: Any = 0.0) -> Tuple[Sensor, bytes]:
        self._check_sensor(sensor)
        _check_poses(self._poses, pose, odometry)
        stamp = time.time() if stamp is None else stamp
        return sensor, _encode_scan(sensor, ranges, pose, stamp, odometry, intensities, angles, begins_map, duration)

    def _check_sensor(self, sensor: Any) -> None:
        if not isinstance(sensor, Sensor):
            raise ValueError(f"sensor is {sensor!r}; the result of laser() or sonar() is needed")
        if sensor.id >= len(self._sensors) or self._sensors[sensor.id] is not sensor:
            raise ValueError(f"{sensor.name} is not a sensor of this client")

    def _take(self, sensor: Sensor, encoded: bytes, block: bool, timeout: Optional[float]) -> None:
        with self._changed:
            self._check_open()
            waited = self._wait_for(self._conversation.has_room, timeout if block else 0.0)
            if not waited:
                raise BufferFull("BUFFER_FULL", f"the buffer is full: {self._unacknowledged()}", retryable=True)
            self._check_open()  # another thread may have closed it
            self._conversation.add(sensor, encoded, time.monotonic())
            self._ring()

    def flush(self, timeout: Optional[float] = None) -> None:
        """Waits until every scan passed to send() so far is durable. Raises ScanloomError on failure."""
        with self._changed:
            last = self._conversation.last
            if not self._wait_for(lambda: self._conversation.acknowledged >= last, timeout):
                raise ScanloomError("TIMEOUT", self._unacknowledged(), retryable=True)

    def close(self, timeout: Optional[float] = None) -> None:
        """Waits until every scan is durable and every request is answered, and disconnects. Raises ScanloomError on
        failure or after timeout seconds; unacknowledged scans are lost then."""
        with self._changed:
            self._conversation.is_ending = True
            self._ring()
            if not self._wait_for(lambda: self._has_ended, timeout):
                self._is_aborted = True
                self._ring()
                raise ScanloomError("TIMEOUT", self._unacknowledged(), retryable=True)
            self._check_failure()

    # Requests. Each is sent after the scans passed to send() before are in the server's maps, so that the server knows
    # the robot's newest pose.

    def plan(self, goal: Point, *, start: Optional[Point] = None, allow_unknown: bool = False,
             body_radius: Optional[float] = None, danger_cost: Optional[float] = None,
             timeout: Optional[float] = None) -> Path:
        """Returns the cheapest path to a point, from the pose of the newest scan or from start. Raises ScanloomError
        with NO_PATH if there is no path or the server has lost the robot, and TIMEOUT without an answer within timeout
        seconds."""
        frame = _Frame()
        request = frame.plan_request
        _set_point("goal", goal, request.goal)
        _set_options(request, start, body_radius)
        request.allow_unknown = bool(allow_unknown)
        if danger_cost is not None:
            request.danger_cost = _finite("danger_cost", danger_cost)
        reply = self._request(frame, timeout)
        return _path(reply.path, reply.revision)

    def next_goal(self, *, start: Optional[Point] = None, body_radius: Optional[float] = None,
                  frontier_size_min: int = 0, timeout: Optional[float] = None) -> Goal:
        """Returns the next exploration goal. Raises ScanloomError like plan()."""
        frame = _Frame()
        request = frame.goal_request
        request.SetInParent()
        _set_options(request, start, body_radius)
        request.frontier_size_min = _whole("frontier_size_min", frontier_size_min, 0, _NO_RETURN)
        reply = self._request(frame, timeout)
        goal = reply.goal
        return Goal(exploration=_enum_name("Exploration", goal.exploration, "EXPLORATION_"),
                    path=_path(goal.path, reply.revision) if goal.HasField("path") else None,
                    target=(goal.target.x, goal.target.y) if goal.HasField("target") else None,
                    given_up=goal.given_up, in_danger=goal.in_danger, revision=reply.revision)

    def coverage(self, *, start: Optional[Point] = None, body_radius: Optional[float] = None,
                 spacing: Optional[float] = None, region: Optional[Sequence[Any]] = None,
                 timeout: Optional[float] = None) -> Coverage:
        """Returns a coverage path over all free ground, or that within region: the corners of a polygon [(x, y), ...],
        or a box [x_min, y_min, x_max, y_max]. Raises ScanloomError like plan()."""
        frame = _Frame()
        request = frame.coverage_request
        request.SetInParent()
        _set_options(request, start, body_radius)
        if spacing is not None:
            request.spacing = _finite("spacing", spacing)
        if region is not None:
            request.region.extend(_region(region))
        reply = self._request(frame, timeout)
        runs = list(reply.coverage.unreachable)
        return Coverage(path=_path(reply.coverage.path, reply.revision), free_area=reply.coverage.free_area,
                        covered_area=reply.coverage.covered_area, cell_size=reply.coverage.cell_size,
                        unreachable=list(zip(runs[0::3], runs[1::3], runs[2::3])))

    def locate(self, sensor: Sensor, scans: Sequence[Sequence[float]], *, odometry: Pose = (0.0, 0.0, 0.0),
               angles: Optional[Sequence[Sequence[float]]] = None, near: Optional[Point] = None,
               radius: Optional[float] = None, timeout: Optional[float] = None) -> Location:
        """Returns the robot's location, determined from laser scans taken at one place. Earlier scans are not needed.

        scans     the ranges of several turns, as for send(); ten are enough
        odometry  of the robot in its odometry frame, where they were taken; without odometry, the origin
        angles    of each scan's beams, if they differ from the sensor's
        near      the robot is at most radius metres from there, along each axis; None: anywhere in the map

        Raises ScanloomError with AMBIGUOUS if several places are similar, UNDETERMINED if too little of the scans is
        in the map, NOTHING_MAPPED if the laser map is empty (then send() scans from a known pose with
        begins_map=True), and TIMEOUT like plan().
        """
        frame = _Frame()
        request = frame.locate_request
        if angles is not None and len(angles) != len(scans):
            raise ValueError(f"angles has {len(angles)} scans; {len(scans)} are given")
        self._check_sensor(sensor)
        laser = _described_laser(sensor)
        _set_pose("odometry", odometry, _Scan().odometry)  # so that an error names this argument
        points: List[Tuple[int, int]] = []
        for number, ranges in enumerate(scans):
            own = None if angles is None else angles[number]
            points += _points_seen(laser, _Scan.FromString(
                _encode_scan(sensor, ranges, odometry, 0.0, None, None, own)))
        _set_points(points, request)
        mount = laser.mount
        _set_point("from", _compose(odometry, (mount.x, mount.y, mount.yaw))[:2], getattr(request, "from"))
        _set_near(near, radius, request)
        found = self._request(frame, timeout).correction
        return _location(found)

    def _request(self, frame: Any, timeout: Optional[float]) -> Any:
        seconds = _lock_timeout(timeout)
        until = math.inf if seconds is None else time.monotonic() + seconds
        late = ScanloomError("TIMEOUT", "the server did not answer the request in time", retryable=True)
        with self._changed:
            self._check_open()
            conversation = self._conversation
            last = conversation.last
            if not self._wait_for(lambda: conversation.applied >= last, until - time.monotonic()):
                raise late
            if not self._wait_for(lambda: len(conversation.requests) < _REQUESTS_MAX, until - time.monotonic()):
                raise late
            self._check_open()
            id = conversation.add_request(frame)
            request = conversation.requests[id]
            self._ring()
            try:
                if not self._wait_for(lambda: request.reply is not None, until - time.monotonic()):
                    raise late
            finally:
                if request.reply is None:
                    conversation.abandon(id)
        reply: Any = request.reply
        if reply.WhichOneof("outcome") == "refusal":
            code = _enum_name("ErrorCode", reply.refusal.code, "ERROR_CODE_")
            raise ScanloomError(code, _shown(reply.refusal.message), code in ("OVERLOADED", "SHUTTING_DOWN"))
        return reply

    def transform(self) -> Optional[Location]:
        """Returns where the robot's odometry frame is in the map by the server's newest correction, also after its link
        has ended; None before the first one, while the robot is not located in the map that others began, and always
        with poses="map". Does not wait.

        at(odometry) of it is the robot's pose in the map, by its current odometry. It jumps when the server corrects
        the poses, for example where a loop closes. With poses="none" the robot itself is its odometry frame, so that
        at() is the pose of its newest scan in the maps.
        """
        with self._changed:
            location = self._conversation.location
        return None if location and location.state == "UNLOCATED" else location

    # Status

    def stored_before(self, timeout: Optional[float] = None) -> int:
        """Waits for the first connection, and returns the number of this robot's scans on the server then. A program
        that streams a recording skips this many."""
        with self._changed:
            if not self._wait_for(lambda: self._conversation.stored_before is not None, timeout):
                raise ScanloomError("TIMEOUT", self._trouble, retryable=True)
            return self._conversation.stored_before or 0

    @property
    def sent(self) -> int:
        """The number of scans sent in this run, each counted once."""
        return self.status().sent

    @property
    def acknowledged(self) -> int:
        """The number of durable scans of this robot, including those of earlier runs."""
        return self.status().acknowledged

    def status(self) -> Status:
        with self._changed:
            is_linked = self._conversation.link is not None and self._conversation.link.is_welcome
            before = self._conversation.stored_before or 0
            return Status(stored_before=before, scans=before + self._conversation.last,
                          sent=self._conversation.sent_ever, acknowledged=before + self._conversation.acknowledged,
                          bytes=self._conversation.bytes_sent, reconnects=max(0, self._conversation.welcomes - 1),
                          is_linked=is_linked)

    # Called with the lock held

    def _wait_for(self, condition: Callable[[], bool], timeout: Optional[float]) -> bool:
        """Returns whether the condition became true in time. Raises the error of a failed client."""
        timeout = _lock_timeout(timeout)
        self._changed.wait_for(lambda: condition() or self._failure is not None, timeout)
        if condition():
            return True
        self._check_failure()
        return False

    def _check_failure(self) -> None:
        if self._failure:
            raise ScanloomError(self._failure.code, self._failure.message, self._failure.retryable)

    def _check_open(self) -> None:
        self._check_failure()
        if self._conversation.is_ending:
            raise ScanloomError("CLOSED", "the client is closed")

    def _unacknowledged(self) -> str:
        count = self._conversation.last - self._conversation.acknowledged
        return f"{count} scans are not acknowledged: {self._what_is_wrong()}"

    def _what_is_wrong(self) -> str:
        if self._conversation.link and self._conversation.link.is_welcome:
            return "the server is connected but acknowledges nothing"
        return self._trouble

    def _ring(self) -> None:
        """Wakes the thread."""
        self._changed.notify_all()
        if self._has_ended:
            return
        try:
            self._bell_ringer.send(b"!")
        except BlockingIOError:
            pass  # the thread is already notified

    # Called on the thread

    def _run(self) -> None:
        failure: Optional[ScanloomError] = None
        try:
            failure = self._keep_linked()
        except Exception as error:  # pylint: disable=broad-except
            _log.exception("the client failed")
            failure = ScanloomError("INTERNAL", f"the client failed: {error!r}")
        with self._changed:
            self._failure = failure
            self._has_ended = True
            self._bell.close()
            self._bell_ringer.close()
            self._changed.notify_all()

    def _keep_linked(self) -> Optional[ScanloomError]:
        """Returns the final error, or None when everything is done."""
        backoff = _Backoff(self._timing)
        while True:
            acknowledged = self._conversation.acknowledged
            failure = self._use_one_link()
            with self._changed:
                self._conversation.close()
                if self._conversation.is_done():
                    return None
                if not failure.retryable:
                    return failure
                self._trouble = failure.message
                if self._servers.choose_another(failure.address):
                    continue  # at once
                _log.warning("%s; retrying", failure.message)
                if self._conversation.acknowledged > acknowledged:
                    backoff.reset()
                until = time.monotonic() + min(backoff.next(), self._servers.wait_max)
                self._changed.wait_for(lambda: self._conversation.is_done() or self._is_aborted,
                                       min(until, self._conversation.progress_deadline()) - time.monotonic())
                if self._conversation.is_done():
                    return None
                if self._is_aborted:
                    return self._given_up()
                if time.monotonic() >= self._conversation.progress_deadline():
                    return self._no_progress()

    def _no_progress(self) -> ScanloomError:
        return ScanloomError("TIMEOUT", f"gave up after {self._timing.give_up_after:g} s without progress: "
                             f"{self._what_is_wrong()}")

    def _given_up(self) -> ScanloomError:
        return ScanloomError("CLOSED", f"the client was closed while {self._unacknowledged()}")

    def _use_one_link(self) -> ScanloomError:
        """Returns the reason for the end of the link."""
        try:
            sock = self._servers.connect(self._tls, self._timing.connect)
        except ScanloomError as failure:
            return failure
        connection = _Connection(sock, self._bell)
        try:
            with self._changed:
                self._conversation.open(time.monotonic())
            while True:
                timeout = self._send_frames(connection)
                for body in connection.turn(timeout):
                    with self._changed:
                        before = self._conversation.location
                        self._conversation.receive(_Frame.FromString(body), time.monotonic())
                        if self._conversation.link and self._conversation.link.is_welcome:
                            self._servers.settle()
                        location = self._conversation.location
                        self._changed.notify_all()
                    if self._on_correction and location and location is not before:
                        self._on_correction(location)
        except ScanloomError as failure:
            return self._explained(failure)
        except DecodeError as error:
            return self._unreadable(error)
        finally:
            connection.close()

    def _send_frames(self, connection: _Connection) -> float:
        """Sends all frames that can be sent now; returns the seconds until the next check."""
        with self._changed:
            now = time.monotonic()
            self._conversation.check(now)
            progress_deadline = self._conversation.progress_deadline()
            if now >= progress_deadline:
                raise self._no_progress()
            if self._is_aborted:
                raise self._given_up()
            while connection.is_writable():
                frame = self._conversation.next_frame(now)
                if frame is None:
                    break
                connection.write(frame)
            return min(self._conversation.deadline(), progress_deadline) - now

    def _explained(self, failure: ScanloomError) -> ScanloomError:
        link = self._conversation.link
        if failure.code != "UNREACHABLE" or self._tls or (link and link.is_welcome):
            return failure
        return _retry("UNREACHABLE", f"{self._servers} closed the link without an answer; if it uses TLS, "
                      "give tls=")

    def _unreadable(self, error: DecodeError) -> ScanloomError:
        if self._conversation.link and self._conversation.link.is_welcome:
            return _retry("MALFORMED_FRAME", f"invalid data from the server: {error}")
        return ScanloomError("MALFORMED_FRAME", f"{self._servers} does not use Scanloom's robot protocol; "
                             "give the server's robot port, and tls= if it uses TLS", self._servers.has_others())


def _set_options(request: Any, start: Optional[Point], body_radius: Optional[float]) -> None:
    if start is not None:
        _set_point("start", start, request.start)
    if body_radius is not None:
        request.body_radius = _finite("body_radius", body_radius)


def _path(path: Any, revision: int) -> Path:
    return Path(list(zip(path.points[0::2], path.points[1::2])), path.length, path.cost, revision)


# Program ----------------------------------------------------------------------------------------------------------

_USAGE = """reads scans from standard input and streams them to a server, one JSON object per line:

  {"t": 12.5, "pose": [1.0, 0.5, 0.785], "ranges": [1.25, Infinity, null]}

  t            seconds
  pose         [x, y, yaw] of the robot in the map, metres and radians; only with --poses map
  ranges       metres, one per beam: Infinity or range-max is no return, null an invalid reading
  odometry     [x, y, yaw] of the robot in its odometry frame; needed with --poses odometry, absent with --poses none,
               else optional, like the following members
  intensities  whole numbers, one per beam
  angles       radians, one per beam, if they differ from --angle-min and --angle-increment
  duration     seconds from the first beam to the last of a laser that turns evenly; negative if the last beam was taken
               first; t, pose and odometry are then of the middle of this time

Invalid lines are reported and skipped. At the end it waits until every scan is durable and prints a summary. Exits 0 if
every line is stored, 1 if not or if lines were skipped ("skipped" of the summary), 2 on invalid arguments."""


class _OneLineParser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"scanloom_client.py: {message}; see --help\n")


def _parse_options(arguments: Optional[List[str]]) -> argparse.Namespace:
    parser = _OneLineParser(prog="scanloom_client.py", description=_USAGE,
                            formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
    parser.add_argument("--version", action="version", version=f"scanloom_client.py {__version__}")
    parser.add_argument("--server", required=True, metavar="HOST:PORT", help="the server's robot port; of several servers that share a store, with commas between")
    parser.add_argument("--session", required=True, help="the map's name")
    parser.add_argument("--robot", required=True, help="this robot's name, unique within the session")
    parser.add_argument("--cell-size", type=float, metavar="M", help="metres, for a new session")
    parser.add_argument("--poses", choices=_POSES, default="map",
                        help="what the robot knows of its poses [map]; otherwise the server estimates them")
    parser.add_argument("--angle-min", type=float, metavar="RAD", default=-math.pi,
                        help="direction of the first beam [-pi]")
    parser.add_argument("--angle-increment", type=float, metavar="RAD",
                        help="between beams [a full turn divided by the first line's beams]")
    parser.add_argument("--range-min", type=float, metavar="M", default=0.0, help="shorter readings are invalid [0]")
    parser.add_argument("--range-max", type=float, metavar="M", required=True, help="range of the laser")
    parser.add_argument("--token-file", metavar="FILE", help="file with the token for the server")
    parser.add_argument("--tls-ca", metavar="FILE", help="use TLS; certificate of the server's authority")
    parser.add_argument("--tls-cert", metavar="FILE", help="use TLS, with this client certificate")
    parser.add_argument("--tls-key", metavar="FILE", help="its private key [in the file of --tls-cert]")
    parser.add_argument("--source", default="", metavar="NAME",
                        help="name of a repeatable source: lines that the server already has are skipped")
    return parser.parse_args(arguments)


def _open(options: argparse.Namespace) -> Client:
    token = ""
    if options.token_file:
        with open(options.token_file, encoding="utf-8") as file:
            token = file.read().strip()
    tls = ssl.create_default_context(cafile=options.tls_ca) if options.tls_ca or options.tls_cert else None
    if tls and options.tls_cert:
        tls.load_cert_chain(options.tls_cert, options.tls_key)
    return Client(options.server, session=options.session, robot=options.robot, cell_size=options.cell_size,
                  token=token, tls=tls, source=options.source, poses=options.poses)


class _Lines:
    """Converts lines of the input to scans."""

    _REPORTED_MAX = 10  # of skipped lines

    def __init__(self, robot: Client, options: argparse.Namespace) -> None:
        self._robot = robot
        self._options = options
        self._laser: Optional[Sensor] = None
        self.skipped = 0

    def stream(self, lines: Any) -> None:
        """Sends the scans until the input ends or a first signal arrives."""
        known = self._robot.stored_before() if self._options.source else 0
        try:
            for number, line in enumerate(lines, start=1):
                if not line.strip():
                    continue
                try:
                    scan = self._read(line)
                except (ValueError, TypeError, RecursionError) as error:
                    self._skip(number, error)
                    continue
                if known > 0:
                    known -= 1
                else:
                    self._robot._take(*scan, True, None)
        except KeyboardInterrupt:
            print("interrupted: waiting until sent scans are stored; interrupt again to end immediately",
                  file=sys.stderr)

    def _skip(self, number: int, error: Exception) -> None:
        self.skipped += 1
        if self.skipped <= self._REPORTED_MAX:
            print(f"scanloom_client.py: line {number} of the input is skipped: {error}", file=sys.stderr)
        if self.skipped == self._REPORTED_MAX:
            print("scanloom_client.py: further skipped lines are only counted", file=sys.stderr)

    def _read(self, line: bytes) -> Tuple[Sensor, bytes]:
        scan = json.loads(line)
        needed = {"map": ("t", "pose", "ranges"), "odometry": ("t", "odometry", "ranges")}.get(
            self._options.poses, ("t", "ranges"))
        if not isinstance(scan, dict) or not set(needed) <= scan.keys():
            quoted = [f'"{name}"' for name in needed]
            raise ValueError(f"an object with {', '.join(quoted[:-1])} and {quoted[-1]} is needed")
        if not isinstance(scan["ranges"], list):
            raise ValueError("ranges is not a list of numbers")
        ranges = [math.nan if value is None else value for value in scan["ranges"]]
        pose, odometry = scan.get("pose"), scan.get("odometry")
        _check_poses(self._options.poses, pose, odometry)  # so that an invalid line describes no laser
        if pose is not None:
            _set_pose("pose", pose, _Scan().pose)
        return self._robot._encoded(self._laser or self._make_laser(len(ranges)), ranges, pose, _finite("t", scan["t"]),
                                    odometry, scan.get("intensities"), scan.get("angles"),
                                    duration=scan.get("duration", 0.0))

    def _make_laser(self, count: int) -> Sensor:
        options = self._options
        increment = 2.0 * math.pi / max(count, 1) if options.angle_increment is None else options.angle_increment
        self._laser = self._robot.laser(angle_min=options.angle_min, angle_increment=increment, count=count,
                                        range_min=options.range_min, range_max=options.range_max)
        return self._laser


def main(arguments: Optional[List[str]] = None) -> int:
    options = _parse_options(arguments)
    logging.basicConfig(format="scanloom_client.py: %(message)s")
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    started = time.monotonic()
    problem = ""
    try:
        robot = _open(options)
    except (ValueError, OSError) as error:
        print(f"scanloom_client.py: {error}", file=sys.stderr)
        return 2
    lines = _Lines(robot, options)
    try:
        with robot:
            lines.stream(sys.stdin.buffer)
    except (ScanloomError, ValueError) as error:
        problem = str(error)
    except KeyboardInterrupt:
        problem = "interrupted before every scan was acknowledged"
    summary = dataclasses.asdict(robot.status())
    del summary["is_linked"]
    if lines.skipped and not problem:
        problem = f"{lines.skipped} lines of the input were skipped; the others are stored"
    summary.update(skipped=lines.skipped, seconds=round(time.monotonic() - started, 3), session=options.session,
                   robot=options.robot)
    if problem:
        summary["error"] = problem
        print(f"scanloom_client.py: {problem}", file=sys.stderr)
    print(json.dumps(summary))
    return 1 if problem else 0


if __name__ == "__main__":
    sys.exit(main())
