// Realistic soil: the bed as one surface in the ground of its body, and over it a swarm of small grains for every
// visible particle.

import { COLOUR_MODES, type ColourMode, type Scene } from 'haptolith-protocol';
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  DynamicDrawUsage,
  GLSL3,
  Group,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  LinearFilter,
  Mesh,
  Points,
  RawShaderMaterial,
  RGBAFormat,
  Vector2,
  Vector3,
  Vector4,
  type WebGLRenderer,
} from 'three';
import { lookOf } from './body_looks';
import { Dust } from './dust';
import { ASLEEP_COLOUR, AWAKE_COLOUR, VIRIDIS } from './colour_maps';
import { FINE_GRAIN_FRAGMENT_SHADER, FINE_GRAIN_VERTEX_SHADER } from './fine_grain_shader';
import { LOW_SUN, type LightUniforms } from './light_shader';
import { PLAIN_SURFACE_FRAGMENT_SHADER, PLAIN_SURFACE_VERTEX_SHADER } from './plain_surface_shader';
import { SURFACE_FRAGMENT_SHADER, SURFACE_VERTEX_SHADER } from './surface_shader';
import { surfaceMesh } from './surface_mesh';
import type { SoilSurface } from './soil_surface';
import { makePlainSoilTexture, makeSoilTexture } from './soil_texture';

// Maximum number of small grains in the picture, and per particle.
const BUDGET = { detailed: 120_000, plain: 4_000 } as const;
const SWARM = { detailed: 150, plain: 26 } as const;
// Maximum depth below the surface of particles with a swarm, in radii; in the plain view only those that leave the bed.
const DEEPEST = { detailed: 1.7, plain: 0.3 } as const;
const HORIZON_WIDTHS = 120;
// Width of one tile of fine soil, in widths of the box.
const TILE_WIDTHS = 0.32;

export class SoilView {
  readonly group = new Group();
  readonly dust: Dust;
  private readonly surface: Mesh<BufferGeometry, RawShaderMaterial>;
  private readonly surface_materials;
  private readonly grains: Points<InstancedBufferGeometry, RawShaderMaterial>;
  private readonly uniforms;
  private field: SoilSurface | null = null;
  private radii_m: Float32Array = new Float32Array();
  private state = new DataTexture(new Uint8Array(4), 1, 1, RGBAFormat);
  private mode: ColourMode = 'plain';
  private detailed: boolean | null = null;
  private width_m = 0.126;
  private meshed_for = '';

  constructor(light: LightUniforms) {
    this.uniforms = {
      ...light,
      u_surface: { value: new DataTexture(new Uint8Array(4), 1, 1) },
      u_tile: { value: new DataTexture(new Uint8Array(4), 1, 1) },
      u_plain_tile: { value: new DataTexture(new Uint8Array(4), 1, 1) },
      u_level_m: light.u_ground_m,
      u_soil: { value: new Color() },
      u_lunar: { value: 1 },
      u_surge: { value: 0.8 },
      u_sky: { value: 0.2 },
      u_colour_mode: { value: 0 },
      u_flatness: { value: 0 },
      u_depth_range_m: { value: 0.04 },
      u_map: { value: VIRIDIS.map((colour) => new Color(colour)) },
      u_asleep: { value: new Color(ASLEEP_COLOUR) },
      u_awake: { value: new Color(AWAKE_COLOUR) },
      u_cell_m: { value: new Vector2(0.001, 0.001) },
      u_state: { value: this.state },
      u_horizon: { value: new Color() },
      u_screen_horizon: { value: new Color() },
      u_haze_m: { value: 10 },
      u_edge_m: { value: 0 },
      u_tile_m: { value: 0.05 },
      u_quantised_low_m: { value: new Vector3() },
      u_quantised_high_m: { value: new Vector3() },
      u_swarm: { value: 0 },
      u_deepest: { value: DEEPEST.detailed as number },
      u_size: { value: 1 },
      u_height_px: { value: 720 },
    };
    const material = (vertexShader: string, fragmentShader: string): RawShaderMaterial =>
      new RawShaderMaterial({ glslVersion: GLSL3, vertexShader, fragmentShader, uniforms: this.uniforms });
    this.surface_materials = {
      detailed: material(SURFACE_VERTEX_SHADER, SURFACE_FRAGMENT_SHADER),
      plain: material(PLAIN_SURFACE_VERTEX_SHADER, PLAIN_SURFACE_FRAGMENT_SHADER),
    };
    this.surface = new Mesh(new BufferGeometry(), this.surface_materials.detailed);
    this.grains = new Points(
      new InstancedBufferGeometry(),
      material(FINE_GRAIN_VERTEX_SHADER, FINE_GRAIN_FRAGMENT_SHADER),
    );
    this.surface.frustumCulled = this.grains.frustumCulled = false;
    // The surface hides the lower halves of grains.
    this.grains.renderOrder = 1;
    const view = new Vector4();
    this.grains.onBeforeRender = (renderer, _world, camera) => {
      const { viewport } = camera as { viewport?: Vector4 };
      const height_px = viewport?.w ?? (renderer as WebGLRenderer).getCurrentViewport(view).w;
      this.uniforms.u_height_px.value = height_px;
      this.grains.material.uniformsNeedUpdate = true;
    };
    this.dust = new Dust(this.uniforms);
    this.group.add(this.surface, this.grains, this.dust.points);
  }

