// Size of a tool from a mesh file.

import type { ToolMesh } from 'haptolith-protocol';

export interface MeshSize {
  /** longest edge of its bounding box */
  longest_m: number;
  /** radius of its bounding sphere about the tool's origin */
  reach_m: number;
  /** half extents of its bounding box centred at the tool's origin */
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
