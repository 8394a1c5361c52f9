// The sky of the body: colour from horizon to zenith, stars, the sun, and a companion that is visible there (larger
// than life). It is drawn around the eye, behind everything.

import { BackSide, Color, GLSL3, Mesh, ShaderMaterial, SphereGeometry, Vector3 } from 'three';
import { lookOf } from './body_looks';

// The ground hides lower directions; a small overlap avoids a gap.
const LOWEST_RAD = (2 * Math.PI) / 180;
const COMPANIONS = { earth: 1, jupiter: 2, charon: 3 } as const;

const VERTEX_SHADER = /* glsl */ `
out vec3 v_way;
void main() {
  v_way = position;
  // Only the direction counts: the sphere is centred on the eye and pushed to the far end.
  vec4 clip = projectionMatrix * vec4(mat3(modelViewMatrix) * position, 1.0);
  gl_Position = clip.xyww;
}
`;

const FRAGMENT_SHADER = /* glsl */ `
uniform vec3 u_zenith;
uniform vec3 u_horizon;
uniform vec3 u_to_sun;
uniform vec3 u_sun;
uniform float u_sun_radius;
uniform float u_stars;
uniform int u_companion;
uniform vec3 u_to_companion;
uniform float u_companion_radius;
in vec3 v_way;
layout(location = 0) out vec4 o_colour;

float hash(vec3 p) {
  p = fract(p * 0.1031);
  p += dot(p, p.zyx + 31.32);
  return fract((p.x + p.y) * p.z);
}

float noise(vec3 p) {
  vec3 cell = floor(p);
  vec3 f = p - cell;
  f = f * f * (3.0 - 2.0 * f);
  vec2 o = vec2(0.0, 1.0);
  return mix(mix(mix(hash(cell), hash(cell + o.yxx), f.x), mix(hash(cell + o.xyx), hash(cell + o.yyx), f.x), f.y),
             mix(mix(hash(cell + o.xxy), hash(cell + o.yxy), f.x), mix(hash(cell + o.xyy), hash(cell + o.yyy), f.x), f.y),
             f.z);
}

float clouds(vec3 p) {
  return 0.5 * noise(p) + 0.27 * noise(p * 2.1) + 0.15 * noise(p * 4.3) + 0.08 * noise(p * 9.1);
}

vec3 starlight(vec3 way) {
  vec3 at = way * 90.0;
  vec3 cell = floor(at);
  float chance = hash(cell + 3.0);
  if (chance < 0.975) return vec3(0.0);
  vec3 place = cell + 0.3 + 0.4 * vec3(hash(cell + 11.0), hash(cell + 23.0), hash(cell + 37.0));
  float size = max(0.10, 0.7 * length(fwidth(at)));
  float bright = pow((chance - 0.975) / 0.025, 3.0) * 0.85 + 0.1;
  vec3 tint = mix(vec3(1.0, 0.86, 0.72), vec3(0.78, 0.87, 1.0), hash(cell + 51.0));
  return tint * bright * (1.0 - smoothstep(0.4 * size, size, length(at - place)));
}

vec3 companionColour(vec3 p) {
  if (u_companion == 1) {
    float land = smoothstep(0.50, 0.54, clouds(p * 2.3 + 4.0));
    float cover = smoothstep(0.46, 0.66, clouds(vec3(p.x, p.y, p.z * 2.2) * 3.1 + 9.0));
    vec3 below = mix(vec3(0.02, 0.09, 0.26), vec3(0.16, 0.19, 0.07), land);
    below = mix(below, vec3(0.9), smoothstep(0.80, 0.90, abs(p.z)));
    return mix(below, vec3(0.95), cover * 0.85);
  }
  if (u_companion == 2) {
    float wave = p.z + 0.02 * (clouds(p * 5.0) - 0.5);
    float bands = 0.5 + 0.5 * sin(wave * 21.0) * cos(wave * 7.0 + 0.6);
    vec3 colour = mix(vec3(0.52, 0.34, 0.22), vec3(0.86, 0.78, 0.66), bands);
    vec2 spot = vec2((p.x + 0.25) * 1.0, (p.z + 0.33) * 1.9);
    return mix(vec3(0.60, 0.24, 0.13), colour, smoothstep(0.14, 0.20, length(spot)));
  }
  return vec3(0.34, 0.32, 0.31) * (0.75 + 0.5 * clouds(p * 4.0));
}

void main() {
  vec3 way = normalize(v_way);
  // A renderer without a graphics card computes both branches of an "if", but skips a loop without iterations.
  // Therefore some loops here run once.
  float up = clamp(way.z, 0.0, 1.0);
  vec3 colour = mix(u_horizon, u_zenith, pow(up, 0.45));
  for (int stars = u_stars > 0.0 ? 0 : 1; stars < 1; ++stars) colour += u_stars * starlight(way);

  float to_sun = dot(way, u_to_sun);
  float sun_edge = cos(u_sun_radius);
  colour += u_sun * smoothstep(sun_edge - fwidth(to_sun), sun_edge + fwidth(to_sun), to_sun) * 2.0;
  colour += u_sun * 0.10 * pow(max(to_sun, 0.0), 900.0) * (1.0 + 4.0 * length(u_zenith));

  vec3 right = normalize(cross(u_to_companion, vec3(0.0, 0.0, 1.0)));
  vec3 above = cross(right, u_to_companion);
  vec2 disc = vec2(dot(way, right), dot(way, above)) / sin(u_companion_radius);
  float reach = length(disc);
  float soft = fwidth(reach);
  bool beside = u_companion == 0 || reach >= 1.1 || dot(way, u_to_companion) <= 0.0;
  for (int companion = beside ? 1 : 0; companion < 1; ++companion) {
    vec3 normal = vec3(disc, sqrt(max(0.0, 1.0 - reach * reach)));
    vec3 sun_seen = normalize(vec3(dot(u_to_sun, right) - 0.3, dot(u_to_sun, above), 0.35));
    float lit = smoothstep(-0.08, 0.35, dot(normal, sun_seen));
    vec3 face = companionColour(vec3(normal.x, normal.z, normal.y)) * (0.02 + 1.05 * lit);
    colour = mix(colour, face, 1.0 - smoothstep(1.0 - 1.5 * soft, 1.0, reach));
    if (u_companion == 1) colour += vec3(0.10, 0.22, 0.5) * lit * smoothstep(1.1, 0.97, reach) * smoothstep(0.8, 1.0, reach);
  }
  o_colour = linearToOutputTexel(vec4(colour, 1.0));
}
`;

