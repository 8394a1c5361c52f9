// Close-up of regolith: a tile of powder with angular grains in it, many small ones and few large ones, as in sieve
// curves. Computed once when the page opens, so that a pixel costs only a lookup.

import {
  DataTexture,
  LinearFilter,
  LinearMipmapLinearFilter,
  LinearMipmapNearestFilter,
  RepeatWrapping,
  RGBAFormat,
  RGFormat,
} from 'three';

export const SIDE = 512;
const PLAIN_SIDE = 256;
const SMALLEST_PX = 1.3;
const LARGEST_PX = 17;
// Number of grains larger than r: COUNT (SMALLEST_PX / r)^POWER.
const COUNT = 20_000;
const POWER = 2.5;
const CORNERS = 6;
// Maximum stored slope.
export const STEEPEST = 2;

/** Makes heights in pixels, and the albedo of each point, about 0.5. */
export function regolithTile(random: () => number, side = SIDE): { heights: Float32Array; albedo: Float32Array } {
  const heights = new Float32Array(side * side);
  const albedo = new Float32Array(side * side).fill(0.5);
  const scale = side / SIDE;
  powder(heights, random, side);
  const base = heights.slice();
  // A coarser tile omits grains smaller than its pixels.
  const count = Math.round(COUNT * scale ** POWER);
  // Large ones first: powder and small grains rest on them and against them.
  for (let nth = 0; nth < count; ++nth) {
    const radius_px = scale * Math.min(LARGEST_PX, SMALLEST_PX * ((nth + 0.5) / COUNT) ** (-1 / POWER));
    layGrain(heights, albedo, base, radius_px, random, side);
  }
  return { heights, albedo };
}

/** Adds waves of several lengths that are periodic across the tile's edges. */
function powder(heights: Float32Array, random: () => number, side: number): void {
  for (const [cells, weight] of [
    [8, 9],
    [16, 5],
    [32, 2.5],
    [128, 0.7],
  ] as const) {
    const lattice = Float32Array.from({ length: cells * cells }, random);
    const per_cell = side / cells;
    const smooth = (share: number): number => share * share * (3 - 2 * share);
    for (let y = 0, i = 0; y < side; ++y) {
      const cy = Math.floor(y / per_cell);
      const fy = smooth(y / per_cell - cy);
      const [row, next_row] = [cy * cells, ((cy + 1) % cells) * cells];
      for (let x = 0; x < side; ++x, ++i) {
        const cx = Math.floor(x / per_cell);
        const fx = smooth(x / per_cell - cx);
        const next = (cx + 1) % cells;
        const low = lattice[row + cx]! + fx * (lattice[row + next]! - lattice[row + cx]!);
        const high = lattice[next_row + cx]! + fx * (lattice[next_row + next]! - lattice[next_row + cx]!);
        heights[i]! += (side / SIDE) * weight * (low + fy * (high - low) - 0.5);
      }
    }
  }
}

/** Adds one grain: a block with flat faces, sunk into the powder. */
function layGrain(
  heights: Float32Array,
  albedo: Float32Array,
  base: Float32Array,
  radius_px: number,
  random: () => number,
  side: number,
): void {
  const [x, y] = [side * random(), side * random()];
  const shade = 0.5 + 0.36 * (random() - 0.5);
  const ground = base[Math.floor(y) * side + Math.floor(x)]!;
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
      const at = ((Math.floor(y) + dy) & (side - 1)) * side + ((Math.floor(x) + dx) & (side - 1));
      if (height <= heights[at]! || height < ground) continue;
      heights[at] = height;
      albedo[at] = shade;
    }
}

