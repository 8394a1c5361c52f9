// A tool that somebody drew: how its triangles come in a message, and how large they are.

import * as v from 'valibot';
import { readTriangles, TrianglesText, type TriangleMesh } from './triangle_mesh';

/** Everything is in the tool's frame. */
export interface ToolMesh extends TriangleMesh {
  /** of the file */
  name: string;
  /** what was done to it, a sentence each */
  report: string[];
}

const MeshText = v.object({
  name: v.string(),
  /** an older program does not say */
  report: v.optional(v.array(v.string()), []),
  ...TrianglesText.entries,
});
export type MeshText = v.InferOutput<typeof MeshText>;

// Every change of a scene brings its mesh again. One that has not changed stays the same object, so that nobody has to
// look at all of its points to know that.
let latest: { text: MeshText; mesh: ToolMesh } | null = null;

function isLatest({ name, points_base64, triangles_base64 }: MeshText): boolean {
  return (
    name === latest?.text.name &&
    points_base64 === latest.text.points_base64 &&
    triangles_base64 === latest.text.triangles_base64
  );
}

export const ToolMesh = v.pipe(
  MeshText,
  v.rawTransform<MeshText, ToolMesh>((context) => {
    const text = context.dataset.value;
    if (latest && isLatest(text)) return latest.mesh;
    const triangles = readTriangles(context);
    if (!triangles) return context.NEVER;
    latest = { text, mesh: { name: text.name, report: text.report, ...triangles } };
    return latest.mesh;
  }),
);

export interface MeshSize {
  /** longest edge of the box around it */
  longest_m: number;
  /** radius of the sphere around it whose middle is the tool's origin */
  reach_m: number;
  /** half of the box around it whose middle is the tool's origin */
  half_m: [number, number, number];
}

const sizes = new WeakMap<ToolMesh, MeshSize>();

export function sizeOfMesh(mesh: ToolMesh): MeshSize {
  let size = sizes.get(mesh);
  if (!size) sizes.set(mesh, (size = measure(mesh)));
  return size;
}

function measure({ points_m }: ToolMesh): MeshSize {
  const low_m = [Infinity, Infinity, Infinity];
  const high_m = [-Infinity, -Infinity, -Infinity];
  let reach_m = 0;
  for (let i = 0; i < points_m.length; i += 3) {
    reach_m = Math.max(reach_m, Math.hypot(points_m[i]!, points_m[i + 1]!, points_m[i + 2]!));
    for (let axis = 0; axis < 3; ++axis) {
      low_m[axis] = Math.min(low_m[axis]!, points_m[i + axis]!);
      high_m[axis] = Math.max(high_m[axis]!, points_m[i + axis]!);
    }
  }
  const half_m = (axis: number): number => Math.max(-low_m[axis]!, high_m[axis]!);
  return {
    longest_m: Math.max(...high_m.map((high, axis) => high - low_m[axis]!)),
    reach_m,
    half_m: [half_m(0), half_m(1), half_m(2)],
  };
}
