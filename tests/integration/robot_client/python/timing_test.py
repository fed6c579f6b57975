"""The client's timeouts."""
import math
import socket
import threading
import unittest

from fake_server import well
from fixture import LinkTest
from programs import scanloom_client


def is_silent(link):
    """Accepts everything and sends nothing more."""
    link.greet()
    while link.receive()[0]:
        pass


class Backoff(unittest.TestCase):
    def waits(self, random_part, count):
        timing = scanloom_client.Timing(backoff_first=0.2, backoff_max=1.0)
        backoff = scanloom_client._Backoff(timing, lambda: random_part)
        return [round(backoff.next(), 6) for _ in range(count)], backoff

    def test_waits_double_up_to_the_longest(self):
        self.assertEqual(self.waits(1.0, 5)[0], [0.2, 0.4, 0.8, 1.0, 1.0])

    def test_waits_are_shortened_randomly_by_up_to_half(self):
        self.assertEqual(self.waits(0.0, 5)[0], [0.1, 0.2, 0.4, 0.5, 0.5])

    def test_after_progress_waits_are_short_again(self):
        _, backoff = self.waits(1.0, 5)
        backoff.reset()
        self.assertEqual(backoff.next(), 0.2)


class Timeouts(unittest.TestCase):
    """With times that the test chooses."""

    def setUp(self):
        hello = scanloom_client._hello("s", "r", "", "", None, None)
        timing = scanloom_client.Timing(give_up_after=10.0)
        self.conversation = scanloom_client._Conversation(hello, 1000, timing, now=0.0)
        self.sensor = scanloom_client._describe(0, "SONAR", "", (0, 0, 0), (None, None, None), [0.0], 0.1, 0.0, 5.0)

    def welcome(self, now):
        self.conversation.open(now)
        self.conversation.next_frame(now)
        self.receive(now, "welcome", session_id="a", credit_bytes=1000)

    def receive(self, now, kind, **fields):
        frame = scanloom_client._Frame()
        getattr(frame, kind).SetInParent()
        for name, value in fields.items():
            setattr(getattr(frame, kind), name, value)
        self.conversation.receive(frame, now)

    def test_it_is_limited_until_the_first_welcome(self):
        self.assertEqual(self.conversation.progress_deadline(), 10.0)

    def test_it_is_endless_while_nothing_waits(self):
        self.welcome(5.0)
        self.assertEqual(self.conversation.progress_deadline(), math.inf)

    def test_it_starts_with_the_first_waiting_scan(self):
        self.welcome(5.0)
        self.conversation.add(self.sensor, b"scan", 1000.0)
        self.conversation.add(self.sensor, b"scan", 1004.0)
        self.assertEqual(self.conversation.progress_deadline(), 1010.0)

    def test_it_restarts_with_each_acknowledgement(self):
        self.welcome(5.0)
        for _ in range(2):
            self.conversation.add(self.sensor, scanloom_client._Scan().SerializeToString(), 1000.0)
        while self.conversation.next_frame(1000.0):
            pass
        self.receive(1007.0, "ack", durable_seq=1, credit_bytes=1000)
        self.assertEqual(self.conversation.progress_deadline(), 1017.0)
        self.receive(1008.0, "ack", durable_seq=1, credit_bytes=1000)
        self.assertEqual(self.conversation.progress_deadline(), 1017.0)
        self.receive(1009.0, "ack", durable_seq=2, credit_bytes=1000)
        self.assertEqual(self.conversation.progress_deadline(), math.inf)

    def test_it_ends_after_repeated_replacements(self):
        for time, may_pass in [(5.0, True), (70.0, True), (71.0, True), (72.0, False)]:
            self.welcome(time)
            with self.assertRaises(scanloom_client.ScanloomError) as raised:
                self.receive(time, "error", code=10, message="connected again")
            self.assertEqual((raised.exception.code, raised.exception.retryable), ("REPLACED", may_pass))
            self.conversation.close()


class Silence(LinkTest):
    def test_a_silent_server_is_pinged(self):
        pinged = threading.Event()

        def notes_pings(link):
            link.greet()
            if link.serve(until=lambda frame: frame.WhichOneof("body") == "ping"):
                pinged.set()
            link.serve()

        self.start(notes_pings)
        with self.client(timing={"ping_after": 0.001}):
            pinged.wait()

    def test_a_link_that_stays_silent_is_replaced(self):
        self.start(is_silent, well)
        with self.client(timing={"silence_max": 0.02}) as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)

    def test_an_unanswered_hello_is_sent_again(self):
        self.start(lambda link: link.serve(), well)
        with self.client(timing={"welcome": 0.02}) as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)

    def test_a_server_that_does_not_close_after_the_goodbye_is_disconnected(self):
        let_go = threading.Event()

        def stays(link):
            well(link)
            let_go.wait()

        self.start(stays)
        self.addCleanup(let_go.set)
        with self.client(timing={"goodbye": 0.001, "silence_max": math.inf}) as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)


class GivingUp(LinkTest):
    def test_an_unreachable_server_causes_a_timeout(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            address = "127.0.0.1:%d" % free.getsockname()[1]
        timing = scanloom_client.Timing(give_up_after=0.02, backoff_first=0.001)
        robot = scanloom_client.Client(address, session="s", robot="r", timing=timing)
        error = self.assert_fails("TIMEOUT", robot.close)
        self.assertIn(f"cannot connect to {address}", error.message)
        self.assertIn("gave up after 0.02 s", error.message)

    def test_a_server_without_acknowledgements_causes_a_timeout(self):
        self.start(is_silent)
        robot = self.client(timing={"give_up_after": 0.02, "silence_max": math.inf})

        def send_and_flush():  # either call may raise it
            self.send(robot, self.laser(robot), 1)
            robot.flush()

        self.assertIn("gave up after 0.02 s", self.assert_fails("TIMEOUT", send_and_flush).message)

    def test_flush_and_close_respect_their_timeout(self):
        self.start(is_silent)
        robot = self.client()
        laser = self.laser(robot)
        self.send(robot, laser, 2)
        self.assertIn("2 scans are not acknowledged", self.assert_fails("TIMEOUT", robot.flush, timeout=0.01).message)
        self.assertIn("2 scans are not acknowledged", self.assert_fails("TIMEOUT", robot.close, timeout=0.01).message)
        self.assert_fails("CLOSED", robot.flush)
        self.assert_fails("CLOSED", self.send, robot, laser, 1)

    def test_an_exception_in_the_block_is_raised_after_its_scans_are_stored(self):
        self.start()
        with self.assertRaises(ZeroDivisionError):
            with self.client() as robot:
                self.send(robot, self.laser(robot), 3)
                raise ZeroDivisionError
        self.assert_stored(3)

    def test_a_closed_client_accepts_no_scans(self):
        self.start()
        with self.client() as robot:
            laser = self.laser(robot)
        self.assert_fails("CLOSED", self.send, robot, laser, 1)
        self.assert_fails("CLOSED", robot.plan, (0.0, 0.0))
        robot.close()


class Failing(LinkTest):
    def test_an_error_raised_in_the_block_is_not_logged_again(self):
        def refuses(link):
            link.receive()
            link.send(error={"code": 14, "message": "no token was given"})

        self.start(refuses)
        with self.assertNoLogs("scanloom"), self.assertRaises(scanloom_client.ScanloomError) as caught:
            with self.client() as robot:
                self.send(robot, self.laser(robot), 1)
                robot.flush()
        self.assertEqual(caught.exception.message, "no token was given")


if __name__ == "__main__":
    unittest.main()
