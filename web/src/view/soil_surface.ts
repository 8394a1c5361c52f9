// The soil as one surface: how a bed of far finer particles would appear from above. A particle represents soil, so its
// round top is not shown: gaps are filled and bumps smoothed. The ground around the box continues the bed at its level.
// In addition to the height, the shaders get the height of the sun's shadow over each point, and the drift of the soil
// there since the scene began, so that patterns on it move with it.
//
// Soil that the tool carries or throws is above the surface and not part of it. It is listed, as are the visible
// particles, for soil_view.ts to draw.

import { dequantise, type Scene } from 'haptolith-protocol';
import { DataTexture, DataUtils, HalfFloatType, LinearFilter, RGBAFormat, RGFormat, type Vector4 } from 'three';
import { Aloft } from './aloft';
import { blurTwice, castShadows, fillGaps, spreadGreatest } from './grid_filters';
import type { Carrier } from './height_field';
import { ballAround, HeightOrder, raiseTriangles, type Grid } from './height_grid';

const LARGEST_SIDE = 192;
const CELLS_PER_RADIUS = 3;
// Slope of the ground around the box towards a heap or a pit at its edge.
const EDGE_SLOPE = 0.8;
const MARGIN_RADII = 6;
// Maximum reach of the centres of soil that is held behind the sides.
const MOST_HELD_RADII = 2;
// With a gap below its lowest point between these limits, a particle counts less and less as part of the bed.
const LYING_RADII = 0.3;
const ALOFT_RADII = 1.5;
// Particles whose centre is deeper than this below the surface are not visible.
const SEEN_RADII = 1.6;
// Particles whose centre is less deep than this rise above the surface, or are about to.
const RISEN_RADII = 0.3;
// Width of a box corner, in which a packing of spheres leaves a hole. If at least LEVEL_SHARE of the soil around it, up
// to the second width, is level, the hole is not the result of digging. Digging within the last distance of a corner
// lowers the height to which the corner is filled.
const CORNER_RADII = 4;
const AROUND_CORNER_RADII = 6;
const LEVEL_SHARE = 0.9;
const DUG_NEAR_RADII = 2;

export class SoilSurface implements Grid {
  readonly columns: number;
  readonly rows: number;
  readonly low_x_m: number;
  readonly low_y_m: number;
  readonly width_m: number;
  readonly length_m: number;
  readonly cell_width_m: number;
  readonly cell_length_m: number;
  /** heights of the surface and of the shadow over it, and drift of the soil along x and y, all in m */
  readonly texture: DataTexture;
  /** height including stones, and smoothed; as in HeightField */
  readonly standing: DataTexture;
  top_m = 0;
  /** height of the ground around, in m */
  level_m: number;
  /** soil above the surface */
  readonly aloft: Aloft;
  /** visible particles; the first `seen_count` are valid, and the first `risen_count` rise above the surface */
  readonly seen: Uint32Array;
  seen_count = 0;
  risen_count = 0;

  /** the topmost particle of each cell */
  readonly topmost: Uint32Array;

  private readonly bed: Float32Array;
  private readonly surface: Float32Array;
  private readonly shadow: Float32Array;
  private readonly scratch: Float32Array;
  private readonly wide: Float32Array;
  private readonly drift_x: Float32Array;
  private readonly drift_y: Float32Array;
  private readonly halves: Uint16Array;
  private readonly standing_halves: Uint16Array;
  private readonly order = new HeightOrder();
  /** initial x and y of each particle */
  private readonly from_m: Float32Array;
  private from_known = false;
  /** distance along x and y to which centres of held soil extend beyond the box, in m */
  private readonly held_m: [x: number, y: number] = [0, 0];
  /** initial heights, with the holes in the corners */
  private first_bed: Float32Array | null = null;
  private first_level_m = 0;
  /** cells of the corners without digging at the start */
  private corner_cells: number[] = [];

