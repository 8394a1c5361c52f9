// Parts of tools. Parts that touch soil have exactly the simulated size; handle, bevel and rims only make a tool
// recognisable.

import type { Tool, Vec3 } from 'haptolith-protocol';
import {
  BoxGeometry,
  CatmullRomCurve3,
  CylinderGeometry,
  ExtrudeGeometry,
  Mesh,
  Shape as Outline,
  TorusGeometry,
  TubeGeometry,
  Vector3,
  type BufferGeometry,
  type Material,
  type Object3D,
} from 'three';

export interface ToolMaterials {
  metal: Material;
  handle: Material;
}

const edges_m = (tool: Tool): Vec3 => tool.size_mm.map((mm) => mm / 1000) as Vec3;

/** Makes a box of exactly this size, with small bevels inside it and a sharpened front edge. */
export function blade(tool: Tool): BufferGeometry {
  const [x, y, z] = edges_m(tool);
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

/** Makes a vertical stick from the centre of a sphere, a plate or a cylinder. */
export function stick(from_m: number, size_m: number, thickness: number, material: Material): Object3D {
  const length_m = 1.6 * size_m;
  const mesh = new Mesh(new CylinderGeometry(thickness * size_m, thickness * size_m, length_m, 24), material);
  mesh.rotation.x = Math.PI / 2;
  mesh.position.z = from_m + length_m / 2;
  return mesh;
}

/** Returns the bulge of a jaw's centre, and the radius of its arc; 0 and null for a flat one. */
function arcOf(tool: Tool): { bulge_m: number; radius_m: number | null; half_rad: number } {
  const [length_m] = edges_m(tool);
  const half_rad = (tool.jaw_bend_deg * Math.PI) / 360;
  if (half_rad === 0) return { bulge_m: 0, radius_m: null, half_rad };
  const radius_m = length_m / (2 * half_rad);
  return { bulge_m: radius_m * (1 - Math.cos(half_rad)), radius_m, half_rad };
}

/** Returns the half extents of the bounding box of one jaw, along the tool's x, y and z. */
export function halfJaw_m(tool: Tool): Vec3 {
  const [length_m, width_m, thickness_m] = edges_m(tool);
  const { bulge_m, radius_m, half_rad } = arcOf(tool);
  const half_height_m = radius_m === null ? length_m / 2 : (radius_m + thickness_m / 2) * Math.sin(half_rad);
  return [(thickness_m + bulge_m) / 2, width_m / 2, half_height_m];
}

/** Makes the right one of two jaws; the left one is its copy, turned about z. */
export function rightJaw(tool: Tool): BufferGeometry {
  const [length_m, width_m, thickness_m] = edges_m(tool);
  const { radius_m, half_rad } = arcOf(tool);
  if (radius_m === null) return new BoxGeometry(thickness_m, width_m, length_m);
  const axis_m = -radius_m * Math.cos(half_rad);
  const profile = new Outline();
  profile.absarc(axis_m, 0, radius_m + thickness_m / 2, -half_rad, half_rad, false);
  profile.absarc(axis_m, 0, radius_m - thickness_m / 2, half_rad, -half_rad, true);
  profile.closePath();
  return new ExtrudeGeometry(profile, { depth: width_m, bevelEnabled: false, curveSegments: 24 })
    .translate(0, 0, -width_m / 2)
    .rotateX(Math.PI / 2);
}

/** Makes a beam on which the jaws slide, and a stick to hold it. */
export function yoke(tool: Tool, { handle }: ToolMaterials): Object3D[] {
  const [, width_m, thickness_m] = edges_m(tool);
  const height_m = 2 * halfJaw_m(tool)[2];
  const across_m = tool.opening_mm / 1000 + 2 * thickness_m;
  const beam_m = 0.12 * height_m;
  const beam = new Mesh(new BoxGeometry(across_m, 0.3 * width_m, beam_m), handle);
  beam.position.z = (height_m + beam_m) / 2;
  return [beam, stick(height_m / 2 + beam_m, height_m, 0.06, handle)];
}

/** Makes rims on both sides and at the back, a socket and a handle that rises backwards to a grip. */
export function shovelHandle(tool: Tool, { metal, handle }: ToolMaterials): Object3D[] {
  const [x, y, z] = edges_m(tool);
  const rim_m = Math.min(0.35 * z, 0.06 * y);
  const rise_m = 0.1 * y;
  const rims: Object3D[] = [];
  for (const side of [-1, 1]) {
    const rim = new Mesh(new BoxGeometry(0.82 * x, rim_m, rise_m), metal);
    rim.position.set(-0.09 * x, side * (y / 2 - rim_m / 2), z / 2 + rise_m / 2);
    rims.push(rim);
  }
  const back = new Mesh(new BoxGeometry(rim_m, y, rise_m), metal);
  back.position.set(-x / 2 + rim_m / 2, 0, z / 2 + rise_m / 2);

  const size_m = Math.max(x, y);
  const start = new Vector3(-0.28 * x, 0, z / 2);
  const neck = new Vector3(-0.52 * x, 0, z / 2 + 0.1 * size_m);
  const end = neck.clone().add(new Vector3(-1.35 * size_m, 0, 1.05 * size_m));
  const middle = neck.clone().lerp(end, 0.35);
  const socket = new Mesh(
    new TubeGeometry(new CatmullRomCurve3([start, neck, neck.clone().lerp(end, 0.12)]), 16, 0.055 * size_m, 16),
    metal,
  );
  const shaft = new Mesh(
    new TubeGeometry(new CatmullRomCurve3([neck.clone().lerp(end, 0.1), middle, end]), 24, 0.036 * size_m, 16),
    handle,
  );
  // A D-shaped grip identifies a shovel at a glance.
  const grip = new Mesh(new TorusGeometry(0.13 * size_m, 0.032 * size_m, 12, 28), handle);
  const along = end.clone().sub(neck).normalize();
  grip.position.copy(end).addScaledVector(along, 0.12 * size_m);
  // The ring is in the plane of the handle's direction and the blade's y axis.
  const normal = new Vector3().crossVectors(along, new Vector3(0, 1, 0)).normalize();
  grip.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
  return [...rims, back, socket, shaft, grip];
}