export class SkyView {
  readonly mesh: Mesh<SphereGeometry, ShaderMaterial>;
  readonly horizon = new Color();

  constructor(to_sun: Vector3) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX_SHADER,
      fragmentShader: FRAGMENT_SHADER,
      side: BackSide,
      depthWrite: false,
      uniforms: {
        u_zenith: { value: new Color() },
        u_horizon: { value: new Color() },
        u_to_sun: { value: to_sun },
        u_sun: { value: new Color() },
        u_sun_radius: { value: 0.02 },
        u_stars: { value: 0 },
        u_companion: { value: 0 },
        u_to_companion: { value: new Vector3(0.36, 1, 0.17).normalize() },
        u_companion_radius: { value: 0.05 },
      },
    });
    this.mesh = new Mesh(skyDown(Math.PI / 2 + LOWEST_RAD), material);
    this.mesh.frustumCulled = false;
    // After all solid objects, so that only pixels with sky are computed.
    this.mesh.renderOrder = 2;
  }

  /** Sets whether there is also sky below the horizon, as around a table. */
  setAround(around: boolean): void {
    this.mesh.geometry.dispose();
    this.mesh.geometry = skyDown(around ? Math.PI : Math.PI / 2 + LOWEST_RAD);
  }

  setBody(body: string | null): void {
    const look = lookOf(body);
    const uniforms = this.mesh.material.uniforms;
    (uniforms.u_zenith!.value as Color).set(look.zenith);
    (uniforms.u_horizon!.value as Color).set(look.horizon);
    (uniforms.u_sun!.value as Color).set(look.sun);
    uniforms.u_sun_radius!.value = (look.sun_radius_deg * Math.PI) / 180;
    uniforms.u_stars!.value = look.stars;
    uniforms.u_companion!.value = look.companion ? COMPANIONS[look.companion] : 0;
    uniforms.u_companion_radius!.value = look.companion === 'jupiter' ? 0.085 : 0.038;
    this.horizon.set(look.horizon);
  }
}

/** Returns the part of a sphere from the zenith down to an angle. */
function skyDown(angle_rad: number): SphereGeometry {
  return new SphereGeometry(1, 32, 16, 0, 2 * Math.PI, 0, angle_rad).rotateX(Math.PI / 2) as SphereGeometry;
}
