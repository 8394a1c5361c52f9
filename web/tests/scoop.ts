// A typical mesh file, and meshes as the program sends them: the inverse of ToolMesh.

import type { MeshText, Vec3 } from 'haptolith-protocol';

export function encodeMesh(name: string, points_m: Vec3[], triangles: Vec3[]): MeshText {
  const base64 = (numbers: Float32Array | Uint32Array): string => Buffer.from(numbers.buffer).toString('base64');
  return {
    name,
    report: [],
    points_base64: base64(new Float32Array(points_m.flat())),
    triangles_base64: base64(new Uint32Array(triangles.flat())),
  };
}

/** Returns the corners of a rectangle about the centre, counter-clockwise seen from above. */
const corners = (x: number, y: number, z: number): Vec3[] => [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]]; // prettier-ignore

const SIDES = [0, 1, 2, 3].map((i): [number, number] => [i, (i + 1) % 4]);
const QUADS: [number, number, number, number][] = [
  [3, 2, 1, 0],
  // outside, rim, inside
  ...[0, 4, 8].flatMap((first) =>
    SIDES.map(([i, j]): [number, number, number, number] => [first + i, first + j, first + j + 4, first + i + 4]),
  ),
  [12, 13, 14, 15],
];

/** A tray of 60 by 40 by 20 mm, open above, with walls of 3 mm; its origin is the centre of its bottom. */
export const SCOOP = encodeMesh(
  'scoop.stl',
  [
    ...corners(0.03, 0.02, 0),
    ...corners(0.03, 0.02, 0.02),
    ...corners(0.027, 0.017, 0.02),
    ...corners(0.027, 0.017, 0.003),
  ],
  QUADS.flatMap(([a, b, c, d]): Vec3[] => [[a, b, c], [a, c, d]]), // prettier-ignore
);
