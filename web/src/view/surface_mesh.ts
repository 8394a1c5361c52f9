// Mesh of the ground: fine at the bed, and long triangles from there to the horizon. The latter extend slightly under
// the bed, so that there is no visible gap.

import { BufferAttribute, BufferGeometry } from 'three';

const AROUND_PER_SIDE = 24;

/** Builds the mesh: x, y in m, and z for the shader: 0, or the depth under the ground. */
export function surfaceMesh(
  width_m: number,
  length_m: number,
  columns: number,
  rows: number,
  horizon_m: number,
): BufferGeometry {
  const at: number[] = [];
  const corners: number[] = [];
  const quad = (a: number, b: number, c: number, d: number): void => void corners.push(a, b, c, a, c, d);
  for (let row = 0; row <= rows; ++row)
    for (let column = 0; column <= columns; ++column)
      at.push((column / columns - 0.5) * width_m, (row / rows - 0.5) * length_m, 0);
  const stride = columns + 1;
  for (let row = 0; row < rows; ++row)
    for (let column = 0; column < columns; ++column) {
      const first = row * stride + column;
      quad(first, first + 1, first + 1 + stride, first + stride);
    }
  const [half_x, half_y] = [(0.5 - 1 / columns) * width_m, (0.5 - 1 / rows) * length_m];
  const ring = at.length / 3;
  const around = 4 * AROUND_PER_SIDE;
  for (let i = 0; i < around; ++i) {
    const [side, along] = [Math.floor(i / AROUND_PER_SIDE), (2 * (i % AROUND_PER_SIDE)) / AROUND_PER_SIDE - 1];
    const x = [along, 1, -along, -1][side]! * half_x;
    const y = [-1, along, 1, -along][side]! * half_y;
    const away = horizon_m / Math.hypot(x, y);
    // Intermediate rings avoid very long triangles, whose light would be wrong.
    for (const [k, out] of RINGS.entries()) {
      const share = 1 + out * (away - 1);
      at.push(share * x, share * y, k === 0 ? (-0.02 * Math.min(width_m, length_m)) / columns : 0);
    }
  }
  for (let i = 0; i < around; ++i) {
    const next = (i + 1) % around;
    for (let k = 0; k + 1 < RINGS.length; ++k) {
      const [a, b] = [ring + i * RINGS.length + k, ring + next * RINGS.length + k];
      quad(a, a + 1, b + 1, b);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(at), 3));
  geometry.setIndex(corners);
  return geometry;
}

const RINGS = [0, 0.0004, 0.02, 0.2, 1];