/** Returns 1 where the sun reaches the tile, 0 in the shadow of a grain; the tile repeats in all directions. */
export function tileSun(heights: Float32Array, to_sun: { x: number; y: number; z: number }, side = SIDE): Float32Array {
  const [main, other] = Math.abs(to_sun.x) >= Math.abs(to_sun.y) ? [to_sun.x, to_sun.y] : [to_sun.y, to_sun.x];
  const [line_stride, cell_stride] = main === to_sun.x ? [1, side] : [side, 1];
  const aside = other / Math.abs(main);
  const whole = Math.floor(aside);
  const part = aside - whole;
  const drop = to_sun.z / Math.abs(main);
  const sun = new Float32Array(side * side);
  let before = new Float32Array(side).fill(-Infinity);
  let now = new Float32Array(side);
  // Two passes: one for the shadows that cross the tile's edge, one for the result.
  for (let nth = 0; nth < 2 * side; ++nth) {
    const line = (main > 0 ? 2 * side - 1 - nth : nth) & (side - 1);
    for (let cell = 0; cell < side; ++cell) {
      const a = before[(cell + whole) & (side - 1)]!;
      const b = before[(cell + whole + 1) & (side - 1)]!;
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

type Sun = { x: number; y: number; z: number };

/** Makes the texture. Red, green: slope along x and y about 0.5; blue: brightness about 0.5; alpha: sun. */
export function makeSoilTexture(to_sun: Sun): DataTexture {
  const data = new Uint8Array(4 * SIDE * SIDE);
  eachPixel(SIDE, to_sun, (i, slope_x, slope_y, albedo, sun) => {
    data[4 * i] = byte(0.5 + slope_x / (2 * STEEPEST));
    data[4 * i + 1] = byte(0.5 + slope_y / (2 * STEEPEST));
    data[4 * i + 2] = byte(albedo);
    data[4 * i + 3] = byte(sun);
  });
  const texture = tiled(new DataTexture(data, SIDE, SIDE, RGBAFormat));
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = 8;
  return texture;
}

/** Makes the plain texture: brightness on the screen relative to level soil, halved; red: in the sun, green: in
 * shadow. */
export function makePlainSoilTexture(to_sun: Sun): DataTexture {
  const data = new Uint8Array(2 * PLAIN_SIDE * PLAIN_SIDE);
  const length = Math.hypot(to_sun.x, to_sun.y, to_sun.z);
  // As litSoil() in regolith_shader.ts, at an oblique view.
  const back = (into: number): number => Math.max(0, into) / (Math.max(0, into) + 0.5);
  const level = back(to_sun.z / length);
  eachPixel(PLAIN_SIDE, to_sun, (i, slope_x, slope_y, albedo, sun) => {
    const [x, y] = [0.6 * slope_x, 0.6 * slope_y];
    const into = (to_sun.z - x * to_sun.x - y * to_sun.y) / length / Math.sqrt(1 + x * x + y * y);
    const own = 1 + 0.9 * (albedo - 0.5);
    data[2 * i] = byte(0.5 * (own * (0.45 + 0.55 * sun) * (back(into) / level)) ** (1 / 2.2));
    data[2 * i + 1] = byte(0.5 * own ** (1 / 2.2));
  });
  const texture = tiled(new DataTexture(data, PLAIN_SIDE, PLAIN_SIDE, RGFormat));
  texture.minFilter = LinearMipmapNearestFilter;
  return texture;
}

const byte = (value: number): number => Math.max(0, Math.min(255, Math.round(255 * value)));

function eachPixel(
  side: number,
  to_sun: Sun,
  put: (i: number, slope_x: number, slope_y: number, albedo: number, sun: number) => void,
): void {
  // A fixed seed, so that pictures are reproducible.
  let seed = 1969;
  const random = (): number => (seed = (seed * 16807) % 2147483647) / 2147483647;
  const { heights, albedo } = regolithTile(random, side);
  const sun = tileSun(heights, to_sun, side);
  const last = side - 1;
  for (let y = 0, i = 0; y < side; ++y)
    for (let x = 0; x < side; ++x, ++i) {
      const along = (dx: number, dy: number): number => heights[((y + dy) & last) * side + ((x + dx) & last)]!;
      put(i, (along(1, 0) - along(-1, 0)) / 2, (along(0, 1) - along(0, -1)) / 2, albedo[i]!, sun[i]!);
    }
}

function tiled(texture: DataTexture): DataTexture {
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.generateMipmaps = true;
  texture.needsUpdate = true;
  return texture;
}
