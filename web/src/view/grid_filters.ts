// Filters for all heights of a grid: smoothing, filling, shadows.

import type { Grid } from './height_grid';

/** Blurs twice by a box with a reach of `reach_m` to either side, which approximates a Gaussian. `scratch` is
 * overwritten. */
export function blurTwice(
  from: Float32Array,
  to: Float32Array,
  scratch: Float32Array,
  grid: Grid,
  reach_m: number,
): void {
  const { columns, rows } = grid;
  const [across, along] = cellsOf(grid, reach_m);
  for (let pass = 0; pass < 2; ++pass) {
    const source = pass === 0 ? from : to;
    for (let row = 0; row < rows; ++row) boxBlur(source, scratch, row * columns, 1, columns, across);
    for (let column = 0; column < columns; ++column) boxBlur(scratch, to, column, columns, rows, along);
  }
}

/** Fills gaps that are narrower than a block with this reach (morphological closing): pushed over the heights from
 * above, it does not enter them. */
export function fillGaps(heights: Float32Array, scratch: Float32Array, grid: Grid, reach_m: number): void {
  const { columns, rows } = grid;
  const [across, along] = cellsOf(grid, reach_m);
  for (const sign of [1, -1] as const) {
    for (let row = 0; row < rows; ++row) slide(sign, heights, scratch, row * columns, 1, columns, across);
    for (let column = 0; column < columns; ++column) slide(sign, scratch, heights, column, columns, rows, along);
  }
}

/** Replaces each value by the maximum within a square around it, whose half side is `reach_m`. */
export function spreadGreatest(values: Float32Array, scratch: Float32Array, grid: Grid, reach_m: number): void {
  const { columns, rows } = grid;
  const [across, along] = cellsOf(grid, reach_m);
  for (let row = 0; row < rows; ++row) slide(1, values, scratch, row * columns, 1, columns, across);
  for (let column = 0; column < columns; ++column) slide(1, scratch, values, column, columns, rows, along);
}

/** Computes the height of the shadow over each point. Proceeds cell by cell away from the sun: a shadow descends
 * with distance, and each higher top starts a new one. */
export function castShadows(
  heights: Float32Array,
  shadow: Float32Array,
  grid: Grid,
  to_sun: { x: number; y: number; z: number },
): void {
  const { columns, rows, cell_width_m: dx, cell_length_m: dy } = grid;
  const by_columns = Math.abs(to_sun.x) * dy >= Math.abs(to_sun.y) * dx;
  const [lines, cells] = by_columns ? [columns, rows] : [rows, columns];
  const [line_stride, cell_stride] = by_columns ? [1, columns] : [columns, 1];
  const [main, other] = by_columns ? [to_sun.x / dx, to_sun.y / dy] : [to_sun.y / dy, to_sun.x / dx];
  const towards = Math.sign(main);
  const aside = other / Math.abs(main);
  const drop_m = to_sun.z / Math.abs(main);
  const whole = Math.floor(aside);
  const part = aside - whole;
  for (let nth = 0; nth < lines; ++nth) {
    const line = towards > 0 ? lines - 1 - nth : nth;
    for (let cell = 0; cell < cells; ++cell) {
      const at = line * line_stride + cell * cell_stride;
      if (nth === 0) {
        shadow[at] = -1;
        continue;
      }
      const before = (line + towards) * line_stride;
      const a = before + Math.min(cells - 1, Math.max(0, cell + whole)) * cell_stride;
      const b = before + Math.min(cells - 1, Math.max(0, cell + whole + 1)) * cell_stride;
      const top_a = Math.max(shadow[a]!, heights[a]!);
      const top_b = Math.max(shadow[b]!, heights[b]!);
      shadow[at] = top_a + part * (top_b - top_a) - drop_m;
    }
  }
}

function cellsOf(grid: Grid, reach_m: number): [number, number] {
  return [Math.max(1, Math.round(reach_m / grid.cell_width_m)), Math.max(1, Math.round(reach_m / grid.cell_length_m))];
}

/** Computes the mean of 2 reach + 1 neighbours along one line of a grid; the end values continue beyond the ends. */
export function boxBlur(
  from: Float32Array,
  to: Float32Array,
  start: number,
  stride: number,
  count: number,
  reach: number,
): void {
  const last = start + (count - 1) * stride;
  let sum = 0;
  for (let i = -reach; i <= reach; ++i) sum += from[Math.min(last, Math.max(start, start + i * stride))]!;
  const share = 1 / (2 * reach + 1);
  // indices of the next value to enter and of the last one to leave
  let in_at = start + (reach + 1) * stride;
  let out_at = start - reach * stride;
  for (let i = 0, at = start; i < count; ++i, at += stride, in_at += stride, out_at += stride) {
    to[at] = sum * share;
    sum += from[in_at < last ? in_at : last]! - from[out_at > start ? out_at : start]!;
  }
}

/** Computes the maximum (or with -1, minimum) of 2 reach + 1 neighbours along one line of a grid. */
function slide(
  sign: 1 | -1,
  from: Float32Array,
  to: Float32Array,
  start: number,
  stride: number,
  count: number,
  reach: number,
): void {
  for (let i = 0; i < count; ++i) {
    let at = start + Math.max(0, i - reach) * stride;
    const end = start + Math.min(count - 1, i + reach) * stride;
    let best = sign * from[at]!;
    for (at += stride; at <= end; at += stride) {
      const value = sign * from[at]!;
      if (value > best) best = value;
    }
    to[start + i * stride] = sign * best;
  }
}
