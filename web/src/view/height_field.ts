// How high the soil stands over each point of the floor: a small picture of the bed from above. Shaders look into it to
// find out how much sky and sun a grain sees. Each point has two heights: as it is, and smoothed over about two grains.
//
// A grain or a stone in the air is no height: below it there is light. Such ones are listed instead, for round shadows
// of their own.

import { DataTexture, DataUtils, HalfFloatType, LinearFilter, RGFormat, Vector4 } from 'three';
import { dequantise, radiiOf, type Scene, type Vec3 } from '../protocol';

const LARGEST_SIDE = 192;
// A grain is a few cells wide, enough to see its round top; more cells than this cost time without being seen.
const CELLS_PER_RADIUS = 3.5;
// With nothing so close below its lowest point, a grain flies.
const FLYING_RADII = 3;
/** More grains in the air than these cast no shadow. */
export const MOST_FLYING = 16;
const HEIGHT_BINS = 1024;

/** What carries grains though it is no soil: the sphere around the tool. */
export interface Carrier {
  at_m: Vec3;
  radius_m: number;
}

export class HeightField {
  readonly columns: number;
  readonly rows: number;
  readonly low_x_m: number;
  readonly low_y_m: number;
  readonly width_m: number;
  readonly length_m: number;
  readonly texture: DataTexture;
  /** highest point of the soil, in m */
  top_m = 0;
  /** centres and radii of the lowest of the grains in the air; the first `flying_count` are valid */
  readonly flying_m = Array.from({ length: MOST_FLYING }, () => new Vector4());
  flying_count = 0;

  private readonly cell_m: number;
  private readonly heights: Float32Array;
  private readonly smoothed: Float32Array;
  private readonly scratch: Float32Array;
  private readonly halves: Uint16Array;
  private readonly bins = new Uint32Array(HEIGHT_BINS + 1);
  private order = new Uint32Array(0);

  constructor(
    private readonly scene: Scene,
    private readonly radii_m = radiiOf(scene),
  ) {
    const finest_m = this.radii_m.reduce((least, radius_m) => Math.min(least, radius_m), scene.radius_m);
    // One grain of margin, so that the edge of the picture is bare ground and everything beyond it reads as such.
    const margin_m = 1.5 * scene.radius_m;
    this.width_m = scene.box.width_m + 2 * margin_m;
    this.length_m = scene.box.length_m + 2 * margin_m;
    this.low_x_m = -this.width_m / 2;
    this.low_y_m = -this.length_m / 2;
    this.cell_m = Math.max(Math.max(this.width_m, this.length_m) / LARGEST_SIDE, finest_m / CELLS_PER_RADIUS);
    this.columns = Math.max(4, Math.ceil(this.width_m / this.cell_m));
    this.rows = Math.max(4, Math.ceil(this.length_m / this.cell_m));
    const cells = this.columns * this.rows;
    this.heights = new Float32Array(cells);
    this.smoothed = new Float32Array(cells);
    this.scratch = new Float32Array(cells);
    this.halves = new Uint16Array(cells * 2);
    this.texture = new DataTexture(this.halves, this.columns, this.rows, RGFormat, HalfFloatType);
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearFilter;
  }

  /**
   * Builds the field from all records (four u16 a particle, as in a frame), and the triangles of each stone (nine
   * numbers a triangle, in the scene's frame).
   */
  build(
    records: Uint16Array,
    particles: number,
    carrier: Carrier | null = null,
    stones_m: readonly Float32Array[] = [],
  ): void {
    this.sort(records, particles);
    this.raise(records, particles, carrier);
    for (const triangles_m of stones_m) this.raiseStone(triangles_m);
    this.smooth();
    const { heights, smoothed, halves } = this;
    let top_m = 0;
    for (let i = 0; i < heights.length; ++i) {
      const height = heights[i]!;
      if (height > top_m) top_m = height;
      halves[2 * i] = DataUtils.toHalfFloat(height);
      halves[2 * i + 1] = DataUtils.toHalfFloat(smoothed[i]!);
    }
    this.top_m = top_m;
    this.texture.needsUpdate = true;
  }

