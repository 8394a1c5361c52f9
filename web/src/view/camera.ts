// The eye that orbits the bed. Its state is only angles about the centre of the bed and a distance, so that a view can
// be named and restored.

import type { Scene } from 'haptolith-protocol';
import { PerspectiveCamera, Vector3 } from 'three';
import type { ViewName } from '../settings';
import { BoxView } from './box_view';

interface View {
  azimuth_deg: number;
  elevation_deg: number;
}

interface Fit {
  distance_m: number;
  target_z_m: number;
}

type Place = View & Fit & { zoom: number };

/** Position of an eye that the user has moved. */
export interface EyePlace extends View {
  zoom: number;
  /** horizontal offset from the centre of the bed */
  aside_m: [x: number, y: number];
}

interface Extent {
  width_m: number;
  length_m: number;
  surface_m: number;
  /** height of the drawn walls */
  wall_m: number;
}

// Azimuth 0 looks along +y, from the front; it increases counter-clockwise seen from above.
const VIEWS: Record<ViewName, View> = {
  front: { azimuth_deg: 0, elevation_deg: 9 },
  side: { azimuth_deg: 90, elevation_deg: 9 },
  top: { azimuth_deg: 0, elevation_deg: 89.5 },
  'three-quarter': { azimuth_deg: 32, elevation_deg: 22.5 },
};

// A pit in level ground is visible only from above; from much higher the horizon is not visible.
const IN_GROUND_DEG = 18;

const FIELD_OF_VIEW_DEG = 40;
// The eye looks slightly over the bed: the tool works above it, and the horizon shows the horizontal.
const LOOK_OVER_DEG = 5;
// Fraction of the free picture's width or height that the box fills in a named view, whichever is reached first.
const FILLED = 0.65;
// Height of a raised tool that fits into the picture above the box.
const RAISED_TOOL_M = 0.12;
const LOWEST_DEG = 2;
const HIGHEST_DEG = 89.5;
const SMALLEST_ZOOM = 0.15;
const LARGEST_ZOOM = 8;
const TURN_S = 0.35;
const DEGREES = Math.PI / 180;
const HALF_HEIGHT = Math.tan((FIELD_OF_VIEW_DEG / 2) * DEGREES);

/** Above this elevation the view counts as from above, and the mouse moves the tool horizontally instead of
 * vertically. */
export const FROM_ABOVE_DEG = 52;

