// Soil that looks like soil: the bed as one surface that lies in the ground of its body, and over it a swarm of small
// grains for every macroparticle that can be seen.

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
  LinearMipmapLinearFilter,
  LinearMipmapNearestFilter,
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
import { SURFACE_FRAGMENT_SHADER, SURFACE_VERTEX_SHADER } from './surface_shader';
import { surfaceMesh } from './surface_mesh';
import type { SoilSurface } from './soil_surface';
import { makeSoilTexture } from './soil_texture';

// Small grains in the picture at most, of all particles together, and of one.
const BUDGET = { detailed: 120_000, plain: 9_000 } as const;
const SWARM = { detailed: 150, plain: 26 } as const;
const HORIZON_WIDTHS = 120;
// One tile of fine soil is so wide, in widths of the box.
const TILE_WIDTHS = 0.32;

export class SoilView {
  readonly group = new Group();
  readonly dust: Dust;
  private readonly surface: Mesh<BufferGeometry, RawShaderMaterial>;
  private readonly grains: Points<InstancedBufferGeometry, RawShaderMaterial>;
  private readonly uniforms;
  private field: SoilSurface | null = null;
  private radii_m: Float32Array = new Float32Array();
  private state = new DataTexture(new Uint8Array(4), 1, 1, RGBAFormat);
  private mode: ColourMode = 'plain';
  private detailed = true;
  private width_m = 0.126;
  private meshed_for = '';

  constructor(light: LightUniforms) {
    this.uniforms = {
      ...light,
      u_surface: { value: new DataTexture(new Uint8Array(4), 1, 1) },
      u_tile: { value: makeSoilTexture(LOW_SUN) },
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
      u_haze_m: { value: 10 },
      u_edge_m: { value: 0 },
      u_tile_m: { value: 0.05 },
      u_quantised_low_m: { value: new Vector3() },
      u_quantised_high_m: { value: new Vector3() },
      u_swarm: { value: 0 },
      u_size: { value: 1 },
      u_height_px: { value: 720 },
    };
    const material = (vertexShader: string, fragmentShader: string): RawShaderMaterial =>
      new RawShaderMaterial({ glslVersion: GLSL3, vertexShader, fragmentShader, uniforms: this.uniforms });
    this.surface = new Mesh(new BufferGeometry(), material(SURFACE_VERTEX_SHADER, SURFACE_FRAGMENT_SHADER));
    this.grains = new Points(
      new InstancedBufferGeometry(),
      material(FINE_GRAIN_VERTEX_SHADER, FINE_GRAIN_FRAGMENT_SHADER),
    );
    this.surface.material.defines = { DETAIL: '1' };
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
    uniforms.u_haze_m.value = look.haze_widths * this.width_m;
    uniforms.u_lunar.value = look.lunar;
    uniforms.u_surge.value = look.surge;
    uniforms.u_sky.value = look.shadow_fill;
    uniforms.u_tile_m.value = TILE_WIDTHS * this.width_m;
    uniforms.u_depth_range_m.value = depth_range_m;
    uniforms.u_quantised_low_m.value.set(...scene.quantised.low_m);
    uniforms.u_quantised_high_m.value.set(...scene.quantised.high_m);
  }

  /** Other particles, and the surface that they make. */
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
    this.define('DETAIL', detailed);
    // Sharp at a slant costs many looks into the tile, which hardly count on a graphics card.
    const tile = this.uniforms.u_tile.value;
    tile.anisotropy = detailed ? 8 : 1;
    tile.minFilter = detailed ? LinearMipmapLinearFilter : LinearMipmapNearestFilter;
    tile.needsUpdate = true;
    this.mesh();
    this.shareOut();
    this.dust.setDetail(detailed);
  }

  /** The ground ends after so many widths of the box; null: at the horizon. */
  setEdge(widths: number | null): void {
    this.uniforms.u_edge_m.value = (widths ?? 0) * this.width_m;
    this.define('ENDS', widths !== null);
  }

  /** The surface has been built anew. */
  takeSurface(records: Uint16Array): void {
    this.shareOut();
    if (this.mode !== 'plain') this.paintState(records);
    this.takeRecords(records);
  }

  /** What a frame says: fast grains throw dust. Where colours mean a number there is none. */
  throwDust(records: Uint16Array, time_s: number): void {
    if (this.mode === 'plain') this.dust.take(records, this.radii_m, time_s);
    else if (this.dust.points.visible) this.dust.forget();
  }

  /** Particles have moved: the swarms go with them at once, the surface follows when it is due. */
  takeRecords(records: Uint16Array): void {
    const { field, grains } = this;
    if (!field) return;
    const own = grains.geometry.getAttribute('a_record') as InstancedBufferAttribute;
    const particle = grains.geometry.getAttribute('a_particle') as InstancedBufferAttribute;
    const outwards = grains.geometry.getAttribute('a_outwards') as InstancedBufferAttribute;
    for (let nth = 0; nth < field.seen_count; ++nth) {
      const i = field.seen[nth]!;
      for (let k = 0; k < 4; ++k) own.array[4 * nth + k] = records[4 * i + k]!;
      for (let k = 0; k < 3; ++k) outwards.array[3 * nth + k] = field.aloft.outwards[3 * i + k]!;
      particle.array[2 * nth] = this.radii_m[i]!;
      particle.array[2 * nth + 1] = i;
    }
    for (const attribute of [own, particle, outwards]) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, field.seen_count * attribute.itemSize);
      attribute.needsUpdate = true;
    }
    grains.geometry.instanceCount = field.seen_count;
  }

  private mesh(): void {
    if (!this.field) return;
    const { width_m, length_m, columns, rows } = this.field;
    const cells = (points: number): number =>
      this.detailed ? Math.min(192, points) : Math.min(80, Math.ceil(0.55 * points));
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

  /** As many small grains a particle as there may be; one more or less comes and goes by its size. */
  private shareOut(): void {
    const how = this.detailed ? 'detailed' : 'plain';
    const seen = Math.max(1, this.field?.seen_count ?? 1);
    const each = Math.min(SWARM[how], Math.max(6, BUDGET[how] / seen));
    this.uniforms.u_swarm.value = each;
    this.uniforms.u_size.value = Math.min(2.2, Math.sqrt(SWARM.detailed / each));
    this.grains.geometry.setDrawRange(0, Math.ceil(each));
  }

  /** What the particle at the top of each point carries, for the colours that mean a number. */
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

  private define(name: string, on: boolean): void {
    const { material } = this.surface;
    const defines = { ...(material.defines as Record<string, string>) };
    if (name in defines === on) return;
    if (on) defines[name] = '1';
    else delete defines[name];
    material.defines = defines;
    material.needsUpdate = true;
  }
}

/** Small grains of a swarm: place in a ball of radius 1, and radius; the first is its core. Many small, few large. */
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
