#!/usr/bin/env python3
"""Leads haptolith's tool along a circle through its network device, and prints the force that a hand would feel.

    haptolith run --device network          in one terminal
    examples/network_device.py              in another

Packets are signed with a shared key: openssl rand -hex 32 > device.key, with --device-key-file device.key for haptolith and
--key-file device.key here. Both packets are described in docs/reference/udp.md. It needs only Python's standard library.
"""

import argparse
import hashlib
import hmac
import math
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
FORGET_NONCE_S = 0.5  # without an answer; another client may have held the tool since


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--address", default="127.0.0.1:9050", help="HOST:PORT that haptolith listens at")
    parser.add_argument("--seconds", type=float, default=10, help="how long")
    parser.add_argument("--radius-mm", type=float, default=20, help="of the circle")
    parser.add_argument("--period-s", type=float, default=4, help="of one round")
    parser.add_argument("--height-mm", type=float, default=-90,
                        help="of the circle, in the device's frame, whose middle lies 85 mm above the soil [-90: in it]")
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


def circle(t, radius, period, height):
    """Position (m) and velocity (m/s) after t seconds."""
    turn = 2 * math.pi / period
    c, s = math.cos(turn * t), math.sin(turn * t)
    return (radius * c, radius * s, height), (-radius * turn * s, radius * turn * c, 0.0)


def main():
    args = arguments()
    connection = Connection(args.address, args.key_file)

    start = time.monotonic()
    answers, strongest, last_print, round_trip_ms = 0, 0.0, start, math.nan
    sequence = 0
    while time.monotonic() - start < args.seconds:
        now = time.monotonic()
        position, velocity = circle(now - start, args.radius_mm / 1000, args.period_s, args.height_mm / 1000)
        upright, no_turning = (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        connection.send(DEVICE.pack(b"HLDV", VERSION, HELD, sequence % 2**32, 0, time.monotonic_ns(),
                                    *position, *upright, *velocity, *no_turning, 0.0))
        sequence += 1

        answer = connection.newest_answer()
        if answer is not None:
            _, _, flags, _, _, sent_ns, fx, fy, fz, *_ = answer
            answers += 1
            strongest = max(strongest, math.hypot(fx, fy, fz))
            round_trip_ms = (time.monotonic_ns() - sent_ns) / 1e6
            if now - last_print > 0.1:
                last_print = now
                state = "tripped" if flags & TRIPPED else "live" if flags & LIVE else "not held"
                print(f"force {fx:7.3f} {fy:7.3f} {fz:7.3f} N  round trip {round_trip_ms:6.2f} ms  {state}", flush=True)
        # A program that renders force on a hand would also set it to zero here after 20 ms without an answer.
        time.sleep(0.001)
    print(f"{sequence} packets sent, {answers} answers, strongest force {strongest:.3f} N")
    if answers > 0 and strongest == 0:
        print("the tool has felt nothing: is the soil lower than --height-mm?")


if __name__ == "__main__":
    main()
