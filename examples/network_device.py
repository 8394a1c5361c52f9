#!/usr/bin/env python3
"""Leads haptolith's tool along a circle or a file of poses, through its network device, and prints the force that a hand would feel.

    haptolith run --device network          in one terminal
    examples/network_device.py              in another

Packets are signed with a shared key: openssl rand -hex 32 > device.key, with --device-key-file device.key for haptolith and
--key-file device.key here. Both packets are described in docs/reference/udp.md. It needs only Python's standard library.
"""

import argparse
import bisect
import contextlib
import csv
import hashlib
import hmac
import math
import os
import socket
import struct
import sys
import time

# little-endian: magic, version, flags, sequence, buttons, time; position, orientation, velocities, gripper
DEVICE = struct.Struct("<4sHHIIQ 3d4d3d3d d")
# little-endian: magic, version, flags, sequence, number, time; force, torque, gripper force
ANSWER = struct.Struct("<4sHHIIQ 3d3d d")
VERSION = 1
HELD = 1  # flags of sent packets: the dead-man switch is held
LIVE, TRIPPED = 1, 2  # flags of the answer
NONCE_BYTES = TAG_BYTES = 16  # in signed packets
NO_NONCE = bytes(NONCE_BYTES)
TICK_S = 0.001
MOST_OWED = 20  # answers; haptolith owes no more
FORGET_NONCE_S = 0.5  # without an answer; another client may have held the tool since


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--address", default="127.0.0.1:9050", help="HOST:PORT that haptolith listens at")
    parser.add_argument("--seconds", type=float, default=10, help="how long, on the circle")
    parser.add_argument("--radius-mm", type=float, default=20, help="of the circle")
    parser.add_argument("--period-s", type=float, default=4, help="of one round")
    parser.add_argument("--height-mm", type=float, default=-90,
                        help="of the circle, in the device's frame, whose middle lies 85 mm above the soil [-90: in it]")
    parser.add_argument("--poses", metavar="FILE.csv",
                        help="instead of the circle: t_s,x_m,y_m,z_m,qw,qx,qy,qz in simulated time and in the scene's frame; "
                             "rest for the first 2 s, in which haptolith takes up the hand")
    parser.add_argument("--origin-mm", type=float, nargs=3, default=(0, 0, 134), metavar=("X", "Y", "Z"),
                        help="of the device's frame in the scene's, for --poses [0 0 134: 85 mm above soil that is 49 mm deep]")
    parser.add_argument("--key-file", help="with the key that packets are signed with, 64 hexadecimal digits")
    return parser.parse_args()


def tag(key, nonce, packet):
    return hashlib.blake2b(nonce + packet, key=key, digest_size=TAG_BYTES).digest()


class Connection:
    """Sends packets and receives answers, signed when there is a key."""

    def __init__(self, address, key_file):
        host, port = address.rsplit(":", 1)
        self.key = None
        if key_file:
            with open(key_file, encoding="ascii") as file:
                self.key = bytes.fromhex(file.read().strip())
        self.nonce = NO_NONCE  # packets signed with it request the nonce to use
        self.answered = time.monotonic()
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.connect((host, int(port)))
        self.sock.setblocking(False)

    def send(self, packet):
        try:
            self.sock.send(packet + tag(self.key, self.nonce, packet) if self.key else packet)
        except ConnectionRefusedError:
            self.nobody()

    def newest_answer(self):
        """Returns the newest received answer, or None."""
        newest = None
        while True:
            try:
                packet = self.sock.recv(ANSWER.size + NONCE_BYTES + TAG_BYTES + 1)
            except BlockingIOError:
                if time.monotonic() - self.answered > FORGET_NONCE_S:
                    self.nonce = NO_NONCE
                return newest
            except ConnectionRefusedError:
                self.nobody()
            newest = self.read(packet) or newest

    def read(self, packet):
        size = ANSWER.size + (NONCE_BYTES + TAG_BYTES if self.key else 0)
        if len(packet) != size:
            return None
        if self.key and not hmac.compare_digest(tag(self.key, NO_NONCE, packet[:-TAG_BYTES]), packet[-TAG_BYTES:]):
            return None
        answer = ANSWER.unpack(packet[:ANSWER.size])
        sent_ns = answer[5]
        # An old answer may be a replay attack. A program that renders force on a hand would accept at most 20 ms.
        fresh = 0 <= time.monotonic_ns() - sent_ns <= FORGET_NONCE_S * 1e9
        if answer[0] != b"HLAN" or answer[1] != VERSION or not fresh:
            return None
        self.nonce = packet[ANSWER.size:ANSWER.size + NONCE_BYTES]
        self.answered = time.monotonic()
        return answer

    def nobody(self):
        sys.exit("nobody listens there: start `haptolith run --device network` first, or give --address")


