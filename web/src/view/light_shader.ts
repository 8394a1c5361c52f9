// Light on soil, shared by the shaders of the particles and of the ground. Everything is in the scene's frame, in
// metres.
//
// Sun shadow: a short ray march towards the sun over the height field. Fill light: fraction of the sky that the height
// field leaves free. Particles in the air, which are not in the field, cast a round shadow. Shadow of the tool: its
// signed distance, marched along the same ray; the ratio of distance to path length gives the soft edge.

import type { Pose, Scene, Tool } from 'haptolith-protocol';
import {
  Color,
  Data3DTexture,
  DataTexture,
  Matrix3,
  Matrix4,
  Quaternion,
  Vector2,
  Vector3,
  Vector4,
  type IUniform,
} from 'three';
import { shapeOf, SOLIDS } from '../tool_shapes';
import { lookOf } from './body_looks';
import { MOST_FLYING } from './height_field';
import { makeNoiseTexture } from './noise_texture';

/** Direction towards the sun: from the left, a little from the front, 38 degrees high. */
export const TO_SUN = new Vector3(-0.62, -0.48, 0.62).normalize();
/** Direction to a low sun on the same side, 27 degrees high: long shadows. */
export const LOW_SUN = new Vector3(-0.7, -0.36, 0.4).normalize();

export interface LightUniforms {
  [name: string]: IUniform;
  u_noise: IUniform<Data3DTexture>;
  u_field: IUniform<DataTexture>;
  u_field_rect: IUniform<Vector4>;
  u_field_top_m: IUniform<number>;
  /** height of the ground outside the field */
  u_ground_m: IUniform<number>;
  u_flying_m: IUniform<Vector4[]>;
  u_flying_count: IUniform<number>;
  u_flying_around_m: IUniform<Vector4>;
  u_radius_m: IUniform<number>;
  u_box_half_m: IUniform<Vector2>;
  u_to_sun: IUniform<Vector3>;
  u_sun: IUniform<Color>;
  u_fill: IUniform<Color>;
  u_tool_solid: IUniform<number>;
  u_tool_half_m: IUniform<Vector3>;
  u_jaw_middle_m: IUniform<number>;
  u_tool_reach_m: IUniform<number>;
  u_tool_origin_m: IUniform<Vector3>;
  u_tool_T_scene: IUniform<Matrix3>;
}

export function makeLightUniforms(): LightUniforms {
  return {
    u_noise: { value: new Data3DTexture(new Uint8Array(4), 1, 1, 1) },
    u_field: { value: new DataTexture(new Uint8Array(4), 1, 1) },
    u_field_rect: { value: new Vector4(0, 0, 1, 1) },
    u_field_top_m: { value: 0 },
    u_ground_m: { value: 0 },
    u_flying_m: { value: Array.from({ length: MOST_FLYING }, () => new Vector4()) },
    u_flying_count: { value: 0 },
    u_flying_around_m: { value: new Vector4() },
    u_radius_m: { value: 0.007 },
    u_box_half_m: { value: new Vector2(0.1, 0.1) },
    u_to_sun: { value: TO_SUN.clone() },
    u_sun: { value: new Color(1, 1, 1) },
    u_fill: { value: new Color(1, 1, 1) },
    u_tool_solid: { value: 0 },
    u_tool_half_m: { value: new Vector3(0.025, 0.02, 0.0025) },
    u_jaw_middle_m: { value: 0 },
    u_tool_reach_m: { value: 0.04 },
    u_tool_origin_m: { value: new Vector3(0, 0, 1) },
    u_tool_T_scene: { value: new Matrix3() },
  };
}

/** Makes the noise texture for rough surfaces at its first use, because that takes a while. */
export function needNoise(uniforms: LightUniforms): void {
  if (uniforms.u_noise.value.image.width === 1) uniforms.u_noise.value = makeNoiseTexture();
}

export interface Field {
  texture: DataTexture;
  low_x_m: number;
  low_y_m: number;
  width_m: number;
  length_m: number;
}

/** @param ground_m  height of the ground outside the field */
export function lightScene(uniforms: LightUniforms, scene: Scene, field: Field, ground_m: number): void {
  uniforms.u_field.value = field.texture;
  uniforms.u_ground_m.value = ground_m;
  uniforms.u_flying_count.value = 0;
  uniforms.u_field_rect.value.set(field.low_x_m, field.low_y_m, 1 / field.width_m, 1 / field.length_m);
  uniforms.u_radius_m.value = scene.radius_m;
  uniforms.u_box_half_m.value.set(scene.box.width_m / 2, scene.box.length_m / 2);
}

