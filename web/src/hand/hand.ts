// The hand of this page. The holders of the tool (mouse, keys, gamepad, controller) set its target pose. This class
// sends it to the program, at most 60 times per second, and releases the tool after the last holder.

import type { Command, Frame, Pose, Quat, Scene, Vec3 } from 'haptolith-protocol';
import type { Connection } from '../connection';
import { angleBetween, clampTo, samePose, turned, turnedTowards } from './pose_math';

export type Holder = 'mouse' | 'keys' | 'gamepad' | 'controller' | 'automation' | 'tilt';

const SEND_INTERVAL_MS = 1000 / 60;
// Distance by which a target may leave the workspace before it is clamped: after an overshoot, the mouse returns
// immediately.
const SLACK_M = 0.02;

export class Hand {
  /** orientation of the tool at this hand's last release; null: never held */
  left: Quat | null = null;
  /** name of the tool in commands; undefined: the first */
  private tool: string | undefined = undefined;
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

  /** Selects the tool of this hand by its name, after a release of the tool before; undefined: the only one. */
  choose(tool: string | undefined): void {
    if (tool === this.tool) return;
    this.giveUp();
    this.left = null;
    this.tool = tool;
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

  /** Target pose of the tool, within the workspace. */
  get wished(): Pose {
    const range = this.scene?.workspace;
    return range ? { ...this.free, position_m: clampTo(range, this.free.position_m) } : this.free;
  }

  /** Takes the tool for a holder. False when there is nothing to hold yet. */
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
    this.connection.send(this.ofTool({ do: 'release' }));
    this.forget();
    this.onChange();
  }

  /** Drops the tool without a message to the program: it was refused, taken away or the connection is lost. */
  drop(): void {
    if (!this.held) return;
    this.holders.clear();
    this.forget();
    this.onChange();
  }

  /** Releases the tool because the program reports another holder or none, even if that report is outdated. */
  giveUp(): void {
    if (!this.held) return;
    this.drop();
    this.connection.send(this.ofTool({ do: 'release' }));
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

  /** Turns towards a rotation, by at most an angle; true when it is reached. */
  turnTo(rotation: Quat, max_rad: number): boolean {
    this.free = { ...this.free, rotation: turnedTowards(this.free.rotation, rotation, max_rad) };
    return angleBetween(this.free.rotation, rotation) < 1e-4;
  }

  setPose(pose: Pose): void {
    this.free = structuredClone(pose);
  }

  /** Sends the target pose. Called for every frame. */
  tick(now_ms: number): void {
    if (!this.held || now_ms - this.sent_ms < SEND_INTERVAL_MS - 1) return;
    const wished = this.wished;
    if (this.sent && samePose(this.sent, wished)) return;
    this.connection.send(this.holdAt(wished));
    this.sent = wished;
    this.sent_ms = now_ms;
  }

  private holdAt({ position_m, rotation }: Pose): Command {
    return this.ofTool({ do: 'hold', pose: [...position_m, ...rotation] });
  }

  private ofTool(command: Extract<Command, { do: 'hold' | 'release' }>): Command {
    return this.tool === undefined ? command : { ...command, tool: this.tool };
  }

  private forget(): void {
    this.sent = null;
    this.left = this.frame?.tool.rotation ?? null;
  }

  /** Takes the tool. The first hold asks for a reply, because another client may have the tool. */
  private begin(): void {
    const wished = this.wished;
    this.sent = wished;
    this.connection.request(this.holdAt(wished)).catch((error: Error) => {
      this.drop();
      this.onRefused(error);
    });
    this.onChange();
  }
}
