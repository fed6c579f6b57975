"""Writes and lists bags with ROS's own rosbag: Debian's package python3-rosbag.

usage: rosbag_judge.py write FILE COMPRESSION    writes a bag of raw messages
       rosbag_judge.py list FILE                 prints the messages of a bag: topic, type, time in ns, bytes in hex
"""
import sys

try:
    import rosbag
    import rospy
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(77)


class Scan:
    """Any message, as far as rosbag needs it: bytes that are written as they are."""
    _type = "sensor_msgs/LaserScan"
    _md5sum = "90c7ef2dc6895d81024acba2ac42f369"
    _full_text = "float32 x\n"


def write(file, compression):
    with rosbag.Bag(file, "w", compression=compression, chunk_threshold=2000) as bag:
        for i in range(300):
            data = bytes((i * k) % 256 for k in range(i % 90))
            topic = "/scan" if i % 2 else "/rear/scan"
            time = rospy.Time(1_700_000_000 + i, 999_999_000 + i)
            bag.write(topic, (Scan._type, data, Scan._md5sum, (0, 0), Scan), time, raw=True)


def list_messages(file):
    with rosbag.Bag(file) as bag:
        for topic, raw, time in bag.read_messages(raw=True):
            print(topic, raw[0], time.to_nsec(), raw[1].hex() or "-")


if sys.argv[1] == "write":
    write(sys.argv[2], sys.argv[3])
else:
    list_messages(sys.argv[2])
