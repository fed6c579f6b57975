"""locate() and transform(): the position of a robot from its laser scans."""
import math
import unittest

from fixture import LinkTest
from programs import scanloom_client

ROUND = dict(angle_min=0.0, angle_increment=math.pi / 2, count=4, range_min=0.1, range_max=10.0)


def points_of(request):
    """In whole millimetres."""
    x = y = 0
    points = []
    for dx, dy in zip(request.points[0::2], request.points[1::2]):
        x, y = x + dx, y + dy
        points.append((x, y))
    return points


class Locate(LinkTest):
    def answers(self, **reply):
        """Receives one request, stores it in self.asked, and answers it."""
        def script(link):
            link.greet()
            frame = link.serve(until=lambda frame: frame.WhichOneof("body") == "locate_request")
            self.asked = frame.locate_request
            link.send(locate_reply={"id": self.asked.id, "revision": 9, **reply})
            link.serve()

        return script

    def found(self):
        return self.answers(correction={"T_map_odom": {"x": 1.0, "y": 2.0, "yaw": math.pi / 2}, "revision": 9,
                                        "explained": 0.9, "position_sigma": 0.01, "yaw_sigma": 0.02})

    def test_it_returns_the_servers_answer_also_before_any_scan(self):
        self.start(self.found())
        with self.client() as robot:
            location = robot.locate(self.laser(robot, **ROUND), [[1.0, 2.0, math.inf, math.nan]] * 10)
        self.assertEqual(location.T_map_odom, (1.0, 2.0, math.pi / 2))
        self.assertEqual(location.explained, location.inlier_ratio, "the earlier name")
        self.assertEqual((location.inlier_ratio, location.position_sigma, location.yaw_sigma, location.revision),
                         (0.9, 0.01, 0.02, 9))
        for actual, wanted in zip(location.at((1.0, 0.5, math.pi)), (0.5, 3.0, -math.pi / 2)):
            self.assertAlmostEqual(actual, wanted)
        self.assertEqual(points_of(self.asked), [(1000, 0), (0, 2000)] * 10)
        self.assertFalse(self.asked.HasField("near"))

    def test_points_are_in_the_frame_of_the_odometry(self):
        self.start(self.found())
        with self.client() as robot:
            laser = self.laser(robot, **{**ROUND, "mount": (0.5, 0.0, math.pi / 2)})
            robot.locate(laser, [[1.0, 0.05, 10.0, 0.0]] * 20, odometry=(1.0, 2.0, math.pi / 2), near=(3.0, 4.0),
                         radius=5.0)
        self.assertEqual(points_of(self.asked), [(0, 2500)] * 20)
        origin = getattr(self.asked, "from")
        self.assertAlmostEqual(origin.x, 1.0)
        self.assertAlmostEqual(origin.y, 2.5)
        self.assertEqual((self.asked.near.x, self.asked.near.y, self.asked.radius), (3.0, 4.0, 5.0))

    def test_scans_may_have_their_own_angles(self):
        self.start(self.found())
        with self.client() as robot:
            robot.locate(self.laser(robot, **ROUND), [[1.0] * 10, [2.0] * 10], angles=[[0.0] * 10, [math.pi] * 10])
        self.assertEqual(points_of(self.asked), [(1000, 0)] * 10 + [(-2000, 0)] * 10)

    def test_too_many_points_are_thinned_evenly(self):
        self.start(self.found())
        with self.client() as robot:
            laser = self.laser(robot, **ROUND)
            robot.locate(laser, [[1.0 + 0.0001 * n] * 4 for n in range(3 * 32768 // 8)])
        points = points_of(self.asked)
        self.assertEqual(len(points), 32768)
        self.assertEqual(points[0], (1000, 0))
        self.assertGreater(max(map(abs, points[-1])), 2220)

    def test_refusals_are_raised(self):
        for code, name in ((20, "AMBIGUOUS"), (21, "UNDETERMINED"), (22, "NOTHING_MAPPED")):
            with self.subTest(name):
                self.start(self.answers(refusal={"code": code, "message": "why"}))
                with self.client() as robot:
                    error = self.assert_fails(name, robot.locate, self.laser(robot, **ROUND), [[1.0] * 4] * 10)
                    self.assertEqual((error.message, error.retryable), ("why", False))

    def test_a_server_without_this_request_is_reported_as_an_earlier_version(self):
        def knows_nothing(link):
            link.greet()
            link.serve(until=lambda frame: frame.WhichOneof("body") == "locate_request")
            link.send(error={"code": 1, "message": "a frame without a body this program knows", "retryable": False})

        self.start(knows_nothing)
        error = self.assert_fails("MALFORMED_FRAME", self.locate_once)
        self.assertIn("; a server of an earlier version cannot localize robots: update it, or state",
                      error.message)

    def locate_once(self):
        with self.client() as robot:
            robot.locate(self.laser(robot, **ROUND), [[1.0] * 4] * 10)

    def test_invalid_arguments_are_refused_by_name(self):
        self.start()
        with self.client() as robot:
            laser = self.laser(robot, **ROUND)
            sonar = robot.sonar(range_max=5.0, aperture=0.5, **{k: ROUND[k] for k in ("angle_min", "angle_increment",
                                                                                     "count")})
            scans = [[1.0] * 4] * 10
            for expected, arguments in [("the scans have 0 points; at least 20 are needed", {"scans": []}),
                                    ("the scans have 16 points", {"scans": scans[:4]}),
                                    ("sonar is not a laser", {"sensor": sonar}),
                                    ("sensor is None", {"sensor": None}),
                                    ("odometry.x is nan", {"odometry": (math.nan, 0.0, 0.0)}),
                                    ("angles has 1 scans; 10 are given", {"angles": [[0.0] * 4]}),
                                    ("near and radius need each other", {"near": (1.0, 2.0)}),
                                    ("near and radius need each other", {"radius": 2.0}),
                                    ("radius is 0.0", {"near": (1.0, 2.0), "radius": 0.0}),
                                    ("radius is 1001", {"near": (1.0, 2.0), "radius": 1001}),
                                    ("near is 3", {"near": 3, "radius": 1.0})]:
                with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                    robot.locate(**{"sensor": laser, "scans": scans, **arguments})


class Corrections(LinkTest):
    def correction(self, x, state):
        return {"T_map_odom": {"x": x, "y": 2.0, "yaw": math.pi / 2}, "revision": 9, "explained": 0.9,
                "position_sigma": 0.01, "yaw_sigma": 0.02, "state": state,
                **({"mount_yaw_error": 3.0} if state == 2 else {})}

    def test_each_is_passed_on_and_the_newest_is_kept_also_after_a_reconnect(self):
        def first(link):
            link.greet()
            link.send(correction=self.correction(1.0, 1))
            link.send(correction=self.correction(3.0, 2))
            link.close()

        def second(link):
            link.greet()
            link.serve()

        received = []
        self.start(first, second)
        with self.client(poses="odometry", on_correction=received.append) as robot:
            laser = self.laser(robot)
            robot.send(laser, [1.0] * 50, odometry=(0.0, 0.0, 0.0), stamp=0.0)
            robot.flush(timeout=10.0)
            newest = robot.transform()
        self.assertEqual([(location.T_map_odom, location.state) for location in received],
                         [((1.0, 2.0, math.pi / 2), "TRACKING"), ((3.0, 2.0, math.pi / 2), "LOST")])
        self.assertIs(newest, received[-1])
        self.assertEqual([location.mount_yaw_error for location in received], [None, 3.0])
        self.assertEqual((newest.inlier_ratio, newest.position_sigma, newest.yaw_sigma, newest.revision),
                         (0.9, 0.01, 0.02, 9))
        for actual, wanted in zip(newest.at((1.0, 0.5, math.pi)), (2.5, 3.0, -math.pi / 2)):
            self.assertAlmostEqual(actual, wanted)

    def test_there_is_none_before_the_first(self):
        self.start(lambda link: (link.greet(), link.serve()))
        with self.client(poses="none") as robot:
            robot.stored_before(timeout=10.0)
            self.assertIsNone(robot.transform())


if __name__ == "__main__":
    unittest.main()
