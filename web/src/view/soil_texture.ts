// What regolith looks like from near: a tile of powder with angular grains in it, many small ones and few large ones, as
// sieves find them. Worked out once, when the page opens, so that a look into it is all that a pixel costs.

import { DataTexture, LinearFilter, LinearMipmapLinearFilter, RepeatWrapping, RGBAFormat } from 'three';

export const SIDE = 512;
const SMALLEST_PX = 1.3;
const LARGEST_PX = 17;
// So many grains are larger than r: COUNT (SMALLEST_PX / r)^POWER.
const COUNT = 20_000;
const POWER = 2.5;
const CORNERS = 6;
// Slopes up to this are kept.
export const STEEPEST = 2;

/** Heights in pixels, and which share of the light each point sends back, about 0.5. */
export function regolithTile(random: () => number): { heights: Float32Array; albedo: Float32Array } {
  const heights = new Float32Array(SIDE * SIDE);
  const albedo = new Float32Array(SIDE * SIDE).fill(0.5);
  powder(heights, random);
  const base = heights.slice();
  // Large ones first: powder and small grains lie on them and against them.
  for (let nth = 0; nth < COUNT; ++nth) {
    const radius_px = Math.min(LARGEST_PX, SMALLEST_PX * ((nth + 0.5) / COUNT) ** (-1 / POWER));
    layGrain(heights, albedo, base, radius_px, random);
  }
  return { heights, albedo };
}

/** Waves of several lengths that go on across the tile's edges. */
function powder(heights: Float32Array, random: () => number): void {
  for (const [cells, weight] of [
    [8, 9],
    [16, 5],
    [32, 2.5],
    [128, 0.7],
  ] as const) {
    const lattice = Float32Array.from({ length: cells * cells }, random);
    const per_cell = SIDE / cells;
    const smooth = (share: number): number => share * share * (3 - 2 * share);
    for (let y = 0, i = 0; y < SIDE; ++y) {
      const cy = Math.floor(y / per_cell);
      const fy = smooth(y / per_cell - cy);
      const [row, next_row] = [cy * cells, ((cy + 1) % cells) * cells];
      for (let x = 0; x < SIDE; ++x, ++i) {
        const cx = Math.floor(x / per_cell);
        const fx = smooth(x / per_cell - cx);
        const next = (cx + 1) % cells;
        const low = lattice[row + cx]! + fx * (lattice[row + next]! - lattice[row + cx]!);
        const high = lattice[next_row + cx]! + fx * (lattice[next_row + next]! - lattice[next_row + cx]!);
        heights[i]! += weight * (low + fy * (high - low) - 0.5);
      }
    }
  }
}

/** One grain: a block with flat faces, sunk into the powder. */
function layGrain(
  heights: Float32Array,
  albedo: Float32Array,
  base: Float32Array,
  radius_px: number,
  random: () => number,
): void {
  const [x, y] = [SIDE * random(), SIDE * random()];
  const shade = 0.5 + 0.36 * (random() - 0.5);
  const ground = base[Math.floor(y) * SIDE + Math.floor(x)]!;
  const top = ground + radius_px * (0.25 + 0.5 * random());
  const lean_x = 0.5 * (random() - 0.5);
  const lean_y = 0.5 * (random() - 0.5);
  const turn = random();
  const faces = Array.from({ length: CORNERS }, (_, k) => {
    const angle = (2 * Math.PI * (k + turn + 0.5 * random())) / CORNERS;
    return [Math.cos(angle), Math.sin(angle), 0.55 + 0.4 * random(), 1 + 1.6 * random()] as const;
  });
  const reach = Math.ceil(radius_px);
  for (let dy = -reach; dy <= reach; ++dy)
    for (let dx = -reach; dx <= reach; ++dx) {
      let height = top + lean_x * dx + lean_y * dy;
      for (const [nx, ny, away, slope] of faces)
        height = Math.min(height, top + slope * (away * radius_px - nx * dx - ny * dy) - 0.4 * radius_px);
      const at = ((Math.floor(y) + dy) & (SIDE - 1)) * SIDE + ((Math.floor(x) + dx) & (SIDE - 1));
      if (height <= heights[at]! || height < ground) continue;
      heights[at] = height;
      albedo[at] = shade;
    }
}

/** 1 where the sun reaches the tile, 0 in the shadow of a grain; the tile repeats in all directions. */
export function tileSun(heights: Float32Array, to_sun: { x: number; y: number; z: number }): Float32Array {
  const [main, other] = Math.abs(to_sun.x) >= Math.abs(to_sun.y) ? [to_sun.x, to_sun.y] : [to_sun.y, to_sun.x];
  const [line_stride, cell_stride] = main === to_sun.x ? [1, SIDE] : [SIDE, 1];
  const aside = other / Math.abs(main);
  const whole = Math.floor(aside);
  const part = aside - whole;
  const drop = to_sun.z / Math.abs(main);
  const sun = new Float32Array(SIDE * SIDE);
  let before = new Float32Array(SIDE).fill(-Infinity);
  let now = new Float32Array(SIDE);
  // Once for the shadows that come over the tile's edge, once to keep.
  for (let nth = 0; nth < 2 * SIDE; ++nth) {
    const line = (main > 0 ? 2 * SIDE - 1 - nth : nth) & (SIDE - 1);
    for (let cell = 0; cell < SIDE; ++cell) {
      const a = before[(cell + whole) & (SIDE - 1)]!;
      const b = before[(cell + whole + 1) & (SIDE - 1)]!;
      const at = line * line_stride + cell * cell_stride;
      const shadow = nth === 0 ? -Infinity : a + part * (b - a) - drop;
      const height = heights[at]!;
      now[cell] = Math.max(shadow, height);
      sun[at] = Math.min(1, Math.max(0, 0.5 + (height - shadow) / 0.8));
    }
    [before, now] = [now, before];
  }
  return sun;
}

/** Red, green: slope along x and y about 0.5; blue: brightness about 0.5; alpha: sun. */
export function makeSoilTexture(to_sun: { x: number; y: number; z: number }): DataTexture {
  // A seed of its own, so that pictures can be compared.
  let seed = 1969;
  const random = (): number => (seed = (seed * 16807) % 2147483647) / 2147483647;
  const { heights, albedo } = regolithTile(random);
  const sun = tileSun(heights, to_sun);
  const data = new Uint8Array(4 * SIDE * SIDE);
  const byte = (value: number): number => Math.max(0, Math.min(255, Math.round(255 * value)));
  for (let y = 0, i = 0; y < SIDE; ++y)
    for (let x = 0; x < SIDE; ++x, ++i) {
      const along = (dx: number, dy: number): number =>
        heights[((y + dy) & (SIDE - 1)) * SIDE + ((x + dx) & (SIDE - 1))]!;
      const slope_x = (along(1, 0) - along(-1, 0)) / 2;
      const slope_y = (along(0, 1) - along(0, -1)) / 2;
      data[4 * i] = byte(0.5 + slope_x / (2 * STEEPEST));
      data[4 * i + 1] = byte(0.5 + slope_y / (2 * STEEPEST));
      data[4 * i + 2] = byte(albedo[i]!);
      data[4 * i + 3] = byte(sun[i]!);
    }
  const texture = new DataTexture(data, SIDE, SIDE, RGBAFormat);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = 8;
  texture.generateMipmaps = true;
  texture.needsUpdate = true;
  return texture;
}
