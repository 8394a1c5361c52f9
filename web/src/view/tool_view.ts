// The tool at its actual and at its target pose. Its handle is translucent because soil passes through it.

import { isSameTool, type Pose, type Tool } from 'haptolith-protocol';
import {
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Material,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  MeshStandardMaterial,
  Object3D,
} from 'three';
import { shapeOf } from '../tool_shapes';

const METAL = { color: '#b3c1cb', metalness: 0.15, roughness: 0.45 } as const;
const HANDLE = { color: '#d8a04a', transparent: true, opacity: 0.45, depthWrite: false } as const;

export class ToolView {
  /** follows the tool */
  readonly group = new Group();
  /** shows the target pose */
  readonly ghost = new Group();
  private built_for: Tool | null = null;
  /** parts that move along the tool's x when jaws open */
  private jaws: { part: Object3D; side: number }[] = [];
  private jaw_thickness_m = 0;
  private readonly detailed_materials = {
    metal: new MeshStandardMaterial({ ...METAL, flatShading: false }),
    handle: new MeshStandardMaterial({ ...HANDLE, roughness: 0.6 }),
  };
  private readonly plain_materials = {
    metal: new MeshLambertMaterial({ color: METAL.color }),
    handle: new MeshLambertMaterial(HANDLE),
  };
  private materials: { metal: Material; handle: Material } = this.detailed_materials;
  private readonly ghost_lines = new LineBasicMaterial({
    color: '#7fd7e6',
    transparent: true,
    opacity: 0.85,
    depthTest: false,
  });
  private readonly ghost_fill = new MeshBasicMaterial({
    color: '#7fd7e6',
    transparent: true,
    opacity: 0.1,
    depthWrite: false,
    depthTest: false,
  });

  setTool(tool: Tool): void {
    if (this.built_for && isSameTool(tool, this.built_for)) return;
    this.dispose();
    this.built_for = tool;
    const shape = shapeOf(tool);
    const solid = shape.geometry(tool);
    this.jaw_thickness_m = tool.size_mm[2] / 1000;
    for (const side of shape.jaws ? [-1, 1] : [0]) {
      const body = new Mesh(solid, this.materials.metal);
      const fill = new Mesh(solid, this.ghost_fill);
      const lines = new LineSegments(shape.edges(solid, tool), this.ghost_lines);
      fill.renderOrder = 19;
      lines.renderOrder = 20;
      this.group.add(body);
      this.ghost.add(fill, lines);
      if (side !== 0) this.jaws.push(...[body, fill, lines].map((part) => ({ part, side })));
    }
    for (const part of shape.extras(tool, this.materials)) this.group.add(part);
  }

  /** Frees the geometry of the current tool. */
  dispose(): void {
    this.built_for = null;
    dispose(this.group);
    dispose(this.ghost);
    this.jaws = [];
  }

  /** Selects the normal or the cheaper way to draw, for machines with slow graphics. */
  setDetail(detailed: boolean): void {
    const before = this.materials;
    this.materials = detailed ? this.detailed_materials : this.plain_materials;
    this.group.traverse((part) => {
      if (!(part instanceof Mesh)) return;
      if (part.material === before.metal) part.material = this.materials.metal;
      if (part.material === before.handle) part.material = this.materials.handle;
    });
  }

  setPoses(tool: Pose, wished: Pose, show_ghost: boolean, opening_m: number): void {
    for (const { part, side } of this.jaws) {
      part.position.x = (side * (opening_m + this.jaw_thickness_m)) / 2;
      part.rotation.z = side < 0 ? Math.PI : 0;
    }
    place(this.group, tool);
    place(this.ghost, wished);
    this.ghost.visible = show_ghost;
  }
}

export function place(object: Object3D, pose: Pose): void {
  object.position.set(...pose.position_m);
  const [w, x, y, z] = pose.rotation;
  object.quaternion.set(x, y, z, w);
}

function dispose(group: Group): void {
  for (const child of [...group.children]) {
    group.remove(child);
    if (child instanceof Mesh || child instanceof LineSegments) (child.geometry as BufferGeometry).dispose();
  }
}
