// Mesh of a tool from a file, as in a message.

import * as v from 'valibot';
import { readTriangles, TrianglesText, type TriangleMesh } from './triangle_mesh.js';

/** Mesh in the tool's frame. */
export interface ToolMesh extends TriangleMesh {
  /** name of the file */
  name: string;
  /** changes made to the mesh, one sentence each */
  report: string[];
}

const MeshText = v.object({
  name: v.string(),
  /** absent from older programs */
  report: v.optional(v.array(v.string()), []),
  ...TrianglesText.entries,
});
export type MeshText = v.InferOutput<typeof MeshText>;

// Every change of a scene sends its meshes again. An unchanged mesh keeps its object, so that it need not be compared
// point by point.
const MOST_KEPT = 16; // tools in a scene
let kept: { text: MeshText; mesh: ToolMesh }[] = [];

const isSame = (a: MeshText, b: MeshText): boolean =>
  a.name === b.name && a.points_base64 === b.points_base64 && a.triangles_base64 === b.triangles_base64;

export const ToolMesh = v.pipe(
  MeshText,
  v.rawTransform<MeshText, ToolMesh>((context) => {
    const text = context.dataset.value;
    const found = kept.find((one) => isSame(one.text, text));
    if (found) return found.mesh;
    const triangles = readTriangles(context);
    if (!triangles) return context.NEVER;
    const mesh = { name: text.name, report: text.report, ...triangles };
    kept = [{ text, mesh }, ...kept.slice(0, MOST_KEPT - 1)];
    return mesh;
  }),
);
