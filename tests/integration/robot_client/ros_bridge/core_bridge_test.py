"""What scanloom_bridge sends, publishes and reports, and when."""
import math
import tempfile
import unittest

from fixture import BridgeTest, core, scan, transform

Location = core.scanloom_client.Location
ScanloomError = core.scanloom_client.ScanloomError


def location(x=0.0, state="TRACKING", **more):
    return Location((x, 0.0, 0.0), 0.9, 0.01, 0.001, 1, state, **more)


class Waiting(BridgeTest):
    def test_a_scan_has_the_odometry_at_its_middle(self):
        self.start_with_odometry()
        self.bridge.on_scan(scan(100.06, time_increment=0.02))
        self.bridge.tick()
        sent = self.client.sent[1]
        self.assertAlmostEqual(sent["odometry"][0], 0.08)
        self.assertAlmostEqual(sent["stamp"], 100.08)
        self.assertAlmostEqual(sent["duration"], 0.04)
        self.assertFalse(sent["block"])

    def test_poses_in_the_map_are_sent_as_such(self):
        self.start()
        self.give(transform("map", "base", translation=(1.0, 2.0, 0.0)), transform("base", "laser"), is_static=True)
        self.bridge.on_scan(scan(100.0))
        self.bridge.tick()
        self.assertEqual(self.client.options["poses"], "map")
        self.assertEqual(self.client.sent[0]["pose"], (1.0, 2.0, 0.0))

    def test_a_scan_waits_for_its_transform(self):
        self.start_with_odometry()
        self.pass_time(5.0)
        self.bridge.on_scan(scan(100.15))
        self.pass_time(0.9)
        self.assertEqual(len(self.client.sent), 1)
        self.give_odometry(100.2)
        self.bridge.tick()
        self.assertAlmostEqual(self.client.sent[1]["odometry"][0], 0.15)
        self.assert_skipped("", 0)

    def test_a_scan_without_a_transform_is_skipped_after_the_wait(self):
        self.start_with_odometry()
        self.bridge.on_scan(scan(100.15))
        self.pass_time(1.1)
        self.assert_skipped("a scan of /scan is skipped: the transforms odom -> base end before the scan")

    def test_later_scans_are_sent_after_those_that_wait(self):
        self.start_with_odometry()
        self.bridge.on_scan(scan(100.15))
        self.bridge.on_scan(scan(100.06, topic="/rear"))
        self.bridge.tick()
        self.assertEqual(len(self.client.sent), 1)
        self.give_odometry(100.2)
        self.bridge.tick()
        self.assertEqual([round(one["stamp"], 2) for one in self.client.sent], [100.05, 100.15, 100.06])

    def test_minutes_without_transforms_are_counted_and_rarely_logged(self):
        self.start(poses="odometry")
        for n in range(1200):
            self.bridge.on_scan(scan(100.0 + 0.1 * n))
            self.pass_time(0.1)
        self.pass_time(5.0)
        self.assert_skipped("no transforms lead from an odometry frame to laser", 1200)
        self.assertLessEqual(len(self.logged("warn")), 5)
        self.assertEqual(self.clients, [])
        self.give_mount()
        self.give_odometry(220.0, 220.1)
        self.bridge.on_scan(scan(220.05))
        self.bridge.tick()
        self.assertEqual(len(self.client.sent), 1)

    def test_the_number_of_waiting_scans_is_bounded(self):
        self.start(poses="odometry")
        for n in range(600):
            self.bridge.on_scan(scan(100.0 + 0.001 * n))
        self.assert_skipped("more than 512 scans wait for transforms", 88)

    def test_a_laser_without_a_known_mount_is_skipped(self):
        self.start_with_odometry()
        self.bridge.on_scan(scan(100.06, topic="/rear", frame="rear"))
        self.bridge.on_scan(scan(100.07))
        self.pass_time(1.1)
        self.assert_skipped("a scan of /rear is skipped: no transforms lead from base to rear")
        self.assertEqual(len(self.client.sent), 2)


class Connecting(BridgeTest):
    def test_the_client_has_what_the_parameters_say_and_never_gives_up(self):
        self.start_with_odometry(server="maps.lab:7447", buffer_mb=3, cell_size=0.1)
        self.assertEqual(self.client.server, "maps.lab:7447")
        options = self.client.options
        self.assertEqual((options["session"], options["robot"], options["poses"], options["cell_size"]),
                         ("s", "r", "odometry", 0.1))
        self.assertEqual((options["buffer_bytes"], options["timing"].give_up_after), (3 << 20, math.inf))

    def test_the_token_is_that_of_the_file(self):
        with tempfile.NamedTemporaryFile("w") as file:
            file.write("secret\n")
            file.flush()
            self.start_with_odometry(token_file=file.name)
        self.assertEqual(self.client.options["token"], "secret")