  constructor(
    private readonly scene: Scene,
    private readonly radii_m: Float32Array,
    private readonly to_sun: { x: number; y: number; z: number },
  ) {
    const finest_m = radii_m.reduce((least, radius_m) => Math.min(least, radius_m), scene.radius_m);
    const margin_m = MARGIN_RADII * scene.radius_m;
    this.level_m = scene.box.surface_m;
    this.width_m = scene.box.width_m + 2 * margin_m;
    this.length_m = scene.box.length_m + 2 * margin_m;
    this.low_x_m = -this.width_m / 2;
    this.low_y_m = -this.length_m / 2;
    const cell_m = Math.max(Math.max(this.width_m, this.length_m) / LARGEST_SIDE, finest_m / CELLS_PER_RADIUS);
    this.columns = Math.max(8, Math.ceil(this.width_m / cell_m));
    this.rows = Math.max(8, Math.ceil(this.length_m / cell_m));
    this.cell_width_m = this.width_m / this.columns;
    this.cell_length_m = this.length_m / this.rows;
    const cells = this.columns * this.rows;
    const heights = (): Float32Array => new Float32Array(cells);
    [this.bed, this.surface, this.shadow, this.scratch, this.wide] = [
      heights(),
      heights(),
      heights(),
      heights(),
      heights(),
    ];
    [this.drift_x, this.drift_y] = [heights(), heights()];
    this.topmost = new Uint32Array(cells);
    this.aloft = new Aloft(radii_m.length);
    this.seen = new Uint32Array(radii_m.length);
    this.from_m = new Float32Array(2 * radii_m.length);
    this.halves = new Uint16Array(4 * cells);
    this.standing_halves = new Uint16Array(2 * cells);
    this.texture = new DataTexture(this.halves, this.columns, this.rows, RGBAFormat, HalfFloatType);
    this.standing = new DataTexture(this.standing_halves, this.columns, this.rows, RGFormat, HalfFloatType);
    for (const texture of [this.texture, this.standing]) texture.magFilter = texture.minFilter = LinearFilter;
  }

  /** Builds the surface, as HeightField.build; `thickness_m` is that of a tool, and not a gap between soil above and
   * below it. */
  build(
    records: Uint16Array,
    particles: number,
    carriers: readonly (Carrier & { thickness_m: number })[] = [],
    stones_m: readonly Float32Array[] = [],
  ): void {
    const first = !this.from_known;
    if (first) this.rememberPlaces(records, particles);
    this.order.sort(records, particles);
    this.lay(records, particles, carriers);
    this.extend();
    const radius_m = this.scene.radius_m;
    fillGaps(this.bed, this.scratch, this, 0.9 * radius_m);
    if (first) this.rememberCorners();
    this.fillCorners();
    this.blur(this.bed, this.surface, 0.55 * radius_m);
    if (first) this.findLevel();
    this.meetGround();
    this.blur(this.drift_x, this.drift_x, 0.6 * radius_m);
    this.blur(this.drift_y, this.drift_y, 0.6 * radius_m);
    this.blur(this.surface, this.wide, 1.6 * radius_m);
    this.findSeen(records, particles);
    // From here on, `bed` includes stones.
    this.bed.set(this.surface);
    this.aloft.gather();
    for (const triangles_m of stones_m) this.layStone(triangles_m);
    castShadows(this.bed, this.shadow, this, this.to_sun);
    this.upload();
  }

  /** Returns the height of the surface at a point, in m; that of the level ground outside the field. */
  heightAt(x_m: number, y_m: number): number {
    const column = Math.floor((x_m - this.low_x_m) / this.cell_width_m);
    const row = Math.floor((y_m - this.low_y_m) / this.cell_length_m);
    if (column < 0 || row < 0 || column >= this.columns || row >= this.rows) return this.level_m;
    return this.surface[row * this.columns + column]!;
  }

  /** Whether a point of the surface is in shadow. */
  isShaded(x_m: number, y_m: number): boolean {
    const column = Math.floor((x_m - this.low_x_m) / this.cell_width_m);
    const row = Math.floor((y_m - this.low_y_m) / this.cell_length_m);
    const at = row * this.columns + column;
    return this.shadow[at]! > this.surface[at]!;
  }

  /** Spheres that cast the shadow of soil aloft, as in HeightField. */
  get flying_m(): Vector4[] {
    return this.aloft.balls_m;
  }

  get flying_count(): number {
    return this.aloft.ball_count;
  }

  dispose(): void {
    this.texture.dispose();
    this.standing.dispose();
  }

  private rememberPlaces(records: Uint16Array, particles: number): void {
    const { low_m, high_m } = this.scene.quantised;
    for (let i = 0; i < particles; ++i) {
      this.from_m[2 * i] = dequantise(records[4 * i]!, low_m[0], high_m[0]);
      this.from_m[2 * i + 1] = dequantise(records[4 * i + 1]!, low_m[1], high_m[1]);
    }
    this.from_known = true;
    const sides_m = [this.scene.box.width_m, this.scene.box.length_m];
    const most_m = MOST_HELD_RADII * this.scene.radius_m;
    this.from_m.forEach((at_m, k) => {
      const axis = k % 2;
      this.held_m[axis] = Math.min(most_m, Math.max(this.held_m[axis]!, Math.abs(at_m) - sides_m[axis]! / 2));
    });
  }

