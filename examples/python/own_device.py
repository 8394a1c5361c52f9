#!/usr/bin/env python3
"""A device in Python in the 1 kHz loop: a handle on a spring that is pulled into the soil. For experiments only; a device for a
person's hand should be written in C or C++."""

import time

import numpy as np

import haptolith as hp


class HandleOnASpring(hp.Device):
    name = "handle on a spring"
    limits = hp.Limits(simulated=1, max_force_n=12, turns=0)

    def __init__(self):
        self.position_m, self.velocity_m_s, self.felt_n = np.zeros(3), np.zeros(3), np.zeros(3)

    def read(self):
        pull_n = 60 * (np.array([0, 0, -0.11]) - self.position_m) - 6 * self.velocity_m_s + self.felt_n
        self.velocity_m_s += 1e-3 * pull_n / 0.3
        self.position_m += 1e-3 * self.velocity_m_s
        return hp.DeviceInput(self.position_m, linear_m_s=self.velocity_m_s)

    def write(self, force_n, torque_nm):
        self.felt_n = force_n


with hp.Scene("icra2021", loop__duration_s=2) as scene, hp.Loop(scene, HandleOnASpring()) as loop:
    loop.start()
    while (now := loop.snapshot()).running:
        print(f"{now.time_s:4.1f} s  tool at {1e3 * now.tool_pose[2]:5.1f} mm  {now.device_force_n[2]:6.3f} N  tick {now.tick_us_p50:4.0f} us")
        time.sleep(0.25)
    print("ended:", loop.snapshot().end)
