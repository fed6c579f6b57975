"""The client on links that are slow, broken or inconsistent."""
import socket
import threading
import unittest

from fake_server import FakeServer, well
from fixture import LinkTest
from programs import scanloom_client


def is_batch(frame):
    return frame.WhichOneof("body") == "scan_batch"


def hangs_up_after(batches):
    """Serves this many batches, receives one more, and closes without a message."""

    def script(link):
        link.greet()
        seen = iter(range(batches))
        last = link.serve(until=lambda frame: is_batch(frame) and next(seen, None) is None)
        if last:
            link.take(last.scan_batch)  # stored, but never acknowledged

    return script


class Resuming(LinkTest):
    def test_all_scans_arrive_before_the_goodbye(self):
        self.start()
        with self.client() as robot:
            self.send(robot, self.laser(robot), 20)
        self.assert_stored(20)
        self.assertEqual(robot.acknowledged, 20)
        self.assertEqual(robot.sent, 20)
        self.assertEqual(self.server.goodbyes, 1)

    def test_links_that_end_silently_lose_and_duplicate_no_scan(self):
        self.start(hangs_up_after(0), hangs_up_after(1), lambda link: None, hangs_up_after(2), well)
        with self.client() as robot:
            laser = self.laser(robot)
            for i in range(40):
                self.send(robot, laser, 1, first=i)
                if i % 8 == 0:
                    robot.flush()
        self.assert_stored(40)
        self.assertEqual(robot.status().reconnects, 3)

    def test_a_retryable_error_is_retried(self):
        def overloaded(link):
            link.receive()
            link.send(error={"code": 15, "message": "later", "retryable": True})

        self.start(overloaded, well)
        with self.client() as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)

    def test_the_server_that_has_the_session_is_connected_at_once(self):
        owner = self.start(well)

        def elsewhere(link):
            link.receive()
            link.send(error={"code": 23, "message": "not here", "retryable": True, "address": owner.address})

        other = FakeServer(elsewhere)
        self.addCleanup(other.stop)
        with self.client(server=other.address, timing={"backoff_first": 3600.0}) as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)
        self.assertEqual(other.stored, [])

    def test_the_next_server_is_tried_when_one_cannot_be_reached(self):
        self.start(well)
        both = (f"{self.server.address},127.0.0.1:{port}" for port in range(1, 1000))
        servers = next(two for two in both if str(scanloom_client._Servers(two, "s")) != self.server.address)
        with self.client(server=servers) as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)

    def test_the_order_of_the_servers_depends_on_the_session(self):
        servers = scanloom_client._Servers("a:1,b:2,c:3", "a")
        for expected, is_last in (("a:1", False), ("c:3", False), ("b:2", True), ("a:1", False)):  # as in server_list_test.cpp
            self.assertEqual(str(servers), expected)
            self.assertEqual(servers.choose_another(""), not is_last)
        self.assertEqual(str(scanloom_client._Servers("c:3,b:2,a:1", "s1")), "b:2")

    def test_an_acknowledgement_of_an_unsent_scan_ends_the_link_only(self):
        def boasts(link):
            link.greet()
            link.serve(until=is_batch)
            link.send(ack={"durable_seq": 99, "credit_bytes": 20000})
            link.serve()

        self.start(boasts, well)
        with self.client() as robot:
            self.send(robot, self.laser(robot), 3)
        self.assert_stored(3)

    def test_a_recreated_session_is_reported(self):
        def another(link):
            link.greet(session_id="b", last_durable_seq=0)
            link.serve()

        self.start(hangs_up_after(1), another)
        robot = self.client()
        laser = self.laser(robot)
        self.send(robot, laser, 1)
        robot.flush()
        self.send(robot, laser, 1)
        error = self.assert_fails("SESSION_DELETED", robot.flush)
        self.assertIn("session s was deleted and recreated", error.message)
        self.assert_fails("SESSION_DELETED", self.send, robot, laser, 1)

    def test_lost_scans_of_a_server_are_reported(self):
        def forgot(link):
            link.greet(last_durable_seq=0)
            link.serve()

        self.start(hangs_up_after(1), forgot)
        robot = self.client()
        laser = self.laser(robot)
        self.send(robot, laser, 1)
        robot.flush()
        self.send(robot, laser, 1)
        self.assertIn("had acknowledged 1", self.assert_fails("LOST_SCANS", robot.flush).message)

    def test_scans_of_another_program_are_reported(self):
        def more(link):
            link.greet(last_durable_seq=7)
            link.serve()

        self.start(hangs_up_after(0), more)
        robot = self.client()
        self.send(robot, self.laser(robot), 1)
        self.assertIn("another program", self.assert_fails("SESSION_CONFLICT", robot.close).message)

    def test_numbers_continue_after_the_stored_scans(self):
        self.start(well)
        with self.client() as robot:
            self.send(robot, self.laser(robot), 5)
        with self.client() as robot:
            self.assertEqual(robot.stored_before(), 5)
            self.send(robot, self.laser(robot), 5, first=5)
        self.assert_stored(10)
        self.assertEqual((robot.sent, robot.acknowledged, robot.status().acknowledged), (5, 10, 10))


