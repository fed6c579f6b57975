"""A client with a fake server."""
import logging
import threading
import unittest

from fake_server import FakeServer
from programs import scanloom_client

logging.getLogger("scanloom").addHandler(logging.NullHandler())  # these tests are about lost links

QUICK = dict(backoff_first=0.001, backoff_max=0.01)


class LinkTest(unittest.TestCase):
    def start(self, *scripts, **options):
        self.server = FakeServer(*scripts, **options)
        self.addCleanup(self.server.stop)
        return self.server

    def client(self, timing=None, server=None, **options):
        """A robot that close() does not wait for when the test fails."""
        client = scanloom_client.Client(server or self.server.address, session="s", robot="r",
                                        timing=scanloom_client.Timing(**{**QUICK, **(timing or {})}), **options)
        self.addCleanup(self._abort, client)
        return client

    def assert_logs_retry(self, reason, **options):
        """Starts a client that cannot connect, waits until it logs this reason for a retry, and ends it."""
        logged, messages = threading.Event(), []

        class Reader(logging.Handler):
            def emit(self, record):
                messages.append(record.getMessage())
                if reason in messages[-1]:
                    logged.set()

        reader = Reader()
        logging.getLogger("scanloom").addHandler(reader)
        self.addCleanup(logging.getLogger("scanloom").removeHandler, reader)
        client = self.client(**options)
        self.assertTrue(logged.wait(60.0), messages)
        self._abort(client)
        self.assert_fails("CLOSED", client.close)  # waits for its thread: the next client uses the same server

    @staticmethod
    def _abort(client):
        try:
            client.close(timeout=0.0)
        except scanloom_client.ScanloomError:
            pass  # the test has already checked any expected error

    def laser(self, client, **options):
        return client.laser(**{"angle_min": 0.0, "angle_increment": 0.01, "count": 50, "range_max": 10.0, **options})

    def send(self, client, laser, count, first=0):
        """Scans that can be distinguished by their stamp."""
        for i in range(first, first + count):
            client.send(laser, [1.0 + 0.001 * i] * 50, pose=(0.1 * i, 0.0, 0.0), stamp=float(i))

    def assert_stored(self, count):
        self.assertEqual([scan.stamp for scan in self.server.stored], [float(i) for i in range(count)])
        self.assertEqual([scan.seq for scan in self.server.stored], list(range(1, count + 1)))
        self.assertEqual(self.server.faults, [])

    def assert_fails(self, code, call, *arguments, **options):
        """Returns the error."""
        with self.assertRaises(scanloom_client.ScanloomError) as caught:
            call(*arguments, **options)
        self.assertEqual(caught.exception.code, code, caught.exception.message)
        return caught.exception
