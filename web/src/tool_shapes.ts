// Properties of each tool shape. A new shape needs an entry here and its word in the protocol's `Shape`.

import type { Shape, Tool, Vec3 } from 'haptolith-protocol';
import { CylinderGeometry, EdgesGeometry, SphereGeometry, type BufferGeometry, type Object3D } from 'three';
import { sizeOfMesh } from './tool_mesh';
import { meshEdges, meshGeometry } from './view/mesh_geometry';
import { blade, halfJaw_m, rightJaw, shovelHandle, stick, yoke, type ToolMaterials } from './view/tool_geometry';

/** A size that the user can change. */
export interface ToolSize {
  name: string;
  mm(tool: Tool): number;
  /** returns the change to request for a new size */
  change(mm: number, tool: Tool): Partial<Tool>;
}

/** Solids that the shader of the tool's shadow supports; `none` has no shadow. */
export const SOLIDS = ['box', 'sphere', 'cylinder', 'none'] as const;

export interface ToolShape {
  /** name on buttons and in sentences */
  name: string;
  sizes: readonly ToolSize[];
  /** longest edge or diameter, in m */
  longest_m(tool: Tool): number;
  /** radius of the bounding sphere about the tool's origin, in m */
  reach_m(tool: Tool): number;
  /** angle by which the nose turns down when a pointer takes the tool, in degrees; 0: no change */
  dig_tilt_deg: number;
  /** whether it is two solids, which open along the tool's x */
  jaws: boolean;
  solid: (typeof SOLIDS)[number];
  /** half extents of the solid along the tool's x, y and z, in m; for jaws those of one jaw with its bulge; for
   * `none` those of a bounding box about the tool's origin */
  half_m(tool: Tool): Vec3;
  /** the solid, in m, about its centre; for jaws the right one, about the centre of its flat plate; a mesh in its
   * file's frame */
  geometry(tool: Tool): BufferGeometry;
  /** those edges of the geometry that are drawn as lines */
  edges(solid: BufferGeometry, tool: Tool): BufferGeometry;
  /** decoration that makes the tool recognisable: soil passes through it */
  extras(tool: Tool, materials: ToolMaterials): Object3D[];
}

const edge = (name: string, axis: 0 | 1 | 2): ToolSize => ({
  name,
  mm: ({ size_mm }) => size_mm[axis],
  change: (mm, { size_mm }) => ({ size_mm: size_mm.map((old, i) => (i === axis ? mm : old)) as Vec3 }),
});
const EDGES = [edge('length', 0), edge('width', 1), edge('thickness', 2)];
const DIAMETER: ToolSize = {
  name: 'diameter',
  mm: (tool) => tool.diameter_mm,
  change: (diameter_mm) => ({ diameter_mm }),
};
const THICKNESS: ToolSize = {
  name: 'thickness',
  mm: (tool) => tool.thickness_mm,
  change: (thickness_mm) => ({ thickness_mm }),
};
const LENGTH: ToolSize = { name: 'length', mm: (tool) => tool.length_mm, change: (length_mm) => ({ length_mm }) };
const OPENING: ToolSize = { name: 'opening', mm: (tool) => tool.opening_mm, change: (opening_mm) => ({ opening_mm }) };

/** Faces that meet at a larger angle have an edge. */
const EDGE_ANGLE_DEG = 25;
const sharpEdges = (solid: BufferGeometry): BufferGeometry => new EdgesGeometry(solid, EDGE_ANGLE_DEG);

/** A cylinder about z, with flat ends. */
const round = (name: string, height: ToolSize): ToolShape => ({
  name,
  sizes: [DIAMETER, height],
  longest_m: (tool) => Math.max(tool.diameter_mm, height.mm(tool)) / 1000,
  reach_m: (tool) => Math.hypot(tool.diameter_mm, height.mm(tool)) / 2000,
  dig_tilt_deg: 0,
  jaws: false,
  solid: 'cylinder',
  half_m: (tool) => [tool.diameter_mm / 2000, tool.diameter_mm / 2000, height.mm(tool) / 2000],
  geometry: (tool) => {
    const radius_m = tool.diameter_mm / 2000;
    return new CylinderGeometry(radius_m, radius_m, height.mm(tool) / 1000, 64).rotateX(Math.PI / 2);
  },
  edges: sharpEdges,
  extras: (tool, { handle }) => [stick(height.mm(tool) / 2000, tool.diameter_mm / 1000, 0.045, handle)],
});

export const TOOL_SHAPES = {
  box: {
    name: 'shovel',
    sizes: EDGES,
    longest_m: (tool) => Math.max(...tool.size_mm) / 1000,
    reach_m: (tool) => Math.hypot(...tool.size_mm) / 2000,
    dig_tilt_deg: 55,
    jaws: false,
    solid: 'box',
    half_m: (tool) => tool.size_mm.map((mm) => mm / 2000) as Vec3,
    geometry: blade,
    edges: sharpEdges,
    extras: shovelHandle,
  },
  sphere: {
    name: 'sphere',
    sizes: [DIAMETER],
    longest_m: (tool) => tool.diameter_mm / 1000,
    reach_m: (tool) => tool.diameter_mm / 2000,
    dig_tilt_deg: 0,
    jaws: false,
    solid: 'sphere',
    half_m: (tool) => [tool.diameter_mm / 2000, tool.diameter_mm / 2000, tool.diameter_mm / 2000],
    geometry: (tool) => new SphereGeometry(tool.diameter_mm / 2000, 48, 32),
    edges: (solid) => new EdgesGeometry(solid, 0),
    extras: (tool, { handle }) => [stick(tool.diameter_mm / 2000, tool.diameter_mm / 1000, 0.045, handle)],
  },
  plate: round('plate', THICKNESS),
  cylinder: round('cylinder', LENGTH),
  // The edges of jaws (length, width, thickness) are along z, y and x.
  jaws: {
    name: 'jaws',
    sizes: [...EDGES, OPENING],
    longest_m: (tool) => Math.max(...tool.size_mm) / 1000,
    reach_m: (tool) => {
      const [x, y, z] = halfJaw_m(tool);
      return Math.hypot(tool.opening_mm / 2000 + 2 * x, y, z);
    },
    dig_tilt_deg: 0,
    jaws: true,
    solid: 'box',
    half_m: halfJaw_m,
    geometry: rightJaw,
    edges: sharpEdges,
    extras: yoke,
  },
  // A mesh is the complete tool. Its bounding box is not a solid, because soil can be inside it, as in a scoop.
  mesh: {
    name: 'mesh',
    sizes: [],
    longest_m: (tool) => sizeOfMesh(tool.mesh!).longest_m,
    reach_m: (tool) => sizeOfMesh(tool.mesh!).reach_m,
    dig_tilt_deg: 0,
    jaws: false,
    solid: 'none',
    half_m: (tool) => sizeOfMesh(tool.mesh!).half_m,
    geometry: (tool) => meshGeometry(tool.mesh!),
    edges: (_solid, tool) => meshEdges(tool.mesh!, EDGE_ANGLE_DEG),
    extras: () => [],
  },
} satisfies Record<Shape, ToolShape>;

export const shapeOf = (tool: Tool): ToolShape => TOOL_SHAPES[tool.shape];

/** Whether the tool can change to this shape: a mesh has to be loaded first. */
export const canBecome = (tool: Tool, shape: Shape): boolean => shape !== 'mesh' || tool.mesh !== null;
