// Appearance of a mesh: smooth where its triangles are nearly coplanar, with an edge where they are not. Triangles of
// one surface share their points, so neighbours are found by index. three.js would search by position, which takes
// seconds for 100 000 triangles.

import type { TriangleMesh } from 'haptolith-protocol';
import { BufferGeometry, Float32BufferAttribute, Uint32BufferAttribute, Vector3 } from 'three';

/** Minimum angle between two faces that do not appear as one surface. */
const CREASE_DEG = 30;

const cosine = (angle_deg: number): number => Math.cos((angle_deg * Math.PI) / 180);

/** Normals of the triangles, and the triangles at each point. */
class Faces {
  /** unit normals: x, y, z of each; 0 without area */
  private readonly normals: Float32Array;
  /** twice the area of each */
  private readonly areas: Float32Array;
  /** the faces of each point, in sequence, and the first index of each point */
  private readonly around: Uint32Array;
  private readonly first: Uint32Array;

  constructor(private readonly mesh: TriangleMesh) {
    const { points_m, triangles } = mesh;
    this.normals = new Float32Array(triangles.length);
    this.areas = new Float32Array(triangles.length / 3);
    const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
    for (let face = 0; face < this.areas.length; ++face) {
      a.fromArray(points_m, 3 * triangles[3 * face]!);
      b.fromArray(points_m, 3 * triangles[3 * face + 1]!);
      c.fromArray(points_m, 3 * triangles[3 * face + 2]!);
      const normal = b.sub(a).cross(c.sub(a));
      this.areas[face] = normal.length();
      normal.normalize().toArray(this.normals, 3 * face);
    }
    this.first = new Uint32Array(points_m.length / 3 + 1);
    for (const point of triangles) this.first[point + 1]! += 1;
    for (let point = 1; point < this.first.length; ++point) this.first[point]! += this.first[point - 1]!;
    this.around = new Uint32Array(triangles.length);
    const next = this.first.slice();
    triangles.forEach((point, corner) => (this.around[next[point]!++] = Math.floor(corner / 3)));
  }

  forEachAt(point: number, run: (face: number) => void): void {
    for (let i = this.first[point]!; i < this.first[point + 1]!; ++i) run(this.around[i]!);
  }

  has(face: number, point: number): boolean {
    const { triangles } = this.mesh;
    return triangles[3 * face] === point || triangles[3 * face + 1] === point || triangles[3 * face + 2] === point;
  }

  /** Returns the cosine of the angle between two faces. */
  cosine(one: number, other: number): number {
    const { normals } = this;
    const x = normals[3 * one]! * normals[3 * other]!;
    const y = normals[3 * one + 1]! * normals[3 * other + 1]!;
    return x + y + normals[3 * one + 2]! * normals[3 * other + 2]!;
  }

  /** Adds the normal of a face, weighted by its area. */
  addTo(sum: Vector3, face: number): void {
    const { normals } = this;
    const area = this.areas[face]!;
    sum.x += area * normals[3 * face]!;
    sum.y += area * normals[3 * face + 1]!;
    sum.z += area * normals[3 * face + 2]!;
  }
}

export function meshGeometry(mesh: TriangleMesh): BufferGeometry {
  const { points_m, triangles } = mesh;
  const faces = new Faces(mesh);
  const least = cosine(CREASE_DEG);
  const positions = new Float32Array(3 * triangles.length);
  const normals = new Float32Array(3 * triangles.length);
  const normal = new Vector3();
  triangles.forEach((point, corner) => {
    const face = Math.floor(corner / 3);
    normal.set(0, 0, 0);
    faces.forEachAt(point, (other) => {
      if (faces.cosine(face, other) > least) faces.addTo(normal, other);
    });
    normal.normalize().toArray(normals, 3 * corner);
    for (let axis = 0; axis < 3; ++axis) positions[3 * corner + axis] = points_m[3 * point + axis]!;
  });
  return new BufferGeometry()
    .setAttribute('position', new Float32BufferAttribute(positions, 3))
    .setAttribute('normal', new Float32BufferAttribute(normals, 3));
}

/** Returns lines where two faces meet at more than an angle. */
export function meshEdges(mesh: TriangleMesh, edge_angle_deg: number): BufferGeometry {
  const { points_m, triangles } = mesh;
  const faces = new Faces(mesh);
  const least = cosine(edge_angle_deg);
  const lines: number[] = [];
  triangles.forEach((from, corner) => {
    const face = Math.floor(corner / 3);
    const to = triangles[3 * face + ((corner + 1) % 3)]!;
    // The face on the other side has this edge in the opposite direction: each edge is tested once.
    if (from > to) return;
    let sharp = false;
    faces.forEachAt(from, (other) => {
      sharp ||= other !== face && faces.has(other, to) && faces.cosine(face, other) < least;
    });
    if (sharp) for (const point of [from, to]) lines.push(...points_m.subarray(3 * point, 3 * point + 3));
  });
  return new BufferGeometry().setAttribute('position', new Float32BufferAttribute(lines, 3));
}

/** Returns the mesh with flat triangles. */
export function flatGeometry({ points_m, triangles }: TriangleMesh): BufferGeometry {
  const shared = new BufferGeometry()
    .setAttribute('position', new Float32BufferAttribute(points_m, 3))
    .setIndex(new Uint32BufferAttribute(triangles, 1));
  const geometry = shared.toNonIndexed();
  geometry.computeVertexNormals();
  return geometry;
}