class Poses(BridgeTest):
    def test_poses_of_the_map_are_chosen_at_once_others_after_a_wait(self):
        for chain, poses, wait in [(("map", "odom"), "map", 0.0), (("odom",), "odometry", 1.0), ((), "none", 5.0)]:
            with self.subTest(poses):
                self.start()
                frames = [*chain, "base", "laser"]
                self.give(*(transform(*pair) for pair in zip(frames, frames[1:])), is_static=True)
                self.bridge.on_scan(scan(100.0))
                if wait:
                    self.pass_time(wait - 0.1)
                    self.assertEqual(self.clients, [])
                self.pass_time(0.1)
                self.assertEqual(self.client.options["poses"], poses)
                self.assertEqual(len(self.client.sent), 1)
                self.assertIn("chosen from the transforms", self.logged("info")[-2])

    def test_odometry_that_comes_too_late_is_reported(self):
        self.start()
        self.bridge.on_scan(scan(100.0, frame="base"))
        self.pass_time(5.0)
        self.assertEqual(self.client.options["poses"], "none")
        self.give_odometry(105.0)
        self.pass_time(1.0)
        self.assertIn("came after the node had begun without poses: restart it", self.logged("warn")[0])


class Clocks(BridgeTest):
    def test_a_clock_that_is_set_back_begins_again(self):
        self.start_with_odometry()
        self.bridge.on_scan(scan(100.15))
        self.give_odometry(90.0, 90.1)
        self.bridge.on_scan(scan(90.05))
        self.bridge.tick()
        self.assert_skipped("the clock was set back while it waited")
        self.assertEqual(len(self.client.sent), 1)  # transforms of both times could be mixed
        self.give_odometry(90.0, 90.1, speed=2.0)
        self.bridge.tick()
        self.assertAlmostEqual(self.client.sent[1]["odometry"][0], -19.9)

    def test_the_clock_of_a_simulation_that_begins_again_is_recognised(self):
        self.start_with_odometry()
        self.output.time = 3.0
        self.bridge.tick()
        self.assertIn("the clock was set back by 97.0 s", self.logged("warn")[0])

    def test_scans_that_are_not_newer_are_skipped(self):
        self.start_with_odometry()
        for at in (100.05, 100.0):
            self.bridge.on_scan(scan(at))
        self.assert_skipped("its stamp is not newer than that of the scan before", 2)

    def test_a_scan_without_a_stamp_has_the_time_of_its_arrival(self):
        self.start(poses="none", base_frame="laser")
        self.bridge.on_scan(scan(0.0))
        self.bridge.tick()
        self.assertEqual(self.client.sent[0]["stamp"], 100.0)
        self.output.time = 0.0
        self.bridge.on_scan(scan(0.0))
        self.assert_skipped("it has no stamp, and no clock is published")


class Invalid(BridgeTest):
    def test_unusable_scans_and_transforms_are_counted(self):
        self.start_with_odometry()
        self.bridge.on_scan(scan(100.06, ranges=()))
        self.bridge.on_scan(scan(100.06, angle_min=math.nan))
        self.bridge.on_transforms([None], False)
        self.assert_skipped("it has no beams")
        self.assert_skipped("its angles are not finite")
        self.assert_skipped("a transform is ignored")

    def test_a_loop_of_transforms_is_named(self):
        self.start_with_odometry()
        self.give(transform("laser", "base"), is_static=True)
        self.bridge.on_scan(scan(100.06))
        self.pass_time(1.1)
        self.assertEqual(len(self.client.sent), 1)
        self.assert_skipped("are a loop")

    def test_reasons_are_bounded(self):
        self.start()
        for n in range(300):
            self.bridge.on_scan(scan(1.0, topic=f"/{n}", ranges=()))
        self.assertEqual(len(self.bridge.reports.counts()), 101)
        self.assert_skipped("other reasons", 200)


