// Height of the soil over each point of the floor: a small map of the bed from above. Shaders read it to estimate how
// much sky and sun a particle sees. Each point has two heights: unfiltered, and smoothed over about two particles.
//
// A particle or a stone in the air does not change the height, because there is light below it. Such objects are listed
// instead, for separate round shadows.

import { dequantise, radiiOf, type Scene, type Vec3 } from 'haptolith-protocol';
import { DataTexture, DataUtils, HalfFloatType, LinearFilter, RGFormat, Vector4 } from 'three';
import { boxBlur } from './grid_filters';
import { ballAround, HeightOrder, raiseTriangles } from './height_grid';

const LARGEST_SIDE = 192;
// A particle is a few cells wide, enough to show its round top; more cells cost time without a visible effect.
const CELLS_PER_RADIUS = 3.5;
// A particle flies if nothing is within this distance below its lowest point, in radii.
const FLYING_RADII = 3;
/** Maximum number of particles in the air that cast a shadow. */
export const MOST_FLYING = 16;

/** Sphere around a tool, which can carry particles although it is not soil. */
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
  /** centres and radii of the lowest particles in the air; the first `flying_count` are valid */
  readonly flying_m = Array.from({ length: MOST_FLYING }, () => new Vector4());
  flying_count = 0;

  private readonly cell_m: number;
  private readonly heights: Float32Array;
  private readonly smoothed: Float32Array;
  private readonly scratch: Float32Array;
  private readonly halves: Uint16Array;
  private readonly order = new HeightOrder();

  constructor(
    private readonly scene: Scene,
    private readonly radii_m = radiiOf(scene),
  ) {
    const finest_m = this.radii_m.reduce((least, radius_m) => Math.min(least, radius_m), scene.radius_m);
    // One particle of margin, so that the edge of the map is bare ground, as is everything beyond it.
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

  /** Builds the field from all records (four u16 per particle, as in a frame), and the triangles of each stone (nine
   * numbers per triangle, in the scene's frame). */
  build(
    records: Uint16Array,
    particles: number,
    carriers: readonly Carrier[] = [],
    stones_m: readonly Float32Array[] = [],
  ): void {
    this.order.sort(records, particles);
    this.raise(records, particles, carriers);
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

  /** Returns the height of the soil at a point, in m; 0 outside the field. */
  heightAt(x_m: number, y_m: number): number {
    const column = Math.floor((x_m - this.low_x_m) / this.cell_width_m);
    const row = Math.floor((y_m - this.low_y_m) / this.cell_length_m);
    if (column < 0 || row < 0 || column >= this.columns || row >= this.rows) return 0;
    return this.heights[row * this.columns + column]!;
  }

  dispose(): void {
    this.texture.dispose();
  }

  get cell_width_m(): number {
    return this.width_m / this.columns;
  }

  get cell_length_m(): number {
    return this.length_m / this.rows;
  }

  /** Raises the heights to the round top of every particle that does not fly. */
  private raise(records: Uint16Array, particles: number, carriers: readonly Carrier[]): void {
    const { heights, columns, rows } = this;
    const { low_m, high_m } = this.scene.quantised;
    const dx = this.cell_width_m;
    const dy = this.cell_length_m;
    heights.fill(0);
    this.flying_count = 0;
    for (let nth = 0; nth < particles; ++nth) {
      const i = this.order.index[nth]!;
      const radius_m = this.radii_m[i]!;
      const squared = radius_m * radius_m;
      const x = dequantise(records[4 * i]!, low_m[0], high_m[0]) - this.low_x_m;
      const y = dequantise(records[4 * i + 1]!, low_m[1], high_m[1]) - this.low_y_m;
      const z = dequantise(records[4 * i + 2]!, low_m[2], high_m[2]);
      if (
        z - radius_m > FLYING_RADII * radius_m &&
        this.flies(x + this.low_x_m, y + this.low_y_m, z, radius_m, carriers)
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

  /** Raises the heights to the top of a stone; a flying stone is listed instead, and replaces the last particle if
   * the list is full. */
  private raiseStone(triangles_m: Float32Array): void {
    const ball = ballAround(triangles_m);
    if (ball.lowest_m - this.heightAt(ball.x_m, ball.y_m) > FLYING_RADII * this.scene.radius_m) {
      this.flying_count = Math.min(MOST_FLYING, this.flying_count + 1);
      this.flying_m[this.flying_count - 1]!.set(ball.x_m, ball.y_m, ball.z_m, ball.radius_m);
      return;
    }
    raiseTriangles(triangles_m, this.heights, this);
  }

  /** Whether neither soil, of the lower particles added so far, nor a carrier is close below a particle. */
  private flies(x_m: number, y_m: number, z_m: number, radius_m: number, carriers: readonly Carrier[]): boolean {
    for (const carrier of carriers) {
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
    const reach_columns = Math.max(1, Math.round((1.2 * this.scene.radius_m) / this.cell_width_m));
    const reach_rows = Math.max(1, Math.round((1.2 * this.scene.radius_m) / this.cell_length_m));
    const { columns, rows } = this;
    for (let row = 0; row < rows; ++row) boxBlur(this.heights, this.scratch, row * columns, 1, columns, reach_columns);
    for (let column = 0; column < columns; ++column)
      boxBlur(this.scratch, this.smoothed, column, columns, rows, reach_rows);
  }
}
