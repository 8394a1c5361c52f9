// Dust from digging: motes that leave fast particles, each on a ballistic path. Their number is invented, their motion
// is not: a parabola without air; with air, Stokes' drag on grains of 0.1 mm diameter, tau = rho d^2 / (18 mu).

import { type Range3, speedOf, type Vec3 } from 'haptolith-protocol';
import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  GLSL3,
  Points,
  RawShaderMaterial,
  Vector3,
  Vector4,
  type IUniform,
  type WebGLRenderer,
} from 'three';
import { REGOLITH_SHADER } from './regolith_shader';

const MOST_MOTES = 1500;
/** Slower particles throw none; a faster one throws MOTES_A_METRE motes per second for each m/s. */
const SLOWEST_M_S = 0.12;
const MOTES_A_METRE = 260;
const MOST_A_FRAME = 60;
/** Longest interval between frames from which the motion of a particle can be estimated. */
const LONGEST_STEP_S = 0.1;
const LIFE_S = 3;

const GRAIN_KG_M3 = 2700;
const GRAIN_M = 1e-4;
/** Viscosity of the air in Pa s: nitrogen (Earth) and carbon dioxide (Mars) at the temperature of the ground. */
const VISCOSITY_PA_S: Record<string, number> = { Earth: 1.8e-5, Mars: 1.1e-5 };

/** Returns the time constant with which air slows a mote, in s; null: no air. */
export function slowingTime_s(body: string | null): number | null {
  const viscosity_pa_s = VISCOSITY_PA_S[body ?? ''];
  return viscosity_pa_s === undefined ? null : (GRAIN_KG_M3 * GRAIN_M ** 2) / (18 * viscosity_pa_s);
}

/** Returns the distance that a mote has travelled in t: the shader's equation. */
export function flown_m(velocity_m_s: number, gravity_m_s2: number, tau_s: number | null, t_s: number): number {
  if (tau_s === null) return velocity_m_s * t_s + 0.5 * gravity_m_s2 * t_s * t_s;
  const end_m_s = gravity_m_s2 * tau_s;
  return end_m_s * t_s + (velocity_m_s - end_m_s) * tau_s * (1 - Math.exp(-t_s / tau_s));
}

const VERTEX_SHADER = /* glsl */ `
precision highp float;
precision highp int;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
in vec4 position;               // start position in m, and start time in s
in vec4 a_velocity;             // velocity in m/s, and radius in m
${REGOLITH_SHADER}
uniform float u_time_s;
uniform float u_slowing_s;      // 0: no air
uniform vec3 u_gravity_m_s2;
uniform float u_height_px;
flat out vec3 v_colour;

void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = 1.0;
  v_colour = vec3(0.0);
  float t = u_time_s - position.w;
  if (t < 0.0 || t > ${LIFE_S.toFixed(1)}) return;
  vec3 end = u_gravity_m_s2 * u_slowing_s;
  vec3 at_m = position.xyz + (u_slowing_s > 0.0
    ? end * t + (a_velocity.xyz - end) * u_slowing_s * (1.0 - exp(-t / u_slowing_s))
    : a_velocity.xyz * t + 0.5 * u_gravity_m_s2 * t * t);
  if (at_m.z < surfaceAt(at_m.xy).x) return;  // it has landed
  mat3 turned = mat3(modelViewMatrix);
  float scale = length(turned[0]);
  vec4 clip = projectionMatrix * modelViewMatrix * vec4(at_m, 1.0);
  gl_Position = clip;
  gl_PointSize = clamp(a_velocity.w * scale * projectionMatrix[1][1] * u_height_px / clip.w, 1.0, 6.0);
  vec3 eye_m = -(modelViewMatrix[3].xyz * turned) / (scale * scale);
  vec3 to_eye = normalize(eye_m - at_m);
  float sun = smoothstep(-0.03 * u_radius_m, 0.07 * u_radius_m, at_m.z - surfaceAt(at_m.xy).y) * sunPastTool(at_m);
  v_colour = toScreen(litSoil(0.95 * u_soil, normalize(u_to_sun + 0.4 * to_eye), to_eye, sun, 0.9));
}
`;

const FRAGMENT_SHADER = /* glsl */ `
precision highp float;
flat in vec3 v_colour;
layout(location = 0) out vec4 o_colour;
void main() {
  o_colour = vec4(v_colour, 1.0);
}
`;

export class Dust {
  readonly points: Points<BufferGeometry, RawShaderMaterial>;
  private readonly geometry = new BufferGeometry();
  private readonly from = new BufferAttribute(new Float32Array(4 * MOST_MOTES).fill(-1e3), 4);
  private readonly velocity = new BufferAttribute(new Float32Array(4 * MOST_MOTES), 4);
  private readonly uniforms;
  private most = MOST_MOTES;
  private next = 0;
  private before = new Uint16Array();
  private before_s = -Infinity;
  private quantised: Range3 = { low_m: [0, 0, 0], high_m: [1, 1, 1] };
  private seed = 1972;
  /** false where gravity is hidden from a participant of a study: dust would reveal it, or fly wrongly */
  private gravity_known = false;

