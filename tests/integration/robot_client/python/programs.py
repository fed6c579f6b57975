"""The programs of the build under test, as processes of a test, and the client of this checkout."""
import faulthandler
import json
import os
import pathlib
import signal
import subprocess
import sys
import urllib.request

SOURCE = pathlib.Path(__file__).resolve().parents[4]
CLIENT = SOURCE / "robot_client/python/scanloom_client.py"
PROGRAMS = pathlib.Path(os.environ.get("SCANLOOM_BIN_DIR", SOURCE / "build/bin"))

sys.path.insert(0, str(CLIENT.parent))
import scanloom_client  # imported by the tests from here


faulthandler.dump_traceback_later(500, exit=True)  # prints the stack of a test that hangs


class RunningServer:
    """A scanloom-server, ready when constructed. Ports 0 select free ones. options are further arguments."""

    def __init__(self, directory, robot_port=0, http_port=0, options=()):
        directory = pathlib.Path(directory)
        with open(directory / "server.log", "ab") as log:
            self.process = subprocess.Popen(
                [PROGRAMS / "scanloom-server", "--store", directory / "store", "--listen", f"127.0.0.1:{robot_port}",
                 "--http", f"127.0.0.1:{http_port}", *options], stdout=subprocess.PIPE, stderr=log)
        ready = json.loads(self.process.stdout.readline() or "{}")
        if "robot_port" not in ready:
            self.stop()
            raise RuntimeError("scanloom-server ended: " + (directory / "server.log").read_text())
        self.robot_port = ready["robot_port"]
        self.http_port = ready["http_port"]
        self.address = f"127.0.0.1:{self.robot_port}"

    def get(self, target):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.http_port}/api/v1/sessions/{target}") as answer:
            return answer.read().decode()

    def get_json(self, target):
        return json.loads(self.get(target))

    def kill(self):
        self.stop(signal.SIGKILL)

    def stop(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        self.process.wait()
        self.process.stdout.close()


def run(*command, **options):
    """A program's exit code, output and errors."""
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          check=False, **options)
    return done.returncode, done.stdout, done.stderr
