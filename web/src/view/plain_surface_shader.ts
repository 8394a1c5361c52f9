// The bed and the ground around it for machines with slow graphics. Light is computed at the corners of the mesh. A
// pixel costs two samples of a tile that already contains the light on small grains.

import { REGOLITH_SHADER } from './regolith_shader';

export const PLAIN_SURFACE_VERTEX_SHADER = /* glsl */ `
precision highp float;
precision highp int;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
in vec3 position;               // z: 0, or the depth of the far mesh under the near one
${REGOLITH_SHADER}
uniform vec2 u_cell_m;
uniform sampler2D u_state;      // speed, force and sleep of the topmost particle
uniform vec3 u_horizon;
uniform float u_haze_m;
uniform float u_tile_m;
out vec2 v_at_m;
out vec2 v_tile;                // position in the tile
out vec4 v_lit;                 // colour in the sun; visibility of the tile
out vec4 v_shaded;              // colour in shadow; height over the shadow, in radii
out vec2 v_sun_haze;            // sun past tool and flying particles; fraction of the horizon

void main() {
  vec4 here = surfaceAt(position.xy);
  vec2 slope = (vec2(surfaceAt(position.xy + vec2(u_cell_m.x, 0.0)).x, surfaceAt(position.xy + vec2(0.0, u_cell_m.y)).x) -
                here.x) / u_cell_m;
  vec3 normal = normalize(vec3(-slope, 1.0));
  vec3 at_m = vec3(position.xy, here.x + position.z);
  mat3 turn = mat3(modelViewMatrix);
  vec3 eye_m = -(modelViewMatrix[3].xyz * turn) / dot(turn[0], turn[0]);
  vec3 to_eye = eye_m - at_m;
  float away_m = length(to_eye);
  to_eye /= away_m;

  float deep = clamp((soilHeight(position.xy).y - here.x) / (2.0 * u_radius_m), 0.0, 1.0);
  float sky = 1.0 - 0.6 * deep;
  if (distance(at_m, u_tool_origin_m) < u_tool_reach_m + u_radius_m)
    sky *= clamp(0.45 + 0.9 * distanceToTool(at_m) / u_radius_m, 0.3, 1.0);
  vec3 albedo = u_soil;
  vec2 beyond_m = abs(at_m.xy) - u_box_half_m;
  if (u_colour_mode > 0 && max(beyond_m.x, beyond_m.y) < 0.0) {
    vec3 state = textureLod(u_state, (at_m.xy - u_field_rect.xy) * u_field_rect.zw, 0.0).rgb * 255.0;
    albedo = albedoOf(state.r, state.g, state.b / 255.0, at_m.z);
  }
  albedo *= 1.0 - 0.08 * clamp(length(here.zw) / (0.8 * u_radius_m), 0.0, 1.0);

  v_at_m = at_m.xy;
  // The pattern moves with the soil.
  v_tile = (at_m.xy - here.zw) / u_tile_m;
  // A tile seen from above is stretched on a steep wall.
  v_lit = vec4(toScreen(litSoil(albedo, normal, to_eye, 1.0, sky)),
               (1.0 - u_flatness) * mix(0.35, 1.0, smoothstep(0.45, 0.85, normal.z)));
  v_shaded = vec4(toScreen(litSoil(albedo, normal, to_eye, 0.0, sky)), (here.x - here.y) / u_radius_m);
  v_sun_haze = vec2(sunPastTool(at_m) * sunPastFlying(at_m), 1.0 - exp(-away_m / u_haze_m));
  gl_Position = projectionMatrix * modelViewMatrix * vec4(at_m, 1.0);
}
`;

export const PLAIN_SURFACE_FRAGMENT_SHADER = /* glsl */ `
precision highp float;
uniform sampler2D u_plain_tile; // light on small grains relative to level soil, halved: in the sun, in shadow
uniform vec2 u_box_half_m;
uniform vec3 u_screen_horizon;
uniform float u_edge_m;         // radius at which the ground ends
in vec2 v_at_m;
in vec2 v_tile;
in vec4 v_lit;
in vec4 v_shaded;
in vec2 v_sun_haze;
layout(location = 0) out vec4 o_colour;

void main() {
#ifdef ENDS
  if (length(v_at_m) > u_edge_m) discard;
#endif
  vec2 fine = texture(u_plain_tile, v_tile).rg;
  vec2 coarse = texture(u_plain_tile, mat2(0.8, -0.6, 0.6, 0.8) * v_tile * 0.237 + 0.37).rg;
  vec2 tile = 1.0 + v_lit.a * (fine + 0.5 * coarse - 0.75) * 2.0;
  float sun = v_sun_haze.x * clamp(10.0 * v_shaded.a + 0.3, 0.0, 1.0);
  vec3 colour = mix(v_shaded.rgb * tile.y, v_lit.rgb * tile.x, sun);
  // Boundary of the soil that can be dug.
  vec2 beyond_m = abs(v_at_m) - u_box_half_m;
  float outside_m = max(beyond_m.x, beyond_m.y);
  float line = clamp(1.57 - 1.43 * abs(outside_m) / fwidth(outside_m), 0.0, 1.0);
  colour = mix(colour, vec3(0.95, 0.97, 1.0), 0.2 * line);
  o_colour = vec4(mix(colour, u_screen_horizon, v_sun_haze.y), 1.0);
}
`;
