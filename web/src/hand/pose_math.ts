// Small computations with poses, in the protocol's order (quaternions w, x, y, z).

import type { Pose, Quat, Range3, Vec3 } from 'haptolith-protocol';
import { Quaternion, Vector3 } from 'three';

export function clampTo(range: Range3, at_m: Vec3): Vec3 {
  return at_m.map((value, axis) => Math.min(range.high_m[axis]!, Math.max(range.low_m[axis]!, value))) as Vec3;
}

export function toThree([w, x, y, z]: Quat): Quaternion {
  return new Quaternion(x, y, z, w);
}

export function fromThree(q: Quaternion): Quat {
  return [q.w, q.x, q.y, q.z];
}

/** Turns by an angle about an axis of the scene (`after` the rotation) or of the tool (`before` it). */
export function turned(rotation: Quat, axis: Vec3, angle_rad: number, frame: 'scene' | 'tool'): Quat {
  const turn = new Quaternion().setFromAxisAngle(new Vector3(...axis), angle_rad);
  const now = toThree(rotation);
  return fromThree((frame === 'scene' ? turn.multiply(now) : now.multiply(turn)).normalize());
}

/** Returns the angle of the shortest turn from one rotation to another, in rad. */
export function angleBetween(a: Quat, b: Quat): number {
  const turn = toThree(a).normalize().conjugate().multiply(toThree(b).normalize());
  return 2 * Math.atan2(Math.hypot(turn.x, turn.y, turn.z), Math.abs(turn.w)); // accurate for small angles, unlike acos
}

/** Turns the shortest way from one rotation towards another, by at most an angle. */
export function turnedTowards(from: Quat, to: Quat, max_rad: number): Quat {
  return fromThree(toThree(from).normalize().rotateTowards(toThree(to).normalize(), max_rad));
}

/** Returns the pose of a tool whose hub moves from one pose to another. */
export function movedWith(tool: Pose, hub: Pose, to: Pose): Pose {
  const turn = toThree(to.rotation).multiply(toThree(hub.rotation).conjugate());
  const arm = new Vector3(...tool.position_m).sub(new Vector3(...hub.position_m)).applyQuaternion(turn);
  return {
    position_m: arm.add(new Vector3(...to.position_m)).toArray(),
    rotation: fromThree(turn.multiply(toThree(tool.rotation))),
  };
}

export function samePose(a: Pose, b: Pose): boolean {
  return (
    a.position_m.every((value, i) => value === b.position_m[i]) &&
    a.rotation.every((value, i) => value === b.rotation[i])
  );
}
