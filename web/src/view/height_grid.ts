// Basis of maps of the bed from above: cells in rows, each with a height.

import type { Vec3 } from 'haptolith-protocol';

export interface Grid {
  readonly columns: number;
  readonly rows: number;
  readonly low_x_m: number;
  readonly low_y_m: number;
  readonly cell_width_m: number;
  readonly cell_length_m: number;
}

const HEIGHT_BINS = 1024;

/** Particles approximately in order of height, lowest first. */
export class HeightOrder {
  index = new Uint32Array(0);
  private readonly bins = new Uint32Array(HEIGHT_BINS + 1);

  sort(records: Uint16Array, particles: number): void {
    const { bins } = this;
    if (this.index.length !== particles) this.index = new Uint32Array(particles);
    bins.fill(0);
    for (let i = 0; i < particles; ++i) bins[(records[4 * i + 2]! >> 6) + 1]! += 1;
    for (let bin = 1; bin <= HEIGHT_BINS; ++bin) bins[bin]! += bins[bin - 1]!;
    for (let i = 0; i < particles; ++i) this.index[bins[records[4 * i + 2]! >> 6]!++] = i;
  }
}

/** Raises the heights to triangles of nine numbers each. */
export function raiseTriangles(triangles_m: Float32Array, heights: Float32Array, grid: Grid): void {
  const { columns, rows, low_x_m, low_y_m, cell_width_m: dx, cell_length_m: dy } = grid;
  for (let i = 0; i < triangles_m.length; i += 9) {
    const [ax, ay, az, bx, by, bz, cx, cy, cz] = triangles_m.subarray(i, i + 9) as unknown as FixedTriangle;
    const [ux, uy, uz, vx, vy, vz] = [bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az];
    const area = ux * vy - uy * vx;
    if (area <= 0) continue; // it faces down
    const first_column = Math.max(0, Math.ceil((Math.min(ax, bx, cx) - low_x_m) / dx - 0.5));
    const last_column = Math.min(columns - 1, Math.floor((Math.max(ax, bx, cx) - low_x_m) / dx - 0.5));
    const first_row = Math.max(0, Math.ceil((Math.min(ay, by, cy) - low_y_m) / dy - 0.5));
    const last_row = Math.min(rows - 1, Math.floor((Math.max(ay, by, cy) - low_y_m) / dy - 0.5));
    for (let row = first_row; row <= last_row; ++row) {
      const y = low_y_m + (row + 0.5) * dy - ay;
      for (let column = first_column; column <= last_column; ++column) {
        const x = low_x_m + (column + 0.5) * dx - ax;
        const u = (x * vy - y * vx) / area;
        const v = (ux * y - uy * x) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const at = row * columns + column;
        heights[at] = Math.max(heights[at]!, az + u * uz + v * vz);
      }
    }
  }
}

type FixedTriangle = [number, number, number, number, number, number, number, number, number];

/** Returns the mean of a stone's corners, their mean distance from it, and their minimum height. */
export function ballAround(triangles_m: Float32Array): {
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