  /** @param soil  uniforms of the soil's shaders */
  constructor(soil: Record<string, IUniform>) {
    this.uniforms = {
      ...soil,
      u_time_s: { value: 0 },
      u_slowing_s: { value: 0 },
      u_gravity_m_s2: { value: new Vector3() },
      u_height_px: { value: 720 },
    };
    this.geometry.setAttribute('position', this.from.setUsage(DynamicDrawUsage));
    this.geometry.setAttribute('a_velocity', this.velocity.setUsage(DynamicDrawUsage));
    this.points = new Points(
      this.geometry,
      new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: VERTEX_SHADER,
        fragmentShader: FRAGMENT_SHADER,
        uniforms: this.uniforms,
      }),
    );
    this.points.frustumCulled = false;
    this.points.renderOrder = 1;
    this.points.visible = false;
    const view = new Vector4();
    this.points.onBeforeRender = (renderer, _world, camera) => {
      const { viewport } = camera as { viewport?: Vector4 };
      this.uniforms.u_height_px.value = viewport?.w ?? (renderer as WebGLRenderer).getCurrentViewport(view).w;
      this.points.material.uniformsNeedUpdate = true;
    };
  }

  setWorld(body: string | null, gravity_m_s2: Vec3, quantised: Range3): void {
    this.gravity_known = Math.hypot(...gravity_m_s2) > 0;
    if (!this.gravity_known) this.forget();
    this.uniforms.u_gravity_m_s2.value.set(...gravity_m_s2);
    this.uniforms.u_slowing_s.value = slowingTime_s(body) ?? 0;
    this.quantised = quantised;
  }

  /** Drops the last positions, because there are other particles: no motion is known. */
  forget(): void {
    this.before_s = -Infinity;
    (this.from.array as Float32Array).fill(-1e3);
    this.from.needsUpdate = true;
    this.points.visible = false;
  }

  /** Limits the number of motes. */
  setDetail(detailed: boolean): void {
    this.most = detailed ? MOST_MOTES : MOST_MOTES / 6;
    this.next = 0;
  }

  /** Number of motes in the air, or recently so. */
  get count(): number {
    const { array } = this.from;
    let count = 0;
    for (let i = 3; i < array.length; i += 4) if (this.uniforms.u_time_s.value - array[i]! <= LIFE_S) ++count;
    return count;
  }

  /** Accepts the particles at this time; the fast ones throw dust. */
  take(records: Uint16Array, radii_m: Float32Array, time_s: number): void {
    if (!this.gravity_known) return;
    const step_s = time_s - this.before_s;
    if (step_s < 0) this.forget();
    this.uniforms.u_time_s.value = time_s;
    if (step_s > 0 && step_s <= LONGEST_STEP_S && this.before.length === records.length)
      this.throwFrom(records, radii_m, time_s, step_s);
    if (this.before.length !== records.length) this.before = new Uint16Array(records.length);
    this.before.set(records);
    this.before_s = time_s;
  }

  private throwFrom(records: Uint16Array, radii_m: Float32Array, time_s: number, step_s: number): void {
    const { low_m, high_m } = this.quantised;
    const metre = [0, 1, 2].map((axis) => (high_m[axis]! - low_m[axis]!) / 65535);
    const first = Math.floor(this.random() * radii_m.length); // a fair start, as their number is limited
    let thrown = 0;
    for (let n = 0; n < radii_m.length && thrown < MOST_A_FRAME; ++n) {
      const i = (first + n) % radii_m.length;
      const speed_m_s = speedOf(records[4 * i + 3]! & 255);
      if (speed_m_s < SLOWEST_M_S || this.random() > MOTES_A_METRE * speed_m_s * step_s) continue;
      const at = 4 * this.next;
      const away = [0, 1, 2].map(() => 2 * this.random() - 1);
      const share = 0.6 + 0.6 * this.random();
      for (let axis = 0; axis < 3; ++axis) {
        const now = records[4 * i + axis]!;
        const moved_m_s = ((now - this.before[4 * i + axis]!) * metre[axis]!) / step_s;
        this.from.array[at + axis] = low_m[axis]! + now * metre[axis]! + 0.9 * radii_m[i]! * away[axis]!;
        this.velocity.array[at + axis] = share * moved_m_s + 0.3 * speed_m_s * away[axis]!;
      }
      this.from.array[at + 3] = time_s - step_s * this.random();
      this.velocity.array[at + 3] = radii_m[i]! * (0.02 + 0.06 * this.random() ** 3);
      this.next = (this.next + 1) % this.most;
      ++thrown;
    }
    if (thrown === 0) return;
    this.from.needsUpdate = this.velocity.needsUpdate = true;
    this.points.visible = true;
  }

  private random(): number {
    return (this.seed = (this.seed * 16807) % 2147483647) / 2147483647;
  }
}
