"""The client as a program, copied to a folder without other files of this project."""
import json
import math
import pathlib
import shutil
import sys
import tempfile
import unittest

from fake_server import FakeServer
from programs import CLIENT, RunningServer, run, scanloom_client

ANGLES = ("--angle-min", "0", "--angle-increment", "0.1")


def line_of(i, **more):
    return json.dumps({"t": 0.1 * i, "pose": [0.01 * i, 0.0, 0.0], "ranges": [2.0, 2.5, None, math.inf], **more})


class Program(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)
        shutil.copy(CLIENT, self.directory / "client.py")

    def stream(self, address, lines, *options):
        return run(sys.executable, "client.py", "--server", address, "--session", "s", "--robot", "r",
                   "--range-max", "10", *(options or ANGLES), cwd=self.directory,
                   input="".join(line + "\n" for line in lines))

    def fake(self, *scripts):
        server = FakeServer(*scripts)
        self.addCleanup(server.stop)
        return server

    def test_piped_scans_give_the_same_maps_as_sent_ones(self):
        server = RunningServer(self.directory)
        self.addCleanup(server.stop)
        code, out, errors = self.stream(server.address, [line_of(i) for i in range(50)], *ANGLES, "--cell-size", "0.05")
        self.assertEqual((code, errors), (0, ""))
        summary = json.loads(out)
        for key, value in {"scans": 50, "acknowledged": 50, "sent": 50, "stored_before": 0, "robot": "r"}.items():
            self.assertEqual(summary[key], value, key)
        with scanloom_client.Client(server.address, session="sent", robot="r", cell_size=0.05) as robot:
            laser = robot.laser(angle_min=0.0, angle_increment=0.1, count=4, range_max=10.0)
            for i in range(50):
                robot.send(laser, [2.0, 2.5, math.nan, math.inf], pose=(0.01 * i, 0.0, 0.0), stamp=0.1 * i)
        self.assertEqual(server.get_json("s/digest"), server.get_json("sent/digest"))

    def test_lines_with_a_source_are_not_sent_twice(self):
        server = self.fake()
        lines = [line_of(i) for i in range(8)]
        self.stream(server.address, lines[:5], "--source", "lines")
        code, out, _ = self.stream(server.address, lines, "--source", "lines")
        self.assertEqual(code, 0)
        self.assertEqual(json.loads(out)["stored_before"], 5)
        self.assertEqual([scan.stamp for scan in server.stored], [0.1 * i for i in range(8)])

    def test_without_angles_the_beams_of_the_first_line_are_a_full_turn(self):
        server = self.fake()
        line = line_of(0, angles=None, intensities=[1, 2, 3, 4], odometry=[1, 2, 3], duration=0.1)
        self.stream(server.address, [line], "--range-min", "0.1")
        self.assertEqual(list(server.stored[0].intensities), [1, 2, 3, 4])
        self.assertEqual((server.stored[0].odometry.y, server.stored[0].duration), (2.0, 0.1))
        uniform = server.sensors[0].angles.uniform
        self.assertEqual((uniform.first, uniform.increment, uniform.count), (-math.pi, math.pi / 2, 4))

    def test_an_invalid_line_is_reported_and_skipped(self):
        for expected, wrong in [("Expecting value", "hello"), ('"t", "pose" and "ranges" is needed', '{"t": 1}'),
                            ("pose has 2 numbers", '{"t": 1, "pose": [1, 2], "ranges": [1]}'),
                            ("ranges is not a list", '{"t": 1, "pose": [1, 2, 3], "ranges": 4}'),
                            ("t is None", '{"t": null, "pose": [1, 2, 3], "ranges": [1]}')]:
            with self.subTest(expected):
                server = self.fake()
                code, out, errors = self.stream(server.address, [line_of(0), "", line_of(1), wrong, line_of(3)])
                self.assertEqual(code, 1)
                self.assertIn("line 4 of the input is skipped: ", errors)
                self.assertIn(expected, errors)
                self.assertIn("1 lines of the input were skipped", errors)
                summary = json.loads(out)
                self.assertEqual((summary["acknowledged"], summary["skipped"]), (3, 1))
                self.assertEqual([scan.stamp for scan in server.stored], [0.0, 0.1, 0.1 * 3])

    def test_lines_without_poses_are_sent_if_the_robot_knows_none(self):
        line = {"t": 1.0, "ranges": [2.0, 2.5]}
        odometry = {**line, "odometry": [1, 2, 3]}
        for poses, good, wrong, needed in [("odometry", odometry, line, '"t", "odometry" and "ranges" is needed'),
                                           ("none", line, odometry, "leave odometry out")]:
            with self.subTest(poses):
                server = self.fake()
                code, _, errors = self.stream(server.address, [json.dumps(good), json.dumps(wrong)], *ANGLES, "--poses",
                                              poses)
                self.assertEqual(code, 1)
                self.assertIn("line 2 of the input is skipped", errors)
                self.assertIn(needed, errors)
                self.assertEqual([scan.HasField("pose") for scan in server.stored], [False])
                self.assertEqual(server.stored[0].HasField("odometry"), poses == "odometry")

    def test_invalid_lines_do_not_count_when_lines_are_streamed_again(self):
        server = self.fake()
        lines = [line_of(0), "hello", line_of(1), line_of(2)]
        self.stream(server.address, lines[:3], "--source", "lines")
        self.stream(server.address, lines, "--source", "lines")
        self.assertEqual([scan.stamp for scan in server.stored], [0.1 * i for i in range(3)])

    def test_many_invalid_lines_are_counted(self):
        server = self.fake()
        code, out, errors = self.stream(server.address, ["hello"] * 50 + [line_of(0)])
        self.assertEqual((code, json.loads(out)["skipped"], len(server.stored)), (1, 50, 1))
        self.assertEqual(errors.count("\n"), 12)

    def test_a_refusal_is_reported_in_one_line(self):
        def refuses(link):
            link.receive()
            link.send(error={"code": 14, "message": "no token was given"})

        server = self.fake(refuses)
        code, out, errors = self.stream(server.address, [line_of(0)])
        self.assertEqual((code, errors), (1, "scanloom_client.py: no token was given\n"))
        self.assertEqual(json.loads(out)["error"], "no token was given")

    def test_invalid_options_are_reported_in_one_line(self):
        for expected, options in [("--volume", ["--volume", "3"]), ("invalid float value: 'x'", ["--range-max", "x"]),
                              ("session is 'a b'", ["--session", "a b"]), ("No such file", ["--token-file", "absent"])]:
            with self.subTest(expected):
                code, out, errors = self.stream("127.0.0.1:1", [], *options)
                self.assertEqual((code, out), (2, ""))
                self.assertIn(expected, errors)
                self.assertEqual(errors.count("\n"), 1)

    def test_a_token_is_read_from_its_file(self):
        server = self.fake()
        (self.directory / "token").write_text("secret\n")
        self.stream(server.address, [line_of(0)], "--token-file", "token")
        self.assertEqual(server.hellos[0].token, "secret")


if __name__ == "__main__":
    unittest.main()
