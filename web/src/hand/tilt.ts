// The tilt of the tool: 0 horizontal, 90 nose straight down. A horizontal shovel presses the soil instead of digging.
// A tool that digs by its edge therefore turns its nose down when it is taken; the slider over the picture tilts it by
// hand.

import type { Frame, Quat, Scene, Vec3 } from 'haptolith-protocol';
import { Quaternion, Vector3 } from 'three';
import { shapeOf } from '../tool_shapes';
import type { Hand } from './hand';
import { angleBetween, fromThree, toThree } from './pose_math';

/** pace of a calm hand */
export const TILT_DEG_S = 120;
export const LOWEST_TILT_DEG = -30;
export const HIGHEST_TILT_DEG = 90;
const DEGREES = Math.PI / 180;
const LONGEST_STEP_S = 0.1;
const RELEASE_MS = 600;
// The tool yields to the soil: within this angle of its orientation at release, the tool has not been turned otherwise.
const SAME_DEG = 15;
const ARRIVED_RAD = 1e-4;

/** Returns the nose angle of a tool, in degrees: 0 horizontal, 90 straight down. */
export function tiltOf(rotation: Quat): number {
  const turn = toThree(rotation);
  const nose = new Vector3(1, 0, 0).applyQuaternion(turn);
  const up = new Vector3(0, 0, 1).applyQuaternion(turn);
  return Math.atan2(-nose.z, up.z) / DEGREES;
}

/** Returns the rotation of a tool whose nose points along `ahead` (horizontal) and down by an angle. */
export function noseDown(ahead: Vec3, tilt_deg: number): Quat {
  const yaw = new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), Math.atan2(ahead[1], ahead[0]));
  return fromThree(yaw.multiply(new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), tilt_deg * DEGREES)));
}

export class ToolTilt {
  /** target rotation; null: the tool keeps its rotation */
  private goal: Quat | null = null;
  private last: Quat | null = null;
  private before_ms: number | null = null;
  private idle_since_ms = 0;

  constructor(
    private readonly hand: Hand,
    private readonly scene: () => Scene | null,
    private readonly frame: () => Frame | null,
    /** to the right of the picture, horizontal */
    private readonly right: () => Vec3,
  ) {}

  /** Tilt of the tool: the target where it is held, else the actual one; null: not known yet. */
  get now_deg(): number | null {
    const frame = this.frame();
    return this.hand.held ? tiltOf(this.goal ?? this.hand.wished.rotation) : frame && tiltOf(frame.tool.rotation);
  }

  /** Rotation in which the tool digs when it is dragged across the picture; null: no special rotation. */
  get digging(): Quat | null {
    const scene = this.scene();
    const tilt_deg = scene ? shapeOf(scene.tool).dig_tilt_deg : 0;
    return tilt_deg === 0 ? null : noseDown(this.right(), tilt_deg);
  }

  /** Turns the nose down after a pointer has taken the tool, unless its rotation is that of this page's last
   * release. */
  taken(): void {
    const { left } = this.hand;
    const kept = left !== null && angleBetween(left, this.hand.wished.rotation) < SAME_DEG * DEGREES;
    if (kept || !this.hand.isHeldOnlyBy('mouse') || !this.digging) return;
    this.aim(this.digging);
    this.hand.grab('tilt'); // a click also turns it
  }

  /** Tilts the tool, and takes it if it is free. False when there is nothing to hold yet. */
  set(tilt_deg: number): boolean {
    const now_deg = this.now_deg;
    if (now_deg === null || !this.hand.grab('tilt')) return false;
    const from = this.goal ?? this.hand.wished.rotation;
    const by = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), (tilt_deg - now_deg) * DEGREES);
    this.aim(fromThree(toThree(from).multiply(by)));
    return true;
  }

  /** Turns towards the target. Called for every frame. */
  tick(now_ms: number): void {
    const elapsed_s = this.before_ms === null ? 0 : Math.min(LONGEST_STEP_S, (now_ms - this.before_ms) / 1000);
    this.before_ms = now_ms;
    if (!this.hand.held) this.goal = null;
    // Keys, or another hand, turn it now.
    if (this.goal && this.last && angleBetween(this.last, this.hand.wished.rotation) > ARRIVED_RAD) this.goal = null;
    if (this.goal) {
      this.idle_since_ms = now_ms;
      if (this.hand.turnTo(this.goal, TILT_DEG_S * DEGREES * elapsed_s)) this.goal = null;
      this.last = this.hand.wished.rotation;
    } else if (this.hand.isHeldBy('tilt') && now_ms - this.idle_since_ms > RELEASE_MS) this.hand.release('tilt');
  }

  private aim(goal: Quat | null): void {
    this.goal = goal;
    this.last = null;
  }
}