class Refusing(LinkTest):
    def test_the_servers_error_is_raised_unchanged(self):
        def refuses(link):
            link.greet()
            link.serve(until=is_batch)
            link.send(error={"code": 4, "message": "pose.x is \x1b[31mbad\u202e", "retryable": False})

        self.start(refuses)
        robot = self.client()
        laser = self.laser(robot)
        self.send(robot, laser, 1)
        error = self.assert_fails("INVALID_FIELD", robot.flush)
        self.assertEqual((error.message, error.retryable), ("pose.x is \\x1b[31mbad\\u202e", False))
        self.assert_fails("INVALID_FIELD", self.send, robot, laser, 1)
        self.assert_fails("INVALID_FIELD", robot.close)

    def test_leaving_the_block_raises_if_not_every_scan_is_durable(self):
        def refuses(link):
            link.receive()
            link.send(error={"code": 14})

        self.start(refuses)
        with self.assertRaises(scanloom_client.ScanloomError) as caught:
            with self.client() as robot:
                laser = self.laser(robot)
        self.assertEqual(caught.exception.code, "UNAUTHORIZED")
        self.assertIn("UNAUTHORIZED without a message", caught.exception.message)
        self.assert_fails("UNAUTHORIZED", self.send, robot, laser, 1)

    def test_another_protocol_is_not_retried(self):
        def web(link):
            link.receive()
            link.send_bytes(b"HTTP/1.1 400 Bad Request\r\n\r\n")

        self.start(web)
        error = self.assert_fails("MALFORMED_FRAME", self.client().close)
        self.assertIn("does not use Scanloom's robot protocol", error.message)
        self.assertEqual(self.server.links, 1)

    def test_invalid_data_after_the_welcome_ends_the_link_only(self):
        def garbles(link):
            link.greet()
            link.serve(until=is_batch)
            link.send_bytes(b"\0\0\0\2\xff\xff")
            link.serve()

        self.start(garbles, well)
        with self.client() as robot:
            self.send(robot, self.laser(robot), 2)
        self.assert_stored(2)


class Reading(LinkTest):
    def test_any_split_of_the_bytes_yields_the_same_frames(self):
        frames = [b"one", b"x" * 300, b"3"]
        data = b"".join(len(frame).to_bytes(4, "big") + frame for frame in frames)
        for step in (1, 2, 3, 5, 300, len(data)):
            (server, robot), (ringer, bell) = socket.socketpair(), socket.socketpair()
            bell.setblocking(False)
            with server, bell, ringer:
                connection = scanloom_client._Connection(robot, bell)
                read = []
                for i in range(0, len(data), step):
                    server.sendall(data[i : i + step])
                    read += connection.turn(0.0)
                connection.close()
            self.assertEqual(read, frames)

    def test_frames_may_arrive_byte_by_byte(self):
        self.start(split=True)
        with self.client() as robot:
            laser = self.laser(robot)
            for i in range(5):
                self.send(robot, laser, 1, first=i)
                robot.flush()
        self.assert_stored(5)
        self.assertEqual(self.server.links, 1)

    def test_pings_are_answered(self):
        answers = []
        all_answered = threading.Event()

        def pings(link):
            link.greet()
            for nonce in (7, 2**64 - 1):
                link.send(ping={"nonce": nonce})
                answers.append(link.receive()[0].pong.nonce)
            all_answered.set()
            link.serve()

        self.start(pings)
        with self.client():
            all_answered.wait()
        self.assertEqual(answers, [7, 2**64 - 1])


