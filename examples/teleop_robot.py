#!/usr/bin/env python3
"""Minimal robot for haptolith's operator, as a starting point for a real robot.

    examples/teleop_robot.py                             in one terminal
    haptolith teleop operator --connect 127.0.0.1:7410   in another

It follows commands by their number, stops without commands, and reports a force: that of level ground with a stiffness of
500 N/m below the site's zero. Replace drive(), measure() and look() by an arm, a force sensor and a camera; without a camera
remove look(). The packets are those of docs/reference/teleop-packets.md and include/haptolith/teleop.h. It needs only Python's
standard library.
"""

import argparse
import bisect
import hashlib
import hmac
import os
import random
import socket
import struct
import time

COMMAND = struct.Struct("<4sHHIIQQ")  # magic, version, flags, session, keys, number, sender's time
KEY = struct.Struct("<Q3f4f3f3ff")  # index, position, orientation, velocities, opening
STATE = struct.Struct("<4sHHIIQQQBBHI")  # magic, version, flags, sessions, number, time, newest, state, reason, reports
REPORT = struct.Struct("<QII3f4f3f3ff")  # index, ticks, -, position, orientation, force, torque, -
SITE = struct.Struct("<4sHHIHHfffHHHHIQQ")  # magic, version, -, session, map, corner, cell, part, -, number, index
HELD = 1
WAITING, FOLLOWING, HOLDING = 1, 3, 4
NONE, SILENCE, RELEASED = 0, 1, 2
TAG_BYTES = NONCE_BYTES = 16
PERIOD_S, LOOK_S, SILENCE_S = 0.02, 0.25, 1.0
MOST_REPORTS = 4  # per packet: reports are repeated because packets can be lost


class Seal:
    """Signs packets and verifies signatures, if there is a key."""

    def __init__(self, key_file):
        self.key = bytes.fromhex(open(key_file, encoding="ascii").read().strip()) if key_file else None
        self.own, self.other = os.urandom(NONCE_BYTES), bytes(NONCE_BYTES)

    def tag(self, nonce, message):
        return hashlib.blake2b(nonce + message, key=self.key, digest_size=TAG_BYTES).digest()

    def seal(self, packet):
        return packet + self.own + self.tag(self.other, packet + self.own) if self.key else packet

    def open(self, packet):
        """Returns the packet and whether it is of this run; None without a valid signature."""
        if not self.key:
            return packet, True
        message, signed = packet[:-TAG_BYTES], packet[-TAG_BYTES:]
        fresh = hmac.compare_digest(signed, self.tag(self.own, message))
        if not fresh and not hmac.compare_digest(signed, self.tag(bytes(NONCE_BYTES), message)):
            return None
        self.other = message[-NONCE_BYTES:]
        return message[:-NONCE_BYTES], fresh


def parse(packet):
    """Session, number, sender's time, whether the hand holds the tool, and keys by index; None for anything else."""
    if len(packet) < COMMAND.size:
        return None
    magic, version, flags, session, count, number, sent = COMMAND.unpack_from(packet)
    if magic != b"HLTC" or version != 1 or session == 0 or len(packet) != COMMAND.size + count * KEY.size:
        return None
    keys = {}
    for i in range(count):
        index, *values = KEY.unpack_from(packet, COMMAND.size + i * KEY.size)
        if not all(abs(v) < 1000 for v in values):  # also false for NaN
            return None
        keys[index] = (values[0:3], values[3:7])
    return session, number, sent, bool(flags & HELD), keys


def drive(pose):
    """Moves the tool to a pose; returns its actual pose. A robot would limit speed and force here, and stop if necessary."""
    return pose


def measure(pose):
    """Force (N) and torque (N m) of the soil on the tool: here an elastic ground below the site's zero."""
    depth = max(0.0, -pose[0][2])
    return (0.0, 0.0, 500 * depth), (0.0, 0.0, 0.0)


SIDE, CELL_M = 16, 0.015  # cells along a side of the map, and their width


def look(pose):
    """Heights of the soil above the site's zero in m, row by row along x: here a ground that yields under the tool."""
    (x, y, z), heights = pose[0], []
    for row in range(SIDE):
        for column in range(SIDE):
            aside = [(i + 0.5 - SIDE / 2) * CELL_M - at for i, at in ((column, x), (row, y))]
            heights.append(min(0.0, z) if max(map(abs, aside)) < 0.03 else 0.0)
    return heights