  /** Height of the soil at a point, in m; 0 beside the field. */
  heightAt(x_m: number, y_m: number): number {
    const column = Math.floor((x_m - this.low_x_m) / this.cellWidth);
    const row = Math.floor((y_m - this.low_y_m) / this.cellLength);
    if (column < 0 || row < 0 || column >= this.columns || row >= this.rows) return 0;
    return this.heights[row * this.columns + column]!;
  }

  dispose(): void {
    this.texture.dispose();
  }

  private get cellWidth(): number {
    return this.width_m / this.columns;
  }

  private get cellLength(): number {
    return this.length_m / this.rows;
  }

  /** Orders the grains from the lowest to the highest, about. */
  private sort(records: Uint16Array, particles: number): void {
    const { bins } = this;
    if (this.order.length !== particles) this.order = new Uint32Array(particles);
    bins.fill(0);
    for (let i = 0; i < particles; ++i) bins[(records[4 * i + 2]! >> 6) + 1]! += 1;
    for (let bin = 1; bin <= HEIGHT_BINS; ++bin) bins[bin]! += bins[bin - 1]!;
    for (let i = 0; i < particles; ++i) this.order[bins[records[4 * i + 2]! >> 6]!++] = i;
  }

  /** Lays the round top of every grain that does not fly over the floor and what lies below it. */
  private raise(records: Uint16Array, particles: number, carrier: Carrier | null): void {
    const { heights, columns, rows } = this;
    const { low_m, high_m } = this.scene.quantised;
    const dx = this.cellWidth;
    const dy = this.cellLength;
    heights.fill(0);
    this.flying_count = 0;
    for (let nth = 0; nth < particles; ++nth) {
      const i = this.order[nth]!;
      const radius_m = this.radii_m[i]!;
      const squared = radius_m * radius_m;
      const x = dequantise(records[4 * i]!, low_m[0], high_m[0]) - this.low_x_m;
      const y = dequantise(records[4 * i + 1]!, low_m[1], high_m[1]) - this.low_y_m;
      const z = dequantise(records[4 * i + 2]!, low_m[2], high_m[2]);
      if (
        z - radius_m > FLYING_RADII * radius_m &&
        this.flies(x + this.low_x_m, y + this.low_y_m, z, radius_m, carrier)
      ) {
        if (this.flying_count < MOST_FLYING)
          this.flying_m[this.flying_count++]!.set(x + this.low_x_m, y + this.low_y_m, z, radius_m);
        continue;
      }
      const first_column = Math.max(0, Math.ceil((x - radius_m) / dx - 0.5));
      const last_column = Math.min(columns - 1, Math.floor((x + radius_m) / dx - 0.5));
      const first_row = Math.max(0, Math.ceil((y - radius_m) / dy - 0.5));
      const last_row = Math.min(rows - 1, Math.floor((y + radius_m) / dy - 0.5));
      for (let row = first_row; row <= last_row; ++row) {
        const off_y = (row + 0.5) * dy - y;
        const left = squared - off_y * off_y;
        for (let column = first_column; column <= last_column; ++column) {
          const off_x = (column + 0.5) * dx - x;
          const rest = left - off_x * off_x;
          if (rest <= 0) continue;
          const at = row * columns + column;
          const top = z + Math.sqrt(rest);
          if (top > heights[at]!) heights[at] = top;
        }
      }
    }
  }

  /** Lays the top of a stone over what is there, or lists it in place of the last grain when it flies. */
  private raiseStone(triangles_m: Float32Array): void {
    const ball = ballAround(triangles_m);
    if (ball.lowest_m - this.heightAt(ball.x_m, ball.y_m) > FLYING_RADII * this.scene.radius_m) {
      this.flying_count = Math.min(MOST_FLYING, this.flying_count + 1);
      this.flying_m[this.flying_count - 1]!.set(ball.x_m, ball.y_m, ball.z_m, ball.radius_m);
      return;
    }
    for (let i = 0; i < triangles_m.length; i += 9) this.raiseTriangle(triangles_m.subarray(i, i + 9));
  }

