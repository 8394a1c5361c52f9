// The tool: a shovel, a ball, a round plate or two jaws. What touches soil has exactly the size that the simulation has; handle,
// bevel and rims are there so that it can be recognised, and the handle is translucent because soil passes through it.

import {
  BoxGeometry,
  BufferGeometry,
  CatmullRomCurve3,
  CylinderGeometry,
  EdgesGeometry,
  ExtrudeGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  Object3D,
  Shape as Outline,
  SphereGeometry,
  TorusGeometry,
  TubeGeometry,
  Vector3,
} from 'three';
import type { Pose, Tool } from '../protocol';

const METAL = { color: '#b3c1cb', metalness: 0.15, roughness: 0.45 } as const;
const HANDLE_OPACITY = 0.45;

export class ToolView {
  /** follows the tool */
  readonly group = new Group();
  /** where the hand wants it */
  readonly ghost = new Group();
  private built_for = '';
  /** what moves along the tool's x when jaws open */
  private jaws: { part: Object3D; side: number }[] = [];
  private jaw_thickness_m = 0;
  private readonly metal = new MeshStandardMaterial({ ...METAL, flatShading: false });
  private readonly handle = new MeshStandardMaterial({
    color: '#d8a04a',
    roughness: 0.6,
    transparent: true,
    opacity: HANDLE_OPACITY,
    depthWrite: false,
  });
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
    const wanted = JSON.stringify(tool);
    if (wanted === this.built_for) return;
    this.built_for = wanted;
    dispose(this.group);
    dispose(this.ghost);
    this.jaws = [];
    this.jaw_thickness_m = tool.size_mm[2] / 1000;
    const solid = bodyGeometry(tool);
    for (const side of tool.shape === 'jaws' ? [-1, 1] : [0]) {
      const body = new Mesh(solid, this.metal);
      const fill = new Mesh(solid, this.ghost_fill);
      const lines = new LineSegments(new EdgesGeometry(solid, tool.shape === 'sphere' ? 0 : 25), this.ghost_lines);
      fill.renderOrder = 19;
      lines.renderOrder = 20;
      this.group.add(body);
      this.ghost.add(fill, lines);
      if (side !== 0) this.jaws.push(...[body, fill, lines].map((part) => ({ part, side })));
    }
    this.group.add(...this.extras(tool));
  }

  setPoses(tool: Pose, wished: Pose, show_ghost: boolean, opening_m: number): void {
    for (const { part, side } of this.jaws) part.position.x = (side * (opening_m + this.jaw_thickness_m)) / 2;
    place(this.group, tool);
    place(this.ghost, wished);
    this.ghost.visible = show_ghost;
  }

  private extras(tool: Tool): Object3D[] {
    switch (tool.shape) {
      case 'box':
        return this.shovelExtras(tool.size_mm.map((mm) => mm / 1000) as [number, number, number]);
      case 'sphere':
        return [this.stick(tool.diameter_mm / 2000, tool.diameter_mm / 1000, 0.045)];
      case 'plate':
        return [this.stick(tool.thickness_mm / 2000, tool.diameter_mm / 1000, 0.045)];
      case 'jaws':
        return this.yoke(tool);
    }
  }

  /** A stick straight up from the middle of a ball or a plate. */
  private stick(from_m: number, size_m: number, thickness: number): Object3D {
    const length_m = 1.6 * size_m;
    const mesh = new Mesh(new CylinderGeometry(thickness * size_m, thickness * size_m, length_m, 24), this.handle);
    mesh.rotation.x = Math.PI / 2;
    mesh.position.z = from_m + length_m / 2;
    return mesh;
  }

  /** A beam on which the jaws slide, and a stick to hold it by. */
  private yoke(tool: Tool): Object3D[] {
    const [height_m, width_m, thickness_m] = tool.size_mm.map((mm) => mm / 1000) as [number, number, number];
    const across_m = tool.opening_mm / 1000 + 2 * thickness_m;
    const beam_m = 0.12 * height_m;
    const beam = new Mesh(new BoxGeometry(across_m, 0.3 * width_m, beam_m), this.handle);
    beam.position.z = (height_m + beam_m) / 2;
    return [beam, this.stick(height_m / 2 + beam_m, height_m, 0.06)];
  }

  /** Rims on both sides and at the back, a socket and a handle that rises backwards to a grip. */
  private shovelExtras([x, y, z]: [number, number, number]): Object3D[] {
    const rim_m = Math.min(0.35 * z, 0.06 * y);
    const rise_m = 0.1 * y;
    const rims: Object3D[] = [];
    for (const side of [-1, 1]) {
      const rim = new Mesh(new BoxGeometry(0.82 * x, rim_m, rise_m), this.metal);
      rim.position.set(-0.09 * x, side * (y / 2 - rim_m / 2), z / 2 + rise_m / 2);
      rims.push(rim);
    }
    const back = new Mesh(new BoxGeometry(rim_m, y, rise_m), this.metal);
    back.position.set(-x / 2 + rim_m / 2, 0, z / 2 + rise_m / 2);

    const size_m = Math.max(x, y);
    const start = new Vector3(-0.28 * x, 0, z / 2);
    const neck = new Vector3(-0.52 * x, 0, z / 2 + 0.1 * size_m);
    const end = neck.clone().add(new Vector3(-1.35 * size_m, 0, 1.05 * size_m));
    const middle = neck.clone().lerp(end, 0.35);
    const socket = new Mesh(
      new TubeGeometry(new CatmullRomCurve3([start, neck, neck.clone().lerp(end, 0.12)]), 16, 0.055 * size_m, 16),
      this.metal,
    );
    const shaft = new Mesh(
      new TubeGeometry(new CatmullRomCurve3([neck.clone().lerp(end, 0.1), middle, end]), 24, 0.036 * size_m, 16),
      this.handle,
    );
    // A D-shaped grip says "shovel" at a glance.
    const grip = new Mesh(new TorusGeometry(0.13 * size_m, 0.032 * size_m, 12, 28), this.handle);
    const along = end.clone().sub(neck).normalize();
    grip.position.copy(end).addScaledVector(along, 0.12 * size_m);
    // The ring lies in the plane of the handle's direction and the blade's y axis.
    const normal = new Vector3().crossVectors(along, new Vector3(0, 1, 0)).normalize();
    grip.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
    return [...rims, back, socket, shaft, grip];
  }
}

