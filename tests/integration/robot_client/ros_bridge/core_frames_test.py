"""Transforms, frames, mounts and readings of scanloom_bridge."""
import math
import types
import unittest

from fixture import ROLLED, SECOND, BridgeTest, core, scan, transform, yaw_of


def tree_of(*transforms, static=()):
    tree = core.FrameTree()
    for one in transforms:
        tree.add(one, is_static=False)
    for one in static:
        tree.add(one, is_static=True)
    return tree


class Trees(unittest.TestCase):
    def assert_pose(self, found, expected):
        for part, other in zip(found.planar(), expected):
            self.assertAlmostEqual(part, other, places=9)

    def assert_missing(self, tree, at, reason, may_come, target="odom", source="base"):
        with self.assertRaisesRegex(core.NoTransform, reason) as caught:
            tree.find(target, source, round(at * SECOND))
        self.assertEqual(caught.exception.may_come, may_come)

    def test_poses_are_interpolated_on_the_shorter_arc(self):
        tree = tree_of(transform("odom", "base", 1.0, (0.0, 0.0, 0.0), yaw_of(3.0)),
                       transform("odom", "base", 2.0, (4.0, 2.0, 0.0), yaw_of(-3.0)))
        turn = 2.0 * math.pi - 6.0
        self.assert_pose(tree.find("odom", "base", round(1.25 * SECOND)), (1.0, 0.5, 3.0 + turn / 4.0))
        self.assert_pose(tree.find("odom", "base", 1 * SECOND), (0.0, 0.0, 3.0))

    def test_nothing_is_extrapolated(self):
        tree = tree_of(transform("odom", "base", 1.0), transform("odom", "base", 2.0))
        self.assert_missing(tree, 2.001, "odom -> base end before the scan", may_come=True)
        self.assert_missing(tree, 0.999, "odom -> base begin after the scan", may_come=False)

    def test_holes_are_not_interpolated_unless_the_robot_stands(self):
        tree = tree_of(transform("odom", "base", 1.0), transform("odom", "base", 4.0, (1.0, 0.0, 0.0)),
                       transform("odom", "base", 8.0, (1.0, 0.0, 0.0)))
        self.assert_missing(tree, 2.0, "hole of more than 2 s", may_come=False)
        self.assert_pose(tree.find("odom", "base", 6 * SECOND), (1.0, 0.0, 0.0))

    def test_frames_are_joined_through_their_common_ancestor(self):
        tree = tree_of(static=[transform("base", "left", translation=(0.0, 1.0, 0.0), rotation=yaw_of(math.pi / 2)),
                               transform("base", "front", translation=(2.0, 1.0, 0.0))])
        self.assert_pose(tree.find("left", "front", 0), (0.0, -2.0, -math.pi / 2))

    def test_unknown_frames_may_come(self):
        self.assert_missing(tree_of(), 1.0, "no transforms lead from odom to base", may_come=True)

    def test_loops_end(self):
        tree = tree_of(static=[transform("a", "b"), transform("b", "c"), transform("c", "a")])
        self.assert_missing(tree, 1.0, "loop", may_come=True, source="a")
        self.assertEqual(tree.ancestors("a"), ["a", "c", "b"])

    def test_late_transforms_are_sorted_and_of_equal_stamps_the_first_counts(self):
        tree = tree_of(transform("odom", "base", 2.0, (2.0, 0.0, 0.0)), transform("odom", "base", 1.0, (1.0, 0.0, 0.0)),
                       transform("odom", "base", 1.0, (9.0, 0.0, 0.0)))
        self.assert_pose(tree.find("odom", "base", round(1.5 * SECOND)), (1.5, 0.0, 0.0))

    def test_old_transforms_are_forgotten(self):
        tree = tree_of(*(transform("odom", "base", float(at)) for at in range(100)))
        self.assert_missing(tree, 88.5, "begin after", may_come=False)
        tree.find("odom", "base", 89 * SECOND)

    def test_messages_without_a_usable_transform_are_recognised(self):
        def message(child="/base", x=1.0, w=2.0):
            at, turn = types.SimpleNamespace(x=x, y=0.0, z=0.0), types.SimpleNamespace(x=0.0, y=0.0, z=0.0, w=w)
            return types.SimpleNamespace(header=types.SimpleNamespace(frame_id="/odom"), child_frame_id=child,
                                         transform=types.SimpleNamespace(translation=at, rotation=turn))

        self.assertEqual(core.transform_of(message(), 5), core.Transform(
            "odom", "base", 5, core.Rigid((1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))))
        for wrong in ({"x": math.nan}, {"w": 0.0}, {"w": math.inf}, {"child": ""}, {"child": "odom"}):
            self.assertIsNone(core.transform_of(message(**wrong), 5))


