// Triangles as in a message: of a tool from a file, and of stones.

import * as v from 'valibot';

/** A closed mesh. */
export interface TriangleMesh {
  /** x, y, z of each point */
  points_m: Float32Array<ArrayBuffer>;
  /** three point indices each, counter-clockwise seen from outside */
  triangles: Uint32Array<ArrayBuffer>;
}

export const TrianglesText = v.object({ points_base64: v.string(), triangles_base64: v.string() });
export type TrianglesText = v.InferOutput<typeof TrianglesText>;

/** Decodes one or more triples of four-byte values; null: invalid. */
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

/** Reads triangles; reports an issue and returns null if they are invalid. */
export function readTriangles<Text extends TrianglesText>({
  dataset: { value: text },
  addIssue,
}: v.RawTransformContext<Text>): TriangleMesh | null {
  const refuse = (key: keyof TrianglesText, expected: string): null => {
    addIssue({ expected, path: [{ type: 'object', origin: 'value', input: text, key, value: text[key] }] });
    return null;
  };
  const points = triples(text.points_base64);
  if (!points) return refuse('points_base64', 'base64 of 12 bytes a point');
  const triangles = triples(text.triangles_base64);
  if (!triangles) return refuse('triangles_base64', 'base64 of 12 bytes a triangle');
  // The arrays use the machine's byte order, as frames do.
  const mesh = { points_m: new Float32Array(points), triangles: new Uint32Array(triangles) };
  if (!mesh.points_m.every(Number.isFinite)) return refuse('points_base64', 'finite');
  const count = mesh.points_m.length / 3;
  if (!mesh.triangles.every((point) => point < count)) return refuse('triangles_base64', `of ${count} points`);
  return mesh;
}
