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

// Every change of a scene sends its mesh again. An unchanged mesh keeps its object, so that it need not be compared
// point by point.
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
