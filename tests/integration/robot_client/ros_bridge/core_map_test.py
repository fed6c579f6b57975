"""The map that scanloom_bridge publishes, from a server that the test plays."""
import gzip
import http.server
import threading
import unittest

from fixture import core

YAML = b"image: map.pgm\nresolution: 0.05\norigin: [-1.5, 2.25, 0]\nnegate: 0\n"
PGM = b"P5\n# CREATOR: scanloom 0.050 m/pix\n3 2\n255\n" + bytes([254, 0, 205, 254, 254, 100])


class Server(http.server.BaseHTTPRequestHandler):
    """Answers as the script of its server says: a function of the request that returns (status, fields, body)."""

    def do_GET(self):
        status, fields, body = self.server.script(self)
        self.send_response(status)
        for name, value in fields.items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


class Maps(unittest.TestCase):
    def start(self, script, **parameters):
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Server)
        server.script = script
        self.requests = []
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        address = f"http://127.0.0.1:{server.server_port}"
        self.maps = core.MapRequests(core.Options.of({"session": "s", "http": address, **parameters}), "secret", None)

    def revision(self, request, revision=1, pgm=PGM):
        """A server that knows entity tags."""
        self.requests.append(request.path)
        tag = f'"map-{revision}"'
        if request.headers.get("If-None-Match") == tag:
            return 304, {"ETag": tag}, b""
        if request.path.endswith(".yaml"):
            return 200, {"ETag": tag}, YAML
        return 200, {"ETag": "W/" + tag, "Content-Encoding": "gzip"}, gzip.compress(pgm)

    def test_rows_begin_below_and_cells_are_free_occupied_or_unknown(self):
        self.start(self.revision)
        grid = self.maps.newest()
        self.assertEqual((grid.width, grid.height, grid.resolution, grid.origin), (3, 2, 0.05, (-1.5, 2.25, 0.0)))
        self.assertEqual(list(grid.cells), [0, 0, -1, 0, 100, -1])

    def test_a_map_is_returned_once(self):
        self.start(self.revision)
        self.assertIsNotNone(self.maps.newest())
        self.assertIsNone(self.maps.newest())
        self.assertEqual([path.rpartition(".")[2] for path in self.requests], ["yaml", "pgm", "yaml"])

    def test_files_of_different_moments_are_requested_again(self):
        revisions = iter([1, 2, 3, 3])
        self.start(lambda request: self.revision(request, next(revisions)))
        self.assertIsNotNone(self.maps.newest())
        self.assertEqual(len(self.requests), 4)

    def test_a_map_that_never_holds_still_is_left_for_later(self):
        self.start(lambda request: self.revision(request, len(self.requests)))
        self.assertIsNone(self.maps.newest())
        self.assertEqual(len(self.requests), 2 * core.MapRequests.ATTEMPTS)

    def test_the_token_is_sent(self):
        seen = []
        self.start(lambda request: seen.append(request.headers["Authorization"]) or (404, {}, b""))
        self.assertIsNone(self.maps.newest())
        self.assertEqual(seen, ["Bearer secret"])

    def test_errors_say_what_to_do(self):
        for status, reason in [(401, "token of a viewer in map_token_file"),
                               (403, "token of a viewer in map_token_file"),
                               (500, "with 500; is it the server's HTTP address"), (302, "with 302")]:
            with self.subTest(status):
                self.start(lambda request, status=status: (status, {"Location": "http://127.0.0.1:1/"}, b""))
                with self.assertRaisesRegex(ValueError, reason):
                    self.maps.newest()

    def test_damaged_maps_are_refused(self):
        for pgm, reason in [(PGM[:-1], "has 5 pixels instead of 3 x 2"), (PGM + b"x", "has 7 pixels"),
                            (b"P6\n3 2\n255\n", "is not as expected"), (b"", "is not as expected")]:
            with self.subTest(reason):
                self.start(lambda request, pgm=pgm: self.revision(request, pgm=pgm))
                with self.assertRaisesRegex(ValueError, reason):
                    self.maps.newest()

    def test_maps_that_are_cut_or_too_large_are_refused(self):
        whole = gzip.compress(PGM)
        for body in (whole[:-9], b"none", gzip.compress(bytes(core.MapRequests.BYTES_MAX + 1))):
            with self.subTest(len(body)):
                self.start(lambda request, body=body: (200, {"ETag": '"1"', "Content-Encoding": "gzip"}, body))
                with self.assertRaisesRegex(ValueError, "damaged or has more than 64 million cells"):
                    self.maps.newest()

    def test_a_server_that_is_away_is_named(self):
        maps = core.MapRequests(core.Options.of({"session": "s", "http": "http://127.0.0.1:1"}), "", None)
        with self.assertRaisesRegex(ValueError, "no map from http://127.0.0.1:1: Connection refused"):
            maps.newest()


if __name__ == "__main__":
    unittest.main()
