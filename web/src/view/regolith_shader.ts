// Reflectance of soil, and access to its surface for the shaders of the realistic view. Soil of airless bodies is not
// matt: it is as bright at its edge as at its centre, as the full Moon is (Lommel-Seeliger). It is brighter when
// looking away from the sun, because grains then hide their shadows. Hapke, Theory of Reflectance and Emittance
// Spectroscopy, 2nd ed., Cambridge 2012: chapters 8 and 9; Hapke's B is u_surge / (1 + tan(g/2) / SURGE_WIDTH).

import type { Color, DataTexture, IUniform } from 'three';
import { LIGHT_SHADER, type LightUniforms } from './light_shader';
import { STEEPEST } from './soil_texture';

export interface RegolithUniforms extends LightUniforms {
  u_surface: IUniform<DataTexture>;
  u_tile: IUniform<DataTexture>;
  u_level_m: IUniform<number>;
  u_soil: IUniform<Color>;
  u_lunar: IUniform<number>;
  u_surge: IUniform<number>;
  u_sky: IUniform<number>;
}

export const REGOLITH_SHADER = /* glsl */ `
${LIGHT_SHADER}
#define SURGE_WIDTH 0.11
uniform sampler2D u_surface;    // heights of the surface and of the shadow over it, drift along x and y, in m
uniform sampler2D u_tile;       // slopes along x and y, brightness, sun
uniform float u_level_m;        // height of the ground around
uniform vec3 u_soil;
uniform float u_lunar;          // 0 matt, 1 as an airless body
uniform float u_surge;          // increase in brightness opposite to the sun
uniform float u_sky;            // fraction of the fill light that reaches shadows
uniform int u_colour_mode;      // 0 plain, 1 force, 2 speed, 3 depth, 4 sleep
uniform float u_flatness;       // 0 lit like soil; towards 1, colours match the legend
uniform float u_depth_range_m;
uniform vec3 u_map[9];
uniform vec3 u_asleep;
uniform vec3 u_awake;

bool inField(vec2 uv) {
  return all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)));
}

// Outside the field there is level ground in the sun.
vec4 surfaceAt(vec2 at_m) {
  vec2 uv = (at_m - u_field_rect.xy) * u_field_rect.zw;
  return inField(uv) ? textureLod(u_surface, uv, 0.0) : vec4(u_level_m, -1.0, 0.0, 0.0);
}

vec2 tileSlope(vec4 tile) {
  return (tile.xy - 0.5) * ${(2 * STEEPEST).toFixed(1)};
}

vec3 mapped(float value) {
  float at = clamp(value, 0.0, 1.0) * 8.0;
  int low = min(int(at), 7);
  return mix(u_map[low], u_map[low + 1], at - float(low));
}

vec3 albedoOf(float speed_byte, float force_byte, float asleep, float height_m) {
  if (u_colour_mode == 1) return mapped(force_byte < 0.5 ? 0.0 : (6.0 * (force_byte - 1.0) / 254.0 - 1.0) / 5.0);
  if (u_colour_mode == 2) return mapped(max(speed_byte - 1.0, 0.0) / 254.0);
  if (u_colour_mode == 3) return mapped(1.0 - (u_level_m - height_m) / u_depth_range_m);
  if (u_colour_mode == 4) return mix(u_awake, u_asleep, asleep);
  return u_soil;
}

vec3 litSoil(vec3 albedo, vec3 normal, vec3 to_eye, float sun, float sky) {
  float into = max(dot(normal, u_to_sun), 0.0);
  float out_of = max(dot(normal, to_eye), 0.12);
  float phase = dot(to_eye, u_to_sun);
  float half_tan = sqrt(max(0.0, 1.0 - phase) / max(1e-3, 1.0 + phase));
  float surge = 1.0 + u_surge / (1.0 + half_tan / SURGE_WIDTH);
  float back = mix(into, 1.25 * into / (into + out_of), u_lunar) * surge;
  vec3 light = u_sun * (0.47 * back * sun) + u_fill * (u_sky * sky * (0.6 + 0.4 * normal.z));
  vec3 flat_light = vec3(0.62 + 0.26 * into * sun + 0.12 * sky);
  return albedo * mix(light, flat_light, u_flatness);
}
`;
