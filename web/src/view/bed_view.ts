// The bed: all particles in one draw call. The records of a frame go to the graphics card unchanged, eight bytes per
// particle, and the shader computes positions. Only changed runs are sent again. The radii are sent once.

import {
  COLOUR_MODES,
  type ColourMode,
  dequantise,
  type Frame,
  radiiOf,
  type Scene,
  type Tool,
  type Vec3,
} from 'haptolith-protocol';
import {
  Color,
  CustomBlending,
  DynamicDrawUsage,
  GLSL3,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  BufferAttribute,
  MaxEquation,
  Mesh,
  OneFactor,
  RawShaderMaterial,
  Vector3,
  ZeroFactor,
} from 'three';
import type { Drawing } from '../settings';
import { shapeOf } from '../tool_shapes';
import { lookOf } from './body_looks';
import { ASLEEP_COLOUR, AWAKE_COLOUR, VIRIDIS } from './colour_maps';
import { GRAIN_FRAGMENT_SHADER, GRAIN_VERTEX_SHADER } from './grain_shader';
import { HeightField, type Carrier } from './height_field';
import { lightScene, shadeFlying, type Field, type LightUniforms } from './light_shader';
import { SoilSurface } from './soil_surface';
import { SoilView } from './soil_view';
import type { StoneView } from './stone_view';

// With more particles, the sun is evaluated once per particle instead of per pixel, and particles are smooth.
const MOST_WITH_PIXEL_SUN = 20_000;

// The height field need not follow every frame if building it takes long.
const FIELD_INTERVAL_MS = { small: 30, large: 80 } as const;

export class BedView {
  readonly mesh: Mesh<InstancedBufferGeometry, RawShaderMaterial>;
  readonly soil: SoilView;
  drawn = 0;
  /** extent of the outermost spheres from the centre along x and y, in m; null: not known yet */
  reach_m: [x: number, y: number] | null = null;

  private readonly material: RawShaderMaterial;
  private geometry = new InstancedBufferGeometry();
  private records: InstancedBufferAttribute | null = null;
  private scene: Scene | null = null;
  private radii_m: Float32Array = new Float32Array();
  private field: HeightField | SoilSurface | null = null;
  private drawing: Drawing = 'balls';
  private carriers: (Carrier & { thickness_m: number })[] = [];
  private field_stale = false;
  private field_built_ms = 0;