class Choice(unittest.TestCase):
    def choose(self, chain, **options):
        """chain is the laser's frame and those above it."""
        tree = tree_of(static=[transform(parent, child) for child, parent in zip(chain, chain[1:])])
        return core.available_frames(tree, chain[0], core.Options(session="s", **options))

    def test_the_best_poses_are_chosen(self):
        self.assertEqual(self.choose(["laser", "base", "odom", "map"]), core.Frames("map", "base", "map"))
        self.assertEqual(self.choose(["laser", "link", "r1/base", "r1/odom"]),
                         core.Frames("odometry", "r1/base", "r1/odom"))
        self.assertEqual(self.choose(["laser", "link", "base"]), core.Frames("none", "base", ""))
        self.assertEqual(self.choose(["laser"]), core.Frames("none", "laser", ""))

    def test_a_node_that_publishes_map_to_odom_takes_no_poses_of_the_map(self):
        self.assertEqual(self.choose(["laser", "base", "odom", "map"], publish_tf=True),
                         core.Frames("odometry", "base", "odom"))
        self.assertEqual(self.choose(["laser", "base", "map"], publish_tf=True), core.Frames("none", "base", ""))

    def test_stated_poses_and_frames_are_taken(self):
        chain = ["laser", "link", "base", "odom", "map"]
        self.assertEqual(self.choose(chain, poses="odometry"), core.Frames("odometry", "base", "odom"))
        self.assertEqual(self.choose(chain, poses="none"), core.Frames("none", "base", ""))
        self.assertEqual(self.choose(chain, base_frame="link").base, "link")
        self.assertEqual(self.choose(["laser", "base", "start"], odom_frame="start"),
                         core.Frames("odometry", "base", "start"))
        self.assertEqual(self.choose(["laser", "base", "site"], map_frame="site"), core.Frames("map", "base", "site"))

    def test_what_is_missing_is_named(self):
        self.assertEqual(self.choose(["laser", "base"], poses="odometry"),
                         "no transforms lead from an odometry frame to base; frames from the laser up are: laser, base")
        self.assertIn("lead from map to base", self.choose(["laser", "base", "odom"], poses="map"))
        self.assertIn("lead from wheels to base", self.choose(["laser", "base", "odom"], poses="odometry",
                                                              odom_frame="wheels"))
        self.assertIn("lead from chassis to laser", self.choose(["laser", "base"], base_frame="chassis"))