  private raiseTriangle(corners_m: Float32Array): void {
    const [ax, ay, az, bx, by, bz, cx, cy, cz] = corners_m as unknown as FixedTriangle;
    const [ux, uy, uz, vx, vy, vz] = [bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az];
    const area = ux * vy - uy * vx;
    if (area <= 0) return; // its other side is up
    const dx = this.cellWidth;
    const dy = this.cellLength;
    const first_column = Math.max(0, Math.ceil((Math.min(ax, bx, cx) - this.low_x_m) / dx - 0.5));
    const last_column = Math.min(this.columns - 1, Math.floor((Math.max(ax, bx, cx) - this.low_x_m) / dx - 0.5));
    const first_row = Math.max(0, Math.ceil((Math.min(ay, by, cy) - this.low_y_m) / dy - 0.5));
    const last_row = Math.min(this.rows - 1, Math.floor((Math.max(ay, by, cy) - this.low_y_m) / dy - 0.5));
    for (let row = first_row; row <= last_row; ++row) {
      const y = this.low_y_m + (row + 0.5) * dy - ay;
      for (let column = first_column; column <= last_column; ++column) {
        const x = this.low_x_m + (column + 0.5) * dx - ax;
        const u = (x * vy - y * vx) / area;
        const v = (ux * y - uy * x) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const at = row * this.columns + column;
        this.heights[at] = Math.max(this.heights[at]!, az + u * uz + v * vz);
      }
    }
  }

  /** Whether neither soil, of the lower grains laid so far, nor what carries is close below a grain. */
  private flies(x_m: number, y_m: number, z_m: number, radius_m: number, carrier: Carrier | null): boolean {
    if (carrier) {
      const [x, y, z] = carrier.at_m;
      if (Math.hypot(x_m - x, y_m - y, z_m - z) < carrier.radius_m + FLYING_RADII * radius_m) return false;
    }
    const low_m = z_m - (1 + FLYING_RADII) * radius_m;
    for (let row = -1; row <= 1; ++row)
      for (let column = -1; column <= 1; ++column)
        if (this.heightAt(x_m + 0.7 * column * radius_m, y_m + 0.7 * row * radius_m) > low_m) return false;
    return true;
  }

  private smooth(): void {
    const reach_columns = Math.max(1, Math.round((1.2 * this.scene.radius_m) / this.cellWidth));
    const reach_rows = Math.max(1, Math.round((1.2 * this.scene.radius_m) / this.cellLength));
    const { columns, rows } = this;
    for (let row = 0; row < rows; ++row) boxBlur(this.heights, this.scratch, row * columns, 1, columns, reach_columns);
    for (let column = 0; column < columns; ++column)
      boxBlur(this.scratch, this.smoothed, column, columns, rows, reach_rows);
  }
}

type FixedTriangle = [number, number, number, number, number, number, number, number, number];

/** The middle of a stone's corners, how far from it they are in the mean, and the lowest of them. */
function ballAround(triangles_m: Float32Array): {
  x_m: number;
  y_m: number;
  z_m: number;
  radius_m: number;
  lowest_m: number;
} {
  const count = triangles_m.length / 3;
  const middle: Vec3 = [0, 0, 0];
  let lowest_m = Infinity;
  for (let i = 0; i < triangles_m.length; ++i) {
    middle[i % 3]! += triangles_m[i]! / count;
    if (i % 3 === 2) lowest_m = Math.min(lowest_m, triangles_m[i]!);
  }
  const [x_m, y_m, z_m] = middle;
  let radius_m = 0;
  for (let i = 0; i < triangles_m.length; i += 3)
    radius_m += Math.hypot(triangles_m[i]! - x_m, triangles_m[i + 1]! - y_m, triangles_m[i + 2]! - z_m) / count;
  return { x_m, y_m, z_m, radius_m, lowest_m };
}

/** Mean over 2 reach + 1 neighbours along one line of a picture; the ends stand for what is beyond them. */
function boxBlur(
  from: Float32Array,
  to: Float32Array,
  start: number,
  stride: number,
  count: number,
  reach: number,
): void {
  const at = (i: number): number => from[start + Math.min(count - 1, Math.max(0, i)) * stride]!;
  let sum = 0;
  for (let i = -reach; i <= reach; ++i) sum += at(i);
  const share = 1 / (2 * reach + 1);
  for (let i = 0; i < count; ++i) {
    to[start + i * stride] = sum * share;
    sum += at(i + reach + 1) - at(i - reach);
  }
}