class Sending(LinkTest):
    def test_bytes_in_flight_stay_within_the_credit(self):
        credit = 700  # two scans

        def counts(link):
            link.greet(credit_bytes=credit)
            in_flight, pinged = 0, False
            while True:
                frame, size = link.receive()
                kind = frame.WhichOneof("body")
                if kind == "goodbye":
                    return
                if kind == "sensor_description":
                    link.described.add(0)
                if kind == "scan_batch":
                    link.take(frame.scan_batch)
                    in_flight += size
                    if in_flight > credit:
                        link.server.faults.append(f"{in_flight} bytes in flight")
                    if not pinged:  # frames before the pong were sent without waiting for an ack
                        link.send(ping={"nonce": 1})
                    pinged = True
                if kind == "pong":
                    in_flight, pinged = 0, False
                    link.ack(credit)

        self.start(counts)
        with self.client() as robot:
            self.send(robot, self.laser(robot), 30)
        self.assert_stored(30)

    def test_waiting_scans_share_a_batch(self):
        all_sent = threading.Event()

        def waits(link):
            all_sent.wait()
            well(link)

        self.start(waits)
        with self.client() as robot:
            self.send(robot, self.laser(robot), 40)
            all_sent.set()
        self.assert_stored(40)
        self.assertEqual(self.server.batches, [40])

    def test_batches_respect_the_servers_limits(self):
        all_sent = threading.Event()

        def limits(link):
            all_sent.wait()
            link.greet(limits=scanloom_client._messages["Limits"](scans_per_batch_max=7, frame_size_max=2000))
            link.serve()

        self.start(limits)
        with self.client() as robot:
            self.send(robot, self.laser(robot), 40)
            all_sent.set()
        self.assert_stored(40)
        self.assertEqual(max(self.server.batches), 7)

    def test_a_scan_beyond_the_servers_limits_is_reported(self):
        self.start(lambda link: (link.greet(limits=scanloom_client._messages["Limits"](beams_max=49)), link.serve()))
        robot = self.client()
        self.send(robot, self.laser(robot), 1)
        self.assertIn("50 beams", self.assert_fails("FRAME_TOO_LARGE", robot.flush).message)

    def test_a_full_buffer_refuses_or_waits(self):
        acknowledge = threading.Event()

        def hesitates(link):
            link.greet(credit_bytes=0)
            acknowledge.wait()
            link.ack()
            link.serve()

        self.start(hesitates)
        robot = self.client(buffer_bytes=1000)
        laser = self.laser(robot)
        with self.assertRaises(scanloom_client.BufferFull):
            for i in range(100):
                robot.send(laser, [1.0] * 50, pose=(0.1 * i, 0.0, 0.0), stamp=float(i), block=False)
        held = robot.status().scans
        self.assertLessEqual(held, 5)
        with self.assertRaises(scanloom_client.BufferFull):
            robot.send(laser, [1.0] * 50, pose=(0.0, 0.0, 0.0), stamp=0.0, timeout=0.001)
        waiting = threading.Thread(target=self.send, args=(robot, laser, 20, held))
        waiting.start()
        acknowledge.set()
        waiting.join()
        robot.close()
        self.assert_stored(held + 20)

    def test_many_threads_may_send(self):
        self.start()
        with self.client() as robot:
            laser = self.laser(robot)
            threads = [threading.Thread(target=self.send, args=(robot, laser, 50, 50 * n)) for n in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        self.assertEqual(sorted(scan.stamp for scan in self.server.stored), [float(i) for i in range(200)])
        for n in range(4):  # in the order of each thread
            own = [scan.stamp for scan in self.server.stored if 50 * n <= scan.stamp < 50 * (n + 1)]
            self.assertEqual(own, sorted(own))

    def test_sensors_are_described_again_on_every_link(self):
        self.start(hangs_up_after(1), well)
        with self.client() as robot:
            for sensor in (self.laser(robot), robot.sonar(range_max=5.0, aperture=0.4, angles=[0.0] * 50)):
                self.send(robot, sensor, 1)
                robot.flush()
        self.assertEqual([scan.sensor for scan in self.server.stored], [0, 1])
        self.assertEqual(self.server.faults, [])


if __name__ == "__main__":
    unittest.main()