class Scans(unittest.TestCase):
    def test_unusable_scans_are_named(self):
        for reason, wrong in [("no beams", {"ranges": ()}), ("more than 4096 beams", {"ranges": (1.0,) * 4097}),
                              ("angles are not finite", {"angle_min": math.nan}),
                              ("angles are not finite", {"angle_increment": math.inf}),
                              ("angle_increment is 0", {"angle_increment": 0.0}),
                              ("more than a full turn", {"angle_increment": 3.2})]:
            with self.subTest(reason):
                self.assertIn(reason, scan(1.0, **wrong).problem())
        turtlebot = scan(1.0, ranges=(1.0,) * 360, angle_min=0.0, angle_increment=0.017501922324299812)
        for usable in (scan(1.0), turtlebot, scan(1.0, ranges=(1.0,), angle_increment=0.0)):
            self.assertEqual(usable.problem(), "")

    def test_the_middle_is_half_of_the_turn_later(self):
        self.assertEqual(scan(1.0, time_increment=0.01).middle(), round(1.01 * SECOND))
        self.assertEqual(scan(1.0, time_increment=-0.01).middle(), round(0.99 * SECOND))
        for unknown in (math.nan, math.inf, 6.0):
            self.assertEqual(scan(1.0, time_increment=unknown).middle(), SECOND)

    def readings(self, *scans, **options):
        habits = core.RangeHabits(core.Options(session="s", **options))
        return [["inf" if r == math.inf else "broken" if math.isnan(r) else r
                 for r in habits.readings(scan(1.0, ranges=ranges))] for ranges in scans]

    def test_readings_follow_rep_117(self):
        self.assertEqual(self.readings((1.0, math.inf, math.nan, 0.0, 12.0)),
                         [[1.0, "inf", "broken", "broken", "broken"]])

    def test_one_number_above_the_range_is_no_return_if_nothing_is_infinite(self):
        self.assertEqual(self.readings((1.0, 81.91, 81.91)), [[1.0, "inf", "inf"]])
        self.assertEqual(self.readings((1.0, 81.91, 20.0)), [[1.0, "broken", "broken"]])
        self.assertEqual(self.readings((81.91,), (math.inf,), (81.91,)), [["inf"], ["inf"], ["broken"]])

    def test_options_state_other_habits(self):
        self.assertEqual(self.readings((0.0,), zero="no-return"), [["inf"]])
        self.assertEqual(self.readings((20.0, 30.0), beyond_max="no-return"), [["inf", "inf"]])
        self.assertEqual(self.readings((20.0, 20.0), beyond_max="broken"), [["broken", "broken"]])

    def test_a_tilted_laser_has_no_mount(self):
        def rolled(degrees):
            half = math.radians(degrees) / 2.0
            return core.Rigid(rotation=(math.sin(half), 0.0, 0.0, math.cos(half)))

        self.assertFalse(core.mount_of(rolled(14.0)).is_upside_down)
        self.assertTrue(core.mount_of(rolled(170.0)).is_upside_down)
        with self.assertRaisesRegex(core.NoTransform, "tilted by more than 15 degrees"):
            core.mount_of(rolled(16.0))


class Sensors(BridgeTest):
    def send(self, *scans, rotation=(0.0, 0.0, 0.0, 1.0)):
        self.start(poses="none", base_frame="base")
        self.give(transform("base", "laser", translation=(0.2, -0.1, 0.3), rotation=rotation), is_static=True)
        for one in scans:
            self.bridge.on_scan(one)
            self.bridge.tick()

    def test_the_mount_and_the_range_are_described_once(self):
        self.send(scan(1.0), scan(1.1))
        (laser,) = self.client.sensors
        self.assertEqual((laser["mount"], laser["range_min"], laser["range_max"], laser["name"]),
                         ((0.2, -0.1, 0.0), 0.1, 10.0, "/scan"))
        self.assertEqual([one["angles"] for one in self.client.sent], [None, None])

    def test_the_angles_of_a_laser_upside_down_are_negated(self):
        self.send(scan(1.0, angle_min=0.3), rotation=ROLLED)
        self.assertEqual((self.client.sensors[0]["angle_min"], self.client.sensors[0]["angle_increment"]), (-0.3, -0.1))

    def test_other_angles_are_sent_with_their_scan(self):
        self.send(scan(1.0), scan(1.1, angle_min=0.5))
        self.assertEqual(len(self.client.sensors), 1)
        self.assertEqual(self.client.sent[1]["angles"], [0.5, 0.6, 0.7])

    def test_a_changed_mount_is_another_sensor_until_it_is_as_before(self):
        self.send(scan(1.0))
        upright = (0.0, 0.0, 0.0, 1.0)
        for at, x, rotation in ((1.1, 0.5, upright), (1.2, 0.2, upright), (1.3, 0.2, ROLLED)):
            self.give(transform("base", "laser", translation=(x, -0.1, 0.3), rotation=rotation), is_static=True)
            self.bridge.on_scan(scan(at))
            self.bridge.tick()
        self.assertEqual([one["sensor"] for one in self.client.sent], [0, 1, 0, 2])

    def test_a_range_beyond_50_metres_is_not_believed(self):
        self.send(scan(1.0, range_max=1000.0), scan(1.1, range_max=math.nan, range_min=math.nan))
        self.assertEqual([(one["range_min"], one["range_max"]) for one in self.client.sensors],
                         [(0.1, 50.0), (0.0, 50.0)])


if __name__ == "__main__":
    unittest.main()
