"""The client with the real server: maps are correct, and nothing is lost when the server is killed."""
import math
import os
import pathlib
import random
import sys
import tempfile
import unittest

import fixture  # disables the log of lost links
from programs import PROGRAMS, SOURCE, RunningServer, run, scanloom_client

NO_READING = 81.83  # a SICK scanner's value for 50 m and more


class ServerTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)
        self.server = RunningServer(self.directory)
        self.addCleanup(lambda: self.server.stop())

    def client(self, session, **options):
        return scanloom_client.Client(self.server.address, session=session, robot="r",
                                      timing=scanloom_client.Timing(backoff_first=0.01, backoff_max=0.1), **options)

    def assert_fails(self, code, call, *arguments):
        with self.assertRaises(scanloom_client.ScanloomError) as caught:
            call(*arguments)
        self.assertEqual(caught.exception.code, code, caught.exception.message)


def square_room(yaw, beams=361):
    """The scan of a laser in the middle of a room of 4 m by 4 m."""
    angles = [yaw - math.pi / 2 + i * math.pi / 360 for i in range(beams)]
    return [2.0 / max(abs(math.cos(angle)), abs(math.sin(angle))) for angle in angles]


def half_turn_laser(robot, **options):
    return robot.laser(angle_min=-math.pi / 2, angle_increment=math.pi / 360, count=361, range_max=10.0, **options)


