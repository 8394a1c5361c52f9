// Small angular grains, one point each: a swarm of them for every visible particle. On the bed they are on the surface.
// In the air and on the tool they alone represent the soil, as a clump.

import { REGOLITH_SHADER } from './regolith_shader';

export const FINE_GRAIN_VERTEX_SHADER = /* glsl */ `
precision highp float;
precision highp int;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
in vec4 position;               // position of a grain in its swarm and its radius, in radii of the particle
in vec4 a_record;               // normalised: x, y, z in the range; (speed + 256 force) / 65535
in vec2 a_particle;             // radius in m, index
in vec3 a_outwards;             // outward direction of its heap
${REGOLITH_SHADER}
uniform vec3 u_quantised_low_m;
uniform vec3 u_quantised_high_m;
uniform float u_swarm;          // number of grains per particle
uniform float u_deepest;        // maximum depth of a particle with grains, in radii
uniform float u_size;           // scale of the grains; fewer ones are larger
uniform float u_height_px;
uniform vec2 u_cell_m;
#define CLOUD_RADII 1.3
#define LYING_SHARE 0.22

flat out vec3 v_albedo;
flat out vec3 v_normal;
flat out vec3 v_right;
flat out vec3 v_up;
flat out vec3 v_to_eye;
flat out vec4 v_light;          // sun, sky, seed, angularity

float random(uint seed) {
  seed = seed * 747796405u + 2891336453u;
  seed = ((seed >> ((seed >> 28u) + 4u)) ^ seed) * 277803737u;
  return float((seed >> 22u) ^ seed & 0xffffu) / 66559.0;
}

void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = 1.0;
  float radius_m = a_particle.x;
  vec3 centre_m = mix(u_quantised_low_m, u_quantised_high_m, a_record.xyz);
  uint number = uint(a_particle.y);
  float over = (centre_m.z - surfaceAt(centre_m.xy).x) / radius_m;
  float aloft = smoothstep(0.0, 0.8, over);
  // On the bed, the surface already shows the fine grains.
  float many = u_swarm * mix(LYING_SHARE, 1.0, aloft);
  float shown = smoothstep(-u_deepest, 0.55 - u_deepest, over) * clamp(many - float(gl_VertexID), 0.0, 1.0);
  bool core = gl_VertexID == 0;
  if (shown <= 0.0 || (core && aloft < 0.5)) return;

  // Each swarm is turned differently.
  float turn = 6.2831853 * random(number);
  vec3 way = position.xyz;
  way.xy = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * way.xy;
  if ((number & 1u) == 1u) way = way.zxy;
  vec3 at_m = centre_m + CLOUD_RADII * radius_m * way;
  float size_m = radius_m * position.w * mix(0.5 * min(u_size, 1.6), u_size, aloft) * shown;
  if (core) size_m = 0.65 * radius_m;
  vec4 here = surfaceAt(at_m.xy);
  float lying_m = here.x + 0.35 * size_m;
  at_m.z = max(lying_m, mix(lying_m, at_m.z, aloft));

  mat3 turned = mat3(modelViewMatrix);
  float scale = length(turned[0]);
  vec3 eye_m = -(modelViewMatrix[3].xyz * turned) / (scale * scale);
  v_to_eye = normalize(eye_m - at_m);
  vec4 clip = projectionMatrix * modelViewMatrix * vec4(at_m, 1.0);
  float size_px = size_m * scale * projectionMatrix[1][1] * u_height_px / clip.w;
  if (size_px < 0.7) return;
  gl_Position = clip;
  gl_PointSize = size_px;

  float seed = random(number * 977u + uint(gl_VertexID));
  v_right = normalize(cross(vec3(0.0, 0.0, 1.0) + 1e-3, v_to_eye));
  v_up = cross(v_to_eye, v_right);
  vec3 round_normal = normalize((core ? v_to_eye : way) + 0.4 * a_outwards + vec3(0.0, 0.0, 0.3));
  vec3 bed_normal = vec3(surfaceAt(at_m.xy - vec2(u_cell_m.x, 0.0)).x - here.x,
                         surfaceAt(at_m.xy - vec2(0.0, u_cell_m.y)).x - here.x, 0.0) / vec3(u_cell_m, 1.0);
  // Light penetrates loose soil a little.
  v_normal = normalize(mix(normalize(bed_normal + vec3(0.0, 0.0, 1.0)), round_normal, aloft) + 0.4 * u_to_sun);
  float over_shadow_m = at_m.z - here.y;
  float sun = smoothstep(-0.03 * u_radius_m, 0.07 * u_radius_m, over_shadow_m) * sunPastTool(at_m);
  if (aloft < 0.5) sun *= sunPastFlying(at_m);
  v_light = vec4(sun, mix(0.9, 0.8 + 0.2 * way.z, aloft), seed, core ? 0.0 : 1.0);

  float state = floor(a_record.w * 65535.0 + 0.5);
  float force_byte = floor(state / 256.0);
  float speed_byte = state - 256.0 * force_byte;
  float spread = u_colour_mode == 0 ? 0.36 : 0.12;
  v_albedo = albedoOf(speed_byte, force_byte, speed_byte < 0.5 ? 1.0 : 0.0, centre_m.z) *
             ((core ? 0.55 : 0.78) + spread * (seed - 0.5));
}
`;

export const FINE_GRAIN_FRAGMENT_SHADER = /* glsl */ `
precision highp float;
precision highp int;
${REGOLITH_SHADER}
flat in vec3 v_albedo;
flat in vec3 v_normal;
flat in vec3 v_right;
flat in vec3 v_up;
flat in vec3 v_to_eye;
flat in vec4 v_light;
layout(location = 0) out vec4 o_colour;

void main() {
  vec2 at = vec2(2.0, -2.0) * (gl_PointCoord - 0.5);
  float turn = 6.2831853 * fract(v_light.z * 7.31);
  at = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * at;
  // Five straight edges, each at another distance.
  vec2 far = vec2(0.0);
  float edge = max(max(at.y / 0.75, dot(at, vec2(0.95, 0.31)) / 0.9),
                   max(dot(at, vec2(-0.95, 0.31)) / 0.62, max(dot(at, vec2(0.59, -0.81)) / 0.7,
                       dot(at, vec2(-0.59, -0.81)) / 0.95)));
  if (edge > 1.0) discard;
  // Three faces that meet near the centre.
  vec2 from_tip = at - vec2(0.1, 0.15);
  vec2 lean = from_tip.y > 0.6 * abs(from_tip.x) ? vec2(0.0, 1.0)
              : from_tip.x > 0.0 ? vec2(0.87, -0.5) : vec2(-0.87, -0.5);
  lean = lean * mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
  vec3 normal = normalize(v_normal + 0.45 * v_light.w * (v_right * lean.x + v_up * lean.y) + 0.15 * v_to_eye);
  o_colour = vec4(toScreen(litSoil(v_albedo, normal, v_to_eye, v_light.x, v_light.y)), 1.0);
}
`;
