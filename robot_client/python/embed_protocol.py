#!/usr/bin/env python3
"""Embeds the current messages of proto/ into scanloom_client.py in this folder.

    python3 robot_client/python/embed_protocol.py            writes them
    python3 robot_client/python/embed_protocol.py --check    exits 1 where the file holds others
"""
import argparse
import base64
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap
import zlib

CLIENT = pathlib.Path(__file__).resolve().with_name("scanloom_client.py")
PROTO = CLIENT.parents[2] / "proto"
BLOCK = re.compile(r'(?<=_PROTOCOL = """\n)[A-Za-z0-9+/=\n]*(?=""")')


def described_today(protoc: str) -> bytes:
    """Returns the FileDescriptorSet of frame.proto and its imports."""
    with tempfile.TemporaryDirectory() as directory:
        out = pathlib.Path(directory) / "descriptors"
        subprocess.run([protoc, f"--proto_path={PROTO}", "--include_imports", f"--descriptor_set_out={out}",
                        "scanloom/v1/frame.proto"], check=True)
        return out.read_bytes()


def main() -> int:
    parser = argparse.ArgumentParser(description="Embeds proto/ into scanloom_client.py.")
    parser.add_argument("--check", action="store_true", help="only compare")
    parser.add_argument("--protoc", default="protoc", help="protobuf's compiler")
    options = parser.parse_args()
    today = described_today(options.protoc)
    text = CLIENT.read_text(encoding="utf-8")
    embedded = zlib.decompress(base64.b64decode(BLOCK.search(text).group()) or zlib.compress(b""))
    if embedded == today:
        return 0
    if options.check:
        print("scanloom_client.py differs from proto/; run: python3 robot_client/python/embed_protocol.py",
              file=sys.stderr)
        return 1
    lines = textwrap.wrap(base64.b64encode(zlib.compress(today, 9)).decode("ascii"), 116)
    CLIENT.write_text(BLOCK.sub("\n".join(lines) + "\n", text), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