  setScene(scene: Scene, depth_range_m: number): void {
    const look = lookOf(scene.body);
    const { uniforms } = this;
    this.width_m = Math.max(scene.box.width_m, scene.box.length_m);
    this.dust.setWorld(scene.body, scene.gravity_m_s2, scene.quantised);
    uniforms.u_soil.value.set(look.soil);
    uniforms.u_horizon.value.set(look.horizon);
    uniforms.u_screen_horizon.value.set(look.horizon).convertLinearToSRGB();
    uniforms.u_haze_m.value = look.haze_widths * this.width_m;
    uniforms.u_lunar.value = look.lunar;
    uniforms.u_surge.value = look.surge;
    uniforms.u_sky.value = look.shadow_fill;
    uniforms.u_tile_m.value = TILE_WIDTHS * this.width_m;
    uniforms.u_depth_range_m.value = depth_range_m;
    uniforms.u_quantised_low_m.value.set(...scene.quantised.low_m);
    uniforms.u_quantised_high_m.value.set(...scene.quantised.high_m);
  }

  /** Sets other particles, and their surface. */
  setParticles(field: SoilSurface, radii_m: Float32Array): void {
    this.field = field;
    this.radii_m = radii_m;
    this.uniforms.u_surface.value = field.texture;
    this.uniforms.u_cell_m.value.set(field.cell_width_m, field.cell_length_m);
    this.state.dispose();
    this.state = new DataTexture(new Uint8Array(4 * field.columns * field.rows), field.columns, field.rows, RGBAFormat);
    this.state.magFilter = this.state.minFilter = LinearFilter;
    this.uniforms.u_state.value = this.state;
    this.mesh();
    this.makeSwarms();
    this.dust.forget();
  }

  setColour(mode: ColourMode): void {
    this.mode = mode;
    this.uniforms.u_colour_mode.value = COLOUR_MODES.indexOf(mode);
    this.uniforms.u_flatness.value = mode === 'plain' ? 0 : 0.75;
  }

  setDetail(detailed: boolean): void {
    if (detailed === this.detailed) return;
    this.detailed = detailed;
    this.surface.material = this.surface_materials[detailed ? 'detailed' : 'plain'];
    // Each tile takes a while to compute, so it is made at its first use.
    const tile = detailed ? this.uniforms.u_tile : this.uniforms.u_plain_tile;
    if (tile.value.image.width === 1) tile.value = detailed ? makeSoilTexture(LOW_SUN) : makePlainSoilTexture(LOW_SUN);
    this.uniforms.u_deepest.value = DEEPEST[detailed ? 'detailed' : 'plain'];
    this.mesh();
    this.shareOut();
    this.dust.setDetail(detailed);
  }

  /** Sets the radius at which the ground ends, in widths of the box; null: at the horizon. */
  setEdge(widths: number | null): void {
    this.uniforms.u_edge_m.value = (widths ?? 0) * this.width_m;
    for (const material of Object.values(this.surface_materials)) {
      material.defines = widths === null ? {} : { ENDS: '1' };
      material.needsUpdate = true;
    }
  }

  /** Applies a rebuilt surface. */
  takeSurface(records: Uint16Array): void {
    this.shareOut();
    if (this.mode !== 'plain') this.paintState(records);
    this.takeRecords(records);
  }

  /** Throws dust from the fast particles of a frame. Where colours represent a number, no dust is shown. */
  throwDust(records: Uint16Array, time_s: number): void {
    if (this.mode === 'plain') this.dust.take(records, this.radii_m, time_s);
    else if (this.dust.points.visible) this.dust.forget();
  }

