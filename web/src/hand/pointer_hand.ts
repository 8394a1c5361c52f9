// Mouse and fingers. The left button or one finger on the tool drags it; off the tool it turns the view. The right and
// the middle button and two fingers always turn the view.
//
// The drag plane depends on the view. From the side (also in the three-quarter view) it is a vertical plane that faces
// the eye, so that down means into the soil and a horizontal stroke stays horizontal. The wheel moves the tool away and
// nearer. From above it is a horizontal plane, and the wheel lowers and raises the tool. Either way the tool stays
// under the pointer.

import { Plane, Raycaster, Vector2, Vector3 } from 'three';
import { shapeOf } from '../tool_shapes';
import type { Stage } from '../view/stage';
import type { Hand } from './hand';

const GRAB_RADIUS_PX = 44;
const TURN_DEG_PER_PX = 0.35;
const FINE = 0.2;
const WHEEL_M_PER_NOTCH = 0.003;

interface Finger {
  x: number;
  y: number;
}

export class PointerHand {
  /** the left button drags the tool wherever it is pressed */
  dig_anywhere = false;
  /** false: it only turns the view */
  may_dig = true;
  private readonly fingers = new Map<number, Finger>();
  private dragging: number | null = null;
  private readonly caster = new Raycaster();

  constructor(
    private readonly stage: Stage,
    private readonly hand: Hand,
    private readonly canvas: HTMLElement,
    private readonly onTaken = (): void => {},
    /** chooses one of several tools for the hand, by its number; null: the hand has one tool */
    private readonly choose: ((tool: number) => void) | null = null,
  ) {
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.moved(event));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
      canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('auxclick', (event) => event.preventDefault());
  }

  private down(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (this.fingers.size > 1) return this.stopDragging();
    const may_grab = this.may_dig && (event.pointerType !== 'mouse' || event.button === 0);
    const under = this.dig_anywhere ? null : this.toolUnder(event, event.pointerType === 'touch' ? 1.4 : 1);
    if (may_grab && (this.dig_anywhere || under !== null)) {
      if (under !== null) this.choose?.(under);
      if (this.hand.grab('mouse')) {
        this.dragging = event.pointerId;
        this.onTaken();
      }
    }
    if (event.button === 1) event.preventDefault();
    this.showCursor(event);
  }

  private moved(event: PointerEvent): void {
    const finger = this.fingers.get(event.pointerId);
    if (!finger) return this.showCursor(event);
    const before = { ...finger };
    const spread_before = this.spread();
    finger.x = event.clientX;
    finger.y = event.clientY;
    if (this.dragging === event.pointerId) return this.drag(before, finger, event.shiftKey);
    if (event.shiftKey) {
      this.stage.orbit.pan(finger.x - before.x, finger.y - before.y, this.canvas.clientHeight);
      return this.stage.invalidate();
    }
    // Each of two fingers contributes half of the turn.
    const share = TURN_DEG_PER_PX / this.fingers.size;
    this.stage.orbit.orbit(-(finger.x - before.x) * share, (finger.y - before.y) * share);
    const spread = this.spread();
    if (spread > 0 && spread_before > 0) this.stage.orbit.zoomBy(spread / spread_before);
    this.stage.invalidate();
  }

  private up(event: PointerEvent): void {
    if (!this.fingers.delete(event.pointerId)) return;
    if (this.dragging === event.pointerId) this.stopDragging();
    this.showCursor(event);
  }

  private stopDragging(): void {
    if (this.dragging === null) return;
    this.dragging = null;
    this.hand.release('mouse');
  }

  private drag(before: Finger, now: Finger, fine: boolean): void {
    if (!this.hand.isHeldBy('mouse')) return;
    const from = this.onPlane(before);
    const to = this.onPlane(now);
    if (!from || !to) return;
    const by = to.sub(from).multiplyScalar(fine ? FINE : 1);
    this.hand.move([by.x, by.y, by.z]);
    this.stage.invalidate();
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    // Browsers may report lines or pages instead of pixels.
    const pixels = event.deltaY * (event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1);
    if (this.dragging === null || event.ctrlKey) {
      this.stage.orbit.zoomBy(Math.exp(-pixels * (event.ctrlKey ? 0.006 : 0.0012)));
      this.stage.invalidate();
      return;
    }
    const step_m = (-pixels / 100) * WHEEL_M_PER_NOTCH * this.worldScale() * (event.shiftKey ? FINE : 1);
    const way = this.stage.orbit.lookingFromAbove ? new Vector3(0, 0, 1) : this.stage.orbit.ahead();
    this.hand.move([way.x * step_m, way.y * step_m, way.z * step_m]);
  }

  /** Steps are proportional to the box, with 1 for a width of 126 mm (icra2021). */
  private worldScale(): number {
    return (this.stage.currentScene?.box.width_m ?? 0.126) / 0.126;
  }

  private spread(): number {
    if (this.fingers.size !== 2) return 0;
    const [a, b] = [...this.fingers.values()];
    return Math.hypot(a!.x - b!.x, a!.y - b!.y);
  }

  private onPlane(finger: Finger): Vector3 | null {
    const rect = this.canvas.getBoundingClientRect();
    const at = new Vector2(
      ((finger.x - rect.left) / rect.width) * 2 - 1,
      1 - ((finger.y - rect.top) / rect.height) * 2,
    );
    const orbit = this.stage.orbit;
    this.caster.setFromCamera(at, orbit.camera);
    const normal = orbit.lookingFromAbove ? new Vector3(0, 0, 1) : orbit.ahead();
    const plane = new Plane().setFromNormalAndCoplanarPoint(normal, new Vector3(...this.hand.wished.position_m));
    return this.caster.ray.intersectPlane(plane, new Vector3());
  }

  /** Returns the number of the tool under the pointer that this hand has or may choose, or null. */
  private toolUnder(event: PointerEvent, generosity: number): number | null {
    const { height } = this.canvas.getBoundingClientRect();
    const pixel_m = this.stage.orbit.metresPerPixel(height);
    let nearest: number | null = null;
    let nearest_px = Infinity;
    this.stage.tools.forEach(({ tool, pose, held_by }, i) => {
      if (i !== this.stage.own && (this.choose === null || held_by !== 0)) return;
      const { x, y } = this.stage.onScreen(pose.position_m);
      const reach_px = Math.max(GRAB_RADIUS_PX, (0.8 * shapeOf(tool).longest_m(tool)) / pixel_m) * generosity;
      const away_px = Math.hypot(event.clientX - x, event.clientY - y);
      if (away_px < Math.min(reach_px, nearest_px)) [nearest, nearest_px] = [i, away_px];
    });
    return nearest;
  }

  private showCursor(event: PointerEvent): void {
    const near =
      this.may_dig && (this.dig_anywhere || (event.pointerType === 'mouse' && this.toolUnder(event, 1) !== null));
    this.canvas.style.cursor = this.dragging !== null ? 'grabbing' : near ? 'grab' : 'default';
  }
}
