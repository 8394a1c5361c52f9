// The bed and the ground around it as one surface of one soil; only a thin line shows the edge of the box.

import { REGOLITH_SHADER } from './regolith_shader';

export const SURFACE_VERTEX_SHADER = /* glsl */ `
precision highp float;
precision highp int;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
in vec3 position;               // z: 0, or the depth of the far mesh under the near one
${REGOLITH_SHADER}
uniform vec2 u_cell_m;
out vec3 v_at_m;
out vec3 v_normal;
out vec4 v_light;               // height over the shadow, drift along x and y, depth below the surroundings
flat out vec3 v_eye_m;

void main() {
  mat3 turn = mat3(modelViewMatrix);
  v_eye_m = -(modelViewMatrix[3].xyz * turn) / dot(turn[0], turn[0]);
  vec4 here = surfaceAt(position.xy);
  vec2 step_m = u_cell_m;
  vec2 slope = vec2(
    surfaceAt(position.xy + vec2(step_m.x, 0.0)).x - surfaceAt(position.xy - vec2(step_m.x, 0.0)).x,
    surfaceAt(position.xy + vec2(0.0, step_m.y)).x - surfaceAt(position.xy - vec2(0.0, step_m.y)).x) / (2.0 * step_m);
  v_normal = vec3(-slope, 1.0);
  v_at_m = vec3(position.xy, here.x + position.z);
  v_light = vec4(here.x - here.y, here.zw, soilHeight(position.xy).y - here.x);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(v_at_m, 1.0);
}
`;

export const SURFACE_FRAGMENT_SHADER = /* glsl */ `
precision highp float;
precision highp int;
${REGOLITH_SHADER}
uniform sampler2D u_state;      // speed byte, force byte, 1 for asleep; of 255
uniform vec3 u_horizon;
uniform float u_haze_m;
uniform float u_edge_m;         // radius at which the ground ends
uniform float u_tile_m;
in vec3 v_at_m;
in vec3 v_normal;
in vec4 v_light;
flat in vec3 v_eye_m;
layout(location = 0) out vec4 o_colour;

void main() {
  vec3 at_m = v_at_m;
#ifdef ENDS
  if (length(at_m.xy) > u_edge_m) discard;
#endif
  vec3 normal = normalize(v_normal);
  vec3 from_eye = at_m - v_eye_m;
  float away_m = length(from_eye);
  vec3 to_eye = -from_eye / away_m;
  vec2 drift_m = v_light.yz;
  float stirred = clamp(length(drift_m) / (0.8 * u_radius_m), 0.0, 1.0);

  // The pattern moves with the soil.
  vec2 on_m = at_m.xy - drift_m;
  vec2 fine_uv = on_m / u_tile_m;
  vec4 fine = texture(u_tile, fine_uv);
  vec4 coarse = texture(u_tile, mat2(0.8, -0.6, 0.6, 0.8) * fine_uv * 0.237 + 0.37);
  // Mixed soil has lost its pattern, and the tile would be torn into streaks; on a steep wall, seen from above, it
  // would be stretched.
  vec2 still_uv = at_m.xy / u_tile_m;
  vec2 dx = dFdx(still_uv), dy = dFdy(still_uv);
  float rise_x = dFdx(at_m.z) / u_tile_m, rise_y = dFdy(at_m.z) / u_tile_m;
  float mixed = smoothstep(0.35, 0.9, (length(dFdx(drift_m)) + length(dFdy(drift_m))) / u_tile_m / (length(dx) + length(dy)));
  float steep = smoothstep(0.82, 0.62, normal.z);
  if (mixed > 0.0) fine = mix(fine, textureGrad(u_tile, still_uv, dx, dy), mixed);
  if (steep > 0.0) {
    bool along_x = abs(normal.y) > abs(normal.x);
    vec4 wall = textureGrad(u_tile, vec2(along_x ? still_uv.x : still_uv.y, at_m.z / u_tile_m) + 0.61,
                            vec2(along_x ? dx.x : dx.y, rise_x), vec2(along_x ? dy.x : dy.y, rise_y));
    fine = mix(fine, wall, steep);
  }
  vec4 hummocks = texture(u_noise, vec3(still_uv / 7.0, 0.4)) - 0.5;
  vec4 swells = texture(u_noise, vec3(still_uv / 41.0, 0.7)) - 0.5;
  vec2 slope = (0.6 + 0.3 * stirred) * tileSlope(fine) + (0.2 + 0.2 * stirred) * tileSlope(coarse) +
               0.35 * hummocks.gb + 0.4 * swells.gb;
  normal = normalize(normal - vec3(slope * (1.0 - u_flatness), 0.0));

  // The shadow of a single grain is hard; that of a heap has the sun's soft edge.
  float sun = smoothstep(-0.03 * u_radius_m, 0.07 * u_radius_m, v_light.x);
  sun *= mix(1.0, fine.a * mix(1.0, coarse.a, 0.3), (0.55 + 0.25 * stirred) * (1.0 - u_flatness));
  if (sun > 0.0) sun *= sunPastTool(at_m) * sunPastFlying(at_m);
  float deep = clamp(v_light.w / (2.0 * u_radius_m), 0.0, 1.0);
  float sky = 1.0 - 0.6 * deep;
  // Loops that run once; sky_view.ts gives the reason.
  for (int near = distance(at_m, u_tool_origin_m) < u_tool_reach_m + u_radius_m ? 0 : 1; near < 1; ++near)
    sky *= clamp(0.45 + 0.9 * distanceToTool(at_m) / u_radius_m, 0.3, 1.0);

  vec3 state = vec3(0.0);
  bool tinted = u_colour_mode > 0;
  vec2 beyond_m = abs(at_m.xy) - u_box_half_m;
  float outside_m = max(beyond_m.x, beyond_m.y);
  for (int paint = tinted ? 0 : 1; paint < 1; ++paint)
    state = textureLod(u_state, (at_m.xy - u_field_rect.xy) * u_field_rect.zw, 0.0).rgb * 255.0;
  vec3 albedo = tinted && outside_m < 0.0 ? albedoOf(state.r, state.g, state.b / 255.0, at_m.z) : u_soil;
  albedo *= 1.0 + (0.9 * (fine.b - 0.5) + 0.3 * (coarse.b - 0.5) + 0.16 * hummocks.r + 0.2 * swells.r) * (1.0 - 0.8 * u_flatness);
  albedo *= 1.0 - 0.08 * stirred;
  vec3 colour = litSoil(albedo, normal, to_eye, sun, sky);

  // Boundary of the soil that can be dug.
  float line = 1.0 - smoothstep(0.4, 1.1, abs(outside_m) / fwidth(outside_m));
  colour = mix(colour, vec3(0.9, 0.95, 1.0), 0.11 * line);
  colour = mix(colour, u_horizon, 1.0 - exp(-away_m / u_haze_m));
  o_colour = vec4(toScreen(colour), 1.0);
}
`;