  /** Moves the swarms with their particles at once; the surface follows when it is due. */
  takeRecords(records: Uint16Array): void {
    const { field, grains } = this;
    if (!field) return;
    const own = grains.geometry.getAttribute('a_record') as InstancedBufferAttribute;
    const particle = grains.geometry.getAttribute('a_particle') as InstancedBufferAttribute;
    const outwards = grains.geometry.getAttribute('a_outwards') as InstancedBufferAttribute;
    const count = this.detailed ? field.seen_count : field.risen_count;
    for (let nth = 0; nth < count; ++nth) {
      const i = field.seen[nth]!;
      for (let k = 0; k < 4; ++k) own.array[4 * nth + k] = records[4 * i + k]!;
      for (let k = 0; k < 3; ++k) outwards.array[3 * nth + k] = field.aloft.outwards[3 * i + k]!;
      particle.array[2 * nth] = this.radii_m[i]!;
      particle.array[2 * nth + 1] = i;
    }
    for (const attribute of [own, particle, outwards]) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, count * attribute.itemSize);
      attribute.needsUpdate = true;
    }
    grains.geometry.instanceCount = count;
    grains.visible = count > 0;
  }

  private mesh(): void {
    if (!this.field) return;
    const { width_m, length_m, columns, rows } = this.field;
    const cells = (points: number): number =>
      this.detailed ? Math.min(192, points) : Math.min(56, Math.ceil(0.5 * points));
    const size = [width_m, length_m, cells(columns), cells(rows)] as const;
    if (size.join() === this.meshed_for) return;
    this.meshed_for = size.join();
    this.surface.geometry.dispose();
    this.surface.geometry = surfaceMesh(...size, HORIZON_WIDTHS * this.width_m);
  }

  private makeSwarms(): void {
    this.grains.geometry.dispose();
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(swarm(SWARM.detailed), 4));
    const count = this.radii_m.length;
    const record = new InstancedBufferAttribute(new Uint16Array(4 * count), 4, true);
    const particle = new InstancedBufferAttribute(new Float32Array(2 * count), 2);
    const outwards = new InstancedBufferAttribute(new Float32Array(3 * count), 3);
    geometry.setAttribute('a_outwards', outwards.setUsage(DynamicDrawUsage));
    geometry.setAttribute('a_record', record.setUsage(DynamicDrawUsage));
    geometry.setAttribute('a_particle', particle.setUsage(DynamicDrawUsage));
    geometry.instanceCount = 0;
    this.grains.geometry = geometry;
  }

  /** Sets the number of small grains per particle within the budget; single ones appear and vanish by their size. */
  private shareOut(): void {
    const how = this.detailed ? 'detailed' : 'plain';
    const seen = Math.max(1, (this.detailed ? this.field?.seen_count : this.field?.risen_count) ?? 1);
    const each = Math.min(SWARM[how], Math.max(6, BUDGET[how] / seen));
    this.uniforms.u_swarm.value = each;
    this.uniforms.u_size.value = Math.min(2.2, Math.sqrt(SWARM.detailed / each));
    this.grains.geometry.setDrawRange(0, Math.ceil(each));
  }

  /** Paints the state of the topmost particle at each point, for the colours that represent a number. */
  private paintState(records: Uint16Array): void {
    const { field } = this;
    if (!field) return;
    const data = this.state.image.data as Uint8Array;
    for (let cell = 0; cell < field.topmost.length; ++cell) {
      const i = field.topmost[cell]!;
      const both = records[4 * i + 3]!;
      data[4 * cell] = both & 255;
      data[4 * cell + 1] = both >> 8;
      data[4 * cell + 2] = (both & 255) === 0 ? 255 : 0;
    }
    this.state.needsUpdate = true;
  }
}

/** Makes the small grains of a swarm: position in a sphere of radius 1, and radius; the first is its core. Many
 * small, few large. */
export function swarm(count: number): Float32Array {
  let seed = 1970;
  const random = (): number => (seed = (seed * 16807) % 2147483647) / 2147483647;
  const made = new Float32Array(4 * count);
  for (let i = 1; i < count; ++i) {
    const up = 2 * random() - 1;
    const angle = 2 * Math.PI * random();
    const out = 0.55 + 0.45 * Math.cbrt(random());
    const level = out * Math.sqrt(1 - up * up);
    made.set([level * Math.cos(angle), level * Math.sin(angle), out * up], 4 * i);
    made[4 * i + 3] = 0.085 * Math.min(3.5, (0.03 + 0.97 * random()) ** -0.45);
  }
  return made;
}