class TransformOfOdometry(BridgeTest):
    def publish(self, **parameters):
        self.start_with_odometry(publish_tf=True, **parameters)
        self.client.location = location(2.0)

    def test_it_is_off_by_default(self):
        self.start_with_odometry()
        self.client.location = location(2.0)
        self.pass_time(0.1)
        self.assertEqual(self.output.transforms, [])

    def test_it_is_stamped_now_and_the_tolerance(self):
        self.publish()
        self.pass_time(1.0)
        self.assertEqual(self.output.transforms, [("map", "odom", 101.1, (2.0, 0.0, 0.0))])

    def test_no_stamp_is_published_twice(self):
        self.publish()
        self.pass_time(1.0)
        self.bridge.tick()
        self.output.time -= 0.5
        self.bridge.tick()
        self.assertEqual(len(self.output.transforms), 1)
        self.output.time -= 50.0  # a simulation begins again
        self.bridge.tick()
        self.assertAlmostEqual(self.output.transforms[1][2], 50.6)

    def test_nothing_is_published_before_a_correction_and_without_a_clock(self):
        self.publish()
        self.client.location = None
        self.pass_time(1.0)
        self.client.location = location()
        self.output.time = 0.0
        self.bridge.tick()
        self.assertEqual(self.output.transforms, [])

    def test_without_odometry_the_robots_frame_is_in_the_map(self):
        self.start(poses="none", publish_tf=True)
        self.bridge.on_scan(scan(100.0))
        self.bridge.tick()
        self.client.location = location(2.0)
        self.pass_time(0.1)
        self.assertEqual(self.output.transforms[0][:2], ("map", "laser"))

    def test_a_frame_that_has_a_parent_is_not_given_another(self):
        self.publish()
        self.give(transform("map", "odom", 100.0))
        self.pass_time(0.1)
        self.assertEqual(self.output.transforms, [])
        self.assertIn("map -> odom is not published, because odom already has the parent map", self.logged("warn")[0])

    def test_another_node_that_publishes_it_is_reported(self):
        self.publish()
        self.pass_time(0.1)
        parent, child, stamp, _ = self.output.transforms[0]
        self.give(transform(parent, child, stamp))
        self.assertEqual(self.logged("warn"), [])
        self.give(transform(parent, child, stamp + 0.001))
        self.assertIn("another node publishes map -> odom, too", self.logged("warn")[0])


class Reporting(BridgeTest):
    def test_a_reason_is_logged_at_once_and_then_with_its_count(self):
        self.start_with_odometry()
        for _ in range(10):
            self.bridge.on_scan(scan(100.05))
            self.pass_time(1.0)
        self.assertEqual(len(self.logged("warn")), 1)
        self.pass_time(25.0)
        self.assertTrue(self.logged("warn")[1].endswith("(9 times)"), self.logged("warn"))

    def test_states_are_logged_in_words_when_they_change(self):
        self.start_with_odometry()
        for state in ("UNLOCATED", "TRACKING", "TRACKING", "LOST"):
            self.client.options["on_correction"](location(state=state))
            self.bridge.tick()
        unlocated, lost = self.logged("warn")
        self.assertIn("the robot's place in the map, which other robots began, is not known yet", unlocated)
        self.assertIn("the server has lost the robot", lost)
        self.assertEqual(self.logged("info").count("the server tracks the robot in the map"), 1)

    def test_a_wrong_mount_is_reported(self):
        self.start_with_odometry()
        self.client.options["on_correction"](location(mount_yaw_error=math.pi))
        self.bridge.tick()
        self.assertIn("the laser's mount is too large by 180 degrees", self.logged("warn")[0])

    def test_diagnostics_come_once_a_second(self):
        self.start_with_odometry()
        count = len(self.output.diagnostics)
        for _ in range(21):
            self.pass_time(0.1)
        self.assertEqual(len(self.output.diagnostics), count + 2)
        level, text, values = self.output.diagnostics[-1]
        self.assertEqual((level, text, values["scans sent"]), (core.OK, "scans are sent", "1"))

    def test_diagnostics_warn(self):
        self.start_with_odometry()
        for prepare, text in [(lambda: setattr(self.client, "is_linked", False), "not connected"),
                              (lambda: setattr(self.client, "is_linked", True) or
                               self.client.options["on_correction"](location(state="LOST")), "has lost the robot")]:
            prepare()
            self.pass_time(1.0)
            self.assertEqual(self.output.diagnostics[-1][0], core.WARN)
            self.assertIn(text, self.output.diagnostics[-1][1])


