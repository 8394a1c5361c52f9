// The eye that orbits the bed. Angles about the middle of the bed, and a distance; nothing else, so that a view can be
// named and found again.

import { PerspectiveCamera, Vector3 } from 'three';
import type { Scene } from '../protocol';
import type { ViewName } from '../settings';

interface View {
  azimuth_deg: number;
  elevation_deg: number;
}

// Azimuth 0 looks along +y, from the front; it turns against the clock seen from above.
const VIEWS: Record<ViewName, View> = {
  front: { azimuth_deg: 0, elevation_deg: 9 },
  side: { azimuth_deg: 90, elevation_deg: 9 },
  top: { azimuth_deg: 0, elevation_deg: 89.5 },
  'three-quarter': { azimuth_deg: 32, elevation_deg: 22.5 },
};

const FIELD_OF_VIEW_DEG = 40;
// The eye looks a little over the bed: the tool works above it, and the horizon tells what is level.
const LOOK_OVER_DEG = 5;
const LARGEST_FIT_TOOLS = 7;
const LOWEST_DEG = 2;
const HIGHEST_DEG = 89.5;
const TURN_S = 0.35;
const DEGREES = Math.PI / 180;

/** Above this elevation one looks onto the bed from above, and the mouse moves the tool level instead of upright. */
export const FROM_ABOVE_DEG = 52;

export class OrbitCamera {
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 0.01, 100);
  azimuth_deg = VIEWS['three-quarter'].azimuth_deg;
  elevation_deg = VIEWS['three-quarter'].elevation_deg;
  private readonly target_m = new Vector3(0, 0, 0.03);
  private readonly aside_m = new Vector3();
  private fitted_m = 0.5;
  private zoom = 1;
  private box_m = 0.126;
  private width_m = 0.126;
  private height_m = 0.06;
  private view: ViewName = 'three-quarter';
  private turn: { from: View & { zoom: number }; to: View & { zoom: number }; start_ms: number } | null = null;

  constructor() {
    this.camera.up.set(0, 0, 1);
  }

  setScene(scene: Scene): void {
    // Of a box much larger than the tool only the middle is shown at first: what matters happens at the tool.
    const tool_m = Math.max(...scene.tool.size_mm.slice(0, 2), scene.tool.diameter_mm) / 1000;
    const box_m = Math.max(scene.box.width_m, scene.box.length_m);
    this.box_m = box_m;
    this.width_m = Math.min(box_m, Math.max(LARGEST_FIT_TOOLS * tool_m, 0.25 * box_m));
    this.height_m = scene.box.surface_m;
    this.fit();
  }

  setAspect(aspect: number): void {
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    this.fit();
  }

  setView(name: ViewName, animate: boolean): void {
    this.view = name;
    this.aside_m.set(0, 0, 0);
    const to = { ...VIEWS[name], zoom: 1 };
    if (!animate) {
      this.turn = null;
      Object.assign(this, { azimuth_deg: to.azimuth_deg, elevation_deg: to.elevation_deg, zoom: 1 });
      this.apply();
      return;
    }
    // The short way round.
    const azimuth_deg = this.azimuth_deg - 360 * Math.round((this.azimuth_deg - to.azimuth_deg) / 360);
    const from = { azimuth_deg, elevation_deg: this.elevation_deg, zoom: this.zoom };
    this.turn = { from, to, start_ms: performance.now() };
  }

  resetView(animate: boolean): void {
    this.setView(this.view, animate);
  }

  orbit(azimuth_deg: number, elevation_deg: number): void {
    this.turn = null;
    this.azimuth_deg += azimuth_deg;
    this.elevation_deg = Math.min(HIGHEST_DEG, Math.max(LOWEST_DEG, this.elevation_deg + elevation_deg));
    this.apply();
  }

  zoomBy(factor: number): void {
    this.turn = null;
    this.zoom = Math.min(8, Math.max(0.15, this.zoom * factor));
    this.apply();
  }

  /** Looks at a place beside the middle; pixels to the right and down, of a picture so high. */
  pan(right_px: number, down_px: number, height_px: number): void {
    this.turn = null;
    const scale = this.metresPerPixel(height_px);
    this.aside_m.addScaledVector(this.right(), -right_px * scale).addScaledVector(this.ahead(), down_px * scale);
    this.aside_m.clampLength(0, this.box_m / 2);
    this.apply();
  }

  /** Goes on with a turn to a named view; true while it lasts. */
  advance(now_ms: number): boolean {
    if (!this.turn) return false;
    const { from, to, start_ms } = this.turn;
    const share = Math.min(1, (now_ms - start_ms) / (1000 * TURN_S));
    const eased = share * share * (3 - 2 * share);
    this.azimuth_deg = from.azimuth_deg + eased * (to.azimuth_deg - from.azimuth_deg);
    this.elevation_deg = from.elevation_deg + eased * (to.elevation_deg - from.elevation_deg);
    this.zoom = from.zoom + eased * (to.zoom - from.zoom);
    this.apply();
    if (share >= 1) this.turn = null;
    return true;
  }

  get lookingFromAbove(): boolean {
    return this.elevation_deg > FROM_ABOVE_DEG;
  }

  /** To the right of the picture, in the scene's frame. */
  right(): Vector3 {
    const angle = this.azimuth_deg * DEGREES;
    return new Vector3(Math.cos(angle), Math.sin(angle), 0);
  }

  /** Away from the eye, level, in the scene's frame. */
  ahead(): Vector3 {
    const angle = this.azimuth_deg * DEGREES;
    return new Vector3(-Math.sin(angle), Math.cos(angle), 0);
  }

  /** How many metres at the middle of the bed one CSS pixel is. */
  metresPerPixel(height_px: number): number {
    const distance_m = this.camera.position.distanceTo(this.target_m);
    return (2 * distance_m * Math.tan((FIELD_OF_VIEW_DEG / 2) * DEGREES)) / height_px;
  }

  /** Far enough away that the box fits into the narrower side of the picture. */
  private fit(): void {
    const half_height = Math.tan((FIELD_OF_VIEW_DEG / 2) * DEGREES);
    const half_width = half_height * this.camera.aspect;
    // Seen from a corner the box is 1.4 widths wide; the tool wants as much above the bed.
    const for_width_m = (0.8 * this.width_m) / half_width;
    const for_height_m = (0.79 * this.width_m) / half_height;
    this.fitted_m = Math.max(for_width_m, for_height_m) + 0.25 * this.width_m;
    this.camera.near = 0.06 * this.fitted_m;
    this.camera.far = 400 * this.fitted_m;
    this.camera.updateProjectionMatrix();
    this.apply();
  }

  private apply(): void {
    const azimuth = this.azimuth_deg * DEGREES;
    const elevation = this.elevation_deg * DEGREES;
    this.target_m.set(this.aside_m.x, this.aside_m.y, 0.6 * this.height_m);
    const distance_m = this.fitted_m / this.zoom;
    const level_m = distance_m * Math.cos(elevation);
    this.camera.position.set(
      this.target_m.x + level_m * Math.sin(azimuth),
      this.target_m.y - level_m * Math.cos(azimuth),
      this.target_m.z + distance_m * Math.sin(elevation),
    );
    // Under the ground there is nothing to see.
    this.camera.position.z = Math.max(this.camera.position.z, 0.15 * this.height_m);
    this.camera.lookAt(this.target_m);
    this.camera.rotateX(LOOK_OVER_DEG * DEGREES * Math.cos(elevation));
    this.camera.updateMatrixWorld();
  }
}
