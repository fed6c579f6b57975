"""What the client does when nothing comes."""
import socket
import threading
import unittest

from fake_server import well
from fixture import LinkTest
from programs import scanloom_client


def is_silent(link):
    """Takes all and says nothing any more."""
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

    def test_up_to_half_of_a_wait_is_left_out(self):
        self.assertEqual(self.waits(0.0, 5)[0], [0.1, 0.2, 0.4, 0.5, 0.5])

    def test_after_progress_waits_are_short_again(self):
        _, backoff = self.waits(1.0, 5)
        backoff.reset()
        self.assertEqual(backoff.next(), 0.2)


class Silence(LinkTest):
    def test_a_silent_server_is_pinged(self):
        pinged = threading.Event()

        def notes_pings(link):
            link.greet()
            link.serve(until=lambda frame: frame.WhichOneof("body") == "ping")
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

    def test_a_hello_that_stays_unanswered_is_said_again(self):
        self.start(lambda link: link.serve(), well)
        with self.client(timing={"welcome": 0.02}) as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)

    def test_a_server_that_does_not_close_after_the_goodbye_is_left(self):
        let_go = threading.Event()

        def stays(link):
            well(link)
            let_go.wait()

        self.start(stays)
        self.addCleanup(let_go.set)
        with self.client(timing={"goodbye": 0.001}) as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)


class GivingUp(LinkTest):
    def test_a_server_that_is_not_there_is_given_up_on(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            address = "127.0.0.1:%d" % free.getsockname()[1]
        timing = scanloom_client.Timing(give_up_after=0.02, backoff_first=0.001)
        robot = scanloom_client.Client(address, session="s", robot="r", timing=timing)
        error = self.assert_fails("TIMEOUT", robot.close)
        self.assertIn(f"cannot connect to {address}", error.message)
        self.assertIn("gave up after 0.02 s", error.message)

    def test_a_server_that_acknowledges_nothing_is_given_up_on(self):
        self.start(is_silent)
        robot = self.client(timing={"give_up_after": 0.02})
        self.send(robot, self.laser(robot), 1)
        self.assertIn("acknowledges nothing", self.assert_fails("TIMEOUT", robot.flush).message)

    def test_a_robot_with_nothing_to_say_may_be_quiet_for_longer(self):
        long_quiet = threading.Event()

        def counts_pings(link):
            link.greet()
            for _ in range(10):  # one after every 5 ms of silence
                link.serve(until=lambda frame: frame.WhichOneof("body") == "ping")
                link.send(pong={})
            long_quiet.set()
            link.serve()

        self.start(counts_pings)
        with self.client(timing={"give_up_after": 0.02, "ping_after": 0.005}) as robot:
            long_quiet.wait()
            self.send(robot, self.laser(robot), 1)
        self.assert_stored(1)

    def test_flush_and_close_wait_no_longer_than_they_are_told(self):
        self.start(is_silent)
        robot = self.client()
        laser = self.laser(robot)
        self.send(robot, laser, 2)
        self.assertIn("2 scans are not acknowledged", self.assert_fails("TIMEOUT", robot.flush, timeout=0.01).message)
        self.assertIn("2 scans are not acknowledged", self.assert_fails("TIMEOUT", robot.close, timeout=0.01).message)
        self.assert_fails("CLOSED", robot.flush)
        self.assert_fails("CLOSED", self.send, robot, laser, 1)

    def test_what_failed_in_the_block_is_told_and_its_scans_are_stored_all_the_same(self):
        self.start()
        with self.assertRaises(ZeroDivisionError):
            with self.client() as robot:
                self.send(robot, self.laser(robot), 3)
                raise ZeroDivisionError
        self.assert_stored(3)

    def test_a_closed_client_takes_no_more(self):
        self.start()
        with self.client() as robot:
            laser = self.laser(robot)
        self.assert_fails("CLOSED", self.send, robot, laser, 1)
        self.assert_fails("CLOSED", robot.plan, (0.0, 0.0))
        robot.close()


if __name__ == "__main__":
    unittest.main()