  /** Raises the bed to the round tops of the particles; lists those without support. */
  private lay(records: Uint16Array, particles: number, carriers: readonly (Carrier & { thickness_m: number })[]): void {
    const { bed, drift_x, drift_y, columns, rows, low_x_m, low_y_m, cell_width_m: dx, cell_length_m: dy } = this;
    const { low_m, high_m } = this.scene.quantised;
    bed.fill(0);
    drift_x.fill(0);
    drift_y.fill(0);
    this.aloft.clear();
    for (let nth = 0; nth < particles; ++nth) {
      const i = this.order.index[nth]!;
      const radius_m = this.radii_m[i]!;
      const x_m = dequantise(records[4 * i]!, low_m[0], high_m[0]);
      const y_m = dequantise(records[4 * i + 1]!, low_m[1], high_m[1]);
      const z_m = dequantise(records[4 * i + 2]!, low_m[2], high_m[2]);
      const lies = this.liesOnBed(x_m, y_m, z_m, radius_m, carriers);
      if (lies < 0.5) this.aloft.add(i, x_m, y_m, z_m, radius_m);
      if (lies <= 0) continue;
      const x = x_m - low_x_m;
      const y = y_m - low_y_m;
      const first_column = Math.max(0, Math.ceil((x - radius_m) / dx - 0.5));
      const last_column = Math.min(columns - 1, Math.floor((x + radius_m) / dx - 0.5));
      const first_row = Math.max(0, Math.ceil((y - radius_m) / dy - 0.5));
      const last_row = Math.min(rows - 1, Math.floor((y + radius_m) / dy - 0.5));
      const drift_x_m = x_m - this.from_m[2 * i]!;
      const drift_y_m = y_m - this.from_m[2 * i + 1]!;
      for (let row = first_row; row <= last_row; ++row) {
        const off_y = (row + 0.5) * dy - y;
        const left = radius_m * radius_m - off_y * off_y;
        for (let column = first_column; column <= last_column; ++column) {
          const off_x = (column + 0.5) * dx - x;
          const rest = left - off_x * off_x;
          if (rest <= 0) continue;
          const at = row * columns + column;
          const rise_m = z_m + Math.sqrt(rest) - bed[at]!;
          if (rise_m <= 0) continue;
          bed[at]! += lies * rise_m;
          this.topmost[at] = i;
          drift_x[at] = drift_x_m;
          drift_y[at] = drift_y_m;
        }
      }
    }
  }

  /** Returns 1 on the soil added so far, 0 above it; a smooth transition between them avoids a jump of the bed. */
  private liesOnBed(
    x_m: number,
    y_m: number,
    z_m: number,
    radius_m: number,
    carriers: readonly (Carrier & { thickness_m: number })[],
  ): number {
    let below_m = 0;
    for (let i = 0; i < 5; ++i) {
      const column = Math.floor((x_m + 0.7 * radius_m * PROBES[2 * i]! - this.low_x_m) / this.cell_width_m);
      const row = Math.floor((y_m + 0.7 * radius_m * PROBES[2 * i + 1]! - this.low_y_m) / this.cell_length_m);
      if (column < 0 || row < 0 || column >= this.columns || row >= this.rows) continue;
      below_m = Math.max(below_m, this.bed[row * this.columns + column]!);
    }
    let gap_m = z_m - radius_m - below_m;
    for (const carrier of carriers) {
      const [x, y, z] = carrier.at_m;
      if (Math.hypot(x_m - x, y_m - y, z_m - z) < carrier.radius_m + radius_m) gap_m -= carrier.thickness_m;
    }
    const share = (gap_m / radius_m - LYING_RADII) / (ALOFT_RADII - LYING_RADII);
    const bounded = Math.min(1, Math.max(0, share));
    return 1 - bounded * bounded * (3 - 2 * bounded);
  }

