// A tool that somebody drew: how its triangles come in a message, and how large they are.

import * as v from 'valibot';

/** Closed; everything is in the tool's frame. */
export interface ToolMesh {
  /** of the file */
  name: string;
  /** x, y, z of each point */
  points_m: Float32Array<ArrayBuffer>;
  /** three points each, counter-clockwise seen from outside */
  triangles: Uint32Array<ArrayBuffer>;
}

const MeshText = v.object({ name: v.string(), points_base64: v.string(), triangles_base64: v.string() });
export type MeshText = v.InferOutput<typeof MeshText>;

/** Bytes of one or more triples of four bytes each; null: it is something else. */
function triples(base64: string): ArrayBuffer | null {
  let text: string;
  try {
    text = atob(base64);
  } catch {
    return null;
  }
  if (text.length === 0 || text.length % 12 !== 0) return null;
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

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
  v.rawTransform<MeshText, ToolMesh>(({ dataset: { value: text }, addIssue, NEVER }) => {
    if (latest && isLatest(text)) return latest.mesh;
    const refuse = (key: keyof MeshText, expected: string): never => {
      addIssue({ expected, path: [{ type: 'object', origin: 'value', input: text, key, value: text[key] }] });
      return NEVER;
    };
    const points = triples(text.points_base64);
    if (!points) return refuse('points_base64', 'base64 of 12 bytes a point');
    const triangles = triples(text.triangles_base64);
    if (!triangles) return refuse('triangles_base64', 'base64 of 12 bytes a triangle');
    // They are read in the machine's byte order, as frames are.
    const mesh = { name: text.name, points_m: new Float32Array(points), triangles: new Uint32Array(triangles) };
    if (!mesh.points_m.every(Number.isFinite)) return refuse('points_base64', 'finite');
    const count = mesh.points_m.length / 3;
    if (!mesh.triangles.every((point) => point < count)) return refuse('triangles_base64', `of ${count} points`);
    latest = { text, mesh };
    return mesh;
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