class Robot:
    def __init__(self):
        self.keys, self.session, self.number, self.sent, self.held = {}, 0, 0, 0, False
        self.index, self.pose, self.silent_since = None, ((0.0, 0.0, 0.085), (1.0, 0.0, 0.0, 0.0)), time.monotonic()
        self.forces, self.reports = [], []

    def take(self, session, number, sent, held, keys):
        if session == self.session and number <= self.number:
            return  # out of order, or replayed by another sender
        if session != self.session:
            self.keys, self.index, self.reports = {}, None, []
        self.session, self.number, self.sent, self.held = session, number, sent, held
        self.keys.update(keys)
        self.silent_since = time.monotonic()

    def step(self, seconds):
        """Advances by a number of the operator's ticks, as far as commands have been received."""
        if not self.keys or not self.held:
            return
        newest = max(self.keys)
        before = self.index if self.index is not None else newest
        behind = newest - before
        pace = min(1.1, max(0.9, 1 + (behind - 40) / 2000))  # 40 ms of buffer against jitter
        self.index = min(newest, before + pace * 1000 * seconds)
        self.pose = drive(self.command(self.index))
        self.forces.append((self.index, *measure(self.pose)))
        self.keys = {i: k for i, k in self.keys.items() if i >= self.index - 1000 or i == newest}

    def command(self, index):
        """Pose of the hand between two keys. A cubic Hermite spline with the keys' velocities would be smoother."""
        known = sorted(self.keys)
        after = bisect.bisect_left(known, index)
        if after == 0 or after == len(known):
            return self.keys[known[min(after, len(known) - 1)]]
        (p, q), (r, s) = self.keys[known[after - 1]], self.keys[known[after]]
        share = (index - known[after - 1]) / (known[after] - known[after - 1])
        return [a + share * (b - a) for a, b in zip(p, r)], (s if share > 0.5 else q)

    def report(self):
        last = self.reports[-1][0] if self.reports else None
        index = int(self.index or 0)
        if self.forces and last is not None and index > last:
            mean = [sum(f[part][i] for f in self.forces) / len(self.forces) for part in (1, 2) for i in range(3)]
            self.reports.append((index, index - last, mean, self.pose))
        elif not self.reports:
            self.reports.append((index, 0, [0.0] * 6, self.pose))
        self.forces = []
        self.reports = self.reports[-MOST_REPORTS:]


def map_packet(session, number, index, heights):
    """Packs a map with a single part; larger maps are sent in parts of 16 by 16 cells."""
    corner = -SIDE / 2 * CELL_M
    header = SITE.pack(b"HLTM", 1, 0, session, SIDE, SIDE, corner, corner, CELL_M, 0, 0, SIDE, SIDE, 0, number, index)
    return header + struct.pack(f"<{SIDE * SIDE}h", *(round(1e4 * height) for height in heights))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--listen", default="127.0.0.1:7410", help="HOST:PORT that commands come to")
    parser.add_argument("--key-file", help="with the key that both sides sign with, 64 hexadecimal digits")
    parser.add_argument("--seconds", type=float, help="how long [until Ctrl-C]")
    args = parser.parse_args()
    host, port = args.listen.rsplit(":", 1)
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind((host, int(port)))
    sock.setblocking(False)
    seal, robot, operator = Seal(args.key_file), Robot(), None
    own_session, number, maps = random.randrange(1, 2**32), 0, 0
    start = told = before = printed = shown = time.monotonic()
    while args.seconds is None or time.monotonic() - start < args.seconds:
        while True:
            try:
                packet, sender = sock.recvfrom(65536)
            except (BlockingIOError, ConnectionRefusedError):
                break
            opened = seal.open(packet)
            command = parse(opened[0]) if opened else None
            if command:
                operator = sender
                if opened[1]:
                    robot.take(*command)
        now = time.monotonic()
        silent = now - robot.silent_since > SILENCE_S
        if not silent:
            robot.step(now - before)
        before = now
        if now - told >= PERIOD_S and operator:
            told = now
            robot.report()
            number += 1
            state = WAITING if robot.session == 0 else FOLLOWING if robot.held and not silent else HOLDING
            reason = SILENCE if silent and robot.session else NONE if robot.held or robot.session == 0 else RELEASED
            packet = STATE.pack(b"HLTS", 1, 0, robot.session, own_session, number, robot.sent,
                                max(robot.keys, default=0), state, reason, len(robot.reports), 0)
            for index, ticks, mean, (position, orientation) in robot.reports:
                packet += REPORT.pack(index, ticks, 0, *position, *orientation, *mean, 0.0)
            packets = [packet]
            if now - shown >= LOOK_S:
                shown = now
                maps += 1
                packets.append(map_packet(own_session, maps, int(robot.index or 0), look(robot.pose)))
            try:
                for packet in packets:
                    sock.sendto(seal.seal(packet), operator)
            except ConnectionRefusedError:
                pass  # the operator is disconnected, and may reconnect
        if now - printed > 0.5:
            printed = now
            x, y, z = robot.pose[0]
            print(f"command {int(robot.index or 0):8d}  tool {1e3 * x:7.1f} {1e3 * y:7.1f} {1e3 * z:7.1f} mm", flush=True)
        time.sleep(0.001)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
