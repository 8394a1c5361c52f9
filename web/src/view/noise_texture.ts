// Roughness for particles and ground: a block of noise that repeats in all directions, with its slope. One lookup gives
// the brightness of a point and the slope of its surface. That is far cheaper than computing noise in every pixel.

import { Data3DTexture, LinearFilter, LinearMipmapLinearFilter, RepeatWrapping, RGBAFormat } from 'three';

const SIDE = 32;
/** lattice cells along a side, and weight, of each octave */
const OCTAVES: [cells: number, weight: number][] = [
  [4, 0.5],
  [8, 0.3],
  [16, 0.2],
];

const smooth = (share: number): number => share * share * (3 - 2 * share);

function valueNoise(cells: number, random: () => number): Float32Array {
  const lattice = Float32Array.from({ length: cells ** 3 }, random);
  const at = (x: number, y: number, z: number): number =>
    lattice[((z % cells) * cells + (y % cells)) * cells + (x % cells)]!;
  const mix = (a: number, b: number, share: number): number => a + (b - a) * share;
  const block = new Float32Array(SIDE ** 3);
  const per_cell = SIDE / cells;
  for (let z = 0, i = 0; z < SIDE; ++z)
    for (let y = 0; y < SIDE; ++y)
      for (let x = 0; x < SIDE; ++x, ++i) {
        const cx = Math.floor(x / per_cell);
        const cy = Math.floor(y / per_cell);
        const cz = Math.floor(z / per_cell);
        const fx = smooth(x / per_cell - cx);
        const fy = smooth(y / per_cell - cy);
        const fz = smooth(z / per_cell - cz);
        const plane = (dz: number): number =>
          mix(
            mix(at(cx, cy, cz + dz), at(cx + 1, cy, cz + dz), fx),
            mix(at(cx, cy + 1, cz + dz), at(cx + 1, cy + 1, cz + dz), fx),
            fy,
          );
        block[i] = mix(plane(0), plane(1), fz);
      }
  return block;
}

/** Makes the texture. Red: height 0 to 1; green, blue, alpha: its slope along x, y, z about 0.5. One period per unit
 * of the coordinates. */
export function makeNoiseTexture(): Data3DTexture {
  // A fixed seed, so that pictures are reproducible.
  let seed = 20210;
  const random = (): number => (seed = (seed * 16807) % 2147483647) / 2147483647;
  const block = new Float32Array(SIDE ** 3);
  for (const [cells, weight] of OCTAVES) {
    const octave = valueNoise(cells, random);
    for (let i = 0; i < block.length; ++i) block[i]! += weight * octave[i]!;
  }
  const data = new Uint8Array(4 * SIDE ** 3);
  const index = (x: number, y: number, z: number): number =>
    ((z & (SIDE - 1)) * SIDE + (y & (SIDE - 1))) * SIDE + (x & (SIDE - 1));
  const slope = (a: number, b: number): number => Math.max(0, Math.min(255, 127.5 + 640 * (block[a]! - block[b]!)));
  for (let z = 0, i = 0; z < SIDE; ++z)
    for (let y = 0; y < SIDE; ++y)
      for (let x = 0; x < SIDE; ++x, ++i) {
        data[4 * i] = 255 * block[i]!;
        data[4 * i + 1] = slope(index(x + 1, y, z), index(x - 1, y, z));
        data[4 * i + 2] = slope(index(x, y + 1, z), index(x, y - 1, z));
        data[4 * i + 3] = slope(index(x, y, z + 1), index(x, y, z - 1));
      }
  const texture = new Data3DTexture(data, SIDE, SIDE, SIDE);
  texture.format = RGBAFormat;
  texture.wrapS = texture.wrapT = texture.wrapR = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.needsUpdate = true;
  return texture;
}
