#!/usr/bin/env python3
"""A robot that turns once on the spot in a square room and sends what its laser sees.

    PYTHONPATH=robot_client/python python3 robot_client/examples/send_scan.py 127.0.0.1:7447
"""
import math
import sys

import scanloom_client

HALF_ROOM = 2.0  # metres from the robot to each wall


def distance_to_wall(angle: float) -> float:
    return HALF_ROOM / max(abs(math.cos(angle)), abs(math.sin(angle)))


def main(server: str) -> None:
    with scanloom_client.Client(server, session="example", robot="python", cell_size=0.05) as robot:
        beams = 361
        laser = robot.laser(angle_min=-math.pi / 2, angle_increment=math.pi / 360, count=beams, range_max=10.0)
        for step in range(36):
            yaw = math.radians(10 * step)
            ranges = [distance_to_wall(yaw - math.pi / 2 + i * math.pi / 360) for i in range(beams)]
            robot.send(laser, ranges, pose=(0.0, 0.0, yaw))
    print(f"{robot.acknowledged} scans are stored")  # leaving the block has waited for that


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1:7447")
