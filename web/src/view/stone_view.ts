// Stones: rock with an individual colour and fracture facets, in the same light as the soil.

import type { Frame, Scene, Stone } from 'haptolith-protocol';
import { BufferGeometry, Color, GLSL3, Group, Mesh, ShaderMaterial, SphereGeometry } from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { LIGHT_SHADER, type LightUniforms } from './light_shader';
import { flatGeometry } from './mesh_geometry';
import { place } from './tool_view';

const ROCK = '#6f665b';
// Variation of the colour's hue, saturation and lightness between stones.
const SPREAD = { h: 0.02, s: 0.06, l: 0.09 } as const;

const VERTEX_SHADER = /* glsl */ `
uniform mat4 u_scene_T_stone;
out vec3 v_at_stone_m;
out vec3 v_at_m;
out vec3 v_normal;
void main() {
  v_at_stone_m = position;
  v_at_m = (u_scene_T_stone * vec4(position, 1.0)).xyz;
  v_normal = mat3(u_scene_T_stone) * normal;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}
`;

const FRAGMENT_SHADER = /* glsl */ `
${LIGHT_SHADER}
uniform mat4 u_scene_T_stone;
uniform vec3 u_rock;
uniform float u_size_m;         // radius of the bounding sphere
uniform float u_seed;
in vec3 v_at_stone_m;
in vec3 v_at_m;
in vec3 v_normal;
layout(location = 0) out vec4 o_colour;

void main() {
  // Stains as wide as a facet, and a rough surface.
  vec3 at = v_at_stone_m / u_size_m + 13.7 * u_seed;
  vec4 stains = texture(u_noise, 0.23 * at);
  vec4 rough = texture(u_noise, 1.1 * at);
  vec3 albedo = u_rock * (1.0 + 0.5 * (stains.r - 0.5) + 0.7 * (rough.r - 0.5));
  vec3 lean = 0.25 * (stains.gba - 0.5) + 0.5 * (rough.gba - 0.5);
  vec3 normal = normalize(normalize(v_normal) - mat3(u_scene_T_stone) * lean);

  // The height field also contains the stone, so covering soil is sampled next to it.
  vec3 outside_m = v_at_m + 1.5 * u_radius_m * normalize(v_normal);
  float covered = clamp((soilHeight(outside_m.xy).y - outside_m.z) / (2.2 * u_radius_m), 0.0, 1.0);
  float crevice = (1.0 - 0.72 * covered) * clamp(0.55 + 0.9 * distanceToTool(outside_m) / u_radius_m, 0.4, 1.0);
  float sun = sunOverSoil(v_at_m, u_radius_m, 9) * sunPastTool(v_at_m) * sunPastFlying(v_at_m);
  float facing = max(dot(normal, u_to_sun), 0.0);
  vec4 open = openSky(outside_m, u_radius_m);
  float sky = open.w * (0.62 + 0.38 * dot(normal, normalize(open.xyz)));
  vec3 light = u_sun * facing * sun * 0.42 + u_fill * sky * crevice * 0.8 + u_fill * 0.05;
  o_colour = linearToOutputTexel(vec4(albedo * light, 1.0));
}
`;

export class StoneView {
  readonly group = new Group();
  private stones: Mesh<BufferGeometry, ShaderMaterial>[] = [];
  private scene = 0;
  private poses: Float32Array = new Float32Array();

  constructor(private readonly light: LightUniforms) {
    this.group.visible = false;
  }

  setScene({ scene, stones = [] }: Scene): void {
    for (const { geometry, material } of this.stones) {
      geometry.dispose();
      material.dispose();
    }
    this.stones = stones.map((stone, i) => this.make(stone, i));
    this.group.clear();
    for (const stone of this.stones) this.group.add(stone);
    if (scene !== this.scene) this.poses = new Float32Array();
    this.scene = scene;
    this.put();
  }

  /** Applies a frame; true if the stones have moved. */
  setFrame({ stones }: Frame): boolean {
    const moved = stones.length !== this.poses.length || stones.some((value, i) => value !== this.poses[i]);
    if (!moved) return false;
    this.poses = stones;
    this.put();
    return true;
  }

  /** Returns the corners of each stone's triangles, nine numbers per triangle. */
  trianglesInScene(): Float32Array[] {
    if (!this.group.visible) return [];
    return this.stones.map(({ geometry, matrix }) => {
      const corners = geometry.getAttribute('position').clone();
      return corners.applyMatrix4(matrix).array as Float32Array;
    });
  }

  /** Places the stones; they are hidden until a frame contains their poses. */
  private put(): void {
    this.group.visible = this.poses.length === 7 * this.stones.length;
    if (!this.group.visible) return;
    this.stones.forEach((mesh, i) => {
      const [x, y, z, qw, qx, qy, qz] = this.poses.subarray(7 * i, 7 * i + 7) as unknown as SevenNumbers;
      place(mesh, { position_m: [x, y, z], rotation: [qw, qx, qy, qz] });
      mesh.updateMatrix();
    });
  }

  private make(stone: Stone, i: number): Mesh<BufferGeometry, ShaderMaterial> {
    const geometry = geometryOf(stone);
    geometry.computeBoundingSphere();
    const [h, s, l] = [0.618, 0.755, 0.57].map((step) => ((i + 1) * step) % 1) as [number, number, number];
    const rock = new Color(ROCK).offsetHSL(SPREAD.h * (h - 0.5), SPREAD.s * (s - 0.5), SPREAD.l * (l - 0.5));
    const mesh = new Mesh(geometry, new ShaderMaterial());
    mesh.material.setValues({
      glslVersion: GLSL3,
      vertexShader: VERTEX_SHADER,
      fragmentShader: FRAGMENT_SHADER,
      uniforms: {
        ...this.light,
        u_scene_T_stone: { value: mesh.matrix },
        u_rock: { value: rock },
        u_size_m: { value: geometry.boundingSphere!.radius },
        u_seed: { value: h },
      },
    });
    return mesh;
  }
}

type SevenNumbers = [number, number, number, number, number, number, number];

function geometryOf(stone: Stone): BufferGeometry {
  if (!('spheres' in stone)) return flatGeometry(stone);
  const balls = stone.spheres.map(([x, y, z, radius_m]) => new SphereGeometry(radius_m, 24, 16).translate(x, y, z));
  return mergeGeometries(balls.map((ball) => ball.toNonIndexed()));
}