/** What touches the soil, in m, about the tool's origin. */
function bodyGeometry(tool: Tool): BufferGeometry {
  switch (tool.shape) {
    case 'sphere':
      return new SphereGeometry(tool.diameter_mm / 2000, 48, 32);
    case 'plate': {
      const radius_m = tool.diameter_mm / 2000;
      return new CylinderGeometry(radius_m, radius_m, tool.thickness_mm / 1000, 64).rotateX(Math.PI / 2);
    }
    case 'jaws': {
      const [height_m, width_m, thickness_m] = tool.size_mm.map((mm) => mm / 1000) as [number, number, number];
      return new BoxGeometry(thickness_m, width_m, height_m);
    }
    case 'box':
      return bladeGeometry(tool.size_mm.map((mm) => mm / 1000) as [number, number, number]);
  }
}

/** A box of exactly this size whose edges are broken by a small bevel inside it, and whose front edge is sharpened. */
function bladeGeometry([x, y, z]: [number, number, number]): BufferGeometry {
  const bevel_m = 0.16 * Math.min(x, y, z);
  const outline = new Outline();
  // Side view: x to the right, z up; the front edge at +x is ground from above.
  const grind_m = Math.min(0.1 * x, 1.2 * z);
  outline.moveTo(-x / 2 + bevel_m, -z / 2 + bevel_m);
  outline.lineTo(x / 2 - bevel_m, -z / 2 + bevel_m);
  outline.lineTo(x / 2 - bevel_m, -z / 2 + 0.3 * z);
  outline.lineTo(x / 2 - grind_m, z / 2 - bevel_m);
  outline.lineTo(-x / 2 + bevel_m, z / 2 - bevel_m);
  outline.closePath();
  const geometry = new ExtrudeGeometry(outline, {
    depth: y - 2 * bevel_m,
    bevelEnabled: true,
    bevelThickness: bevel_m,
    bevelSize: bevel_m,
    bevelSegments: 2,
  });
  // Extruded along the outline's normal, which is -y when x stays x and the outline's y becomes z.
  return geometry.rotateX(Math.PI / 2).translate(0, y / 2 - bevel_m, 0);
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
