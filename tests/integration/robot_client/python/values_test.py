"""Conversion of the callers' values to messages."""
import array
import math
import unittest

from fixture import LinkTest
from programs import scanloom_client

NO_RETURN = 0xFFFFFFFF


class Millimetres(unittest.TestCase):
    def assert_rounds(self, cases):
        self.assertEqual([scanloom_client._millimetres(metres) for metres in cases], list(cases.values()))

    def test_readings_are_rounded_to_the_nearest_millimetre(self):
        self.assert_rounds({1.0: 1000, 1.2344: 1234, 1.2346: 1235, 81.83: 81830, 2: 2000})
        self.assert_rounds({0.0004: 0, 0.0005: 1, 0.0025: 3})

    def test_values_that_are_no_length_are_invalid(self):
        self.assert_rounds({0.0: 0, -1.0: 0, -math.inf: 0, math.nan: 0})

    def test_values_beyond_the_range_of_millimetres_have_no_return(self):
        self.assert_rounds({4294967.294: 4294967294})
        self.assert_rounds(dict.fromkeys((4294967.295, 5e6, 1e300, math.inf), NO_RETURN))


class Fields(LinkTest):
    def sent(self, ranges, sensor=None, **options):
        """The scan as received."""
        self.start()
        with self.client() as robot:
            laser = self.laser(robot, **(sensor or {}))
            robot.send(laser, ranges, **{"pose": (1.0, 2.0, 3.0), "stamp": 4.5, **options})
        return self.server.stored[0]

    def test_all_given_values_arrive(self):
        scan = self.sent([1.0, math.inf, math.nan], odometry=(4.0, 5.0, 6.0), intensities=[1.0, 255, 0],
                         angles=[0.1, 0.3, 0.2], begins_map=True, duration=-0.1)
        self.assertEqual((scan.pose.x, scan.pose.y, scan.pose.yaw, scan.stamp), (1.0, 2.0, 3.0, 4.5))
        self.assertEqual((scan.odometry.x, scan.odometry.y, scan.odometry.yaw), (4.0, 5.0, 6.0))
        self.assertEqual(list(scan.ranges), [1000, NO_RETURN, 0])
        self.assertEqual(list(scan.intensities), [1, 255, 0])
        self.assertEqual(list(scan.angles.explicit.angles), [0.1, 0.3, 0.2])
        self.assertTrue(scan.begins_map)
        self.assertEqual(scan.duration, -0.1)

    def test_missing_values_are_absent(self):
        scan = self.sent([1.0], pose=(0, 0, 0))
        self.assertTrue(scan.HasField("pose"))
        self.assertFalse(scan.HasField("odometry") or scan.HasField("angles") or scan.intensities or scan.begins_map or scan.duration)

    def test_poses_that_are_not_in_the_map_are_absent(self):
        for poses, odometry in (("odometry", (1.0, 2.0, 3.0)), ("none", None)):
            with self.subTest(poses):
                self.start()
                with self.client(poses=poses) as robot:
                    robot.send(self.laser(robot), [1.0], stamp=0.0, odometry=odometry)
                scan = self.server.stored[0]
                self.assertEqual((scan.HasField("pose"), scan.HasField("odometry")), (False, odometry is not None))
                self.assertEqual(self.server.hellos[0].poses, {"odometry": 1, "none": 2}[poses])

    def test_arrays_are_accepted_like_lists(self):
        self.assertEqual(list(self.sent(array.array("f", [1.5, 2.5])).ranges), [1500, 2500])

    def test_a_hello_names_the_program(self):
        self.start()
        with self.client(cell_size=0.1, token="secret", source="recording", body_radius=0.2):
            pass
        hello = self.server.hellos[0]
        self.assertEqual((hello.protocol_version, hello.session, hello.robot), (1, "s", "r"))
        self.assertEqual((hello.token, hello.source, hello.body_radius), ("secret", "recording", 0.2))
        self.assertEqual(hello.create.cell_size, 0.1)
        self.assertTrue(hello.client.startswith("scanloom_client.py "))

    def test_a_session_is_created_also_without_a_cell_size(self):
        self.start()
        with self.client():
            pass
        self.assertTrue(self.server.hellos[0].HasField("create"))
        self.assertFalse(self.server.hellos[0].create.HasField("cell_size"))


