// A tool that somebody drew, as it comes in a message.

import * as v from 'valibot';
import { readTriangles, TrianglesText, type TriangleMesh } from './triangle_mesh.js';

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