/** Sets the spheres in the air that cast a shadow. */
export function shadeFlying(uniforms: LightUniforms, flying_m: Vector4[], count: number): void {
  uniforms.u_flying_m.value = flying_m;
  uniforms.u_flying_count.value = count;
  const around = uniforms.u_flying_around_m.value.set(0, 0, 0, 0);
  for (let i = 0; i < count; ++i) around.addScaledVector(flying_m[i]!, 1 / count);
  around.w = 0;
  for (let i = 0; i < count; ++i) {
    const { x, y, z, w } = flying_m[i]!;
    around.w = Math.max(around.w, Math.hypot(x - around.x, y - around.y, z - around.z) + w);
  }
}

export function lightBody(uniforms: LightUniforms, body: string | null): void {
  const look = lookOf(body);
  uniforms.u_sun.value.set(look.sun).multiplyScalar(look.sun_strength);
  uniforms.u_fill.value.set(look.fill).multiplyScalar(look.fill_strength);
}

export function shadeTool(uniforms: LightUniforms, tool: Tool): void {
  const shape = shapeOf(tool);
  uniforms.u_tool_solid.value = SOLIDS.indexOf(shape.solid);
  uniforms.u_tool_half_m.value.set(...shape.half_m(tool));
}

const rotation = new Quaternion();
const scratch = new Matrix4();

export function shadeToolAt(uniforms: LightUniforms, tool: Tool, pose: Pose, opening_m: number): void {
  uniforms.u_jaw_middle_m.value = shapeOf(tool).jaws ? opening_m / 2 + uniforms.u_tool_half_m.value.x : 0;
  const { x: half_x, y: half_y, z: half_z } = uniforms.u_tool_half_m.value;
  uniforms.u_tool_reach_m.value = Math.hypot(half_x + uniforms.u_jaw_middle_m.value, half_y, half_z);
  const [w, x, y, z] = pose.rotation;
  uniforms.u_tool_origin_m.value.set(...pose.position_m);
  // The inverse of a rotation is its transpose.
  uniforms.u_tool_T_scene.value
    .setFromMatrix4(scratch.makeRotationFromQuaternion(rotation.set(x, y, z, w)))
    .transpose();
}