class Refused(LinkTest):
    def test_invalid_scans_are_refused_by_name(self):
        self.start()
        with self.client() as robot:
            laser = self.laser(robot)
            fixed = robot.laser(angles=[0.0, 0.1], range_max=5.0)
            good = {"sensor": laser, "ranges": [1.0, 2.0], "pose": (0.0, 0.0, 0.0), "stamp": 0.0}
            for expected, wrong in [
                    ("ranges has 0 beams", {"ranges": []}),
                    ("ranges has 4097 beams", {"ranges": [1.0] * 4097}),
                    ("more than a full turn", {"ranges": [1.0] * 700}),
                    ("ranges contains an invalid number", {"ranges": ["1", 2.0]}),
                    ("for 2 angles", {"sensor": fixed, "ranges": [1.0]}),
                    ("for 3 angles", {"angles": [0.0, 0.1, 0.2]}),
                    ("an angle is nan", {"angles": [0.0, math.nan]}),
                    ("intensities has 1 values", {"intensities": [1]}),
                    ("duration is -10.5", {"duration": -10.5}),
                    ("begins_map is 'False'", {"begins_map": "False"}),
                    ("intensities are whole numbers", {"intensities": [-1, 0]}),
                    ("pose.yaw is nan", {"pose": (0.0, 0.0, math.nan)}),
                    ("pose.x is 2000000.0", {"pose": (2e6, 0.0, 0.0)}),
                    ("pose has 2 numbers", {"pose": (0.0, 0.0)}),
                    ("odometry.y is inf", {"odometry": (0.0, math.inf, 0.0)}),
                    ("ranges is of type bytes", {"ranges": b"12"}),
                    ("ranges is of type dict", {"ranges": {1.0: 2.0}}),
                    ("ranges is of type NoneType", {"ranges": None}),
                    ("pose is None", {"pose": None}),
                    ("pose.x is 1000", {"pose": (10**400, 0, 0)}),
                    ("sensor is None", {"sensor": None}),
                    ("timeout is 'x'", {"timeout": "x"}),
                    ("stamp is 1000", {"stamp": 10**400}),
                    ("stamp is 'now'", {"stamp": "now"})]:
                with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                    robot.send(**{**good, **wrong})
            robot.send(**good)
        self.assertEqual(len(self.server.stored), 1)

    def test_scans_without_the_poses_of_the_client_are_refused(self):
        pose = (0.0, 0.0, 0.0)
        self.start()
        for poses, expected, given in [
                ("map", "pose is None", {"odometry": pose}),
                ("odometry", "odometry is None", {}),
                ("odometry", "leave pose out", {"pose": pose, "odometry": pose}),
                ("none", "leave pose out", {"pose": pose}),
                ("none", "leave odometry out", {"odometry": pose})]:
            robot = self.client(poses=poses)
            with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                robot.send(self.laser(robot), [1.0], **given)
        with self.assertRaisesRegex(ValueError, "poses is 'gps'; 'map', 'odometry' or 'none' is needed"):
            self.client(poses="gps")

    def test_a_full_turn_of_a_float32_increment_is_sent(self):
        self.start()
        with self.client() as robot:
            laser = self.laser(robot, angle_increment=0.017501922324299812, count=360)  # a TurtleBot3's
            robot.send(sensor=laser, ranges=[1.0] * 360, pose=(0.0, 0.0, 0.0), stamp=0.0)
        self.assertEqual(len(self.server.stored), 1)

    def test_invalid_sensors_are_refused_by_name(self):
        self.start()
        robot = self.client()
        for expected, wrong in [
                ("angle_increment is 0", {"angle_increment": 0.0}),
                ("more than a full turn", {"angle_increment": 1.0}),
                ("count has 0 beams", {"count": 0}),
                ("count is 1.5", {"count": 1.5}),
                ("name is None", {"name": None}),
                ("give angle_min", {"angle_min": None}),
                ("not both", {"angles": [0.0]}),
                ("range_max 1001", {"range_max": 1001.0}),
                ("range_min is 11", {"range_min": 11.0}),
                ("aperture is 4", {"aperture": 4.0}),
                ("longer than 64 bytes", {"name": "n" * 65}),
                ("mount.x is nan", {"mount": (math.nan, 0.0, 0.0)})]:
            with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                self.laser(robot, **wrong)
        for _ in range(64):
            self.laser(robot)
        with self.assertRaisesRegex(ValueError, "at most 64 sensors"):
            self.laser(robot)

    def test_a_sensor_of_another_client_is_refused(self):
        self.start()
        with self.client() as one:
            stranger = self.laser(one)
        with self.client() as other:
            self.laser(other)
            with self.assertRaisesRegex(ValueError, "not a sensor of this client"):
                self.send(other, stranger, 1)

    def test_invalid_names_and_addresses_are_refused(self):
        for expected, wrong in [("session is 'a b'", {"session": "a b"}), ("robot is ''", {"robot": ""}),
                            ("source", {"source": "s" * 65}), ("HOST:PORT", {"server": "localhost"}),
                            ("HOST:PORT", {"server": "localhost:0"}), ("cell_size is nan", {"cell_size": math.nan}),
                            ("cell_size is 2", {"cell_size": 2}), ("body_radius is 6", {"body_radius": 6}),
                            ("session is None", {"session": None}), ("token is None", {"token": None}),
                            ("token is longer", {"token": "t" * 20000}), ("HOST:PORT", {"server": None}),
                            ("tls is True", {"tls": True}), ("buffer_bytes is 0", {"buffer_bytes": 0}),
                            ("buffer_bytes is -1", {"buffer_bytes": -1}), ("source is 'a.nb'", {"source": "a\nb"})]:
            with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                scanloom_client.Client(**{"server": "127.0.0.1:1", "session": "s", "robot": "r", **wrong})

    def test_addresses_may_be_ipv6(self):
        self.assertEqual(scanloom_client._split_address("[::1]:7447"), ("::1", 7447))


if __name__ == "__main__":
    unittest.main()
