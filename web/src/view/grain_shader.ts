// One particle: a square that faces the eye, in which each pixel intersects its ray with the sphere. Light and depth
// are those of the sphere, so particles intersect each other, the tool and the floor correctly. Everything is in the
// scene's frame: the ray is the same for a screen and for either eye of a headset.

import { LIGHT_SHADER } from './light_shader';

export const GRAIN_VERTEX_SHADER = /* glsl */ `
precision highp float;
precision highp int;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
in vec3 position;
${LIGHT_SHADER}
in float a_radius_m;
in vec4 a_record;               // normalised: x, y, z in the range; (speed + 256 force) / 65535
uniform vec3 u_quantised_low_m;
uniform vec3 u_quantised_high_m;
uniform int u_colour_mode;      // 0 plain, 1 force, 2 speed, 3 depth, 4 sleep
uniform float u_surface_m;
uniform float u_depth_range_m;
uniform vec3 u_soil;
uniform vec3 u_map[9];
uniform vec3 u_asleep;
uniform vec3 u_awake;

flat out vec3 v_centre_m;
flat out vec3 v_eye_m;
flat out vec3 v_albedo;
flat out vec4 v_sky;
flat out float v_sun;
flat out float v_seed;
flat out float v_radius_m;
out vec3 v_at_m;

vec3 mapped(float value) {
  float at = clamp(value, 0.0, 1.0) * 8.0;
  int low = min(int(at), 7);
  return mix(u_map[low], u_map[low + 1], at - float(low));
}

float random(uint seed) {
  seed = seed * 747796405u + 2891336453u;
  seed = ((seed >> ((seed >> 28u) + 4u)) ^ seed) * 277803737u;
  return float((seed >> 22u) ^ seed & 0xffffu) / 66559.0;
}

vec3 albedoOf(float speed_byte, float force_byte, float height_m) {
  if (u_colour_mode == 1) return mapped(force_byte < 0.5 ? 0.0 : (6.0 * (force_byte - 1.0) / 254.0 - 1.0) / 5.0);
  if (u_colour_mode == 2) return mapped(max(speed_byte - 1.0, 0.0) / 254.0);
  if (u_colour_mode == 3) return mapped(1.0 - (u_surface_m - height_m) / u_depth_range_m);
  if (u_colour_mode == 4) return speed_byte < 0.5 ? u_asleep : u_awake;
  return u_soil;
}

void main() {
  v_centre_m = mix(u_quantised_low_m, u_quantised_high_m, a_record.xyz);
  float state = floor(a_record.w * 65535.0 + 0.5);
  float force_byte = floor(state / 256.0);
  float speed_byte = state - 256.0 * force_byte;

  // The eye in the scene's frame; the view may be rotated, translated and scaled, not sheared.
  mat3 turn = mat3(modelViewMatrix);
  v_eye_m = -(modelViewMatrix[3].xyz * turn) / dot(turn[0], turn[0]);

  v_radius_m = a_radius_m;
  v_sky = openSky(v_centre_m, a_radius_m);

  // Particles deep below the surface are visible only through a wall that faces the eye.
  vec2 to_wall_m = u_box_half_m - v_centre_m.xy * sign(v_eye_m.xy);
  bvec2 at_seen_wall = bvec2(abs(v_eye_m.x) > u_box_half_m.x && to_wall_m.x < 3.0 * u_radius_m,
                             abs(v_eye_m.y) > u_box_half_m.y && to_wall_m.y < 3.0 * u_radius_m);
  bool buried = !any(at_seen_wall);
  for (int i = 0; i < 4 && buried; ++i) {
    vec2 way = 1.8 * u_radius_m * vec2(i < 2 ? 1.0 : -1.0, (i & 1) == 0 ? 1.0 : -1.0);
    buried = soilHeight(v_centre_m.xy + way).y > v_centre_m.z + 3.5 * u_radius_m;
  }

  vec3 from_eye = v_centre_m - v_eye_m;
  float distance_m = length(from_eye);
  if (buried || distance_m < 1.2 * a_radius_m) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }

  // The square is at the sphere's nearest point to the eye, with the size of the cone around the sphere there.
  vec3 forward = from_eye / distance_m;
  vec3 right = normalize(cross(forward, abs(forward.z) > 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0)));
  vec3 up = cross(right, forward);
  float near_m = distance_m - a_radius_m;
  float half_m = near_m * a_radius_m * inversesqrt(distance_m * distance_m - a_radius_m * a_radius_m);
  v_at_m = v_eye_m + forward * near_m + (right * position.x + up * position.y) * half_m;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(v_at_m, 1.0);

  v_seed = random(uint(gl_InstanceID));
  // Particles of soil differ in brightness, which makes single ones visible as they move. Colours for numbers vary
  // less, so that the legend is still valid.
  float spread = u_colour_mode == 0 ? 0.30 : 0.08;
  v_albedo = albedoOf(speed_byte, force_byte, v_centre_m.z) * (1.0 + spread * (v_seed - 0.5));
#ifdef SUN_PER_GRAIN
  v_sun = sunOverSoil(v_centre_m + vec3(0.0, 0.0, 0.4 * a_radius_m), a_radius_m, 8);
#else
  v_sun = 1.0;
#endif
}
`;

