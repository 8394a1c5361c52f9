// The hand of this page: what holds the tool here (mouse, keys, gamepad, controller) says where it wishes the tool to
// be; this sends the wish to the program, at most 60 times a second, and lets go when the last of them has.

import type { Frame, Pose, Quat, Scene, Vec3 } from 'haptolith-protocol';
import type { Connection } from '../connection';
import { angleBetween, clampTo, samePose, turned, turnedTowards } from './pose_math';

export type Holder = 'mouse' | 'keys' | 'gamepad' | 'controller' | 'automation' | 'tilt';

const SEND_INTERVAL_MS = 1000 / 60;
// How far a wish may run ahead of the workspace before it is cut: a mouse that went too far comes back at once.
const SLACK_M = 0.02;

export class Hand {
  /** how the tool stood when this hand last let go of it; null: it never had it */
  left: Quat | null = null;
  private readonly holders = new Set<Holder>();
  private free: Pose = { position_m: [0, 0, 0.1], rotation: [1, 0, 0, 0] };
  private sent: Pose | null = null;
  private sent_ms = 0;
  private scene: Scene | null = null;
  private frame: Frame | null = null;

  constructor(
    private readonly connection: Connection,
    private readonly onRefused: (error: Error) => void,
    private readonly onChange: () => void,
  ) {}

  setScene(scene: Scene): void {
    this.scene = scene;
  }

  setFrame(frame: Frame): void {
    this.frame = frame;
  }

  get held(): boolean {
    return this.holders.size > 0;
  }

  isHeldBy(holder: Holder): boolean {
    return this.holders.has(holder);
  }

  isHeldOnlyBy(holder: Holder): boolean {
    return this.isHeldBy(holder) && this.holders.size === 1;
  }

  /** Where the hand wants the tool, within the workspace. */
  get wished(): Pose {
    const range = this.scene?.workspace;
    return range ? { ...this.free, position_m: clampTo(range, this.free.position_m) } : this.free;
  }

  /** False when there is nothing to hold yet. */
  grab(holder: Holder): boolean {
    if (!this.scene || !this.frame || !this.connection.connected) return false;
    if (!this.held) {
      this.free = structuredClone(this.frame.tool);
      this.holders.add(holder);
      this.begin();
    }
    this.holders.add(holder);
    return true;
  }

  release(holder: Holder): void {
    if (!this.holders.delete(holder) || this.held) return;
    this.connection.send({ do: 'release' });
    this.forget();
    this.onChange();
  }

  /** Forgets the tool without telling the program: it was refused, taken away or the connection is gone. */
  drop(): void {
    if (!this.held) return;
    this.holders.clear();
    this.forget();
    this.onChange();
  }

  /** Lets go because the program says that somebody else has the tool, or nobody: whatever it knew when it said so. */
  giveUp(): void {
    if (!this.held) return;
    this.drop();
    this.connection.send({ do: 'release' });
  }

  move(by_m: Vec3): void {
    const range = this.scene!.workspace;
    const loose = {
      low_m: range.low_m.map((value) => value - SLACK_M) as Vec3,
      high_m: range.high_m.map((value) => value + SLACK_M) as Vec3,
    };
    const moved = this.free.position_m.map((value, axis) => value + by_m[axis]!) as Vec3;
    this.free = { ...this.free, position_m: clampTo(loose, moved) };
  }

  turn(axis: Vec3, angle_rad: number, frame: 'scene' | 'tool'): void {
    this.free = { ...this.free, rotation: turned(this.free.rotation, axis, angle_rad, frame) };
  }

  /** Turns towards a rotation, by an angle at most; true when it is reached. */
  turnTo(rotation: Quat, max_rad: number): boolean {
    this.free = { ...this.free, rotation: turnedTowards(this.free.rotation, rotation, max_rad) };
    return angleBetween(this.free.rotation, rotation) < 1e-4;
  }

  setPose(pose: Pose): void {
    this.free = structuredClone(pose);
  }

  /** Called for every picture. */
  tick(now_ms: number): void {
    if (!this.held || now_ms - this.sent_ms < SEND_INTERVAL_MS - 1) return;
    const wished = this.wished;
    if (this.sent && samePose(this.sent, wished)) return;
    this.connection.send({ do: 'hold', pose: [...wished.position_m, ...wished.rotation] });
    this.sent = wished;
    this.sent_ms = now_ms;
  }

  private forget(): void {
    this.sent = null;
    this.left = this.frame?.tool.rotation ?? null;
  }

  /** The first hold asks for a reply: somebody else may have the tool. */
  private begin(): void {
    const wished = this.wished;
    this.sent = wished;
    this.connection.request({ do: 'hold', pose: [...wished.position_m, ...wished.rotation] }).catch((error: Error) => {
      this.drop();
      this.onRefused(error);
    });
    this.onChange();
  }
}
