"""The client's embedded protocol is equal to that of this checkout."""
import os
import re
import sys
import unittest

from programs import CLIENT, SOURCE, run, scanloom_client


class Embedded(unittest.TestCase):
    def test_the_messages_equal_those_of_proto(self):
        code, _, errors = run(sys.executable, CLIENT.with_name("embed_protocol.py"), "--check", "--protoc",
                              os.environ.get("PROTOC", "protoc"))
        self.assertEqual(code, 0, errors)

    def test_the_version_is_the_projects(self):
        project = re.search(r"project\(scanloom VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text())
        self.assertEqual(scanloom_client.__version__, project[1])


if __name__ == "__main__":
    unittest.main()