export const GRAIN_FRAGMENT_SHADER = /* glsl */ `
#ifdef CONSERVATIVE_DEPTH
// The sphere is nowhere nearer than its square, so pixels behind other particles need not be computed.
#extension GL_EXT_conservative_depth : enable
#endif
precision highp float;
precision highp int;
#ifdef CONSERVATIVE_DEPTH
layout(depth_greater) out highp float gl_FragDepth;
#endif
${LIGHT_SHADER}
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform float u_flatness;       // 0 lit like soil; towards 1, colours match the legend

flat in vec3 v_centre_m;
flat in vec3 v_eye_m;
flat in vec3 v_albedo;
flat in vec4 v_sky;
flat in float v_sun;
flat in float v_seed;
flat in float v_radius_m;
in vec3 v_at_m;
layout(location = 0) out vec4 o_colour;


void main() {
  vec3 ray = normalize(v_at_m - v_eye_m);
  vec3 from_centre = v_eye_m - v_centre_m;
  float nearest_m = -dot(from_centre, ray);
  vec3 miss = from_centre + nearest_m * ray;
  float inside = 1.0 - dot(miss, miss) / (v_radius_m * v_radius_m);
  float edge = fwidth(inside);
  if (inside <= 0.0) discard;
  vec3 at_m = v_eye_m + (nearest_m - sqrt(inside) * v_radius_m) * ray;
  vec3 normal = (at_m - v_centre_m) / v_radius_m;

  vec4 clip = projectionMatrix * modelViewMatrix * vec4(at_m, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;

  vec3 albedo = v_albedo;
#ifdef GRAIN_DETAIL
  // A rough surface, fading out where a particle is only a few pixels wide.
  float detail = clamp(1.0 - 9.0 * edge, 0.0, 1.0) * (1.0 - u_flatness);
  if (detail > 0.0) {
    vec4 rough = texture(u_noise, normal * 0.31 + v_seed * 13.7);
    albedo *= 1.0 + detail * 0.9 * (rough.r - 0.5);
    normal = normalize(normal - detail * 0.8 * (rough.gba - 0.5));
  }
#endif

  // Soil next to this point that is higher than the point blocks light.
  vec3 outside_m = at_m + 0.55 * v_radius_m * normal;
  float covered = clamp((soilHeight(outside_m.xy).y - outside_m.z) / (2.2 * v_radius_m), 0.0, 1.0);
  float crevice = (1.0 - 0.72 * covered) * clamp(0.55 + 0.9 * distanceToTool(outside_m) / v_radius_m, 0.4, 1.0);

#ifdef SUN_PER_GRAIN
  float sun = v_sun;
#else
  float sun = sunOverSoil(at_m, v_radius_m, 9);
#endif
  sun *= sunPastTool(at_m) * sunPastFlying(at_m);
  float facing = max(dot(normal, u_to_sun), 0.0);
  // Soil scatters back more evenly than a matt sphere: its terminator is steeper, its centre flatter.
  facing = facing * (1.35 - 0.35 * facing);
  float sky = v_sky.w * (0.62 + 0.38 * dot(normal, normalize(v_sky.xyz)));
  vec3 light = u_sun * facing * sun * 0.42 + u_fill * sky * crevice * 0.8 + u_fill * 0.05;
  vec3 flat_light = vec3(0.62 + 0.26 * facing * sun + 0.12 * sky) * mix(0.75, 1.0, crevice);
  o_colour = vec4(albedo * mix(light, flat_light, u_flatness), clamp(inside / edge, 0.0, 1.0));
  o_colour.rgb = toScreen(o_colour.rgb);
}
`;