export const LIGHT_SHADER = /* glsl */ `
precision highp sampler3D;
uniform sampler3D u_noise;         // height; slope along x, y, z about 0.5
uniform sampler2D u_field;
uniform vec4 u_field_rect;      // low x, low y, 1 / width, 1 / length
uniform float u_field_top_m;
uniform float u_ground_m;
uniform vec4 u_flying_m[${MOST_FLYING}];  // centre, radius
uniform int u_flying_count;
uniform vec4 u_flying_around_m;  // a sphere around all of them
uniform float u_radius_m;       // radius of the coarsest particles
uniform vec2 u_box_half_m;
uniform vec3 u_to_sun;
uniform vec3 u_sun;
uniform vec3 u_fill;
uniform int u_tool_solid;       // 0 box, 1 sphere, 2 cylinder, 3 none: SOLIDS
uniform vec3 u_tool_half_m;     // half extents; for jaws those of one jaw
uniform float u_jaw_middle_m;   // from the tool's origin to the centre of a jaw, 0 with other tools
uniform float u_tool_reach_m;   // radius of its bounding sphere
uniform vec3 u_tool_origin_m;
uniform mat3 u_tool_T_scene;

// Converts to sRGB, as screens and headsets expect it, by square roots alone, because a power costs a renderer without
// a graphics card much more. Error below half a step of 255.
vec3 toScreen(vec3 linear) {
  vec3 light = clamp(linear, 0.0, 1.0);
  vec3 root = sqrt(light);
  vec3 fourth = sqrt(root);
  vec3 curved = 0.662002687 * root + 0.68412206 * fourth - 0.323583601 * sqrt(fourth) - 0.022541147 * light;
  return mix(12.92 * light, curved, step(0.0031308, light));
}

// x: unfiltered height of the soil, y: smoothed; in m. Outside the field the ground is level.
vec2 soilHeight(vec2 at_m) {
  vec2 uv = (at_m - u_field_rect.xy) * u_field_rect.zw;
  if (any(lessThan(uv, vec2(0.0))) || any(greaterThan(uv, vec2(1.0)))) return vec2(u_ground_m);
  return textureLod(u_field, uv, 0.0).xy;
}

// 1 where the sun reaches a point, 0 in shadow. The march starts one radius away, so that a particle is not in the
// shadow of its top.
float sunOverSoil(vec3 from_m, float radius_m, int steps) {
  // Ground beyond the longest shadow returns early.
  vec2 longest_m = u_box_half_m + u_radius_m + max(u_field_top_m - from_m.z, 0.0) * abs(u_to_sun.xy) / u_to_sun.z;
  if (any(greaterThan(abs(from_m.xy), longest_m))) return 1.0;
  float start_m = 1.25 * radius_m;
  float end_m = min((u_field_top_m - from_m.z) / u_to_sun.z, 40.0 * u_radius_m);
  if (end_m <= start_m) return 1.0;
  float light = 1.0;
  for (int i = 0; i < steps; ++i) {
    float share = (float(i) + 0.5) / float(steps);
    float way_m = mix(start_m, end_m, share * mix(share, 1.0, 0.5));  // denser near the particle
    vec3 at_m = from_m + way_m * u_to_sun;
    float free_m = at_m.z - soilHeight(at_m.xy).x;
    light = min(light, 0.5 + free_m / (0.35 * radius_m + 0.10 * way_m));
  }
  return smoothstep(0.0, 1.0, clamp(light, 0.0, 1.0));
}

// Shadows of particles in the air: round, and softer with distance.
float sunPastFlying(vec3 from_m) {
  float light = 1.0;
  // Most points are far from all of their shadows, which a test with their bounding sphere shows.
  vec3 to_all = u_flying_around_m.xyz - from_m;
  float along_all_m = dot(to_all, u_to_sun);
  bool past_all = length(to_all - along_all_m * u_to_sun) > u_flying_around_m.w * 1.35 + 0.06 * max(along_all_m, 0.0);
  // A loop with no iteration instead of an early return; sky_view.ts gives the reason.
  for (int i = past_all ? u_flying_count : 0; i < u_flying_count; ++i) {
    vec3 to_grain = u_flying_m[i].xyz - from_m;
    float radius_m = u_flying_m[i].w;
    float along_m = dot(to_grain, u_to_sun);
    if (along_m < 1.05 * radius_m) continue;  // its surface
    float free_m = length(to_grain - along_m * u_to_sun) - radius_m;
    light = min(light, 0.5 + free_m / (0.35 * radius_m + 0.10 * along_m));
    if (light <= 0.0) break;
  }
  return smoothstep(0.0, 1.0, clamp(light, 0.0, 1.0));
}

// Distance from a point of the scene to the tool's surface, in m; negative inside. Large if there is no solid.
float distanceToTool(vec3 at_m) {
  if (u_tool_solid == 3) return 1e3;
  vec3 p = u_tool_T_scene * (at_m - u_tool_origin_m);
  if (u_tool_solid == 1) return length(p) - u_tool_half_m.x;
  vec3 d = u_tool_solid != 2 ? abs(vec3(abs(p.x) - u_jaw_middle_m, p.yz)) - u_tool_half_m
                             : vec3(length(p.xy) - u_tool_half_m.x, -1.0, abs(p.z) - u_tool_half_m.z);
  return length(max(d, 0.0)) + min(max(d.x, max(d.y, d.z)), 0.0);
}

float sunPastTool(vec3 from_m) {
  // Most points are far from the tool's shadow, which a test with its bounding sphere shows.
  vec3 to_tool = u_tool_origin_m - from_m;
  float along_m = dot(to_tool, u_to_sun);
  float beside_m = length(to_tool - along_m * u_to_sun);
  bool past_it = along_m < -u_tool_reach_m || beside_m > u_tool_reach_m * 1.3 + 0.06 * max(along_m, 0.0);
  float light = 1.0;
  float way_m = 0.15 * u_radius_m;
  for (int i = past_it ? 14 : 0; i < 14; ++i) {
    float free_m = distanceToTool(from_m + way_m * u_to_sun);
    light = min(light, 0.5 + 9.0 * free_m / (way_m + 0.01));
    if (light <= 0.0 || way_m > along_m + u_tool_reach_m) break;
    way_m += max(free_m, 0.12 * u_radius_m);
  }
  return smoothstep(0.0, 1.0, clamp(light, 0.0, 1.0));
}

// Returns the direction of the free part of the sky (not normalised) and its fraction, 0 to 1, above a particle.
vec4 openSky(vec3 at_m, float radius_m) {
  vec3 towards = vec3(0.0, 0.0, 0.6);
  float open = 0.0;
  for (int i = 0; i < 6; ++i) {
    float angle = 1.0471976 * float(i) + 0.4;
    vec2 way = vec2(cos(angle), sin(angle));
    float slope = (soilHeight(at_m.xy + 2.4 * radius_m * way).y - at_m.z) / (2.4 * radius_m);
    slope = max(slope, (soilHeight(at_m.xy + 5.5 * radius_m * way).y - at_m.z) / (5.5 * radius_m));
    slope = max(slope, 0.0);
    float free = 1.0 - slope * inversesqrt(1.0 + slope * slope);
    open += free;
    towards.xy += way * free / 3.0;
  }
  return vec4(towards, open / 6.0);
}
`;
