"""A minimal server for tests of the client: each link runs a script, the last one all further links."""
import socket
import threading

from programs import scanloom_client

Frame = scanloom_client._Frame


class Link:
    """One connection, seen from the server."""

    def __init__(self, sock, server, split=False):
        self.sock = sock
        self.server = server
        self.split = split  # one TCP segment for each byte
        self.described = set()
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def receive(self):
        """The next frame and its bytes on the wire; None at the end."""
        head = self._read(4)
        body = self._read(int.from_bytes(head, "big")) if head else None
        return (Frame.FromString(body), 4 + len(body)) if body else (None, 0)

    def _read(self, size):
        data = b""
        while len(data) < size:
            try:
                got = self.sock.recv(size - len(data))
            except OSError:
                return None
            if not got:
                return None
            data += got
        return data

    def send(self, **body):
        """send(pong={"nonce": 1})"""
        ((kind, fields),) = body.items()
        encoded = Frame(**{kind: scanloom_client._messages[_message_name(kind)](**fields)}).SerializeToString()
        self.send_bytes(len(encoded).to_bytes(4, "big") + encoded)

    def send_bytes(self, data):
        for part in [data[i : i + 1] for i in range(len(data))] if self.split else [data]:
            self.sock.sendall(part)

    def greet(self, **welcome):
        """Receives the hello and welcomes the robot, with the real state unless another is given."""
        frame, _ = self.receive()
        self.server.hellos.append(frame.hello)
        truth = {"session_id": "a", "last_durable_seq": len(self.server.stored), "credit_bytes": 20000}
        self.send(welcome={**truth, **welcome})
        return frame.hello

    def take(self, batch):
        """Stores the new scans of a batch."""
        for scan in batch.scans:
            if scan.sensor not in self.described:
                self.server.faults.append(f"scan {scan.seq} is of a sensor that was not described")
            if scan.seq > len(self.server.stored) + 1:
                self.server.faults.append(f"scan {scan.seq} follows {len(self.server.stored)}")
            if scan.seq == len(self.server.stored) + 1:
                self.server.stored.append(scan)

    def ack(self, credit_bytes=20000):
        durable = len(self.server.stored)
        self.send(ack={"durable_seq": durable, "applied_seq": durable, "credit_bytes": credit_bytes})

    def serve(self, until=lambda frame: False):
        """Stores and acknowledges. Returns the frame for which `until` is true, or None at the end of the link."""
        while True:
            frame, _ = self.receive()
            if frame is None or until(frame):
                return frame
            kind = frame.WhichOneof("body")
            if kind == "sensor_description":
                self.described.add(frame.sensor_description.sensor)
                self.server.sensors.append(frame.sensor_description)
            elif kind == "scan_batch":
                self.server.batches.append(len(frame.scan_batch.scans))
                self.take(frame.scan_batch)
                self.ack()
            elif kind == "ping":
                self.send(pong={"nonce": frame.ping.nonce})
            elif kind == "goodbye":
                self.server.goodbyes += 1
                return None


def well(link):
    """A server without errors."""
    link.greet()
    link.serve()


class FakeServer:
    def __init__(self, *scripts, tls=None, split=False):
        self.scripts = scripts or (well,)
        self.tls = tls
        self.split = split
        self.links = 0
        self.hellos, self.sensors, self.stored, self.batches, self.faults = [], [], [], [], []
        self.goodbyes = 0
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._open = None
        self.address = "127.0.0.1:%d" % self._listener.getsockname()[1]
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self):
        while True:
            try:
                sock, _ = self._listener.accept()
            except OSError:
                return
            script = self.scripts[min(self.links, len(self.scripts) - 1)]
            self.links += 1
            self._open = sock
            try:
                if self.tls:
                    sock = self._open = self.tls.wrap_socket(sock, server_side=True)
                script(Link(sock, self, self.split))
            except OSError:
                pass  # the robot has disconnected
            except Exception as error:  # the test's own thread reports it
                self.faults.append(repr(error))
            finally:
                sock.close()

    def stop(self):
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        if self._open:
            try:
                self._open.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass  # already closed
        self._thread.join()


def _message_name(field):
    return "".join(part.capitalize() for part in field.split("_"))