class Ending(BridgeTest):
    def fail(self, error):
        self.client.error = error
        self.bridge.on_scan(scan(100.06))
        self.bridge.tick()

    def test_a_final_error_ends_the_node(self):
        self.start_with_odometry()
        self.fail(ScanloomError("UNAUTHORIZED", "the token is not valid"))
        self.assertEqual(self.bridge.failure, "the token is not valid")
        self.assertEqual(self.logged("error"), ["the token is not valid"])
        self.assertEqual(self.bridge.close(), 1)

    def test_a_full_buffer_skips_scans(self):
        self.start_with_odometry()
        self.fail(core.scanloom_client.BufferFull("BUFFER_FULL", "full", True))
        self.assertEqual(self.bridge.failure, "")
        self.assert_skipped("the buffer is full, because the server is away")

    def test_it_waits_for_stored_scans_and_reports_lost_ones(self):
        self.start_with_odometry(close_wait=3.0)
        self.assertEqual(self.bridge.close(), 0)
        self.assertEqual(self.client.closed, 3.0)
        self.start_with_odometry()
        self.client.error = ScanloomError("TIMEOUT", "1 scans are not acknowledged: no connection", True)
        self.assertEqual(self.bridge.close(), 1)
        self.assertEqual(self.logged("error"),
                         ["ends with scans that are lost: 1 scans are not acknowledged: no connection"])

    def test_its_last_lines_are_the_counts_since_the_last_report(self):
        self.start_with_odometry()
        for _ in range(5):
            self.bridge.on_scan(scan(100.05))
        self.bridge.close()
        self.assertTrue(self.logged("warn")[-1].endswith("(4 times)"))

    def test_without_scans_it_ends_well(self):
        self.start()
        self.assertEqual(self.bridge.close(), 0)

    def test_parameters_that_the_client_refuses_end_the_node(self):
        self.start(poses="none", server="127.0.0.1:99999")
        self.bridge._connect = core.scanloom_client.Client
        self.bridge.on_scan(scan(100.0))
        self.bridge.tick()
        self.assertIn("the server's address is '127.0.0.1:99999'", self.bridge.failure)
        self.assertEqual(self.bridge.close(), 1)


class Parameters(unittest.TestCase):
    def test_they_are_read_as_ros_passes_them(self):
        options = core.Options.of({"session": 7, "robot": "r", "tf_wait": 2, "scan_topics": "/front, rear",
                                   "use_sim_time": True})
        self.assertEqual((options.session, options.tf_wait, options.scan_topics), ("7", 2.0, ("/front", "rear")))
        self.assertEqual(core.Options.of({"session": "s", "scan_topics": ["a", "b"]}).scan_topics, ("a", "b"))

    def test_text_of_launch_files_is_read_and_empty_text_is_the_default(self):
        options = core.Options.of({"session": "s", "publish_tf": "True", "tls": "false", "tf_rate": "20",
                                   "buffer_mb": "8", "map_period": "", "scan_topics": "", "poses": "", "publish_map": ""})
        self.assertEqual((options.publish_tf, options.tls, options.tf_rate, options.buffer_mb), (True, False, 20.0, 8))
        self.assertEqual((options.map_period, options.scan_topics, options.poses, options.publish_map),
                         (2.0, ("scan",), "auto", False))

    def test_defaults_depend_on_the_host(self):
        options = core.Options.of({"session": "s", "server": "maps.lab:7447"})
        self.assertRegex(options.robot, "^[A-Za-z0-9_-]{1,64}$")
        self.assertEqual(options.http, "http://maps.lab:8080")
        self.assertEqual(core.Options.of({"session": "s", "server": "[::1]:7", "tls": True}).http, "https://[::1]:8080")

    def test_invalid_ones_are_named(self):
        for reason, wrong in [("session is missing", {"session": ""}), ("session is 'my lab'", {"session": "my lab"}),
                              ("server is 'lab'; HOST:PORT", {"server": "lab"}), ("poses is 'gps'", {"poses": "gps"}),
                              ("http is 'lab:8080'", {"http": "lab:8080"}),
                              ("http is 'http://lab/map'", {"http": "http://lab/map"}),
                              ("tf_rate is 0; 1 to 100", {"tf_rate": 0}), ("tf_wait is nan", {"tf_wait": math.nan}),
                              ("publish_tf is 'yes'; true or false", {"publish_tf": "yes"}),
                              ("buffer_mb is 1.5; a whole number", {"buffer_mb": 1.5}),
                              ("robot is True; text", {"robot": True}),
                              ("scan_topics is ','; names of topics", {"scan_topics": ","}),
                              ("buffer_mb is '1.5'; a whole number", {"buffer_mb": "1.5"}),
                              ("tf_wait is nan; a finite number", {"tf_wait": "nan"}),
                              ("scan_topics is 5", {"scan_topics": 5}), ("zero is 'far'", {"zero": "far"}),
                              ("publish_tf needs poses odometry or none", {"publish_tf": True, "poses": "map"})]:
            with self.subTest(reason), self.assertRaisesRegex(ValueError, reason):
                core.Options.of({"session": "s", **wrong})

    def test_unknown_ones_are_listed(self):
        self.assertEqual(core.Options.unknown({"session": "s", "sever": "x", "rat": 1}), ["rat", "sever"])


if __name__ == "__main__":
    unittest.main()