  /** Continues the bed into the ground around it. Higher soil that is held or heaped behind the box's sides is kept. */
  private extend(): void {
    const inset_m = 0.8 * this.scene.radius_m;
    const { columns, rows, bed, drift_x, drift_y, topmost } = this;
    const first_column = Math.ceil((-this.scene.box.width_m / 2 + inset_m - this.low_x_m) / this.cell_width_m);
    const first_row = Math.ceil((-this.scene.box.length_m / 2 + inset_m - this.low_y_m) / this.cell_length_m);
    const last_column = columns - 1 - first_column;
    const last_row = rows - 1 - first_row;
    for (let row = 0; row < rows; ++row) {
      const from_row = Math.min(last_row, Math.max(first_row, row));
      for (let column = 0; column < columns; ++column) {
        const from_column = Math.min(last_column, Math.max(first_column, column));
        const [at, from] = [row * columns + column, from_row * columns + from_column];
        const out_m = Math.hypot((column - from_column) * this.cell_width_m, (row - from_row) * this.cell_length_m);
        const above_m = bed[from]! - this.level_m;
        const carried_m = bed[from]! - Math.min(Math.max(0, above_m), EDGE_SLOPE * Math.max(0, out_m - inset_m));
        if (bed[at]! >= carried_m) continue;
        bed[at] = carried_m;
        drift_x[at] = drift_x[from]!;
        drift_y[at] = drift_y[from]!;
        topmost[at] = topmost[from]!;
      }
    }
  }

  /** Stores the initial bed, and which of its corners are undisturbed. */
  private rememberCorners(): void {
    const { box, radius_m } = this.scene;
    if (box.periodic_x || box.periodic_y) return;
    const inside = this.bed.filter((_, at) => Math.min(...this.fromEdges_m(at)) > 0).sort();
    const median_m = inside[inside.length >> 1] ?? box.surface_m;
    this.first_level_m = Math.abs(median_m - box.surface_m) < 2 * radius_m ? median_m : box.surface_m;
    const [level, around] = [
      [0, 0, 0, 0],
      [0, 0, 0, 0],
    ];
    this.bed.forEach((height_m, at) => {
      const corner = this.cornerOf(at, AROUND_CORNER_RADII);
      if (corner < 0 || this.cornerOf(at, CORNER_RADII) >= 0) return;
      around[corner]! += 1;
      if (Math.abs(height_m - this.first_level_m) < radius_m) level[corner]! += 1;
    });
    this.bed.forEach((_, at) => {
      const corner = this.cornerOf(at, CORNER_RADII);
      if (corner >= 0 && level[corner]! > LEVEL_SHARE * around[corner]!) this.corner_cells.push(at);
    });
    this.first_bed = this.bed.slice();
  }

  /** Fills holes in corners up to the level bed, less the depth of later digging next to them. */
  private fillCorners(): void {
    const { first_bed, bed, wide: dug } = this;
    if (!first_bed || this.corner_cells.length === 0) return;
    for (let at = 0; at < bed.length; ++at) dug[at] = Math.max(0, first_bed[at]! - bed[at]!);
    spreadGreatest(dug, this.scratch, this, DUG_NEAR_RADII * this.scene.radius_m);
    for (const at of this.corner_cells) bed[at] = Math.max(bed[at]!, this.first_level_m - dug[at]!);
  }

  /** Returns the index of the corner that contains a cell, with the ground beyond it; -1: none. Corners are squares. */
  private cornerOf(at: number, radii: number): number {
    if (Math.max(...this.fromEdges_m(at)) >= radii * this.scene.radius_m) return -1;
    return (at % this.columns < this.columns / 2 ? 0 : 1) + (at < (this.columns * this.rows) / 2 ? 0 : 2);
  }

  /** Returns the distance of a cell inside the edges along x and y; negative outside. */
  private fromEdges_m(at: number): [x_m: number, y_m: number] {
    const x_m = this.low_x_m + ((at % this.columns) + 0.5) * this.cell_width_m;
    const y_m = this.low_y_m + (Math.floor(at / this.columns) + 0.5) * this.cell_length_m;
    return [this.scene.box.width_m / 2 - Math.abs(x_m), this.scene.box.length_m / 2 - Math.abs(y_m)];
  }

  private blur(from: Float32Array, to: Float32Array, reach_m: number): void {
    blurTwice(from, to, this.scratch, this, reach_m);
  }

