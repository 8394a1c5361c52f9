// Shape of a stone, as in a message.

import * as v from 'valibot';
import { readTriangles, TrianglesText, type TriangleMesh } from './triangle_mesh.js';

const Sphere = v.tuple([v.number(), v.number(), v.number(), v.pipe(v.number(), v.gtValue(0))]);

/** Shape in the stone's frame, in m. Each sphere is x, y, z and radius. */
export const Stone = v.union([
  v.object({ spheres: v.pipe(v.array(Sphere), v.nonEmpty()) }),
  v.pipe(
    TrianglesText,
    v.rawTransform<TrianglesText, TriangleMesh>((context) => readTriangles(context) ?? context.NEVER),
  ),
]);
export type Stone = v.InferOutput<typeof Stone>;