  constructor(
    private readonly light: LightUniforms,
    private readonly conservative_depth: boolean,
  ) {
    this.soil = new SoilView(light);
    this.soil.group.visible = false;
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: GRAIN_VERTEX_SHADER,
      fragmentShader: GRAIN_FRAGMENT_SHADER,
      // A particle's alpha is its coverage of a pixel; the picture itself is opaque.
      alphaToCoverage: true,
      blending: CustomBlending,
      blendSrc: OneFactor,
      blendDst: ZeroFactor,
      blendSrcAlpha: OneFactor,
      blendDstAlpha: OneFactor,
      blendEquationAlpha: MaxEquation,
      uniforms: {
        ...light,
        u_quantised_low_m: { value: new Vector3() },
        u_quantised_high_m: { value: new Vector3() },
        u_colour_mode: { value: 0 },
        u_flatness: { value: 0 },
        u_surface_m: { value: 0 },
        u_depth_range_m: { value: 0.04 },
        u_soil: { value: new Color() },
        u_map: { value: VIRIDIS.map((colour) => new Color(colour)) },
        u_asleep: { value: new Color(ASLEEP_COLOUR) },
        u_awake: { value: new Color(AWAKE_COLOUR) },
      },
    });
    this.mesh = new Mesh(this.geometry, this.material);
    // The bounding box of the geometry does not contain the particles.
    this.mesh.frustumCulled = false;
  }

  /** Colours for depth span from the level surface to the floor. */
  get depthRange_m(): number {
    return Math.max(0.005, this.scene?.box.surface_m ?? 0.04);
  }

  setScene(scene: Scene): void {
    const particles_changed =
      !this.scene ||
      this.scene.scene !== scene.scene ||
      this.scene.particles !== scene.particles ||
      this.scene.radius_m !== scene.radius_m;
    this.scene = scene;
    this.soil.setScene(scene, this.depthRange_m);
    if (particles_changed) this.makeRoom(scene);
    const uniforms = this.material.uniforms;
    (uniforms.u_quantised_low_m!.value as Vector3).set(...scene.quantised.low_m);
    (uniforms.u_quantised_high_m!.value as Vector3).set(...scene.quantised.high_m);
    uniforms.u_surface_m!.value = scene.box.surface_m;
    uniforms.u_depth_range_m!.value = this.depthRange_m;
    (uniforms.u_soil!.value as Color).set(lookOf(scene.body).soil);
  }

  setColour(mode: ColourMode): void {
    this.soil.setColour(mode);
    this.field_stale = true;
    this.material.uniforms.u_colour_mode!.value = COLOUR_MODES.indexOf(mode);
    this.material.uniforms.u_flatness!.value = mode === 'plain' ? 0 : 0.75;
  }

  setDrawing(drawing: Drawing): void {
    if (drawing === this.drawing) return;
    this.drawing = drawing;
    this.mesh.visible = drawing === 'balls';
    this.soil.group.visible = drawing === 'grains';
    this.makeField();
  }

  /** Selects the normal or the cheaper way to draw, for machines with slow graphics. */
  setDetail(detailed: boolean): void {
    this.soil.setDetail(detailed);
    const few = (this.scene?.particles ?? 0) <= MOST_WITH_PIXEL_SUN;
    const defines: Record<string, string> = detailed && few ? { GRAIN_DETAIL: '1' } : { SUN_PER_GRAIN: '1' };
    if (this.conservative_depth) defines.CONSERVATIVE_DEPTH = '1';
    if (JSON.stringify(defines) === JSON.stringify(this.material.defines)) return;
    this.material.defines = defines;
    this.material.needsUpdate = true;
  }

  /** Applies a frame's records; false when they belong to other particles than the scene's. `own` is the
   * number of `scene.tool`. */
  setFrame(frame: Frame, own = 0): boolean {
    const scene = this.scene;
    const attribute = this.records;
    if (!scene || !attribute || frame.scene !== scene.scene || frame.particles !== attribute.count) return false;
    this.carriers = [carrierOf(scene.tool, frame.tool.position_m)];
    (scene.tools ?? []).forEach((tool, i) => {
      const state = frame.tools[i];
      if (state && i !== own) this.carriers.push(carrierOf(tool, state.turned.position_m));
    });
    const all = attribute.array as Uint16Array;
    let from = 0;
    for (let i = 0; i < frame.runs.length; i += 2) {
      const first = frame.runs[i]! * 4;
      const count = frame.runs[i + 1]! * 4;
      all.set(frame.records.subarray(from, from + count), first);
      attribute.addUpdateRange(first, count);
      from += count;
    }
    if (from > 0) {
      attribute.needsUpdate = true;
      this.field_stale = true;
      if (this.drawing === 'grains') this.soil.takeRecords(all);
    }
    if (this.drawing === 'grains') this.soil.throwDust(all, frame.time_s);
    if (frame.whole) {
      this.drawn = frame.particles;
      this.geometry.instanceCount = frame.particles;
      this.reach_m ??= this.findReach(scene, all);
    }
    return true;
  }

  /** Marks the height field as outdated, after an object other than particles has moved that casts a shadow. */
  outdateField(): void {
    this.field_stale = true;
  }

  /** Updates the height field if it is due. True while an update is pending. */
  refreshField(now_ms: number, stones: StoneView): boolean {
    if (!this.field_stale || !this.field || !this.records || this.drawn === 0) return false;
    const interval_ms = this.records.count <= MOST_WITH_PIXEL_SUN ? FIELD_INTERVAL_MS.small : FIELD_INTERVAL_MS.large;
    if (now_ms - this.field_built_ms < interval_ms) return true;
    this.field.build(this.records.array as Uint16Array, this.records.count, this.carriers, stones.trianglesInScene());
    if (this.field instanceof SoilSurface) {
      this.light.u_ground_m.value = this.field.level_m;
      this.soil.takeSurface(this.records.array as Uint16Array);
    }
    shadeFlying(this.light, this.field.flying_m, this.field.flying_count);
    this.light.u_field_top_m.value = this.field.top_m;
    this.field_built_ms = now_ms;
    this.field_stale = false;
    return false;
  }

  private makeRoom(scene: Scene): void {
    this.geometry.dispose();
    this.geometry = new InstancedBufferGeometry();
    this.geometry.setAttribute(
      'position',
      new BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3),
    );
    this.geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.records = new InstancedBufferAttribute(new Uint16Array(scene.particles * 4), 4, true);
    this.records.setUsage(DynamicDrawUsage);
    this.geometry.setAttribute('a_record', this.records);
    this.radii_m = radiiOf(scene);
    this.geometry.setAttribute('a_radius_m', new InstancedBufferAttribute(this.radii_m, 1));
    this.geometry.instanceCount = 0;
    this.mesh.geometry = this.geometry;
    this.drawn = 0;
    this.reach_m = null;
    this.makeField();
  }

  private findReach({ quantised: { low_m, high_m } }: Scene, records: Uint16Array): [x: number, y: number] {
    const reach_m: [x: number, y: number] = [0, 0];
    this.radii_m.forEach((radius_m, i) => {
      for (const axis of [0, 1] as const) {
        const at_m = dequantise(records[4 * i + axis]!, low_m[axis], high_m[axis]);
        reach_m[axis] = Math.max(reach_m[axis], Math.abs(at_m) + radius_m);
      }
    });
    return reach_m;
  }

  private makeField(): void {
    const { scene, radii_m } = this;
    if (!scene) return;
    this.field?.dispose();
    if (this.drawing === 'grains') {
      const field = new SoilSurface(scene, radii_m, this.light.u_to_sun.value);
      lightScene(this.light, scene, { ...boundsOf(field), texture: field.standing }, scene.box.surface_m);
      this.soil.setParticles(field, radii_m);
      this.field = field;
    } else {
      this.field = new HeightField(scene, radii_m);
      lightScene(this.light, scene, this.field, 0);
    }
    this.field_stale = true;
    this.field_built_ms = 0;
  }
}

function boundsOf({ low_x_m, low_y_m, width_m, length_m }: SoilSurface): Omit<Field, 'texture'> {
  return { low_x_m, low_y_m, width_m, length_m };
}

function carrierOf(tool: Tool, at_m: Vec3): Carrier & { thickness_m: number } {
  const shape = shapeOf(tool);
  const thickness_m = shape.solid === 'none' ? 0 : 2 * Math.min(...shape.half_m(tool));
  return { at_m, radius_m: shape.reach_m(tool), thickness_m };
}
