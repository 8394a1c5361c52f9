// The ground around the box and the floor in it, with the shadows of soil and tool. In a headset the ground shrinks to
// the top of a table.

import type { Scene } from 'haptolith-protocol';
import { CircleGeometry, Color, GLSL3, Mesh, ShaderMaterial } from 'three';
import { lookOf } from './body_looks';
import { LIGHT_SHADER, type LightUniforms } from './light_shader';

const VERTEX_SHADER = /* glsl */ `
out vec3 v_at_m;
flat out vec3 v_eye_m;
void main() {
  mat3 turn = mat3(modelViewMatrix);
  v_eye_m = -(modelViewMatrix[3].xyz * turn) / dot(turn[0], turn[0]);
  v_at_m = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}
`;

const FRAGMENT_SHADER = /* glsl */ `
${LIGHT_SHADER}
uniform vec3 u_soil;
uniform vec3 u_horizon;
uniform float u_haze_m;
uniform float u_edge_m;         // radius at which the ground ends
in vec3 v_at_m;
flat in vec3 v_eye_m;
layout(location = 0) out vec4 o_colour;

// Roughness of many sizes, and its slope towards the sun; the texture's mipmaps remove details smaller than a pixel.
vec2 roughness(vec2 at_m) {
  vec2 sum = vec2(0.0);
  float size_m = 60.0 * u_radius_m;
  float weight = 0.5;
  vec2 towards = normalize(u_to_sun.xy);
  for (int i = 0; i < OCTAVES; ++i) {
    vec4 here = texture(u_noise, vec3(at_m / size_m, 0.37 * float(i)));
    sum += weight * vec2(here.r - 0.5, dot(here.gb - 0.5, towards));
    size_m *= 0.23;
    at_m = mat2(0.8, -0.6, 0.6, 0.8) * at_m;
    towards = mat2(0.8, -0.6, 0.6, 0.8) * towards;
    weight *= 0.9;
  }
  return sum;
}

void main() {
  vec3 at_m = v_at_m;
  vec2 beyond_m = abs(at_m.xy) - u_box_half_m;
  float outside_m = max(beyond_m.x, beyond_m.y);
  float pixel = max(length(dFdx(at_m.xy)), length(dFdy(at_m.xy)));

  vec2 rough = roughness(at_m.xy);
  float facing = clamp(u_to_sun.z * (1.0 - 1.5 * rough.y), 0.0, 1.0);

  float sun = sunOverSoil(at_m, u_radius_m, SUN_STEPS) * sunPastTool(at_m) * sunPastFlying(at_m);
  float covered = clamp(soilHeight(at_m.xy).y / (3.0 * u_radius_m), 0.0, 1.0);
  float beside = outside_m < 0.0 ? 1.0 : clamp(0.62 + outside_m / (9.0 * u_radius_m), 0.0, 1.0);
  vec3 albedo = u_soil * (0.62 + 0.22 * rough.x);
  vec3 colour = albedo * (u_sun * facing * sun * 0.42 + u_fill * beside * (1.0 - 0.7 * covered) * 0.7);

  float away_m = distance(at_m, v_eye_m);
  colour = mix(colour, u_horizon, 1.0 - exp(-away_m / u_haze_m));
#ifdef ENDS
  // Only where it is needed, because a shader that may discard runs even for pixels hidden by nearer objects.
  if (length(at_m.xy) > u_edge_m) discard;
#endif
  o_colour = linearToOutputTexel(vec4(colour, 1.0));
}
`;

export class GroundView {
  readonly mesh: Mesh<CircleGeometry, ShaderMaterial>;
  private width_m = 0.126;

  constructor(light: LightUniforms) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX_SHADER,
      fragmentShader: FRAGMENT_SHADER,
      defines: { OCTAVES: '4', SUN_STEPS: '12' },
      uniforms: {
        ...light,
        u_soil: { value: new Color() },
        u_horizon: { value: new Color() },
        u_haze_m: { value: 10 },
        u_edge_m: { value: 0 },
      },
    });
    this.mesh = new Mesh(new CircleGeometry(1, 96), material);
    this.mesh.frustumCulled = false;
    // After the particles, which hide much of it.
    this.mesh.renderOrder = 1;
  }

  setScene(scene: Scene): void {
    const look = lookOf(scene.body);
    const width_m = Math.max(scene.box.width_m, scene.box.length_m);
    const uniforms = this.mesh.material.uniforms;
    (uniforms.u_soil!.value as Color).set(look.soil);
    (uniforms.u_horizon!.value as Color).set(look.horizon);
    uniforms.u_haze_m!.value = look.haze_widths * width_m;
    if (width_m !== this.width_m || this.mesh.userData.sized !== true) this.resize(width_m);
  }

  setDetail(detailed: boolean): void {
    this.define({ OCTAVES: detailed ? '4' : '2', SUN_STEPS: detailed ? '12' : '7' });
  }

  /** Sets the radius at which the ground ends, in widths of the box; null: at the horizon. */
  setEdge(widths: number | null): void {
    this.mesh.material.uniforms.u_edge_m!.value = (widths ?? 0) * this.width_m;
    this.define({ ENDS: widths === null ? undefined : '1' });
  }

  private resize(width_m: number): void {
    this.width_m = width_m;
    this.mesh.geometry.dispose();
    this.mesh.geometry = new CircleGeometry(120 * width_m, 96);
    this.mesh.userData.sized = true;
  }

  private define(changes: Record<string, string | undefined>): void {
    const material = this.mesh.material;
    const wanted: Record<string, string> = { ...(material.defines as Record<string, string>) };
    for (const [name, value] of Object.entries(changes)) {
      if (value === undefined) delete wanted[name];
      else wanted[name] = value;
    }
    if (JSON.stringify(wanted) === JSON.stringify(material.defines)) return;
    material.defines = wanted;
    material.needsUpdate = true;
  }
}
