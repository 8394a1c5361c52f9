// "Bring tool here": lifts the tool out of the soil and over the centre of the bed, at the pace of a calm hand, turns
// it into its digging pose, and releases it there.

import type { Quat, Scene, Vec3 } from 'haptolith-protocol';
import { shapeOf } from '../tool_shapes';
import type { Hand } from './hand';
import { TILT_DEG_S } from './tilt';

const SPEED_M_S = 0.15;
const CLEARANCE_M = 0.02;
const LONGEST_STEP_S = 0.1;
// The tool is coupled by a spring, and follows with a delay.
const WAIT_S = 1;

export class ToolBringer {
  private before_ms: number | null = null;
  private waited_s = 0;

  constructor(
    private readonly hand: Hand,
    private readonly scene: () => Scene | null,
    /** as ToolTilt.digging */
    private readonly digging: () => Quat | null,
  ) {}

  /** Target position: as high over the soil as the tool is long. */
  get target_m(): Vec3 | null {
    const scene = this.scene();
    if (!scene) return null;
    const size_m = shapeOf(scene.tool).longest_m(scene.tool);
    return [0, 0, Math.min(scene.workspace.high_m[2], scene.box.surface_m + size_m / 2 + CLEARANCE_M)];
  }

  /** Starts. False when there is nothing to hold yet. */
  start(): boolean {
    this.before_ms = null;
    this.waited_s = 0;
    return this.hand.grab('automation');
  }

  /** Moves the tool. Called for every frame. */
  tick(now_ms: number): void {
    const to_m = this.target_m;
    if (!to_m || !this.hand.isHeldBy('automation')) return;
    if (!this.hand.isHeldOnlyBy('automation')) return this.hand.release('automation');
    const elapsed_s = this.before_ms === null ? 0 : Math.min(LONGEST_STEP_S, (now_ms - this.before_ms) / 1000);
    this.before_ms = now_ms;
    const at_m = this.hand.wished.position_m;
    // Out of the soil first, then across, then to its height; it turns above the soil.
    const low = at_m[2] < to_m[2] - 1e-6;
    const digging = low ? null : this.digging();
    const turned = digging === null || this.hand.turnTo(digging, (TILT_DEG_S * Math.PI * elapsed_s) / 180);
    const aside = Math.hypot(at_m[0] - to_m[0], at_m[1] - to_m[1]) > 1e-6;
    const next_m: Vec3 = low ? [at_m[0], at_m[1], to_m[2]] : aside ? [to_m[0], to_m[1], at_m[2]] : to_m;
    const way_m = next_m.map((value, axis) => value - at_m[axis]!) as Vec3;
    const far_m = Math.hypot(...way_m);
    if (far_m < 1e-6) {
      if (!turned) return;
      this.waited_s += elapsed_s;
      if (this.waited_s >= WAIT_S) this.hand.release('automation');
      return;
    }
    const share = Math.min(1, (SPEED_M_S * elapsed_s) / far_m);
    this.hand.move(way_m.map((value) => value * share) as Vec3);
  }
}
