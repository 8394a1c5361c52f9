// The tool by keys: arrows move it horizontally as seen; page up and page down raise and lower it. Q E yaw, W S pitch
// and A D roll it. While the mouse holds the tool, keys add to its motion. The tool is released shortly after the last
// key.

import type { Vec3 } from 'haptolith-protocol';
import type { OrbitCamera } from '../view/camera';
import type { Hand } from './hand';

const TURN_RAD_S = (80 * Math.PI) / 180;
const MOVE_M_S = 0.06;
const FINE = 0.2;
const RELEASE_MS = 350;

const TURNS: Record<string, { axis: Vec3; frame: 'scene' | 'tool'; sign: number }> = {
  KeyQ: { axis: [0, 0, 1], frame: 'scene', sign: 1 },
  KeyE: { axis: [0, 0, 1], frame: 'scene', sign: -1 },
  KeyW: { axis: [0, 1, 0], frame: 'tool', sign: 1 },
  KeyS: { axis: [0, 1, 0], frame: 'tool', sign: -1 },
  KeyA: { axis: [1, 0, 0], frame: 'tool', sign: -1 },
  KeyD: { axis: [1, 0, 0], frame: 'tool', sign: 1 },
};

const MOVES = new Set(['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'PageUp', 'PageDown']);

export class KeyHand {
  private readonly pressed = new Set<string>();
  /** released since the last frame: a short tap still counts for one frame */
  private readonly released = new Set<string>();
  private fine = false;
  private idle_since_ms = 0;
  private last_ms = 0;

  constructor(
    private readonly hand: Hand,
    private readonly orbit: OrbitCamera,
    private readonly scale: () => number,
  ) {
    addEventListener('blur', () => this.pressed.clear());
    document.addEventListener('visibilitychange', () => this.pressed.clear());
  }

  /** Handles a pressed key; true when it moves the tool. */
  down(event: KeyboardEvent): boolean {
    this.fine = event.shiftKey;
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (!(event.code in TURNS) && !MOVES.has(event.code)) return false;
    this.pressed.add(event.code);
    this.released.delete(event.code);
    return true;
  }

  up(event: KeyboardEvent): void {
    this.fine = event.shiftKey;
    if (this.pressed.has(event.code)) this.released.add(event.code);
  }

  tick(now_ms: number): void {
    const seconds = Math.min(0.1, (now_ms - this.last_ms) / 1000);
    this.last_ms = now_ms;
    if (this.pressed.size === 0) {
      if (this.hand.isHeldBy('keys') && now_ms - this.idle_since_ms > RELEASE_MS) this.hand.release('keys');
      return;
    }
    this.idle_since_ms = now_ms;
    if (!this.hand.isHeldBy('keys') && !this.hand.grab('keys')) return this.forgetReleased();
    const pace = seconds * (this.fine ? FINE : 1);
    for (const [code, { axis, frame, sign }] of Object.entries(TURNS))
      if (this.pressed.has(code)) this.hand.turn(axis, sign * TURN_RAD_S * pace, frame);
    this.move(pace);
    this.forgetReleased();
  }

  private forgetReleased(): void {
    for (const code of this.released) this.pressed.delete(code);
    this.released.clear();
  }

  private move(pace: number): void {
    const axis = (plus: string, minus: string): number =>
      Number(this.pressed.has(plus)) - Number(this.pressed.has(minus));
    const sideways = axis('ArrowRight', 'ArrowLeft');
    const away = axis('ArrowUp', 'ArrowDown');
    const up = axis('PageUp', 'PageDown');
    if (sideways === 0 && away === 0 && up === 0) return;
    const step_m = MOVE_M_S * pace * this.scale();
    const way = this.orbit.right().multiplyScalar(sideways).addScaledVector(this.orbit.ahead(), away);
    this.hand.move([way.x * step_m, way.y * step_m, up * step_m]);
  }
}