  /** Computes the level: about the height of the particles' tops, which smoothing lowers slightly. */
  private findLevel(): void {
    const { columns, rows } = this;
    const inside = this.surface.filter((_, at) => {
      const across = Math.abs((at % columns) - columns / 2) * this.cell_width_m;
      const along = Math.abs(Math.floor(at / columns) - rows / 2) * this.cell_length_m;
      return across < 0.45 * this.scene.box.width_m && along < 0.45 * this.scene.box.length_m;
    });
    const median_m = inside.sort()[inside.length >> 1]!;
    if (Math.abs(median_m - this.level_m) < 2 * this.scene.radius_m) this.level_m = median_m;
  }

  /** Blends heaps and pits next to the box into the level ground. */
  private meetGround(): void {
    const { columns, rows, surface } = this;
    const { width_m, length_m } = this.scene.box;
    const [held_x_m, held_y_m] = this.held_m;
    const margin_m = MARGIN_RADII * this.scene.radius_m;
    const outside = (x_m: number, y_m: number): number => Math.hypot(Math.max(0, x_m), Math.max(0, y_m));
    for (let row = 0; row < rows; ++row) {
      const beyond_y_m = Math.abs(this.low_y_m + (row + 0.5) * this.cell_length_m) - length_m / 2;
      for (let column = 0; column < columns; ++column) {
        const beyond_x_m = Math.abs(this.low_x_m + (column + 0.5) * this.cell_width_m) - width_m / 2;
        const beyond_m = outside(beyond_x_m, beyond_y_m);
        if (beyond_m === 0) continue;
        const at = row * columns + column;
        const share = Math.min(1, beyond_m / (margin_m - 2 * this.cell_width_m));
        const above_m = surface[at]! - this.level_m;
        // Heaps rest on held soil, which is not dug: pits end at the box.
        const sloping_m = above_m > 0 ? outside(beyond_x_m - held_x_m, beyond_y_m - held_y_m) : beyond_m;
        const left_m = Math.max(0, Math.abs(above_m) - EDGE_SLOPE * sloping_m) * (1 - share * share);
        surface[at] = this.level_m + Math.sign(above_m) * left_m;
        const kept = 1 - share * share * (3 - 2 * share);
        this.drift_x[at]! *= kept;
        this.drift_y[at]! *= kept;
      }
    }
  }

  private findSeen(records: Uint16Array, particles: number): void {
    const { low_m, high_m } = this.scene.quantised;
    this.seen_count = this.risen_count = 0;
    for (let i = 0; i < particles; ++i) {
      const z_m = dequantise(records[4 * i + 2]!, low_m[2], high_m[2]);
      const x_m = dequantise(records[4 * i]!, low_m[0], high_m[0]);
      const y_m = dequantise(records[4 * i + 1]!, low_m[1], high_m[1]);
      const over = (z_m - this.heightAt(x_m, y_m)) / this.radii_m[i]!;
      if (over <= -SEEN_RADII) continue;
      this.seen[this.seen_count] = i;
      if (over > -RISEN_RADII) {
        this.seen[this.seen_count] = this.seen[this.risen_count]!;
        this.seen[this.risen_count++] = i;
      }
      ++this.seen_count;
    }
  }

  /** Raises the heights to a stone; a flying stone is listed instead, and replaces the last sphere if the list is
   * full. */
  private layStone(triangles_m: Float32Array): void {
    const ball = ballAround(triangles_m);
    if (ball.lowest_m - this.heightAt(ball.x_m, ball.y_m) <= this.scene.radius_m)
      return raiseTriangles(triangles_m, this.bed, this);
    this.aloft.addBall(ball.x_m, ball.y_m, ball.z_m, ball.radius_m);
  }

  private upload(): void {
    const { surface, shadow, drift_x, drift_y, bed, wide, halves, standing_halves } = this;
    let top_m = 0;
    for (let i = 0; i < surface.length; ++i) {
      halves[4 * i] = DataUtils.toHalfFloat(surface[i]!);
      halves[4 * i + 1] = DataUtils.toHalfFloat(shadow[i]!);
      halves[4 * i + 2] = DataUtils.toHalfFloat(drift_x[i]!);
      halves[4 * i + 3] = DataUtils.toHalfFloat(drift_y[i]!);
      standing_halves[2 * i] = DataUtils.toHalfFloat(bed[i]!);
      standing_halves[2 * i + 1] = DataUtils.toHalfFloat(wide[i]!);
      if (bed[i]! > top_m) top_m = bed[i]!;
    }
    this.top_m = top_m;
    this.texture.needsUpdate = true;
    this.standing.needsUpdate = true;
  }
}

const PROBES = [0, 0, 1, 0, -1, 0, 0, 1, 0, -1];
