// A gamepad holds the tool while a stick is off centre: left stick horizontal motion, right stick height and yaw,
// triggers pitch. It vibrates with the force.

import type { OrbitCamera } from '../view/camera';
import type { Hand } from './hand';

const DEAD = 0.15;
const MOVE_M_S = 0.08;
const TURN_RAD_S = 1.4;
const RELEASE_MS = 500;
const RUMBLE_INTERVAL_MS = 60;
const FULL_RUMBLE_N = 4;

const outsideDead = (value: number | undefined): number => {
  const size = Math.abs(value ?? 0);
  return size < DEAD ? 0 : (Math.sign(value!) * (size - DEAD)) / (1 - DEAD);
};

export class GamepadHand {
  private idle_since_ms = 0;
  private rumbled_ms = 0;
  private last_ms = 0;

  constructor(
    private readonly hand: Hand,
    private readonly orbit: OrbitCamera,
    private readonly scale: () => number,
    private readonly force_n: () => number,
  ) {}

  tick(now_ms: number): void {
    const seconds = Math.min(0.1, (now_ms - this.last_ms) / 1000);
    this.last_ms = now_ms;
    const pad = navigator.getGamepads?.().find((candidate) => candidate?.connected && candidate.axes.length >= 2);
    if (!pad) return this.hand.release('gamepad');
    const [x, y, yaw, up] = [0, 1, 2, 3].map((axis) => outsideDead(pad.axes[axis])) as [number, number, number, number];
    const tilt = (pad.buttons[7]?.value ?? 0) - (pad.buttons[6]?.value ?? 0);
    if (Math.abs(x) + Math.abs(y) + Math.abs(yaw) + Math.abs(up) + Math.abs(tilt) < 0.02) {
      if (now_ms - this.idle_since_ms > RELEASE_MS) this.hand.release('gamepad');
      return;
    }
    this.idle_since_ms = now_ms;
    if (!this.hand.isHeldBy('gamepad') && !this.hand.grab('gamepad')) return;
    const step_m = MOVE_M_S * seconds * this.scale();
    // A stick pushed forward reads negative.
    const way = this.orbit.right().multiplyScalar(x).addScaledVector(this.orbit.ahead(), -y);
    this.hand.move([way.x * step_m, way.y * step_m, -up * step_m]);
    this.hand.turn([0, 0, 1], -yaw * TURN_RAD_S * seconds, 'scene');
    this.hand.turn([0, 1, 0], tilt * TURN_RAD_S * seconds, 'tool');
    this.rumble(pad, now_ms);
  }

  private rumble(pad: Gamepad, now_ms: number): void {
    const strength = Math.min(1, this.force_n() / FULL_RUMBLE_N);
    if (strength < 0.02 || now_ms - this.rumbled_ms < RUMBLE_INTERVAL_MS) return;
    this.rumbled_ms = now_ms;
    // Not every gamepad has a motor; a refused effect is not an error.
    void pad.vibrationActuator
      ?.playEffect('dual-rumble', { duration: 90, strongMagnitude: strength * strength, weakMagnitude: strength })
      .catch(() => undefined);
  }
}
