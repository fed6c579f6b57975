"""Requests on the link: each reply reaches its caller."""
import math
import threading
import unittest

from fixture import LinkTest
from programs import scanloom_client


def collect(link, count):
    """Receives this many requests, in order."""
    requests = []
    link.serve(until=lambda frame: frame.WhichOneof("body").endswith("_request") and
               (requests.append(frame) or len(requests) == count))
    return requests


def path_to(goal):
    return {"points": [0.0, 0.0, goal.x, goal.y], "length": goal.x, "cost": goal.x}


def reply_plan(link, request):
    link.send(plan_reply={"id": request.id, "revision": 5, "path": path_to(request.goal)})


class Requests(LinkTest):
    def ask_in_threads(self, robot, goals):
        """The paths by goal."""
        paths = {}
        threads = [threading.Thread(target=lambda x=x: paths.update({x: robot.plan((x, 1.0))})) for x in goals]
        for thread in threads:
            thread.start()
        return paths, threads

    def test_replies_in_another_order_reach_their_callers(self):
        def backwards(link):
            link.greet()
            for frame in reversed(collect(link, 3)):
                reply_plan(link, frame.plan_request)
            link.serve()

        self.start(backwards)
        with self.client() as robot:
            paths, threads = self.ask_in_threads(robot, [1.0, 2.0, 3.0])
            for thread in threads:
                thread.join()
        self.assertEqual({x: path.points[-1] for x, path in paths.items()}, {x: (x, 1.0) for x in (1.0, 2.0, 3.0)})
        self.assertEqual(paths[1.0].revision, 5)

    def test_at_most_four_are_in_flight(self):
        four_came, fifth_was_tried = threading.Event(), threading.Event()

        def counts(link):
            link.greet()
            first = collect(link, 4)
            four_came.set()
            fifth_was_tried.wait()
            link.send(ping={"nonce": 1})
            fifth = []
            link.serve(until=lambda frame: frame.WhichOneof("body") == "pong" or fifth.append(frame))
            link.server.faults += fifth
            for frame in first:
                reply_plan(link, frame.plan_request)
            reply_plan(link, collect(link, 1)[0].plan_request)
            link.serve()

        self.start(counts)
        with self.client() as robot:
            paths, threads = self.ask_in_threads(robot, [1.0, 2.0, 3.0, 4.0])
            four_came.wait()
            self.assert_fails("TIMEOUT", robot.plan, (5.0, 1.0), timeout=0.02)
            fifth_was_tried.set()
            self.assertEqual(robot.plan((5.0, 1.0)).points[-1], (5.0, 1.0))
            for thread in threads:
                thread.join()
        self.assertEqual(sorted(paths), [1.0, 2.0, 3.0, 4.0])
        self.assertEqual(self.server.faults, [])

    def test_requests_of_a_broken_link_are_sent_again(self):
        def answers(link):
            link.greet()
            reply_plan(link, collect(link, 1)[0].plan_request)
            link.serve()

        self.start(lambda link: (link.greet(), collect(link, 1)), answers)
        with self.client() as robot:
            self.assertEqual(robot.plan((2.0, 1.0)).points, [(0.0, 0.0), (2.0, 1.0)])

    def test_a_refusal_is_raised_and_the_link_continues(self):
        def refuses(link):
            link.greet()
            id = collect(link, 1)[0].plan_request.id
            link.send(plan_reply={"id": id, "refusal": {"code": 18, "message": "a wall is in the way"}})
            link.serve()

        self.start(refuses)
        with self.client() as robot:
            error = self.assert_fails("NO_PATH", robot.plan, (2.0, 1.0))
            self.assertEqual((error.message, error.retryable), ("a wall is in the way", False))
            self.send(robot, self.laser(robot), 2)
        self.assert_stored(2)
        self.assertEqual(self.server.links, 1)

    def test_a_late_reply_is_ignored(self):
        asked, asked_again = threading.Event(), threading.Event()

        def is_late(link):
            link.greet()
            late = collect(link, 1)[0].plan_request
            asked.set()
            asked_again.wait()
            reply_plan(link, late)
            while requests := collect(link, 1):
                reply_plan(link, requests[0].plan_request)

        self.start(is_late)
        with self.client() as robot:
            paths = []
            # The last request is sent after the others were cancelled, and answered after the first one's late reply.
            while not asked.is_set():  # a busy machine may cancel a request before it is sent
                self.assert_fails("TIMEOUT", robot.plan, (2.0, 1.0), timeout=0.05)
            asking = threading.Thread(target=lambda: paths.append(robot.plan((3.0, 1.0))))
            asking.start()
            asked_again.set()
            asking.join()
        self.assertEqual(paths[0].points[-1], (3.0, 1.0))
        self.assertEqual(self.server.links, 1)

    def test_a_reply_of_another_kind_ends_the_link_only(self):
        def mistakes(link):
            link.greet()
            id = collect(link, 1)[0].plan_request.id
            link.send(goal_reply={"id": id, "goal": {"exploration": 3}})
            link.serve()

        def answers(link):
            link.greet()
            reply_plan(link, collect(link, 1)[0].plan_request)
            link.serve()

        self.start(mistakes, answers)
        with self.client() as robot:
            self.assertEqual(robot.plan((2.0, 1.0)).points[-1], (2.0, 1.0))

    def test_requests_wait_until_earlier_scans_are_applied(self):
        order = []

        def notes(link):
            link.greet()
            frame = link.serve(until=lambda frame: order.append(frame.WhichOneof("body")) or
                               order[-1] == "plan_request")
            reply_plan(link, frame.plan_request)
            link.serve()

        self.start(notes)
        with self.client() as robot:
            self.assertEqual(robot.stored_before(), 0)
            self.send(robot, self.laser(robot), 2)
            self.assertEqual(robot.plan((2.0, 1.0)).points[-1], (2.0, 1.0))
        self.assertEqual(order[-1], "plan_request")
        self.assertIn("scan_batch", order)
        self.assert_stored(2)

    def test_regions_are_polygons_or_boxes(self):
        box = [0.0, 0.0, 2.0, 0.0, 2.0, 1.0, 0.0, 1.0]
        self.assertEqual(scanloom_client._region([0, 0, 2, 1]), box)
        self.assertEqual(scanloom_client._region([(0, 0), (2, 0), (2, 1), (0, 1)]), box)
        for wrong in ([0, 0, 2], [2, 0, 0, 1], [(0, 0), (1, 1)], [(0, 0), (1, 1), (1,)], 5, [], "abcd",
                      [(0, 0), (1, 1), 2], [0, 0, "x", 1], [(math.nan, 0), (1, 0), (1, 1)], [(0, 0)] * 4097):
            with self.subTest(wrong=str(wrong)[:40]), self.assertRaisesRegex(ValueError, "region"):
                scanloom_client._region(wrong)

    def test_invalid_arguments_are_refused_by_name(self):
        self.start()
        with self.client() as robot:
            for expected, call, arguments in [("goal is None", robot.plan, {"goal": None}),
                                          ("frontier_size_min is 1.5", robot.next_goal, {"frontier_size_min": 1.5}),
                                          ("frontier_size_min is -1", robot.next_goal, {"frontier_size_min": -1}),
                                          ("start is 3", robot.coverage, {"start": 3})]:
                with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                    call(**arguments)

    def test_options_of_requests_are_sent_unchanged(self):
        asked = []

        def notes(link):
            link.greet()
            for _ in range(3):
                frame = collect(link, 1)[0]
                asked.append(frame)
                kind = frame.WhichOneof("body")
                id = getattr(frame, kind).id
                refusal = {"id": id, "refusal": {"code": 15, "message": "no time"}}
                link.send(**{kind.replace("request", "reply"): refusal})
            link.serve()

        self.start(notes)
        with self.client() as robot:
            options = {"start": (0.0, 0.0), "allow_unknown": True, "danger_cost": 2.0}
            self.assert_fails("OVERLOADED", robot.plan, (0.0, 0.0), **options)
            self.assert_fails("OVERLOADED", robot.next_goal, body_radius=0.2, frontier_size_min=3)
            self.assert_fails("OVERLOADED", robot.coverage, spacing=0.3, region=[(0, 0), (1, 0), (1, 1)])
        plan, goal, coverage = asked[0].plan_request, asked[1].goal_request, asked[2].coverage_request
        self.assertTrue(plan.HasField("start") and plan.HasField("goal") and plan.allow_unknown)
        self.assertFalse(plan.HasField("body_radius"))
        self.assertEqual((plan.danger_cost, goal.body_radius, goal.frontier_size_min), (2.0, 0.2, 3))
        self.assertFalse(goal.HasField("start"))
        self.assertEqual((coverage.spacing, list(coverage.region)), (0.3, [0, 0, 1, 0, 1, 1]))


if __name__ == "__main__":
    unittest.main()
