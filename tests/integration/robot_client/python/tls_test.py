"""Links over TLS."""
import pathlib
import shutil
import ssl
import tempfile
import unittest

from fixture import LinkTest
from programs import run


@unittest.skipUnless(shutil.which("openssl"), "openssl makes the certificates of this test; install it")
class Tls(LinkTest):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.directory.cleanup)
        cls.certificate, cls.server_side = cls.make_certificate("localhost", "IP:127.0.0.1")

    @classmethod
    def make_certificate(cls, name, address):
        """Creates a self-signed certificate, with the files that a server needs to use it."""
        certificate, key = (pathlib.Path(cls.directory.name) / f"{name}.{kind}" for kind in ("pem", "key"))
        code, _, errors = run("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
                              "-nodes", "-days", "2", "-subj", f"/CN={name}", "-addext", f"subjectAltName={address}",
                              "-keyout", key, "-out", certificate)
        assert code == 0, errors
        server_side = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        server_side.load_cert_chain(certificate, key)
        return certificate, server_side

    def test_a_server_with_tls_is_reported(self):
        self.start(lambda link: link.receive())  # and closes, as a server with a certificate does
        self.assert_logs_retry("if it uses TLS, give tls=")

    def test_the_hint_depends_on_the_certificates_error(self):
        certificate, server_side = self.make_certificate("another", "DNS:another.example")
        self.start(tls=server_side)
        context = ssl.create_default_context(cafile=certificate)
        error = self.assert_fails("UNAUTHORIZED", self.client(tls=context).close)
        self.assertIn("use the name in the certificate", error.message)
        self.assertNotIn("its authority", error.message)

    def test_scans_arrive(self):
        self.start(tls=self.server_side)
        with self.client(tls=ssl.create_default_context(cafile=self.certificate)) as robot:
            laser = self.laser(robot, count=4000, angle_increment=0.001)
            for i in range(30):  # more than one read of a TLS record
                robot.send(laser, [1.0] * 4000, pose=(0.0, 0.0, 0.0), stamp=float(i))
        self.assert_stored(30)

    def test_a_required_client_certificate_is_accepted(self):
        certificate, _ = self.make_certificate("robot", "DNS:robot.example")
        _, server_side = self.make_certificate("mutual", "IP:127.0.0.1")
        server_side.verify_mode = ssl.CERT_REQUIRED
        server_side.load_verify_locations(certificate)
        self.start(tls=server_side)
        context = ssl.create_default_context(cafile=pathlib.Path(self.directory.name) / "mutual.pem")
        self.assert_logs_retry("load_cert_chain", tls=context)
        context.load_cert_chain(certificate, pathlib.Path(self.directory.name) / "robot.key")
        with self.client(tls=context) as robot:
            robot.send(self.laser(robot), [1.0] * 4, pose=(0.0, 0.0, 0.0), stamp=0.0)
        self.assert_stored(1)

    def test_an_untrusted_certificate_is_refused(self):
        self.start(tls=self.server_side)
        error = self.assert_fails("UNAUTHORIZED", self.client(tls=ssl.create_default_context()).close)
        self.assertIn(f"the certificate of {self.server.address} is not trusted", error.message)

    def test_a_server_without_tls_is_reported(self):
        self.start()
        self.assert_logs_retry(f"no TLS with {self.server.address}", tls=ssl.create_default_context(),
                            timing={"connect": 0.05})


if __name__ == "__main__":
    unittest.main()