class Maps(ServerTest):
    def cells(self, session, layer):
        """Rows from the top, of the square of 16 m around the origin."""
        table = self.server.get(f"{session}/map.csv?layer={layer}&bbox=-8,-8,8,8")
        return [[float(cell) for cell in row.split(",")] for row in table.split()]

    def test_walls_are_occupied_and_the_room_is_free(self):
        with self.client("room", cell_size=0.1) as robot:
            laser = half_turn_laser(robot)
            for degrees in range(0, 360, 10):
                yaw = math.radians(degrees)
                robot.send(laser, square_room(yaw), pose=(5.05, -3.05, yaw), stamp=degrees / 10.0)
        self.assertEqual(self.server.get_json("room")["scans"], 36)
        rows = self.cells("room", "classification")

        def class_at(x, y):
            return rows[int((8.0 - y) / 0.1)][int((x + 8.0) / 0.1)]

        for along in (-1.5, 0.0, 1.5):
            for x, y in ((7.05, -3.05 + along), (3.05, -3.05 + along), (5.05 + along, -1.05), (5.05 + along, -5.05)):
                self.assertEqual(class_at(x, y), 2, f"the wall at {x}, {y}")
            for x, y in ((5.05 + along / 2, -2.05), (5.05 + along / 2, -4.05)):
                self.assertEqual(class_at(x, y), 1, f"the floor at {x}, {y}")

    def test_sonars_are_mapped_as_sonars(self):
        with self.client("ring", cell_size=0.1) as robot:
            ring = robot.sonar(angle_min=0.0, angle_increment=math.pi / 4, count=8, aperture=0.4, range_max=5.0)
            robot.send(ring, [2.0] * 8, pose=(0.0, 0.0, 0.0), stamp=0.0)
        sonar, occupancy = ({cell for row in self.cells("ring", layer) for cell in row}
                            for layer in ("sonar", "occupancy"))
        self.assertGreater(len(sonar), 2)
        self.assertEqual(len(occupancy), 1)

    def test_a_mounted_laser_with_listed_angles_gives_the_map_of_a_centred_one(self):
        with self.client("middle", cell_size=0.1) as robot:
            robot.send(half_turn_laser(robot), square_room(0.0), pose=(0.0, 0.0, 0.0), stamp=0.0)
        with self.client("mounted", cell_size=0.1) as robot:
            angles = [-math.pi / 2 + i * math.pi / 360 for i in range(361)]
            laser = robot.laser(angles=angles, range_max=10.0, mount=(-0.5, 0.0, 0.0))
            robot.send(laser, square_room(0.0), pose=(0.5, 0.0, 0.0), stamp=0.0)
        middle, mounted = (self.cells(session, "classification") for session in ("middle", "mounted"))
        self.assertEqual(middle, mounted)

    def test_paths_goals_and_coverage_are_found(self):
        with self.client("room", cell_size=0.05, body_radius=0.15) as robot:
            laser = half_turn_laser(robot)
            robot.send(laser, square_room(0.0), pose=(0.0, 0.0, 0.0), stamp=0.0)
            robot.flush()
            path = robot.plan((1.0, 1.0))
            self.assertAlmostEqual(math.dist(path.points[-1], (1.0, 1.0)), 0.0, delta=0.05)
            self.assertGreaterEqual(path.length, math.sqrt(2.0) - 0.1)
            self.assert_fails("NO_PATH", robot.plan, (5.0, 5.0))
            goal = robot.next_goal()
            self.assertEqual(goal.exploration, "GOAL")
            self.assertEqual(len(goal.target), 2)
            robot.send(laser, square_room(math.pi), pose=(0.0, 0.0, math.pi), stamp=1.0)
            robot.flush()
            self.assertEqual(robot.next_goal().exploration, "COMPLETE")
            coverage = robot.coverage(region=[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
            self.assertAlmostEqual(coverage.free_area, 4.0, delta=0.2)
            self.assertAlmostEqual(coverage.covered_area, coverage.free_area, delta=0.1)

    def test_settings_that_differ_from_the_sessions_are_refused(self):
        self.client("room", cell_size=0.05).close()
        self.assert_fails("SESSION_CONFLICT", self.client("room", cell_size=0.1).close)

    def test_the_example_runs(self):
        code, out, errors = run(sys.executable, SOURCE / "robot_client/examples/send_scan.py", self.server.address,
                                env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
        self.assertEqual((code, out), (0, "36 scans are stored\n"), errors)


class SameAsTheRobotProgram(ServerTest):
    def test_a_carmen_file_gives_the_same_maps_from_every_client(self):
        log = self.directory / "log.clf"
        log.write_text("".join(carmen_lines(200)))
        code, _, errors = run(PROGRAMS / "scanloom-robot", "--server", self.server.address, "--session", "replayed",
                              "--robot", "r", "--cell-size", "0.05", "replay", log)
        self.assertEqual(code, 0, errors)
        with self.client("sent", cell_size=0.05) as robot:
            send_carmen(robot, log)
        replayed, sent = (self.server.get_json(session + "/digest") for session in ("replayed", "sent"))
        self.assertEqual(sent["layers"], replayed["layers"])
        self.assertEqual(self.server.get_json("sent")["scans"], 200)


def carmen_lines(count):
    """FLASER ranges, laser pose, odometry, times. Readings are such that rounding matters."""
    noise = random.Random(5)
    for i in range(count):
        x, y, yaw = 0.003 * i, 0.5 * math.sin(0.02 * i), 0.01 * i - 1.0
        ranges = [NO_READING if noise.random() < 0.02 else round(r + noise.uniform(-0.05, 0.05), 4)
                  for r in square_room(yaw)]
        pose = f"{x:.6f} {y:.6f} {yaw:.6f}"
        yield f"FLASER 361 {' '.join(map(str, ranges))} {pose} {pose} {0.1 * i:.6f} robot {0.1 * i:.6f}\n"


def send_carmen(robot, log):
    """Converts as `scanloom-robot replay` does: readings of 50 m and more carry no information."""
    laser = half_turn_laser_of_carmen(robot)
    with open(log, encoding="ascii") as lines:
        for line in lines:
            words = line.split()
            ranges = [float(word) for word in words[2:363]]
            pose = tuple(float(word) for word in words[363:366])
            robot.send(laser, [r if r < 50.0 else math.nan for r in ranges], pose=pose, odometry=pose,
                       stamp=float(words[369]))


def half_turn_laser_of_carmen(robot):
    return robot.laser(angle_min=-math.pi / 2, angle_increment=math.pi / 360, count=361, range_max=50.0)


class Killed(ServerTest):
    SCANS = 600

    def stream(self, robot, disturb=lambda i: None):
        laser = half_turn_laser(robot)
        for i in range(self.SCANS):
            disturb(i)
            yaw = 0.02 * i
            robot.send(laser, square_room(yaw), pose=(0.001 * i, 0.0, yaw), odometry=(0.0, 0.0, yaw), stamp=0.1 * i)

    def restart(self):
        self.server.kill()
        self.server = RunningServer(self.directory, self.server.robot_port, self.server.http_port)

    def test_no_scan_is_lost_or_duplicated(self):
        with self.client("undisturbed", cell_size=0.05) as robot:
            self.stream(robot)

        def kill_now_and_then(i):
            if i in (100, 200, 400):
                robot.flush()
            if i in (100, 103, 250, 420):  # with all, a few, and many scans in flight
                self.restart()

        with self.client("killed", cell_size=0.05) as robot:
            self.stream(robot, kill_now_and_then)
        self.assertEqual(robot.acknowledged, self.SCANS)
        self.assertGreaterEqual(robot.status().reconnects, 2)
        self.assertEqual(self.server.get_json("killed")["robots"][0]["last_seq"], self.SCANS)
        self.assertEqual(self.server.get_json("killed")["scans"], self.SCANS)
        killed, undisturbed = (self.server.get_json(session + "/digest") for session in ("killed", "undisturbed"))
        self.assertEqual(killed, undisturbed)


if __name__ == "__main__":
    unittest.main()