export class OrbitCamera {
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 0.01, 100);
  azimuth_deg = VIEWS['three-quarter'].azimuth_deg;
  elevation_deg = VIEWS['three-quarter'].elevation_deg;
  /** centre of the orbit */
  private readonly target_m = new Vector3(0, 0, 0.03);
  private readonly aside_m = new Vector3();
  /** values that show the complete box in the named view */
  private fitted: Fit = { distance_m: 0.5, target_z_m: 0.03 };
  /** current values: `fitted`, except during a turn to another view */
  private shown: Fit = this.fitted;
  private zoom = 1;
  private covered = 0;
  private box: Extent = { width_m: 0.126, length_m: 0.126, surface_m: 0.04, wall_m: 0.06 };
  private view: ViewName = 'three-quarter';
  private moved = false;
  private in_ground = false;
  private turn: { from: Place; to: Place; start_ms: number } | null = null;

  constructor() {
    this.camera.up.set(0, 0, 1);
    this.fit();
  }

  setScene(scene: Scene): void {
    const { width_m, length_m, surface_m } = scene.box;
    const box = { width_m, length_m, surface_m, wall_m: BoxView.wallHeight(scene) };
    if (JSON.stringify(box) === JSON.stringify(this.box)) return;
    this.box = box;
    this.aside_m.clampLength(0, this.longest_m / 2);
    this.fit();
  }

  /** Sets whether the ground is at the level of the soil, instead of below the box. */
  setInGround(in_ground: boolean): void {
    if (in_ground === this.in_ground) return;
    this.in_ground = in_ground;
    if (this.moved) this.fit();
    else this.setView(this.view, false);
  }

  /** Sets the shape of the picture, which fits the view again, unless the user has moved the eye. `covered`:
   * fraction of its height that is covered at the top. */
  setAspect(aspect: number, covered = 0): void {
    this.camera.aspect = aspect;
    this.covered = covered;
    // Resets the field of view after use by a headset.
    this.camera.fov = FIELD_OF_VIEW_DEG;
    this.camera.updateProjectionMatrix();
    if (this.moved) this.apply();
    else this.fit();
  }

  setView(name: ViewName, animate: boolean): void {
    this.view = name;
    this.moved = false;
    const from = { ...this.shown, azimuth_deg: this.azimuth_deg, elevation_deg: this.elevation_deg, zoom: this.zoom };
    this.aside_m.set(0, 0, 0);
    this.zoom = 1;
    this.turn = null;
    Object.assign(this, this.viewOf(name));
    this.fit();
    if (!animate) return;
    // Turns the short way round.
    from.azimuth_deg -= 360 * Math.round((from.azimuth_deg - this.azimuth_deg) / 360);
    this.turn = { from, to: { ...this.fitted, ...this.viewOf(name), zoom: 1 }, start_ms: performance.now() };
    this.go(from);
  }

  /** Position to which the user has moved the eye; null: a named view. */
  get moved_to(): EyePlace | null {
    const { azimuth_deg, elevation_deg, zoom, aside_m } = this;
    return this.moved ? { azimuth_deg, elevation_deg, zoom, aside_m: [aside_m.x, aside_m.y] } : null;
  }

  moveTo(place: EyePlace): void {
    this.takeOver();
    this.azimuth_deg = place.azimuth_deg;
    this.elevation_deg = Math.min(HIGHEST_DEG, Math.max(LOWEST_DEG, place.elevation_deg));
    this.zoom = Math.min(LARGEST_ZOOM, Math.max(SMALLEST_ZOOM, place.zoom));
    this.aside_m.set(place.aside_m[0], place.aside_m[1], 0).clampLength(0, this.longest_m / 2);
    this.apply();
  }

  resetView(animate: boolean): void {
    this.setView(this.view, animate);
  }

  orbit(azimuth_deg: number, elevation_deg: number): void {
    this.takeOver();
    this.azimuth_deg += azimuth_deg;
    this.elevation_deg = Math.min(HIGHEST_DEG, Math.max(LOWEST_DEG, this.elevation_deg + elevation_deg));
    this.apply();
  }

  zoomBy(factor: number): void {
    this.takeOver();
    this.zoom = Math.min(LARGEST_ZOOM, Math.max(SMALLEST_ZOOM, this.zoom * factor));
    this.apply();
  }

  /** Moves the point of view horizontally, by pixels to the right and down in a picture of a height. */
  pan(right_px: number, down_px: number, height_px: number): void {
    this.takeOver();
    const scale = this.metresPerPixel(height_px);
    this.aside_m.addScaledVector(this.right(), -right_px * scale).addScaledVector(this.ahead(), down_px * scale);
    this.aside_m.clampLength(0, this.longest_m / 2);
    this.apply();
  }

  /** Advances a turn to a named view; true while it lasts. */
  advance(now_ms: number): boolean {
    if (!this.turn) return false;
    const { from, to, start_ms } = this.turn;
    const share = Math.min(1, (now_ms - start_ms) / (1000 * TURN_S));
    const eased = share * share * (3 - 2 * share);
    const between = (key: keyof Place): number => from[key] + eased * (to[key] - from[key]);
    this.go({
      azimuth_deg: between('azimuth_deg'),
      elevation_deg: between('elevation_deg'),
      zoom: between('zoom'),
      distance_m: between('distance_m'),
      target_z_m: between('target_z_m'),
    });
    if (share >= 1) this.turn = null;
    return true;
  }

  get lookingFromAbove(): boolean {
    return this.elevation_deg > FROM_ABOVE_DEG;
  }

  /** Returns the direction to the right of the picture, in the scene's frame. */
  right(): Vector3 {
    const angle = this.azimuth_deg * DEGREES;
    return new Vector3(Math.cos(angle), Math.sin(angle), 0);
  }

  /** Returns the horizontal direction away from the eye, in the scene's frame. */
  ahead(): Vector3 {
    const angle = this.azimuth_deg * DEGREES;
    return new Vector3(-Math.sin(angle), Math.cos(angle), 0);
  }

  /** Returns the length of one CSS pixel at the centre of the bed, in m. */
  metresPerPixel(height_px: number): number {
    const middle_m = new Vector3(this.aside_m.x, this.aside_m.y, 0.6 * this.box.surface_m);
    const distance_m = this.camera.position.distanceTo(middle_m);
    return (2 * distance_m * HALF_HEIGHT) / height_px;
  }

  /** Returns the length of the picture's shorter side at the centre of the bed, in m; in a headset, that of a usual
   * picture. */
  shorterSide_m(in_headset: boolean): number {
    return in_headset ? 1.6 * this.longest_m : this.metresPerPixel(1) * Math.min(1, this.camera.aspect);
  }

  private get longest_m(): number {
    return Math.max(this.box.width_m, this.box.length_m);
  }

  /** Ends a turn, because the user moves the eye: it stays at the last position. */
  private takeOver(): void {
    this.turn = null;
    this.moved = true;
  }

  private viewOf(name: ViewName): View {
    const { azimuth_deg, elevation_deg } = VIEWS[name];
    return { azimuth_deg, elevation_deg: this.in_ground ? Math.max(IN_GROUND_DEG, elevation_deg) : elevation_deg };
  }

  /** Computes the position from which the named view shows the complete box. */
  private fit(): void {
    const view = this.viewOf(this.view);
    const { azimuth_deg, elevation_deg, zoom, shown } = this;
    const aside_m = this.aside_m.clone();
    Object.assign(this, { ...view, zoom: 1 });
    this.aside_m.set(0, 0, 0);
    // Finds the nearest distance at which everything fits, because objects appear larger from near.
    const longest_m = this.longest_m + this.box.wall_m;
    let near_m = 0.6 * longest_m;
    let far_m = near_m + 20 * longest_m * Math.max(1, 1 / this.camera.aspect);
    for (let i = 0; i < 24; ++i) {
      const distance_m = (near_m + far_m) / 2;
      this.shown = { distance_m, target_z_m: this.centred(distance_m) };
      this.apply();
      const { box, above } = this.extentInPicture();
      const free = 2 - 2 * this.covered - Math.max(0, above - box.top);
      const fits = box.aside <= FILLED && box.top - box.bottom <= FILLED * free;
      if (fits) far_m = distance_m;
      else near_m = distance_m;
    }
    this.fitted = { distance_m: far_m, target_z_m: this.centred(far_m) };
    this.camera.near = 0.06 * far_m;
    this.camera.far = 400 * far_m;
    this.camera.updateProjectionMatrix();
    Object.assign(this, { azimuth_deg, elevation_deg, zoom, shown });
    this.aside_m.copy(aside_m);
    if (this.turn) Object.assign(this.turn.to, this.fitted);
    else this.shown = this.fitted;
    this.apply();
  }

  /** Returns the height of the target at which box and raised tool together are centred in the picture. */
  private centred(distance_m: number): number {
    let low_m = -distance_m;
    let high_m = distance_m;
    for (let i = 0; i < 24; ++i) {
      const target_z_m = (low_m + high_m) / 2;
      this.shown = { distance_m, target_z_m };
      this.apply();
      const { box, above } = this.extentInPicture();
      if (above + box.bottom > -2 * this.covered) low_m = target_z_m;
      else high_m = target_z_m;
    }
    return (low_m + high_m) / 2;
  }

  /** Returns the extent of box and raised tool in the picture, whose edges are at -1 and 1. */
  private extentInPicture(): { box: { aside: number; bottom: number; top: number }; above: number } {
    const into_camera = this.camera.matrixWorldInverse;
    const at_m = new Vector3();
    const box = { aside: 0, bottom: Infinity, top: -Infinity };
    const look = (x_m: number, y_m: number, z_m: number): { x: number; y: number } => {
      at_m.set(x_m, y_m, z_m).applyMatrix4(into_camera);
      const depth_m = Math.max(1e-3 * this.longest_m, -at_m.z);
      return { x: at_m.x / (depth_m * HALF_HEIGHT * this.camera.aspect), y: at_m.y / (depth_m * HALF_HEIGHT) };
    };
    const { width_m, length_m, wall_m } = this.box;
    // In the ground, neither the box below it nor its walls are visible.
    const [low_m, high_m] = this.in_ground ? [this.box.surface_m, this.box.surface_m] : [0, wall_m];
    for (let corner = 0; corner < 8; ++corner) {
      const sign = (bit: number): number => (corner & bit ? 0.5 : -0.5);
      const { x, y } = look(sign(1) * width_m, sign(2) * length_m, corner & 4 ? high_m : low_m);
      box.aside = Math.max(box.aside, Math.abs(x));
      box.bottom = Math.min(box.bottom, y);
      box.top = Math.max(box.top, y);
    }
    return { box, above: Math.max(box.top, look(0, 0, RAISED_TOOL_M).y) };
  }

  private go({ azimuth_deg, elevation_deg, zoom, distance_m, target_z_m }: Place): void {
    Object.assign(this, { azimuth_deg, elevation_deg, zoom, shown: { distance_m, target_z_m } });
    this.apply();
  }

  private apply(): void {
    const azimuth = this.azimuth_deg * DEGREES;
    const elevation = this.elevation_deg * DEGREES;
    this.target_m.set(this.aside_m.x, this.aside_m.y, this.shown.target_z_m);
    const distance_m = this.shown.distance_m / this.zoom;
    const level_m = distance_m * Math.cos(elevation);
    this.camera.position.set(
      this.target_m.x + level_m * Math.sin(azimuth),
      this.target_m.y - level_m * Math.cos(azimuth),
      this.target_m.z + distance_m * Math.sin(elevation),
    );
    // The eye stays above the ground.
    const lowest_m = this.in_ground ? 1.2 * this.box.surface_m : 0.15 * this.box.surface_m;
    this.camera.position.z = Math.max(this.camera.position.z, lowest_m);
    this.camera.lookAt(this.target_m);
    this.camera.rotateX(LOOK_OVER_DEG * DEGREES * Math.cos(elevation));
    this.camera.updateMatrixWorld();
  }
}
