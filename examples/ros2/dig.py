#!/usr/bin/env python3
"""A node of ROS 2 that digs in haptolith's soil, and prints what the soil does to the tool.

    haptolith ros2 icra2021 --target-timeout-s 0.2            in one terminal
    source /opt/ros/DISTRO/setup.bash
    examples/ros2/dig.py --surface-m 0.09                  in another; the height that haptolith prints at its start

Written from rclpy's documentation and not tested with a real ROS 2: docs/how-to/ros2.md lists the tests.
"""
import argparse
import math

import rclpy
from geometry_msgs.msg import PoseStamped, WrenchStamped
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data

PERIOD_S = 0.01  # targets at 100 Hz: haptolith releases the tool after 0.1 s without one


class Digger(Node):
    def __init__(self, surface_m, depth_m):
        super().__init__("digger")
        self.surface_m, self.depth_m, self.time_s, self.wrench = surface_m, depth_m, 0.0, None
        # Best effort, as in haptolith; a subscription with reliable delivery receives nothing.
        self.create_subscription(WrenchStamped, "/haptolith/wrench", self.hear, qos_profile_sensor_data)
        self.targets = self.create_publisher(PoseStamped, "/haptolith/target_pose", 1)
        self.create_timer(PERIOD_S, self.lead)
        self.create_timer(0.5, self.tell)

    def lead(self):
        """A circle of 30 mm; the first 5 s move from 50 mm above the soil down into it."""
        self.time_s += PERIOD_S
        sunk = min(1.0, self.time_s / 5)
        target = PoseStamped()
        target.header.stamp = self.get_clock().now().to_msg()
        target.header.frame_id = "haptolith_bed"
        target.pose.position.x = 0.03 * math.cos(2 * math.pi * self.time_s / 4)
        target.pose.position.y = 0.03 * math.sin(2 * math.pi * self.time_s / 4)
        target.pose.position.z = self.surface_m + 0.05 - sunk * (0.05 + self.depth_m)
        target.pose.orientation.w = 1.0
        self.targets.publish(target)

    def hear(self, message):
        self.wrench = message.wrench

    def tell(self):
        if self.wrench is None:
            self.get_logger().info("no wrench yet: is haptolith in the same domain (ROS_DOMAIN_ID)?")
            return
        force = self.wrench.force
        self.get_logger().info(f"force {force.x:6.2f} {force.y:6.2f} {force.z:6.2f} N, in the tool's frame")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--surface-m", type=float, required=True, help="height of the soil's surface, as haptolith prints it")
    parser.add_argument("--depth-m", type=float, default=0.01)
    args = parser.parse_args()
    rclpy.init()
    node = Digger(args.surface_m, args.depth_m)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