class Circle:
    """A round at constant height."""

    def __init__(self, args):
        self.radius, self.turn, self.height = args.radius_mm / 1000, 2 * math.pi / args.period_s, args.height_mm / 1000
        self.duration_s = args.seconds

    def at(self, t):
        """Position (m), orientation (w x y z), linear (m/s) and angular velocity (rad/s) after t seconds."""
        x, y = self.radius * math.cos(self.turn * t), self.radius * math.sin(self.turn * t)
        return (x, y, self.height), (1.0, 0.0, 0.0, 0.0), (-self.turn * y, self.turn * x, 0.0), (0.0, 0.0, 0.0)


class Poses:
    """A file of poses."""

    def __init__(self, args):
        with open(args.poses, encoding="utf-8-sig", newline="") as file:
            rows = [[float(row[name]) for name in "t_s x_m y_m z_m qw qx qy qz".split()] for row in csv.DictReader(file)]
        if len(rows) < 2:
            sys.exit(f"{args.poses}: {len(rows)} poses; expected a table of at least 2")
        self.times = [row[0] - rows[0][0] for row in rows]
        self.positions = [[x - origin / 1000 for x, origin in zip(row[1:4], args.origin_mm)] for row in rows]
        self.orientations = [row[4:] for row in rows]
        self.duration_s = self.times[-1]

    def pose(self, t):
        """Interpolates linearly between rows, and orientations on the arc between them."""
        i = min(bisect.bisect_right(self.times, t), len(self.times) - 1)
        share = min((t - self.times[i - 1]) / (self.times[i] - self.times[i - 1]), 1)
        p, q = self.orientations[i - 1:i + 1]
        cosine = sum(a * b for a, b in zip(p, q))
        angle = math.acos(min(abs(cosine), 1))
        from_p, from_q = (math.sin((1 - share) * angle), math.sin(share * angle)) if angle > 1e-6 else (1, 0)
        turned = [from_p * a + math.copysign(from_q, cosine) * b for a, b in zip(p, q)]  # the shorter way
        return ([a + share * (b - a) for a, b in zip(*self.positions[i - 1:i + 1])],
                [a / math.hypot(*turned) for a in turned])

    def at(self, t):
        """Position (m), orientation (w x y z), linear (m/s) and angular velocity (rad/s) after t seconds."""
        (position, p), (next_position, q) = self.pose(t), self.pose(t + TICK_S)
        turn = (p[0] * q[1] - p[1] * q[0] + p[2] * q[3] - p[3] * q[2],  # vector part of q p^-1: half of a small angle
                p[0] * q[2] - p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
                p[0] * q[3] - p[3] * q[0] + p[1] * q[2] - p[2] * q[1])
        return position, p, [(b - a) / TICK_S for a, b in zip(position, next_position)], [2 * a / TICK_S for a in turn]


def main():
    args = arguments()
    connection = Connection(args.address, args.key_file)
    path = Poses(args) if args.poses else Circle(args)
    with contextlib.suppress(AttributeError, OSError):  # Linux only, and by permission
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(20))  # 20 ms without a packet trip the hand

    start = time.monotonic()
    answers, strongest, last_print, round_trip_ms = 0, 0.0, start, math.nan
    sequence, ticks_due, ticks_answered, last_number = 0, 0, 0, None
    while True:
        now = time.monotonic()
        # Poses follow the simulated time, so that a slow machine does not hurry the hand.
        t = ticks_answered * TICK_S if args.poses else now - start
        if t >= path.duration_s:
            break
        position, orientation, velocity, angular_velocity = path.at(t)
        # A tick answers one packet. Also sending what a pause has delayed gives an answer per tick, which counts time.
        sent, ticks_due = ticks_due, int((now - start) / TICK_S) + 1
        for _ in range(min(ticks_due - sent, MOST_OWED)):
            connection.send(DEVICE.pack(b"HLDV", VERSION, HELD, sequence % 2**32, 0, time.monotonic_ns(),
                                        *position, *orientation, *velocity, *angular_velocity, 0.0))
            sequence += 1

        answer = connection.newest_answer()
        if answer is not None:
            _, _, flags, _, number, sent_ns, fx, fy, fz, *_ = answer
            answers += 1
            if flags & LIVE and not flags & TRIPPED and last_number is not None:
                ticks_answered += (number - last_number) % 2**32
            last_number = number
            strongest = max(strongest, math.hypot(fx, fy, fz))
            round_trip_ms = (time.monotonic_ns() - sent_ns) / 1e6
            if now - last_print > 0.1:
                last_print = now
                state = "tripped" if flags & TRIPPED else "live" if flags & LIVE else "not held"
                print(f"force {fx:7.3f} {fy:7.3f} {fz:7.3f} N  round trip {round_trip_ms:6.2f} ms  {state}", flush=True)
        # A program that renders force on a hand would also set it to zero here after 20 ms without an answer.
        time.sleep(TICK_S)
    print(f"{sequence} packets sent, {answers} answers, strongest force {strongest:.3f} N")
    if answers > 0 and strongest == 0:
        print("the tool has felt nothing: is the soil lower than --height-mm?")


if __name__ == "__main__":
    main()
